"""``python -m cdprlab workspace WORLD``: a plane of a workspace as figure, table and data."""

import argparse
from functools import reduce
from operator import and_
from pathlib import Path
from typing import Any

import numpy as np

from .. import view
from ..arrays import as_number
from ..errors import InvalidInput, quoted
from ..run.log import write_csv, write_rows
from ..workspace import (
    Criterion,
    DynamicEquilibrium,
    InterferenceFree,
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
from ..world import World, load_world
from ..world.files import replaced
from .output import print_table, progress_bar, refuse, results

CRITERIA: dict[str, Any] = {
    "wrench_closure": WrenchClosure, "wrench_feasible": WrenchFeasible,
    "static_equilibrium": StaticEquilibrium, "dynamic_equilibrium": DynamicEquilibrium,
    "statically_stable": StaticallyStable, "twist_feasible": TwistFeasible,
    "interference_free": InterferenceFree, "tipping_safe": TippingSafe,
}

PLANES = ("yz", "xz", "xy")
"""By the axis that each cuts."""


def judge_workspace(options: argparse.Namespace) -> None:
    """Judge the poses of a plane, and write them as figure, table and data."""
    world = load_world(options.world)
    criterion, grid = _criterion(world, options), _grid(world, options)
    with results(options, world, f"{options.criterion} at {len(grid)} poses over {', '.join(grid.axes)}",
                 "workspace") as write:
        with progress_bar("judging", "poses") as bar:
            found = workspace(world.robot, grid, criterion, n_jobs=options.jobs,
                              checkpoint=options.checkpoint, progress=bar)
        poses = grid.poses

        def save(folder: Path) -> None:
            axes: dict[str, Any] = {f"axis_{name}": places for name, places in grid.axes.items()}
            with replaced(folder / "workspace.npz") as file:
                np.savez(file, **axes, position=poses.position, rotation=grid.origin.rotation,
                         inside=found.inside, margin=found.margin)
            columns = {name: (places, "m") for name, places in zip("xyz", poses.position.T)}
            write_csv(folder / "workspace.csv",
                      {**columns, "inside": (found.inside, ""), "margin": (found.margin, "")})

        def tell(folder: Path) -> None:
            inside, refined = found.inside, refine(world.robot, grid, criterion, 2, n_jobs=options.jobs)
            unit = "m²" if len(grid.axes) == 2 else "m"
            table = {"poses inside": f"{int(inside.sum())} of {inside.size} ({100 * inside.mean():.1f} %)",
                     "size, border cells halved twice": f"{refined.measure:.4g} ± {refined.error:.2g} {unit}"}
            known = np.flatnonzero(inside & np.isfinite(found.margin))
            if known.size:
                best = known[found.margin[known].argmax()]
                place = poses.position[best].round(6) + 0.0
                where = ", ".join(f"{name} = {x:.3g}" for name, x in zip("xyz", place))
                table["largest margin"] = f"{found.margin[best]:.4g} {criterion.unit}".rstrip() + f" at {where} m"
            write_rows(folder / "table.csv", table.items())
            print_table(table)

        def draw(path: Path) -> None:
            from ..view.workspace import plot_workspaces

            title = f"{world.title or world.name}: {options.criterion.replace('_', ' ').replace(',', ', ')}"
            view.save_figure(plot_workspaces(world.robot, grid, {"": found}, title=title, unit=criterion.unit), path)

        write(save, tell, {"workspace.png": draw})


def _criterion(world: World, options: argparse.Namespace) -> Criterion:
    turns = len(world.robot.pattern.turn_axes)
    one_each_way = np.repeat([1.0, 0.0], [world.robot.n_dof - turns, turns])
    asked: dict[str, dict[str, Any]] = {
        "dynamic_equilibrium": {"accelerations": one_each_way},
        "twist_feasible": {"half_widths": one_each_way, "moving": "all"},
        "interference_free": {"obstacles": world.scene.boxes}}
    names = options.criterion.split(",")
    for name in names:
        if name not in CRITERIA:
            raise InvalidInput(f"unknown criterion {quoted(name)}; there are {', '.join(CRITERIA)}")
    return reduce(and_, [CRITERIA[name](**asked.get(name, {})) for name in names])


def _grid(world: World, options: argparse.Namespace) -> PoseGrid:
    exits, d, scene = world.robot.exit_points, world.robot.dimension, world.scene
    low, high = np.array([exits.min(axis=0), exits.max(axis=0)]
                         if scene.frame is None else scene.frame)
    if d == 3 or high[-1] - low[-1] < 0.1 * np.ptp(low):
        low[-1] = min(low[-1], scene.floor_height)
    if d == 2:
        refuse(options, ("plane", "at"), "--{} helps to choose a plane in space; this robot has but one")
    else:
        plane = "".join(sorted(options.plane))
        if plane not in PLANES:
            raise InvalidInput(f"plane must be {', '.join(PLANES)}, got {quoted(options.plane)}")
        held = PLANES.index(plane)
        middle = (low[held] + high[held]) / 2
        low[held] = high[held] = middle if options.at is None else as_number(options.at, "at", "m")
    return position_grid(low, high, float((high - low).max()) / 100 if options.step is None else options.step)
