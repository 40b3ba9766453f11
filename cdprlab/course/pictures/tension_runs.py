"""The same flight by several distributions: tensions apart, motion together."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.lines import Line2D

from ...arrays import checked
from ...errors import InvalidInput
from ...run import Run
from ...view.plots import Figure
from ...view.style import CABLE_DASHES, INK, cable_style
from .panels import drawn

_MARKERS = 12
"""Measured values shown per cable."""


@checked
def plot_tension_runs(runs: Sequence[Run]) -> Figure:
    """Tensions of each run above; below, what cables carried beyond the command, and how far the platform was off.

    runs : of the same task, by different methods
    Raises InvalidInput where their times differ, or tensions were not commanded.
    """
    if not len(runs) or any(run.time.shape != runs[0].time.shape or run.commanded_lengths is not None
                       for run in runs):
        raise InvalidInput("plot_tension_runs takes runs of one duration with commanded tensions, got "
                           + (", ".join(f"{run.method} {run.time.size} steps" for run in runs) or "none"))
    with drawn(3.6 * max(len(runs), 2), 6.6) as figure:
        parts: Any = figure.subfigures(2, 1, height_ratios=(1.15, 1.0))
        panels = np.atleast_1d(parts[0].subplots(1, len(runs), sharex=True, sharey=True))
        m = runs[0].commanded_tensions.shape[1]
        styles = [cable_style(i)._asdict() for i in range(m)]
        every = max(1, runs[0].time.size // _MARKERS)
        for panel, run in zip(panels, runs):
            for i, style in enumerate(styles):
                panel.plot(run.time, run.commanded_tensions[:, i], linewidth=1.4, **style)
                panel.plot(run.time, run.measured_tensions[:, i], color=style["color"],
                           linestyle="none", marker="o",
                           markersize=4, markeredgecolor="white", markeredgewidth=0.4,
                           markevery=(every * i // 8, every))
            panel.set(title=run.method.replace("_", " "), xlabel="time [s]")
        panels[0].set_ylabel("tension [N]")
        handles: list[Any] = [Line2D([], [], label=str(i + 1), **style)
                              for i, style in enumerate(styles)]
        dot = Line2D([], [], color=INK, marker="o", markersize=4, linestyle="none",
                     label="measured")
        parts[0].legend(handles=[*handles, dot], loc="outside lower center", ncols=m + 1,
                        title="cable", fontsize=9,
                        title_fontsize=9, columnspacing=1.2)
        left, right = parts[1].subplots(1, 2)
        for k, run in enumerate(runs):
            # The last run is drawn thinnest: lines on each other stay visible.
            look = {"color": cable_style(k).color,
                    "linestyle": CABLE_DASHES[k % len(CABLE_DASHES)],
                    "linewidth": 1.4 * (len(runs) - k), "label": run.method.replace("_", " ")}
            residual = np.abs(run.measured_tensions - run.commanded_tensions).max(axis=1)
            left.plot(run.time, 1e3 * residual, **look)
            right.plot(run.time, 1e3 * run.position_errors, **look)
        left.set(xlabel="time [s]", ylabel="residual [mN]",
                 title="Largest |measured − commanded|")
        right.set(xlabel="time [s]", ylabel="off the path [mm]",
                  title="Platform: distance from the reference")
        right.legend()
        left.set_ylim(bottom=0.0)
        right.set_ylim(bottom=0.0)
        figure.alt_text = "; ".join(f"{run.method.replace('_', ' ')}: tensions {run.commanded_tensions.min():.0f} to "
                                    f"{run.commanded_tensions.max():.0f} N, platform at most "
                                    f"{1e3 * run.position_errors.max():.2g} mm off"
                                    for run in runs)
    return figure
