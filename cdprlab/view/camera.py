"""Pictures of a spatial robot: flat-shaded solids and cables colored by tension.

No graphics card, window or engine is needed, and the same robot state always gives the same picture.
"""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_array
from ..errors import InvalidInput
from ..robot import Platform, Robot
from ..robot.pose import Pose
from ..world import World
from .canvas import (
    BOX_CORNERS,
    BOX_EDGES,
    BOX_FACES,
    Canvas,
    Color,
    Picture,
    View,
    draw_beam,
    draw_box,
    draw_dot,
    draw_face,
    draw_line,
    draw_prism,
    fitted_view,
)

TENSION_COLORS: tuple[Color, ...] = ((24, 20, 120), (92, 10, 165), (156, 23, 158), (203, 71, 120), (232, 114, 66),
                                     (240, 150, 20))
"""Low to high tension: plasma without its yellow end, which vanishes on white; readable with color-blind eyes."""

SLACK_COLOR: Color = (120, 120, 120)
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
        self._backgrounds: dict[tuple[int, int], tuple[View, Canvas]] = {}

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
            draw_box(canvas, view, _corners(place, size), LOAD)
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
            draw_face(canvas, view, triangle, color)
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

    def _background(self, width: int, height: int) -> tuple[View, Canvas]:
        if (width, height) not in self._backgrounds:
            if width < 16 or height < 16:
                raise InvalidInput(f"a picture needs at least 16 x 16 pixels, got {width} x {height}")
            size = width * _OVERSAMPLING, height * _OVERSAMPLING
            view, canvas = fitted_view(_landmarks(self.world), *size), Canvas(*size)
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


def _landmarks(world: World) -> Array:
    """(k, 3) points that must be in the picture [m]."""
    robot, scene = world.robot, world.scene
    groups = [robot.exit_points, _corners(world.pose, robot.platform.size, robot.platform.center)]
    if scene.frame is not None:
        groups.append(scene.frame.mean(axis=0) + BOX_CORNERS * (scene.frame[1] - scene.frame[0]))
    groups += [_corners(Pose(box.position, rpy=[0, 0, box.yaw]), box.size) for box in scene.boxes]
    groups += [_footprint(robot, i, 0.0) for i in range(len(robot.bases))]
    points = np.concatenate([group for group in groups if len(group)])
    grounded = points.copy()
    grounded[:, 2] = scene.floor_height
    return np.concatenate([points, grounded])


# --- what is drawn --------------------------------------------------------------------------------------
def _draw_surroundings(canvas: Canvas, view: View, world: World) -> None:
    scene, thickness = world.scene, _thickness(world)
    _draw_floor(canvas, view, _landmarks(world), scene.floor_height)
    if scene.frame is not None:
        corners = scene.frame.mean(axis=0) + BOX_CORNERS * (scene.frame[1] - scene.frame[0])
        for start, end in BOX_EDGES:
            draw_beam(canvas, view, corners[start], corners[end], thickness, STEEL)
    for box in scene.boxes:
        draw_box(canvas, view, _corners(Pose(box.position, rpy=[0, 0, box.yaw]), box.size),
                  OBSTACLE if box.kind == "obstacle" else BOX)


def _draw_floor(canvas: Canvas, view: View, points: Array, height: float) -> None:
    """Tiles of 1 m (10 m and so on for large worlds), half a tile beyond what stands on them."""
    low, high = points[:, :2].min(axis=0), points[:, :2].max(axis=0)
    tile = 10.0 ** max(0, np.ceil(np.log10(max(*(high - low), 1.0) / 25)))
    first, last = np.floor(low / tile - 0.25).astype(int), np.ceil(high / tile + 0.25).astype(int)
    for i in range(first[0], last[0]):
        for j in range(first[1], last[1]):
            corners = np.array([[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]]) * tile
            canvas.polygon(*view.pixels(np.insert(corners, 2, height - 1e-3, axis=1)), FLOOR[(i + j) % 2])


def _draw_supports(canvas: Canvas, view: View, world: World, robot: Robot) -> None:
    """What carries the exit points where no frame does: bases with masts, or poles."""
    if not robot.bases and world.scene.frame is not None:
        return
    thickness = _thickness(world)
    for index in range(len(robot.bases)):
        draw_prism(canvas, view, _footprint(robot, index, 0.0), _footprint(robot, index, 0.25), STEEL)
    for cable, exit_point in zip(robot.cables, robot.exit_points):
        if cable.base is not None or world.scene.frame is None:
            foot = np.array([*exit_point[:2], world.scene.floor_height])
            draw_beam(canvas, view, foot, exit_point, thickness * 0.6, STEEL)


def _draw_platform(canvas: Canvas, view: View, robot: Robot, pose: Pose, floor_height: float, tray: bool) -> None:
    corners = _corners(pose, robot.platform.size, robot.platform.center)
    shadow = corners.copy()
    shadow[:, 2] = floor_height
    for face in BOX_FACES:
        canvas.polygon(*view.pixels(shadow[face]), SHADOW)
    for part, size in _tray(robot.platform) if tray else [(robot.platform.center, robot.platform.size)]:
        draw_box(canvas, view, _corners(pose, size, part), PLATFORM)


def _tray(platform: Platform) -> list[tuple[Array, Array]]:
    """Center and size [m] of floor and end walls, 2 cm thick, open along y."""
    (x, y, z), thin = platform.size, 0.02
    floor = np.array([0, 0, thin - z]) / 2, np.array([x, y, thin])
    walls = [(np.array([side * (x - thin) / 2, 0, 0]), np.array([thin, y, z])) for side in (-1, 1)]
    return [(platform.center + center, size) for center, size in (floor, *walls)]


def _draw_trail(canvas: Canvas, view: View, points: Array) -> None:
    for start, end in pairwise(points):
        draw_line(canvas, view, np.stack([start, end]), TRAIL, 3.4, bias=1.0)


def _draw_cables(canvas: Canvas, view: View, robot: Robot, pose: Pose, tau: Array, colors: Picture,
                 rope_lengths: Array | None) -> None:
    anchors = pose.position + robot.anchor_points @ pose.rotation.T
    unit = max(1.0, min(view.width, view.height) / 960)
    lengths = np.zeros(robot.n_cables) if rope_lengths is None else rope_lengths
    for start, end, tension, color, length in zip(anchors, robot.exit_points, tau, colors, lengths):
        for piece in _pieces(hanging(start, end, length), dashed=not tension > 0):
            draw_line(canvas, view, piece, color, 5.0 * unit, bias=1.002)
    for point in robot.exit_points:
        draw_dot(canvas, view, point, 7.0 * unit, INK, bias=1.02)  # an exit point may lie inside a beam of the frame
    for point in anchors:
        draw_dot(canvas, view, point, 4.5 * unit, INK, bias=1.003)


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


def _corners(pose: Pose, size: Array, center: Array | None = None) -> Array:
    local = BOX_CORNERS * size + (0 if center is None else center)
    return np.asarray(pose.position + local @ pose.rotation.T)


def _footprint(robot: Robot, index: int, height: float) -> Array:
    base = robot.bases[index]
    return base.to_world(np.insert(base.footprint, 2, height, axis=1))


def _thickness(world: World) -> float:
    return 0.006 * float(np.linalg.norm(np.diff(extents(world), axis=0)))
