"""Certified workspaces: boxes of poses that are inside or outside beyond doubt, and what is left between them."""
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, checked
from ..errors import InvalidInput
from ..mechanics.cables import cables_at, have_directions
from ..mechanics.intervals import Intervals
from ..mechanics.statics import gravity_wrench
from ..robot import Robot
from ..robot.pose import Pose
from .capacity import best_tensions, capacity_margins, one_or_several
from .grids import corners
from .interval_statics import PoseBoxes, certainly_inside, certainly_outside
from .workspace_cells import WorkspaceCells, halved

_MOST_BOXES, _CHUNK = 2_000_000, 4096


@checked
def certify(robot: Robot, lower: ArrayLike, upper: ArrayLike, *, resolution: Annotated[float, "[m] > 0"] = 0.05,
            rpy: ArrayLike | None = None, angle: float | None = None,
            wrenches: ArrayLike | None = None) -> WorkspaceCells:
    """Wrench feasibility under the weight, proven box by box with intervals rounded outward (branch and bound).

    Inside: tensions that follow the pose are proven to balance the wrench within the limits all
    over the box. Outside: one hyperplane separates the wrench from all that the cables can do,
    all over the box. Robot and limits are taken as given, in floating point, and not one newton
    is forgiven.

    lower, upper : (d,) corners [m]; in the plane (x, y, φ) as well [m, rad]; equal ends hold an
        axis
    resolution : boxes that are neither are halved down to this size [m; rad for φ]
    rpy, angle : the orientation where it is held, as `Pose` takes it [rad]
    wrenches : (k, n) or (n,) external wrenches besides the weight; inside needs all of them
        [N, N m]
    Raises InvalidInput for a 2R3T robot, one with pulleys, or where the boxes get too many.
    Source: Gouttefarde, Daney and Merlet 2011 (interval-analysis-based determination of the
    wrench-feasible workspace); the proofs are chosen anew.

    >>> import cdprlab as cl
    >>> found = certify(cl.load_world("planar_point").robot, [-0.5, 0.5], [0.5, 1.5], resolution=0.2)
    >>> found.bounds[0] <= found.bounds[1] <= 1.0
    True
    """
    if robot.motion_pattern == "2R3T":
        raise InvalidInput("a 2R3T robot's wrench turns with its rod: only the other motion patterns can be certified")
    if robot.pulleys.size:
        raise InvalidInput("proofs over boxes of poses know cables that leave their exit points straight, "
                           "this robot's run over pulleys: use workspace() instead")
    low, high = corners(lower, upper)
    if low.size not in (robot.dimension, 3):
        raise InvalidInput(f"lower must be {robot.dimension} numbers [m] for this robot, got {low.size}")
    rotation = Pose(np.zeros(robot.dimension), rpy, angle=angle).rotation
    loads = one_or_several(wrenches, "wrenches", robot.n_dof, "N, N m")
    low, high = low[None], high[None]
    kept: list[tuple[Array, Array, Array]] = []
    while len(low):
        verdict = np.concatenate([
            _verdicts(robot, low[k:k + _CHUNK], high[k:k + _CHUNK], rotation, loads)
            for k in range(0, len(low), _CHUNK)])
        done = (verdict != 0) | (high - low <= resolution * (1 + 1e-9)).all(axis=1)
        kept.append((low[done], high[done], verdict[done]))
        low, high = low[~done], high[~done]
        low, high = halved(low, high, (high - low).argmax(axis=1))
        if len(low) + sum(len(part[0]) for part in kept) > _MOST_BOXES:
            raise InvalidInput(f"more than {_MOST_BOXES} boxes at a resolution of {resolution:g} m: "
                               "ask for a coarser one")
    return WorkspaceCells(*map(np.concatenate, zip(*kept)))


def _verdicts(robot: Robot, low: Array, high: Array, rotation: Array, loads: Array) -> Array:
    """(N,) 1, −1 or 0: inside for all loads, outside for one."""
    boxes = PoseBoxes(robot, Intervals(low, high), rotation)
    verdict, sound = np.zeros(len(low)), have_directions(robot, boxes.middle)   # an exit point in the middle: halved
    boxes, poses = boxes[sound], boxes.middle[sound]
    _, lengths, W = cables_at(robot, poses)
    weight = gravity_wrench(robot, poses)
    inside, outside = np.ones(len(W), dtype=bool), np.zeros(len(W), dtype=bool)
    for load in loads:
        s, tau = best_tensions(W, weight + load, robot.tension_min, robot.tension_max)
        good, bad = s > 0, (s < 0) & ~outside
        inside &= good
        inside[good] &= certainly_inside(boxes[good], load, W[good], tau[good], lengths[good])
        normal = capacity_margins(W[bad], weight[bad], load[None], np.zeros(robot.n_dof),
                                  robot.tension_min, robot.tension_max)[1]
        outside[bad] = certainly_outside(boxes[bad], load, normal)
    verdict[sound] = inside.astype(float) - outside
    return verdict
