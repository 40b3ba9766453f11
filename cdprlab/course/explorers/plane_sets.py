"""What the explorers of available twists and wrenches share: two components of a set, drawn in the plane."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Polygon

from ...arrays import Array
from ...errors import InvalidInput
from ...view.style import GREY
from ...world import World
from ..pictures.set_charts import axis_label, draw_polygon

_SQUARE = np.array([[-1.0, -1], [1, -1], [1, 1], [-1, 1]])


def check_set_world(world: World, quantity: str, plural: str, limit: str) -> None:
    """Whether its set has an area and is bounded.

    quantity, plural : "twist" and "twists", say
    limit : that bounds it, "speed" or "tension"
    Raises InvalidInput for a single degree of freedom, for a cable without limit.
    """
    if world.robot.n_dof < 2:
        raise InvalidInput(f"world {world.name!r} has a single degree of freedom; its {plural} are a line, not a set "
                           "in the plane")
    if not np.isfinite(getattr(world.robot, f"{limit}_max")).all():
        raise InvalidInput(f"world {world.name!r} has cables without a {limit} limit: no {quantity} is out of reach")


def set_patches(panel: Axes, labels: Sequence[str], names: Sequence[str], ends: Array) -> list[Polygon]:
    """A polygon for each set, to be moved by ``set_xy``, on axes with lines through 0.

    labels : of the sets
    names : of the two components
    ends : (2, 2) of the panel's axes, a row an axis
    """
    patches = [draw_polygon(panel, _SQUARE, style, label) for style, label in enumerate(labels)]
    for patch in patches:
        patch.set_animated(True)
    panel.axhline(0, color=GREY, linewidth=0.8)
    panel.axvline(0, color=GREY, linewidth=0.8)
    panel.set(xlim=ends[0], ylim=ends[1], aspect="equal", xlabel=axis_label(names[0]),
              ylabel=axis_label(names[1]))
    return patches
