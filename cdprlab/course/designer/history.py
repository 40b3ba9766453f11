"""What was done and can be undone: a line of states, none of them ever changed."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Generic, NamedTuple, TypeVar

from ...errors import InvalidInput

State = TypeVar("State")


class Step(NamedTuple, Generic[State]):
    """One edit: its name and the state on its far side."""

    label: str
    state: State


@dataclass(frozen=True)
class History(Generic[State]):
    """A present state with the edits that led to it and those that were undone.

    present : what is now
    past : last edit last, each with the state before it
    future : the edit undone last comes first, each with the state after it
    most : so many edits can be undone; older ones are forgotten

    >>> history = History(0).done("one more", 1).done("doubled", 2).undone()
    >>> history.present, history.undo_label, history.redo_label
    (1, 'one more', 'doubled')
    """

    present: State
    past: tuple[Step[State], ...] = ()
    future: tuple[Step[State], ...] = ()
    most: int = 200

    def done(self, label: str, state: State) -> History[State]:
        """After an edit; what had been undone is gone."""
        past = (*self.past, Step(label, self.present))[-self.most:]
        return replace(self, present=state, past=past, future=())

    def undone(self) -> History[State]:
        """Before the last edit; raises InvalidInput if there is none."""
        if not self.past:
            raise InvalidInput("nothing to undo: this is the robot you began with")
        *earlier, last = self.past
        return replace(self, present=last.state, past=tuple(earlier),
                       future=(Step(last.label, self.present), *self.future))

    def redone(self) -> History[State]:
        """With the edit undone last done again; raises InvalidInput if there is none."""
        if not self.future:
            raise InvalidInput("nothing to redo: no edit has been undone since the last one was made")
        following, *later = self.future
        return replace(self, present=following.state,
                       past=(*self.past, Step(following.label, self.present)),
                       future=tuple(later))

    @property
    def undo_label(self) -> str:
        """Name of the edit that would be undone, '' if there is none."""
        return self.past[-1].label if self.past else ""

    @property
    def redo_label(self) -> str:
        """Name of the edit that would be done again, '' if there is none."""
        return self.future[0].label if self.future else ""
