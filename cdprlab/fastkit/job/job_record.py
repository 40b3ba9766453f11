"""What happened on a job: a run in which more is written down, the states it went through, and how it ended."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from ...arrays import Array
from ...robot.pose import Pose
from ...run import Run
from ...run.log import write_rows
from ...world.model import PickAndPlace
from ..events import Chronicle, Event
from .machine import SETTLING, least_edge_loads


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class Job(Chronicle, Run):
    """A job, done or stopped: a `Run` of N control steps under a ``method`` of control, and beside its columns:

    state, reason : "done", or "stopped" and why
    events : states in order, when each was entered [s]
    base_poses : (N, p, 3) x, y, heading [m, m, rad]; tilts : (N, p) of the masts [rad]
    wheels : (N, p, k) load of each wheel, as measured at the begin of the step [N]
    box_poses : Pose of batch (N,); stroke : (N,) share of the gripper's
    carried : (N,) known payload [kg]
    states : (N,) index into ``events``; words : state → what is done in it
    """

    csv_rows: ClassVar[int] = 5

    motor_torques: Array
    motor_speeds: Array
    events: tuple[Event, ...]
    base_poses: Array
    tilts: Array
    wheels: Array
    box_poses: Pose
    stroke: Array
    carried: Array
    states: Any
    words: dict[str, str]

    @property
    def work(self) -> PickAndPlace:
        """The task itself."""
        return self.world.task(self.task)     # type: ignore[return-value]

    def boxes_at(self, index: int) -> tuple[tuple[Pose, Array], ...]:
        return ((self.box_poses[self.row(index)], self.work.box_size),)

    @property
    def box_error(self) -> float:
        """Distance of the box from its place at the end [m]."""
        return float(np.linalg.norm(self.box_poses.position[-1] - self.work.place))

    @property
    def least_edge_load(self) -> float:
        """What the two wheels of the least loaded edge carried at least, once the wheels had found the floor [N]."""
        return float(least_edge_loads(self.wheels[self.time >= SETTLING]).min())

    def state_at(self, index: int) -> str:
        """Name of the state at one control step."""
        return self.events[int(self.states[self.row(index)])].state

    def table(self) -> dict[str, str]:
        """The job in a few lines: quantity → value with unit."""
        robot, tensions = self.world.robot, self.measured_tensions
        if not (self.time >= SETTLING).any():   # too short to judge wheels and tensions by
            return {"state": self.state, "cut short": self.cut_short}
        assert robot.winch   # or nobody controlled it
        return {
            "state": f"{self.state}: {self.reason}".removesuffix(": "),
            "tracking error, largest": f"{self.position_errors.max() * 1e3:.2f} mm",
            "tension, smallest": f"{tensions[1:].min():.1f} N (limit {robot.tension_min.min():g} N)",
            "tension, largest": f"{tensions.max():.1f} N (limit {robot.tension_max.max():g} N)",
            "motor torque, largest": f"{np.abs(self.motor_torques).max():.2f} N m (limit {robot.winch.torque:g} N m)",
            "motor speed, largest": f"{np.abs(self.motor_speeds).max():.0f} rad/s",
            "least load on a base's edge": f"{self.least_edge_load:.0f} N (0: it tips)",
            "box off its place": f"{self.box_error * 1e3:.1f} mm",
            "simulated time": f"{self.time[-1]:.1f} s",
            "real-time factor": f"{self.real_time_factor:.1f}",
            **({"cut short": self.cut_short} if self.cut_short else {}),
        }

    def columns(self) -> dict[str, tuple[Any, str]]:
        return {**super().columns(), "tilt": (self.tilts, "rad"),
                "wheel": (self.wheels, "N"), "box_position": (self.box_poses.position, "m"),
                "box_rotation": (self.box_poses.rpy, "rad"), "stroke": (self.stroke, ""),
                "carried": (self.carried, "kg"), "state": (self.states, "")}

    def save(self, folder: str | Path) -> Path:
        """Write log.npz (arrays and their units), log.csv, events.csv, the world and the settings."""
        target = super().save(folder)
        write_rows(target / "events.csv", [
            ("time [s]", "state", "why"),
            *((f"{event.time:.3f}", event.state, event.why) for event in self.events)])
        return target
