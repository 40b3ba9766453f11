"""Pictures of a spatial robot: flat-shaded solids and cables colored by tension, drawn in numpy with a depth buffer.

No graphics card, window or engine is needed, and the same robot state always gives the same picture.
"""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import Array, as_array
from ..errors import InvalidInput
from ..pose import Pose
from ..robot import Platform, Robot
from ..world import World

Color = tuple[int, int, int]
Picture = NDArray[np.uint8]

TENSION_COLORS: tuple[Color, ...] = ((24, 20, 120), (92, 10, 165), (156, 23, 158), (203, 71, 120), (232, 114, 66),
                                     (240, 150, 20))
"""Low to high tension: plasma without its yellow end, which vanishes on white; readable with color-blind eyes."""

SLACK_COLOR: Color = (120, 120, 120)
PAPER: Color = (255, 255, 255)
FLOOR: tuple[Color, Color] = ((238, 240, 242), (228, 231, 234))
SHADOW: Color = (190, 194, 199)
STEEL: Color = (196, 203, 211)
PLATFORM: Color = (120, 150, 180)
BOX: Color = (205, 190, 165)
LOAD: Color = (196, 150, 90)
OBSTACLE: Color = (205, 110, 95)
INK: Color = (45, 50, 58)
TRAIL: Color = (0, 128, 96)

# Drawn twice as large and averaged down, which smooths every edge.
_OVERSAMPLING = 2
_FOCAL = 1.9
_SUN = np.array([0.45, -0.65, 1.0]) / np.linalg.norm([0.45, -0.65, 1.0])
_EYE_DIRECTION = np.array([0.55, -1.0, 0.48]) / np.linalg.norm([0.55, -1.0, 0.48])
_CORNERS = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
_FACES = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])
_EDGES = np.array([[0, 1], [2, 3], [4, 5], [6, 7], [0, 2], [1, 3], [4, 6], [5, 7], [0, 4], [1, 5], [2, 6], [3, 7]])


def tension_colors(tensions: ArrayLike, limits: tuple[float, float]) -> Picture:
    """Colors of tensions on the scale of ``TENSION_COLORS``; grey where a cable is slack (no positive tension).

    tensions : (…) [N]; NaN for a cable that is cut
    limits : tensions of the first and the last color [N]
    Returns (…, 3).

    >>> tension_colors([0.0, 100.0], (0.0, 100.0)).tolist()
    [[120, 120, 120], [240, 150, 20]]
    """
    tau = np.asarray(tensions, dtype=float)
    taut = tau > 0
    low, high = limits
    place = np.clip((np.where(taut, tau, low) - low) / max(high - low, 1e-12), 0, 1) * (len(TENSION_COLORS) - 1)
    table = np.array(TENSION_COLORS, dtype=float)
    stops = np.arange(len(table))
    colors = np.stack([np.interp(place, stops, table[:, channel]) for channel in range(3)], axis=-1)
    return np.where(taut[..., None], colors.round(), SLACK_COLOR).astype(np.uint8)


class Camera:
    """A fixed view of a whole spatial robot and its scene.

    world : a spatial World
    Raises InvalidInput for a planar one.

    >>> import cdprlab as cl
    >>> world = cl.load_world("caroca")
    >>> Camera(world).picture(world.pose, [200.0] * 8).shape
    (480, 640, 3)
    """

    def __init__(self, world: World) -> None:
        if world.robot.dimension != 3:
            raise InvalidInput(f"world {world.name!r} is planar; the camera draws spatial robots only")
        self.world = world
        self._backgrounds: dict[tuple[int, int], tuple[_View, _Canvas]] = {}

    def picture(self, pose: Pose, tensions: ArrayLike, width: int = 640, height: int = 480,
                limits: tuple[float, float] | None = None, trail: ArrayLike | None = None,
                rope_lengths: ArrayLike | None = None, robot: Robot | None = None,
                boxes: Iterable[tuple[Pose, Array]] = (), tray: bool = False) -> Picture:
        """The robot at one pose.

        pose : single Pose
        tensions : (m,) [N]; cables without positive tension (or NaN) are grey and dashed
        width, height : [pixels]
        limits : tensions of the first and last color [N]; default 0 and the smaller of weight and largest limit
        trail : (k, 3) points joined by a thin line, such as where P has been [m]
        rope_lengths : (m,) what is let out of each cable; what is not needed hangs through [m]
        robot : the world's with its mobile bases where they stand now; default where the world puts them
        boxes : pose and size [m] of each loose box
        tray : draw the platform as a floor between two end walls, so that a box in it is seen
        Returns (height, width, 3).
        """
        robot = self.world.robot if robot is None else robot
        tau = np.broadcast_to(np.asarray(tensions, dtype=float), (robot.n_cables,))
        view, background = self._background(width, height)
        canvas = background.copy()
        _draw_supports(canvas, view, self.world, robot)
        for place, size in boxes:
            _draw_box(canvas, view, _corners(place, size), LOAD)
        if trail is not None:
            _draw_trail(canvas, view, as_array(trail, "trail", ("k", 3), "m"))
        _draw_platform(canvas, view, robot, pose, self.world.scene.floor_height, tray)
        _draw_cables(canvas, view, robot, pose, tau, tension_colors(tau, limits or default_limits(robot)),
                     None if rope_lengths is None else as_array(rope_lengths, "rope_lengths", (robot.n_cables,), "m"))
        return canvas.picture(_OVERSAMPLING)

    def surface(self, triangles: ArrayLike, color: Color, width: int = 640, height: int = 480) -> Picture:
        """The surroundings with a solid surface in them, such as the border of a workspace.

        triangles : (k, 3, 3) corners [m]
        Returns (height, width, 3).
        """
        view, background = self._background(width, height)
        canvas = background.copy()
        _draw_supports(canvas, view, self.world, self.world.robot)
        for triangle in as_array(triangles, "triangles", ("k", 3, 3), "m"):
            _draw_face(canvas, view, triangle, color)
        return canvas.picture(_OVERSAMPLING)

    def project(self, points: ArrayLike, width: int = 640, height: int = 480) -> Array:
        """Where world points appear in the picture.

        points : (…, 3) [m]
        Returns (…, 2), x to the right and y down [pixels].
        """
        view, _ = self._background(width, height)
        return view.pixels(as_array(points, "points", (3,), "m", batch=True))[0] / _OVERSAMPLING

    def close(self) -> None:
        """Forget the prepared backgrounds; safe to call twice."""
        self._backgrounds.clear()

    def _background(self, width: int, height: int) -> tuple[_View, _Canvas]:
        if (width, height) not in self._backgrounds:
            if width < 16 or height < 16:
                raise InvalidInput(f"a picture needs at least 16 x 16 pixels, got {width} x {height}")
            size = width * _OVERSAMPLING, height * _OVERSAMPLING
            view, canvas = _fitted_view(_landmarks(self.world), *size), _Canvas(*size)
            _draw_surroundings(canvas, view, self.world)
            self._backgrounds[width, height] = view, canvas
        return self._backgrounds[width, height]


def extents(world: World) -> Array:
    """(2, 3) lowest and highest corner of all that is in the picture [m]."""
    points = _landmarks(world)
    return np.stack([points.min(axis=0), points.max(axis=0)])


def default_limits(robot: Robot) -> tuple[float, float]:
    """A color scale for any task: 0 to the smaller of the platform's weight and the largest tension limit [N]."""
    weight = robot.platform.mass * robot.gravity
    highest = float(np.max(robot.tension_max))
    return 0.0, min(weight, highest) if weight > 0 else highest


# --- view and canvas ------------------------------------------------------------------------------------
class _View(NamedTuple):
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


class _Canvas:
    """Colors and inverse depths; the nearer surface wins."""

    def __init__(self, width: int, height: int) -> None:
        self.colors = np.full((height, width, 3), PAPER, dtype=np.uint8)
        self.nearness = np.zeros((height, width), dtype=np.float32)

    def copy(self) -> _Canvas:
        other = object.__new__(_Canvas)
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


def _fitted_view(points: Array, width: int, height: int) -> _View:
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
    return _View(axes, target + distance * _EYE_DIRECTION, width, height)


def _landmarks(world: World) -> Array:
    """(k, 3) points that must be in the picture [m]."""
    robot, scene = world.robot, world.scene
    groups = [robot.exit_points, _corners(world.pose, robot.platform.size, robot.platform.center)]
    if scene.frame is not None:
        groups.append(scene.frame.mean(axis=0) + _CORNERS * (scene.frame[1] - scene.frame[0]))
    groups += [_corners(Pose(box.position, rpy=[0, 0, box.yaw]), box.size) for box in scene.boxes]
    groups += [_footprint(robot, i, 0.0) for i in range(len(robot.bases))]
    points = np.concatenate([group for group in groups if len(group)])
    grounded = points.copy()
    grounded[:, 2] = scene.floor_height
    return np.concatenate([points, grounded])


# --- what is drawn --------------------------------------------------------------------------------------
def _draw_surroundings(canvas: _Canvas, view: _View, world: World) -> None:
    scene, thickness = world.scene, _thickness(world)
    _draw_floor(canvas, view, _landmarks(world), scene.floor_height)
    if scene.frame is not None:
        corners = scene.frame.mean(axis=0) + _CORNERS * (scene.frame[1] - scene.frame[0])
        for start, end in _EDGES:
            _draw_beam(canvas, view, corners[start], corners[end], thickness)
    for box in scene.boxes:
        _draw_box(canvas, view, _corners(Pose(box.position, rpy=[0, 0, box.yaw]), box.size),
                  OBSTACLE if box.kind == "obstacle" else BOX)


def _draw_floor(canvas: _Canvas, view: _View, points: Array, height: float) -> None:
    """Tiles of 1 m (10 m and so on for large worlds), half a tile beyond what stands on them."""
    low, high = points[:, :2].min(axis=0), points[:, :2].max(axis=0)
    tile = 10.0 ** max(0, np.ceil(np.log10(max(*(high - low), 1.0) / 25)))
    first, last = np.floor(low / tile - 0.25).astype(int), np.ceil(high / tile + 0.25).astype(int)
    for i in range(first[0], last[0]):
        for j in range(first[1], last[1]):
            corners = np.array([[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]]) * tile
            canvas.polygon(*view.pixels(np.insert(corners, 2, height - 1e-3, axis=1)), FLOOR[(i + j) % 2])


def _draw_supports(canvas: _Canvas, view: _View, world: World, robot: Robot) -> None:
    """What carries the exit points where no frame does: bases with masts, or poles."""
    if not robot.bases and world.scene.frame is not None:
        return
    thickness = _thickness(world)
    for index in range(len(robot.bases)):
        _draw_prism(canvas, view, _footprint(robot, index, 0.0), _footprint(robot, index, 0.25), STEEL)
    for cable, exit_point in zip(robot.cables, robot.exit_points):
        if cable.base is not None or world.scene.frame is None:
            foot = np.array([*exit_point[:2], world.scene.floor_height])
            _draw_beam(canvas, view, foot, exit_point, thickness * 0.6)


def _draw_platform(canvas: _Canvas, view: _View, robot: Robot, pose: Pose, floor_height: float, tray: bool) -> None:
    corners = _corners(pose, robot.platform.size, robot.platform.center)
    shadow = corners.copy()
    shadow[:, 2] = floor_height
    for face in _FACES:
        canvas.polygon(*view.pixels(shadow[face]), SHADOW)
    for part, size in _tray(robot.platform) if tray else [(robot.platform.center, robot.platform.size)]:
        _draw_box(canvas, view, _corners(pose, size, part), PLATFORM)


def _tray(platform: Platform) -> list[tuple[Array, Array]]:
    """Center and size [m] of floor and end walls, 2 cm thick, open along y."""
    (x, y, z), thin = platform.size, 0.02
    floor = np.array([0, 0, thin - z]) / 2, np.array([x, y, thin])
    walls = [(np.array([side * (x - thin) / 2, 0, 0]), np.array([thin, y, z])) for side in (-1, 1)]
    return [(platform.center + center, size) for center, size in (floor, *walls)]


def _draw_trail(canvas: _Canvas, view: _View, points: Array) -> None:
    for start, end in pairwise(points):
        _draw_line(canvas, view, np.stack([start, end]), TRAIL, 3.4, bias=1.0)


def _draw_cables(canvas: _Canvas, view: _View, robot: Robot, pose: Pose, tau: Array, colors: Picture,
                 rope_lengths: Array | None) -> None:
    anchors = pose.position + robot.anchor_points @ pose.rotation.T
    unit = max(1.0, min(view.width, view.height) / 960)
    lengths = np.zeros(robot.n_cables) if rope_lengths is None else rope_lengths
    for start, end, tension, color, length in zip(anchors, robot.exit_points, tau, colors, lengths):
        for piece in _pieces(hanging(start, end, length), dashed=not tension > 0):
            _draw_line(canvas, view, piece, color, 5.0 * unit, bias=1.002)
    for point in robot.exit_points:
        _draw_dot(canvas, view, point, 7.0 * unit, bias=1.02)  # an exit point may lie inside a beam of the frame
    for point in anchors:
        _draw_dot(canvas, view, point, 4.5 * unit, bias=1.003)


def hanging(start: Array, end: Array, length: float, pieces: int = 32) -> Array:
    """(pieces + 1, d) points of a rope of this length between two points: straight, or a parabola hanging through.

    start, end : (d,) [m]; length : [m], too short counts as straight

    >>> points = hanging(np.zeros(3), np.array([2.0, 0, 0]), 3.0)
    >>> float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum().round(6))
    3.0
    """
    shares = np.linspace(0, 1, pieces + 1)[:, None]
    line = start + shares * (end - start)
    low, high = 0.0, float(length)
    if length <= np.linalg.norm(end - start) * (1 + 1e-6):
        return line
    bow = 4 * shares * (1 - shares) * -np.eye(start.size)[-1]
    for _ in range(40):
        sag = (low + high) / 2
        longer = np.linalg.norm(np.diff(line + sag * bow, axis=0), axis=1).sum() > length
        low, high = (low, sag) if longer else (sag, high)
    return line + low * bow


def _pieces(points: Array, dashed: bool) -> Iterable[Array]:
    straight = np.allclose(points, np.linspace(points[0], points[-1], len(points)), rtol=0, atol=1e-9)
    if straight and not dashed:
        return [points[[0, -1]]]
    return [points[i:i + 2] for i in range(0, len(points) - 1, 2 if dashed else 1)]


def _draw_box(canvas: _Canvas, view: _View, corners: Array, color: Color) -> None:
    """A box from its 8 corners in the order of ``_CORNERS``, with dark edges."""
    for face in _FACES:
        _draw_face(canvas, view, corners[face], color)
    for edge in _EDGES:
        _draw_line(canvas, view, corners[edge], [int(0.6 * c) for c in color], 1.6, bias=1.0005)


def _draw_beam(canvas: _Canvas, view: _View, start: Array, end: Array, thickness: float) -> None:
    axis = end - start
    length = float(np.linalg.norm(axis))
    if length < 1e-9:
        return
    side = np.eye(3)[int(np.argmin(np.abs(axis)))]
    y = np.cross(axis / length, side)
    y /= np.linalg.norm(y)
    rotation = np.stack([axis / length, y, np.cross(axis / length, y)], axis=1)
    local = _CORNERS * [length + thickness, thickness, thickness]
    corners = (start + end) / 2 + local @ rotation.T
    for face in _FACES:
        _draw_face(canvas, view, corners[face], STEEL)


def _draw_prism(canvas: _Canvas, view: _View, bottom: Array, top: Array, color: Color) -> None:
    for i in range(len(bottom)):
        j = (i + 1) % len(bottom)
        _draw_face(canvas, view, np.stack([bottom[i], bottom[j], top[j], top[i]]), color)
    if len(top) > 2:
        _draw_face(canvas, view, top, color)


def _draw_face(canvas: _Canvas, view: _View, corners: Array, color: Color) -> None:
    normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    length = np.linalg.norm(normal)
    if length > 0:
        normal = normal / length * np.sign(normal @ (view.eye - corners[0]))
        shade = 0.78 + 0.25 * float(normal @ _SUN)
        canvas.polygon(*view.pixels(corners), np.clip(np.array(color) * shade, 0, 255).astype(np.uint8))


def _draw_line(canvas: _Canvas, view: _View, ends: Array, color: Any, width: float, bias: float) -> None:
    """A line of constant width [canvas pixels] whose depth is that of the line."""
    pixels, inverse = view.pixels(ends)
    along = pixels[1] - pixels[0]
    length = float(np.hypot(*along))
    if length > 0:
        across = np.array([-along[1], along[0]]) / length * width / 2
        strip = np.stack([pixels[0] - across, pixels[1] - across, pixels[1] + across, pixels[0] + across])
        canvas.polygon(strip, inverse[[0, 1, 1, 0]], color, bias)


def _draw_dot(canvas: _Canvas, view: _View, point: Array, radius: float, bias: float) -> None:
    pixel, inverse = view.pixels(point)
    turn = np.linspace(0, 2 * np.pi, 16, endpoint=False)
    canvas.polygon(pixel + radius * np.stack([np.cos(turn), np.sin(turn)], axis=1), np.full(16, inverse), INK, bias)


def _corners(pose: Pose, size: Array, center: Array | None = None) -> Array:
    local = _CORNERS * size + (0 if center is None else center)
    return np.asarray(pose.position + local @ pose.rotation.T)


def _footprint(robot: Robot, index: int, height: float) -> Array:
    base = robot.bases[index]
    return base.to_world(np.insert(base.footprint, 2, height, axis=1))


def _thickness(world: World) -> float:
    return 0.006 * float(np.linalg.norm(np.diff(extents(world), axis=0)))
