"""Stills and films: of an engine's state, of a run, and of whatever gives frames."""

from collections.abc import Iterable
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import ListedColormap, Normalize
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator
from PIL import Image, ImageColor
from PIL.PngImagePlugin import PngInfo

from ..arrays import Array, as_count, as_number, checked
from ..simulate.state import State
from ..world.files import checked_path, replaced
from ..world.model import Scene
from .drawing import SLACK_DASHES, RobotDrawing
from .outlines import landmarks
from .picture import Frame as Frame, Picture
from .screen import HEIGHT, Screen, check_like, robot_axes, sized_figure
from .style import AXIS_COLORS, INK, SLACK_COLOR, TRAIL, house_style, tension_colors

LARGEST_FILE = 3_000_000
"""Bytes: what mail, chat and slides take without complaint."""

_LONGEST = 12.0
_MOST_PICTURES = 5_000
"""Of one film: all of them are in memory at once, a megabyte each."""
_PAUSE = 1000
"""[ms] The last picture stays for a moment before the film starts again."""

_ECONOMIES = ((1, 128), (1, 80), (2, 80), (3, 64), (4, 64), (8, 48), (16, 48))
"""(every how many frames, colors), tried in turn until the film is small enough."""


def draw(state: State, width: int = 640, height: int = 480) -> Frame:
    """A picture of an engine's present state, cables colored by tension: ``draw(engine.state())``.

    state : what `Simulator.state` tells
    width, height : [pixels]
    Returns (height, width, 3).

    >>> import cdprlab as cl
    >>> with cl.open_simulator(cl.load_world("planar_rigid")) as engine:
    ...     draw(engine.state(), 320, 240).shape
    (240, 320, 3)
    """
    check_like(state, "State", "rope_lengths")
    figure = sized_figure(width, height)
    with house_style():
        axes = robot_axes(figure, state.robot.dimension)
        drawing = RobotDrawing(axes, state.robot, state.scene, state.pose, solid=True)
        drawing.move(state.pose, state.tensions, state.rope_lengths, state.boxes)
        return Picture(figure).pixels()


@checked
def save_film(run: Any, path: str | Path, seconds: float | None = None, fps: int = 12,
              width: int = 640) -> Path:
    """An animated GIF of a run, below ``LARGEST_FILE``.

    run : Run
    path : ends in .gif
    seconds : length of the film [s]; default that of the run, at most 12
    fps : pictures per second
    width : [pixels]
    Raises InvalidInput for a bad path or numbers that make no film.
    """
    check_like(run)
    lasting = run.time.max(initial=0.0)
    length = min(lasting, _LONGEST) if seconds is None else seconds
    parts = max(12, picture_count(length, fps))
    times = np.linspace(0.0, lasting, parts + 1)
    return save_gif(map(RunScreen(run, width).at, times), path, length / parts, _caption(run))


@checked
def still(run: Any, path: str | Path, t: float = 0.0, width: int = 960) -> Path:
    """A PNG of a run at time ``t`` [s], laid out as a frame of the film, with a text description inside.

    path : ends in .png
    width : [pixels]
    """
    return save_png(RunScreen(run, width).at(t), path,
                    f"{_caption(run)} State at t = {t:.2f} s.")


class RunScreen(Screen):
    """Pictures of a run, at whatever time, its cables colored by tension, and the scale below.

    run : Run; width : [pixels]
    scene : what stands around it, by default that of the run's world; captioned : whether
        `words` are shown
    """

    def __init__(self, run: Any, width: int, scene: Scene | None = None,
                 captioned: bool = False) -> None:
        check_like(run)
        super().__init__(run.world.title, width, captioned)
        self.run, robot, scene = run, run.world.robot, scene or run.world.scene
        some = evenly(len(run.time), 20)
        also = [landmarks(run.robot_at(k), scene) for k in some]
        with house_style():
            axes = robot_axes(self.figure, robot.dimension, 60 / HEIGHT, self.top)
            self.drawing = RobotDrawing(axes, robot, scene, run.poses[some], solid=True,
                                        also=also)
            self._draw_scale()

    def _draw_scale(self) -> None:
        """Color bar with round numbers around all tensions [N]; what grey dashes and the thin line mean."""
        tau = self.run.measured_tensions
        taut = tau[tau > 0]   # the last row is measured at the end of its step: a cut cable is NaN there, and slack
        # A few extremes share the last color.
        low, high = np.percentile(taut, [0, 99.8]) if taut.size else (0.0, 1.0)
        round_numbers = MaxNLocator(5, steps=[1, 2, 5, 10])
        ticks = round_numbers.tick_values(low, max(high, low + 1e-3 * high))
        self.drawing.limits = limits = ticks[0], ticks[-1]
        shades = tension_colors(np.linspace(max(limits[0], 1e-9), limits[1], 48), limits) / 255
        bar = self.figure.colorbar(ScalarMappable(Normalize(*limits), ListedColormap(shades)),
                                   cax=self.figure.add_axes(
                                       (0.22, 28 / HEIGHT, 0.46, 14 / HEIGHT)),
                                   orientation="horizontal", ticks=ticks)
        bar.outline.set_visible(False)
        self.figure.text(0.02, 35 / HEIGHT, "cable tension [N]", color=INK, va="center",
                         fontsize=10)
        grey: Any = np.array(SLACK_COLOR) / 255
        keys = [Line2D([], [], color=grey, linestyle=SLACK_DASHES, label="slack or cut"),
                Line2D([], [], color=TRAIL, label="path of P so far")]
        self.figure.legend(handles=keys, loc="lower right", borderaxespad=0.2, labelcolor=INK)

    def at(self, t: float) -> Frame:
        """(height, width, 3) the picture at a time of the run [s]."""
        return self.show(self.run.time[index_at(self.run.time, t)], self.move(t))

    def move(self, t: float) -> str:
        """The robot at a time of the run [s]; returns what it does."""
        run, k = self.run, index_at(self.run.time, t)
        state = state_at(run, k)
        if run.base_poses is not None:
            self.drawing.drive(state.robot)
        self.drawing.move(state.pose, state.tensions, state.rope_lengths, state.boxes,
                          run.poses.position[evenly(k + 1, 50)])
        return self.words(k)

    def words(self, index: int) -> str:
        """What is done at a control step."""
        return ""


def evenly(count: int, most: int) -> list[int]:
    """Which of so many are kept, the first and the last one among them.

    >>> evenly(10, 4)
    [0, 3, 6, 9]
    """
    return np.linspace(0, count - 1, min(count, most)).round().astype(int).tolist()


def index_at(times: Array, t: float) -> int:
    """Of the row at a time, or the first one after it; the last one after the end."""
    return min(int(np.searchsorted(times, t - 1e-9)), len(times) - 1)


def state_at(run: Any, k: int) -> State:
    """A run's step as its engine told it; rope lengths are what is let out as it begins.

    run : Run
    """
    wound = run.commanded_lengths
    let_out = None if wound is None else wound[k - 1] if k else run.lengths[0]
    return State(float(run.time[k]), run.robot_at(k), run.poses.position[k],
                 run.poses.rotation[k], run.twists[k],
                 run.measured_tensions[k], run.world.scene, let_out, run.boxes_at(k))


def _caption(run: Any) -> str:
    side = "front" if run.world.engine == "planar" else "front and above"
    return (f"{run.world.title}, task {run.task}: platform, frame and {run.world.robot.n_cables} cables colored by "
            f"tension, seen from the {side}.")


# --- files ------------------------------------------------------------------------------------------------
def picture_count(seconds: float, fps: int) -> int:
    """Pictures of a film that lasts so many seconds; raises InvalidInput where that makes none, or too many.

    >>> picture_count(2.0, 12)
    24
    """
    rate = as_count(fps, "fps", maximum=1000)
    return as_count(round(as_number(seconds, "seconds", "s", positive=True) * rate),
                    "seconds × fps", 0, _MOST_PICTURES)


def save_gif(frames: Iterable[Frame], path: str | Path, period: float,
             description: str) -> Path:
    """An animated GIF below ``LARGEST_FILE``: fewer colors, then fewer pictures, where it must be.

    frames : (height, width, 3) each
    path : ends in .gif
    period : from one picture to the next [s]; the film lasts that long a picture but the last,
        whatever number of pictures is left out
    description : goes into the file
    Raises InvalidInput for a bad path, before the first frame is drawn.
    """
    target = checked_path(path, ".gif")
    pictures = list(map(Image.fromarray, frames))
    gaps = len(pictures) - 1
    length = round(100 * period * gaps)
    for every, colors in _ECONOMIES:
        # GIF counts time in 10 ms, and players slow down what is shorter than two of them.
        parts = min(gaps // every, length // 2)
        ticks = np.diff(np.linspace(0, length, parts + 1).round().astype(int))
        chosen = [pictures[i] for i in evenly(len(pictures), parts + 1)]
        palette = _palette(chosen, colors)
        flat = [frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in chosen]
        film = BytesIO()
        flat[0].save(film, "gif", save_all=True, append_images=flat[1:], loop=0, optimize=False,
                     disposal=1, duration=[*(10 * ticks).tolist(), _PAUSE],
                     comment=description.encode("ascii", "replace"))
        if film.tell() < LARGEST_FILE:
            break
    with replaced(target) as file:
        file.write(film.getbuffer())
    return target


def save_png(picture: Frame, path: str | Path, description: str) -> Path:
    """A PNG with its description inside; the path ends in .png."""
    target = checked_path(path, ".png")
    with replaced(target) as file:
        file.write(as_png(picture, description))
    return target


def as_png(picture: Frame, description: str) -> bytes:
    """The same as the bytes of a file."""
    text, file = PngInfo(), BytesIO()
    text.add_itxt("Description", description)
    Image.fromarray(picture).save(file, "png", pnginfo=text, optimize=True)
    return file.getvalue()


def _palette(frames: list[Image.Image], colors: int) -> Image.Image:
    """One palette for all frames, so that colors do not flicker.

    The colors that carry meaning are in it as they are: thin lines would lose theirs to large
    grey surfaces.
    """
    meaning = [*tension_colors(np.linspace(1e-9, 1, 24), (0.0, 1.0)).tolist(), SLACK_COLOR]
    meaning += map(ImageColor.getrgb, ("#FFFFFF", INK, TRAIL, *AXIS_COLORS))
    sheet = Image.fromarray(np.concatenate([np.asarray(frames[i])
                                            for i in evenly(len(frames), 4)]))
    others = sheet.quantize(colors - len(meaning),
                            method=Image.Quantize.MEDIANCUT).getpalette() or []
    palette = Image.new("P", (1, 1))
    # White stays white, not tinted.
    palette.putpalette([*np.ravel(meaning).tolist(),
                        *(255 if value > 246 else value for value in others)])
    return palette
