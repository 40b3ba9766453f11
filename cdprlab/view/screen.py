"""What stills and films are made of: a robot with title, clock, caption and tension scale, drawn again and again."""

from typing import Any

from matplotlib.figure import Figure

from ..arrays import as_count
from ..errors import InvalidInput, quoted
from .picture import Frame, Picture
from .style import INK, VERMILION, house_style

_WIDTH, HEIGHT = 640, 516
"""Of a screen at its natural size [pixels]; in others everything grows alike."""


class Screen:
    """A figure with a line for title and clock, a second one for captions, and room for a picture below.

    title : of all pictures
    width : [pixels]
    captioned : whether there is a second line
    """

    def __init__(self, title: str, width: int, captioned: bool) -> None:
        self.figure = sized_figure(as_count(width, "width"), round(HEIGHT * width / _WIDTH), width / _WIDTH)
        self.top, line = 1 - (56 if captioned else 30) / HEIGHT, 1 - 22 / HEIGHT
        with house_style():
            self.figure.text(0.02, line, title, color=INK,
                             fontsize=min(11.5, 740 / max(len(title), 1)))
            self._clock = self.figure.text(0.98, line, "", color=INK, ha="right", fontsize=11.5,
                                           animated=True)
            self._caption = self.figure.text(0.02, self.top + 0.012, "", color=VERMILION,
                                             animated=True)
        self._picture = Picture(self.figure)

    def show(self, time: float, caption: str = "") -> Frame:
        """(height, width, 3) the picture as it is now, with this time [s] and caption."""
        self._clock.set_text(f"t = {time:5.2f} s")
        self._caption.set(text=caption, fontsize=min(13.0, 1000 / max(len(caption), 1)))
        with house_style():
            return self._picture.pixels()


def check_like(value: Any, kind: str = "Run", attribute: str = "commanded_tensions") -> None:
    """Raises InvalidInput for what has not the columns of a run, or not those of a state."""
    if not hasattr(value, attribute):
        raise InvalidInput(f"a {kind} is drawn here, got {quoted(value)}")


def sized_figure(width: int, height: int, scale: float | None = None) -> Figure:
    """A figure of so many pixels.

    scale : of lines and letters, 1 for a picture of 640 x 480; default as large as the figure,
        at least a half
    Raises InvalidInput below 16 x 16 pixels and above 10000 x 10000.
    """
    as_count(width, "width", 16, 10_000)
    as_count(height, "height", 16, 10_000)
    dpi = 100 * (scale or max(0.5, min(width / 640, height / 480)))
    # Matplotlib cuts off parts of pixels: half a one more, or rounding would lose one.
    return Figure(((width + 0.5) / dpi, (height + 0.5) / dpi), dpi=dpi)


def robot_axes(figure: Figure, dimension: int, bottom: float = 0.0, top: float = 1.0) -> Any:
    """Axes over the whole width between two heights; planar ones with room for their ticks."""
    width, height = figure.get_size_inches()
    left, below, above = (0.75, 0.5, 0.05) if dimension == 2 else (0.0, 0.0, 0.0)
    return figure.add_axes((left / width, bottom + below / height, 1 - 1.1 * left / width,
                            top - bottom - (below + above) / height))
