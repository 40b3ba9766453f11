"""Move a point load, push it, tighten its cables: does the force polygon close? Then let it go in the engine."""

import textwrap
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from ...arrays import checked
from ...robot.pose import Pose
from ..pictures.equilibrium import draw_panels, panels
from ..props.experiments import Motion, let_go
from ..props.point_load import EXIT_POINTS, MASS, Equilibrium, equilibrium, point_load
from ..text_table import fixed, in_brackets
from .explorer import Choice, Explorer, Values, once_a_move, sliders


@checked
class EquilibriumExplorer(Explorer):
    """Sliders for load, push and tensions; robot, force polygon and tensions, W τ + w_e = 0 in pictures; and a last
    slider that lets the load go in the engine, tensions held.

    n_cables : 2, 3 or 4, at the start
    internal : whether the internal tension λ of τ = −W⁺ w_e + λ h can be moved
    Raises InvalidInput for another number of cables.

    >>> explorer = equilibrium_explorer(3)
    >>> explorer.set(x=0.5, internal=100)
    >>> bool(explorer.state(explorer.values).closed)
    True
    """

    def __init__(self, n_cables: int = 2, internal: bool = True) -> None:
        self._robots = {m: point_load(m) for m in EXIT_POINTS}
        m = Choice("cables", "number of cables m", tuple(EXIT_POINTS),
                   point_load(n_cables).n_cables)
        # They end short of the exit points at x = ±2 m, where a cable would have no length.
        moved = [slider for slider in sliders("balance") if internal
                 or slider.name != "internal"]
        super().__init__([m, *moved], "Forces on a point load")

    @once_a_move
    def state(self, values: Values) -> Equilibrium:
        """The balance of forces at the controls' values."""
        state = equilibrium(self._robots[values["cables"]], *_load(values),
                            values.get("internal", 0.0))
        return state.held(state.tensions + values["extra"] * np.eye(values["cables"])[0])

    @once_a_move
    def motion(self, values: Values) -> Motion | None:
        """What the engine does with the load, tensions and push held; None as long as the load is."""
        if not values["time"]:
            return None
        position, push = _load(values)
        return let_go(self._robots[values["cables"]], Pose(position),
                      self.state(values).tensions,
                      push, values["time"])

    def build(self, figure: Figure) -> None:
        self.axes = panels(figure, stacked=True)

    def draw(self, values: Values) -> None:
        with self.steady(*self.axes[1:]):
            draw_panels(self.axes, self._robots[values["cables"]], *_load(values),
                        self.state(values), self.motion(values))

    def numbers(self, values: Values) -> dict[str, Any]:
        state, motion = self.state(values), self.motion(values)
        columns = zip(state.tensions, state.null_vector, state.slack)
        rows = [f"{i:>5}  {fixed(tension, 1):>10}  {fixed(h, 2):>6}{'  slack!' if slack else ''}"
                for i, (tension, h, slack) in enumerate(columns, start=1)]
        return {
            "redundancy r = m − n": values["cables"] - 2,
            "w_e [N]": in_brackets(state.w_e, 1),
            "‖W τ + w_e‖ [N]": f"{np.linalg.norm(state.residual):.1e}",
            "cable       τ [N]       h": "\n".join(rows),
            "Let go: M a = W max(τ, 0) + w_e": _told(state, motion),
            "In words": "\n".join(textwrap.wrap(state.words(), 54)),
        }

    def idle(self, values: Values) -> dict[str, str]:
        if values["cables"] > 2 or "internal" not in values:
            return {}
        return {"internal": "two cables hold a point in one way only, r = 0"}

    def describe(self, values: Values) -> str:
        motion = self.motion(values)
        moved = f" Let go, it moves {1e3 * motion.way:.0f} mm in {values['time']:g} s." if motion else ""
        return (f"{self.title} on {values['cables']} cables at ({values['x']:g}, {values['y']:g}) m: "
                f"{self.state(values).words()}{moved}")


equilibrium_explorer = EquilibriumExplorer


def _load(values: Values) -> tuple[list[float], list[float]]:
    """Position [m] and push [N]."""
    return [values["x"], values["y"]], [values["push_x"], values["push_y"]]


def _told(state: Equilibrium, motion: Motion | None) -> str:
    """Acceleration and way, by the formula and by the engine."""
    if motion is None:
        return "held: which way will it go?\nThen move the last slider"
    a, t = state.left_over / MASS, motion.time[-1]
    return (f"left over  {in_brackets(state.left_over, 1)} N, ropes only pull\n"
            f"formula    a = {in_brackets(a, 3)} m/s², ½ a t² = {500 * np.linalg.norm(a) * t**2:.1f} mm\n"
            f"pymunk     a = {in_brackets(motion.acceleration, 3)} m/s², moved {1e3 * motion.way:.1f} mm")
