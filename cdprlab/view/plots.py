"""Figures of a run. Nothing is computed here beyond differences and unit changes (m to mm, rad to mrad)."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib.figure
import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from ..arrays import Array
from ..errors import InvalidInput
from .run_words import (
    axis_names,
    differences,
    infeasible_spans,
    lengths_commanded,
    position_errors,
    rotation_errors,
    run_subject,
    run_title,
    shown_tensions,
    tension_text,
    tracking_text,
    turn_names,
)
from .style import AXIS_COLORS, AXIS_DASHES, GREY, INK, WARNING, cable_style, house_style

_MARKERS = 40
"""Measured values shown per cable: enough to see the course, few enough to see the line below."""

_LEAST_RANGE = 1e-3
"""Errors [mm, mrad, N] below this stay flat: blown up to full height, rounding would look like motion."""


class Figure(matplotlib.figure.Figure):
    """A matplotlib figure with a text description; shows itself in notebooks without pyplot."""

    alt_text: str = ""

    def _repr_png_(self) -> bytes:
        from io import BytesIO

        buffer = BytesIO()
        self.savefig(buffer, format="png", dpi=100)
        return buffer.getvalue()


def plot_tracking(run: Any) -> Figure:
    """Reference and actual position, position error per axis, rotation error if the platform turns.

    run : Run
    """
    with house_style():
        turns = rotation_errors(run).shape[1] > 0
        figure, axes = _figure(run, (8.0, 7.6 if turns else 5.6), rows=3 if turns else 2)
        _tracking_panels(axes, run)
        figure.alt_text = f"Tracking of {run_subject(run)}. {tracking_text(run)}"
        return figure


def plot_tensions(run: Any) -> Figure:
    """Commanded (lines) and measured (dots) tension of every cable, and measured minus commanded below.

    run : Run
    """
    with house_style():
        figure, axes = _figure(run, (8.0, 6.4), rows=2, height_ratios=[2, 1])
        _tension_panels(axes, run)
        figure.alt_text = f"Cable tensions of {run_subject(run)}. {tension_text(run)}"
        return figure


def save_figure(figure: matplotlib.figure.Figure, path: str | Path) -> Path:
    """Save a figure; its description goes into the file (PNG and SVG: Description, PDF: Subject).

    path : the ending chooses the format
    Raises InvalidInput if its folder does not exist.
    """
    target = Path(path)
    if not target.parent.is_dir():
        raise InvalidInput(f"cannot save {target}: there is no folder {target.parent}")
    key = {".png": "Description", ".svg": "Description", ".pdf": "Subject"}.get(target.suffix.lower())
    text = getattr(figure, "alt_text", "")
    with house_style():
        figure.savefig(target, metadata={key: text} if key and text else None)
    return target


# --- figures and panels -----------------------------------------------------------------------------------
def plot_run(run: Any) -> Figure:
    with house_style():
        figure = Figure(figsize=(13.0, 7.8), layout="constrained")
        turns = rotation_errors(run).shape[1] > 0
        rows = 3 if turns else 2
        grid = figure.add_gridspec(rows, 2, wspace=0.06)
        left = [figure.add_subplot(grid[row, 0]) for row in range(rows)]
        right = [figure.add_subplot(grid[:rows - 1, 1]), figure.add_subplot(grid[rows - 1, 1])]
        _finish(figure, left, run)
        _finish(figure, right, run)
        _tracking_panels(left, run)
        _tension_panels(right, run)
        figure.alt_text = f"Overview of {run_subject(run)}. {tracking_text(run)} {tension_text(run)}"
        return figure


def _figure(run: Any, size: tuple[float, float], rows: int, **options: Any) -> tuple[Figure, list[Axes]]:
    figure = Figure(figsize=size, layout="constrained")
    axes = list(np.atleast_1d(figure.subplots(rows, 1, gridspec_kw=options)))
    _finish(figure, axes, run)
    return figure, axes


def _finish(figure: Figure, axes: Sequence[Axes], run: Any) -> None:
    """Title, one time axis for panels above each other."""
    title = run_title(run)
    # About 10 characters of 13 pt text fit an inch; a longer title is set smaller rather than cut off.
    size = 13 * min(1.0, 10 * figure.get_figwidth() / len(title))
    figure.suptitle(title, x=0.01, ha="left", fontsize=size, color=INK)
    end = float(run.time[-1]) if len(run.time) and run.time[-1] > 0 else 1.0
    for panel in axes:
        panel.set_xlim(0.0, end)
        panel.tick_params(labelbottom=panel is axes[-1])
    axes[-1].set_xlabel("time [s]")


def _tracking_panels(axes: Sequence[Axes], run: Any) -> None:
    _position_panel(axes[0], run)
    position, names = 1e3 * position_errors(run), axis_names(run)
    _error_panel(axes[1], run.time, position, names, "position error [mm]", "Position error, reference − actual")
    if len(axes) > 2:
        rotation = 1e3 * rotation_errors(run)
        _error_panel(axes[2], run.time, rotation, turn_names(run), "rotation error [mrad]",
                     "Rotation error (rotation vector)")


def _position_panel(panel: Axes, run: Any) -> None:
    actual, wanted, names = run.poses.position, run.reference.pose.position, axis_names(run)
    for axis, color, dashes in zip(range(actual.shape[1]), AXIS_COLORS, AXIS_DASHES):
        panel.plot(run.time, wanted[:, axis], color=color, linewidth=6, alpha=0.28, solid_capstyle="butt",
                   label=f"_reference {names[axis]}")
        panel.plot(run.time, actual[:, axis], color=color, linestyle=dashes, label=names[axis])
    panel.set_ylabel("position [m]")
    panel.set_title("Position of P")
    handles = [Line2D([], [], color=INK, linewidth=6, alpha=0.28, label="reference"),
               Line2D([], [], color=INK, label="actual")]
    _legend_above(panel, handles)
    label_ends(panel, [actual[:, axis] for axis in range(actual.shape[1])], names, AXIS_COLORS)


def _error_panel(panel: Axes, time: Array, errors: Array, names: Sequence[str], label: str, title: str) -> None:
    colors = AXIS_COLORS if errors.shape[1] > 1 else (INK,)
    for column, color, dashes in zip(range(errors.shape[1]), colors, AXIS_DASHES):
        panel.plot(time, errors[:, column], color=color, linestyle=dashes, linewidth=1.4, label=names[column])
    norm = np.linalg.norm(errors, axis=1)
    handles = []
    if errors.shape[1] > 1:
        panel.plot(time, norm, color=INK, linewidth=1.0, linestyle=(0, (1, 1.5)), label="norm")
        handles = [Line2D([], [], color=INK, linewidth=1.0, linestyle=(0, (1, 1.5)), label="norm")]
    _around_zero(panel)
    panel.set_ylabel(label)
    panel.set_title(title)
    _legend_above(panel, handles)
    label_ends(panel, [errors[:, column] for column in range(errors.shape[1])], names, colors)


def _tension_panels(axes: Sequence[Axes], run: Any) -> None:
    above, below = axes
    if lengths_commanded(run):
        return _rope_panels(above, below, run)
    every = max(1, len(run.time) // _MARKERS)
    for cable in range(run.commanded_tensions.shape[1]):
        color, dashes = cable_style(cable)
        above.plot(run.time, run.commanded_tensions[:, cable], color=color, linestyle=dashes,
                   label=f"cable {cable + 1}")
        above.plot(run.time, run.measured_tensions[:, cable], color=color, linestyle="none", marker="o",
                   markersize=4.2, markeredgecolor="white", markeredgewidth=0.5,
                   markevery=(every * cable // 8, every), label=f"_measured {cable + 1}")
        below.plot(run.time, differences(run)[:, cable], color=color, linestyle=dashes, linewidth=1.2,
                   label=f"cable {cable + 1}")
    _describe_tensions(above, below, run)


def _rope_panels(above: Axes, below: Axes, run: Any) -> None:
    """Ropes wound to lengths: what they carry, and what is let out of them and not needed."""
    # Lengths are logged as a step begins, those commanded hold as it ends: the next row's.
    slack = np.full(run.lengths.shape, np.nan)
    slack[:-1] = 1e3 * (run.commanded_lengths[:-1] - run.lengths[1:])
    for cable in range(run.measured_tensions.shape[1]):
        color, dashes = cable_style(cable)
        above.plot(run.time, run.measured_tensions[:, cable], color=color, linestyle=dashes, label=f"cable {cable + 1}")
        below.plot(run.time, slack[:, cable], color=color, linestyle=dashes, linewidth=1.2, label=f"cable {cable + 1}")
    _describe_tensions(above, below, run)
    below.set_ylabel("slack [mm]")
    below.set_title("Rope let out − distance it spans")


def _describe_tensions(above: Axes, below: Axes, run: Any) -> None:
    above.set_ylabel("tension [N]")
    above.set_title("Tensions")
    below.set_ylabel("difference [N]")
    below.set_title("Measured − commanded")
    below.set_title("cables drawn as above", loc="right", fontsize=9, fontweight="normal", color=GREY)
    _around_zero(below)
    handles: list[Any] = [Line2D([], [], color=INK, label="commanded"),
                          Line2D([], [], color=INK, linestyle="none", marker="o", markersize=4.2, label="measured")]
    if lengths_commanded(run):
        handles = [Line2D([], [], color=INK, label="measured")]
    if not np.all(run.feasible):
        handles.append(Patch(color=WARNING, label="winch too slow" if lengths_commanded(run) else "infeasible"))
    for panel in (above, below):
        for start, end in infeasible_spans(run):
            panel.axvspan(start, end, color=WARNING, zorder=0, linewidth=0)
    _draw_limits(above, run)
    _legend_above(above, handles)
    names = [f"{cable + 1}" for cable in range(run.commanded_tensions.shape[1])]
    colors = [cable_style(cable).color for cable in range(len(names))]
    # The differences all but coincide: names pushed apart would point nowhere, so the panel above names the lines.
    label_ends(above, list(np.transpose(shown_tensions(run))), names, colors)


def _draw_limits(panel: Axes, run: Any) -> None:
    """Limits as lines where they are in range, else in words: a far limit must not squeeze the tensions."""
    robot = run.world.robot
    shown = float(np.nanmax([np.nanmax(shown_tensions(run)), np.nanmax(run.measured_tensions), 1e-9]))
    words = []
    for name, limits in ((r"$\tau_\mathrm{min}$", robot.tension_min),
                         (r"$\tau_\mathrm{max}$", robot.tension_max)):
        for limit in np.unique(limits):
            if limit <= 1.4 * shown:
                panel.axhline(limit, color=INK, linewidth=1.2, linestyle=(0, (1, 2)), label="_limit")
                panel.annotate(f"{name} {limit:g} N", (0.995, limit), xycoords=("axes fraction", "data"), ha="right",
                               xytext=(0, 3), textcoords="offset points", fontsize=9, color=INK)
            else:
                words.append(f"{name} {limit:g} N")
    if words:
        low, high = panel.get_ylim()
        panel.set_ylim(low, high + 0.08 * (high - low))  # room for the note above all lines
        panel.annotate(f"off scale: {', '.join(words)}", (0.008, 0.985), xycoords="axes fraction", va="top",
                       fontsize=9, color=INK)


# --- small drawing parts ------------------------------------------------------------------------------------
def _legend_above(panel: Axes, handles: Sequence[Any]) -> None:
    """A legend on the title's line, where no data can be."""
    if handles:
        panel.legend(handles=list(handles), loc="lower right", bbox_to_anchor=(1.0, 0.995), ncols=len(handles),
                     borderaxespad=0.1, handlelength=1.8, columnspacing=1.2)


def _around_zero(panel: Axes) -> None:
    """A line at zero, and a range no smaller than ``_LEAST_RANGE``."""
    panel.axhline(0, color=GREY, linewidth=0.8)
    low, high = panel.get_ylim()
    panel.set_ylim(min(low, -_LEAST_RANGE), max(high, _LEAST_RANGE))


def label_ends(panel: Axes, lines: Sequence[Array], names: Sequence[str], colors: Sequence[str]) -> None:
    """Each line's name at its right end, pushed apart where ends coincide."""
    low, high = panel.get_ylim()
    panel.set_ylim(low, high)
    ends = np.array([_last_finite(line, low) for line in lines])
    gap = min(14 / _height_points(panel), 1 / len(names))
    heights = spread_apart(np.clip((ends - low) / (high - low), 0, 1), gap)
    for name, color, height in zip(names, colors, heights):
        panel.annotate(name, (1.0, height), xycoords="axes fraction", xytext=(5, 0), textcoords="offset points",
                       va="center", color=color, fontsize=10, fontweight="bold", annotation_clip=False)


def spread_apart(heights: Array, gap: float) -> Array:
    """Heights moved apart to at least ``gap``, in the same order and about the same places."""
    order = np.argsort(heights, kind="stable")
    steps = gap * np.arange(len(heights))
    placed = heights[order].copy()
    for _ in range(200):
        overlap = gap - np.diff(placed)
        push = np.where(overlap > 1e-6, overlap / 2, 0.0)
        placed[:-1] -= push
        placed[1:] += push
    placed = np.maximum.accumulate(placed - steps) + steps
    placed += max(-placed[0], 0.0) - max(placed[-1] - 1.0, 0.0)
    spread = np.empty_like(placed)
    spread[order] = placed
    return spread


def _last_finite(line: Array, otherwise: float) -> float:
    finite = line[np.isfinite(line)]
    return float(finite[-1]) if len(finite) else otherwise


def _height_points(panel: Axes) -> float:
    # Before the layout has run, the panel's height follows from its rows in the grid; close enough for labels.
    figure, spec = panel.get_figure(root=True), panel.get_subplotspec()
    assert figure is not None and spec is not None
    grid = spec.get_gridspec()
    ratios = np.asarray(grid.get_height_ratios(), dtype=float)
    share = ratios[spec.rowspan.start:spec.rowspan.stop].sum() / ratios.sum()
    return float(figure.get_figheight() * 72 * 0.92 * share - 40)
