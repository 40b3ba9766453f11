"""Tension distributions side by side along one task: smoothness, effort, distance to the limits, time."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Annotated, Any, ClassVar

import numpy as np

from ..arrays import Array, Progress, as_count, checked, data_frame, frozen, lasting
from ..errors import InvalidInput
from ..mechanics.dynamics import inverse_dynamics
from ..mechanics.statics import wrench_matrix
from ..mechanics.trajectory import Trajectory
from ..robot import Robot
from ..tensions import checked_distribution, solver_for, tension_methods
from ..tensions.method import Solver
from ..world import World
from .log import text_table

_FINER = 20
"""Parts the largest step is cut into: a jump stays whole, a steep slope falls to a twentieth of it."""


@lasting
@dataclass(frozen=True, eq=False)
class TensionComparison:
    """One row a method; columns are arrays (k,), taken over the samples where the method is feasible.

    method : names
    feasible_share : part of the samples
    smallest, largest : tension [N]
    energy : ∫ ‖τ‖² dt [N² s]
    largest_step : largest change of one tension from one sample to the next [N]
    continuous : whether that change shrinks when sampled more finely
    margin : smallest distance to a limit [N]
    solve_time : median of one solve, as the control loop calls it [s]

    Beside the table what it was made of: time (N,) [s], tensions (k, N, m) [N],
    feasible (k, N).
    """

    world: World
    task: str
    method: tuple[str, ...]
    feasible_share: Array
    smallest: Array
    largest: Array
    energy: Array
    largest_step: Array
    continuous: Any
    margin: Array
    solve_time: Array
    time: Array = field(repr=False)
    tensions: Array = field(repr=False)
    feasible: Any = field(repr=False)

    COLUMNS: ClassVar[dict[str, str]] = {
        "method": "", "feasible_share": "", "smallest": "N", "largest": "N", "energy": "N² s",
        "largest_step": "N",
        "continuous": "", "margin": "N", "solve_time": "s"}
    """Column → unit."""

    def rows(self) -> list[dict[str, Any]]:
        """One dictionary a method, keys as the columns."""
        return [{name: getattr(self, name)[k] for name in self.COLUMNS}
                for k in range(len(self.method))]

    def to_frame(self) -> Any:
        """A row a method, as a pandas DataFrame."""
        return data_frame({name: getattr(self, name) for name in self.COLUMNS})

    def lines(self) -> list[tuple[str, ...]]:
        """The table in words: its head, then a line a method."""
        lines: list[tuple[str, ...]] = [("method", "feasible", "τ min [N]", "τ max [N]", "∫‖τ‖² [N² s]", "step [N]",
                                         "continuous", "margin [N]", "solve [µs]")]
        for row in self.rows():
            *numbers, margin = [f"{row[name]:.4g}".replace("nan", "–") for name in
                                ("smallest", "largest", "energy", "largest_step", "margin")]
            continuous = ("yes" if row["continuous"] else "no") if row["feasible_share"] else "–"
            lines.append((row["method"], f"{100 * row['feasible_share']:.0f} %", *numbers, continuous, margin,
                          f"{1e6 * row['solve_time']:.1f}"))
        return lines

    def __str__(self) -> str:
        head, *rows = self.lines()
        return text_table(head, rows)

    __repr__ = __str__


@checked
def compare_tensions(world: World, task: str = "default",
                     methods: str | Sequence[str] | None = None, *,
                     time_step: Annotated[float, "[s] > 0"] | None = None,
                     progress: Progress | None = None) -> TensionComparison:
    """Each method's tensions for W τ = M a + C v − f_g along a task's reference, without an engine.

    world, task : what moves, and one of its tasks' names
    methods : names; default all that apply to this robot's number of redundant cables
    time_step : between samples [s]; default 400 of them
    progress : called as (methods done, methods in all)
    Raises InvalidInput for unknown names or a time step that is not positive.
    Source: the comparison of Okoli 2016, ch. 6, on the same path for all.

    >>> import cdprlab as cl
    >>> table = compare_tensions(cl.load_world("caroca"), methods=["quadratic_program", "pseudo_inverse"])
    >>> table.method, table.tensions.shape
    (('quadratic_program', 'pseudo_inverse'), (2, 401, 8))
    """
    job, robot = world.task(task), world.robot
    step = job.duration / 400 if time_step is None else time_step
    redundancy = robot.n_cables - robot.n_dof
    fits = {"kernel": redundancy == 1, "barycenter": redundancy <= 2}
    names = [name for name in tension_methods() if fits.get(name, True)]
    if methods is not None:
        names = [methods] if isinstance(methods, str) else list(methods)
    if not names:
        raise InvalidInput(f"methods must name at least one of {', '.join(tension_methods())}, got none")
    count = as_count(round(job.duration / step) + 1, "duration / time_step")
    times = np.linspace(0.0, job.duration, max(2, count))
    path = job.trajectory()
    W, w_e = _wrenches(robot, path, times)
    found = []
    for name in names:
        found.append(_follow(robot, path, times, W, w_e, name))
        if progress is not None:
            progress(len(found), len(names))
    columns = {name: frozen(np.array([entry[name] for entry in found])) for name in found[0]}
    return TensionComparison(world, task, tuple(names), time=frozen(times), **columns)


def _wrenches(robot: Robot, path: Trajectory, times: Array) -> tuple[Array, Array]:
    pose, twists, accelerations = path(times)
    wanted = [inverse_dynamics(robot, *motion) for motion in zip(pose.rotation, twists, accelerations)]
    return np.ascontiguousarray(wrench_matrix(robot, pose)), -np.array(wanted)


def _follow(robot: Robot, path: Trajectory, times: Array, W: Array, w_e: Array, name: str) -> dict[str, Any]:
    """One method's row, its tensions and where they are feasible."""
    low, high = robot.tension_min, robot.tension_max
    solve = solver_for(name, robot.n_dof, low, high)
    solve(W[0], w_e[0])   # what is compiled or imported at first use is no part of a solve
    tensions, moments = [], [time.perf_counter()]
    for problem in zip(W, w_e):
        tensions.append(solve(*problem)[0])
        moments.append(time.perf_counter())
    judged = checked_distribution(W, w_e, low, high, np.array(tensions), "", name)
    good = judged.feasible
    row = {"feasible_share": good.mean(), "solve_time": np.median(np.diff(moments)), "tensions": judged.tensions,
           "feasible": good}
    if not good.any():
        return row | dict.fromkeys(("smallest", "largest", "energy", "largest_step", "margin"), np.nan) | {
            "continuous": False}
    steps = np.where(good[1:] & good[:-1], np.abs(np.diff(judged.tensions, axis=0)).max(axis=1), 0.0)
    at, used = int(steps.argmax()), judged.tensions[good]
    return row | {"smallest": used.min(), "largest": used.max(), "margin": judged.margin[good].min(),
                  "energy": np.trapezoid(np.where(good, (judged.tensions**2).sum(axis=1), 0.0), times),
                  "largest_step": steps[at],
                  "continuous": step_shrinks(robot, path, times[at:at + 2], solve, steps[at])}


def step_shrinks(robot: Robot, path: Trajectory, span: Array, solve: Solver, step: float) -> bool:
    """Whether the largest step of a method's tensions within a span of time falls when sampled more finely."""
    problems = zip(*_wrenches(robot, path, np.linspace(span[0], span[1], _FINER + 1)))
    steps = np.diff([solve(W, w_e)[0] for W, w_e in problems], axis=0)
    return bool(np.abs(steps).max() <= max(0.5 * step, 1e-6 * robot.tension_max.max()))
