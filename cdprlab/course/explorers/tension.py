"""Choose a distribution method, move the platform and the limits: the feasible set, every method's point, the bars."""

import textwrap
from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ...arrays import Array
from ...errors import InvalidInput
from ...mechanics.statics import gravity_wrench, wrench_matrix
from ...robot import Robot
from ...robot.pose import Pose
from ...tensions import TensionDistribution, distribute_tensions, tension_methods
from ...world import World
from ..pictures.tension_panels import MARKS, OWN, draw_set, draw_tensions
from ..pictures.tension_polygon import TensionSet, set_in_words, tension_set
from ..props.point_load import decimal
from ..text_table import cable_table
from .explorer import Choice, Explorer, Slider, Values, once_a_move
from .posing import Posing

BORDER = "walk_along_the_border"
"""Shown in place of a method's tensions: those at the ``walk`` slider's place on the border."""


_STAR = "* an incomplete method: its NO proves nothing"


class TensionState(NamedTuple):
    """What the limits leave at some slider values, and what every method makes of it.

    free : TensionSet
    found : method → TensionDistribution
    shown : (m,) tensions of the chosen method, or on the border [N]
    """

    free: TensionSet
    found: dict[str, TensionDistribution]
    shown: Array


class TensionExplorer(Explorer):
    """Sliders for pose and limits, a menu of methods: what {τ : W τ + w_e = 0, τ_min ≤ τ ≤ τ_max} is, who picks what.

    world_or_robot : World or Robot with one or two redundant cables, at rest under its weight
    start : Pose, single; default the world's, for a robot the middle of its exit points
    Limits are the same for all cables; they start at the robot's, as far as the sliders reach.
    Raises InvalidInput for another redundancy, or a start that does not fit.

    >>> import cdprlab as cl
    >>> explorer = tension_explorer(cl.load_world("caroca"))
    >>> explorer.set(method="barycenter", tension_max=1000)
    >>> print(explorer.text.splitlines()[1])
    feasible set  r = 2: a polygon of 4 corners.
    """

    below = 1

    def __init__(self, world_or_robot: World | Robot, start: Pose | None = None) -> None:
        self._posing = Posing(world_or_robot, start)
        robot = self._posing.robot
        r = robot.n_cables - robot.n_dof
        if r not in (1, 2):
            raise InvalidInput("a tension explorer draws one or two redundant cables (r = m − n); here "
                               f"{robot.n_cables} cables hold {robot.n_dof} freedoms, r = {r}")
        # The kernel method is for r = 1 only.
        self._methods = tuple(name for name in tension_methods() if r == 1 or name != "kernel")
        menu = Choice("method", "method", (*self._methods, BORDER), start="quadratic_program")
        walk = Slider("walk", "walk the border", "%", 0.0, 100.0, 0.0, 1.0)
        limits = _limit_sliders(robot, self._posing.start)
        super().__init__([menu, *limits, *self._posing.places, *self._posing.turns, walk],
                         f"Tensions of {self._posing.title}", size=(6.2, 4.5))

    @once_a_move
    def state(self, values: Values) -> TensionState:
        """The feasible set and all answers at some values of the controls."""
        robot, pose = self._posing.robot, self._posing.pose(values)
        low, high = (np.full(robot.n_cables, values[name])
                     for name in ("tension_min", "tension_max"))
        W, w_e = wrench_matrix(robot, pose), gravity_wrench(robot, pose)
        free = tension_set(W, w_e, low, high)
        found = {name: distribute_tensions(W, w_e, low, high, name) for name in self._methods}
        if values["method"] != BORDER:
            shown = found[values["method"]].tensions
        elif free.redundancy in (1, 2):
            shown = free.tensions(free.walk(values["walk"] / 100))
        else:
            shown = np.full(robot.n_cables, np.nan)
        return TensionState(free, found, np.asarray(shown))

    def build(self, figure: Figure) -> None:
        figure.set_layout_engine("constrained", h_pad=0.08)   # a wide title needs it
        grid = figure.add_gridspec(2, 2, width_ratios=[1.5, 1.0], height_ratios=[1.0, 1.15])
        self._set, robot, self._bars = (figure.add_subplot(part)
                                        for part in (grid[:, 0], grid[0, 1], grid[1, 1]))
        self._drawing = self._posing.drawing(robot)
        handles = [Line2D([], [], linestyle="none", marker=mark.marker,
                          markersize=0.7 * mark.size, color=mark.color,
                          label=name.replace("_", " ")) for name, mark in MARKS.items()
                   if name in self._methods]
        handles.append(Line2D([], [], linestyle="none", marker=OWN[0].marker,
                              markersize=0.6 * OWN[0].size,
                              color=OWN[0].color, markerfacecolor="none",
                              label="walk along the border"))
        figure.legend(handles=handles, loc="outside lower center", ncols=4, fontsize=8.5, handletextpad=0.3,
                      columnspacing=0.9,
                      title="filled: inside the limits; hollow: outside; ring: the bars' tensions", title_fontsize=8.5)

    def draw(self, values: Values) -> None:
        """All three panels."""
        self._drawing.move(self._posing.pose(values))
        state = self.state(values)
        low, high = state.free.low, state.free.high
        # What misses the wrench is no point of the set.
        points = {name: answer.tensions for name, answer in state.found.items()
                  if _balances(answer)}
        if values["method"] == BORDER:
            points[BORDER] = state.shown
        if self.anew:
            self._set.autoscale()
        with self.steady(self._bars):
            draw_set(self._set, state.free, points,
                     {name: bool(answer.feasible) for name, answer in state.found.items()}, values["method"])
            draw_tensions(self._bars, state.shown, low, high, values["method"].replace("_", " "))

    def numbers(self, values: Values) -> dict[str, Any]:
        """Every method in a row; the chosen one's tensions, and its reason where it has none."""
        state = self.state(values)
        top = np.nanmax(state.shown, initial=0.0)
        shown = [_number(tau) if top < 1000 else f"{tau:.0f}" for tau in state.shown]
        rows = [f"{name.replace('_', ' '):<21}{_row(answer)}"
                for name, answer in state.found.items()]
        return {
            "limits": f"{values['tension_min']:.4g} to {values['tension_max']:.4g} N",
            "feasible set": set_in_words(state.free),
            "in words": "\n".join(textwrap.wrap(self.words(values), 54)),
            f"{values['method'].replace('_', ' ')}": cable_table({"τ [N]": shown}, gap=1),
            "method                found?     Σ τ     ‖τ‖  margin [N]": "\n".join([*rows, _STAR]),
        }

    def idle(self, values: Values) -> dict[str, str]:
        return {} if values["method"] == BORDER else {"walk": f"choose the method “{BORDER.replace('_', ' ')}”"}

    def words(self, values: Values) -> str:
        """What the chosen method found, or why not."""
        here = self.state(values)
        if values["method"] == BORDER:
            met = ", ".join(here.free.met_limits(here.shown)) if np.isfinite(here.shown).all() else ""
            return f"On the border; limits met: {met}." if met else "There is no border to walk along."
        answer = here.found[values["method"]]
        if not answer.feasible:
            reason = str(answer.reason)
            return f"{reason[:1].upper()}{reason[1:]}."
        met = ", ".join(here.free.met_limits(answer.tensions))
        return f"Balanced within the limits, {f'at {met}' if met else 'none of them met'}."

    def describe(self, values: Values) -> str:
        """Where the platform is, what can be chosen and what was."""
        return (f"{self.title} at {self.told(values, 'walk')}. {set_in_words(self.state(values).free)} "
                f"{values['method'].replace('_', ' ')}: {self.words(values)}")


tension_explorer = TensionExplorer


def _limit_sliders(robot: Robot, start: Pose) -> list[Slider]:
    """The same limits for all cables, in ranges that touch but never cross, near the tensions at the start."""
    W, w_e = wrench_matrix(robot, start), gravity_wrench(robot, start)
    held = distribute_tensions(W, w_e, robot.tension_min, robot.tension_max, "relaxed").tensions
    least, most = robot.tension_min.max(), robot.tension_max.min()
    largest = max(held.max(), 2 * least, 1e-3 * most)
    unit = 10.0 ** np.floor(np.log10(largest) - 1)
    border = float(np.ceil(largest / unit) * unit)
    return [Slider("tension_min", "τ_min", "N", 0.0, border, least, unit / 2),
            Slider("tension_max", "τ_max", "N", border, 6 * border,
                   float(np.clip(most, border, 6 * border)), unit)]


def _balances(answer: TensionDistribution) -> bool:
    """Whether an answer is balanced at all, limits aside."""
    return bool(np.abs(answer.residual).max() < 1e-6 * (1 + np.abs(answer.tensions).max()))


def _row(answer: TensionDistribution) -> str:
    tau = answer.tensions
    said = "yes" if answer.feasible else "NO" if answer.complete else "NO *"
    numbers = tau.sum(), np.linalg.norm(tau), answer.margin
    return f" {said:<6}" + "".join(f"{_number(float(number)):>8}" for number in numbers)


def _number(value: float) -> str:
    return "–" if not np.isfinite(value) else decimal(value)
