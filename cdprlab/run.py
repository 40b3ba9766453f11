"""The closed loop: reference, controller, tension distribution, engine; and the log of what happened."""

from __future__ import annotations

import csv
import json
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from struct import Struct
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .arrays import Array, as_array, as_number, frozen
from .control import ComputedTorque, Controller
from .errors import InfeasibleTensions, InvalidInput
from .geometry import cable_lengths
from .pose import Pose, rotation_vector
from .robot import Robot
from .simulate import Simulator, open_simulator
from .statics import wrench_matrix
from .tensions.distribution import TensionDistribution, checked_distribution, solver_for
from .trajectory import Reference
from .world import World

WOUND = ("length", "elastic")
"""Cable models that take lengths, not tensions: winches wind by inverse kinematics of the reference."""

INFEASIBLE = ("relax", "stop", "hold")
"""Where the method finds no tensions: take the least wrench error, raise, or keep the last tensions."""

Cuts = Mapping[float, ArrayLike]
"""Time [s] → the cables cut then, by index from 0."""

Progress = Callable[[int, int], Any]
"""``(steps done, steps in all)``, called about a hundred times in a run."""


@dataclass(frozen=True, eq=False)
class Run:
    """What happened: N control steps of a run, one row each.

    time : (N,) start of each control step [s]
    poses : Pose of batch (N,); twists (N, 3 or 6) [m/s, rad/s]
    reference : Reference of batch (N,)
    commanded_tensions : (N, m) held during the step, NaN where lengths are commanded [N]
    measured_tensions : (N, m) what the engine's cables carried at its end [N]
    lengths : (N, m) cable lengths [m]
    errors : (N, n) reference minus pose in the motion pattern's rows: position, rotation vector [m, rad]
    feasible : (N,) the method balanced the wanted wrench within the limits, or the winches reached their lengths
    real_time_factor : simulated over elapsed time of the loop
    settings : how the run was made
    commanded_lengths : (N, m) the winches were to reach by the step's end, None where tensions are commanded [m]
    base_poses : (N, p, 3) x, y, heading of each mobile base, None where none was driven [m, m, rad]
    """

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

    def robot_at(self, index: int) -> Robot:
        """The robot with its bases where they stood at one control step."""
        robot = self.world.robot
        if self.base_poses is None:
            return robot
        return robot.with_bases({base.name: pose for base, pose in zip(robot.bases, self.base_poses[index])})

    @property
    def position_errors(self) -> Array:
        """(N,) distance from the reference [m]."""
        d = min(self.world.robot.dimension, self.errors.shape[1])
        return np.linalg.norm(self.errors[:, :d], axis=1)

    def table(self) -> dict[str, str]:
        """The run in eight lines: quantity → value with unit."""
        wound, steps = self.commanded_lengths is not None, self.time.size
        off, measured = self.position_errors, self.measured_tensions
        shown = measured if wound else self.commanded_tensions
        missed = f"{int((~self.feasible).sum())} of {steps}"
        if wound:
            kept = {"steps with a slack cable": f"{int((measured == 0).any(axis=1).sum())} of {steps}",
                    "steps at a winch's speed limit": missed}
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
        }

    def save(self, folder: str | Path) -> Path:
        """Write log.npz (named arrays and their units), log.csv, the world used and the settings.

        folder : made if missing
        """
        target = Path(folder)
        target.mkdir(parents=True, exist_ok=True)
        columns = self._columns()
        units = {name: unit for name, (_, unit) in columns.items()}
        arrays: dict[str, Any] = {name: values for name, (values, _) in columns.items()}
        np.savez_compressed(target / "log.npz", units=np.array(json.dumps(units)), **arrays)
        write_csv(target / "log.csv", columns)
        self.world.save(target / "world.yaml")
        settings = {"task": self.task, "method": self.method, "cables": self.cables, **self.settings}
        (target / "settings.json").write_text(json.dumps(settings, indent=1) + "\n", encoding="utf-8")
        return target

    def _columns(self) -> dict[str, tuple[Array, str]]:
        """Name → array, unit of each log column group."""
        spatial = self.world.robot.dimension == 3

        def turn(pose: Pose) -> Array:
            return pose.rpy if spatial else np.asarray(pose.angle)[:, None]

        return {
            "time": (self.time, "s"),
            "position": (self.poses.position, "m"),
            "rotation": (turn(self.poses), "rad"),
            "twist": (self.twists, "m/s, rad/s"),
            "reference_position": (self.reference.pose.position, "m"),
            "reference_rotation": (turn(self.reference.pose), "rad"),
            "reference_twist": (self.reference.twist, "m/s, rad/s"),
            "error": (self.errors, "m, rad"),
            "commanded_tension": (self.commanded_tensions, "N"),
            "measured_tension": (self.measured_tensions, "N"),
            "length": (self.lengths, "m"),
            **({} if self.commanded_lengths is None else {"commanded_length": (self.commanded_lengths, "m")}),
            **({} if self.base_poses is None else {"base_pose": (self.base_poses, "m, m, rad")}),
            "feasible": (np.asarray(self.feasible), ""),
        }


def run(world: World, task: str = "default", method: str | Callable[..., Any] = "quadratic_program",
        cables: str = "tension", controller: Controller | None = None, dt: float = 1e-3,
        control_period: float | None = None, infeasible: str = "relax", external_wrench: Any = None,
        duration: float | None = None, seed: int = 0, *, base_speeds: Any = None, cut: Cuts | None = None,
        progress: Progress | None = None, simulator: Simulator | None = None, **engine_options: Any) -> Run:
    """Move a world's robot along a task in its engine and log every control step.

    world, task : what moves, and one of its tasks' names
    method : a tension method's name, or a callable (W, w_e, tension_min, tension_max) → tensions or TensionDistribution
    cables : "tension" (constraint cables under torque), "force" (ideal massless baseline) or "length" (winches pay
        ropes in and out by inverse kinematics of the reference; method, controller and infeasible then have no say)
    controller : (t, state, reference) → wrench the cables shall exert; default ComputedTorque(100, 100)
    dt, control_period : engine step and control step [s], the second a multiple of the first; default equal
    infeasible : "relax" (least wrench error inside the limits), "stop" (raise), "hold" (last tensions)
    external_wrench : (n,) at P or t → (n,), felt by the platform and not told to the controller [N, N m]
    duration : of the run; default the task's motion and hold [s]
    seed : kept with the log for whatever draws random numbers; the loop itself draws none
    base_speeds : (3p,) θ̇, ρ̇₁, ρ̇₂ of each mobile base or t → (3p,), driven while the cables work, clipped to the bases'
        limits; winches and tensions follow the bases; planar worlds [rad/s, m/s]
    cut : time [s] → cables cut then, by index from 0; methods know at once: limits 0 to 0, and a zero column of W
    progress : called as (steps done, steps in all), about a hundred times
    simulator : an open Simulator to use (and leave open) instead of a new one
    engine_options : passed to ``open_simulator``
    Raises InvalidInput; InfeasibleTensions with infeasible="stop"; SimulationDiverged.

    >>> import cdprlab as cl
    >>> cl.run(cl.load_world("nowhere"))
    Traceback (most recent call last):
    ...
    cdprlab.errors.WorldError: unknown world 'nowhere'; there are ...
    """
    job = world.task(task)
    if infeasible not in INFEASIBLE:
        raise InvalidInput(f"infeasible must be one of {', '.join(INFEASIBLE)}, got {infeasible!r}")
    substeps, period = _control_steps(dt, control_period)
    length = job.duration + job.hold if duration is None else as_number(duration, "duration", "s", positive=True)
    times: Array = np.arange(max(1, round(length / period)), dtype=float) * period
    if cables in WOUND and controller is not None:
        raise InvalidInput(f"cables={cables!r} winds by inverse kinematics and takes no controller")
    law = ComputedTorque() if controller is None else controller
    loop = _Loop(world.robot, method, infeasible, law, external_wrench, times.size)
    loop.drive = None if base_speeds is None else _Drive(base_speeds, period)
    loop.cuts = _cut_steps(cut or {}, world.robot.n_cables, times.size, period)
    engine = simulator or open_simulator(world, cables, dt, **engine_options)
    try:
        engine.reset(job.start)
        path = job.trajectory()
        if cables in WOUND:
            elapsed = loop.wind(engine, path(times), path(times + period), substeps, progress)
        else:
            elapsed = loop.fly(engine, path(times), substeps, progress)
    finally:
        if simulator is None:
            engine.close()
    name = method if isinstance(method, str) else getattr(method, "__name__", "own method")
    name, ruler = ("inverse_kinematics",) * 2 if cables in WOUND else (name, _describe(law))
    settings = {"dt": dt, "control_period": period, "controller": ruler, "infeasible": infeasible,
                "external_wrench": None if external_wrench is None else str(external_wrench),
                "duration": float(times.size * period), "seed": seed, **engine_options}
    if base_speeds is not None:
        settings["base_speeds"] = str(base_speeds)
    if cut:
        settings["cut"] = {float(at): np.ravel(indices).tolist() for at, indices in cut.items()}
    return loop.log(world, task, name, cables, times, times.size * period / elapsed, dt, period, settings)


class _Loop:
    """The state of one closed loop: buffers for its log, and the solver built for its limits."""

    def __init__(self, robot: Robot, method: Any, infeasible: str, controller: Controller,
                 external_wrench: Any, steps: int) -> None:
        self.robot, self.infeasible, self.controller = robot, infeasible, controller
        self.external_wrench = external_wrench
        self.chosen, self.method = method, method if isinstance(method, str) else ""
        self.cuts: dict[int, list[int]] = {}
        self.whole: Array | None = None
        self._limit(robot.tension_min, robot.tension_max)
        d, m = robot.dimension, robot.n_cables
        self.widths = (d, d * d, 3 if d == 2 else 6, robot.n_dof, m, m, m)
        self.table = np.empty((steps, sum(self.widths)))
        self.last: Array | None = None
        self.feasible: Any = None
        self.commanded_lengths: Array | None = None
        self.drive: _Drive | None = None

    def fly(self, engine: Simulator, reference: Reference, substeps: int, progress: Progress | None) -> float:
        """The loop itself; returns the elapsed time [s]."""
        self.reference = reference
        push = self.external_wrench
        if push is not None and not callable(push):
            engine.push(push)
        steps, table, concatenate = self.table.shape[0], self.table, np.concatenate
        every = max(1, steps // 100)
        began = time.perf_counter()
        for k, wish in enumerate(map(Reference, *reference)):
            if self.drive is not None:
                self.drive.step(engine)
            if k in self.cuts:
                self._cut(engine, k)
            state = engine.state()
            if callable(push):
                engine.push(push(state.time))
            wanted = np.asarray(self.controller(state.time, state, wish), dtype=np.float64)
            tensions = self._tensions(engine.wrench_matrix, wanted, state.time)
            lengths = engine.lengths
            engine.step(tensions, substeps)
            # One row of one table: kept as separate arrays, the log would push the loop out of the cache.
            concatenate((state.position, state.rotation.ravel(), state.twist, wanted, lengths, tensions,
                         engine.tensions), out=table[k])
            if progress is not None and ((k + 1) % every == 0 or k + 1 == steps):
                progress(k + 1, steps)
        return time.perf_counter() - began

    def wind(self, engine: Simulator, reference: Reference, ahead: Reference, substeps: int,
             progress: Progress | None) -> float:
        """The loop with winches: by each step's end, the lengths of where the platform should then be."""
        self.reference, push = reference, self.external_wrench
        if push is not None and not callable(push):
            engine.push(push)
        steps, period = self.table.shape[0], engine.dt * substeps
        sample, wind, every = engine.sample, engine.wind, max(1, steps // 100)
        began = time.perf_counter()
        start, m = list(sample()), self.robot.n_cables
        # Packed rows are the quickest log from Python numbers: lists and tuples would call the garbage collector.
        pack, log = Struct(f"{1 + m + len(start)}d").pack, []
        for k, lengths in enumerate(self._lengths(engine, ahead.pose)):
            if k in self.cuts:
                engine.cut(self.cuts[k])
            if callable(push):
                engine.push(push(k * period))
            log.append(pack(wind(lengths, substeps), *lengths, *sample()))
            if progress is not None and ((k + 1) % every == 0 or k + 1 == steps):
                progress(k + 1, steps)
        rows = np.frombuffer(b"".join(log)).reshape(steps, -1)
        elapsed = time.perf_counter() - began
        self.feasible, self.commanded_lengths = rows[:, 0] == 1, rows[:, 1:1 + m].copy()
        self._fill(np.vstack([start, rows[:, 1 + m:]]))
        return elapsed

    def _lengths(self, engine: Simulator, ahead: Pose) -> Iterator[list[float]]:
        """Rope lengths for each step's end; where bases drive, to where they will then stand."""
        if self.drive is None:
            return map(np.ndarray.tolist, cable_lengths(self.robot, ahead))
        return (cable_lengths(self.drive.step(engine), pose).tolist() for pose in ahead)

    def _fill(self, samples: Array) -> None:
        """The table from N + 1 samples: states as each step began, tensions as it ended, no wrench or tension asked."""
        m, states = self.robot.n_cables, sum(self.widths[:3])
        self.table[:] = np.nan
        self.table[:, :states] = samples[:-1, :states]
        self.table[:, states + self.widths[3]:][:, :m] = samples[:-1, states:states + m]
        self.table[:, -m:] = samples[1:, -m:]

    def _limit(self, low: Array, high: Array) -> None:
        self.low, self.high = low, high
        self.solve = self._solver(self.chosen, low, high)
        self.relax = solver_for("relaxed", self.robot.n_dof, low, high)

    def _cut(self, engine: Simulator, step: int) -> None:
        """Cut what is due, and leave the method nothing to ask of it."""
        engine.cut(self.cuts[step])
        self.whole = np.ones(self.robot.n_cables) if self.whole is None else self.whole.copy()
        self.whole[self.cuts[step]] = 0.0
        self._limit(self.low * self.whole, self.high * self.whole)
        if self.last is not None:
            self.last = self.last * self.whole

    def _tensions(self, W: Array, wanted: Array, now: float) -> Array:
        if self.last is None:
            wanted = as_array(wanted, "the controller's wrench", (self.robot.n_dof,), "N, N m")
        if self.whole is not None:
            W = W * self.whole  # the pseudo-inverse looks at no limits, but gives a zero column nothing
        tensions, reason = self.solve(W, -wanted)
        if self.whole is not None:
            tensions = tensions * self.whole  # what rounding leaves of nothing
        if not reason:
            self.last = tensions
            return tensions
        if not np.isfinite(wanted).all():
            raise InvalidInput(f"the controller asked for the wrench {wanted.tolist()} at t = {now:.4g} s; "
                               "it must be finite")
        if self.infeasible == "stop":
            raise InfeasibleTensions(f"at t = {now:.4g} s: {reason}; infeasible=\"relax\" goes on with the least "
                                     "wrench error inside the limits",
                                     self._judge(W, -wanted, tensions, reason, self.low, self.high))
        if self.infeasible == "relax" or self.last is None:
            self.last = self.relax(W, -wanted)[0]
        return self.last

    def _judge(self, W: Array, w_e: Array, tensions: Array, reasons: Any, low: Array,
               high: Array) -> TensionDistribution:
        low, high = (np.broadcast_to(limit, tensions.shape) for limit in (low, high))
        return checked_distribution(W, w_e, low, high, tensions, np.broadcast_to(np.array(reasons, dtype=object),
                                                                                tensions.shape[:-1]), self.method)

    def _limits(self) -> tuple[Array, Array]:
        """(N, m) smallest and largest tension of every step, (m,) where no cable was cut."""
        low, high = self.robot.tension_min, self.robot.tension_max
        if not self.cuts:
            return low, high
        whole = np.ones((self.table.shape[0], low.size))
        for step, indices in self.cuts.items():
            whole[step:, indices] = 0.0
        return low * whole, high * whole

    def _solver(self, method: Any, low: Array, high: Array) -> Callable[[Array, Array], tuple[Array, str]]:
        robot = self.robot
        if isinstance(method, str):
            return solver_for(method, robot.n_dof, low, high)

        def own(W: Array, w_e: Array) -> tuple[Array, str]:
            answer = method(W, w_e, low, high)
            if isinstance(answer, TensionDistribution):
                return answer.tensions, str(answer.reason)
            tensions = np.array(answer, float)  # a copy: the method may use its array again
            usable = tensions.shape == (robot.n_cables,) and bool(np.isfinite(tensions).all())
            return tensions, "" if usable else f"the method gave no {robot.n_cables} finite tensions"

        return own

    def log(self, world: World, task: str, method: str, cables: str, times: Array, factor: float, dt: float,
            period: float, settings: dict[str, Any]) -> Run:
        columns = [frozen(np.ascontiguousarray(part))
                   for part in np.split(self.table, np.cumsum(self.widths)[:-1], axis=1)]
        positions, rotations, twists, wrenches, lengths, commanded, measured = columns
        d = world.robot.dimension
        poses = Pose.of(positions, rotations.reshape(-1, d, d))
        if self.feasible is None:
            # Judged by the law for the whole run at once: equilibrium with the wanted wrench, and the limits.
            W = wrench_matrix(world.robot, poses) if self.drive is None else np.array(self.drive.matrices)
            self.feasible = self._judge(W, -wrenches, commanded, "", *self._limits()).feasible
        return Run(world, task, method, cables, frozen(times), poses, twists, self.reference, commanded, measured,
                   lengths, _errors(world.robot, poses, self.reference.pose), self.feasible, factor, dt, period,
                   settings, None if self.commanded_lengths is None else frozen(self.commanded_lengths),
                   None if self.drive is None else frozen(np.array(self.drive.poses)))


class _Drive:
    """Mobile bases driven during a run: their speeds, asked for at each step, and what the log keeps of them.

    speeds : (3p,) or t → (3p,); period : control step [s]
    """

    def __init__(self, speeds: Any, period: float) -> None:
        self.speeds, self.period = speeds, period
        self.poses: list[Any] = []
        self.matrices: list[Array] = []

    def step(self, engine: Simulator) -> Robot:
        """Set the coming step's speeds; returns the robot with its bases where they will be at the step's end."""
        now = len(self.poses) * self.period
        driven = engine.drive(self.speeds(now) if callable(self.speeds) else self.speeds).reshape(-1, 3)
        robot = engine.robot
        self.poses.append([[*base.position.tolist(), base.heading] for base in robot.bases])
        self.matrices.append(engine.wrench_matrix)
        return robot.with_bases({
            base.name: (*(base.position + base.rotation[:2, :2] @ speed[1:] * self.period),
                        base.heading + speed[0] * self.period) for base, speed in zip(robot.bases, driven)})


def _errors(robot: Robot, poses: Pose, wanted: Pose) -> Array:
    """(N, n) reference minus pose in the motion pattern's rows."""
    turn = rotation_vector(wanted.rotation @ np.swapaxes(poses.rotation, -1, -2))
    full = np.concatenate([wanted.position - poses.position, turn], axis=-1)
    return frozen((full[..., None, :] @ robot.pattern.basis(poses.rotation))[..., 0, :])


def _control_steps(dt: float, control_period: float | None) -> tuple[int, float]:
    step = as_number(dt, "dt", "s", positive=True)
    period = step if control_period is None else as_number(control_period, "control_period", "s", positive=True)
    substeps = round(period / step)
    if substeps < 1 or abs(substeps * step - period) > 1e-9 * period:
        raise InvalidInput(f"control_period must be a whole multiple of dt, got {period:g} s and {step:g} s")
    return substeps, substeps * step


def _cut_steps(cut: Cuts, m: int, steps: int, period: float) -> dict[int, list[int]]:
    """Control step → the cables cut as it begins."""
    due: dict[int, list[int]] = {}
    for moment, cables in cut.items():
        at = as_number(moment, "the time of a cut", "s")
        step = int(np.ceil(at / period - 1e-9))
        if not 0 <= step < steps:
            raise InvalidInput(f"a cut must fall within the run, 0 to {steps * period:g} s, got {at:g} s")
        due.setdefault(step, []).extend(_indices(cables, m))
    return due


def _indices(cables: ArrayLike, m: int) -> list[int]:
    given = np.atleast_1d(np.asarray(cables)).ravel().tolist()
    if any(isinstance(i, bool) or not isinstance(i, int) or not 0 <= i < m for i in given):
        raise InvalidInput(f"cables to cut are given by index, 0 to {m - 1}, got {given}")
    return given


def _describe(controller: Any) -> str:
    if isinstance(controller, ComputedTorque):
        return f"ComputedTorque(kp={np.asarray(controller.kp).tolist()}, kd={np.asarray(controller.kd).tolist()})"
    return getattr(controller, "__name__", type(controller).__name__)


def write_csv(path: Path, columns: dict[str, tuple[Array, str]]) -> None:
    """One row a step; column groups of several values get numbers, counted from 1, and their unit."""
    blocks = {name: (values.reshape(values.shape[0], -1), unit) for name, (values, unit) in columns.items()}
    header = []
    for name, (values, unit) in blocks.items():
        suffix = f" [{unit}]" if unit else ""
        numbers = [""] if values.shape[1] == 1 else [f"_{i + 1}" for i in range(values.shape[1])]
        header += [f"{name}{number}{suffix}" for number in numbers]
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(header)
        table = np.concatenate([values.astype(float) for values, _ in blocks.values()], axis=1)
        writer.writerows([f"{value:.9g}" for value in row] for row in table.tolist())
