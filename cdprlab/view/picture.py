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

_WHITE = 255


class Picture:
    """Draws a figure again and again.

    Artists with ``animated=True`` go over a kept picture of all others; as soon as one of the
    others has changed (matplotlib marks it stale), its panel is drawn anew. The layout is
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
        self._changed: list[Any] = []
        self._slots: list[tuple[slice, slice]] | None = None

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
        changed = zip(panels, still, self._still())
        # Axes call themselves stale for any new artist, though this one is drawn anyway.
        self._changed += [axes for axes, old, new in changed if (old != new if self._added else axes.stale)]
        if self._added:
            self.figure.stale = bool(self._changed)

    def pixels(self) -> NDArray[np.uint8]:
        """(height, width, 3) the figure as it is now."""
        renderer = self._canvas.get_renderer()
        first = self._background is None
        if first:
            self._lay_out()
        elif self._changed and self._slots is None:
            self._slots = self._parted(renderer)
        if first or (self.figure.stale and not self._redrawn(renderer)):
            self._canvas.draw()
            if self._slots:   # for lack of room in one: they are parted anew
                self._slots = None
        elif not self.figure.stale:
            self._canvas.restore_region(self._background)
        if first or self.figure.stale:
            self._background = self._canvas.copy_from_bbox(self.figure.bbox)
        self.figure.stale, self._changed = False, []
        for artist in self._moving():
            artist.draw(renderer)
        return np.array(self._canvas.buffer_rgba())[..., :3]

    def png(self) -> bytes:
        """The same as a file."""
        buffer = BytesIO()
        Image.fromarray(self.pixels()).save(buffer, "png", compress_level=1,
                                            compress_type=_RUN_LENGTHS)
        return buffer.getvalue()

    def _redrawn(self, renderer: Any) -> bool:
        """Draw what changed panel by panel; False where one has none to itself, or words that reach out of it."""
        if not (self._changed and self._slots):
            return False
        self._canvas.restore_region(self._background)
        height = self.figure.bbox.height
        for axes in dict.fromkeys(self._changed):
            rows, columns = slot = self._slots[self.figure.axes.index(axes)]
            left, low, right, high = axes.get_tightbbox(renderer).extents
            if not (columns.start <= left and right <= columns.stop
                    and rows.start <= height - high and height - low <= rows.stop):
                return False
            np.asarray(renderer.buffer_rgba())[slot] = _WHITE
            axes.draw(renderer)
        return True

    def _lay_out(self) -> None:
        """Axes to their places, for good; titles, which say what moves, move from now on."""
        for axes in self.figure.axes:
            axes.apply_aspect()
        engine = self.figure.get_layout_engine()
        if engine is not None:
            engine.execute(self.figure)
        self.figure.set_layout_engine("none")
        for axes in self.figure.axes:
            for text in axes.get_children():
                if isinstance(text, Text) and text.get_transform() != axes.transData:
                    text.set_animated(True)

    def _parted(self, renderer: Any) -> list[tuple[slice, slice]]:
        """Rows and columns of pixels that are a panel's alone, halfway to its neighbors; none where panels overlap."""
        panels = self.figure.axes
        parts: list[Any] = [*panels, *self.figure.legends, *self.figure.texts]
        boxes = np.array([part.get_tightbbox(renderer).extents for part in parts])
        slots = []
        for box in boxes[:len(panels)]:
            ends = [0, 0, *self.figure.bbox.size]
            for axis in (0, 1):
                low, high = box[axis], box[axis + 2]
                ends[axis] = max([0, *(boxes[boxes[:, axis + 2] <= low, axis + 2] + low) / 2])
                ends[axis + 2] = min([ends[axis + 2], *(boxes[boxes[:, axis] >= high, axis] + high) / 2])
            inside = (boxes[:, :2] < ends[2:]).all(axis=1) & (boxes[:, 2:] > ends[:2]).all(axis=1)
            if inside.sum() > 1:
                return []
            left, low, right, high = (round(end) for end in ends)
            height = round(self.figure.bbox.height)
            slots.append((slice(height - high, height - low), slice(left, right)))
        return slots

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
