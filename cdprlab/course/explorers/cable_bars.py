"""Tensions as bars, a word at the end of each."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from ...arrays import Array
from ...view.style import INK


class CableBars:
    """A bar for each of m cables.

    axes : of their own, 0 to ``end`` [N]
    gap : between a bar and its word [N]
    """

    def __init__(self, axes: Axes, m: int, end: float, gap: float) -> None:
        self.axes, self.gap, cables = axes, gap, np.arange(1, m + 1)
        axes.set(xlim=(0.0, end), ylim=(m + 0.5, 0.5), xlabel="tension [N]", ylabel="cable",
                 yticks=cables)

    def draw(self, lengths: Array, words: Sequence[str], ends: Array | None = None, **look: Any) -> None:
        """Bars of these (m,) lengths [N], words beyond their ``ends``, or beyond other ones [N]."""
        self.bars = self.axes.barh(range(1, len(words) + 1), lengths, height=0.62,
                                   zorder=2, **look)
        self.words = [self.axes.text(float(end) + self.gap, k, word, va="center", fontsize=9,
                                     color=INK, zorder=5)
                      for k, (end, word) in enumerate(zip(lengths if ends is None else ends, words), start=1)]
