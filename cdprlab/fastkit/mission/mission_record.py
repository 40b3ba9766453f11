"""The record of a mission: its events, its parts and what came of them."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ...arrays import checked
from ...run.log import write_csv
from ...world import World
from ...world.files import made_folder
from ..events import STOPPED, Chronicle, Event
from ..job.job_record import Job
from ..navigation.journey import Journey


@checked
@dataclass
class Mission(Chronicle):
    """What happened, state by state.

    world, task : what was to be done; seed : of all noise
    state, reason : "done", or "stopped" and why
    events : states in order
    journey, job, way_home : the way to the shelf, what happened there, the way back
    real_time_factor : simulated over elapsed time
    cut_short : '' or what ended it early, Ctrl-C for one
    """

    world: World
    task: str
    seed: int
    events: list[Event] = field(default_factory=list)
    journey: Journey | None = None
    job: Job | None = None
    way_home: Journey | None = None
    real_time_factor: float = np.nan
    cut_short: str = ""

    @property
    def parts(self) -> dict[str, Journey | Job]:
        """What there is of the way there, the work and the way home, in this order."""
        parts = {"way there": self.journey, "work": self.job, "way home": self.way_home}
        return {name: part for name, part in parts.items() if part is not None}

    @property
    def now(self) -> float:
        """Simulated time so far [s]."""
        return sum(float(part.time[-1:].sum()) for part in self.parts.values())

    def when(self, begins: str) -> float:
        """When the job first was in that state of its own; now, if it never was, or there is no job [s]."""
        if self.job is None or self.journey is None:
            return self.now
        times = [event.time for event in self.job.events if event.state == begins]
        return float(self.journey.time[-1]) + times[0] if times else self.now

    def cut(self, reason: str, part: Any) -> Mission:
        """The mission as it is when something ends it early, in the middle of a part."""
        if isinstance(part, Job):
            self.job = part
        elif isinstance(part, Journey):
            setattr(self, "way_home" if self.journey else "journey", part)
        self.cut_short = reason
        self.events.append(Event(self.now, STOPPED, reason))
        return self

    def save(self, folder: str | Path) -> Path:
        """Write what there is: the job as it saves itself, and a CSV file of the way there and of the way home."""
        target = made_folder(folder)
        for name, part in self.parts.items():
            if isinstance(part, Journey):
                write_csv(target / f"{name.replace(' ', '_')}.csv", part.columns())
            elif isinstance(part, Job):
                part.save(target)
        return target

    def table(self) -> dict[str, str]:
        """The mission in a few lines."""
        rows = {f"{number}. {event.state}": f"{event.time:.1f} s, {event.why}".removesuffix(", ")
                for number, event in enumerate(self.events, 1)}
        for name, part in self.parts.items():
            rows.update({f"{name}: {quantity}": value
                         for quantity, value in part.table().items()
                         if quantity not in ("state", "real-time factor")})
        return {**rows, "mission time": f"{self.now:.1f} s",
                "real-time factor": f"{self.real_time_factor:.1f}"}
