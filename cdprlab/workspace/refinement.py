"""Length, area or volume of a workspace with an error bound: cells the border runs through are split again."""

from itertools import product

import numpy as np

from ..arrays import Array, as_count, checked
from ..errors import InvalidInput
from ..robot import Robot
from .criterion import Criterion
from .grids import PoseGrid
from .sweep import workspace
from .workspace_cells import WorkspaceCells, halved

_MOST_CELLS = 2_000_000


@checked
def refine(robot: Robot, grid: PoseGrid, criterion: Criterion, levels: int = 3, *,
           n_jobs: int | None = None) -> WorkspaceCells:
    """Split the cells whose corners and center do not agree, level by level.

    levels : times a border cell is halved along each axis; every level halves the error about
    Returns WorkspaceCells over the grid's axes.
    Raises InvalidInput where that makes more cells than can be judged.

    >>> import cdprlab as cl
    >>> from cdprlab.workspace import position_grid, refine
    >>> robot = cl.load_world("planar_rigid").robot
    >>> found = refine(robot, position_grid([-1, 0.2], [1, 1.8], 0.2), cl.WrenchFeasible(), levels=1)
    >>> found.bounds[0] <= found.measure <= found.bounds[1]
    True
    """
    as_count(levels, "levels", 0, 30)
    lower, upper = (np.stack(np.meshgrid(*ends, indexing="ij"), axis=-1).reshape(-1, len(ends))
                    for ends in zip(*((at[:-1], at[1:]) for at in grid.axes.values())))
    k = len(grid.axes)
    judged = np.array([*product((0.0, 1.0), repeat=k), np.full(k, 0.5)])   # corners and center
    kept: list[tuple[Array, Array, Array]] = []
    for level in range(levels + 1):
        if len(lower) > _MOST_CELLS:
            raise InvalidInput(f"{len(lower)} cells at level {level}: take a coarser grid or fewer levels")
        points = (lower[:, None] + (upper - lower)[:, None] * judged).reshape(-1, k)
        # Points that cells share are judged once: those that differ by more than rounding, and
        # which of them each is.
        points, back = np.unique(np.round(points, 9), axis=0, return_inverse=True)
        inside = workspace(robot, grid.poses_at(points), criterion, margin=False, n_jobs=n_jobs).inside
        inside = inside[back.ravel()].reshape(-1, len(judged))
        verdict = np.asarray(1.0 * inside.all(axis=1) - ~inside.any(axis=1))
        done = (verdict != 0) | (level == levels)
        kept.append((lower[done], upper[done], verdict[done]))
        lower, upper = lower[~done], upper[~done]
        for axis in range(k):
            lower, upper = halved(lower, upper, axis)
    return WorkspaceCells(*map(np.concatenate, zip(*kept)))
