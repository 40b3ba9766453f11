"""Plan a way for two coupled bases: how wide is the gap, how far from everything, where to, and the way answers."""

from typing import Any

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from ...arrays import Array, checked
from ...fastkit import Hall, OccupancyGrid, Plan, Vehicle, carried, inflated_width, plan_path
from ...fastkit.navigation.planner import between
from ...fastkit.plane import step_between
from ...view.style import BLUE, GREY, INK, VERMILION
from .explorer import Explorer, Slider, Values, once_a_move

_SIZE = (8.4, 5.6)                       # m
_RACKS, _DEPTH, _MIDDLE = 4.2, 0.5, 1.5  # m: racks across the hall, and where the gap between them is
_DETOUR = (3.7, 5.5)                     # m: a second gap, always open
_START = np.array([1.6, 2.8, np.pi / 2])
_NEVER, _TURNED = "#B9BFC8", "#E4E7EB"


@checked
class PlanningExplorer(Explorer):
    """Sliders for a gap, the margin and the goal; the inflated map and the pair's way answer.

    vehicle : the pair
    Raises InvalidInput for anything else.

    >>> import cdprlab as cl
    >>> explorer = planning_explorer(Vehicle.of(cl.load_world("fastkit_suspended").robot, 1.6))
    >>> explorer.set(gap=1.0)
    >>> print(explorer.text.splitlines()[5])
    goes through                          the upper gap
    """

    def __init__(self, vehicle: Vehicle) -> None:
        self.vehicle = vehicle
        super().__init__([Slider("gap", "lower gap", "m", 0.8, 2.2, 2.0, 0.05),
                          Slider("margin", "margin", "m", 0.0, 0.3, 0.1, 0.01),
                          Slider("x", "goal x", "m", 5.6, 7.8, 6.8, 0.1),
                          Slider("y", "goal y", "m", 0.6, 5.0, 2.8, 0.1),
                          Slider("heading", "goal heading", "deg", -180.0, 180.0, 90.0, 5.0)],
                         "A way for the pair", size=(6.2, 5.0))

    @staticmethod
    def hall(values: Values) -> Hall:
        """The hall with its lower gap as wide as the slider says."""
        low, high = _MIDDLE - values["gap"] / 2, _MIDDLE + values["gap"] / 2
        across = ((0.0, low), (high, _DETOUR[0]), (_DETOUR[1], _SIZE[1]))
        return Hall.of([[_RACKS, (a + b) / 2, _DEPTH, b - a, 0.0] for a, b in across],
                       [[0, 0], _SIZE])

    @staticmethod
    def goal(values: Values) -> Array:
        """(3,) where the sliders say [m, m, rad]."""
        return np.array([values["x"], values["y"], np.deg2rad(values["heading"])])

    @once_a_move
    def grid(self, values: Values) -> OccupancyGrid:
        """Which cells of the hall are free, and how far from everything."""
        return OccupancyGrid.of(self.hall(values))

    @once_a_move
    def plan(self, values: Values) -> Plan:
        """The way, or why there is none."""
        return plan_path(self.grid(values), self.vehicle, _START, self.goal(values),
                         values["margin"])

    def build(self, figure: Figure) -> None:
        axes = self._axes = figure.subplots()
        axes.plot([], [], color=BLUE, linewidth=2, label="way of the middle")
        for color, words in ((_NEVER, "the middle may never be here"),
                             (_TURNED, "only at some headings")):
            axes.plot([], [], "s", color=color, markeredgecolor=GREY, markersize=9, label=words)
        axes.plot([], [], color=BLUE, linewidth=1.2, label="the pair, its front end thick")
        axes.plot([], [], "--", color=VERMILION, label="goal")
        axes.set(xlim=(0, _SIZE[0]), ylim=(0, _SIZE[1]), aspect="equal", xlabel="x [m]",
                 ylabel="y [m]")
        axes.grid(False)
        axes.text(float(_START[0]), 1.5, "start", color=INK, ha="center", va="top", zorder=6, animated=True)
        figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=2,
                      fontsize=9)

    def numbers(self, values: Values) -> dict[str, Any]:
        """How long, how near, and what a gap must have at least."""
        grid, plan, pair, margin = self.grid(values), self.plan(values), self.vehicle, values["margin"]
        found = {"the pair [m]": f"{pair.length:.2f} x {pair.width:.2f}",
                 "turning on the spot takes [m]": f"{np.hypot(pair.length, pair.width):.2f}",
                 "lower gap, wider than the pair by [m]": f"{values['gap'] - pair.width:.2f}",
                 "a gap needs [m]": f"{pair.width + 2 * margin:.2f}",
                 "a gap is surely found with [m]": f"{inflated_width(grid, pair, margin):.2f}"}
        if not plan.found:
            return {**found, "way": f"none: {plan.reason}"}
        poses = plan.poses
        every = np.concatenate([between(a, b) for a, b in zip(poses, poses[1:])])
        seconds = pair.quickest(step_between(poses[:-1], poses[1:])).sum()
        return {**found, "goes through": f"the {_gap(plan)} gap",
                "way of its middle [m]": f"{plan.length:.2f}",
                "time at the bases' speed limits [s]": f"{seconds:.0f}",
                "least room beside it, by cells [m]": f"{grid.room(pair, every).min():.2f}"}

    def draw(self, values: Values) -> None:
        axes, pair, plan = self._axes, self.vehicle, self.plan(values)
        clearance = self.grid(values).clearance - values["margin"]
        places = [(np.arange(count) + 0.5) * self.grid(values).cell for count in clearance.shape]
        axes.contourf(*places, clearance.T, colors=[_NEVER, _TURNED],
                      levels=[-1.0, pair.width / 2, np.hypot(pair.length, pair.width) / 2])
        stations = _stations(plan.poses) if plan.found else _START[None]
        front = np.array([[pair.length, -pair.width], [pair.length, pair.width]]) / 2
        racks = list(self.hall(values).outlines)
        for outlines in (
                PolyCollection(racks, facecolor=GREY, edgecolor=INK, linewidth=0.8, zorder=2),
                PolyCollection(list(pair.outline(stations)), facecolor="none", edgecolor=BLUE, alpha=0.7, zorder=4),
                PolyCollection(list(carried(stations, front)), edgecolor=BLUE, linewidth=2.5, zorder=4),
                PolyCollection([pair.outline(self.goal(values))], facecolor="none", edgecolor=VERMILION,
                               linewidth=2, linestyle="--", zorder=5)):
            axes.add_collection(outlines, autolim=False)
        if plan.found:
            axes.plot(*plan.poses[:, :2].T, color=BLUE, linewidth=2, zorder=5)
        self.says = axes.text(_SIZE[0] / 2, 2.6, "" if plan.found else "no way",
                              color=VERMILION, weight="bold",
                              ha="center", zorder=6, bbox={"facecolor": "white",
                                                           "edgecolor": VERMILION})

    def describe(self, values: Values) -> str:
        plan = self.plan(values)
        what = f"the way goes through the {_gap(plan)} gap" if plan.found else f"no way: {plan.reason}"
        return (f"A hall from above, {_SIZE[0]:g} by {_SIZE[1]:g} m, with racks across it; the lower gap is "
                f"{values['gap']:.2f} m wide, the upper one {_DETOUR[1] - _DETOUR[0]:.2f} m; {what}")


planning_explorer = PlanningExplorer


def _gap(plan: Plan) -> str:
    """Whether the way crosses the racks above the middle one's center."""
    x, y = plan.poses[:, 0], plan.poses[:, 1]
    k = int(np.argmax(x > _RACKS))
    across = np.interp(_RACKS, x[k - 1:k + 1], y[k - 1:k + 1])
    return "upper" if across > (_MIDDLE + _DETOUR[0]) / 2 else "lower"


def _stations(poses: Array, step: float = 0.9, turn_step: float = 0.8) -> Array:
    """(k, 3) poses on the way to be drawn, not too many."""
    return np.concatenate([poses[:1], *(between(a, b, step, turn_step)[1:]
                                        for a, b in zip(poses, poses[1:]))])
