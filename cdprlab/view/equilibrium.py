"""Forces that balance a point load: the robot, its closed force polygon, and the tensions as bars."""

from __future__ import annotations

from typing import Any, NamedTuple

import matplotlib
import matplotlib.figure
import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from ..arrays import Array, as_array, as_number
from ..errors import InvalidInput
from ..pose import Pose
from ..robot import MOTION_PATTERNS, Cable, Platform, Robot
from ..statics import gravity_wrench, wrench_matrix
from ..tensions import distribute_tensions
from .plots import Figure
from .style import INK, ORANGE, cable_style, house_style

EXIT_POINTS = {
    2: ((-2.0, 3.0), (2.0, 3.0)),
    3: ((-2.0, 3.0), (2.0, 3.0), (0.0, 0.0)),
    4: ((-2.0, 3.0), (2.0, 3.0), (2.0, 0.0), (-2.0, 0.0)),
}
"""Number of cables → exit points of the vertical plane's robots [m]."""

MASS = 10.0
"""Of the point load [kg]."""

SLACK = "#A50F15"
"""A cable that would have to push; always dashed and said in words as well."""

_CLOSED = 1e-6
"""Forces that add up to less than this share of the load are called balanced: rounding is far below."""

SIZE = (11.5, 4.3)
"""Of the figure [inch]."""

_ARROW = 1.1 / (MASS * 9.81)
"""Length of a force arrow beside the robot [m/N]: the weight is 1.1 m long."""


class Equilibrium(NamedTuple):
    """A point load's balance of forces, cables taken as rods that may push.

    W : (2, m); w_e : (2,) weight and push [N]
    tensions : (m,) −W⁺ w_e + λ h, negative where a cable would have to push [N]
    null_vector : (m,) h with W h = 0, its largest entry 1 in size; zeros where there is none
    residual : (2,) W τ + w_e, what the cables leave unbalanced [N]
    """

    W: Array
    w_e: Array
    tensions: Array
    null_vector: Array
    residual: Array

    @property
    def closed(self) -> bool:
        """Whether the forces add up to zero."""
        return bool(np.linalg.norm(self.residual) <= _CLOSED * (1 + np.linalg.norm(self.w_e)))

    @property
    def slack(self) -> Array:
        """(m,) True where a cable would have to push; rounding aside."""
        return np.asarray(self.tensions < -_CLOSED * (1 + np.abs(self.tensions).max()))

    def words(self) -> str:
        """The numbers as text."""
        text = f"τ = ({', '.join(_number(value) for value in self.tensions)}) N. "
        if not self.closed:
            return text + (f"The forces do not balance: {np.linalg.norm(self.residual):.1f} N are left over, "
                           "the polygon stays open.")
        if not self.slack.any():
            return text + "The polygon is closed and every cable pulls."
        pushes = " and ".join(f"cable {i + 1} would have to push {-self.tensions[i]:.1f} N"
                              for i in np.flatnonzero(self.slack))
        return text + f"The polygon closes on paper only: {pushes}, and cables only pull (slack!)."


def point_load(n_cables: int) -> Robot:
    """A 10 kg load in a vertical plane, hung on two, three or four cables.

    n_cables : 2 (both from above), 3 (one from below) or 4 (a rectangle of exit points)
    Raises InvalidInput for another number.

    >>> point_load(3)
    Robot(2T, 3 cables, 10 kg)
    """
    if n_cables not in EXIT_POINTS:
        raise InvalidInput(f"the point load hangs on 2, 3 or 4 cables, got {n_cables!r}")
    here = np.zeros(2)
    cables = tuple(Cable(np.array(exit_point), here, 0.0, 1e4) for exit_point in EXIT_POINTS[n_cables])
    load = Platform(MASS, np.array(0.1), here, np.array([0.2, 0.2]), here)
    return Robot(MOTION_PATTERNS["2T"], load, cables)


def equilibrium(robot: Robot, position: ArrayLike, push: ArrayLike = (0.0, 0.0), internal: float = 0.0) -> Equilibrium:
    """τ = −W⁺ w_e + λ h: the least tensions, and an internal tension that no one sees from outside.

    robot : of pattern 2T
    position : (2,) of the load [m]
    push : (2,) external force beside the weight [N]
    internal : λ, the internal tension of the most stretched cable [N]
    Raises InvalidInput where a cable has no length.

    >>> equilibrium(point_load(2), [0, 1]).tensions.round(2)
    array([69.37, 69.37])
    """
    pose = Pose(as_array(position, "position", (2,), "m"), angle=0.0)
    W = wrench_matrix(robot, pose)
    w_e = gravity_wrench(robot, pose) + as_array(push, "push", (2,), "N")
    least = distribute_tensions(W, w_e, robot.tension_min, robot.tension_max, "pseudo_inverse").tensions
    h = null_vector(W)
    tensions = least + as_number(internal, "internal tension", "N") * h
    return Equilibrium(W, w_e, tensions, h, W @ tensions + w_e)


def null_vector(W: Array) -> Array:
    """h with W h = 0 whose smallest entry is as large as can be, max |h_i| = 1; zeros where W has no null space.

    W : (n, m)
    Returns (m,); all entries positive exactly where a positive null vector exists.

    >>> null_vector(np.array([[1.0, -2.0]]))
    array([1. , 0.5])
    """
    from scipy.linalg import null_space
    from scipy.optimize import linprog

    kernel = null_space(W)
    m, r = kernel.shape
    if r == 0:
        return np.zeros(m)
    if r == 1:
        h = kernel[:, 0] * (1.0 if kernel.sum() >= 0 else -1.0)
    else:
        # h = N z with |h| ≤ 1 and t ≤ h_i, t as large as possible.
        rows = np.block([[-kernel, np.ones((m, 1))], [kernel, np.zeros((m, 1))], [-kernel, np.zeros((m, 1))]])
        bounds = np.concatenate([np.zeros(m), np.ones(2 * m)])
        best = linprog(np.append(np.zeros(r), -1.0), A_ub=rows, b_ub=bounds, bounds=(None, None))
        h = kernel @ best.x[:r]
        if np.abs(h).max() < 1e-9:  # no h ≥ 0 but zero: any direction will do
            h = kernel[:, 0]
    return np.asarray(h / np.abs(h).max())


def draw_equilibrium(robot: Robot, position: ArrayLike, push: ArrayLike = (0.0, 0.0), internal: float = 0.0,
                     tensions: ArrayLike | None = None) -> Figure:
    """The robot, its force polygon and its tensions side by side.

    robot, position, push, internal : as in `equilibrium`
    tensions : (m,) somebody's own, drawn instead of the balanced ones [N]
    """
    state = equilibrium(robot, position, push, internal)
    if tensions is not None:
        own = as_array(tensions, "tensions", (robot.n_cables,), "N")
        state = state._replace(tensions=own, residual=state.W @ own + state.w_e)
    with house_style():
        figure = Figure(figsize=SIZE, layout="constrained")
        draw_panels(panels(figure), robot, position, push, state)
        figure.alt_text = ("A point load on cables, the polygon of the forces on it, and its cable tensions. "
                           + state.words())
        return figure


def panels(figure: matplotlib.figure.Figure, stacked: bool = False) -> list[Axes]:
    """Three axes, robot, force polygon and tensions, side by side.

    stacked : the last two above each other, which leaves room beside the figure
    """
    if not stacked:
        return list(figure.subplots(1, 3, gridspec_kw={"width_ratios": [1.25, 1.15, 0.8]}))
    grid = figure.add_gridspec(2, 2, width_ratios=[1.3, 1.0], height_ratios=[1.35, 1.0])
    return [figure.add_subplot(grid[:, 0]), figure.add_subplot(grid[0, 1]), figure.add_subplot(grid[1, 1])]


def draw_panels(axes: list[Axes], robot: Robot, position: ArrayLike, push: ArrayLike, state: Equilibrium) -> None:
    """Fill the three panels anew, under house style."""
    style = matplotlib.rcParams
    for panel in axes:
        # Not clear(): ticks made anew would take longer than all the rest.
        for artist in [*panel.lines, *panel.texts, *panel.patches]:
            artist.remove()
        panel.containers.clear()
        # Grid lines are made when first drawn, which may be after house style has gone.
        panel.tick_params(grid_color=style["grid.color"], grid_linewidth=style["grid.linewidth"])
    force = np.asarray(push, dtype=float)
    _draw_robot(axes[0], robot, np.asarray(position, dtype=float), force, state)
    _draw_polygon(axes[1], force, state)
    _draw_bars(axes[2], state)


# --- panels -----------------------------------------------------------------------------------------------
def _draw_robot(panel: Axes, robot: Robot, position: Array, push: Array, state: Equilibrium) -> None:
    for i, exit_point in enumerate(robot.exit_points):
        color, dashes, width = _look(i, state)
        panel.plot(*np.transpose([exit_point, position]), color=color, linestyle=dashes, linewidth=width)
        panel.plot(*exit_point, marker="s", markersize=8, color=INK)
        panel.annotate(str(i + 1), exit_point, (0, 9 if exit_point[1] > 1 else -9), textcoords="offset points",
                       ha="center", va="bottom" if exit_point[1] > 1 else "top", color=INK)
        if state.slack[i]:
            x, y = (exit_point - position) / np.linalg.norm(exit_point - position)
            _label(panel, "slack!", (exit_point + position) / 2, np.array([abs(y), x if y < 0 else -x]), SLACK)
    for force, name, color in _loads(push, state):
        tip = position + _ARROW * force
        _arrow(panel, position, tip, color)
        _label(panel, name, tip, force / np.linalg.norm(force), color)
    panel.plot(*position, marker="o", markersize=12, color=INK)
    panel.set(xlim=(-2.9, 2.9), ylim=(-1.3, 4.4), aspect="equal", xlabel="x [m]", ylabel="y [m]")
    panel.set_title("Robot", y=1.02)


def _draw_polygon(panel: Axes, push: Array, state: Equilibrium) -> None:
    """Head to tail, by direction from straight down counter-clockwise: a polygon that never crosses itself."""
    arrows = [(force, name, color, "solid") for force, name, color in _loads(push, state)]
    for i, force in enumerate((state.W * state.tensions).T):
        if np.linalg.norm(force) > _CLOSED:
            color, dashes, _ = _look(i, state)
            arrows.append((force, f"cable {i + 1}", color, dashes))
    arrows.sort(key=lambda arrow: (np.arctan2(arrow[0][0], -arrow[0][1]) + 1e-9) % (2 * np.pi))
    corners = np.cumsum([np.zeros(2)] + [arrow[0] for arrow in arrows], axis=0)
    for start, end, (force, name, color, dashes) in zip(corners, corners[1:], arrows):
        _arrow(panel, start, end, color, dashes)
        outwards = np.array([force[1], -force[0]]) / np.linalg.norm(force)
        _label(panel, name, (start + end) / 2, outwards, color)
    if not state.closed:
        panel.plot(*np.transpose([corners[-1], corners[0]]), color=SLACK, linestyle=(0, (1, 2)))
        _label(panel, "open!", (corners[0] + corners[-1]) / 2, np.array([1.0, 0.0]), SLACK)
    low, high = corners.min(axis=0), corners.max(axis=0)
    reach = 0.95 * max(float((high - low).max()), 1.0)
    middle = (low + high) / 2
    panel.set(xlim=middle[0] + reach * np.array([-1, 1]), ylim=middle[1] + reach * np.array([-1, 1]),
              aspect="equal", xlabel="f_x [N]", ylabel="f_y [N]")
    panel.set_title(f"Force polygon: {'closed' if state.closed else 'OPEN'}", y=1.02)


def _draw_bars(panel: Axes, state: Equilibrium) -> None:
    m = state.tensions.size
    top = max(float(np.abs(state.tensions).max()), 1.0)
    for i, tension in enumerate(state.tensions):
        color, _, _ = _look(i, state)
        slack = bool(state.slack[i])
        panel.bar(i + 1, tension, color="white" if slack else color, edgecolor=color, width=0.6,
                  linestyle="dashed" if slack else "solid", hatch="//" if slack else None, linewidth=1.6)
        panel.annotate(f"{_number(tension)} N" + ("\nslack!" if slack else ""), (i + 1, tension),
                       (0, -3 if slack else 3), textcoords="offset points", ha="center",
                       va="top" if slack else "bottom", color=color if slack else INK, fontsize=11 if m < 4 else 9)
    panel.axhline(0, color=INK, linewidth=1)
    panel.grid(axis="x", visible=False)
    low, high = min(0.0, float(state.tensions.min())), max(0.3 * top, float(state.tensions.max()))
    room = high - low  # for two lines of text below a bar, for one above
    panel.set(xlim=(0.4, m + 0.6), xticks=range(1, m + 1), xlabel="cable", ylabel="tension [N]",
              ylim=(low - (0.4 if state.slack.any() else 0.1) * room, high + 0.2 * room))
    panel.set_title("Tensions", y=1.02)


def _label(panel: Axes, text: str, place: Any, side: Array, color: str) -> None:
    """Text beside a point, on the side of a unit vector."""
    x, y = side.tolist()
    panel.annotate(text, (place[0], place[1]), (7 * x, 7 * y), textcoords="offset points", color=color,
                   bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.75, "pad": 0.5},
                   ha="left" if x > 0.3 else "right" if x < -0.3 else "center",
                   va="bottom" if y > 0.3 else "top" if y < -0.3 else "center")


def _number(value: float) -> str:
    """One decimal, with a true minus and no negative zero."""
    return f"{round(value, 1) + 0.0:.1f}".replace("-", "−")


def _look(i: int, state: Equilibrium) -> tuple[str, Any, float]:
    """Color, dashes and width of a cable: its own, or that of a cable that would have to push."""
    if state.slack[i]:
        return SLACK, (0, (4, 3)), 1.6
    return *cable_style(i), 2.4


def _loads(push: Array, state: Equilibrium) -> list[tuple[Array, str, str]]:
    """Weight and push, whichever are there."""
    loads = [(state.w_e - push, "weight", INK), (push, "push", ORANGE)]
    return [load for load in loads if np.linalg.norm(load[0]) > _CLOSED]


def _arrow(panel: Axes, start: Array, end: Array, color: str, dashes: Any = "solid") -> None:
    panel.annotate("", (end[0], end[1]), (start[0], start[1]), arrowprops={
        "arrowstyle": "-|>", "color": color, "linestyle": dashes, "linewidth": 2.2, "shrinkA": 0, "shrinkB": 0,
        "mutation_scale": 14})
