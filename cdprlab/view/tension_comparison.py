"""A comparison of tension distributions in one figure: every method's tensions, and four numbers that differ."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Patch

from ..run.compare import TensionComparison
from .plots import Figure, draw_cables, fitted_title, shade
from .style import INK, SKY, VERMILION, WARNING, house_style

_COLUMNS = 3
_NUMBERS = {"energy": "∫‖τ‖² dt [N² s]", "largest_step": "largest step [N], hatched: a jump",
            "margin": "least distance to a limit [N]", "solve_time": "time per solve [µs]"}


def plot_tension_comparison(table: TensionComparison) -> Figure:
    """Tensions over time, one panel a method on common axes; below, energy, largest step, margin and time per solve.

    table : TensionComparison
    """
    names = [name.replace("_", " ") for name in table.method]
    count, rows = len(names), -(-len(names) // _COLUMNS)
    heights = 2.3 * rows, 1.6 + 0.26 * count
    with house_style():
        figure = Figure(figsize=(13.0, sum(heights) + 1.0), layout="constrained")
        fitted_title(figure, f"{table.world.title} · task {table.task} · tension distributions")
        halves: Any = figure.subfigures(2, 1, height_ratios=heights)
        above, below = halves
        panels = above.subplots(rows, _COLUMNS, sharex=True, sharey=True, squeeze=False).ravel()
        for k, (panel, name) in enumerate(zip(panels, names)):
            panel.set_title(name, fontsize=11)
            _draw_method(panel, table, k)
        for panel in panels[count:]:
            panel.set_axis_off()
        _share_axes(panels[:count], table)
        above.legend(handles=[*panels[0].get_lines(), Patch(color=WARNING, label="infeasible")],
                     loc="outside upper right", ncols=table.tensions.shape[2] + 2,
                     handlelength=1.9,
                     columnspacing=1.1, fontsize=9)
        for chart, (column, label) in zip(below.subplots(1, len(_NUMBERS), sharey=True),
                                          _NUMBERS.items()):
            values = getattr(table, column) * (1e6 if "[µs]" in label else 1.0)
            bars = chart.barh(names, np.nan_to_num(values), 0.6, color=SKY, edgecolor=INK,
                              linewidth=0.6)
            chart.bar_label(bars,
                            [f"{value:.3g}" if np.isfinite(value) else "never feasible"
                             for value in values],
                            padding=4, fontsize=8.5)
            if column == "largest_step":
                for bar, continuous in zip(bars, table.continuous):
                    bar.set_hatch("" if continuous else "///")
            chart.margins(x=0.25)
            chart.grid(axis="y", visible=False)
            chart.set_xlabel(label)
        below.axes[0].invert_yaxis()
        figure.alt_text = _in_words(table, names)
        return figure


def _draw_method(panel: Axes, table: TensionComparison, k: int) -> None:
    draw_cables(panel, table.time, table.tensions[k], linewidth=1.2)
    panel.axhline(table.world.robot.tension_min.max(), color=INK, linewidth=1.0,
                  linestyle=(0, (1, 2)),
                  label=r"$\tau_\mathrm{min}$")
    shade(panel, table.time, table.feasible[k])
    if not table.feasible[k].all():
        panel.set_title(f"infeasible {100 * (1 - table.feasible[k].mean()):.0f} %", loc="right",
                        fontsize=9,
                        fontweight="normal", color=VERMILION)


def _share_axes(panels: Sequence[Axes], table: TensionComparison) -> None:
    """One range for all, that of the usable tensions: what breaks limits leaves the picture, not the scale."""
    usable = table.tensions[table.feasible]
    top = np.nanmax(usable if usable.size else table.tensions)
    panels[0].set(xlim=(table.time[0], table.time[-1]), ylim=(-0.03 * top, 1.08 * top))
    for panel in panels[::_COLUMNS]:
        panel.set_ylabel("tension [N]")
    for panel in panels[-_COLUMNS:]:
        panel.set_xlabel("time [s]")
        panel.tick_params(labelbottom=True)


def _in_words(table: TensionComparison, names: Sequence[str]) -> str:
    parts = []
    for name, row in zip(names, table.rows()):
        if row["feasible_share"]:
            parts.append(f"{name} feasible on {100 * row['feasible_share']:.0f} % of the path, largest step "
                         f"{row['largest_step']:.3g} N{'' if row['continuous'] else ' (jumps)'}, margin "
                         f"{row['margin']:.3g} N, {1e6 * row['solve_time']:.0f} µs a solve")
        else:
            parts.append(f"{name} never feasible")
    return f"Tension distributions compared on {table.world.title}, task {table.task}: {'; '.join(parts)}."
