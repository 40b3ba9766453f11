"""The border of a workspace in space: triangles where a field over a grid changes sign."""

import numpy as np

from ..arrays import Array
from ..errors import InvalidInput
from .criterion import Judgement
from .grids import PoseGrid

_AROUND = np.array([[0, 0, 0], [0, 1, 0], [0, 1, 1], [0, 0, 1]])
"""From an edge along x to the four cells around it, in order, backwards."""


def border_triangles(grid: PoseGrid, judgement: Judgement) -> Array:
    """Triangles of the surface around the poses inside, closed at the grid's ends.

    It crosses the grid's edges where margins vanish by linear interpolation, without them
    half-way, and in each cell has a corner amid the crossings with its edges.

    grid : with three axes; judgement : of its poses
    Returns (k, 3, 3) corners, counter-clockwise from outside [m].
    Raises InvalidInput for a grid that is no volume.
    Source: Gibson 1998 (surface nets).

    >>> from cdprlab.workspace import position_grid
    >>> grid = position_grid([0, 0, 0], [1, 1, 1], 0.5)
    >>> everything = Judgement(np.ones(27, dtype=bool), np.full(27, np.nan))
    >>> triangles = border_triangles(grid, everything)
    >>> normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    >>> float(((triangles[:, 0] * normals).sum() / 6).round(2))   # volume, by the divergence theorem
    1.0
    """
    if len(grid.axes) != 3:
        raise InvalidInput(f"a surface needs a grid over x, y and z, this one is over {', '.join(grid.axes)}")
    field = np.pad(grid.field(signed(judgement)), 1, constant_values=-1.0)
    places = [np.concatenate([axis[:1] - 1e-6 * step, axis, axis[-1:] + 1e-6 * step])
              for axis, step in zip(grid.axes.values(), grid.step)]
    points = np.stack(np.meshgrid(*places, indexing="ij"), axis=-1)
    crossed = np.zeros((*field.shape, 4))   # of each cell the sum of its crossings, and how many there are
    tips, cells = [], []
    for axis in range(3):
        edges = np.argwhere(np.diff(field > 0, axis=axis))
        low, high = tuple(edges.T), tuple((edges + np.eye(3, dtype=int)[axis]).T)
        share = field[low] / (field[low] - field[high])
        crossings = points[low] + share[:, None] * (points[high] - points[low])
        around = edges[:, None] - np.roll(_AROUND, axis, axis=1)
        np.add.at(crossed, tuple(around.T), np.pad(crossings, ((0, 0), (0, 1)), constant_values=1.0))
        enters = field[low] < 0
        around[enters] = around[enters, ::-1]
        tips.append(crossings)
        cells.append(around)
    sums = crossed[tuple(np.concatenate(cells).T)].swapaxes(0, 1)
    corners = sums[..., :3] / sums[..., 3:]
    middles = np.broadcast_to(np.concatenate(tips)[:, None], corners.shape)
    return np.stack([middles, corners, np.roll(corners, -1, axis=1)], axis=2).reshape(-1, 3, 3)


def signed(judgement: Judgement) -> Array:
    """A field that is positive inside and negative outside: margins, or ±1 where there are none."""
    plain = np.where(judgement.inside, 1.0, -1.0)
    finite = np.isfinite(judgement.margin)
    size = np.abs(judgement.margin[finite]).max(initial=0.0)
    if not finite.any() or size == 0:
        return plain
    least = 1e-9 * size   # a margin that rounding took to the other side
    margins = np.where(finite, judgement.margin / size, plain)
    return np.where(judgement.inside, np.maximum(margins, least), np.minimum(margins, -least))
