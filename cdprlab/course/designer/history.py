"""What was done and can be undone: a line of states, none of them ever changed."""

from __future__ import annotations

from typing import Generic, NamedTuple, TypeVar

from ...errors import InvalidInput

State = TypeVar("State")

MOST = 200
"""So many edits can be undone; older ones are forgotten."""


class Step(NamedTuple, Generic[State]):
    """One edit: its name and the state it led to; of the beginning the name is empty."""

    label: str
    state: State


class History(NamedTuple, Generic[State]):
    """States one after the other, one of which is now.

    steps : in the order of their edits; after the present those that were undone
    at : which of them is the present

    >>> history = History(()).done("", 0).done("one more", 1).done("doubled", 2).moved(-1)
    >>> history.present, history.labels
    (1, ('one more', 'doubled'))
    """

    steps: tuple[Step[State], ...]
    at: int = 0

    @property
    def present(self) -> State:
        """What is now."""
        return self.steps[self.at].state

    @property
    def labels(self) -> tuple[str, str]:
        """Names of the edits that would be undone and redone; empty where there is none."""
        names = [*(step.label for step in self.steps), ""]
        return names[self.at], names[self.at + 1]

    def done(self, label: str, state: State) -> History[State]:
        """After an edit; what had been undone is gone."""
        steps = (*self.steps[:self.at + 1], Step(label, state))[-MOST - 1:]
        return History(steps, len(steps) - 1)

    def moved(self, by: int) -> History[State]:
        """So many edits back (negative) or ahead; raises InvalidInput if there are not."""
        if not 0 <= self.at + by < len(self.steps):
            raise InvalidInput("nothing to undo: this is the robot you began with" if by < 0 else
                               "nothing to redo: no edit has been undone since the last one was made")
        return History(self.steps, self.at + by)
