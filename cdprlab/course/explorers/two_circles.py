"""Two lengths, two circles, two places: where is a point on two cables, and where does a load hang on two ropes?"""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle

from ...arrays import Array, as_array, checked
from ...robot.pose import Pose
from ...view.outlines import hanging
from ...view.style import INK, SKY, cable_style
from ..pictures.panels import draw_exit_points
from ..props.experiments import hang
from ..props.point_load import circle_crossings, lower_crossing, point_load
from ..text_table import in_brackets
from .explorer import Choice, Explorer, Slider, Values

EXIT_POINTS = np.array([[0.0, 3.0], [5.0, 3.0]])
"""Of the two cables [m]."""

_START = Pose([2.5, 1.0], angle=0.0)
"""Where the load is before the winches bring the ropes to length; it does not matter where."""

_LOOKS: Any = tuple(zip((cable_style(0).color, cable_style(1).color), ("solid", (0, (5, 2)))))
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
        controls: list[Slider | Choice] = [Slider("l1", "length l₁", "m", 1.0, 7.0, 3.0, 0.05),
                                           Slider("l2", "length l₂", "m", 1.0, 7.0, 4.0, 0.05),
                                           Choice("hang", "hang a load", ("no", "yes"), "no")]
        super().__init__(controls, title="Two lengths, two circles, two places",
                         size=(5.6, 5.2))

    def build(self, figure: Figure) -> None:
        self._panel = figure.subplots()
        draw_exit_points(self._panel, EXIT_POINTS, ("A₁", "A₂"))
        self._panel.set(xlim=(-2.8, 7.8), ylim=(-4.3, 6.3), aspect="equal", xlabel="x [m]",
                        ylabel="y [m]")
        handles = [Line2D([], [], color=color, linestyle=dashes,
                          label=f"as far from {end} as its cable is long")
                   for end, (color, dashes) in zip(("A₁", "A₂"), _LOOKS)]
        handles += [Line2D([], [], color=INK, marker="o", markersize=8, linestyle="none",
                           label=self._whose),
                    Line2D([], [], color=SKY, marker="s", markersize=10, linewidth=4,
                           label="a load at rest on ropes")]
        figure.legend(loc="outside lower center", ncols=2, fontsize=9, handles=handles)

    def numbers(self, values: Values) -> dict[str, Any]:
        self._solve(values)
        text = {"crossings [m]": "none: the circles miss each other"
                if np.isnan(self._crossings).any()
                else " and ".join(in_brackets(point, 3) for point in self._crossings),
                f"{self._whose} [m]": "none"
                if self._found is None else in_brackets(self._found, 3)}
        return text | self._hung()

    def draw(self, values: Values) -> None:
        panel, settled = self._panel, self._settled
        self.load = []
        if settled is not None:
            load = settled.pose.position
            for rope in zip(EXIT_POINTS, self._lengths):
                panel.plot(*hanging(load, *rope).T, color=SKY, linewidth=6.0, alpha=0.8)
            self.load = panel.plot(*load, marker="s", markersize=18, color=SKY)
        for exit_point, length, (color, dashes) in zip(EXIT_POINTS, self._lengths, _LOOKS):
            panel.add_patch(Circle(exit_point, length, fill=False, linewidth=1.4,
                                   edgecolor=color, linestyle=dashes))
            if self._found is not None:
                panel.plot(*np.transpose([exit_point, self._found]), color=color,
                           linestyle=dashes, linewidth=2.4)
        panel.plot(*self._crossings[1], marker="o", markersize=10, color=INK,
                   markerfacecolor="white")
        if self._found is not None:
            panel.plot(*self._found, marker="o", markersize=10, color=INK)

    def describe(self, values: Values) -> str:
        place = "no point" if self._found is None else f"the point at {in_brackets(self._found, 3)} m"
        load = "; load " + self._hung()["load"].replace("\n", " ")
        return f"Circles of radius {values['l1']:g} and {values['l2']:g} m around exit points 5 m apart; {place}{load}"

    # --- inside ---------------------------------------------------------------------------------------
    @property
    def _whose(self) -> str:
        return "lower crossing" if self._formula is lower_crossing else "your point"

    def _solve(self, values: Values) -> None:
        self._lengths = np.array([values["l1"], values["l2"]])
        self._crossings = circle_crossings(EXIT_POINTS, self._lengths)
        self._found = None
        with suppress(ValueError):   # no point has these lengths
            self._found = self._formula(EXIT_POINTS[0].copy(), EXIT_POINTS[1].copy(),
                                        *self._lengths.tolist())
        if self._found is not None:
            self._found = as_array(self._found, "the point", (2,), "m")
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
        if self._found is not None:
            apart = 1e3 * np.linalg.norm(settled.pose.position - self._found)
            text[f"load to {self._whose} [mm]"] = f"{apart:.3f}"
        return text


two_circles_explorer = TwoCirclesExplorer
