"""What stills and films are made of: a robot with title, clock, caption and tension scale, drawn again and again."""

from typing import Any

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import ListedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator
from numpy.typing import ArrayLike, NDArray

from ..arrays import as_count
from ..errors import InvalidInput, quoted
from ..robot import Robot
from ..robot.pose import Pose
from ..world.model import Scene
from .drawing import SLACK_DASHES, RobotDrawing
from .picture import Picture
from .style import INK, SLACK_COLOR, TRAIL, VERMILION, house_style, tension_colors

_MOST = 10_000
_WIDTH, _HEIGHT = 640, 516
"""Of a screen at its natural size [pixels]; in others everything grows alike."""


class Screen:
    """A figure with a line for title and clock, a second one for captions, and room for a picture below.

    title : of all pictures
    width : [pixels]
    captioned : whether there is a second line
    """

    def __init__(self, title: str, width: int, captioned: bool = False) -> None:
        as_count(width, "width", 16, _MOST)
        self.figure = sized_figure(width, round(_HEIGHT * width / _WIDTH), width / _WIDTH)
        self.top = 1 - (56 if captioned else 30) / _HEIGHT
        with house_style():
            self._write(0.02, "left", title, INK, fontsize=min(11.5, 740 / max(len(title), 1)))
            self._clock = self._write(0.98, "right", "", INK, fontsize=11.5, animated=True)
            self._caption = self.figure.text(0.02, self.top + 0.012, "", color=VERMILION,
                                             animated=True)
        self._picture = Picture(self.figure)

    def show(self, time: float, caption: str = "") -> NDArray[np.uint8]:
        """(height, width, 3) the picture as it is now, with this time [s] and caption."""
        self._clock.set_text(f"t = {time:5.2f} s")
        self._caption.set(text=caption, fontsize=min(13.0, 1000 / max(len(caption), 1)))
        with house_style():
            return self._picture.pixels()

    def _write(self, x: float, align: str, words: str, color: str, **options: Any) -> Any:
        return self.figure.text(x, 1 - 22 / _HEIGHT, words, color=color, ha=align, **options)


class RobotScreen(Screen):
    """A robot, its cables colored by tension, and the scale below.

    robot, scene : what is drawn
    poses, also : what must fit into the picture, see `RobotDrawing`
    tensions : (…) [N] all that will be shown: one scale for them
    """

    def __init__(self, robot: Robot, scene: Scene, poses: Pose, tensions: ArrayLike, title: str,
                 width: int, *,
                 captioned: bool = False, also: ArrayLike = ()) -> None:
        super().__init__(title, width, captioned)
        below = 60 / _HEIGHT
        with house_style():
            self.drawing = RobotDrawing(robot_axes(self.figure, robot.dimension, below, self.top), robot, scene, poses,
                                        solid=True, also=also)
            ticks = _ticks(tensions)
            self.drawing.limits = float(ticks[0]), float(ticks[-1])
            self._draw_scale(ticks)

    def _draw_scale(self, ticks: NDArray[np.float64]) -> None:
        """Color bar with its ticks [N]; what grey dashes and the thin line mean."""
        limits = self.drawing.limits
        shades = tension_colors(np.linspace(max(limits[0], 1e-9), limits[1], 48), limits) / 255
        scale = ScalarMappable(Normalize(*limits), ListedColormap(shades))
        bar = self.figure.colorbar(scale, cax=self.figure.add_axes((0.22, 28 / _HEIGHT, 0.46,
                                                                    14 / _HEIGHT)),
                                   orientation="horizontal", ticks=ticks)
        bar.outline.set_visible(False)
        self.figure.text(0.02, 35 / _HEIGHT, "cable tension [N]", color=INK, va="center",
                         fontsize=10)
        grey: Any = np.array(SLACK_COLOR) / 255
        keys = [Line2D([], [], color=grey, linestyle=SLACK_DASHES, label="slack or cut"),
                Line2D([], [], color=TRAIL, label="path of P so far")]
        self.figure.legend(handles=keys, loc="lower right", borderaxespad=0.2, labelcolor=INK)


def check_like(value: Any, kind: str, attribute: str) -> None:
    """Raises InvalidInput for what has not the columns of a run, or not those of a state."""
    if not hasattr(value, attribute):
        raise InvalidInput(f"a {kind} is drawn here, got {quoted(value)}")


def sized_figure(width: int, height: int, scale: float | None = None) -> Figure:
    """A figure of so many pixels.

    scale : of lines and letters, 1 for a picture of 640 x 480; default as large as the figure,
        at least a half
    Raises InvalidInput below 16 x 16 pixels and above 10000 x 10000.
    """
    for name, pixels in (("width", width), ("height", height)):
        as_count(pixels, name, 16, _MOST)
    dpi = 100 * (scale or max(0.5, min(width / 640, height / 480)))
    # Matplotlib cuts off parts of pixels: half a one more, or rounding would lose one.
    return Figure(((width + 0.5) / dpi, (height + 0.5) / dpi), dpi=dpi)


def robot_axes(figure: Figure, dimension: int, bottom: float = 0.0, top: float = 1.0) -> Any:
    """Axes over the whole width between two heights; planar ones with room for their ticks."""
    width, height = figure.get_size_inches()
    left, below, above = (0.75 / width, 0.5 / height, 0.05 / height) if dimension == 2 else (0.0, 0.0, 0.0)
    return figure.add_axes((left, bottom + below, 1 - 1.1 * left, top - bottom - below - above))


def _ticks(tensions: ArrayLike) -> NDArray[np.float64]:
    """Round numbers around all tensions [N]; a few extremes share the last color."""
    tau = np.asarray(tensions, dtype=float)
    taut = tau[np.isfinite(tau) & (tau > 0)]
    low, high = (float(taut.min()), float(np.percentile(taut, 99.8))) if taut.size else (0.0, 1.0)
    return np.asarray(MaxNLocator(5, steps=[1, 2, 5, 10]).tick_values(low, max(high, low + 1e-3 * high)))
