"""A motion in space, turned with the mouse: k3d plays it by itself, in a notebook or as a page of its own."""

import html
import json
from base64 import b64encode
from collections.abc import Mapping, Sequence
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image, ImageColor

from ..arrays import Array, checked
from ..errors import InvalidInput, needed_by
from ..simulate.state import State
from ..world.files import checked_path, replaced
from .film import draw, state_at
from .outlines import (
    EMPTY,
    Solid,
    box_faces,
    cable_lines,
    floor_height,
    floor_tiles,
    landmarks,
    leaned,
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

    def __init__(self, states: Sequence[State] | Mapping[str, Sequence[State]], title: str = "") -> None:
        notes: list[str] = []
        if isinstance(states, Mapping):
            states, notes = _joined(states)
        if not states:
            raise InvalidInput("a scene needs one state at least, got none")
        with needed_by("the scene one turns", "stills and films work without it"):
            import k3d
        chosen = _some(len(states))
        self.states, self.title = [states[k] for k in chosen], title
        self.notes = [notes[k] for k in chosen] if notes else []
        self.times = [state.time - states[0].time for state in self.states]
        tensions = np.nan_to_num([state.tensions for state in self.states])
        self.largest = max(float(tensions.max()), 1.0)
        first = self.states[0]
        points = _raised(landmarks(first.robot, first.scene or EMPTY, first.pose))
        self.unit = 0.004 * float(np.linalg.norm(np.ptp(points, axis=0)))
        self.plot = k3d.plot(height=400, grid_visible=False, camera_auto_fit=False, axes_helper=0.0,
                             menu_visibility=False, colorbar_object_id=0, snapshot_type="full", name=title)
        self._add_floor(points)
        self._add_solids()
        self._add_cables(tensions)
        center, reach = (points.min(axis=0) + points.max(axis=0)) / 2, 250 * self.unit
        way = np.array([0.0, -1.0, 0.12] if first.robot.dimension == 2 else [0.55, -0.75, 0.4])
        center[2] -= 0.1 * reach   # the player's bar covers what is below
        self.plot.camera = [*(center + reach * way).tolist(), *center.tolist(), 0, 0, 1]
        self.plot.additional_js_code = self._player(tensions)

    def page(self) -> str:
        """HTML that opens anywhere, without a server or a network, with a still where there is no WebGL."""
        shown = self.plot.get_snapshot()
        words = f"{html.escape(self.title)}: the robot at its start. Turning it needs WebGL."
        still = (f'<img class="cdprlab-still" style="position: absolute" alt="{words}" '
                 f'src="data:image/png;base64,{b64encode(self.still()).decode("ascii")}">')
        head, rest = shown.split("<body>", 1)
        start, after = head.split("<title>", 1)
        title = f"<title>{html.escape(self.title)}</title>{after.split('</title>', 1)[1]}"
        return f"{start}{title}<body>{still}{rest}".replace("<html>", '<html lang="en">', 1)

    def still(self) -> bytes:
        """The first state as PNG."""
        file = BytesIO()
        Image.fromarray(draw(self.states[0])).save(file, "png", optimize=True)
        return file.getvalue()

    # --- what is in it --------------------------------------------------------------------------------
    def _series(self, values: Sequence[Array]) -> Any:
        """What k3d plays, or one value where nothing moves."""
        arrays = [np.asarray(value, dtype=np.float32) for value in values]
        if all(np.array_equal(arrays[0], value) for value in arrays):
            return arrays[0]
        return {f"{time:.3f}": value for time, value in zip(self.times, arrays)}

    def _add_floor(self, points: Array) -> None:
        state = self.states[0]
        tiles = floor_tiles(points, floor_height(state.robot, state.scene or EMPTY))
        for parity, color in enumerate(FLOOR):
            self.plot += self._mesh([tiles[parity::2]], np.array([[0, 1, 2, 3]]), color)

    def _add_solids(self) -> None:
        """One mesh for all boxes of one color."""
        kinds = [_by_color([*surroundings(state.robot, state.scene or EMPTY, state.base_frames),
                            *platform_solids(state.robot, state.pose, state.boxes)]) for state in self.states]
        for color in kinds[0]:
            self.plot += self._mesh([kind[color] for kind in kinds], box_faces(3), color,
                                    1.0 if color == STEEL else 0.85)

    def _add_cables(self, tensions: Array) -> None:
        import k3d

        lines = [_lines(state) for state in self.states]
        m = tensions.shape[1]
        shades = np.where(tensions > 0, tensions, -_GREY * self.largest)
        self.cables = k3d.lines(
            self._flat(lines), _chains(m, _PIECES),
            indices_type="segment", shader="thick", width=1.3 * self.unit,
            attribute=self._series([np.repeat(row, _PIECES + 1) for row in shades]),
            color_map=_scale(), color_range=[-_GREY * self.largest, self.largest], name="tension [N]")
        self.plot += self.cables
        wheels = [_raised(_leaned(state, strung(state.robot, state.pose)[2])) for state in self.states]
        if wheels[0].size:
            self.plot += k3d.lines(self._flat(wheels), _chains(len(wheels[0]), 24), indices_type="segment",
                                   shader="thick", width=self.unit, color=_rgb(INK))
        exits = self._series([_raised(_leaned(state, state.robot.exit_points)) for state in self.states])
        anchors = self._flat([line[:, -1:] for line in lines])
        for marks, size in ((exits, 5), (anchors, 3)):
            self.plot += k3d.points(marks, point_size=size * self.unit, color=_rgb(INK), shader="flat")
        first = _raised(self.states[0].robot.exit_points)
        for k in range(m):
            place = exits[k] if isinstance(exits, np.ndarray) else {time: points[k] for time, points in exits.items()}
            # Outwards of the point, and above or below it where another is near.
            side = "l" if first[k, 0] > first[:, 0].mean() else "r"
            shared = int((np.abs(first[:k] - first[k]).max(axis=1, initial=0.0) < 20 * self.unit).sum())
            self.plot += k3d.text(str(k + 1), position=place, color=_rgb(INK), size=1.0, label_box=False,
                                  reference_point=side + "bt"[shared % 2])

    def _flat(self, lines: list[Array]) -> Any:
        return self._series([line.reshape(-1, 3) for line in lines])

    def _mesh(self, bodies: list[Array], faces: Array, color: str, opacity: float = 1.0) -> Any:
        """Bodies of (n, k, 3) corners at each state, the faces of each (f, 4), as triangles."""
        import k3d

        n, k, _ = bodies[0].shape
        whole = (faces + k * np.arange(n)[:, None, None]).reshape(-1, 4)
        triangles = np.concatenate([whole[:, [0, 1, 2]], whole[:, [0, 2, 3]]]).astype(np.uint32)
        return k3d.mesh(self._flat(bodies), triangles, color=_rgb(color), opacity=opacity, flat_shading=True,
                        side="double")

    def _player(self, tensions: Array) -> str:
        script = Path(__file__).with_name("player.js").read_text(encoding="utf-8")
        colors = ["#{:02X}{:02X}{:02X}".format(*color) for color in (SLACK_COLOR, *TENSION_COLORS)]
        motion = {"end": max(self.times[-1], 1e-3), "times": np.round(self.times, 3).tolist(),
                  "tensions": tensions.round(1 if self.largest < 1000 else 0).tolist(),
                  "largest": float(f"{self.largest:.3g}"), "colors": colors,
                  "notes": [html.escape(note) for note in self.notes]}
        return script.replace("MOTION;", json.dumps(motion) + ";", 1)


def states_of(run: Any) -> list[State]:
    """A run's steps, as many as a scene shows, as its engine told them.

    run : Run
    """
    return [state_at(run, k) for k in _some(len(run.time))]


@checked
def save_scene(run: Any, path: str | Path, title: str = "") -> Path:
    """A run as one HTML file of at most 3 MB that plays, and turns, wherever there is a browser.

    run : Run; or what is said meanwhile → states, see `MotionScene`
    path : ends in .html; title : default the run's world and task
    """
    target, shown = checked_path(path, ".html"), run
    if not isinstance(run, Mapping):
        check_like(run, "Run", "commanded_tensions")
        shown, title = states_of(run), title or f"{run.world.title}, task {run.task}"
    with replaced(target) as file:
        file.write(MotionScene(shown, title).page().encode())
    return target


def _joined(motions: Mapping[str, Sequence[State]]) -> tuple[list[State], list[str]]:
    """States on one clock, and what is said at each."""
    states: list[State] = []
    notes: list[str] = []
    for said, motion in motions.items():
        began = states[-1].time + _BETWEEN if states else 0.0
        states += [state._replace(time=began + state.time - motion[0].time) for state in motion]
        notes += [said] * len(motion)
    return states, notes


def _some(count: int) -> list[int]:
    """Which of so many states are kept, the last one among them."""
    return np.unique(np.linspace(0, count - 1, min(count, _MOST_FRAMES)).round().astype(int)).tolist()


def _lines(state: State) -> Array:
    """(m, pieces + 1, 3) cables from exit to anchor; slack ones hang through."""
    starts, arcs, _ = strung(state.robot, state.pose)
    return _raised(cable_lines(state.robot, state.pose, state.tensions, state.rope_lengths,
                               _leaned(state, starts), arcs, _PIECES, _LOOSE))


def _leaned(state: State, points: Array) -> Array:
    """What rides on bases, a row a cable or a cable with a pulley, where it is as they lean."""
    robot = state.robot
    owners = np.array(robot.base_indices)
    if len(points) < robot.n_cables:
        owners = owners[robot.pulleys[:, 0] > 0]
    rows = [leaned(robot, k, row, state.base_frames) for k, row in zip(owners, points)]
    return np.reshape(rows, points.shape)


def _chains(count: int, pieces: int) -> Any:
    """Pairs of neighbors on so many lines of so many pieces each."""
    starts = (pieces + 1) * np.arange(count)[:, None] + np.arange(pieces)
    return (starts[..., None] + [0, 1]).reshape(-1, 2).astype(np.uint32)


def _raised(points: Array) -> Array:
    """(…, 3) points in space; planar ones in the plane y = 0, their y upwards."""
    return np.asarray(points) if points.shape[-1] == 3 else np.insert(points, 1, 0.0, axis=-1)


def _by_color(solids: list[Solid]) -> dict[str, Array]:
    """Color → (n, 8, 3) corners; planar boxes become 0.2 m deep."""
    found: dict[str, list[Array]] = {}
    for solid in solids:
        corners = solid.corners
        if corners.shape[-1] == 2:
            front, back = (np.insert(corners.reshape(2, 1, 2, 2), 1, y, axis=-1) for y in (-0.1, 0.1))
            corners = np.concatenate([front, back], axis=1).reshape(8, 3)
        found.setdefault(solid.color, []).append(corners)
    return {color: np.stack(bodies) for color, bodies in found.items()}


def _scale() -> Array:
    """k3d's color map: place and red, green, blue of each color, grey below 0 N."""
    zero = _GREY / (1 + _GREY)
    places = [0.0, 0.98 * zero, *np.linspace(zero, 1.0, len(TENSION_COLORS))]
    colors = np.array([SLACK_COLOR, SLACK_COLOR, *TENSION_COLORS]) / 255
    return np.column_stack([places, colors]).ravel()


def _rgb(color: str) -> int:
    red, green, blue = ImageColor.getrgb(color)[:3]
    return red << 16 | green << 8 | blue
