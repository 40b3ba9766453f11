"""Tensions as bars that move, a word at the end of each."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from ...view.style import INK


class CableBars:
    """A bar for each of m cables.

    axes : of their own, 0 to ``end`` [N]
    gap : between a bar and its word [N]
    """

    def __init__(self, axes: Axes, m: int, end: float, gap: float) -> None:
        cables = np.arange(1, m + 1)
        self.gap = gap
        self.bars = axes.barh(cables, np.zeros(m), height=0.62, zorder=2)
        for bar in self.bars:
            bar.set_animated(True)
        self.words = [axes.text(0, float(cable), "", va="center", fontsize=9, color=INK, zorder=5, animated=True)
                      for cable in cables]
        axes.set(xlim=(0.0, end), ylim=(m + 0.5, 0.5), xlabel="tension [N]", ylabel="cable", yticks=cables)

    def move(self, lengths: ArrayLike, words: Sequence[str], ends: ArrayLike | None = None) -> None:
        """Bars of these (m,) lengths [N], words beyond their ``ends``, or beyond other ones [N]."""
        wide = np.asarray(lengths, dtype=float)
        for bar, length, label, word, end in zip(self.bars, wide, self.words, words,
                                                 wide if ends is None else np.asarray(ends)):
            bar.set_width(float(length))
            label.set_text(word)
            label.set_x(float(end) + self.gap)
