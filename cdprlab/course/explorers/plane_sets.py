"""What the explorers of available twists and wrenches share: two components of sets, drawn beside the robot."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from ...arrays import Array
from ...errors import InvalidInput
from ...view.style import GREY
from ...world import World
from ..pictures.set_charts import Quantity, axis_label, axis_names, draw_polygon
from .explorer import Explorer, Slider
from .posing import Posing

_SQUARE = np.array([[-1.0, -1], [1, -1], [1, 1], [-1, 1]])


class PlaneSetExplorer(Explorer):
    """Left the robot, right two components of its available twists or wrenches; the base of two explorers.

    world : whose places have sliders too
    quantity : "twist" or "wrench"
    chosen : the two components
    sliders : of all else
    """

    def __init__(self, world: World, quantity: Quantity, chosen: Sequence[int],
                 sliders: Sequence[Slider]) -> None:
        self._posing, self._chosen = Posing(world), list(chosen)
        self._names = [axis_names(world.robot.motion_pattern, quantity)[k] for k in chosen]
        super().__init__([*sliders, *self._posing.places],
                         f"Available {quantity} set: {world.title}", (6.2, 4.7))

    def frame(self, figure: Figure, labels: Sequence[str], ends: Array, beyond: ArrayLike = 0.0) -> None:
        """Axes for the robot and, with lines through 0, for the sets; ``patches`` are moved by ``set_xy``.

        labels : of the sets
        ends : (2, 2) of the sets' axes, a row an axis
        beyond : of the robot's picture, see `Posing.ends`
        """
        left, panel = figure.subplots(1, 2, width_ratios=(1, 1.35))
        self.drawing, self.panel = self._posing.drawing(left, beyond), panel
        self.patches = [draw_polygon(panel, _SQUARE, style, label) for style,
                        label in enumerate(labels)]
        for patch in self.patches:
            patch.set_animated(True)
        panel.axhline(0, color=GREY, linewidth=0.8)
        panel.axvline(0, color=GREY, linewidth=0.8)
        x, y = map(axis_label, self._names)
        panel.set(xlim=ends[0], ylim=ends[1], aspect="equal", xlabel=x, ylabel=y)


def check_set_world(world: World, quantity: str, limit: str) -> None:
    """Whether its set has an area and is bounded.

    quantity : "twist", say
    limit : that bounds it, "speed" or "tension"
    Raises InvalidInput for a single degree of freedom, for a cable without limit.
    """
    if world.robot.n_dof < 2:
        raise InvalidInput(f"world {world.name!r} has a single degree of freedom; its available {quantity} set is a "
                           "line, not a set in the plane")
    if not np.isfinite(getattr(world.robot, f"{limit}_max")).all():
        raise InvalidInput(f"world {world.name!r} has cables without a {limit} limit: no {quantity} is out of reach")
