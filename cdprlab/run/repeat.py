"""The same task many times: by robots that differ (accuracy), or by one whose sensors' noise does (repeatability)."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from inspect import signature
from pathlib import Path
from typing import Any

import numpy as np

from ..arrays import Array, Flags, Progress, as_count, checked, data_frame, frozen, lasting, seeds
from ..errors import InvalidInput, Recording, SimulationDiverged, quoted
from ..workspace.checkpoint import Checkpoint
from ..workspace.sweep import over_cores
from ..world import World
from ..world.perturbation import perturbed
from .log import flat_columns
from .sensors import Sensors
from .start import run

SLACK = 0.01
"""[N] a cable that carries no more hangs: what a leg's tip weighs in the engine stays below."""


@lasting
@dataclass(frozen=True, eq=False)
class Repetition:
    """How k runs of one task fared, one row each; NaN where a run diverged.

    final_errors : (k, n) reference minus pose in the end [m, rad]
    largest_errors : (k,) farthest from the reference on the way [m]
    smallest_tensions, largest_tensions : (k, m) measured [N]
    slack, overstretched : (k,) whether a cable ever hung, or carried more than its limit
    cut_short : '' or what ended it before all runs had been flown
    """

    world: World = field(repr=False)
    final_errors: Array
    largest_errors: Array
    smallest_tensions: Array
    largest_tensions: Array
    slack: Flags
    overstretched: Flags
    cut_short: str = ""

    @property
    def mean(self) -> Array:
        """(n,) of the final errors [m, rad]."""
        return np.nanmean(self.final_errors, axis=0)

    @property
    def spread(self) -> Array:
        """(n,) standard deviation of the final errors [m, rad]."""
        return np.nanstd(self.final_errors, axis=0, ddof=min(1, len(self.slack) - 1))

    @property
    def smallest_tension(self) -> float:
        """Of all cables and runs [N]."""
        return float(np.nanmin(self.smallest_tensions))

    @property
    def largest_tension(self) -> float:
        """Of all cables and runs [N]."""
        return float(np.nanmax(self.largest_tensions))

    @property
    def slack_share(self) -> float:
        """Of the runs, those in which a cable hung slack."""
        return float(self.slack.mean())

    @property
    def overstretched_share(self) -> float:
        """Of the runs, those in which a cable carried more than its limit."""
        return float(self.overstretched.mean())

    def table(self) -> dict[str, str]:
        """Quantity → value with unit."""
        d = min(self.world.robot.dimension, self.final_errors.shape[1])
        words = {}
        for name, values in (("mean", self.mean), ("spread", self.spread)):
            milli = [f"{1e3 * value:.3f}" for value in values]
            words[f"final position error, {name}"] = f"{', '.join(milli[:d])} mm"
            if milli[d:]:
                words[f"final rotation error, {name}"] = f"{', '.join(milli[d:])} mrad"
        return words | {
            "tracking error, largest": f"{1e3 * np.nanmax(self.largest_errors):.3f} mm",
            "tensions": f"{self.smallest_tension:.1f} to {self.largest_tension:.1f} N",
            "runs with a slack cable": f"{int(self.slack.sum())} of {len(self.slack)}",
            "runs with an overstretched cable": f"{int(self.overstretched.sum())} of {len(self.slack)}",
            **({"cut short": self.cut_short} if self.cut_short else {})}

    def to_frame(self) -> Any:
        """A row a run, as a pandas DataFrame."""
        return data_frame(flat_columns({name.removesuffix("s"): (getattr(self, name), unit)
                                        for name, unit in _COLUMNS.items()}))

    def __repr__(self) -> str:
        head = f"Repetition({self.world.name!r}, {len(self.slack)} runs)"
        return "\n".join([head, *(f"  {quantity}: {value}" for quantity, value in self.table().items())])


@checked
def repeat(world: World, runs: int, task: str = "default", *,
           errors: Mapping[str, float] | None = None, real: World | None = None,
           sensors: Sensors | None = None, seed: int = 0, n_jobs: int | None = None,
           checkpoint: str | Path | None = None, progress: Progress | None = None,
           **how: Any) -> Repetition:
    """Run a task many times; what is drawn anew differs from run to run.

    world, task : as `run` takes them; runs : how many
    errors : accuracy: a new robot each run, drawn by `perturbed` within these sizes
    real : repeatability: one robot, each run with new noise of its sensors
    sensors : their noise is new each run; default the truth
    seed : of all that is drawn
    n_jobs, checkpoint : processes, and a folder that keeps finished runs, as `workspace` takes them
    progress : called as (runs done, runs in all)
    how : what else `run` takes
    Raises InvalidInput unless either errors or real is given; what `run` raises, but a run that
    diverges is one of the results. What ends it early carries, as ``.run``, what was found until then; in the first
    run, what was flown.

    >>> import cdprlab as cl
    >>> found = repeat(cl.load_world("planar_point"), 2, errors={"mass": 0.1}, duration=0.1)
    >>> found.final_errors.shape, found.slack_share
    ((2, 2), 0.0)
    """
    as_count(runs, "runs")
    if (errors is None) == (real is None):
        raise InvalidInput("give either errors={...}, a new robot each run, or real=..., one robot with new noise")
    sizes: dict[str, Any] = {**(errors or {})}
    if not {*sizes} <= {*signature(perturbed).parameters} - {"world", "seed"}:
        raise InvalidInput(f"errors must be sizes as `perturbed` takes them, got {quoted(sizes)}")
    drawn = seeds(seed, runs)
    calls = [(world, task, real or perturbed(world, **sizes, seed=one), sensors and replace(sensors, seed=one), how)
             for one in drawn]
    kept = Checkpoint(checkpoint, "repeat", world, task, errors, real, sensors, how) if checkpoint is not None else None
    rows = {k: row for k, one in enumerate(drawn) if kept and (row := kept.load(one))}
    waiting = [k for k in range(runs) if k not in rows]

    def found(cut_short: str = "", flown: Any = None) -> Any:
        columns: dict[str, Any] = {name: frozen(np.array([rows[k][name] for k in sorted(rows)])) for name in _COLUMNS}
        return Repetition(world, **columns, cut_short=cut_short) if rows else flown

    with Recording(found):
        # The answers first: a generator of joblib's that is not asked to its end complains.
        for row, k in zip(over_cores(_flown, (calls[k] for k in waiting), n_jobs), waiting):
            rows[k] = row
            if kept:
                kept.save(drawn[k], **row)
            if progress is not None:
                progress(len(rows), runs)
        return found()


_COLUMNS = {"final_errors": "m, rad", "largest_errors": "m", "smallest_tensions": "N", "largest_tensions": "N",
            "slack": "", "overstretched": ""}


def _flown(world: World, task: str, real: World, sensors: Sensors | None, how: dict[str, Any]) -> dict[str, Any]:
    robot = world.robot
    try:
        flown = run(world, task, real=real, sensors=sensors, **how)
    except SimulationDiverged:
        nothing = np.full(robot.n_cables, np.nan)
        return dict(zip(_COLUMNS, (np.full(robot.n_dof, np.nan), np.nan, nothing, nothing, True, True)))
    low, high = flown.measured_tensions.min(axis=0), flown.measured_tensions.max(axis=0)
    return dict(zip(_COLUMNS, (flown.errors[-1], flown.position_errors.max(), low, high, (low <= SLACK).any(),
                               (high > robot.tension_max * (1 + 1e-6)).any())))
