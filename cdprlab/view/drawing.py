"""A robot as matplotlib artists that are made once and then moved: frame, cables with numbers, platform, axes."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.patheffects import withStroke
from numpy.typing import ArrayLike

from ..arrays import Array
from ..mechanics.cables import anchor_offsets
from ..robot import Robot
from ..robot.pose import Pose
from ..world.model import Scene
from .outlines import (
    EMPTY,
    box_edges,
    box_faces,
    floor_height,
    floor_segments,
    frame_segments,
    landmarks,
    platform_corners,
    scene_boxes,
)
from .projection import Projection
from .style import AXIS_COLORS, GREY, INK, cable_style

_STEEL, _FLOOR, _PLATFORM, _BOX = "#9AA3AE", "#DDE1E6", "#7896B4", "#CDBEA5"
_HALO = (withStroke(linewidth=3, foreground="white"),)
_SLACK_DASHES = (0, (1, 2))


class RobotDrawing:
    """The artists of one robot on plane axes; spatial robots are projected.

    axes : to draw in; its limits are set so that all ``poses`` fit
    robot, scene : what is drawn
    poses : Pose, single or batched, that must fit into the picture
    azimuth : of the eye [deg], spatial only; it may walk around (``turn``)
    """

    def __init__(self, axes: Axes, robot: Robot, scene: Scene | None, poses: Pose, azimuth: float = 25.0) -> None:
        self.axes, self.robot, self.scene = axes, robot, scene or EMPTY
        self.points = landmarks(robot, self.scene, poses)
        self.view = Projection(self.points, azimuth)
        self.pose = poses[0] if poses.batch_shape else poses
        self._arm = 0.14 * self.view.radius
        self._frame_axes()
        self._make_still_parts()
        self._make_moving_parts()
        self._fractions = self._label_places()
        self.azimuth: float | None = None
        self.turn(azimuth)
        self.move(self.pose)

    def turn(self, azimuth: float) -> None:
        """See frame and floor from another side; ``move`` shows the rest from there.

        azimuth : of the eye [deg]
        """
        if azimuth == self.azimuth:
            return
        self.azimuth = azimuth
        self.view.turn(azimuth)
        flat = self.view.flat
        height = floor_height(self.robot, self.scene)
        self._floor.set_segments(list(flat(floor_segments(self.points, height))))
        self._boxes.set_verts([flat(corners[face]) for corners in scene_boxes(self.scene)
                               for face in box_faces(self.robot.dimension)])
        self._place_frame()
        if self._world_axes:
            # At the lowest corner, where they are in nobody's way: they show directions.
            self._place_axes(self._world_axes, self.points.min(axis=0), np.eye(3))

    def drive(self, robot: Robot) -> None:
        """The same robot with its bases elsewhere; ``move`` takes the cables along.

        robot : from ``with_bases``
        """
        self.robot = robot
        self._place_frame()

    def move(self, pose: Pose, colors: ArrayLike | None = None, slack: ArrayLike | None = None) -> None:
        """Platform and cables at another pose.

        pose : single Pose
        colors : (m, 3) of the cables, 0 to 255; default each cable's own style
        slack : (m,) which cables are slack; they are dotted
        """
        self.pose = pose
        flat, robot = self.view.flat, self.robot
        anchors = pose.position + anchor_offsets(robot, pose)
        cables = flat(np.stack([robot.exit_points, anchors], axis=1))
        self._cables.set_segments(list(cables))
        if colors is not None:
            self._cables.set_color([tuple(color) for color in np.asarray(colors) / 255])
            dotted = np.zeros(robot.n_cables, bool) if slack is None else np.asarray(slack)
            self._cables.set_linestyle([_SLACK_DASHES if loose else "solid" for loose in dotted])
        for label, (start, end), part in zip(self._numbers, cables, self._fractions):
            label.set_position(start + part * (end - start))
        self._anchors.set_data(*flat(anchors).T)
        corners = platform_corners(robot, pose)
        self._faces.set_verts([flat(corners[face]) for face in box_faces(robot.dimension)])
        self._edges.set_segments(list(flat(corners[box_edges(robot.dimension)])))
        arms = np.stack([np.broadcast_to(pose.position, anchors.shape), anchors], axis=1)
        self._arms.set_segments(list(flat(arms[self._outside])))
        self._place_axes(self._platform_axes, pose.position, pose.rotation)

    # --- artists, made once ---------------------------------------------------------------------------
    def _frame_axes(self) -> None:
        # Room for a walk all around; in the plane for labels beyond the last point.
        bounds = self.view.bounds(_hull_box(self.points), np.arange(-180.0, 180.0, 15.0))
        pad = 0.07 * float(np.ptp(bounds, axis=0).max())
        self.axes.set_xlim(bounds[0, 0] - pad, bounds[1, 0] + pad)
        self.axes.set_ylim(bounds[0, 1] - pad, bounds[1, 1] + pad)
        self.axes.set_aspect("equal")
        if self.robot.dimension == 3:
            self.axes.set_axis_off()
        else:
            self.axes.set(xlabel="x [m]", ylabel="y [m]")

    def _lines(self, color: Any, width: float, order: float, moves: bool = True, **options: Any) -> LineCollection:
        lines = LineCollection([], colors=color, linewidths=width, zorder=order, animated=moves, **options)
        self.axes.add_collection(lines, autolim=False)
        return lines

    def _faces_of(self, color: str, alpha: float, order: float, edge: str = "none",
                  moves: bool = True) -> PolyCollection:
        faces = PolyCollection([], facecolors=color, edgecolors=edge, alpha=alpha, zorder=order, animated=moves)
        self.axes.add_collection(faces, autolim=False)
        return faces

    def _make_still_parts(self) -> None:
        planar = self.robot.dimension == 2
        turns = not planar  # what turns with the eye is animated too: or each turn would redraw the whole figure
        self._floor = self._lines(GREY if planar else _FLOOR, 1.6 if planar else 0.8, 1, moves=turns)
        self._frame = self._lines(_STEEL, 2.2, 2, moves=turns or bool(self.robot.bases))
        self._boxes = self._faces_of(_BOX, 0.35, 2.5, edge="#8A7A5C", moves=turns)
        self._exits, = self.axes.plot([], [], "o", color=INK, markersize=6, zorder=6, animated=True)
        # In the plane the ticks show them.
        self._world_axes = self._make_axes("", 1.8) if turns else None

    def _make_moving_parts(self) -> None:
        m = self.robot.n_cables
        styles = [cable_style(k) for k in range(m)]
        self._faces = self._faces_of(_PLATFORM, 0.28, 3)
        self._edges = self._lines("#3F5A75", 1.4, 4)
        # Anchor points beyond the box hang on arms from P, or they would float.
        self._arms = self._lines("#3F5A75", 1.4, 4)
        beyond = np.abs(self.robot.anchor_points - self.robot.platform.center) - self.robot.platform.size / 2
        self._outside = (beyond > 1e-6 * self.view.radius).any(axis=1)
        self._cables = self._lines([style.color for style in styles], 2.0, 5,
                                   linestyles=[style.linestyle for style in styles])
        self._anchors, = self.axes.plot([], [], "o", color=INK, markersize=4, zorder=6, animated=True)
        self._platform_axes = self._make_axes("′", 2.6)
        self._numbers = [self.axes.text(0, 0, str(k + 1), color=INK, ha="center", va="center", fontsize=10,
                                        fontweight="bold", zorder=8, animated=True, path_effects=_HALO)
                         for k in range(m)]

    def _place_frame(self) -> None:
        self._frame.set_segments(list(self.view.flat(frame_segments(self.robot, self.scene))))
        self._exits.set_data(*self.view.flat(self.robot.exit_points).T)

    def _make_axes(self, mark: str, width: float) -> tuple[LineCollection, list[Any]]:
        d = self.robot.dimension
        names = [self.axes.text(0, 0, name + mark, color=color, ha="center", va="center", fontsize=10, zorder=7.5,
                                animated=True, path_effects=_HALO) for name, color in zip("xyz"[:d], AXIS_COLORS)]
        return self._lines(AXIS_COLORS[:d], width, 7), names

    def _place_axes(self, parts: tuple[LineCollection, list[Any]], origin: Array, rotation: Array) -> None:
        lines, names = parts
        tips = origin + self._arm * rotation.T
        flat_tips, flat_origin = self.view.flat(tips), self.view.flat(origin)
        lines.set_segments([np.stack([flat_origin, tip]) for tip in flat_tips])
        for name, place in zip(names, self.view.flat(origin + 1.25 * self._arm * rotation.T)):
            name.set_position(place)

    def _label_places(self) -> Array:
        """(m,) where along each cable its number stands, from 0 at the exit: as far as possible from the others.

        Chosen once, so that numbers do not jump while the robot moves.
        """
        anchors = self.pose.position + anchor_offsets(self.robot, self.pose)
        starts, ends = self.view.flat(self.robot.exit_points), self.view.flat(anchors)
        chosen: list[float] = []
        placed = np.zeros((0, 2))
        for start, end in zip(starts, ends):
            candidates = np.linspace(0.22, 0.62, 9)
            spots = start + candidates[:, None] * (end - start)
            gaps = np.linalg.norm(spots[:, None] - placed, axis=-1).min(axis=1, initial=self.view.radius / 3)
            best = int(np.argmax(gaps - 1e-6 * candidates))
            chosen.append(float(candidates[best]))
            placed = np.concatenate([placed, spots[best:best + 1]])
        return np.array(chosen)


def _hull_box(points: Array) -> Array:
    """Corners of the upright box around points, and the points."""
    low, high = points.min(axis=0), points.max(axis=0)
    corners = np.stack(np.meshgrid(*np.stack([low, high], axis=1)), axis=-1).reshape(-1, points.shape[1])
    return np.concatenate([points, corners])
