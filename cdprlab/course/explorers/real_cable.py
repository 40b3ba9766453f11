"""One cable as it is: over a wheel, with a weight of its own, and stretched."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from scipy.optimize import brentq

from ...arrays import Array
from ...compiled.columns import over_pulley
from ...mechanics.cables import straight_lengths
from ...mechanics.catenary import SaggingCable, sagging_cable
from ...view.style import BLUE, GREY, INK, ORANGE
from .explorer import Explorer, Values, movable, once_a_move, sliders

_SPAN = np.array([6.0, -2.0])


class RealCableExplorer(Explorer):
    """A cable from a wheel to a load 6 m away and 2 m below; what radius, weight, stretch and pull do to its length.

    >>> explorer = real_cable_explorer()
    >>> explorer.set(radius=100.0)
    >>> print(explorer.text.splitlines()[0])
    straight, A to B [m]      6.3246
    """

    def __init__(self) -> None:
        super().__init__(sliders("real_cable"), "One cable, as it is", (6.2, 3.6))

    def tangent(self, values: Values) -> tuple[Array, float]:
        """From B to where the cable leaves the wheel, and how much of it lies on the wheel [m]."""
        pulley = np.array([values["radius"] / 1e3, 0.0, 1.0])   # the cable comes up the pole
        length, *direction = over_pulley(*-_SPAN, 0.0, *pulley, 0.0)
        free = straight_lengths(_SPAN, pulley[None])[0]
        return free * np.array(direction[:2]), length - free

    @once_a_move
    def cable(self, values: Values) -> SaggingCable:
        """The shorter one of the two that pull so hard."""
        span, pull, stiffness = -self.tangent(values)[0], values["pull"], 1e3 * values["stiffness"]
        chord = np.hypot(*span)

        def hung(length: float) -> SaggingCable:
            return sagging_cable(span, length, values["density"], stiffness)

        def excess(length: float) -> float:
            return float(np.hypot(*hung(length).force_at_anchor)) - pull

        # Stretched half as much again it pulls harder, a fifth longer it hangs.
        return hung(brentq(excess, chord / (1 + 1.5 * pull / stiffness), 1.2 * chord,
                           xtol=1e-10))

    def build(self, figure: Figure) -> None:
        axes = figure.subplots()
        self._wheel = movable(axes, color=GREY, lw=3)
        axes.plot([0, _SPAN[0]], [0, _SPAN[1]], "--", color=INK, lw=1, label="straight, A to B")
        self._over = movable(axes, ":", color=ORANGE, lw=2.5, label="over the wheel")
        self._sagging = movable(axes, color=BLUE, lw=2, label="with its weight")
        axes.plot(*_SPAN, "s", color=INK, ms=12)
        axes.plot([0, 0], [-2.6, 0], color=INK, lw=1)
        axes.annotate("B", (_SPAN[0], _SPAN[1]), (10, 0), textcoords="offset points")
        axes.annotate("A", (0, 0), (-14, -4), textcoords="offset points")
        axes.set(xlabel="x [m]", ylabel="y [m]", xlim=(-0.6, 6.7), ylim=(-2.9, 0.9),
                 aspect="equal")
        axes.legend(loc="lower left", bbox_to_anchor=(0.05, 0.0))

    def draw(self, values: Values) -> None:
        radius, (ahead, wrapped) = values["radius"] / 1e3, self.tangent(values)
        around, wrap = (_around(radius, end) for end in (2 * np.pi, wrapped / radius))
        self._wheel.set_data(*around.T)
        self._over.set_data(*np.vstack([wrap, _SPAN]).T)
        self._sagging.set_data(*(_SPAN + ahead + self.cable(values).points(60)).T)

    def numbers(self, values: Values) -> dict[str, Any]:
        (ahead, wrapped), cable = self.tangent(values), self.cable(values)
        straight, chord = np.hypot(*_SPAN), np.hypot(*ahead)
        points = cable.points(201)
        below = (np.linspace(0, points[-1], 201) - points)[:, 1].max()
        stretched = np.linalg.norm(np.diff(points, axis=0), axis=1).sum()
        pull = np.hypot(*cable.force_at_anchor)
        turned = abs(np.angle(complex(*cable.force_at_anchor) / complex(*ahead), deg=True))
        return {
            "straight, A to B [m]": f"{straight:.4f}",
            "over the wheel [m]": f"{wrapped + chord:.4f}",
            "more, by the wheel [mm]": f"{1e3 * (wrapped + chord - straight):.1f}",
            "more, by the sag [mm]": f"{1e3 * (stretched - chord):.2f}",
            "less, by the stretch [mm]": f"{1e3 * (stretched - cable.length):.2f}",
            "sags by [mm]": f"{1e3 * below:.1f}",
            "end turned by [deg]": f"{turned:.2f}",
            "pull at the load [N]": f"{pull:.1f}",
        }

    def describe(self, values: Values) -> str:
        found = self.numbers(values)
        return (f"A cable over a wheel of {values['radius']:.0f} mm to a load 6 m away: longer by "
                f"{found['more, by the wheel [mm]']} mm, sagging by {found['sags by [mm]']} mm.")


real_cable_explorer = RealCableExplorer


def _around(radius: float, end: float) -> Array:
    """(60, 2) on the wheel's rim, from A so far around it [m, m, rad]."""
    turn = np.linspace(0, end, 60)
    return radius * np.column_stack([1 - np.cos(turn), np.sin(turn)])
