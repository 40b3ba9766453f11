"""States that jobs and missions go through: when each was entered, and why where it is not as planned."""

from collections.abc import Sequence
from typing import Any, NamedTuple

from ..errors import InvalidInput, quoted

DONE, STOPPED = "done", "stopped"
"""How a job, a mission or a journey ends; stopped is safe: bases stand still, the platform holds where it is."""


class Event(NamedTuple):
    """A state was entered: when [s], which, and why, where it is not as planned."""

    time: float
    state: str
    why: str = ""


class Chronicle:
    """What has ``events``: it is in the last one's state."""

    events: Sequence[Event]

    @property
    def state(self) -> str:
        """Name of the last state."""
        return self.events[-1].state if self.events else ""

    @property
    def reason(self) -> str:
        """'' or why it stopped."""
        return self.events[-1].why if self.events else ""


def as_reason(answer: Any, time: float) -> str:
    """What a guard answered at a time [s]; raises InvalidInput unless it is text.

    >>> as_reason(None, 1.0)
    Traceback (most recent call last):
    ...
    cdprlab.errors.InvalidInput: what a guard answers at t = 1 s must be text, '' where all is well, got None
    """
    if not isinstance(answer, str):
        raise InvalidInput(f"what a guard answers at t = {time:.4g} s must be text, '' where all is well, "
                           f"got {quoted(answer)}")
    return answer


def spans(events: Sequence[Event], end: float) -> list[tuple[float, float, str]]:
    """(begin, end, state) of each [s].

    >>> spans([Event(0.0, "reach"), Event(1.5, "done")], 2.0)
    [(0.0, 1.5, 'reach'), (1.5, 2.0, 'done')]
    """
    times = [event.time for event in events] + [end]
    return [(begins, ends, event.state)
            for begins, ends, event in zip(times, times[1:], events)]
