"""Two lengths, two circles, two places: where is a point on two cables, and where does a load hang on two ropes?"""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from ...arrays import Array, as_array, checked
from ...robot.pose import Pose
from ...view.outlines import hanging
from ...view.style import INK, SKY, cable_style
from ..pictures.panels import draw_exit_points
from ..props.experiments import hang
from ..props.point_load import circle_crossings, lower_crossing, point_load
from ..text_table import in_brackets
from .explorer import Choice, Explorer, Look, Values, legend_below, sliders

EXIT_POINTS = np.array([[0.0, 3.0], [5.0, 3.0]])
"""Of the two cables [m]."""

_START = Pose([2.5, 1.0], angle=0.0)
"""Where the load is before the winches bring the ropes to length; it does not matter where."""

_LOOKS: list[Look] = [{"color": cable_style(k).color, "linestyle": dashes} for k,
                      dashes in enumerate(("solid", (0, (5, 2))))]
"""Color and dashes of the two cables and their circles."""

Formula = Callable[[Array, Array, float, float], Any]
"""(A1, A2, l1, l2) → (2,) the place of the point; raises ValueError where there is none."""


@checked
class TwoCirclesExplorer(Explorer):
    """Sliders for two cable lengths: two circles, the point a formula finds, and where a load hangs still.

    formula : somebody's own, (A1, A2, l1, l2) → (2,) [m], raises ValueError where no point has
        these lengths; default the lower crossing

    >>> explorer = two_circles_explorer()
    >>> explorer.set(l1=3.0, l2=6.5, hang="yes")
    >>> print(explorer.text.splitlines()[-2])
    rope 2 is slack, 0.67 m to spare
    """

    def __init__(self, formula: Formula | None = None) -> None:
        load = point_load(2)
        self._robot = replace(load, cables=tuple(replace(cable, exit_point=place)
                                                 for cable, place in zip(load.cables,
                                                                         EXIT_POINTS)))
        self._formula = formula or lower_crossing
        super().__init__([*sliders("two_circles"),
                          Choice("hang", "hang a load", ("no", "yes"))],
                         "Two lengths, two circles, two places", (5.6, 5.2))

    def build(self, figure: Figure) -> None:
        self._panel = figure.subplots()
        draw_exit_points(self._panel, EXIT_POINTS, ("A₁", "A₂"))
        self._panel.set(xlim=(-2.8, 7.8), ylim=(-4.3, 6.3), aspect="equal", xlabel="x [m]",
                        ylabel="y [m]")
        legend_below(figure, {
            "as far from A₁ as its cable is long": _LOOKS[0],
            "as far from A₂ as its cable is long": _LOOKS[1],
            self._whose: {"color": INK, "marker": "o", "markersize": 8, "linestyle": "none"},
            "a load at rest on ropes": {"color": SKY, "marker": "s", "markersize": 10,
                                        "linewidth": 4}})

    def numbers(self, values: Values) -> dict[str, Any]:
        self._solve(values)
        crossings = " and ".join(in_brackets(point, 3) for point in self._crossings)
        if np.isnan(self._crossings).any():
            crossings = "none: the circles miss each other"
        return {"crossings [m]": crossings, f"{self._whose} [m]": self._place} | self._hung()

    def draw(self, values: Values) -> None:
        panel, settled = self._panel, self._settled
        self.load = []
        if settled is not None:
            load = settled.pose.position
            for rope in zip(EXIT_POINTS, self._lengths):
                panel.plot(*hanging(load, *rope).T, color=SKY, linewidth=6.0, alpha=0.8)
            self.load = panel.plot(*load, marker="s", markersize=18, color=SKY)
        for exit_point, length, look in zip(EXIT_POINTS, self._lengths, _LOOKS):
            panel.add_patch(Circle(exit_point, length, fill=False, linewidth=1.4, **look))
            panel.plot(*np.transpose([exit_point, self._found]), linewidth=2.4, **look)
        panel.plot(*self._crossings[1], "o", markersize=10, color=INK, markerfacecolor="white")
        panel.plot(*self._found, "o", markersize=10, color=INK)

    def describe(self, values: Values) -> str:
        load = self._hung()["load"].replace("\n", " ")
        return (f"Circles of radius {values['l1']:g} and {values['l2']:g} m around exit points 5 m apart; "
                f"{self._whose} [m]: {self._place}; load {load}")

    # --- inside ---------------------------------------------------------------------------------------
    @property
    def _whose(self) -> str:
        return "lower crossing" if self._formula is lower_crossing else "your point"

    def _solve(self, values: Values) -> None:
        self._lengths = np.array([values["l1"], values["l2"]])
        self._crossings = circle_crossings(EXIT_POINTS, self._lengths)
        self._found, self._place, answer = np.full(2, np.nan), "none", None
        with suppress(ValueError):   # no point has these lengths
            answer = self._formula(*EXIT_POINTS.copy(), *self._lengths.tolist())
        if answer is not None:
            self._found = as_array(answer, "the point", (2,), "m")
            self._place = in_brackets(self._found, 3)
        self._asked = values["hang"] == "yes"
        self._settled = hang(self._robot, self._lengths, _START) if self._asked else None

    def _hung(self) -> dict[str, str]:
        settled = self._settled
        if not self._asked:
            return {"load": "not hung yet: predict, then let it hang"}
        if settled is None:
            return {"load": "nowhere: the ropes together are shorter\nthan the way from A₁ to A₂"}
        loose = [f"rope {i + 1} is slack, {settled.spare[i]:.2f} m to spare"
                 for i in np.flatnonzero(settled.slack)]
        place = in_brackets(settled.pose.position, 3)
        text = {"load": f"hangs at {place} m\n" + (", ".join(loose) or "both ropes are taut")}
        if self._place != "none":
            apart = 1e3 * np.linalg.norm(settled.pose.position - self._found)
            text[f"load to {self._whose} [mm]"] = f"{apart:.3f}"
        return text


two_circles_explorer = TwoCirclesExplorer
