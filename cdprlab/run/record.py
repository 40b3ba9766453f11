"""What happened in a run: one row a control step, summed up and saved."""

from dataclasses import dataclass, field
from operator import attrgetter
from pathlib import Path
from typing import Any, ClassVar, Self

import numpy as np

from ..arrays import Array, as_count, data_frame, frozen, lasting
from ..mechanics.dynamics import pose_error
from ..mechanics.trajectory import Reference
from ..robot import Robot
from ..robot.pose import Pose
from ..world import World
from ..world.files import made_folder, replaced, write_text
from .log import flat_columns, write_csv
from .loop import Flight

_UNITS = {
    "time": "s", "position": "m", "rotation": "rad", "twist": "m/s, rad/s", "error": "m, rad", "tension": "N",
    "length": "m", "torque": "N m", "speed": "rad/s", "pose": "m, m, rad", "feasible": ""}

_FIELDS = {
    "time": "time", "position": "poses.position", "rotation": "poses.orientation", "twist": "twists",
    "reference_position": "reference.pose.position", "reference_rotation": "reference.pose.orientation",
    "reference_twist": "reference.twist", "error": "errors", "commanded_tension": "commanded_tensions",
    "measured_tension": "measured_tensions", "length": "lengths", "estimated_position": "estimates.position",
    "estimated_rotation": "estimates.orientation", "estimated_twist": "estimated_twists",
    "sensed_length": "sensed_lengths", "sensed_tension": "sensed_tensions", "commanded_length": "commanded_lengths",
    "motor_torque": "motor_torques", "motor_speed": "motor_speeds", "base_pose": "base_poses", "feasible": "feasible"}

QUANTITIES = {name: (field, _UNITS[name.rpartition("_")[2]]) for name, field in _FIELDS.items()}
"""Column of log.csv → the field of a `Run` that it tells, and its unit."""

_AS_IT_WAS: Any = None


def errors_of(robot: Robot, poses: Pose, wanted: Pose) -> Array:
    """(N, n) wanted minus there in the motion pattern's rows: position, rotation vector [m, rad]."""
    error, basis = pose_error(poses, wanted), robot.pattern.basis(poses.rotation)
    return frozen((error[:, None] @ basis)[:, 0])


@lasting
@dataclass(frozen=True, eq=False)
class Run:
    """What happened: N control steps of a run, one row each.

    time : (N,) start of each control step [s]
    poses : Pose of batch (N,); twists (N, 3 or 6) [m/s, rad/s]
    reference : Reference of batch (N,)
    commanded_tensions : (N, m) held during the step, NaN where lengths are commanded [N]
    measured_tensions : (N, m) what the engine's cables carried at its end [N]
    lengths : (N, m) cable lengths [m]
    errors : (N, n) reference minus pose in the motion pattern's rows: position, rotation vector
        [m, rad]
    feasible : (N,) the method balanced the wanted wrench within the limits; where lengths
        are commanded, the winches reached them and they hold the platform as commanded: at the
        step's end every cable is as long as its rope, to 1 mm and the largest stretch of one
    real_time_factor : simulated over elapsed time of the loop
    settings : how the run was made
    commanded_lengths : (N, m) the winches were to reach by the step's end, None where tensions
        are commanded [m]
    motor_torques, motor_speeds : (N, m) of the winches, speeds as the step begins; None where
        there are none or they are ideal [N m, rad/s]
    base_poses : (N, p, 3) x, y, heading of each mobile base, None where none was driven
        [m, m, rad]
    cut_short : '' or what ended it early, and carries it as ``.run``
    real : the world that flew, None where it is the world believed in
    estimates : Pose of batch (N,) as measured, and beside it estimated_twists, sensed_lengths,
        sensed_tensions (N, …): what was known as each step began, without sensors the truth
    """

    csv_rows: ClassVar[int] = 1
    """Of how many rows log.csv keeps one; log.npz has them all."""

    world: World
    task: str
    method: str
    cables: str
    time: Array
    poses: Pose
    twists: Array
    reference: Reference
    commanded_tensions: Array
    measured_tensions: Array
    lengths: Array
    errors: Array
    feasible: Any
    real_time_factor: float
    dt: float
    control_period: float
    settings: dict[str, Any] = field(repr=False)
    commanded_lengths: Array | None = None
    base_poses: Array | None = None
    cut_short: str = ""
    real: World | None = None
    motor_torques: Array | None = None
    motor_speeds: Array | None = None
    estimates: Pose = _AS_IT_WAS
    estimated_twists: Array = _AS_IT_WAS
    sensed_lengths: Array = _AS_IT_WAS
    sensed_tensions: Array = _AS_IT_WAS

    def __post_init__(self) -> None:
        known = {"estimates": self.poses, "estimated_twists": self.twists, "sensed_lengths": self.lengths,
                 "sensed_tensions": self.measured_tensions}
        for name, true in known.items():
            if getattr(self, name) is None:
                object.__setattr__(self, name, true)

    @classmethod
    def of(cls, flight: Flight, reference: Reference, *, world: World, at_end: bool = False, **about: Any) -> Self:
        """A run from what `fly` kept of it.

        reference : of batch (N,), or of more where the flight was cut short
        at_end : rows tell of each control step's end, not of its begin
        about : the fields that the log does not have
        """
        seen, steps = flight.seen, flight.steps
        rows = slice(1, None) if at_end else slice(steps)
        reference = reference.rows(slice(steps))
        poses = Pose.of(seen["position"][rows], seen["rotation"][rows])
        asked: Any = {name: flight.asked[name][:steps] for name in flight.asked.units}
        asked.setdefault("commanded_tensions", frozen(np.full((steps, world.robot.n_cables), np.nan)))
        feasible: Any = flight.feasible
        if "sensed_position" in seen:
            about |= {"estimates": Pose.of(seen["sensed_position"][rows], seen["sensed_rotation"][rows]),
                      "estimated_twists": seen["sensed_twist"][rows], "sensed_lengths": seen["sensed_lengths"][rows],
                      "sensed_tensions": seen["sensed_tensions"][rows]}
        if "driven_torques" in seen:
            about |= {"motor_torques": seen["driven_torques"][1:], "motor_speeds": seen["driven_speeds"][1:]}
            feasible = feasible & (seen["short"][1:] == 0)
        return cls(world=world, poses=poses, twists=seen["twist"][rows], reference=reference,
                   measured_tensions=seen["measured_tensions"][1:], lengths=seen["lengths"][rows],
                   errors=errors_of(world.robot, poses, reference.pose), feasible=frozen(feasible),
                   cut_short=flight.cut_short, **asked, **about)

    def row(self, index: int) -> int:
        """A control step, counted from the end where the index is negative; raises InvalidInput where there is none."""
        return as_count(index, "index", -len(self.time), len(self.time) - 1)

    def robot_at(self, index: int) -> Robot:
        """The robot with its bases where they stood at one control step."""
        robot, row = self.world.robot, self.row(index)
        if self.base_poses is None:
            return robot
        return robot.with_bases({base.name: pose for base, pose in zip(robot.bases, self.base_poses[row])})

    def boxes_at(self, index: int) -> tuple[tuple[Pose, Array], ...]:
        """Pose and size [m] of each loose box at one control step: a plain run has none."""
        self.row(index)
        return ()

    @property
    def position_errors(self) -> Array:
        """(N,) distance from the reference [m]."""
        d = min(self.world.robot.dimension, self.errors.shape[1])
        return np.linalg.norm(self.errors[:, :d], axis=1)

    def table(self) -> dict[str, str]:
        """The run in eight lines: quantity → value with unit."""
        wound, steps = self.commanded_lengths is not None, self.time.size
        if not steps:
            return {"cut short": self.cut_short}
        off, measured = self.position_errors, self.measured_tensions
        shown = measured if wound else self.commanded_tensions
        missed = f"{int((~self.feasible).sum())} of {steps}"
        if wound:
            kept = {"steps with a slack cable": f"{int((measured == 0).any(axis=1).sum())} of {steps}",
                    "steps not held as commanded": missed}
        else:
            kept = {"measured − commanded tension, RMS": f"{np.sqrt(np.mean((measured - shown)**2)):.2g} N",
                    "infeasible steps": missed}
        return {
            "tracking error, largest": f"{off.max() * 1e3:.3f} mm",
            "tracking error, final": f"{off[-1] * 1e3:.3f} mm",
            "tension, smallest": f"{shown.min():.1f} N (limit {self.world.robot.tension_min.min():g} N)",
            "tension, largest": f"{shown.max():.1f} N (limit {self.world.robot.tension_max.max():g} N)",
            **kept,
            "simulated time": f"{self.time[-1] + self.control_period:g} s",
            "real-time factor": f"{self.real_time_factor:.1f}",
            **({"cut short": self.cut_short} if self.cut_short else {}),
        }

    def __repr__(self) -> str:
        head = (f"{type(self).__name__}({self.world.name!r}, task {self.task}, {self.method}, "
                f"cables={self.cables}, {len(self.time)} steps)")
        rows = self.table().items() if len(self.time) else ()
        return "\n".join([head, *(f"  {quantity}: {value}" for quantity, value in rows)][:10])

    def to_frame(self) -> Any:
        """A row a control step, as a pandas DataFrame with the columns of log.csv."""
        return data_frame(flat_columns(self.columns()))

    def save(self, folder: str | Path) -> Path:
        """Write log.npz (named arrays and their units), log.csv, the world used and the settings.

        folder : made if missing, also for the real world
        """
        import json  # not above: all import cdprlab, few save a run

        target, columns = made_folder(folder), self.columns()
        arrays: dict[str, Any] = {name: values for name, (values, _) in columns.items()}
        units = {name: unit for name, (_, unit) in columns.items()}
        with replaced(target / "log.npz") as file:
            np.savez_compressed(file, units=np.array(json.dumps(units)), **arrays)
        write_csv(target / "log.csv", {name: (arrays[name][::self.csv_rows], units[name]) for name in units})
        self.world.save(target / "world.yaml")
        if self.real is not None:
            self.real.save(target / "real.yaml")
        settings = {"task": self.task, "method": self.method, "cables": self.cables, **self.settings}
        if self.cut_short:
            settings["cut_short"] = self.cut_short
        write_text(target / "settings.json", json.dumps(settings, indent=1) + "\n")
        return target

    def columns(self) -> dict[str, tuple[Any, str]]:
        """Name → array, unit of each log column group."""
        told = {name: (attrgetter(field)(self), unit) for name, (field, unit) in QUANTITIES.items()
                if self.estimates is not self.poses or not field.startswith(("estimate", "sensed"))}
        return {name: column for name, column in told.items() if column[0] is not None}
