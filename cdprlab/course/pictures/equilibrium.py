"""Forces on a point load: the robot, its force polygon, the tensions as bars, and where the load goes if let go."""

from typing import Any

import matplotlib.figure
import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from ...arrays import Array, checked
from ...robot import Robot
from ...view.plots import Figure
from ...view.style import GREY, INK, ORANGE, SKY, LineStyle, cable_style
from ..props.experiments import Motion
from ..props.point_load import MASS, Equilibrium, decimal, equilibrium
from .panels import PLAN, arrow, bar_panel, draw_bars, draw_exit_points, drawn, label, round_up, show_square

SLACK = "#A50F15"
"""A cable that would have to push; always dashed and said in words as well."""

_ARROW = 1.1 / (MASS * 9.81)
"""Length of a force arrow beside the robot [m/N]: the weight is 1.1 m long."""

_LONGEST = 1.6
"""Of the arrow of the force left over, whose number says the rest [m]."""

_NOTHING = 1e-6
"""A force too small to be drawn [N]."""

_KEY = np.array([-2.6, 3.75])
"""Where it is said what arrow and diamond mean [m]."""

_GHOSTS = 0.1
"""Between two outlines of a load on its way [s]."""


@checked
def draw_equilibrium(robot: Robot, position: ArrayLike, push: ArrayLike = (0.0, 0.0),
                     tensions: ArrayLike | None = None) -> Figure:
    """The robot, its force polygon and its tensions side by side.

    robot, position, push : as in `equilibrium`
    tensions : (m,) somebody's own, drawn instead of the balanced ones [N]
    """
    state = equilibrium(robot, position, push)
    if tensions is not None:
        state = state.held(tensions)
    with drawn(11.5, 4.3) as figure:
        draw_panels(panels(figure), robot, position, push, state)
        figure.alt_text = ("A point load on cables, the polygon of the forces on it, and its cable tensions. "
                           f"{state.words()}")
        return figure


def panels(figure: matplotlib.figure.Figure, stacked: bool = False) -> list[Axes]:
    """Three axes, robot, force polygon and tensions, side by side.

    stacked : the last two above each other, which leaves room beside the figure
    """
    layout: Any = [[0, 1], [0, 2]] if stacked else [[0, 1, 2]]
    widths, heights = ([1.3, 1.0], [1.35, 1.0]) if stacked else ([1.25, 1.15, 0.8], None)
    axes = [*figure.subplot_mosaic(layout, width_ratios=widths, height_ratios=heights).values()]
    for panel in axes[1:]:   # few numbers are easier to read, and most of the time to draw
        panel.locator_params(nbins=4, steps=[1, 2, 5, 10])
    return axes


def draw_panels(axes: list[Axes], robot: Robot, position: ArrayLike, push: ArrayLike,
                state: Equilibrium,
                motion: Motion | None = None) -> None:
    """Fill the three panels, under house style.

    motion : of the load since it was let go; without one it is held
    """
    force, place = np.asarray(push, float), np.asarray(position, float)
    _draw_robot(axes[0], robot, place, force, state, motion)
    if motion is not None:
        _draw_motion(axes[0], place, state, motion)
    _draw_polygon(axes[1], force, state)
    _draw_bars(axes[2], state)


# --- panels -----------------------------------------------------------------------------------------------
def _draw_robot(panel: Axes, robot: Robot, position: Array, push: Array, state: Equilibrium,
                motion: Motion | None) -> None:
    load = position if motion is None else motion.positions[-1]
    for i, exit_point in enumerate(robot.exit_points):
        panel.plot(*np.transpose([exit_point, load]), **_look(i, state)._asdict(),
                   linewidth=1.6 if state.slack[i] else 2.4)
        if state.slack[i]:
            x, y = exit_point - load   # away from what hangs below the load
            label(panel, "slack!", (exit_point + load) / 2, np.array([-y, x]) * (-1 if x * y > 0 else 1),
                  color=SLACK, zorder=5)
    draw_exit_points(panel, robot.exit_points)
    for force, name, color in _loads(push, state) if motion is None else []:
        tip = position + _ARROW * force
        arrow(panel, position, tip, color=color)
        label(panel, name, tip, (-1, 0) if name == "weight" else force, color=color)
    panel.plot(*load, "o", markersize=12 if motion is None else 9, color=INK)
    panel.set(**PLAN, xlim=(-2.9, 2.9), ylim=(-2.1, 4.4), title="Robot" if motion is None else "Robot, let go")


def _draw_motion(panel: Axes, position: Array, state: Equilibrium, motion: Motion) -> None:
    """The load's way through the engine, an outline every tenth of a second, and where a constant a = F/m ends."""
    size = float(np.linalg.norm(state.left_over))
    if size > _NOTHING * (1 + np.abs(state.w_e).max()):
        # What ropes, which only pull, leave of the forces: the way the load will go.
        arrow(panel, position, position + min(_ARROW, _LONGEST / size) * state.left_over, color=SLACK,
              linestyle=(0, (1, 1)))
        label(panel, f"→ left over {decimal(size)} N", _KEY + [-0.2, 0.45], (1, 0), color=SLACK)
    panel.plot(*motion.positions.T, color=INK, linewidth=1.0)
    every = max(round(_GHOSTS / (motion.time[1] - motion.time[0])), 1)
    panel.plot(*motion.positions[:-1:every].T, "o", markersize=9, markerfacecolor="none", markeredgecolor=GREY)
    expected = position + state.left_over / MASS * motion.time[-1] ** 2 / 2
    panel.plot(*np.transpose([expected, _KEY]), "D", markersize=6, color=SKY, markeredgecolor=INK, zorder=5)
    label(panel, f"p + ½ a t², t = {motion.time[-1]:.2f} s", _KEY, (1, 0), color=INK)


def _draw_polygon(panel: Axes, push: Array, state: Equilibrium) -> None:
    """Head to tail, by direction from straight down counter-clockwise: a polygon that never crosses itself."""
    cables = [(force, f"cable {i + 1}", *_look(i, state)) for i, force in enumerate((state.W * state.tensions).T)]
    arrows = [(force, name, color, "solid") for force, name, color in _loads(push, state)]
    arrows += [cable for cable in cables if np.linalg.norm(cable[0]) > _NOTHING]
    arrows.sort(key=lambda arrow: (np.arctan2(arrow[0][0], -arrow[0][1]) + 1e-9) % (2 * np.pi))
    corners = np.cumsum([np.zeros(2)] + [arrow[0] for arrow in arrows], axis=0)
    for start, end, (force, name, color, dashes) in zip(corners, corners[1:], arrows):
        arrow(panel, start, end, color=color, linestyle=dashes)
        label(panel, name, (start + end) / 2, _outwards(force), color=color)
    if not state.closed:
        panel.plot(*corners[[-1, 0]].T, color=SLACK, linestyle=(0, (1, 2)))
        label(panel, "open!", corners[[0, -1]].mean(axis=0), _outwards(corners[0] - corners[-1]), color=SLACK)
    low, high = corners.min(axis=0), corners.max(axis=0)
    show_square(panel, (low + high) / 2, 0.85 * max((high - low).max(), 1.0))
    found = "OPEN" if not state.closed else "slack!" if state.slack.any() else "closed"
    panel.set(xlabel="f_x [N]", ylabel="f_y [N]", title=f"Force polygon: {found}")


def _draw_bars(panel: Axes, state: Equilibrium) -> None:
    tau, slack = state.tensions, state.slack
    words = [f"{decimal(tension)}{' slack!' if limp else ''}" for tension, limp in zip(tau, slack)]
    draw_bars(panel, tau, [_look(i, state) for i in range(tau.size)], words, tau.clip(min=0.0), slack)
    panel.axvline(0, color=INK, linewidth=1)
    low, high = min(0.0, tau.min()), max(tau.max(), 1.0)
    bar_panel(panel, tau.size, round_up(high + (1.0 if slack.any() else 0.4) * (high - low)), low)
    panel.set_title("Tensions")


def _outwards(side: Array) -> Array:
    """The way out of a polygon that runs counter-clockwise along this side."""
    return np.array([side[1], -side[0]])


def _look(i: int, state: Equilibrium) -> LineStyle:
    """A cable's own, or that of a cable that would have to push."""
    return LineStyle(SLACK, (0, (4, 3))) if state.slack[i] else cable_style(i)


def _loads(push: Array, state: Equilibrium) -> list[tuple[Array, str, str]]:
    """Weight and push, whichever are there."""
    loads = [(state.w_e - push, "weight", INK), (push, "push", ORANGE)]
    return [load for load in loads if np.linalg.norm(load[0]) > _NOTHING]
