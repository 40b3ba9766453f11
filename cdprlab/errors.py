"""What can go wrong: each error says what was given, what is allowed and what to do."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from numpy.typing import NDArray

Location = tuple[str | int, ...]
"""Where in a world file a value stands, e.g. ``("cables", 2, "anchor_point")``; list indices from 0."""


class CdprError(Exception):
    """Root of every error that cdprlab raises on purpose; ``run`` is what was flown where it cut a run short."""

    run: Any = None


class InvalidInput(CdprError, ValueError):
    """A value that cannot be used; ``location`` names its place in a world, where it has one."""

    def __init__(self, message: str, location: Location = ()) -> None:
        super().__init__(message)
        self.message = message
        self.location = location


@contextmanager
def under(*prefix: str | int) -> Iterator[None]:
    """What is InvalidInput inside is so from further up, too: its location starts with ``prefix``."""
    try:
        yield
    except InvalidInput as error:
        raise InvalidInput(error.message, (*prefix, *error.location)) from None


class WorldError(InvalidInput):
    """A world that cannot be used; ``problems`` holds every mistake found, one line each."""

    def __init__(self, problems: list[str]) -> None:
        more = len(problems) - 1
        also = f" (and {more} more {'mistake' if more == 1 else 'mistakes'})" if more else ""
        super().__init__(problems[0] + also)
        self.problems = tuple(problems)


class NoConvergence(CdprError):
    """No pose fits the cable lengths; ``residuals`` holds what is left of each length [m]."""

    def __init__(self, message: str, residuals: NDArray[Any]) -> None:
        super().__init__(message)
        self.residuals = residuals


class InfeasibleTensions(CdprError):
    """No usable tensions; ``distribution`` holds the method's last answer."""

    def __init__(self, message: str, distribution: Any) -> None:
        super().__init__(message)
        self.distribution = distribution


class NotListable(CdprError):
    """A set whose vertices and facets cannot be written down: unbounded, or too many of them."""


class InfeasibleTwist(CdprError):
    """A platform twist beyond the speed limits; ``resolution`` holds the speeds and the largest feasible scale."""

    def __init__(self, message: str, resolution: Any) -> None:
        super().__init__(message)
        self.resolution = resolution


class NoPlacement(CdprError):
    """No base poses were found that serve the wanted poses; ``robot`` stands as near to it as was found."""

    def __init__(self, message: str, robot: Any) -> None:
        super().__init__(message)
        self.robot = robot


class SimulationDiverged(CdprError):
    """The engine lost the robot at ``time`` [s]; ``cable`` (from 1) pulled hardest."""

    def __init__(self, message: str, time: float, cable: int) -> None:
        super().__init__(message)
        self.time = time
        self.cable = cable


class MissingDependency(CdprError, ImportError):
    """An optional package is needed here and not installed; the message names the ways out."""
