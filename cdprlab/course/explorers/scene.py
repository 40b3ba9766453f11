"""A spatial robot in three dimensions, to be turned with the mouse: k3d in the notebook, changed in place."""

from typing import Any

import ipywidgets
import k3d
import numpy as np
from numpy.typing import ArrayLike
from PIL import ImageColor

from ...arrays import Array
from ...errors import InvalidInput, quoted
from ...mechanics.cables import anchor_offsets
from ...robot.pose import Pose
from ...view.outlines import box_faces, floor_height, floor_tiles, landmarks, platform_solids, surroundings
from ...view.style import AXIS_COLORS, FLOOR, INK, SLACK_COLOR, STEEL, TENSION_COLORS, tension_colors, tension_limits
from ...world import World
from ..text_table import tension_text


class RobotScene:
    """A robot and what is around it in ``plot``, a k3d.Plot, cables colored by tension, with the tensions as text.

    world : a spatial World
    pose : single Pose; default the world's
    tensions : (m,) [N]; default none given, all cables grey
    limits : tensions of the first and last color [N]; default 0 and the smaller of weight and
        largest limit
    Raises InvalidInput for a planar world or a pose that does not fit.

    >>> import cdprlab as cl
    >>> opened = RobotScene(cl.load_world("caroca"))
    >>> opened.move(cl.Pose([0.0, 0.0, 1.0]), [300.0] * 8)
    >>> opened.platform.model_matrix[:3, 3]
    array([0., 0., 1.], dtype=float32)
    """

    def __init__(self, world: World, pose: Pose | None = None,
                 tensions: ArrayLike | None = None,
                 limits: tuple[float, float] | None = None) -> None:
        if world.robot.dimension != 3:
            raise InvalidInput(f"world {world.name!r} is planar; the k3d scene shows spatial robots, "
                               "pose_explorer and run_player's view=\"picture\" show planar ones too")
        self.world, self.robot = world, world.robot
        self.limits = limits or tension_limits(world.robot)
        start = world.pose if pose is None else pose
        points = landmarks(world.robot, world.scene, start)
        self.unit = 0.004 * float(np.linalg.norm(np.ptp(points, axis=0)))
        self.plot = k3d.plot(height=460, grid_visible=False, camera_auto_fit=False,
                             axes_helper=0.0)
        self._add_surroundings(points)
        self._add_axes(points)
        self._add_robot(start)
        self.legend = k3d.text2d("", position=(0.01, 0.02), is_html=True, size=0.8,
                                 label_box=True, color=_rgb(INK))
        self.plot += self.legend
        self.move(start, np.full(world.robot.n_cables, np.nan)
                  if tensions is None else tensions)
        center, reach = (points.min(axis=0) + points.max(axis=0)) / 2, float(np.linalg.norm(np.ptp(points, axis=0)))
        eye = center + 1.1 * reach * np.array([0.45, -0.85, 0.35])
        self.plot.camera = [*eye.tolist(), *center.tolist(), 0, 0, 1]
        self.plot.layout.width, self.plot.layout.max_width = "600px", "100%"

    def move(self, pose: Pose, tensions: ArrayLike) -> None:
        """Another pose, other tensions: attributes of the same objects change.

        pose : single spatial Pose
        tensions : (m,) [N]; cables without positive tension (or NaN) are grey
        """
        if pose.dimension != 3 or pose.batch_shape:
            raise InvalidInput(f"a scene takes a single spatial Pose, got {quoted(pose)}")
        tau = np.broadcast_to(np.asarray(tensions, dtype=float), (self.robot.n_cables,))
        colors = tension_colors(tau, self.limits)
        anchors = pose.position + anchor_offsets(self.robot, pose)
        for line, anchor, exit_point, color in zip(self.cables, anchors,
                                                   self.robot.exit_points, colors):
            line.vertices = np.array([exit_point, anchor], dtype=np.float32)
            line.color = _rgb(color)
        for label, place in zip(self.numbers, 0.6 * self.robot.exit_points + 0.4 * anchors):
            label.position = place.tolist()
        self.anchors.positions = anchors.astype(np.float32)
        matrix = np.eye(4, dtype=np.float32)
        matrix[:3, :3], matrix[:3, 3] = pose.rotation, pose.position
        self.platform.model_matrix = matrix
        self.legend.text = legend_html(tau, self.limits)

    def close(self) -> None:
        """Let go of plot and objects; safe to call twice."""
        for thing in (*self.plot.objects, self.plot):
            thing.layout.close()
            ipywidgets.Widget.close(thing)  # k3d's own close of a plot only takes it off the page

    # --- objects, made once ---------------------------------------------------------------------------
    def _add_surroundings(self, points: Array) -> None:
        robot, around = self.robot, self.world.scene
        tiles = floor_tiles(points, floor_height(robot, around))
        for parity, color in enumerate(FLOOR):
            self.plot += _mesh(tiles[parity::2], np.array([[0, 1, 2, 3]]), color, "floor")
        for solid in surroundings(robot, around):
            self.plot += _mesh(solid.corners[None], box_faces(3), solid.color, "frame or box",
                               1.0 if solid.color == STEEL else 0.6)
        self.plot += k3d.points(robot.exit_points.astype(np.float32), point_size=5 * self.unit,
                                color=_rgb(INK),
                                name="exit points")

    def _add_axes(self, points: Array) -> None:
        """World axes at the lowest corner; k3d's own hide a corner of the picture."""
        origin, length = points.min(axis=0), 25 * self.unit
        for name, color, axis in zip("xyz", AXIS_COLORS, np.eye(3)):
            shade = _rgb(color)
            ends = np.stack([origin, origin + length * axis]).astype(np.float32)
            self.plot += k3d.line(ends, color=shade, width=1.5 * self.unit, shader="mesh",
                                  name=f"{name} axis")
            place = (origin + 1.25 * length * axis).tolist()
            self.plot += k3d.text(name, position=place, color=shade, size=1.2, label_box=False,
                                  reference_point="cc")

    def _add_robot(self, pose: Pose) -> None:
        body, = platform_solids(self.robot, Pose([0, 0, 0]))
        self.platform = _mesh(body.corners[None], box_faces(3), body.color, "platform", 0.8)
        ends = np.zeros((2, 3), dtype=np.float32)
        self.cables = [k3d.line(ends, color=_rgb(SLACK_COLOR), width=1.2 * self.unit,
                                shader="mesh",
                                name=f"cable {k + 1}") for k in range(self.robot.n_cables)]
        self.numbers = [k3d.text(str(k + 1), position=[0, 0, 0], color=_rgb(INK), size=1.2,
                                 label_box=False,
                                 reference_point="cc", name=f"number {k + 1}")
                        for k in range(self.robot.n_cables)]
        self.anchors = k3d.points(np.zeros((1, 3), dtype=np.float32), point_size=3 * self.unit,
                                  color=_rgb(INK),
                                  name="anchor points")
        for thing in (self.platform, *self.cables, *self.numbers, self.anchors):
            self.plot += thing


def legend_html(tensions: Array, limits: tuple[float, float]) -> str:
    """The color scale with its ends [N], and every cable's tension as a number."""
    scale, grey = "".join(map(_block, TENSION_COLORS)), _block(SLACK_COLOR)
    lines = [f"tension [N]: {limits[0]:.0f} {scale} {limits[1]:.0f}, slack {grey}"]
    if np.isfinite(tensions).any():
        lines += [f"{_block(color)} {k}: {tension_text(tau)}"
                  for k, (tau, color) in enumerate(zip(tensions, tension_colors(tensions, limits)), 1)]
    return "<br>".join(lines)


def _block(color: Any) -> str:
    return f'<span style="color: #{_rgb(color):06X}">■</span>'


def _mesh(corners: Array, faces: Array, color: str, name: str, opacity: float = 1.0) -> Any:
    """Bodies of (n, k, 3) corners, the faces of each (f, 4), as triangles."""
    whole = (faces + corners.shape[1] * np.arange(len(corners))[:, None, None]).reshape(-1, 4)
    triangles = np.concatenate([whole[:, [0, 1, 2]], whole[:, [0, 2, 3]]]).astype(np.uint32)
    return k3d.mesh(corners.reshape(-1, 3).astype(np.float32), triangles, color=_rgb(color),
                    opacity=opacity,
                    flat_shading=True, side="double", name=name)


def _rgb(color: Any) -> int:
    """As k3d takes a color: from "#RRGGBB" or three numbers up to 255."""
    red, green, blue = map(int,
                           ImageColor.getrgb(color)[:3] if isinstance(color, str) else color)
    return red << 16 | green << 8 | blue
