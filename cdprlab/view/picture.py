"""A matplotlib figure as pixels or PNG, quickly: what stands still is drawn once."""

import struct
import zlib
from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.backends.backend_agg import FigureCanvasAgg, RendererAgg
from matplotlib.figure import Figure
from matplotlib.text import Text
from numpy.typing import NDArray

Frame = NDArray[np.uint8]
"""(height, width, 3) red, green, blue."""

_WHITE = 0xFFFFFFFF


class _Renderer(RendererAgg):
    """Words are drawn once and then copied, to whole pixels: they take most of a picture's time."""

    def __init__(self, width: float, height: float, dpi: float) -> None:
        super().__init__(width, height, dpi)  # type: ignore[no-untyped-call]
        self._drawn = lru_cache(2000)(self._draw_words)

    def draw_text(self, gc: Any, x: float, y: float, s: str, prop: Any, angle: float,
                  ismath: Any = False,
                  mtext: Any = None) -> None:
        left, below, image = self._drawn(s, prop, angle, ismath, gc.get_rgb())
        self.draw_image(gc, round(x + left), round(self.height - y + below), image)

    def _draw_words(self, s: str, prop: Any, angle: float, ismath: Any,
                    color: Any) -> tuple[int, int, Any]:
        """Where its lower left corner is, seen from where the words begin, and (height, width, 4) the image."""
        width, height, descent = self.get_text_width_height_descent(  # type: ignore[no-untyped-call]
            s, prop, ismath)
        turn = np.exp(1j * np.deg2rad(angle))
        up = 1j * np.array([-descent, height - descent])
        corners = turn * (np.array([[0], [width]]) + up)
        left, below = int(corners.real.min()) - 3, int(corners.imag.min()) - 3
        sheet: Any = RendererAgg(  # type: ignore[no-untyped-call]
            int(corners.real.max()) + 3 - left, int(corners.imag.max()) + 3 - below, self.dpi)
        gc = sheet.new_gc()
        gc.set_foreground(color, isRGBA=True)
        sheet.draw_text(gc, -left, sheet.height + below, s, prop, angle, ismath)
        return left, below, np.array(sheet.buffer_rgba())[::-1]


class _Canvas(FigureCanvasAgg):
    def get_renderer(self) -> RendererAgg:
        if not hasattr(self, "renderer"):
            self.renderer = _Renderer(*self.get_width_height(physical=True), self.figure.dpi)
        return self.renderer


def _move(artist: Artist) -> None:
    """Draw it over the kept picture; where it is now is no matter of the layout."""
    artist.set_animated(True)
    artist.set_in_layout(False)


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
        self._canvas: Any = _Canvas(figure)
        self._background: Any = None
        self._added: list[Artist] = []
        self._changed: list[Any] = []
        self._slots: list[tuple[slice, slice]] = []

    def redraw(self, draw: Callable[[], None]) -> None:
        """Let ``draw`` move artists, or add some: those go before the next call, and leave what stands still alone."""
        panels = self.figure.axes
        for artist in self._added:
            artist.remove()
        before = {artist for axes in panels for artist in axes.get_children()}
        still = self._still()
        try:
            draw()
        finally:
            self._added = [artist for axes in panels for artist in axes.get_children()
                           if artist not in before]
            for artist in self._added:
                _move(artist)
            for axes in panels:
                axes.containers.clear()
        changed = zip(panels, still, self._still())
        # Axes call themselves stale for any new artist, though this one is drawn anyway.
        self._changed += [axes for axes, old, new in changed
                          if (old != new if self._added else axes.stale)]
        if self._added:
            self.figure.stale = bool(self._changed)

    def pixels(self) -> Frame:
        """(height, width, 3) the figure as it is now."""
        renderer = self._canvas.get_renderer()
        if self._background is None:
            self._lay_out()
        if self._background is None or self.figure.stale:
            if not self._redrawn(renderer):
                self._canvas.draw()
                # Of what is drawn now: whatever takes its place later wipes all of it.
                self._slots = self._parted(renderer) if self.figure.axes else []
            self._background = self._canvas.copy_from_bbox(self.figure.bbox)
        else:
            self._canvas.restore_region(self._background)
        self.figure.stale, self._changed = False, []
        for part in (self.figure, *self.figure.axes):
            for artist in sorted(part.get_children(), key=Artist.get_zorder):
                if artist.get_animated():
                    artist.draw(renderer)
        # Color by color: a third of the time of a copy of three of every four numbers.
        return np.stack(np.moveaxis(self._canvas.buffer_rgba(), -1, 0)[:3], axis=-1)

    def png(self) -> bytes:
        """The same as a file."""
        pixels = self.pixels()
        height, width, _ = pixels.shape
        # By hand: Pillow tries five filters on every row, and writes more for twice the time.
        rows = np.pad(pixels.reshape(height, -1), ((0, 0), (1, 0)))
        parts = {b"IHDR": struct.pack(">2I5B", width, height, 8, 2, 0, 0, 0),
                 b"IDAT": zlib.compress(rows.tobytes(), 1), b"IEND": b""}
        return b"\x89PNG\r\n\x1a\n" + b"".join(
            struct.pack(">I", len(part)) + kind + part
            + struct.pack(">I", zlib.crc32(kind + part))
            for kind, part in parts.items())

    def _redrawn(self, renderer: Any) -> bool:
        """Draw what changed panel by panel; False where one has none to itself, or words that reach out of it."""
        if not self._slots or not self._changed:
            return False
        self._canvas.restore_region(self._background)
        canvas = np.asarray(renderer.buffer_rgba())[::-1].view(np.uint32)[..., 0]   # from below
        before, outside = canvas.copy(), np.ones(canvas.shape, bool)
        for axes in dict.fromkeys(self._changed):
            slot = self._slots[self.figure.axes.index(axes)]
            canvas[slot], outside[slot] = _WHITE, False
            axes.draw(renderer)
        return not ((canvas != before) & outside).any()

    def _lay_out(self) -> None:
        """Axes to their places, for good; titles, which say what moves, move from now on."""
        engine = self.figure.get_layout_engine()
        if engine is not None:
            engine.execute(self.figure)
        self.figure.set_layout_engine("none")
        for axes in self.figure.axes:
            for text in axes.get_children():
                if isinstance(text, Text) and text.get_transform() != axes.transData:
                    _move(text)

    def _parted(self, renderer: Any) -> list[tuple[slice, slice]]:
        """Rows, from below, and columns of pixels that are a panel's alone, halfway to its neighbors.

        None where panels overlap.
        """
        panels, size = self.figure.axes, self.figure.bbox.size
        boxes: Any = [part.get_tightbbox(renderer)
                      for part in (*panels, *self.figure.legends, *self.figure.texts)]
        lows, highs = np.swapaxes(boxes, 0, 1)
        slots = []
        for low, high, _ in zip(lows, highs, panels):
            start = np.where(highs <= low, highs + low, 0).max(axis=0) / 2
            end = np.where(lows >= high, lows + high, 2 * size).min(axis=0) / 2
            if ((lows < end) & (highs > start)).all(axis=1).sum() > 1:
                return []
            (left, bottom), (right, top) = np.rint([start, end]).astype(int)
            slots.append((slice(bottom, top), slice(left, right)))
        return slots

    def _still(self) -> list[Any]:
        """Of each panel what is drawn anew when it changes, whatever is added: limits and words."""
        return [(axes.get_xlim(), axes.get_ylim(), axes.get_xlabel(), axes.get_ylabel(),
                 *(artist.get_text() for artist in axes.get_children()
                   if isinstance(artist, Text) and not artist.get_animated()))
                for axes in self.figure.axes]
