"""A formula beside what it is compared with, and what is left between them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

import numpy as np
from numpy.typing import ArrayLike

from ...arrays import Array, as_array, checked
from ...errors import InvalidInput, quoted
from ...view.plots import Figure
from ...view.style import CABLE_DASHES, INK, cable_style, house_style


@checked
def plot_comparison(x: Annotated[Array, "(N,)"], pairs: Mapping[str, tuple[ArrayLike, ArrayLike]], xlabel: str,
                    ylabel: str,
                    title: str = "", names: tuple[str, str] = ("engine", "formula")) -> Figure:
    """Two panels: each pair as a wide band (first) under a thin line (second); below, the second minus the first.

    x : (N,) what both are drawn over
    pairs : label → (measured, computed), each (N,)
    xlabel, ylabel : with units; the residual takes ``ylabel``'s
    names : what the first and the second of each pair are
    Raises InvalidInput where lengths differ.

    >>> figure = plot_comparison([0, 1, 2], {"z": ([0, 1, 4], [0, 1, 3])}, "time [s]", "height [m]")
    >>> [axes.get_ylabel() for axes in figure.axes]
    ['height [m]', 'residual [m]']
    """
    import matplotlib.pyplot as plt

    figure: Any
    with house_style():
        figure, (above, below) = plt.subplots(2, 1, FigureClass=Figure, figsize=(7, 5),
                                              sharex=True, layout="constrained", height_ratios=(3, 2))
        for index, (label, pair) in enumerate(pairs.items()):
            first, second = (as_array(values, label, ("N",), limit=np.inf) for values in pair)
            if not first.shape == second.shape == (x.size,):
                raise InvalidInput(f"{quoted(label)} must have one value for each x, {x.shape}, got shapes "
                                   f"{first.shape} and {second.shape}")
            color, dashes = cable_style(index).color, CABLE_DASHES[index % len(CABLE_DASHES)]
            above.plot(x, first, color=color, linewidth=6, alpha=0.3, solid_capstyle="butt",
                       label=f"{label}, {names[0]}")
            above.plot(x, second, color=INK, linewidth=1.2, linestyle=dashes,
                       label=f"{label}, {names[1]}")
            below.plot(x, second - first, color=color, linestyle=dashes, label=label)
        above.set(ylabel=ylabel, title=title)
        above.legend()
        below.axhline(0, color=INK, linewidth=0.8)
        unit = ylabel[ylabel.rfind("["):] if "[" in ylabel else ""
        below.set(xlabel=xlabel, ylabel=f"residual {unit}".rstrip(),
                  title=f"What is left: {names[1]} − {names[0]}")
        if len(pairs) > 1:
            below.legend(ncols=len(pairs))
        figure.alt_text = (f"{title}: {names[0]} and {names[1]} of {', '.join(pairs)}; "
                           f"what is left is at most {np.abs(below.dataLim.intervaly).max():.2g} in size.")
    return figure
