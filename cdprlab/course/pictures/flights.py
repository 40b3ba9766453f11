"""Flights drawn: what one is beside a formula or a plan, and what several distributions make of the same task."""

from collections.abc import Mapping, Sequence
from typing import Annotated, Any

import numpy as np
from numpy.typing import ArrayLike

from ...arrays import Array, as_array, checked
from ...errors import InvalidInput, quoted
from ...run import Run
from ...view.plots import Figure, draw_cables
from ...view.screen import check_like
from ...view.style import CABLE_DASHES, GREY, INK, cable_style, house_style
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
    names = [run.method.replace("_", " ") for run in runs]
    m, every = runs[0].commanded_tensions.shape[1], max(1, runs[0].time.size // _MARKERS)
    with drawn(3.6 * max(len(runs), 2), 6.6) as figure:
        parts: Any = figure.subfigures(2, 1, height_ratios=(1.15, 1.0))
        (panels,) = parts[0].subplots(1, len(runs), sharex=True, sharey=True, squeeze=False)
        for panel, run, name in zip(panels, runs, names):
            draw_cables(panel, run.time, run.commanded_tensions, linewidth=1.4)
            for i, measured in enumerate(run.measured_tensions.T):
                panel.plot(run.time, measured, "o", color=cable_style(i).color, markersize=4, markeredgecolor="white",
                           markeredgewidth=0.4, markevery=(every * i // 8, every))
            panel.set(title=name, xlabel="time [s]")
        panels[0].set_ylabel("tension [N]")
        (dot,) = panels[0].plot([], [], "o", color=INK, markersize=4)
        parts[0].legend([*panels[0].lines[:m], dot], [*map(str, range(1, m + 1)), "measured"],
                        loc="outside lower center", ncols=m + 1, title="cable", fontsize=9, title_fontsize=9,
                        columnspacing=1.2)
        left, right = parts[1].subplots(1, 2)
        for k, (run, name) in enumerate(zip(runs, names)):
            # The last run is drawn thinnest: lines on each other stay visible.
            look = {"color": cable_style(k).color, "linestyle": CABLE_DASHES[k % len(CABLE_DASHES)],
                    "linewidth": 1.4 * (len(runs) - k), "label": name}
            residual = np.abs(run.measured_tensions - run.commanded_tensions).max(axis=1)
            left.plot(run.time, 1e3 * residual, **look)
            right.plot(run.time, 1e3 * run.position_errors, **look)
        left.set(xlabel="time [s]", ylabel="residual [mN]", title="Largest |measured − commanded|")
        right.set(xlabel="time [s]", ylabel="off the path [mm]", title="Platform: distance from the reference")
        right.legend()
        for panel in (left, right):
            panel.set_ylim(bottom=0.0)
        figure.alt_text = "; ".join(f"{name}: tensions {run.commanded_tensions.min():.0f} to "
                                    f"{run.commanded_tensions.max():.0f} N, platform at most "
                                    f"{1e3 * run.position_errors.max():.2g} mm off" for run, name in zip(runs, names))
    return figure


@checked
def plot_flight(run: Any, planned: Sequence[Sequence[bool]], taut: Sequence[Sequence[bool]]) -> Figure:
    """How far the load was off the planned motion, and which cables carried, over time.

    run : Run; planned, taut : (N, m) which cables the plan lets carry, and which did
    """
    plan, did = np.asarray(planned, bool), np.asarray(taut, bool)
    check_like(run, "Run", "position_errors")
    if not (plan.ndim == 2 and plan.shape == did.shape and len(plan) == len(run.time)):
        raise InvalidInput(f"planned and taut must have a row a step, {len(run.time)}, and a column a cable, "
                           f"got shapes {plan.shape} and {did.shape}")
    off, time = 1e3 * run.position_errors, run.time
    with drawn(8.0, 4.4) as figure:
        above, below = figure.subplots(2, 1, sharex=True, height_ratios=(1.2, 1.0))
        above.plot(time, off, color=INK)
        above.set(ylabel="off the plan [mm]", title=f"{run.world.name}: distance from the planned motion",
                  ylim=(0, max(1.15 * off.max(), 1e-3)))
        m = did.shape[1]
        for i in range(m):
            below.fill_between(time, i + 0.62, i + 1.38, plan[:, i], step="post", facecolor="none", edgecolor=GREY,
                               linestyle="--")
            below.fill_between(time, i + 0.78, i + 1.22, did[:, i], step="post", color=cable_style(i).color,
                               linewidth=0)
        below.set(xlabel="time [s]", ylabel="cable", yticks=range(1, m + 1), ylim=(m + 0.5, 0.5))
        below.set_title("Taut: filled bars; allowed by the plan: dashed frames", fontsize=11)
        below.grid(visible=False, axis="y")
        figure.alt_text = (f"The load is at most {off.max():.2g} mm off; cables planned slack carry "
                           f"{100 * (did & ~plan).any(axis=1).mean():.1f} % of the time.")
    return figure


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
            above.plot(x, second, color=INK, linewidth=1.2, linestyle=dashes, label=f"{label}, {names[1]}")
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
