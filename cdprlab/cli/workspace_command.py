"""``python -m cdprlab workspace WORLD``: a workspace as figure, table and data."""

import argparse
from collections.abc import Callable
from functools import reduce
from operator import and_
from pathlib import Path
from typing import Any

import numpy as np

from .. import view
from ..arrays import Array, as_number
from ..errors import InvalidInput, quoted
from ..run.log import write_csv, write_rows
from ..workspace import (
    Criterion,
    DynamicEquilibrium,
    InterferenceFree,
    Judgement,
    PoseGrid,
    StaticallyStable,
    StaticEquilibrium,
    TippingSafe,
    TwistFeasible,
    WrenchClosure,
    WrenchFeasible,
    position_grid,
    refine,
    workspace,
)
from ..workspace.grids import axis_names
from ..world import World, load_world
from ..world.files import replaced
from .output import Bar, add_output_options, print_table, refuse, results

CRITERIA: dict[str, Callable[[World], Criterion]] = {
    "wrench_closure": lambda _: WrenchClosure(),
    "wrench_feasible": lambda _: WrenchFeasible(),
    "static_equilibrium": lambda _: StaticEquilibrium(),
    "dynamic_equilibrium": lambda world: DynamicEquilibrium(_one_each_way(world)),
    "statically_stable": lambda _: StaticallyStable(),
    "twist_feasible": lambda world: TwistFeasible(half_widths=_one_each_way(world), moving="all"),
    "interference_free": lambda world: InterferenceFree(obstacles=world.scene.boxes),
    "tipping_safe": lambda _: TippingSafe(),
}

_HELD = {"xy": 2, "xz": 1, "yz": 0}
"""Plane → the axis that it cuts."""


def add_workspace_command(commands: Any) -> None:
    """Add the command to a parser's."""
    parser = commands.add_parser("workspace", help="judge poses over a plane or a volume; write map, table, data")
    parser.set_defaults(command=_workspace)
    add = parser.add_argument
    add("world", metavar="WORLD",
        help="a world's name (see `worlds`) or the path of a .yaml file")
    add("--criterion", default="wrench_feasible", metavar="NAME[,NAME…]",
        help=f"{', '.join(CRITERIA)}; several with commas must all hold; asked for are 1 m/s² or 1 m/s "
             "along each axis, no pushes and no clearance (default: %(default)s)")
    add("--plane", metavar="AXES", help="xy, xz or yz, in space (default: xz)")
    add("--at", type=float, help="where the plane cuts its third axis [m] (default: in the middle of the exit points)")
    add("--volume", action="store_true", help="all of the space instead of a plane")
    add("--step", type=float,
        help="between poses [m] (default: a hundredth of the size, a thirtieth for a volume)")
    add("--jobs", type=int, default=1,
        help="processes, -1 for all cores (default: %(default)d)")
    add("--checkpoint",
        help="folder that keeps finished chunks; the same command goes on there")
    add_output_options(parser, "out/WORLD/workspace", "table and data")


def _workspace(options: argparse.Namespace) -> None:
    world = load_world(options.world)
    criterion = _criterion(world, options)
    grid = _grid(world, options)
    with results(options, world, f"{options.criterion} at {len(grid)} poses over {', '.join(grid.axes)}",
                 "workspace") as write:
        with Bar("judging", "poses") as bar:
            found = workspace(world.robot, grid, criterion, n_jobs=options.jobs,
                              checkpoint=options.checkpoint, progress=bar)
        title = f"{world.title or world.name}: {options.criterion.replace('_', ' ').replace(',', ', ')}"

        def tell(folder: Path) -> None:
            table = _table(world, grid, criterion, found, options.jobs)
            write_rows(folder / "table.csv", table.items())
            print_table(table)

        def draw(path: Path) -> None:
            from ..view.workspace import plot_workspaces, workspace_still

            if len(grid.axes) == 3:
                workspace_still(world, grid, found, path)
            else:
                view.save_figure(plot_workspaces(world.robot, grid, {"": found}, title=title,
                                            unit=criterion.unit), path)

        drawn = len(grid.axes) < 3 or found.inside.any()
        write(lambda folder: _save(folder, grid, found), tell, {"workspace.png": draw} if drawn else {})


def _criterion(world: World, options: argparse.Namespace) -> Criterion:
    names = options.criterion.split(",")
    for name in names:
        if name not in CRITERIA:
            raise InvalidInput(f"unknown criterion {quoted(name)}; there are {', '.join(CRITERIA)}")
    return reduce(and_, [CRITERIA[name](world) for name in names])


def _one_each_way(world: World) -> Array:
    """Half widths of a box over the linear directions."""
    turns = len(world.robot.pattern.turn_axes)
    return np.append(np.ones(world.robot.n_dof - turns), np.zeros(turns))


def _grid(world: World, options: argparse.Namespace) -> PoseGrid:
    exits, d, scene = world.robot.exit_points, world.robot.dimension, world.scene
    low, high = np.array([exits.min(axis=0), exits.max(axis=0)]
                         if scene.frame is None else scene.frame)
    if d == 3 or high[-1] - low[-1] < 0.1 * np.ptp(low):
        low[-1] = min(low[-1], scene.floor_height)
    if d == 2:
        refuse(options, ("plane", "at", "volume"), "--{} helps to choose a plane in space; this robot has but one")
    elif options.volume:
        refuse(options, ("plane", "at"), "--{} helps to choose a plane in space; this is a volume")
    else:
        plane = "xz" if options.plane is None else "".join(sorted(options.plane))
        if plane not in _HELD:
            raise InvalidInput(f"plane must be {', '.join(_HELD)}, got {quoted(options.plane)}")
        held = _HELD[plane]
        middle = (low[held] + high[held]) / 2
        low[held] = high[held] = middle if options.at is None else as_number(options.at, "at", "m")
    finest = float((high - low).max()) / (30 if options.volume else 100)
    return position_grid(low, high, finest if options.step is None else options.step)


def _table(world: World, grid: PoseGrid, criterion: Criterion, found: Judgement, jobs: int) -> dict[str, str]:
    inside, unit = found.inside, ("m", "m²", "m³")[len(grid.axes) - 1]
    table = {"poses inside": f"{int(inside.sum())} of {inside.size} ({100 * inside.mean():.1f} %)"}
    if len(grid.axes) < 3:   # each level makes a volume's border four times as many cells
        refined = refine(world.robot, grid, criterion, 2, n_jobs=jobs)
        table["size, border cells halved twice"] = f"{refined.measure:.4g} ± {refined.error:.2g} {unit}"
    else:
        table["size, inside poses' cells"] = f"{inside.sum() * grid.cell:.4g} {unit}"
    known = np.where(inside & np.isfinite(found.margin), found.margin, -np.inf)
    if np.isfinite(known).any():
        best = int(known.argmax())
        place = grid[best:best + 1].position[0].round(6) + 0.0
        where = ", ".join(f"{name} = {x:.3g}" for name, x in zip(axis_names(len(place)), place))
        table["largest margin"] = f"{known[best]:.4g} {criterion.unit}".rstrip() + f" at {where} m"
    return table


def _save(folder: Path, grid: PoseGrid, found: Judgement) -> None:
    poses = grid.poses
    axes: dict[str, Any] = {f"axis_{name}": places for name, places in grid.axes.items()}
    with replaced(folder / "workspace.npz") as file:
        np.savez(file, **axes, position=poses.position, rotation=grid.origin.rotation,
                 inside=found.inside, margin=found.margin)
    columns = {name: (places, "m")
               for name, places in zip(axis_names(poses.dimension), poses.position.T)}
    write_csv(folder / "workspace.csv",
              {**columns, "inside": (found.inside, ""), "margin": (found.margin, "")})
