"""Length, area or volume of a workspace with an error bound: cells the border runs through are split again."""

from dataclasses import dataclass
from itertools import product

import numpy as np

from ..arrays import Array, Flags, Progress, checked, lasting
from ..errors import InvalidInput
from ..robot import Robot
from .criterion import Criterion
from .grids import PoseGrid
from .sweep import workspace

_MOST_CELLS = 2_000_000


@lasting
@dataclass(frozen=True, eq=False)
class RefinedWorkspace:
    """Cells of a grid, those on the border halved again and again.

    axes : the axes' names
    lower, upper : (N, k) corners of the cells [m]
    inside, border : (N,) every judged point of the cell is inside; some are and some are not
    """

    axes: tuple[str, ...]
    lower: Array
    upper: Array
    inside: Flags
    border: Flags

    @property
    def bounds(self) -> tuple[float, float]:
        """Least and largest measure: without and with the border's cells [m, m², m³].

        They hold for a workspace without details smaller than the first grid's cells; `certify`
        asks for nothing.
        """
        sizes = np.prod(self.upper - self.lower, axis=1)
        least = float(sizes[self.inside].sum())
        return least, least + float(sizes[self.border].sum())

    @property
    def measure(self) -> float:
        """Middle of the bounds [m, m², m³]."""
        return sum(self.bounds) / 2

    @property
    def error(self) -> float:
        """Half of what lies between the bounds."""
        return (self.bounds[1] - self.bounds[0]) / 2


@checked
def refine(robot: Robot, grid: PoseGrid, criterion: Criterion, levels: int = 3, *,
           n_jobs: int | None = None,
           progress: Progress | None = None) -> RefinedWorkspace:
    """Split the cells whose corners and center do not agree, level by level.

    levels : times a border cell is halved along each axis; every level halves the error about
    progress : called with (levels done, levels in all)
    Raises InvalidInput where that makes more cells than can be judged.

    >>> import cdprlab as cl
    >>> from cdprlab.workspace import position_grid, refine
    >>> robot = cl.load_world("planar_rigid").robot
    >>> found = refine(robot, position_grid([-1, 0.2], [1, 1.8], 0.2), cl.WrenchFeasible(), levels=1)
    >>> found.bounds[0] <= found.measure <= found.bounds[1]
    True
    """
    lower, upper = (np.stack([part.ravel() for part in np.meshgrid(*ends, indexing="ij")], axis=1)
                    for ends in ([at[:-1] for at in grid.axes.values()],
                                 [at[1:] for at in grid.axes.values()]))
    kept: list[tuple[Array, Array, Flags, Flags]] = []
    for level in range(levels + 1):
        if len(lower) > _MOST_CELLS:
            raise InvalidInput(f"{len(lower)} cells at level {level}: take a coarser grid or fewer levels")
        share = _share_inside(robot, grid, criterion, lower, upper, n_jobs)
        border = (share > 0) & (share < 1)
        done = ~border if level < levels else np.ones(len(lower), dtype=bool)
        kept.append((lower[done], upper[done], share[done] == 1, border[done]))
        lower, upper = _halved(lower[~done], upper[~done])
        if progress is not None:
            progress(level + 1, levels + 1)
    joined = [np.concatenate(parts) for parts in zip(*kept)]
    return RefinedWorkspace(tuple(grid.axes), joined[0], joined[1], joined[2], joined[3])


def _halved(lower: Array, upper: Array) -> tuple[Array, Array]:
    size = (upper - lower) / 2
    parts = [lower + size * np.array(which) for which in product((0, 1), repeat=lower.shape[1])]
    low = np.concatenate(parts)
    return low, low + np.tile(size, (len(parts), 1))


def _share_inside(robot: Robot, grid: PoseGrid, criterion: Criterion, lower: Array,
                  upper: Array,
                  n_jobs: int | None) -> Array:
    """Of each cell's corners and center; points that cells share are judged once."""
    k = lower.shape[1]
    if not len(lower):
        return np.zeros(0)
    places = [np.array(which) for which in product((0.0, 1.0), repeat=k)] + [np.full(k, 0.5)]
    points = np.stack([lower + (upper - lower) * at for at in places], axis=1)
    # Points that differ by more than rounding, and which of them each point is.
    flat = points.reshape(-1, k)
    _, first, back = np.unique(np.round(flat, 9), axis=0, return_index=True,
                               return_inverse=True)
    inside = workspace(robot, grid.poses_at(flat[first]), criterion, margin=False, n_jobs=n_jobs).inside
    return inside[back.ravel()].reshape(len(lower), -1).mean(axis=1)
