"""Pictures of workspaces: maps with contours of the margin, certified boxes, and the border in space."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.collections import PatchCollection
from matplotlib.colors import ListedColormap, to_rgb
from matplotlib.patches import Patch, Rectangle

from ..arrays import Array
from ..errors import InvalidInput
from ..robot import Robot
from ..robot.pose import Pose
from ..workspace import CertifiedWorkspace, Judgement, PoseGrid
from ..workspace.grids import axis_names
from ..workspace.surface import border_triangles
from ..world import World
from .depth import Blocks, lightness
from .drawing import RobotDrawing
from .film import save_png
from .outlines import box_corners, surroundings
from .picture import Picture
from .plots import Figure, checked_path, fitted_title
from .screen import robot_axes, sized_figure
from .style import BLUE, GREY, INK, VERMILION, WARNING, house_style

_PALE = "#A9CBE3"
_SURFACE = "#5696C8"


def plot_workspace(robot: Robot, grid: PoseGrid, judgement: Judgement, *, title: str = "", unit: str = "",
                   quantity: str = "margin") -> Figure:
    """A map over a plane grid: inside shaded by the margin with contours, outside pale red, the border as a line.

    robot : its exit points are drawn where they lie in the plane's directions
    grid : with two axes; judgement : of its poses
    unit, quantity : of the margin, for the color bar
    Raises InvalidInput for a grid that is no plane.
    """
    return plot_workspaces(robot, grid, {"": judgement}, title=title or "Workspace", unit=unit, quantity=quantity,
                           columns=1)


def plot_workspaces(robot: Robot, grid: PoseGrid, judgements: Mapping[str, Judgement], *, title: str = "",
                    unit: str = "", quantity: str = "margin", columns: int = 2) -> Figure:
    """Several maps over the same grid, one panel a name, with the same scale of the margin."""
    if len(grid.axes) != 2:
        raise InvalidInput(f"a map needs a grid over two axes, this one is over {', '.join(grid.axes)}; hold one axis "
                           "by giving it the same lower and upper end")
    rows = -(-len(judgements) // columns)
    finite = [j.margin[j.inside & np.isfinite(j.margin)] for j in judgements.values()]
    # The few largest margins share the last color, so that the others can be told.
    most = max((float(np.quantile(part, 0.97)) or float(part.max()) for part in finite if part.size), default=0.0)
    label = f"{quantity} [{unit}]" if unit else quantity
    with house_style():
        figure = _sized([float(np.ptp(places)) for places in grid.axes.values()], rows, columns)
        panels = figure.subplots(rows, columns, squeeze=False).ravel()
        for panel, (name, judgement) in zip(panels, judgements.items()):
            _draw_map(panel, robot, grid, judgement, label, most or 1.0)
            panel.set_title(name)
        for panel in panels[len(judgements):]:
            panel.set_axis_off()
        fitted_title(figure, title)
        figure.alt_text = f"{title}. " + " ".join(f"{name}: {describe(grid, judgement, unit)}".removeprefix(": ")
                                                  for name, judgement in judgements.items())
        return figure


def _draw_map(axes: Axes, robot: Robot, grid: PoseGrid, judgement: Judgement, label: str, most: float) -> None:
    x, y = grid.axes.values()
    inside, margin = grid.field(judgement.inside).T, grid.field(judgement.margin).T
    axes.pcolormesh(x, y, np.ma.masked_where(inside, inside), cmap=ListedColormap([WARNING]), shading="nearest")
    shown = np.where(inside & np.isfinite(margin), margin, np.nan)
    if np.isfinite(shown).any():
        blues = ListedColormap(colormaps["Blues"](np.linspace(0.12, 0.72, 256)))
        drawn = axes.pcolormesh(x, y, shown, cmap=blues, vmin=0, vmax=most, shading="nearest")
        levels = np.unique([float(f"{level:.2g}") for level in most * np.array([0.2, 0.4, 0.6, 0.8])])
        lines = axes.contour(x, y, np.ma.masked_invalid(shown), levels, colors=INK, linewidths=0.6)
        axes.clabel(lines, fmt=lambda value: f"{value:.0f}" if abs(value) >= 100 else f"{value:.3g}", fontsize=8)
        figure: Any = axes.figure
        figure.colorbar(drawn, ax=axes, label=label, location="bottom" if np.ptp(x) > np.ptp(y) else "right",
                        aspect=35, extend="max" if np.nanmax(shown) > most else "neither")
    else:
        axes.pcolormesh(x, y, np.ma.masked_where(~inside, inside), cmap=ListedColormap([_PALE]), shading="nearest")
    if inside.any() and not inside.all():
        axes.contour(x, y, inside.astype(float), [0.5], colors=INK, linewidths=1.6)
    _frame(axes, robot, list(grid.axes), x, y)


def plot_certified(robot: Robot, found: CertifiedWorkspace, *, title: str = "") -> Figure:
    """Boxes certainly inside (blue), certainly outside (vermilion, hatched) and undecided (grey) of a plane.

    Raises InvalidInput where the boxes vary along other than two axes.
    """
    columns = np.flatnonzero(found.varying)
    if len(columns) != 2:
        raise InvalidInput(f"certified boxes are drawn over two axes, these vary along {len(columns)}; hold the others")
    names = [("xyφ" if robot.dimension == 2 else "xyz")[k] for k in columns]
    looks: dict[str, tuple[Array, Any]] = {
        "certainly inside": (found.inside, {"facecolor": _PALE, "edgecolor": BLUE}),
        "certainly outside": (found.outside, {"facecolor": WARNING, "edgecolor": VERMILION, "hatch": "///"}),
        "undecided": (found.undecided, {"facecolor": GREY, "edgecolor": GREY})}
    with house_style():
        figure = _sized((found.upper.max(axis=0) - found.lower.min(axis=0))[columns].tolist())
        axes = figure.add_subplot()
        for boxes, look in looks.values():
            patches = [Rectangle(low[columns], *(high - low)[columns]) for low, high in boxes]
            axes.add_collection(PatchCollection(patches, linewidth=0.3, **look))
        _frame(axes, robot, names, *np.stack([found.lower.min(axis=0), found.upper.max(axis=0)], axis=1)[columns])
        keys: Any = [Patch(label=name, **look) for name, (_, look) in looks.items()]
        figure.legend(handles=keys, loc="outside lower left", ncols=3)
        fitted_title(figure, title)
        low, high = found.bounds
        counts = ", ".join(f"{len(boxes)} boxes {name}" for name, (boxes, _) in looks.items())
        figure.alt_text = f"{title or 'Certified workspace'}. {counts}; inside measures {low:.4g} to {high:.4g}."
        return figure


def workspace_still(world: World, grid: PoseGrid, judgement: Judgement, path: str | Path, width: int = 960) -> Path:
    """A PNG of the border of a workspace in space, around the robot at its start; its description goes into the file.

    grid : over x, y and z; judgement : of its poses
    path : ends in .png; width : [pixels]
    """
    target, corners = checked_path(path, ".png"), border_triangles(grid, judgement)
    figure = sized_figure(width, 3 * width // 4)
    drawing = RobotDrawing(robot_axes(figure, 3), world.robot, world.scene, world.pose, solid=True)
    view = drawing.view
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True).clip(1e-300)
    middles = corners.mean(axis=1)
    seen = np.flatnonzero((normals * (view.eye - middles)).sum(axis=1) > 0)
    order = seen[np.argsort(-np.linalg.norm(middles[seen] - view.eye, axis=1))]
    colors = np.clip(np.outer(lightness(normals[order]), to_rgb(_SURFACE)), 0, 1)
    drawing.faces(5.4, facecolors=colors, edgecolors=colors, linewidths=0.5).set_verts(view.flat(corners[order]))
    # What stands around it is painted once more, as far as it is not behind the workspace.
    low, high = middles.min(axis=0), middles.max(axis=0)
    space = Blocks(box_corners(high - low, Pose((low + high) / 2))[None], view.eye)
    drawing.paint(drawing.faces(5.5), [solid for solid in surroundings(world.robot, world.scene)
                                      if not space.hides(solid.corners).any()])
    title = f"Border of a workspace of {world.title or world.name}."
    return save_png(Picture(figure).pixels(), target, f"{title} {describe(grid, judgement)}")


def describe(grid: PoseGrid, judgement: Judgement, unit: str = "") -> str:
    """What the picture shows, in words."""
    inside = judgement.inside
    where = ", ".join(f"{name} from {a[0]:.4g} to {a[-1]:.4g} m" for name, a in grid.axes.items())
    text = f"{100 * inside.mean():.1f} % of {len(grid)} poses inside, {where}"
    known = judgement.margin[inside & np.isfinite(judgement.margin)]
    return f"{text}; margins up to {known.max():.4g} {unit}".rstrip() + "." if known.size else f"{text}."


def _sized(extent: Sequence[float], rows: int = 1, columns: int = 1) -> Figure:
    """A figure as high as its maps need."""
    width, height = extent
    across = 7.6 if columns == 1 else 4.9
    up = np.clip(across * (0.25 + 0.84 * height / max(width, 1e-9)), 3.4, across)
    return Figure(figsize=(columns * across, 0.3 + rows * float(up)), layout="constrained")


def _frame(axes: Axes, robot: Robot, names: Sequence[str], x: Array, y: Array) -> None:
    """Axes with units, and the exit points as far as the plane has their directions."""
    if "φ" not in names:
        columns = [axis_names(robot.dimension).index(name) for name in names]
        exits = robot.exit_points[:, columns]
        axes.plot(*exits.T, "s", color=INK, markersize=5, label="exit points", clip_on=False, zorder=5)
        x, y = np.append(x, exits[:, 0]), np.append(y, exits[:, 1])
        axes.set_aspect("equal")
    pad = 0.03 * max(float(np.ptp(x)), float(np.ptp(y)))
    across, up = (f"{name} [rad]" if name == "φ" else f"{name} [m]" for name in names)
    axes.set(xlabel=across, ylabel=up, xlim=(x.min() - pad, x.max() + pad),
             ylim=(y.min() - pad, y.max() + pad))
    axes.grid(False)
