"""Figures of a run. Nothing is computed here beyond differences and unit changes (m to mm, rad to mrad)."""

from collections.abc import Sequence
from io import BytesIO
from pathlib import Path
from typing import Any

import matplotlib.figure
import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from ..arrays import Array, checked
from ..errors import InvalidInput
from ..run import Run
from ..workspace.grids import axis_names
from ..world.files import checked_path, replaced
from .screen import check_like
from .style import (
    AXIS_COLORS,
    AXIS_STYLES,
    GREY,
    INK,
    WARNING,
    LineStyle,
    cable_style,
    house_style,
)

_MARKERS = 40
"""Measured values shown per cable: enough to see the course, few enough to see the line below."""

_LEAST_RANGE = 1e-3
"""Errors [mm, mrad, N] below this stay flat: blown up to full height, rounding would look like motion."""


class Figure(matplotlib.figure.Figure):
    """A matplotlib figure with a text description; shows itself in notebooks, also without pyplot."""

    alt_text: str = ""

    def _repr_pretty_(self, printer: Any, cycle: bool) -> None:
        printer.text(self.alt_text or repr(self))

    def _repr_png_(self) -> bytes:
        buffer = BytesIO()
        self.savefig(buffer, format="png", dpi=100)
        return buffer.getvalue()


def plot_tracking(run: Run) -> Figure:
    """Reference and actual position, position error per axis, rotation error if the platform turns.

    run : Run
    """
    check_like(run)
    with house_style():
        height = 7.6 if _turns(run).shape[1] else 5.6
        figure = Figure(figsize=(8.0, height), layout="constrained")
        _draw_tracking(figure, run)
        return _told(figure, run, "Tracking", _tracking_in_words(run))


def plot_tensions(run: Run) -> Figure:
    """Commanded (lines) and measured (dots) tension of every cable, and measured minus commanded below.

    run : Run
    Raises InvalidInput for anything else.
    """
    check_like(run)
    with house_style():
        figure = Figure(figsize=(8.0, 6.4), layout="constrained")
        _draw_tensions(figure, run)
        return _told(figure, run, "Cable tensions", _tensions_in_words(run))


def plot_run(run: Run, beside: Run | None = None) -> Figure:
    """Both of them side by side; crosses are the positions and tensions of a run ``beside`` it.

    run, beside : Run
    """
    with house_style():
        figure = Figure(figsize=(13.0, 7.8), layout="constrained")
        halves: Any = figure.subfigures(1, 2)
        left, right = halves
        position, tensions = _draw_tracking(left, run), _draw_tensions(right, run)
        words = f"{_tracking_in_words(run)} {_tensions_in_words(run)}"
        if beside is not None:
            _cross(position, beside, beside.poses.position, AXIS_STYLES)
            _cross(tensions, beside, _shown(beside), _cable_styles(run))
            words += " Crosses: the same of another run."
        return _told(figure, run, "Overview", words)


def _cross(panel: Axes, beside: Run, lines: Array, styles: Sequence[LineStyle]) -> None:
    """What another run did."""
    for line, style in zip(lines.T, styles):
        panel.plot(beside.time, line, "x", color=style.color, markersize=5,
                   markevery=_every(beside), label="_beside")
    panel.annotate("crosses: the other run", (0.008, 0.02), xycoords="axes fraction",
                   fontsize=9, color=INK)


def plot_glance(run: Run) -> Figure:
    """Position errors and tensions, small, side by side: how a run shows itself.

    run : Run
    """
    d = min(run.world.robot.dimension, run.errors.shape[1])
    with house_style():
        figure = Figure(figsize=(8.0, 2.8), layout="constrained")
        left, right = figure.subplots(1, 2)
        for panel in (left, right):
            _over_time(panel, run)
        _draw_errors(left, run.time, 1e3 * run.errors[:, :d], axis_names(d), "error [mm]",
                     "Position error")
        draw_cables(right, run.time, _shown(run))
        _number_cables(right, run)
        right.set(ylabel="tension [N]", title="Tensions")
    figure.alt_text = f"{_tracking_in_words(run)} {_tensions_in_words(run)}"
    return figure


@checked
def save_figure(figure: matplotlib.figure.Figure, path: str | Path) -> Path:
    """Save a figure; its description goes into the file (PNG and SVG: Description, PDF: Subject).

    path : the ending chooses the format
    Raises InvalidInput if its folder does not exist or the ending is none.
    """
    target, formats = checked_path(path), figure.canvas.get_supported_filetypes()
    ending = target.suffix[1:].lower()
    if ending not in formats:
        raise InvalidInput(f"the path must end in one of .{', .'.join(formats)}, got {target}")
    key = {"png": "Description", "svg": "Description", "pdf": "Subject"}.get(ending)
    text = getattr(figure, "alt_text", "")
    with house_style(), replaced(target) as file:
        figure.savefig(file, format=ending, metadata={key: text} if key and text else None)
    return target


# --- figures and panels -----------------------------------------------------------------------------------
def _told(figure: Figure, run: Run, what: str, words: str) -> Figure:
    """A figure with title and description."""
    method = run.method.replace("_", " ")
    fitted_title(figure, f"{run.world.title} · task {run.task} · {method}")
    figure.alt_text = (f"{what} of {run.world.title}, task {run.task}, {method}, cables as {run.cables}, "
                       f"{run.time[-1]:.3g} s. {words}")
    return figure


def _over_time(panel: Axes, run: Run) -> None:
    """The time axis, of all panels that share it."""
    panel.set(xlim=(0.0, run.time.max(initial=0.0) or 1.0), xlabel="time [s]")


# --- position and errors ----------------------------------------------------------------------------------
def _turns(run: Run) -> Array:
    """(N, 0 to 3) rotation errors [mrad], as many as turns of the platform are controlled."""
    return 1e3 * run.errors[:, run.world.robot.dimension:]


def _draw_tracking(part: Any, run: Run) -> Axes:
    """Panels in a part of a figure; returns the first one, of positions."""
    d, time, turns = run.world.robot.dimension, run.time, _turns(run)
    names = axis_names(d)
    axes = part.subplots(3 if turns.shape[1] else 2, sharex=True)
    _over_time(axes[-1], run)
    solid = [LineStyle(color, "solid") for color in AXIS_COLORS]
    wanted, actual, seen = run.reference.pose.position, run.poses.position, run.estimates.position
    pale: dict[str, Any] = {"linewidth": 6, "alpha": 0.28}
    draw_lines(axes[0], time, wanted, names, solid, solid_capstyle="butt", **pale)
    draw_lines(axes[0], time, actual, names, AXIS_STYLES)
    axes[0].set(ylabel="position [m]", title="Position of P")
    handles = [_key("reference", **pale), _key("actual")]
    title = "Position error, reference − actual"
    if run.estimates is not run.poses:   # what the controller saw
        dots = LineStyle(INK, (0, (1, 3)))
        draw_lines(axes[0], time, seen, names, [dots] * d, linewidth=0.8)
        handles.append(_key("measured", linestyle=dots.linestyle, linewidth=0.8))
        draw_lines(axes[1], time, 1e3 * (wanted - seen), ["_measured"] * d, solid,
                   linewidth=0.6, alpha=0.45, zorder=1)
        title = "Position error (thin: as measured)"
    _legend_above(axes[0], handles)
    label_ends(axes[0], actual, names, AXIS_STYLES)
    _draw_errors(axes[1], time, 1e3 * run.errors[:, :d], names, "position error [mm]", title)
    if turns.shape[1]:
        about = {1: "φ", 2: "about y′, about z′", 3: "about x, about y, about z"}
        _draw_errors(axes[2], time, turns, about[turns.shape[1]].split(", "), "rotation error [mrad]",
                     "Rotation error (rotation vector)")
    return axes[0]


def _draw_errors(panel: Axes, time: Array, errors: Array, names: Sequence[str], label: str,
                 title: str) -> None:
    several = errors.shape[1] > 1
    styles = AXIS_STYLES if several else [LineStyle(INK, "solid")]
    draw_lines(panel, time, errors, names, styles, linewidth=1.4)
    if several:
        _legend_above(panel, panel.plot(time, np.linalg.norm(errors, axis=1), color=INK,
                                        linewidth=1.0, linestyle=(0, (1, 1.5)), label="norm"))
    _around_zero(panel)
    panel.set(ylabel=label, title=title)
    label_ends(panel, errors, names, styles)


# --- tensions ---------------------------------------------------------------------------------------------
def _draw_tensions(part: Any, run: Run) -> Axes:
    """Tensions above; below what measured ones differ by, or how slack ropes are that were wound to lengths.

    Panels in a part of a figure; returns the one above.
    """
    above, below = part.subplots(2, height_ratios=[2, 1], sharex=True)
    _over_time(below, run)
    wound = run.commanded_lengths is not None
    draw_cables(above, run.time, _shown(run))
    draw_cables(below, run.time, _below(run), linewidth=1.2)
    above.set(ylabel="tension [N]", title="Tensions")
    handles = [_key("measured" if wound else "commanded")]
    if wound:
        below.set(ylabel="slack [mm]", title="Rope let out − distance it spans")
    else:
        below.set(ylabel="difference [N]", title="Measured − commanded")
        dots: dict[str, Any] = {"linestyle": "none", "marker": "o", "markersize": 4.2}
        handles.append(_key("measured", **dots))
        every = _every(run)
        for cable, measured in enumerate(run.measured_tensions.T):
            above.plot(run.time, measured, color=cable_style(cable).color,
                       markeredgecolor="white", markeredgewidth=0.5,
                       markevery=(every * cable // 8, every), label=f"_measured {cable + 1}",
                       **dots)
    below.set_title("cables drawn as above", loc="right", fontsize=9, fontweight="normal",
                    color=GREY)
    _around_zero(below)
    if not run.feasible.all():
        handles.append(Patch(color=WARNING, label="not held" if wound else "infeasible"))
    for panel in (above, below):
        shade(panel, run.time, run.feasible)
    _draw_limits(above, run)
    _legend_above(above, handles)
    # The differences all but coincide: names pushed apart would point nowhere, so the panel
    # above names the lines.
    _number_cables(above, run)
    return above


def _every(run: Run) -> int:
    """Of how many values one is marked."""
    return max(1, len(run.time) // _MARKERS)


def draw_cables(panel: Axes, time: Array, lines: Array, **options: Any) -> None:
    """Columns (N, m) over time, each in its cable's style."""
    for k, line in enumerate(lines.T):
        panel.plot(time, line, label=f"cable {k + 1}", **cable_style(k)._asdict(), **options)


def _cable_styles(run: Run) -> list[LineStyle]:
    return [*map(cable_style, range(run.world.robot.n_cables))]


def _number_cables(panel: Axes, run: Run) -> None:
    styles = _cable_styles(run)
    label_ends(panel, _shown(run), [str(k + 1) for k in range(len(styles))], styles)


def _shown(run: Run) -> Array:
    """(N, m) commanded tensions, or measured ones where lengths were commanded [N]."""
    return run.commanded_tensions if run.commanded_lengths is None else run.measured_tensions


def _below(run: Run) -> Array:
    """(N, m) measured − commanded tensions [N], or where lengths were commanded what is let out too much [mm]."""
    if run.commanded_lengths is None:
        return run.measured_tensions - run.commanded_tensions
    # Lengths are logged as a step begins, those commanded hold as it ends: the next row's.
    spanned = np.pad(run.lengths[1:], ((0, 1), (0, 0)), constant_values=np.nan)
    return 1e3 * (run.commanded_lengths - spanned)


def shade(panel: Axes, time: Array, feasible: Any) -> None:
    """Behind the lines, where no feasible tensions were found; single steps stay visible."""
    bad = ~feasible
    bad[1:] |= bad[:-1]   # a step lasts until the next one
    panel.fill_between(time, 0, 1, where=bad, color=WARNING, zorder=0, linewidth=0.6,
                       transform=panel.get_xaxis_transform())


def _draw_limits(panel: Axes, run: Run) -> None:
    """Limits as lines where they are in range, else in words: a far limit must not squeeze the tensions."""
    robot, words = run.world.robot, []
    shown = np.fmax.reduce([_shown(run), run.measured_tensions], axis=None, initial=1e-9)
    for name, limits in (("min", robot.tension_min), ("max", robot.tension_max)):
        for limit in np.unique(limits):
            told = rf"$\tau_\mathrm{{{name}}}$ {limit:g} N"
            if limit <= 1.4 * shown:
                mark_level(panel, limit, told, 0.995, "right")
            else:
                words.append(told)
    if words:
        low, high = panel.get_ylim()
        panel.set_ylim(low, high + 0.08 * (high - low))  # room for the note above all lines
        panel.annotate(f"off scale: {', '.join(words)}", (0.008, 0.985),
                       xycoords="axes fraction", va="top",
                       fontsize=9, color=INK)


# --- in words ---------------------------------------------------------------------------------------------
def _tracking_in_words(run: Run) -> str:
    d = run.world.robot.dimension
    names, off = ", ".join(axis_names(d)), np.linalg.norm(run.errors[:, :d], axis=1)
    if not np.isfinite(run.errors).any():
        return f"Position {names} over time [m]; no reference is known."
    text = (f"Reference and actual {names} over time [m]; the position error [mm] is largest, "
            f"{1e3 * np.nanmax(off):.3g} mm, at {run.time[np.nanargmax(off)]:.3g} s.")
    turns = _turns(run)
    if turns.shape[1]:
        text += f" The largest rotation error is {np.nanmax(np.linalg.norm(turns, axis=1)):.3g} mrad."
    return text


def _tensions_in_words(run: Run) -> str:
    tau, robot, wound = _shown(run), run.world.robot, run.commanded_lengths is not None
    if not np.isfinite(tau).any():
        return "No tensions are known."
    text = (f"{'Measured' if wound else 'Commanded'} tensions of {robot.n_cables} cables lie between "
            f"{np.nanmin(tau):.4g} and {np.nanmax(tau):.4g} N; limits {np.min(robot.tension_min):g} to "
            f"{np.max(robot.tension_max):g} N")
    if not wound:
        text += f"; measured differ from commanded by at most {np.nanmax(np.abs(_below(run))):.3g} N"
    share = 100 * (~run.feasible).mean()
    why = "The ropes did not hold the platform as commanded" if wound else "No feasible tensions"
    return f"{text}." + (f" {why} in {share:.3g} % of the steps (shaded)." if share else "")


# --- small drawing parts ------------------------------------------------------------------------------------
def fitted_title(figure: Any, title: str) -> None:
    """About 10 characters of 13 points fit an inch; a longer title is set smaller rather than cut off."""
    size = 13 * min(1.0, 10 * figure.get_figwidth() / max(len(title), 1))
    figure.suptitle(title, x=0.01, ha="left", fontsize=size, color=INK)


def _key(label: str, **look: Any) -> Any:
    """What a legend shows of lines of all colors."""
    return Line2D([], [], label=label, color=INK, **look)


def _legend_above(panel: Axes, handles: list[Any]) -> None:
    """A legend on the title's line, where no data can be."""
    panel.legend(handles=handles, loc="lower right", bbox_to_anchor=(1.0, 0.995),
                 ncols=len(handles),
                 borderaxespad=0.1, handlelength=1.8, columnspacing=1.2)


def _around_zero(panel: Axes) -> None:
    """A line at zero, and a range no smaller than ``_LEAST_RANGE``."""
    panel.axhline(0, color=GREY, linewidth=0.8)
    low, high = panel.get_ylim()
    panel.set_ylim(min(low, -_LEAST_RANGE), max(high, _LEAST_RANGE))


def draw_lines(panel: Axes, time: Array, lines: Array, names: Sequence[str],
               styles: Sequence[LineStyle], **options: Any) -> None:
    """Columns (N, k) over time (N,), each under its name and in its style."""
    for line, name, style in zip(lines.T, names, styles):
        panel.plot(time, line, label=name, **style._asdict(), **options)


def mark_level(panel: Axes, level: float, words: str = "", place: float = 0.005,
               align: str = "left") -> None:
    """A dotted line across the panel and words above it, at a share of its width."""
    panel.axhline(level, color=INK, linewidth=1.2, linestyle=(0, (1, 2)), label="_limit")
    panel.annotate(words, (place, level), xycoords=("axes fraction", "data"), ha=align,
                   xytext=(0, 3),
                   textcoords="offset points", fontsize=9, color=INK)


def label_ends(panel: Axes, lines: Array, names: Sequence[str],
               styles: Sequence[LineStyle]) -> None:
    """The name of each column (N, k) at its line's right end, pushed apart where ends coincide."""
    low, high = panel.get_ylim()
    panel.set_ylim(low, high)
    ends = np.array([[low, *line[np.isfinite(line)]][-1] for line in lines.T])
    points = panel.bbox.height * 72 / panel.figure.dpi  # before the layout, which leaves panels no lower
    gap = min(14 / points, 1 / len(names))
    heights = spread_apart(np.clip((ends - low) / (high - low), 0, 1), gap)
    for name, style, height in zip(names, styles, heights):
        panel.annotate(name, (1.0, height), xycoords="axes fraction", xytext=(5, 0),
                       textcoords="offset points", va="center", color=style.color,
                       fontsize=10, fontweight="bold")


def spread_apart(heights: Array, gap: float) -> Array:
    """Heights moved apart to at least ``gap``, in the same order and as little as can be, all of them from 0 to 1.

    >>> spread_apart(np.array([0.5, 0.5, 0.1]), 0.2)
    array([0.4, 0.6, 0.1])
    """
    from scipy.optimize import isotonic_regression

    order = np.argsort(heights, kind="stable")
    steps = gap * np.arange(len(heights))
    spread = np.empty_like(heights)
    spread[order] = steps + np.clip(isotonic_regression(heights[order] - steps).x, 0.0,
                                    1.0 - steps[-1])
    return spread
