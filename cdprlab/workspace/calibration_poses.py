"""At which poses to measure a robot: those that tell most about where its points are."""

import numpy as np

from ..arrays import as_count, as_seed, checked
from ..errors import InvalidInput
from ..mechanics.calibration import length_slopes
from ..mechanics.kinematics import moved
from ..robot.pose import Pose
from ..world import World
from .sweep import workspace
from .tensions import TippingSafe, WrenchFeasible

TURN = 0.3
"""[rad] the largest turn about each axis that is tried; chosen."""

_TRIED = 20_000


@checked
def calibration_poses(world: World, count: int, seed: int = 0) -> Pose:
    """Poses that tell most: greedily the largest det Σ JᵀJ (D-optimal), J the slopes of lengths over what is unknown.

    Drawn between the exit points and the start, turned by up to 0.3 rad about each axis; those
    are left out where no tensions within the limits hold the weight, or a base tips.

    world : robot as believed, its bases where they stand
    count : how many
    seed : of the draw
    Returns Pose of batch (count,).
    Raises InvalidInput where too few poses are held.
    Source: Fedorov 1972, Theory of Optimal Experiments.

    >>> import cdprlab as cl
    >>> calibration_poses(cl.load_world("planar_rigid"), 10).batch_shape
    (10,)
    """
    as_count(count, "count", maximum=1000)
    robot, rng, start = world.robot, np.random.default_rng(as_seed(seed)), world.pose
    criteria = [WrenchFeasible(), *[TippingSafe()] * any(base.footprint.size for base in robot.bases)]
    places = np.vstack([robot.exit_points, start.position])
    straight = robot.n_dof - len(robot.pattern.turn_axes)
    reach = np.full((2, robot.n_dof), [[-TURN], [TURN]])
    reach[:, :straight] = ([places.min(axis=0), places.max(axis=0)] - start.position)[:, :straight]
    found: list[Pose] = []
    tried = 0
    while len(found) < 5 * count and tried < _TRIED:
        poses = moved(robot, start, rng.uniform(reach[0], reach[1], (5 * count, robot.n_dof)))
        tried += len(poses)
        for criterion in criteria:   # one after the other: the second takes long
            poses = poses[workspace(robot, poses, criterion, margin=False).inside]
        found += list(poses)
    if len(found) < count:
        raise InvalidInput(f"{count} calibration poses were asked for, but of {tried} poses between the exit points "
                           f"only {len(found)} are held within the tension limits")
    held = Pose.of(np.array([pose.position for pose in found]), np.array([pose.rotation for pose in found]))
    m = robot.n_cables
    slopes = np.einsum("ciik->cik", length_slopes(robot, held).reshape(len(found), m, m, -1))
    # Of what no pose tells, a little must be known, or every determinant is zero.
    spread = np.tile(1e6 * np.eye(slopes.shape[-1]), (m, 1, 1))
    chosen: list[int] = []
    for _ in range(count):
        told = np.einsum("cik,ikl,cil->ci", slopes, spread, slopes)
        gain = np.log1p(told).sum(axis=1)
        gain[chosen] = -np.inf
        best = int(gain.argmax())
        chosen.append(best)
        new = np.einsum("ikl,il->ik", spread, slopes[best])
        spread -= new[:, :, None] * new[:, None] / (1 + told[best])[:, None, None]
    return held[chosen]
