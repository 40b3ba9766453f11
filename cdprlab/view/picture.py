"""A matplotlib figure as pixels or PNG, quickly: what stands still is drawn once."""

from __future__ import annotations

from io import BytesIO
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import Image

_RUN_LENGTHS = 3
"""zlib's Z_RLE: large even areas compress as well as with a search for repeats, in a third of the time."""


class Picture:
    """Draws a figure again and again.

    Artists with ``animated=True`` go over a kept picture of all others; as soon as one of the others has changed
    (matplotlib marks it stale), everything is drawn anew. The layout is computed once, so that axes stay in place.

    >>> figure = Figure((1.0, 1.0), dpi=100)
    >>> Picture(figure).png()[1:4]
    b'PNG'
    """

    def __init__(self, figure: Figure) -> None:
        self.figure = figure
        self._canvas: Any = FigureCanvasAgg(figure)
        self._background: Any = None

    def pixels(self) -> NDArray[np.uint8]:
        """(height, width, 3) the figure as it is now."""
        if self._background is None or self.figure.stale:
            self._canvas.draw()
            self.figure.set_layout_engine("none")
            self.figure.stale = False
            self._background = self._canvas.copy_from_bbox(self.figure.bbox)
        else:
            self._canvas.restore_region(self._background)
        renderer = self._canvas.get_renderer()
        for artist in self._moving():
            artist.draw(renderer)
        return np.array(self._canvas.buffer_rgba())[..., :3]

    def png(self) -> bytes:
        """The same as a file."""
        buffer = BytesIO()
        Image.fromarray(self.pixels()).save(buffer, "png", compress_level=1, compress_type=_RUN_LENGTHS)
        return buffer.getvalue()

    def _moving(self) -> list[Any]:
        """Animated artists, panel by panel, from the back to the front."""
        moving = [artist for artist in self.figure.get_children() if artist.get_animated()]
        for axes in self.figure.axes:
            moving += sorted((artist for artist in axes.get_children() if artist.get_animated()),
                             key=lambda artist: artist.get_zorder())
        return moving
