"""A canvas in numpy with a depth buffer, a perspective that fits, and the solids and lines drawn on it.

Whatever is drawn, the nearer surface wins; flat shading tells the faces of a solid apart.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array

Color = tuple[int, int, int]
Picture = NDArray[np.uint8]

PAPER: Color = (255, 255, 255)

BOX_CORNERS = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
BOX_FACES = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])
BOX_EDGES = np.array([[0, 1], [2, 3], [4, 5], [6, 7], [0, 2], [1, 3], [4, 6], [5, 7], [0, 4], [1, 5], [2, 6], [3, 7]])
"""Of a box of size 1: its corners, and which of them make a face and an edge."""

_FOCAL = 1.9
_SUN = np.array([0.45, -0.65, 1.0]) / np.linalg.norm([0.45, -0.65, 1.0])
_EYE_DIRECTION = np.array([0.55, -1.0, 0.48]) / np.linalg.norm([0.55, -1.0, 0.48])


class View(NamedTuple):
    """A perspective: axes (rows right, up, forward), the eye and the size of the picture."""

    axes: Array
    eye: Array
    width: int
    height: int

    def pixels(self, points: Array) -> tuple[Array, Array]:
        """(…, 2) pixels and (…) inverse depth [1/m], negative behind the eye."""
        local = (points - self.eye) @ self.axes.T
        inverse = 1 / np.where(np.abs(local[..., 2]) < 1e-9, 1e-9, local[..., 2])
        scale = _FOCAL * min(self.width, self.height)
        x = self.width / 2 + scale * local[..., 0] * inverse
        y = self.height / 2 - scale * local[..., 1] * inverse
        return np.stack([x, y], axis=-1), inverse


class Canvas:
    """Colors and inverse depths; the nearer surface wins."""

    def __init__(self, width: int, height: int) -> None:
        self.colors = np.full((height, width, 3), PAPER, dtype=np.uint8)
        self.nearness = np.zeros((height, width), dtype=np.float32)

    def copy(self) -> Canvas:
        """Another with the same drawn on it."""
        other = object.__new__(Canvas)
        other.colors, other.nearness = self.colors.copy(), self.nearness.copy()
        return other

    def polygon(self, pixels: Array, inverse: Array, color: Any, bias: float = 1.0) -> None:
        """Fill a convex polygon; ``bias`` above 1 brings it nearer, so that lines win over their own surface."""
        if inverse.min() <= 0 or abs(_area(pixels)) < 1e-6:  # behind the eye, or seen edge-on
            return
        height, width = self.nearness.shape
        (x0, y0), (x1, y1) = (np.clip(f, 0, (width, height)).astype(int)
                              for f in (np.floor(pixels.min(axis=0)), np.ceil(pixels.max(axis=0)) + 1))
        if x0 >= x1 or y0 >= y1:
            return
        x, y = np.arange(x0, x1) + 0.5, np.arange(y0, y1)[:, None] + 0.5
        near = (_plane(pixels, inverse, x, y) * bias).astype(np.float32)
        seen = _inside(pixels, x, y) & (near > self.nearness[y0:y1, x0:x1])
        self.nearness[y0:y1, x0:x1][seen] = near[seen]
        self.colors[y0:y1, x0:x1][seen] = color

    def picture(self, factor: int) -> Picture:
        """Averaged over squares of ``factor`` × ``factor`` pixels."""
        height, width = (n // factor for n in self.nearness.shape)
        total = np.zeros((height, width, 3), dtype=np.uint16)
        for offset in range(factor**2):
            total += self.colors[offset // factor::factor, offset % factor::factor]
        return ((total + factor**2 // 2) // factor**2).astype(np.uint8)


def _inside(pixels: Array, x: Array, y: Array) -> NDArray[np.bool_]:
    following, area = np.roll(pixels, -1, axis=0), _area(pixels)
    inside = np.ones(np.broadcast_shapes(x.shape, y.shape), dtype=bool)
    for (ax, ay), (bx, by) in zip(pixels, following):
        inside &= ((bx - ax) * (y - ay) - (by - ay) * (x - ax)) * area >= 0
    return inside


def _area(pixels: Array) -> float:
    x, y = (pixels - pixels[0]).T
    return float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum() / 2)


def _plane(pixels: Array, inverse: Array, x: Array, y: Array) -> Array:
    # Inverse depth of a flat surface is affine in the pixels, whatever the polygon.
    center = pixels.mean(axis=0)
    slope = np.linalg.lstsq(pixels - center, inverse - inverse.mean(), rcond=1e-6)[0]
    return np.asarray(inverse.mean() + slope[0] * (x - center[0]) + slope[1] * (y - center[1]))


def fitted_view(points: Array, width: int, height: int) -> View:
    """The view from ``_EYE_DIRECTION`` that just holds all points (k, 3), centered."""
    right = np.cross([0.0, 0.0, 1.0], _EYE_DIRECTION)
    right /= np.linalg.norm(right)
    axes = np.stack([right, np.cross(_EYE_DIRECTION, right), -_EYE_DIRECTION])
    target = (points.min(axis=0) + points.max(axis=0)) / 2
    half = np.array([width, height]) / (2 * _FOCAL * min(width, height)) * 0.94
    for _ in range(6):  # centering changes the distance needed and the other way round; settles in a few rounds
        local = (points - target) @ axes.T
        distance = float((np.abs(local[:, :2]) / half - local[:, 2:]).max())
        screen = local[:, :2] / (local[:, 2:] + distance)
        target = target + (screen.min(axis=0) + screen.max(axis=0)) / 2 * distance @ axes[:2]
    return View(axes, target + distance * _EYE_DIRECTION, width, height)


def draw_box(canvas: Canvas, view: View, corners: Array, color: Color) -> None:
    """A box from its 8 corners in the order of ``BOX_CORNERS``, with dark edges."""
    for face in BOX_FACES:
        draw_face(canvas, view, corners[face], color)
    for edge in BOX_EDGES:
        draw_line(canvas, view, corners[edge], [int(0.6 * c) for c in color], 1.6, bias=1.0005)


def draw_beam(canvas: Canvas, view: View, start: Array, end: Array, thickness: float, color: Color) -> None:
    """A square beam between two points, as long as its ends' corners."""
    axis = end - start
    length = float(np.linalg.norm(axis))
    if length < 1e-9:
        return
    side = np.eye(3)[int(np.argmin(np.abs(axis)))]
    y = np.cross(axis / length, side)
    y /= np.linalg.norm(y)
    rotation = np.stack([axis / length, y, np.cross(axis / length, y)], axis=1)
    local = BOX_CORNERS * [length + thickness, thickness, thickness]
    corners = (start + end) / 2 + local @ rotation.T
    for face in BOX_FACES:
        draw_face(canvas, view, corners[face], color)


def draw_prism(canvas: Canvas, view: View, bottom: Array, top: Array, color: Color) -> None:
    """What stands between two outlines of k corners each, (k, 3); open below."""
    for i in range(len(bottom)):
        j = (i + 1) % len(bottom)
        draw_face(canvas, view, np.stack([bottom[i], bottom[j], top[j], top[i]]), color)
    if len(top) > 2:
        draw_face(canvas, view, top, color)


def draw_face(canvas: Canvas, view: View, corners: Array, color: Color) -> None:
    """A flat polygon, the lighter the more it faces the sun; both sides look the same."""
    normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    length = np.linalg.norm(normal)
    if length > 0:
        normal = normal / length * np.sign(normal @ (view.eye - corners[0]))
        shade = 0.78 + 0.25 * float(normal @ _SUN)
        canvas.polygon(*view.pixels(corners), np.clip(np.array(color) * shade, 0, 255).astype(np.uint8))


def draw_line(canvas: Canvas, view: View, ends: Array, color: Any, width: float, bias: float) -> None:
    """A line of constant width [canvas pixels] whose depth is that of the line."""
    pixels, inverse = view.pixels(ends)
    along = pixels[1] - pixels[0]
    length = float(np.hypot(*along))
    if length > 0:
        across = np.array([-along[1], along[0]]) / length * width / 2
        strip = np.stack([pixels[0] - across, pixels[1] - across, pixels[1] + across, pixels[0] + across])
        canvas.polygon(strip, inverse[[0, 1, 1, 0]], color, bias)


def draw_dot(canvas: Canvas, view: View, point: Array, radius: float, color: Color, bias: float) -> None:
    """A disc of constant radius [canvas pixels]."""
    pixel, inverse = view.pixels(point)
    turn = np.linspace(0, 2 * np.pi, 16, endpoint=False)
    canvas.polygon(pixel + radius * np.stack([np.cos(turn), np.sin(turn)], axis=1), np.full(16, inverse), color, bias)
