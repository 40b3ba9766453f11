"""Pictures of workspaces: maps with contours of the margin."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap

from ..arrays import Array
from ..errors import InvalidInput
from ..robot import Robot
from ..workspace import Judgement, PoseGrid
from ..workspace.grids import axis_names
from .plots import Figure, fitted_title
from .style import INK, WARNING, house_style

_PALE = "#A9CBE3"


def plot_workspaces(robot: Robot, grid: PoseGrid, judgements: Mapping[str, Judgement], *,
                    title: str = "",
                    unit: str = "", quantity: str = "margin") -> Figure:
    """Maps over a plane grid: inside shaded by the margin with contours, outside pale red, the border as a line.

    robot : its exit points are drawn where they lie in the plane's directions
    grid : with two axes
    judgements : name → of the grid's poses; one panel each, with the same scale of the margin
    unit, quantity : of the margin, for the color bar
    Raises InvalidInput for a grid that is no plane.
    """
    if len(grid.axes) != 2:
        raise InvalidInput(f"a map needs a grid over two axes, this one is over {', '.join(grid.axes)}; hold one axis "
                           "by giving it the same lower and upper end")
    columns = min(len(judgements), 2)
    rows = -(-len(judgements) // columns)
    # The few largest margins share the last color, so that the others can be told.
    most = max((float(np.quantile(known, 0.97) or known.max())
                for known in map(_known, judgements.values()) if known.size), default=0.0)
    label = f"{quantity} [{unit}]" if unit else quantity
    width, height = map(np.ptp, grid.axes.values())
    across = 7.6 if columns == 1 else 4.9
    up = float(np.clip(across * (0.25 + 0.84 * height / width), 3.4, across))
    with house_style():
        figure = Figure(figsize=(columns * across, 0.3 + rows * up), layout="constrained")
        panels = figure.subplots(rows, columns, squeeze=False).ravel()
        for panel, (name, judgement) in zip(panels, judgements.items()):
            _draw_map(panel, robot, grid, judgement, label, most or 1.0)
            panel.set_title(name)
        for panel in panels[len(judgements):]:
            panel.set_axis_off()
        fitted_title(figure, title)
        told = [f"{name}: {describe(grid, judgement, unit)}".removeprefix(": ")
                for name, judgement in judgements.items()]
        figure.alt_text = " ".join([f"{title}.", *told])
        return figure


def _draw_map(axes: Axes, robot: Robot, grid: PoseGrid, judgement: Judgement, label: str,
              most: float) -> None:
    x, y = grid.axes.values()
    inside, margin = grid.field(judgement.inside).T, grid.field(judgement.margin).T

    def fill(values: Any, where: Any, **look: Any) -> Any:
        return axes.pcolormesh(x, y, np.ma.masked_where(~where, values), shading="nearest",
                               **look)

    fill(inside, ~inside, cmap=ListedColormap([WARNING]))
    known = inside & np.isfinite(margin)
    if known.any():
        blues = ListedColormap(colormaps["Blues"](np.linspace(0.12, 0.72, 256)))
        drawn = fill(margin, known, cmap=blues, vmin=0, vmax=most)
        levels = np.unique([float(f"{share * most:.2g}") for share in (0.2, 0.4, 0.6, 0.8)])
        lines = axes.contour(x, y, np.ma.masked_where(~known, margin), levels, colors=INK,
                             linewidths=0.6)
        axes.clabel(lines, fmt=lambda value: f"{value:.0f}" if value >= 100 else f"{value:.3g}",
                    fontsize=8)
        figure: Any = axes.figure
        figure.colorbar(drawn, ax=axes, label=label, aspect=35,
                        location="bottom" if np.ptp(x) > np.ptp(y) else "right",
                        extend="max" if margin[known].max() > most else "neither")
    else:
        fill(inside, inside, cmap=ListedColormap([_PALE]))
    if inside.any() and not inside.all():
        axes.contour(x, y, inside, [0.5], colors=INK, linewidths=1.6)
    # The exit points too, as far as the plane has their directions.
    exits = robot.exit_points[:, [axis_names(robot.dimension).index(name)
                                  for name in grid.axes]]
    axes.plot(*exits.T, "s", color=INK, markersize=5, label="exit points", clip_on=False,
              zorder=5)
    across, up = (f"{name} [m]" for name in grid.axes)
    axes.set(xlabel=across, ylabel=up, aspect="equal")
    axes.margins(0.03)
    axes.grid(False)


def describe(grid: PoseGrid, judgement: Judgement, unit: str = "") -> str:
    """What the picture shows, in words."""
    where = ", ".join(f"{name} from {places[0]:.4g} to {places[-1]:.4g} m"
                      for name, places in grid.axes.items())
    text, known = f"{100 * judgement.inside.mean():.1f} % of {len(grid)} poses inside, {where}", _known(judgement)
    return f"{text}; margins up to {known.max():.4g} {unit}".rstrip() + "." if known.size else f"{text}."


def _known(judgement: Judgement) -> Array:
    """The finite margins of poses inside."""
    return judgement.margin[judgement.inside & np.isfinite(judgement.margin)]
