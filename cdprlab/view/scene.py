"""A motion in space, turned with the mouse: k3d plays it by itself, in a notebook or as a page of its own."""

import html
import json
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..arrays import Array, checked
from ..errors import InvalidInput, needed_by
from ..simulate.state import State
from ..world.files import checked_path, replaced
from .film import as_png, draw, evenly, state_at
from .notebook import picture_tag
from .outlines import (
    EMPTY,
    box_faces,
    diagonal,
    floor_height,
    floor_tiles,
    landmarks,
    platform_solids,
    strung,
    surroundings,
)
from .screen import check_like
from .style import FLOOR, INK, SLACK_COLOR, STEEL, TENSION_COLORS

_MOST_FRAMES = 160
"""k3d blends between them; a saved lesson keeps them all."""

_PIECES = 8
"""Of a cable, which may hang through."""

_LOOSE = 1.02
"""A slack cable whose let-out length nobody knows is drawn so much longer than straight."""

_BETWEEN = 0.02
"""From one motion to the next [s]: the scene jumps."""

_GREY = 0.04
"""Share of the color scale, below 0 N, that is slack."""


@checked
class MotionScene:
    """States of an engine, one after the other, as ``plot``, a k3d.Plot that plays them.

    states : State, in the order of time, of many some are kept; or several such lists, shown one after the other:
        what is said meanwhile → states
    title : of the page
    Planar robots stand in the plane y = 0. Cables are colored by tension, slack ones hang.
    Raises InvalidInput without states.

    >>> import cdprlab as cl
    >>> with cl.open_simulator(cl.load_world("planar_rigid")) as engine:
    ...     MotionScene([engine.state()]).plot.time
    0.0
    """

    def __init__(self, states: Sequence[State] | Mapping[str, Sequence[State]],
                 title: str = "") -> None:
        joined = _joined(states if isinstance(states, Mapping) else {"": states})
        if not joined:
            raise InvalidInput("a scene needs one state at least, got none")
        with needed_by("the scene one turns", "stills and films work without it"):
            import k3d
        self.title = title
        self.notes, self.states = zip(*(joined[k] for k in evenly(len(joined), _MOST_FRAMES)))
        self.times = [state.time for state in self.states]
        tensions = np.nan_to_num([state.tensions for state in self.states])
        self.largest = max(tensions.max(), 1.0)
        first = self.states[0]
        points = _raised(landmarks(first.robot, first.scene, first.pose))
        self.unit = 0.004 * diagonal(points)
        self.plot = k3d.plot(height=400, grid_visible=False, camera_auto_fit=False,
                             axes_helper=0.0,
                             menu_visibility=False, colorbar_object_id=0, snapshot_type="full",
                             name=title)
        tiles = floor_tiles(points, floor_height(first.robot, first.scene))
        for parity, color in enumerate(FLOOR):
            self.plot += self._mesh(tiles[None, parity::2], np.array([[0, 1, 2, 3]]), color)
        self._add_solids()
        self._add_cables(tensions)
        center, reach = (points.min(axis=0) + points.max(axis=0)) / 2, 250 * self.unit
        way = np.array([0.0, -1.0, 0.12] if first.robot.dimension == 2 else [0.55, -0.75, 0.4])
        center[2] -= 0.1 * reach   # the player's bar covers what is below
        self.plot.camera = [*(center + reach * way), *center, 0, 0, 1]
        self.plot.additional_js_code = self._player(tensions)

    def page(self) -> str:
        """HTML that opens anywhere, without a server or a network, with a still where there is no WebGL."""
        still = picture_tag(self.still(),
                            f"{self.title}: the robot at its start. Turning it needs WebGL.")
        page = self.plot.get_snapshot().replace("<html>", '<html lang="en">', 1)
        page = page.replace("<body>",
                            f'<body><div class="cdprlab-still" style="position: absolute">{still}</div>', 1)
        return re.sub("<title>.*?<", lambda _: f"<title>{html.escape(self.title)}<", page,
                      count=1)

    def still(self) -> bytes:
        """The first state as PNG."""
        return as_png(draw(self.states[0]), self.title)

    # --- what is in it --------------------------------------------------------------------------------
    def _series(self, values: Array) -> Any:
        """What k3d plays, or one value where nothing moves."""
        arrays = np.asarray(values, dtype=np.float32)
        if (arrays == arrays[0]).all():
            return arrays[0]
        return {f"{time:.3f}": value for time, value in zip(self.times, arrays)}

    def _add_solids(self) -> None:
        """One mesh for all boxes of one color; planar boxes become 0.2 m deep."""
        solids = [surroundings(state.robot, state.scene, state.base_frames)
                  + platform_solids(state.robot, state.pose, state.boxes)
                  for state in self.states]
        bodies = np.array([[solid.corners for solid in shown] for shown in solids])
        if bodies.shape[-1] == 2:
            bodies = _raised(bodies[:, :, [0, 1, 0, 1, 2, 3, 2, 3]])
            bodies[..., 1] = 2 * [-0.1, -0.1, 0.1, 0.1]
        colors = [solid.color for solid in solids[0]]
        for color in dict.fromkeys(colors):
            self.plot += self._mesh(bodies[:, np.equal(colors, color)], box_faces(3), color,
                                    1.0 if color == STEEL else 0.85)

    def _add_cables(self, tensions: Array) -> None:
        import k3d

        told = [strung(state.robot, state.pose, state.tensions, state.rope_lengths,
                       state.base_frames,
                       _PIECES, _LOOSE) for state in self.states]
        lines, wheels = (_raised(np.array(parts)) for parts in zip(*told))
        slack, ink = -_GREY * self.largest, _rgb(INK)
        shades = np.where(tensions > 0, tensions, slack)
        self.cables = self._lines(
            lines, 1.3, attribute=self._series(np.repeat(shades, _PIECES + 1, axis=1)),
            color_map=_scale(), color_range=[slack, self.largest], name="tension [N]")
        self.plot += self.cables
        if wheels.size:
            self.plot += self._lines(wheels, 1.0, color=ink)
        for end, size in ((0, 5), (-1, 3)):
            self.plot += k3d.points(self._series(lines[:, :, end]), point_size=size * self.unit,
                                    color=ink, shader="flat")
        first = lines[0, :, 0]
        for k in range(len(first)):
            # Outwards of the point, and above or below it where another is near.
            side = "l" if first[k, 0] > first[:, 0].mean() else "r"
            near = (np.abs(first[:k] - first[k]).max(axis=1) < 20 * self.unit).sum()
            self.plot += k3d.text(str(k + 1), position=self._series(lines[:, k, 0]), color=ink,
                                  size=1.0, label_box=False, reference_point=side + "bt"[near % 2])

    def _flat(self, parts: Array) -> Any:
        """(T, n, k, 3) points of n parts at each state, as one list."""
        return self._series(parts.reshape(len(parts), -1, 3))

    def _lines(self, lines: Array, width: float, **look: Any) -> Any:
        """(T, n, k, 3) points of n lines at each state; width : in units."""
        import k3d

        n, k = lines.shape[1:3]
        starts = k * np.arange(n)[:, None] + np.arange(k - 1)
        pairs = (starts[..., None] + [0, 1]).reshape(-1, 2).astype(np.uint32)
        return k3d.lines(self._flat(lines), pairs, indices_type="segment", shader="thick",
                         width=width * self.unit, **look)

    def _mesh(self, bodies: Array, faces: Array, color: str, opacity: float = 1.0) -> Any:
        """Bodies of (T, n, k, 3) corners at each state, the faces of each (f, 4), as triangles."""
        import k3d

        n, k = bodies.shape[1:3]
        whole = faces + k * np.arange(n)[:, None, None]
        triangles = whole[..., [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3).astype(np.uint32)
        return k3d.mesh(self._flat(bodies), triangles, color=_rgb(color), opacity=opacity,
                        flat_shading=True, side="double")

    def _player(self, tensions: Array) -> str:
        script = Path(__file__).with_name("player.js").read_text(encoding="utf-8")
        colors = ["#{:02X}{:02X}{:02X}".format(*color)
                  for color in (SLACK_COLOR, *TENSION_COLORS)]
        motion = {"end": max(self.times[-1], 1e-3), "times": np.round(self.times, 3).tolist(),
                  "tensions": tensions.round(1 if self.largest < 1000 else 0).tolist(),
                  "largest": float(f"{self.largest:.3g}"), "colors": colors,
                  "notes": [html.escape(note) for note in self.notes]}
        return script.replace("MOTION;", json.dumps(motion) + ";", 1)


def states_of(run: Any) -> list[State]:
    """A run's steps, as many as a scene shows, as its engine told them.

    run : Run
    """
    return [state_at(run, k) for k in evenly(len(run.time), _MOST_FRAMES)]


@checked
def save_scene(run: Any, path: str | Path, title: str = "") -> Path:
    """A run as one HTML file of at most 3 MB that plays, and turns, wherever there is a browser.

    run : Run; or what is said meanwhile → states, see `MotionScene`
    path : ends in .html; title : default the run's world and task
    """
    target = checked_path(path, ".html")
    if not isinstance(run, Mapping):
        check_like(run)
        run, title = states_of(run), title or f"{run.world.title}, task {run.task}"
    with replaced(target) as file:
        file.write(MotionScene(run, title).page().encode())
    return target


def _joined(motions: Mapping[str, Sequence[State]]) -> list[tuple[str, Any]]:
    """What is said and the states, on one clock, each with a scene."""
    joined: list[tuple[str, Any]] = []
    for said, motion in motions.items():
        began = joined[-1][1].time + _BETWEEN if joined else 0.0
        joined += [(said,
                    state._replace(time=began + state.time - motion[0].time,
                                   scene=state.scene or EMPTY))
                   for state in motion]
    return joined


def _raised(points: Array) -> Array:
    """(…, 3) points in space; planar ones in the plane y = 0, their y upwards."""
    return points if points.shape[-1] == 3 else np.insert(points, 1, 0.0, axis=-1)


def _scale() -> Array:
    """k3d's color map: place and red, green, blue of each color, grey below 0 N."""
    zero = _GREY / (1 + _GREY)
    places = [0.0, 0.98 * zero, *np.linspace(zero, 1.0, len(TENSION_COLORS))]
    colors = np.array([SLACK_COLOR, SLACK_COLOR, *TENSION_COLORS]) / 255
    return np.column_stack([places, colors]).ravel()


def _rgb(color: str) -> int:
    return int(color.removeprefix("#"), 16)
