"""Cable configurations from above: which triplets hold a load, ways from S to G, what a flight made of them."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from numpy.typing import ArrayLike

from ...arrays import Array, as_array, checked
from ...configurations.classify import INSIDE, OUTSIDE, UNCERTAIN, classify_configurations
from ...configurations.configuration import Configuration, triplets
from ...configurations.region import region
from ...configurations.sequence import ConfigurationSequence
from ...robot import Robot
from ...view.plots import Figure
from ...view.style import BLUE, GREY, INK, ORANGE, VERMILION, cable_style
from .panels import draw_exit_points, drawn, label

CLASS_COLORS = {INSIDE: BLUE, UNCERTAIN: ORANGE, OUTSIDE: GREY}
"""Always beside the word itself."""

_MARGIN, WIDE_MARGIN = 0.22, 0.44
"""Of the plan around the exit points, in a large panel and in a small one [m]."""


@checked
def plot_triplets(robot: Robot, position: ArrayLike, classes: Mapping[Any, str] | None = None,
                  position_uncertainty: float = 0.0, exit_uncertainty: float = 0.0) -> Figure:
    """One small plan a triplet: its triangle, the load, and its class.

    robot : a point mass (3T); position : (3,) of the load [m]
    classes : triplet → "inside", "uncertain" or "outside"; default the library's answer
    position_uncertainty, exit_uncertainty : half widths of the boxes [m]
    """
    M, names = as_array(position, "position", (3,), "m"), triplets(robot)
    if classes is None:
        classes = classify_configurations(robot, M, position_uncertainty, exit_uncertainty)
    columns = min(len(names), 5)
    rows = -(-len(names) // columns)
    with drawn(2.6 * columns, 2.7 * rows) as figure:
        panels = np.ravel(figure.subplots(rows, columns, sharex=True, sharey=True,
                                          squeeze=False))
        for panel, chosen in zip(panels, names):
            draw_room(panel, robot, WIDE_MARGIN)
            fill_triplet(panel, robot, chosen, M, classes[chosen], position_uncertainty,
                         exit_uncertainty)
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
    with drawn(4.2 * max(len(sequences), 1), 4.0) as figure:
        panels = np.ravel(figure.subplots(1, max(len(sequences), 1), sharey=True,
                                          squeeze=False))
        for panel, sequence, title in zip(panels, sequences,
                                          list(titles) or [str(s) for s in sequences]):
            draw_room(panel, robot)
            fill_sequence(panel, robot, sequence)
            panel.set_title(title, fontsize=11)
            panel.label_outer()
        figure.alt_text = "Plans of the room with the way from S to G: " + "; ".join(map(str, sequences)) + "."
    return figure


# --- panels -------------------------------------------------------------------------------------------------
def draw_room(panel: Axes, robot: Robot, margin: float = _MARGIN) -> None:
    """Exit points with their numbers, axes in meters, ``margin`` around them [m]."""
    plan = robot.exit_points[:, :2]
    low, high = plan.min(axis=0) - margin, plan.max(axis=0) + margin
    draw_exit_points(panel, plan, fontsize=9)
    panel.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal", xlabel="x [m]",
              ylabel="y [m]")


def fill_triplet(panel: Axes, robot: Robot, chosen: Configuration, position: Array,
                 verdict: str,
                 position_uncertainty: float = 0.0, exit_uncertainty: float = 0.0) -> None:
    """One triangle in the color of its class, its certain part darker, and the load."""
    corners = robot.exit_points[chosen.indices]
    color = CLASS_COLORS[verdict]
    panel.fill(*corners[:, :2].T, facecolor=to_rgba(color, 0.22), edgecolor=color,
               linewidth=1.4,
               linestyle="--" if verdict == OUTSIDE else "-",
               hatch="//" if verdict == UNCERTAIN else None)
    if position_uncertainty or exit_uncertainty:
        sure = region(corners, exit_uncertainty, position_uncertainty).polygon(corners[:, :2], float(position[2]))
        if len(sure):
            panel.fill(*sure.T, facecolor=color, edgecolor="none", alpha=0.38)
    panel.plot(*position[:2], marker="o", markersize=6, color=INK,
               markeredgecolor="white", zorder=5)
    panel.set_title(f"{chosen}: {verdict}", fontsize=10)


def fill_sequence(panel: Axes, robot: Robot, sequence: ConfigurationSequence) -> None:
    """The way from S to G, each part in the style of its configuration, over that configuration's triangle."""
    looks = [cable_style(k) for k in range(len(sequence.configurations))]
    for chosen, look, dashes in zip(sequence.configurations, looks,
                                    ("-", (0, (5, 2)), (0, (1.5, 1.5)), "-.")):
        corners = robot.exit_points[chosen.indices][:, :2]
        panel.fill(*corners.T, facecolor=to_rgba(look.color, 0.13), edgecolor=look.color,
                   linewidth=1.3,
                   linestyle=dashes)
    turn = 0
    for (a, before), (b, after) in zip(sequence.steps, sequence.steps[1:]):
        if before == after:
            panel.plot([a[0], b[0]], [a[1], b[1]], color=looks[turn].color,
                       linewidth=3, zorder=3)
            way = (b - a)[:2]
            if np.linalg.norm(way) > 0.1:  # long enough to be seen: the configuration's name beside its middle
                aside = np.array([way[1], -way[0]]) / np.linalg.norm(way) * (-1 if way[0] < 0 else 1)
                label(panel, str(before), (a + b) / 2, aside, 9, fontsize=9,
                      color=looks[turn].color, zorder=6)
        else:
            turn += 1
            color, marker = (VERMILION, "X") if sequence.transition_scores[turn - 1] else (INK, "D")
            panel.plot(a[0], a[1], marker=marker, markersize=8, color=color,
                       markeredgecolor="white", zorder=5)
            label(panel, f"M{turn}", a, (0, 1), 10, fontsize=9, color=color, zorder=6)
    for name, (place, _) in (("S", sequence.steps[0]), ("G", sequence.steps[-1])):
        panel.plot(place[0], place[1], marker="o", markersize=8, color=INK,
                   markeredgecolor="white", zorder=5)
        label(panel, name, place, (0, 1), 9, fontsize=10, fontweight="bold",
              color=INK, zorder=6)


def in_words(classes: Mapping[Any, str]) -> str:
    """The classes as text: "A123 inside, A124 outside"."""
    return ", ".join(f"{Configuration(chosen)} {verdict}"
                     for chosen, verdict in classes.items())
