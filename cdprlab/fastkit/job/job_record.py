"""What happened on a job: one row a control step, the states it went through, and how it ended."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ...arrays import Array, frozen
from ...robot import Robot
from ...robot.pose import Pose, rotation_vector
from ...run import Log, save_record
from ...run.log import Columns
from ...world import World
from ...world.model import PickAndPlace
from ..events import Event
from .machine import SETTLING, Machine

_UNITS = {
    "time": "s", "positions": "m", "rotations": "", "reference_positions": "m", "reference_rotations": "",
    "commanded": "N", "tensions": "N", "torques": "N m", "motor_speeds": "rad/s", "lengths": "m",
    "base_poses": "m, m, rad", "tilts": "rad", "wheels": "N", "box_positions": "m", "box_rotations": "",
    "stroke": "", "carried": "kg", "state": "", "feasible": "",
}
"""Columns of the log."""

_EVERY = 5
"""Rows that log.csv keeps one of, for spreadsheets; log.npz has them all."""


@dataclass(frozen=True, eq=False)
class Job:
    """A job, done or stopped: N control steps, one row each.

    state, reason : "done", or "stopped" and why
    events : states in order, when each was entered [s]
    time : (N,) [s]; poses, reference : Pose of batch (N,)
    errors : (N, 6) reference minus pose: position, rotation vector [m, rad]
    commanded : (N, m) tensions asked for; tensions : (N, m) measured [N]
    torques, motor_speeds : (N, m) [N m, rad/s]; lengths : (N, m) [m]
    base_poses : (N, p, 3) x, y, heading; tilts : (N, p) of the masts [rad]
    wheels : (N, p, k) load of each wheel, as measured at the begin of the step [N]
    box_poses : Pose of batch (N,); stroke : (N,) share of the gripper's; carried : (N,) known payload [kg]
    states : (N,) index into ``events``; words : state → what is done in it; feasible : (N,)
    real_time_factor : simulated over elapsed time
    """

    world: World
    task_name: str
    task: PickAndPlace
    control: str
    state: str
    reason: str
    events: tuple[Event, ...]
    time: Array
    poses: Pose
    reference: Pose
    errors: Array
    commanded: Array
    tensions: Array
    torques: Array
    motor_speeds: Array
    lengths: Array
    base_poses: Array
    tilts: Array
    wheels: Array
    box_poses: Pose
    stroke: Array
    carried: Array
    states: Any
    words: dict[str, str]
    feasible: Any
    real_time_factor: float
    settings: dict[str, Any] = field(repr=False)

    @property
    def position_errors(self) -> Array:
        """(N,) distance from the reference [m]."""
        return np.linalg.norm(self.errors[:, :3], axis=1)

    @property
    def box_error(self) -> float:
        """Distance of the box from its place at the end [m]."""
        return float(np.linalg.norm(self.box_poses.position[-1] - self.task.place))

    @property
    def least_edge_load(self) -> float:
        """What the two wheels of the least loaded edge carried at least, once the wheels had found the floor [N]."""
        wheels = self.wheels[self.time >= SETTLING]
        return float((wheels + np.roll(wheels, -1, axis=-1)).min())

    def robot_at(self, index: int) -> Robot:
        """The robot with its bases where they stood at one control step."""
        robot = self.world.robot
        return robot.with_bases({base.name: pose for base, pose in zip(robot.bases, self.base_poses[index])})

    def state_at(self, index: int) -> str:
        """Name of the state at one control step."""
        return self.events[int(self.states[index])].state

    def table(self) -> dict[str, str]:
        """The job in a few lines: quantity → value with unit."""
        robot, winch = self.world.robot, self.world.robot.winch
        low, high = robot.tension_min.min(), robot.tension_max.max()
        drive = {} if winch is None else {
            "motor torque, largest": f"{np.abs(self.torques).max():.2f} N m (limit {winch.torque:g} N m)",
            "motor speed, largest": f"{np.abs(self.motor_speeds).max():.0f} rad/s (limit {winch.speed:.0f} rad/s)"}
        return {
            "state": self.state + (f": {self.reason}" if self.reason else ""),
            "tracking error, largest": f"{self.position_errors.max() * 1e3:.2f} mm",
            "tension, smallest": f"{self.tensions[1:].min():.1f} N (limit {low:g} N)",
            "tension, largest": f"{self.tensions.max():.1f} N (limit {high:g} N)",
            **drive,
            "least load on a base's edge": f"{self.least_edge_load:.0f} N (0: it tips)",
            "box off its place": f"{self.box_error * 1e3:.1f} mm",
            "simulated time": f"{self.time[-1]:.1f} s",
            "real-time factor": f"{self.real_time_factor:.1f}",
        }

    def save(self, folder: str | Path) -> Path:
        """Write log.npz (arrays and their units), log.csv (every fifth row), events.csv, the world and the settings.

        folder : made if missing
        """
        parts = {"": self.poses, "reference_": self.reference, "box_": self.box_poses}
        arrays: dict[str, Any] = {name: getattr(self, name) for name in _UNITS if hasattr(self, name)}
        arrays["state"] = self.states
        for kind, pose in parts.items():
            arrays[f"{kind}positions"], arrays[f"{kind}rotations"] = pose.position, pose.rotation
        settings = {"task": self.task_name, "control": self.control, **self.settings}
        target = save_record(folder, {name: (np.asarray(arrays[name]), unit) for name, unit in _UNITS.items()},
                             self.world, settings, _EVERY)
        lines = ["time [s],state,why", *(f"{event.time:.3f},{event.state},\"{event.why}\"" for event in self.events)]
        (target / "events.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
        return target


def job_columns(robot: Robot) -> Columns:
    """What a job keeps of each control step, beside what `fly` does."""
    p, k = len(robot.bases), len(robot.bases[0].footprint)
    return {"time": ((), "s"), "reference_positions": ((3,), "m"), "reference_rotations": ((3, 3), ""),
            "base_poses": ((p, 3), "m, m, rad"), "tilts": ((p,), "rad"), "wheels": ((p, k), "N"),
            "box_positions": ((3,), "m"), "box_rotations": ((3, 3), ""), "stroke": ((), ""), "carried": ((), "kg"),
            "state": ((), "")}


def as_job(world: World, name: str, task: PickAndPlace, control: str, machine: Machine, flown: Log, more: Log,
           elapsed: float, settings: dict[str, Any]) -> Job:
    """A job from both its logs."""
    steps = len(more)
    poses = Pose.of(flown["position"][:steps], flown["rotation"][:steps])
    wanted = Pose.of(more["reference_positions"], more["reference_rotations"])
    turn = rotation_vector(wanted.rotation @ np.swapaxes(poses.rotation, -1, -2))
    errors = np.concatenate([wanted.position - poses.position, turn], axis=1)
    kept = {name: more[name] for name in ("time", "base_poses", "tilts", "wheels", "stroke", "carried")}
    return Job(world, name, task, control, machine.state, machine.history[-1].why, tuple(machine.history),
               poses=poses, reference=wanted, errors=frozen(errors), commanded=flown["commanded_tensions"][:steps],
               tensions=flown["measured_tensions"][1:], torques=flown["motor_torques"][:steps],
               motor_speeds=flown["motor_speeds"][:steps], lengths=flown["lengths"][1:],
               box_poses=Pose.of(more["box_positions"], more["box_rotations"]), states=more["state"].astype(int),
               words={phase.name: phase.what for phase in machine.phases}, feasible=flown["feasible"][:steps] > 0,
               real_time_factor=float(kept["time"][-1]) / elapsed, settings=settings, **kept)
