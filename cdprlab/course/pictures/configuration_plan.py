"""Cable configurations from above: which triplets hold a load, ways from S to G, what a flight made of them."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from numpy.typing import ArrayLike

from ...arrays import Array, as_array, checked
from ...configurations.classify import INSIDE, OUTSIDE, UNCERTAIN
from ...configurations.configuration import Configuration, triplets
from ...configurations.region import region
from ...configurations.sequence import ConfigurationSequence
from ...errors import InvalidInput, quoted
from ...robot import Robot
from ...view.plots import Figure
from ...view.style import BLUE, GREY, INK, ORANGE, VERMILION, cable_style
from .panels import PLAN, drawn, label

CLASS_COLORS = {INSIDE: BLUE, UNCERTAIN: ORANGE, OUTSIDE: GREY}
"""Always beside the word itself."""

_EDGES = ("-", (0, (5, 2)), (0, (1.5, 1.5)), "-.")
"""Of the triangles along a way."""

_MARGIN, WIDE_MARGIN = 0.36, 0.44
"""Of the plan around the exit points, in a large panel and in a small one [m]."""


@checked
def plot_triplets(robot: Robot, position: ArrayLike, classes: Mapping[Any, str]) -> Figure:
    """One small plan a triplet: its triangle, the load, and its class.

    robot : a point mass (3T); position : (3,) of the load [m]
    classes : every triplet → "inside", "uncertain" or "outside"
    Raises InvalidInput where one is missing.
    """
    M, names = as_array(position, "position", (3,), "m"), triplets(robot)
    if not {*names} <= {*classes}:
        raise InvalidInput(f"classes must tell of {', '.join(map(str, names))}, got {quoted(classes)}")
    columns = min(len(names), 5)
    rows = -(-len(names) // columns)
    with drawn(2.6 * columns, 2.7 * rows) as figure:
        panels = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
        for panel, chosen in zip(panels.flat, names):
            draw_room(panel, robot, WIDE_MARGIN)
            fill_triplet(panel, robot, chosen, M, classes[chosen])
            panel.label_outer()
        figure.alt_text = f"Seen from above, the load at ({M[0]:.2f}, {M[1]:.2f}, {M[2]:.2f}) m and every triangle " \
                          f"of three exit points: {in_words(classes)}."
    return figure


@checked
def plot_sequences(robot: Robot, sequences: Sequence[ConfigurationSequence], titles: Sequence[str] = ()) -> Figure:
    """Ways from S to G side by side, each with the triangles of its configurations.

    robot : a point mass (3T)
    sequences : from `plan_configurations`
    titles : one a panel; default the sequence with its score
    """
    columns = max(len(sequences), 1)
    with drawn(4.2 * columns, 4.0) as figure:
        (panels,) = figure.subplots(1, columns, sharey=True, squeeze=False)
        for panel, sequence, title in zip(panels, sequences, [*titles] or map(str, sequences)):
            draw_room(panel, robot)
            fill_sequence(panel, robot, sequence)
            panel.set_title(title, fontsize=11)
            panel.label_outer()
        figure.alt_text = f"Plans of the room with the way from S to G: {'; '.join(map(str, sequences))}."
    return figure


# --- panels -------------------------------------------------------------------------------------------------
def draw_room(panel: Axes, robot: Robot, margin: float = _MARGIN) -> None:
    """Exit points with their numbers, axes in meters, ``margin`` around them [m]."""
    plan = robot.exit_points[:, :2]
    panel.plot(*plan.T, "s", markersize=7, color=INK, zorder=4)
    # At places in meters: words aside by points would be drawn anew at every move of an explorer.
    for k, (x, y) in enumerate(plan + 0.65 * margin * np.sign(np.round(plan - plan.mean(axis=0), 9)), start=1):
        panel.text(x, y, str(k), ha="center", va="center", color=INK, fontsize=9)
    (left, front), (right, back) = plan.min(axis=0) - margin, plan.max(axis=0) + margin
    panel.set(**PLAN, xlim=(left, right), ylim=(front, back))


def fill_triplet(panel: Axes, robot: Robot, chosen: Configuration, position: Array, verdict: str,
                 position_uncertainty: float = 0.0, exit_uncertainty: float = 0.0) -> None:
    """One triangle in the color of its class, its certain part darker, and the load."""
    corners = robot.exit_points[chosen.indices]
    color = CLASS_COLORS[verdict]
    panel.fill(*corners[:, :2].T, facecolor=to_rgba(color, 0.22), edgecolor=color, linewidth=1.4,
               linestyle="--" if verdict == OUTSIDE else "-", hatch="//" if verdict == UNCERTAIN else None)
    if position_uncertainty or exit_uncertainty:
        sure = region(corners, exit_uncertainty, position_uncertainty).polygon(corners[:, :2], float(position[2]))
        if len(sure):
            panel.fill(*sure.T, facecolor=color, edgecolor="none", alpha=0.38)
    _mark(panel, position, "o", 6, INK)
    panel.set_title(f"{chosen}: {verdict}", fontsize=10)


def fill_sequence(panel: Axes, robot: Robot, sequence: ConfigurationSequence) -> None:
    """The way from S to G, each part in the style of its configuration, over that configuration's triangle."""
    starts, ends = sequence.steps[::2], sequence.steps[1::2]   # of its parts
    for k, ((a, chosen), (b, _)) in enumerate(zip(starts, ends)):
        color = cable_style(k).color
        panel.fill(*robot.exit_points[chosen.indices, :2].T, facecolor=to_rgba(color, 0.13), edgecolor=color,
                   linewidth=1.3, linestyle=_EDGES[k % 4])
        panel.plot(*np.transpose([a, b])[:2], color=color, linewidth=3, zorder=3)
        x, y = (b - a)[:2]
        if np.hypot(x, y) > 0.1:  # long enough to be seen: the configuration's name beside its middle
            label(panel, str(chosen), (a + b) / 2, (-y, x) if x < 0 else (y, -x), 9, fontsize=9, color=color, zorder=6)
    for k, ((place, _), score) in enumerate(zip(ends, sequence.transition_scores), start=1):
        color, marker = (VERMILION, "X") if score else (INK, "D")
        _mark(panel, place, marker, 8, color)
        label(panel, f"M{k}", place, (0, 1), 10, fontsize=9, color=color, zorder=6)
    for name, (place, _) in (("S", starts[0]), ("G", ends[-1])):
        _mark(panel, place, "o", 8, INK)
        label(panel, name, place, (0, 1), 9, fontsize=10, fontweight="bold", color=INK, zorder=6)


def _mark(panel: Axes, place: Array, marker: str, size: float, color: str) -> None:
    panel.plot(*place[:2], marker, markersize=size, color=color, markeredgecolor="white", zorder=5)


def in_words(classes: Mapping[Any, str]) -> str:
    """The classes as text: "A123 inside, A124 outside"."""
    return ", ".join(f"{Configuration(chosen)} {verdict}"
                     for chosen, verdict in classes.items())
