"""Plan a way for two coupled bases: how wide is the gap, how far from everything, where to, and the way answers."""

from typing import Any

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from ...arrays import Array, checked
from ...fastkit import Hall, OccupancyGrid, Plan, Vehicle, carried, inflated_width, plan_path
from ...fastkit.navigation.planner import along
from ...fastkit.plane import step_between
from ...view.style import BLUE, GREY, INK, VERMILION
from .explorer import Explorer, Look, Values, legend_below, once_a_move, sliders

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
        self.vehicle, self._gap = vehicle, 0.0
        super().__init__(sliders("planning"), "A way for the pair", (6.2, 5.0))

    @staticmethod
    def hall(values: Values) -> Hall:
        """The hall with its lower gap as wide as the slider says."""
        low, high = _MIDDLE - values["gap"] / 2, _MIDDLE + values["gap"] / 2
        across = ((0.0, low), (high, _DETOUR[0]), (_DETOUR[1], _SIZE[1]))
        return Hall.of([[_RACKS, (a + b) / 2, _DEPTH, b - a, 0.0] for a, b in across],
                       [[0, 0], _SIZE])

    def grid(self, values: Values) -> OccupancyGrid:
        """Which cells of the hall are free, and how far from everything; the same one as long as the hall is."""
        if values["gap"] != self._gap:
            self._gap, self._grid = values["gap"], OccupancyGrid.of(self.hall(values))
        return self._grid

    @staticmethod
    def goal(values: Values) -> Array:
        """(3,) where the sliders say [m, m, rad]."""
        return np.array([values["x"], values["y"], np.deg2rad(values["heading"])])

    @once_a_move
    def plan(self, values: Values) -> Plan:
        """The way, or why there is none."""
        return plan_path(self.grid(values), self.vehicle, _START, self.goal(values),
                         values["margin"])

    def build(self, figure: Figure) -> None:
        axes = self._axes = figure.subplots()
        axes.set(xlim=(0, _SIZE[0]), ylim=(0, _SIZE[1]), aspect="equal", xlabel="x [m]",
                 ylabel="y [m]")
        axes.grid(False)
        axes.text(_START[0], 1.5, "start", color=INK, ha="center", va="top", zorder=6,
                  animated=True)
        shade = {"marker": "s", "linestyle": "none", "markeredgecolor": GREY, "markersize": 9}
        legend_below(figure, {
            "way of the middle": {"color": BLUE, "linewidth": 2},
            "the middle may never be here": {"color": _NEVER, **shade},
            "only at some headings": {"color": _TURNED, **shade},
            "the pair, its front end thick": {"color": BLUE, "linewidth": 1.2},
            "goal": {"color": VERMILION, "linestyle": "--"}})

    def numbers(self, values: Values) -> dict[str, Any]:
        """How long, how near, and what a gap must have at least."""
        grid, plan, pair, margin = self.grid(values), self.plan(values), self.vehicle, values["margin"]
        found = {"the pair [m]": f"{pair.length:.2f} x {pair.width:.2f}",
                 "turning on the spot takes [m]": f"{np.hypot(*pair.size):.2f}",
                 "lower gap, wider than the pair by [m]": f"{values['gap'] - pair.width:.2f}",
                 "a gap needs [m]": f"{pair.width + 2 * margin:.2f}",
                 "a gap is surely found with [m]": f"{inflated_width(grid, pair, margin):.2f}"}
        if not plan.found:
            return found | {"way": f"none: {plan.reason}"}
        poses = plan.poses
        seconds = pair.quickest(step_between(poses[:-1], poses[1:])).sum()
        return found | {"goes through": f"the {_gap(plan)} gap",
                        "way of its middle [m]": f"{plan.length:.2f}",
                        "time at the bases' speed limits [s]": f"{seconds:.0f}",
                        "least room beside it, by cells [m]": f"{grid.room(pair, along(poses)).min():.2f}"}

    def draw(self, values: Values) -> None:
        axes, pair, plan, grid = self._axes, self.vehicle, self.plan(values), self.grid(values)
        # Every second cell, 4 pixels, draws as fine a line in half the time.
        places = [(np.arange(0, count, 2) + 0.5) * grid.cell for count in grid.clearance.shape]
        axes.contourf(*places, grid.clearance[::2, ::2].T - values["margin"], colors=[_NEVER, _TURNED],
                      levels=[-1.0, pair.width / 2, np.hypot(*pair.size) / 2])
        stations = along(plan.poses, 0.9, 0.8) if plan.found else _START[None]
        front = pair.size / 2 * [[1, -1], [1, 1]]
        usual: Look = {"facecolor": "none", "zorder": 4}
        drawn: list[tuple[Array, Look]] = [
            (self.hall(values).outlines,
             {"facecolor": GREY, "edgecolor": INK, "linewidth": 0.8, "zorder": 2}),
            (pair.outline(stations), {"edgecolor": BLUE, "alpha": 0.7}),
            (carried(stations, front), {"edgecolor": BLUE, "linewidth": 2.5}),
            (pair.outline(self.goal(values))[None],
             {"edgecolor": VERMILION, "linewidth": 2, "linestyle": "--", "zorder": 5})]
        for outlines, look in drawn:
            axes.add_collection(PolyCollection(list(outlines), **usual | look), autolim=False)
        if plan.found:
            axes.plot(*plan.poses[:, :2].T, color=BLUE, linewidth=2, zorder=5)
        self.says = axes.text(_SIZE[0] / 2, 2.6, "" if plan.found else "no way",
                              color=VERMILION, weight="bold", ha="center", zorder=6,
                              bbox={"facecolor": "white", "edgecolor": VERMILION})

    def describe(self, values: Values) -> str:
        plan = self.plan(values)
        what = f"the way goes through the {_gap(plan)} gap" if plan.found else f"no way: {plan.reason}"
        return (f"A hall from above, {_SIZE[0]:g} by {_SIZE[1]:g} m, with racks across it; the lower gap is "
                f"{values['gap']:.2f} m wide, the upper one {_DETOUR[1] - _DETOUR[0]:.2f} m; {what}")


planning_explorer = PlanningExplorer


def _gap(plan: Plan) -> str:
    """Whether the way crosses the racks above the middle one's center."""
    x, y = plan.poses[:, 0], plan.poses[:, 1]
    k = np.argmax(x > _RACKS)
    across = np.interp(_RACKS, x[k - 1:k + 1], y[k - 1:k + 1])
    return "upper" if across > (_MIDDLE + _DETOUR[0]) / 2 else "lower"
