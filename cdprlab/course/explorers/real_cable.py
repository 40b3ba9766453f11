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
from .explorer import Explorer, Slider, Values, movable, once_a_move

_SPAN = np.array([6.0, -2.0])


class RealCableExplorer(Explorer):
    """A cable from a wheel to a load 6 m away and 2 m below; what radius, weight, stretch and pull do to its length.

    >>> explorer = real_cable_explorer()
    >>> explorer.set(radius=100.0)
    >>> print(explorer.text.splitlines()[0])
    straight, A to B [m]      6.3246
    """

    def __init__(self) -> None:
        super().__init__([
            Slider("radius", "radius of the wheel", "mm", 1.0, 400.0, 45.0, 1.0),
            Slider("density", "mass of the cable", "kg/m", 0.01, 2.0, 0.05, 0.01),
            Slider("stiffness", "stiffness EA", "kN", 100.0, 2000.0, 100.0, 10.0),
            Slider("pull", "pull at the load", "N", 150.0, 3000.0, 500.0, 10.0),
        ], "One cable, as it is", size=(6.2, 3.6))

    def tangent(self, values: Values) -> tuple[Array, float]:
        """Where the cable leaves the wheel, and the angle that it is wrapped by [rad]."""
        radius = values["radius"] / 1e3
        pulley = np.array([radius, 0.0, 1.0])   # the cable comes up the pole
        length, *direction = over_pulley(*-_SPAN, 0.0, pulley)
        free = float(straight_lengths(_SPAN, pulley[None])[0])
        return _SPAN + free * np.array(direction[:2]), (length - free) / radius

    @once_a_move
    def cable(self, values: Values) -> SaggingCable:
        """The shorter one of the two that pull so hard."""
        span = _SPAN - self.tangent(values)[0]
        chord, pull = float(np.hypot(*span)), values["pull"]

        def hung(length: float) -> SaggingCable:
            return sagging_cable(span, length, values["density"], 1e3 * values["stiffness"])

        def excess(length: float) -> float:
            return float(np.linalg.norm(hung(length).force_at_anchor)) - pull

        # Stretched half as much again it pulls harder, a fifth longer it hangs.
        taut = chord / (1 + 1.5 * pull / (1e3 * values["stiffness"]))
        return hung(brentq(excess, taut, 1.2 * chord, xtol=1e-10))

    def build(self, figure: Figure) -> None:
        axes = figure.subplots()
        self._wheel = movable(axes, color=GREY, lw=3)
        self._straight = movable(axes, "--", color=INK, lw=1, label="straight, A to B")
        self._over = movable(axes, ":", color=ORANGE, lw=2.5, label="over the wheel")
        self._sagging = movable(axes, color=BLUE, lw=2, label="with its weight")
        axes.plot(*_SPAN, "s", color=INK, ms=12)
        axes.annotate("B", (6.0, -2.0), (10, 0), textcoords="offset points")
        axes.annotate("A", (0, 0), (-14, -4), textcoords="offset points")
        axes.plot([0, 0], [-2.6, 0], color=INK, lw=1)
        axes.set(xlabel="x [m]", ylabel="y [m]", xlim=(-0.6, 6.7), ylim=(-2.9, 0.9), aspect="equal")
        axes.legend(loc="lower left", bbox_to_anchor=(0.05, 0.0))

    def draw(self, values: Values) -> None:
        radius, (leaves, wrap) = values["radius"] / 1e3, self.tangent(values)
        turn = np.linspace(0, 2 * np.pi, 60)
        self._wheel.set_data(radius - radius * np.cos(turn), radius * np.sin(turn))
        self._straight.set_data([0, _SPAN[0]], [0, _SPAN[1]])
        arc = np.linspace(0, wrap, 30)
        self._over.set_data([*(radius - radius * np.cos(arc)), _SPAN[0]],
                            [*(radius * np.sin(arc)), _SPAN[1]])
        self._sagging.set_data(*(leaves + self.cable(values).points(60)).T)

    def numbers(self, values: Values) -> dict[str, Any]:
        radius, (leaves, wrap) = values["radius"] / 1e3, self.tangent(values)
        cable = self.cable(values)
        chord = float(np.hypot(*(_SPAN - leaves)))
        straight, over = float(np.hypot(*_SPAN)), radius * wrap + chord
        points, share = cable.points(201), np.linspace(0, 1, 201)[:, None]
        below = float((share * points[-1] - points)[:, 1].max())
        stretched = float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
        pull = float(np.linalg.norm(cable.force_at_anchor))
        ahead, end = (leaves - _SPAN) / chord, cable.force_at_anchor / pull
        turned = float(np.degrees(np.arcsin(abs(ahead[0] * end[1] - ahead[1] * end[0]))))
        return {
            "straight, A to B [m]": f"{straight:.4f}",
            "over the wheel [m]": f"{over:.4f}",
            "more, by the wheel [mm]": f"{1e3 * (over - straight):.1f}",
            "more, by the sag [mm]": f"{1e3 * (stretched - chord):.2f}",
            "less, by the stretch [mm]": f"{1e3 * (stretched - float(cable.length)):.2f}",
            "sags by [mm]": f"{1e3 * below:.1f}",
            "end turned by [deg]": f"{turned:.2f}",
            "pull at the load [N]": f"{pull:.1f}",
        }

    def describe(self, values: Values) -> str:
        found = self.numbers(values)
        return (f"A cable over a wheel of {values['radius']:.0f} mm to a load 6 m away: longer by "
                f"{found['more, by the wheel [mm]']} mm, sagging by {found['sags by [mm]']} mm.")


real_cable_explorer = RealCableExplorer
