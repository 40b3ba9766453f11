"""The border of a workspace in space: triangles where a field over a grid changes sign."""

from itertools import permutations

import numpy as np

from ..arrays import Array
from ..errors import InvalidInput
from .criterion import Judgement
from .grids import PoseGrid

_PATHS = tuple(permutations(range(3)))
"""Six tetrahedra of a cube, one for each way from its lowest corner to its highest along the edges."""

_CUTS = ((1, ((0, 1), (0, 2), (0, 3))), (3, ((0, 3), (1, 3), (2, 3))),
         (2, ((0, 2), (0, 3), (1, 3))), (2, ((0, 2), (1, 3), (1, 2))))
"""Triangles by the number of corners inside, which come first: the edges that each triangle's corners lie on."""


def border_triangles(grid: PoseGrid, judgement: Judgement) -> Array:
    """Triangles of the surface around the poses inside, closed at the grid's ends.

    Where margins are known the surface lies where they vanish by linear interpolation, else
    half-way.

    grid : with three axes; judgement : of its poses
    Returns (k, 3, 3) corners, counter-clockwise from outside [m].
    Raises InvalidInput for a grid that is no volume.
    Source: marching tetrahedra, Doi and Koide 1991.

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
    return np.concatenate([_tetrahedra(points, field, path) for path in _PATHS])


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


def _tetrahedra(points: Array, field: Array, path: tuple[int, ...]) -> Array:
    """Triangles in one of each cube's six tetrahedra."""
    corners = np.cumsum([np.zeros(3, dtype=int), *np.eye(3, dtype=int)[list(path)]], axis=0)
    n = np.array(field.shape) - 1
    parts = [tuple(slice(c[a], n[a] + c[a]) for a in range(3)) for c in corners]
    values = np.stack([field[part].ravel() for part in parts], axis=1)
    places = np.stack([points[part].reshape(-1, 3) for part in parts], axis=1)
    mixed = (values > 0).any(axis=1) & (values < 0).any(axis=1)
    values, places = values[mixed], places[mixed]
    order = np.argsort(-values, axis=1)
    values = np.take_along_axis(values, order, axis=1)
    places = np.take_along_axis(places, order[..., None], axis=1)
    count = (values > 0).sum(axis=1)
    found = []
    for above, edges in _CUTS:
        v, p = values[count == above], places[count == above]
        a, b = np.transpose(edges)
        share = v[:, a] / (v[:, a] - v[:, b])
        triangles = p[:, a] + share[..., None] * (p[:, b] - p[:, a])
        normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
        inward = (normals * (p[:, 3] - p[:, 0])).sum(axis=1) < 0
        triangles[inward] = triangles[inward][:, [0, 2, 1]]
        found.append(triangles)
    return np.concatenate(found)
