"""The record of a mission: its events, its parts and what came of them."""

from dataclasses import dataclass, field

import numpy as np

from ...arrays import checked
from ...world import World
from ..events import Chronicle, Event
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
    """

    world: World
    task: str
    seed: int
    events: list[Event] = field(default_factory=list)
    journey: Journey | None = None
    job: Job | None = None
    way_home: Journey | None = None
    real_time_factor: float = np.nan

    @property
    def parts(self) -> dict[str, Journey | Job]:
        """What there is of the way there, the work and the way home, in this order."""
        parts = {"way there": self.journey, "work": self.job, "way home": self.way_home}
        return {name: part for name, part in parts.items() if part is not None}

    @property
    def now(self) -> float:
        """Simulated time so far [s]."""
        return sum(float(part.time[-1]) for part in self.parts.values())

    def when(self, begins: str) -> float:
        """When the job first was in that state of its own; now, if it never was, or there is no job [s]."""
        if self.job is None or self.journey is None:
            return self.now
        times = [event.time for event in self.job.events if event.state == begins]
        return float(self.journey.time[-1]) + times[0] if times else self.now

    def table(self) -> dict[str, str]:
        """The mission in a few lines."""
        rows = {f"{number}. {event.state}": f"{event.time:.1f} s" + (f", {event.why}"
                                                                     if event.why else "")
                for number, event in enumerate(self.events, 1)}
        for name, part in self.parts.items():
            rows.update({f"{name}: {quantity}": value
                         for quantity, value in part.table().items()
                         if quantity not in ("state", "real-time factor")})
        return {**rows, "mission time": f"{self.now:.1f} s",
                "real-time factor": f"{self.real_time_factor:.1f}"}
