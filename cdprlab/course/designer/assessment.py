"""What a design is worth: equilibrium and rank at the start, interference, stiffness, a slice of the workspace."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from ...arrays import Array, Flags
from ...mechanics.cables import have_directions, why_no_direction
from ...mechanics.statics import gravity_wrench, stiffness, tipping_moments, wrench_matrix
from ...robot import Robot
from ...robot.pose import Pose
from ...tensions import TensionDistribution, distribute_tensions
from ...view.outlines import floor_height, platform_corners
from ...workspace import InterferenceFree, PoseGrid, WrenchFeasible, workspace
from ...workspace.interference import cable_distances, cable_pairs, obstacle_distances, piercing_cables
from ...workspace.stability import smallest_stiffness
from ...world import World
from ..text_table import cable_names

CLEARANCE = 0.02
"""Cables nearer than this to anything are called near [m]."""

ASSUMED_STIFFNESS = 1e5
"""EA of a world whose cables do not stretch, so that designs can be compared [N]."""

PLANES = ("x–y", "x–z", "y–z")
_PLACES, _FEW_PLACES = 28, 8
"""Along a slice's longer side; few where each pose is a linear program of its own (more than two redundant cables)."""


class Slice(NamedTuple):
    """Poses of a plane through the start, all with its orientation.

    grid : PoseGrid
    held : (k,) tensions within the limits hold the platform there
    clear : (k,) and no cable is near another one, the platform or an obstacle
    """

    grid: PoseGrid
    held: Flags
    clear: Flags


class Assessment(NamedTuple):
    """What is known about a design.

    warnings : what is wrong, most serious first, each a sentence
    tensions : TensionDistribution at the start, None where a cable has no direction
    stiffness : (n, n) at the start, None where nothing holds it
    least_stiffness : its smallest eigenvalue, arm 1 m, NaN where nothing holds the start [N/m]
    slice : Slice
    """

    warnings: tuple[str, ...]
    tensions: TensionDistribution | None
    stiffness: Array | None
    least_stiffness: float
    slice: Slice


Window = tuple[Array, Array]
"""Opposite corners (d,) of a box [m]."""


def assess(world: World, plane: str = "x–y", window: Window | None = None) -> Assessment:
    """Judge a world at its start and over a plane through it.

    plane : of `PLANES`; planar robots have "x–y" only
    window : what of the plane is looked at; default the box of exit points and floor

    >>> import cdprlab as cl
    >>> assess(cl.load_world("caroca"), "x–z").warnings
    ()
    """
    robot, pose, found = world.robot, world.pose, workspace_slice(world, plane, window)
    without = why_no_direction(robot, pose)
    if without:
        return Assessment((f"{without.capitalize().replace('this pose', 'the start')}.",), None, None, np.nan, found)
    W, w_e = wrench_matrix(robot, pose), gravity_wrench(robot, pose)
    held = distribute_tensions(W, w_e, robot.tension_min, robot.tension_max)
    K, least = None, np.nan
    if held.feasible:
        K = stiffness(robot, pose, held.tensions, stretch(robot))
        least = float(smallest_stiffness(robot, pose, held.tensions, stretch(robot)))
    return Assessment((*_warnings(world, W, w_e, held, least),), held, K, least, found)


def stretch(robot: Robot) -> float:
    """EA of the robot's cables, or the assumed one [N]."""
    return robot.elasticity.axial_stiffness if robot.elasticity else ASSUMED_STIFFNESS


def workspace_slice(world: World, plane: str = "x–y", window: Window | None = None) -> Slice:
    """The plane's poses within a window, judged at the start's orientation; see `assess`."""
    robot = world.robot
    if robot.dimension == 2:
        plane = PLANES[0]
    grid = slice_grid(world, plane, window)
    poses = grid.poses
    directed = have_directions(robot, poses)
    held = np.zeros(len(grid), bool)
    clear = held.copy()
    if directed.any():
        held[directed] = workspace(robot, poses[directed], WrenchFeasible(), margin=False).inside
    if held.any():
        clear[held] = _clear(world, poses[held])
    return Slice(grid, held, clear)


def slice_grid(world: World, plane: str, window: Window | None = None) -> PoseGrid:
    """Centers of the cells of a plane through the start."""
    low, high = window or exit_box(world)
    # Exit points on one line, or in one place, have no box: it gets some width.
    size = np.maximum(high - low, 0.3 * (high - low).max() or 1.0)
    chosen = ["xyz".index(name) for name in plane.split("–")]
    places = _FEW_PLACES if world.robot.n_cables - world.robot.n_dof > 2 else _PLACES
    axes = {}
    for k in chosen:
        count = max(2, round(places * size[k] / size[chosen].max()))
        axes["xyz"[k]] = (low[k] + high[k] - size[k]) / 2 + (np.arange(count) + 0.5) / count * size[k]
    return PoseGrid(axes, world.pose)


def exit_box(world: World) -> Window:
    """Opposite corners (d,) of the box around all exit points, down to the floor [m]."""
    robot = world.robot
    low = robot.exit_points.min(axis=0)
    low[-1] = floor_height(robot, world.scene)
    return low, robot.exit_points.max(axis=0)


def _clear(world: World, poses: Pose) -> Flags:
    """In the plane cables run in layers: they cross in the picture, not in the machine."""
    spatial = world.robot.dimension == 3
    criterion = InterferenceFree(CLEARANCE, world.scene.boxes, cables=spatial, platform=False)
    free = workspace(world.robot, poses, criterion, margin=False).inside
    return free & ~piercing_cables(world.robot, poses).any(axis=-1) if spatial else free


# --- at the start ---------------------------------------------------------------------------------------------
def _warnings(world: World, W: Array, w_e: Array, held: TensionDistribution, least: float) -> Iterator[str]:
    robot, pose = world.robot, world.pose
    rank = np.linalg.matrix_rank(W, tol=1e-6 * np.abs(W).max())
    if rank < robot.n_dof:
        yield (f"W has rank {rank} of {robot.n_dof} at the start: there is a motion that no cable resists, whatever it "
               f"pulls. {'Add cables, or move' if robot.n_cables < robot.n_dof else 'Move'} exit or anchor points.")
    if held.feasible:
        for name, moments in tipping_moments(robot, pose, held.tensions).items():
            if (moments > 0).any():
                yield (f"Base {name!r} tips at the start: the cables turn it over an edge of its footprint with "
                       f"{moments.max():.3g} N m more than its weight holds.")
    else:
        unlimited = distribute_tensions(W, w_e, 0.0, 100 * max(np.abs(w_e).max(), 1.0))
        if unlimited.feasible:
            tau = unlimited.tensions
            yield ("Infeasible start: no tensions within the limits balance the weight. With other limits "
                   f"cables could: they would pull up to {tau.max():.3g} N, the least {tau.min():.3g} N.")
        else:
            yield ("Infeasible start: the weight is not balanced by cables that can only pull, however hard. "
                   "Move the start, the exit points or the anchor points.")
    if robot.dimension == 3:
        for (i, j), gap in zip(cable_pairs(robot), cable_distances(robot, pose)):
            if gap < CLEARANCE:
                yield f"Interference: cables {i + 1} and {j + 1} are {_gap(gap)} at the start."
        through = piercing_cables(robot, pose)
        if through.any():
            yield f"Interference: {cable_names(through)} through the platform's box at the start."
    for box in world.scene.boxes:
        gaps = obstacle_distances(robot, pose, box)
        nearest = gaps.argmin()
        if gaps[nearest] < CLEARANCE:
            what = box.name or f"a {box.kind}"
            yield f"Interference: cable {nearest + 1} is {_gap(gaps[nearest])} from {what} at the start."
    if least <= 0:
        yield (f"Not stable at the start: the smallest eigenvalue of the stiffness is {least:.3g} N/m; a small "
               "push is not pushed back.")
    depth = floor_height(robot, world.scene) - platform_corners(robot, pose)[:, -1].min()
    if depth > 1e-6:
        yield f"The platform starts {depth:.3g} m below the floor."


def _gap(gap: float) -> str:
    return "touching" if gap < 1e-6 else f"{1e3 * gap:.0f} mm apart"
