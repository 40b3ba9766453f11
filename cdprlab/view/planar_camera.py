"""Pictures of a planar robot: seen from the front, with a grid in metres and cables colored by tension."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from PIL import Image, ImageDraw, ImageFont

from ..arrays import Array, as_array
from ..errors import InvalidInput
from ..robot import Base, Robot
from ..robot.pose import Pose
from ..world import World
from .camera import (
    BOX,
    FLOOR,
    INK,
    OBSTACLE,
    PLATFORM,
    SLACK_COLOR,
    STEEL,
    TRAIL,
    default_limits,
    hanging,
    tension_colors,
)
from .canvas import PAPER, Color, Picture

BASE_HEIGHT = 0.25
"""[m] A mobile base's deck, which is drawn and collides."""

CORNERS = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])
"""Of a rectangle of size 1, counter-clockwise."""

# Drawn three times as large and averaged down, which smooths every edge.
_OVERSAMPLING = 3
_GRID: Color = (226, 229, 233)
_LABEL: Color = (95, 102, 112)


class PlanarCamera:
    """A fixed front view of a whole planar robot and its scene.

    world : a planar World
    also : (k, 2) further points to have in the picture [m]
    Raises InvalidInput for a spatial world.

    >>> import cdprlab as cl
    >>> world = cl.load_world("planar_rigid")
    >>> PlanarCamera(world).picture(world.pose, [20.0] * 4).shape
    (480, 640, 3)
    """

    def __init__(self, world: World, also: ArrayLike = ()) -> None:
        if world.robot.dimension != 2:
            raise InvalidInput(f"world {world.name!r} is spatial; this camera draws planar robots only")
        self.world = world
        self._low, self._high = _extents(world, np.reshape(np.asarray(also, dtype=float), (-1, 2)))

    def picture(self, pose: Pose, tensions: ArrayLike, width: int = 640, height: int = 480,
                limits: tuple[float, float] | None = None, trail: ArrayLike | None = None,
                rope_lengths: ArrayLike | None = None, robot: Robot | None = None) -> Picture:
        """The robot at one pose.

        pose : single Pose
        tensions : (m,) [N]; cables without positive tension (or NaN) are grey and dashed
        width, height : [pixels]
        limits : tensions of the first and last color [N]; default 0 and the smaller of weight and largest limit
        trail : (k, 2) points joined by a thin line, such as where P has been [m]
        rope_lengths : (m,) what is let out of each cable; what is not needed hangs through [m]
        robot : the robot with its bases where they are now; default the world's
        Returns (height, width, 3).
        """
        if width < 16 or height < 16:
            raise InvalidInput(f"a picture needs at least 16 x 16 pixels, got {width} x {height}")
        shown = self.world.robot if robot is None else robot
        tau = np.broadcast_to(np.asarray(tensions, dtype=float), (shown.n_cables,))
        page = _Page(self, width * _OVERSAMPLING, height * _OVERSAMPLING)
        page.draw_surroundings(self.world, shown)
        page.draw_platform(shown, pose)
        if trail is not None:
            page.draw_trail(as_array(trail, "trail", ("k", 2), "m"))
        page.draw_cables(shown, pose, tau, tension_colors(tau, limits or default_limits(shown)),
                         np.zeros(shown.n_cables) if rope_lengths is None
                         else as_array(rope_lengths, "rope_lengths", (shown.n_cables,), "m"))
        small = page.image.resize((width, height), Image.Resampling.BOX)
        self._label(ImageDraw.Draw(small), width, height)
        return np.asarray(small)

    def project(self, points: ArrayLike, width: int = 640, height: int = 480) -> Array:
        """Where points of the plane appear in the picture.

        points : (…, 2) [m]
        Returns (…, 2), x to the right and y down [pixels].
        """
        given = as_array(points, "points", (2,), "m", batch=True)
        scale, middle = self._scale(width, height), (self._low + self._high) / 2
        left, bottom = _margins(width)
        offset = (given - middle) * scale
        return np.stack([(width + left) / 2 + offset[..., 0], (height - bottom) / 2 - offset[..., 1]], axis=-1)

    def close(self) -> None:
        """Nothing to release."""

    def _scale(self, width: int, height: int) -> float:
        left, bottom = _margins(width)
        room = np.array([width - left, height - bottom]) * 0.94
        return float((room / (self._high - self._low)).min())

    def _window(self, width: int, height: int) -> tuple[Array, Array]:
        """What the picture shows: its lower left and upper right corner [m]."""
        scale, (left, bottom) = self._scale(width, height), _margins(width)
        half = np.array([width - left, height - bottom]) / scale / 2
        middle = (self._low + self._high) / 2
        return middle - half, middle + half

    def _ticks(self, width: int, height: int) -> list[Array]:
        """Round coordinates of the grid's lines along x and along y [m]."""
        low, high = self._window(width, height)
        rough = float((high - low).min()) / 4
        decade = 10.0 ** np.floor(np.log10(rough))
        step = decade * max(factor for factor in (1, 2, 5) if factor * decade <= rough)
        # + 0.0: the zero that rounding leaves may be a negative one.
        return [step * np.arange(np.ceil(a / step), np.floor(b / step) + 1).round() + 0.0 for a, b in zip(low, high)]

    def _label(self, drawing: ImageDraw.ImageDraw, width: int, height: int) -> None:
        """The grid's coordinates, with units."""
        font: Any = ImageFont.load_default(size=max(8.0, 12.5 * width / 640))
        left, bottom = _margins(width)
        xs, ys = self._ticks(width, height)
        drawing.rectangle([0, height - bottom, width, height], fill=PAPER)
        drawing.rectangle([0, 0, left, height], fill=PAPER)
        unit_at = width - 4 - 1.3 * drawing.textlength("x [m]", font=font)
        for x, at in ((x, float(self.project([x, 0.0], width, height)[0])) for x in xs):
            if left < at < unit_at:
                drawing.text((at, height - bottom * 0.86), f"{x:g}", fill=_LABEL, font=font, anchor="ma")
        for y, at in ((y, float(self.project([0.0, y], width, height)[1])) for y in ys):
            if bottom < at < height - bottom:
                drawing.text((left * 0.9, at), f"{y:g}", fill=_LABEL, font=font, anchor="rm")
        drawing.text((width - 4, height - bottom * 0.86), "x [m]", fill=_LABEL, font=font, anchor="ra")
        drawing.text((4, 3), "y [m]", fill=_LABEL, font=font, anchor="la")


class _Page:
    """One enlarged picture under the pen; lengths of strokes are in pixels of the small one."""

    def __init__(self, camera: PlanarCamera, width: int, height: int) -> None:
        self.camera, self.width, self.height = camera, width, height
        self.image = Image.new("RGB", (width, height), PAPER)
        self.pen = ImageDraw.Draw(self.image)
        self.unit = _OVERSAMPLING * max(1.0, width / _OVERSAMPLING / 960)

    def at(self, points: ArrayLike) -> list[tuple[float, float]]:
        pixels = self.camera.project(points, self.width, self.height).reshape(-1, 2)
        return [(float(x), float(y)) for x, y in pixels]

    def line(self, points: ArrayLike, color: Color, stroke: float) -> None:
        self.pen.line(self.at(points), fill=color, width=max(1, round(stroke * self.unit)), joint="curve")

    def dot(self, point: ArrayLike, radius: float, color: Color) -> None:
        (x, y), r = self.at(point)[0], radius * self.unit
        self.pen.ellipse([x - r, y - r, x + r, y + r], fill=color)

    def solid(self, corners: ArrayLike, color: Color) -> None:
        self.pen.polygon(self.at(corners), fill=color)
        outline = np.asarray(corners)
        self.line(np.concatenate([outline, outline[:2]]), INK, 1.2)

    def draw_surroundings(self, world: World, robot: Robot) -> None:
        low, high = self.camera._window(self.width, self.height)
        xs, ys = self.camera._ticks(self.width, self.height)
        floor = world.scene.floor_height
        for x in xs:
            self.line([[x, low[1]], [x, high[1]]], _GRID, 0.8)
        for y in ys:
            self.line([[low[0], y], [high[0], y]], _GRID, 0.8)
        if low[1] < floor:
            self.pen.polygon(self.at([[low[0], low[1]], [high[0], low[1]], [high[0], floor], [low[0], floor]]),
                             fill=FLOOR[1])
            self.line([[low[0], floor], [high[0], floor]], INK, 1.2)
        if world.scene.frame is not None:
            middle, size = world.scene.frame.mean(axis=0), world.scene.frame[1] - world.scene.frame[0]
            self.line(middle + np.concatenate([CORNERS, CORNERS[:2]]) * size, STEEL, 5.0)
        for box in world.scene.boxes:
            turned = CORNERS * box.size @ Pose([0.0, 0.0], angle=box.yaw).rotation.T
            self.solid(box.position + turned, OBSTACLE if box.kind == "obstacle" else BOX)
        for base in robot.bases:
            self.draw_base(base, [cable.exit_point for cable in robot.cables if cable.base == base.name])

    def draw_base(self, base: Base, exits: list[Array]) -> None:
        """A deck on two wheels, and a mast up to its exit points."""
        foot = BASE_HEIGHT if len(base.footprint) else 0.0
        for point in exits:
            self.line(base.to_world(np.array([[point[0], foot], point])), STEEL, 6.0)
        if len(base.footprint):
            left, right = sorted(base.footprint[:, 0].tolist())
            self.solid(base.to_world(np.array([[left, 0.05], [right, 0.05], [right, BASE_HEIGHT],
                                               [left, BASE_HEIGHT]])), STEEL)
            for contact in base.footprint:
                self.dot(base.to_world(contact + [0.0, 0.05]), 5.0, INK)

    def draw_platform(self, robot: Robot, pose: Pose) -> None:
        self.solid(_corners(robot, pose), PLATFORM)

    def draw_trail(self, points: Array) -> None:
        for start, end in pairwise(points):
            self.line([start, end], TRAIL, 2.0)

    def draw_cables(self, robot: Robot, pose: Pose, tau: Array, colors: Picture, lengths: Array) -> None:
        anchors = pose.position + robot.anchor_points @ pose.rotation.T
        for start, end, tension, color, length in zip(anchors, robot.exit_points, tau, colors.tolist(), lengths):
            if tension > 0:
                self.line([start, end], tuple(color), 2.8)
            else:
                sagging = length if robot.gravity > 0 else 0.0
                for piece in hanging(start, end, sagging)[:32].reshape(16, 2, 2):
                    self.line(piece, SLACK_COLOR, 2.8)
        for point in robot.exit_points:
            self.dot(point, 4.0, INK)
        for point in anchors:
            self.dot(point, 2.6, INK)


def _margins(width: int) -> tuple[float, float]:
    """Room for the grid's coordinates at the left and below [pixels]."""
    return 40.0 * width / 640, 22.0 * width / 640


def _corners(robot: Robot, pose: Pose) -> Array:
    return pose.position + (robot.platform.center + CORNERS * robot.platform.size) @ pose.rotation.T


def _extents(world: World, also: Array) -> tuple[Array, Array]:
    """Lowest and highest corner of all that is in the picture [m]."""
    robot, scene = world.robot, world.scene
    poses = [world.pose, *(end for task in world.tasks.values() for end in (task.start, task.end))]
    groups = [robot.exit_points, also, *(_corners(robot, pose) for pose in poses)]
    groups += [box.position + CORNERS * box.size for box in scene.boxes]
    groups += [base.to_world(np.concatenate([base.footprint, np.zeros((1, 2))])) for base in robot.bases]
    if scene.frame is not None:
        groups.append(scene.frame)
    points = np.concatenate(groups)
    low, high = points.min(axis=0), points.max(axis=0)
    if scene.floor_height < low[1] < scene.floor_height + 0.5 * (high[1] - low[1]):
        low = np.array([low[0], scene.floor_height])
    # Robots on a line would leave no height.
    grown = np.maximum(high - low, 0.3 * float((high - low).max())) * 1.06 + 0.05
    return (low + high - grown) / 2, (low + high + grown) / 2
