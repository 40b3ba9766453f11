"""A comparison of tension distributions in one figure: every method's tensions, and four numbers that differ."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from ..arrays import Array
from .plots import Figure, fitted_title
from .style import BLUE, GREY, INK, VERMILION, WARNING, cable_style, house_style

_COLUMNS = 3
_NUMBERS = (("energy", "∫‖τ‖² dt [N² s]", 1.0, True), ("largest_step", "largest step [N]", 1.0, True),
            ("margin", "least distance to a limit [N]", 1.0, False), ("solve_time", "time per solve [µs]", 1e6, True))


def plot_tension_comparison(table: Any) -> Figure:
    """Tensions over time, one panel a method on common axes; below, energy, largest step, margin and time per solve.

    table : TensionComparison
    """
    with house_style():
        rows = -(-len(table.method) // _COLUMNS)
        figure = Figure(figsize=(13.0, 2.3 * rows + 1.0 + 1.6 + 0.26 * len(table.method)), layout="constrained")
        fitted_title(figure, f"{table.world.title} · task {table.task} · tension distributions")
        halves: Any = figure.subfigures(2, 1, height_ratios=[2.3 * rows, 1.6 + 0.26 * len(table.method)])
        above, below = halves
        panels = above.subplots(rows, _COLUMNS, sharex=True, sharey=True, squeeze=False).ravel()
        for k, panel in enumerate(panels):
            _tensions(panel, table, k) if k < len(table.method) else panel.set_axis_off()
        _common_axes(panels[:len(table.method)], table)
        charts = below.subplots(1, len(_NUMBERS), sharey=True)
        for chart, (name, label, factor, logarithmic) in zip(charts, _NUMBERS):
            _numbers(chart, table, factor * getattr(table, name), label, logarithmic, jumps=name == "largest_step")
        charts[0].set_yticks(range(len(table.method)), [name.replace("_", " ") for name in table.method])
        charts[0].set_ylim(len(table.method) - 0.5, -0.5)
        figure.alt_text = _in_words(table)
        return figure


def _tensions(panel: Axes, table: Any, k: int) -> None:
    for cable in range(table.tensions.shape[2]):
        color, dashes = cable_style(cable)
        panel.plot(table.time, table.tensions[k, :, cable], color=color, linestyle=dashes, linewidth=1.2,
                   label=f"cable {cable + 1}")
    panel.set_title(table.method[k].replace("_", " "), fontsize=11)
    bad = ~table.feasible[k]
    if bad.any():
        panel.fill_between(table.time, 0, 1, where=bad, step="mid", color=WARNING, zorder=0, linewidth=0,
                           transform=panel.get_xaxis_transform())
        panel.set_title(f"infeasible {100 * bad.mean():.0f} %", loc="right", fontsize=9, fontweight="normal",
                        color=VERMILION)


def _common_axes(panels: Sequence[Axes], table: Any) -> None:
    """One range for all, that of the usable tensions: what breaks limits leaves the picture, not the scale."""
    usable = table.tensions[table.feasible]
    top = float(usable.max()) if usable.size else float(np.nanmax(table.tensions))
    panels[0].set_xlim(float(table.time[0]), float(table.time[-1]))
    panels[0].set_ylim(-0.03 * top, 1.08 * top)
    for k, panel in enumerate(panels):
        panel.axhline(float(table.world.robot.tension_min.max()), color=INK, linewidth=1.0, linestyle=(0, (1, 2)))
        if k % _COLUMNS == 0:
            panel.set_ylabel("tension [N]")
        if k + _COLUMNS >= len(panels):
            panel.set_xlabel("time [s]")
            panel.tick_params(labelbottom=True)
    cables = [Line2D([], [], color=cable_style(i).color, linestyle=cable_style(i).linestyle, label=f"{i + 1}")
              for i in range(table.tensions.shape[2])]
    notes: list[Any] = [Line2D([], [], color=INK, linewidth=1.0, linestyle=(0, (1, 2)), label=r"$\tau_\mathrm{min}$"),
                        Patch(color=WARNING, label="infeasible")]
    figure = panels[0].figure
    figure.legend(handles=cables + notes, loc="outside upper right", ncols=len(cables) + 2, title=None,
                  handlelength=1.9, columnspacing=1.1, fontsize=9)


def _numbers(chart: Axes, table: Any, values: Array, label: str, logarithmic: bool, jumps: bool) -> None:
    rows = np.arange(len(values))
    known = np.isfinite(values)
    jumping = known & ~np.asarray(table.continuous) if jumps else np.zeros(len(values), dtype=bool)
    chart.hlines(rows, 0, 1, transform=chart.get_yaxis_transform(), color="#DDE1E6", linewidth=0.8, zorder=0)
    chart.plot(values[known & ~jumping], rows[known & ~jumping], "o", color=BLUE, markersize=7)
    chart.plot(values[jumping], rows[jumping], "D", color=VERMILION, markersize=7, label="jumps")
    if logarithmic and known.any() and 0 < 10 * values[known].min() < values[known].max():
        chart.set_xscale("log")
    for row in rows[known]:
        chart.annotate(f"{values[row]:.3g}", (values[row], row), xytext=(7, 0), textcoords="offset points",
                       fontsize=8.5, color=INK, va="center")
    for row in rows[~known]:
        chart.annotate("never feasible", (0.02, row), xycoords=chart.get_yaxis_transform(), fontsize=8.5, color=GREY,
                       va="center")
    chart.margins(x=0.25)
    chart.grid(axis="y", visible=False)
    chart.set_xlabel(label)
    if jumping.any():
        chart.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.1)


def _in_words(table: Any) -> str:
    parts = []
    for row in table.rows():
        name = row["method"].replace("_", " ")
        if not row["feasible_share"]:
            parts.append(f"{name} never feasible")
            continue
        parts.append(f"{name} feasible on {100 * row['feasible_share']:.0f} % of the path, largest step "
                     f"{row['largest_step']:.3g} N{'' if row['continuous'] else ' (jumps)'}, margin "
                     f"{row['margin']:.3g} N, {1e6 * row['solve_time']:.0f} µs a solve")
    return f"Tension distributions compared on {table.world.title}, task {table.task}: {'; '.join(parts)}."
