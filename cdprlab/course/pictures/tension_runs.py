"""The same flight by several distributions: tensions apart, motion together."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.lines import Line2D

from ...errors import InvalidInput
from ...view.plots import Figure
from ...view.style import INK, cable_style, house_style

_DASHES: tuple[Any, ...] = ("solid", (0, (5, 2)), (0, (1.5, 1.5)), (0, (6, 2, 1.5, 2)))
_MARKERS = 12
"""Measured values shown per cable."""


def plot_tension_runs(runs: Sequence[Any]) -> Figure:
    """Tensions of each run above; below, what cables carried beyond the command, and how far the platform was off.

    runs : of the same task, by different methods
    Raises InvalidInput where their times differ, or tensions were not commanded.
    """
    if not runs or any(run.time.shape != runs[0].time.shape or run.commanded_lengths is not None for run in runs):
        raise InvalidInput("plot_tension_runs takes runs of one duration with commanded tensions, got "
                           + (", ".join(f"{run.method} {run.time.size} steps" for run in runs) or "none"))
    with house_style():
        figure = Figure(figsize=(3.6 * max(len(runs), 2), 6.6), layout="constrained")
        parts: Any = figure.subfigures(2, 1, height_ratios=(1.15, 1.0))
        panels = np.atleast_1d(parts[0].subplots(1, len(runs), sharex=True, sharey=True))
        for panel, run in zip(panels, runs):
            _tensions(panel, run)
        panels[0].set_ylabel("tension [N]")
        m = runs[0].commanded_tensions.shape[1]
        handles: list[Any] = [Line2D([], [], color=cable_style(i).color, linestyle=cable_style(i).linestyle,
                                     label=str(i + 1)) for i in range(m)]
        dot = Line2D([], [], color=INK, marker="o", markersize=4, linestyle="none", label="measured")
        parts[0].legend(handles=[*handles, dot], loc="outside lower center", ncols=m + 1, title="cable", fontsize=9,
                        title_fontsize=9, columnspacing=1.2)
        left, right = parts[1].subplots(1, 2)
        for k, run in enumerate(runs):
            # The last run is drawn thinnest: lines on each other stay visible.
            look = {"color": cable_style(k).color, "linestyle": _DASHES[k % len(_DASHES)],
                    "linewidth": 1.4 * (len(runs) - k), "label": run.method.replace("_", " ")}
            residual = np.abs(run.measured_tensions - run.commanded_tensions).max(axis=1)
            left.plot(run.time, 1e3 * residual, **look)
            right.plot(run.time, 1e3 * run.position_errors, **look)
        left.set(xlabel="time [s]", ylabel="residual [mN]", title="Largest |measured − commanded|")
        right.set(xlabel="time [s]", ylabel="off the path [mm]", title="Platform: distance from the reference")
        right.legend()
        left.set_ylim(bottom=0.0)
        right.set_ylim(bottom=0.0)
        figure.alt_text = "; ".join(f"{run.method.replace('_', ' ')}: tensions {run.commanded_tensions.min():.0f} to "
                                    f"{run.commanded_tensions.max():.0f} N, platform at most "
                                    f"{1e3 * run.position_errors.max():.2g} mm off" for run in runs)
    return figure


def _tensions(panel: Any, run: Any) -> None:
    every = max(1, run.time.size // _MARKERS)
    for i in range(run.commanded_tensions.shape[1]):
        look = cable_style(i)
        panel.plot(run.time, run.commanded_tensions[:, i], color=look.color, linestyle=look.linestyle, linewidth=1.4)
        panel.plot(run.time, run.measured_tensions[:, i], color=look.color, linestyle="none", marker="o", markersize=4,
                   markeredgecolor="white", markeredgewidth=0.4, markevery=(every * i // 8, every))
    panel.set(title=run.method.replace("_", " "), xlabel="time [s]")
