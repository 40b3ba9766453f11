"""A matplotlib figure as pixels or PNG, quickly: what stands still is drawn once."""

from collections.abc import Callable
from io import BytesIO
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text
from numpy.typing import NDArray
from PIL import Image

_RUN_LENGTHS = 3
"""zlib's Z_RLE: large even areas compress as well as with a search for repeats, in a third of the time."""


class Picture:
    """Draws a figure again and again.

    Artists with ``animated=True`` go over a kept picture of all others; as soon as one of the
    others has changed (matplotlib marks it stale), everything is drawn anew. The layout is
    computed once, so that axes stay in place.

    >>> figure = Figure((1.0, 1.0), dpi=100)
    >>> Picture(figure).png()[1:4]
    b'PNG'
    """

    def __init__(self, figure: Figure) -> None:
        self.figure = figure
        self._canvas: Any = FigureCanvasAgg(figure)
        self._background: Any = None
        self._added: list[Artist] = []

    def redraw(self, draw: Callable[[], None]) -> None:
        """Let ``draw`` move artists, or add some: those go before the next call, and leave what stands still alone."""
        panels = self.figure.axes
        for artist in self._added:
            artist.remove()
        before, still = {artist for axes in panels for artist in axes.get_children()}, self._still()
        try:
            draw()
        finally:
            self._added = [artist for axes in panels for artist in axes.get_children()
                           if artist not in before]
            for artist in self._added:
                artist.set_animated(True)
            for axes in panels:
                axes.containers.clear()
        if self._added:  # axes call themselves stale for any new artist, though this one is drawn anyway
            self.figure.stale = self._still() != still

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
        Image.fromarray(self.pixels()).save(buffer, "png", compress_level=1,
                                            compress_type=_RUN_LENGTHS)
        return buffer.getvalue()

    def _still(self) -> list[Any]:
        """Of each panel what is drawn anew when it changes, whatever is added: limits and words."""
        return [(axes.get_xlim(), axes.get_ylim(), axes.get_xlabel(), axes.get_ylabel(),
                 *(artist.get_text() for artist in axes.get_children()
                   if isinstance(artist, Text) and not artist.get_animated()))
                for axes in self.figure.axes]

    def _moving(self) -> list[Any]:
        """Animated artists, panel by panel, from the back to the front."""
        moving = [artist for artist in self.figure.get_children() if artist.get_animated()]
        for axes in self.figure.axes:
            moving += sorted((artist for artist in axes.get_children()
                              if artist.get_animated()),
                             key=lambda artist: artist.get_zorder())
        return moving
