"""Hang the platform somewhere at rest: how hard does every cable pull?"""

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from ...arrays import checked
from ...errors import InvalidInput
from ...mechanics.statics import gravity_wrench, wrench_matrix
from ...tensions import TensionDistribution, distribute_tensions
from ...view.style import cable_style
from ...world import World
from ..pictures.panels import bar_panel, draw_bars
from ..text_table import in_brackets
from .explorer import Explorer, Values, once_a_move, rounded_up
from .posing import Posing


@checked
class HangingExplorer(Explorer):
    """Sliders for the platform's place; robot and tensions at rest, W τ + w_e = 0 with w_e the weight.

    world : spatial World
    Raises InvalidInput for anything else.

    >>> import cdprlab as cl
    >>> explorer = hanging_explorer(cl.load_world("caroca"))
    >>> explorer.set(z=2.5)
    >>> print(explorer.text.splitlines()[0])
    weight [N]           1471.5
    """

    def __init__(self, world: World) -> None:
        if world.robot.dimension != 3:
            raise InvalidInput(f"a hanging explorer takes a spatial World, {world.name} is planar")
        self.robot, self._posing = world.robot, Posing(world)
        self.pose = self._posing.pose   # where the sliders say
        super().__init__(self._posing.places, f"{world.title}, at rest", size=(6.2, 5.0))


    @once_a_move
    def tensions(self, values: Values) -> TensionDistribution:
        """The least tensions (in the sense of Σ τ²) that hold the platform still there."""
        robot, pose = self.robot, self.pose(values)
        return distribute_tensions(wrench_matrix(robot, pose), gravity_wrench(robot, pose),
                                   robot.tension_min, robot.tension_max)

    def build(self, figure: Figure) -> None:
        left, right = figure.subplots(2, 1, height_ratios=(1.6, 1))
        self._drawing = self._posing.drawing(left)
        # Three times what the start needs: a pull that grows is seen to grow, and beyond it the
        # number tells.
        self._largest = rounded_up(3.0 * np.nanmax(self.tensions(self.values).tensions,
                                                   initial=1.0), 2)
        self._bars = bar_panel(right, self.robot.n_cables, 1.25 * self._largest)

    def draw(self, values: Values) -> None:
        self._drawing.move(self.pose(values))
        held, m = self.tensions(values), self.robot.n_cables
        tau = held.tensions if held.feasible else np.zeros(m)
        words = [f"{tension:.0f}{' →' if tension > self._largest else ''}" for tension in tau]
        self.words = draw_bars(self._bars, np.minimum(tau, self._largest),
                               [*map(cable_style, range(m))],
                               words if held.feasible else ["?"] * m)

    def numbers(self, values: Values) -> dict[str, Any]:
        held, robot = self.tensions(values), self.robot
        weight = {"weight [N]": f"{robot.mass * robot.gravity:.1f}"}
        if not held.feasible:
            return weight | {"In words": "Within their limits the cables\ncannot hold it here."}
        tau = held.tensions
        vertical = tau @ wrench_matrix(robot, self.pose(values))[2]
        return weight | {
            "Σ τ u, vertical [N]": f"{vertical:.1f}",
            "Σ τ [N]": f"{tau.sum():.0f}",
            "hardest pull": f"{tau.max():.0f} N, cable {tau.argmax() + 1}",
            "softest pull": f"{tau.min():.0f} N, cable {tau.argmin() + 1}",
        }

    def describe(self, values: Values) -> str:
        held = self.tensions(values)
        words = "no tensions within the limits hold it"
        if held.feasible:
            words = f"tensions {', '.join(f'{tension:.0f}' for tension in held.tensions)} N"
        return f"{self.title} at {in_brackets(self.pose(values).position, 2)} m: {words}"


hanging_explorer = HangingExplorer
