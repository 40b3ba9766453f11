"""A robot as matplotlib artists that are made once and then moved: for explorers, stills and films."""

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_rgb, to_rgba_array
from matplotlib.font_manager import FontProperties
from matplotlib.path import Path
from matplotlib.text import Text
from matplotlib.textpath import TextPath
from matplotlib.transforms import Affine2D
from numpy.typing import ArrayLike

from ..arrays import Array
from ..robot import Robot
from ..robot.pose import Pose
from ..world.model import Scene
from .depth import Blocks
from .outlines import (
    EMPTY,
    Solid,
    box_corners,
    box_faces,
    diagonal,
    floor_height,
    floor_tiles,
    landmarks,
    platform_corners,
    platform_solids,
    strung,
    surroundings,
)
from .projection import Projection
from .style import AXIS_COLORS, FLOOR, INK, SHADOW, STEEL, TRAIL, cable_style, tension_colors, tension_limits

HALO = 3.0
"""White around words that stand on lines [points]."""

SLACK_DASHES = (0, (2.5, 1.5))

_BEYOND = 1.25
"""How far out the letter of an axis stands, in lengths of its arm."""


class Haloed(Text):
    """A word with a halo about a place; its outline is found once, where matplotlib would at every drawing."""

    def draw(self, renderer: Any) -> None:
        place = self.get_transform().transform(self.get_position())
        outline = _outlined(self.get_text(), self.get_fontproperties())
        to_place = Affine2D().scale(renderer.points_to_pixels(1.0)).translate(*place)
        gc = renderer.new_gc()
        for color, width in (("white", HALO), (self.get_color(), 0.0)):
            gc.set_foreground(color)
            gc.set_linewidth(renderer.points_to_pixels(width))
            renderer.draw_path(gc, outline, to_place, to_rgb(color))
        self.stale = False


@lru_cache(200)
def _outlined(word: str, font: FontProperties) -> Path:
    """The word's outline about its middle [points]."""
    outline = TextPath((0, 0), word, prop=font)
    return Affine2D().translate(*-outline.get_extents().get_points().mean(axis=0)).transform_path(outline)


class RobotDrawing:
    """The artists of one robot on plane axes; spatial robots are projected.

    axes : to draw in; its limits are set so that all ``poses`` fit
    robot, scene : what is drawn
    poses : Pose, single or batched, that must fit into the picture
    azimuth : of the eye [deg], spatial only; it may walk around (``turn``)
    solid : boxes and platform hide what is behind them, and nobody walks around; else they let
        it through, cables carry their numbers, and the platform its axes
    also : (k, d) further points that must fit into the picture [m]
    """

    def __init__(self, axes: Axes, robot: Robot, scene: Scene | None, poses: Pose,
                 azimuth: float = 25.0, *, solid: bool = False, also: ArrayLike = ()) -> None:
        self.axes, self.robot, self.scene, self.solid = axes, robot, scene or EMPTY, solid
        d = robot.dimension
        points = np.concatenate([landmarks(robot, self.scene, poses),
                                 np.reshape(also, (-1, d))])
        # The world's axes stand at the lowest corner, where they are in nobody's way: they show
        # directions.
        self._corner, self._arm = points.min(axis=0), 0.07 * diagonal(points)
        letters = self._corner + _BEYOND * self._arm * np.eye(d)
        self.points = np.concatenate([points, letters, self._corner[None]])
        self.view = Projection(self.points, azimuth)
        self.pose = poses[0] if poses.batch_shape else poses
        self.limits = tension_limits(robot)
        self._tiles = floor_tiles(self.points, floor_height(robot, self.scene))
        self._frame_axes()
        self._make_artists()
        self._places = self._label_places()
        self.drive(robot)
        self.turn(azimuth)
        self.move(self.pose)

    def turn(self, azimuth: float) -> None:
        """See floor and axes from another side; ``move`` shows the rest from there.

        azimuth : of the eye [deg]
        """
        self.view.turn(azimuth)
        self._floor.set_verts(self.view.flat(self._tiles))
        if self._world_axes:
            self._place_axes(self._world_axes, self._corner, np.eye(3))

    def drive(self, robot: Robot) -> None:
        """The same robot with its bases elsewhere; ``move`` shows them there.

        robot : from ``with_bases``
        """
        self.robot, self._around = robot, surroundings(robot, self.scene)

    def move(self, pose: Pose, tensions: ArrayLike | None = None,
             rope_lengths: Array | None = None,
             loads: Sequence[tuple[Pose, Array]] = (), trail: ArrayLike = ()) -> None:
        """Platform and cables at another pose.

        pose : single Pose
        tensions : (m,) [N], colors of the cables on the scale of ``limits``, grey and dashed
            without positive tension (or NaN); default each cable's own style
        rope_lengths : (m,) what is let out of each cable; of those without tension the rest
            hangs through [m]; those that pull sag by the weight that the world gives them
        loads : pose and size [m] of each loose box; the platform is then drawn as a tray
        trail : (k, d) points joined by a thin line, such as where P has been [m]
        """
        self.pose = pose
        flat, robot, d = self.view.flat, self.robot, self.robot.dimension
        solids = self._around + platform_solids(robot, pose, loads)
        self.paint(self._solids, solids)
        if d == 3:
            # Beams and masts are too thin to hide a cable, and exit points lie inside of them.
            wide = [solid.corners for solid in solids if solid.color != STEEL]
            self._blocks = Blocks(np.stack(wide), self.view.eye)
            shadow = platform_corners(robot, pose)[box_faces(3)]
            shadow[..., 2] = floor_height(robot, self.scene)
            self._shadow.set_verts(flat(shadow))
        if tensions is not None:
            self.cables.set_color(tension_colors(tensions, self.limits) / 255)
            self.cables.set_linestyle(["solid" if pull > 0 else SLACK_DASHES
                                       for pull in np.ravel(tensions)])
        lines, wheels = strung(robot, pose, np.inf if tensions is None else tensions,
                               rope_lengths)
        self.cables.set_segments(self._in_sight(lines))
        self._wheels.set_segments(flat(wheels))
        for number, place in zip(self.numbers, flat(lines[self._places])):
            number.set_position(place)
        exits, anchors, trail = lines[:, 0], lines[:, -1], np.reshape(trail, (-1, d))
        for marks, points in ((self._exits, exits), (self._anchors, anchors),
                              (self._trail, trail)):
            marks.set_data(*self._in_sight(points).T)
        arms = np.stack([np.broadcast_to(pose.position, anchors.shape), anchors], axis=1)
        self._arms.set_segments(flat(arms[self._outside]))
        if self._platform_axes:
            self._place_axes(self._platform_axes, pose.position, pose.rotation)

    def paint(self, shapes: Any, solids: list[Solid]) -> None:
        """The faces of solids, from the back to the front, in a collection that ``faces`` made."""
        corners = np.stack([solid.corners for solid in solids])
        faces = corners[:, box_faces(self.robot.dimension)]
        shades, order = np.ones(faces.shape[:2]), [(k, 0) for k in range(len(solids))]
        if self.robot.dimension == 3:
            blocks = Blocks(corners, self.view.eye)
            shades, seen = blocks.lightness, blocks.seen
            order = [(k, f) for k in blocks.order() for f in np.argsort(seen[k])
                     if seen[k, f] or not self.solid]
        k, f = np.transpose(order)
        colors = np.array([solid.color for solid in solids])[k]
        fills = np.clip(shades[k, f, None] * to_rgba_array(colors)[:, :3], 0, 1)
        steel = colors == STEEL
        shapes.set_verts(self.view.flat(faces[k, f]))
        shapes.set_facecolor(np.column_stack([fills, np.where(steel | self.solid, 1.0, 0.3)]))
        shapes.set_edgecolor(fills * np.where(steel, 1.0, 0.62)[:, None])

    def faces(self, order: float, **options: Any) -> Any:
        """A new collection of polygons; order : among the artists, later ones over earlier ones."""
        return self.axes.add_collection(PolyCollection([], zorder=order, animated=True,
                                                       **options))

    # --- what is where --------------------------------------------------------------------------------
    def _in_sight(self, points: Array) -> Array:
        """(…, 2) where points appear, NaN where a solid hides them."""
        flat = self.view.flat(points)
        if self.solid and self.robot.dimension == 3:
            hidden = self._blocks.hides(points.reshape(-1, 3)).any(axis=0)
            flat[hidden.reshape(points.shape[:-1])] = np.nan
        return flat

    def _place_axes(self, parts: list[Any], origin: Array, rotation: Array) -> None:
        lines, *names = parts
        start, tips, places = (self.view.flat(origin + far * self._arm * rotation.T)
                               for far in (0, 1, _BEYOND))
        lines.set_segments(np.stack([start, tips], axis=1))
        for name, place in zip(names, places):
            name.set_position(place)

    # --- artists, made once ---------------------------------------------------------------------------
    def _frame_axes(self) -> None:
        if self.solid:
            seen, room = self.view.flat(self.points), self.axes.bbox.size
            reach = 0.53 * (np.ptp(seen, axis=0) / room).max() * room
        else:
            # Room for a walk all around, and in the plane for labels beyond the last point.
            around = box_corners(np.ptp(self.points, axis=0), Pose(self.view.center))
            seen = np.concatenate([Projection(around, azimuth).flat(around)
                                   for azimuth in range(-180, 180, 15)])
            reach = np.ptp(seen, axis=0) / 2 + 0.07 * np.ptp(seen, axis=0).max()
            self.axes.set_aspect("equal")
        middle = (seen.min(axis=0) + seen.max(axis=0)) / 2
        across, up = np.transpose([middle - reach, middle + reach])
        self.axes.set(xlim=across, ylim=up, xlabel="x [m]", ylabel="y [m]")
        if self.robot.dimension == 3:
            self.axes.set_axis_off()

    def _make_artists(self) -> None:
        robot = self.robot
        self._floor = self.faces(1, facecolors=FLOOR[::-1])
        self._shadow = self.faces(1.5, facecolors=SHADOW)
        self._solids = self.faces(3, linewidths=0.8)
        self._trail = self._marks("-", TRAIL, 3.5, linewidth=1.8)
        self._wheels = self._lines(INK, 1.0, 4.5)
        # Anchor points beyond the box hang on arms from P, or they would float.
        self._arms = self._lines("#3F5A75", 1.4, 4)
        beyond = np.abs(robot.anchor_points - robot.platform.center) - robot.platform.size / 2
        self._outside = (beyond > 1e-6 * self.view.radius).any(axis=1)
        colors, dashes = zip(*map(cable_style, range(robot.n_cables)))
        self.cables = self._lines(colors, 2.0, 5, linestyles=list(dashes))
        self._anchors = self._marks("o", INK, 5.2, markersize=4)
        self._exits = self._marks("o", INK, 6, markersize=5)
        self.numbers = [] if self.solid else [self._text(str(k + 1), INK, 8, fontweight="bold")
                                               for k in range(robot.n_cables)]
        # In the plane the ticks show the world's.
        self._world_axes = self._make_axes("", 1.8) if robot.dimension == 3 else []
        self._platform_axes = [] if self.solid else self._make_axes("′", 2.6)

    def _lines(self, color: Any, width: float, order: float, **options: Any) -> Any:
        return self.axes.add_collection(LineCollection([], colors=color, linewidths=width,
                                                       zorder=order, animated=True,
                                                       **options))

    def _marks(self, kind: str, color: str, order: float, **options: Any) -> Any:
        marks, = self.axes.plot([], [], kind, color=color, zorder=order, animated=True,
                                **options)
        return marks

    def _text(self, words: str, color: str, order: float, **options: Any) -> Any:
        return self.axes.add_artist(Haloed(0, 0, words, color=color, fontsize=10, zorder=order,
                                           animated=True, **options))

    def _make_axes(self, mark: str, width: float) -> list[Any]:
        """The arrows' lines and their letters."""
        colors = AXIS_COLORS[:self.robot.dimension]
        return [self._lines(colors, width, 7),
                *(self._text(name + mark, color, 7.5) for name, color in zip("xyz", colors))]

    def _label_places(self) -> tuple[range, list[int]]:
        """Which point of each cable its number stands at: as far as possible from the others.

        Chosen once, so that numbers do not jump while the robot moves.
        """
        lines, _ = strung(self.robot, self.pose, np.inf)
        chosen: list[int] = []
        placed = np.zeros((0, 2))
        for spots in self.view.flat(lines[:, 21:60:5]):
            gaps = np.linalg.norm(spots[:, None] - placed,
                                  axis=-1).min(axis=1, initial=self.view.radius / 3)
            best = int(gaps.argmax())
            chosen.append(21 + 5 * best)
            placed = np.concatenate([placed, spots[best:best + 1]])
        return range(len(chosen)), chosen
