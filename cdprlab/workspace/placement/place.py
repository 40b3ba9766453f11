"""Placing bases: the present poses, a proof that none serve, a search, and the reason why it found none."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ...arrays import as_array, as_count, checked
from ...errors import InvalidInput, NoPlacement, quoted
from ...mechanics.cables import check_dimension
from ...robot import Robot
from ...robot.pose import Pose
from .program import Duty
from .proof import why_impossible
from .search import Search, why_not_found


@checked
def place_bases(robot: Robot, poses: Pose, wrenches: ArrayLike, *, tipping: bool = True,
                margin: float = 0.0,
                evaluations: int = 300) -> Robot:
    """Base poses for which tensions within the limits balance every wrench at every pose and leave every base standing.

    It maximizes the worst margin s over all poses and wrenches, one linear program a placement:
    max s with W τ + w_e = 0, τ_min + s h ≤ τ ≤ τ_max − s h and moments ≤ −s M about every
    footprint edge; h is half the range of each cable, up to a hundred times the smallest, M
    what each base's own weight holds against tipping, the mean over its edges.

    A pattern search over the directions in which the bases can drive (speed limit above 0),
    from their present poses and from layouts around the wanted ones. Bases keep clear of each
    other, and masts of the platform. A placement found does serve. That there is none is proven
    only where it holds for each base placed freely in its directions, for one pose and wrench
    at a time ("no base poses can serve"); otherwise the search ends ("none found").

    robot : with mobile bases; returned as it is where its bases serve already
    poses : single or a batch (N,) of platform poses
    wrenches : (n,), (k, n) or (N, k, n) external wrenches w_e, gravity included: each of the k
        at each pose [N, N m]
    tipping : keep `tipping_moments` ≤ 0, on by default because a base that falls serves no
        pose; False asks of the cables alone, as for bases on stabilizers, and a base without a
        footprint is never asked. The tensions exist: a distribution that does not look at the
        bases may choose others
    margin : smallest s asked for, 0 to 1
    evaluations : placements tried at most
    Returns the robot with its bases moved.
    Raises NoPlacement with the pose and wrench, and what is short there: tension limits,
    directions that are held, standing; InvalidInput for a robot without bases that can drive.
    Source: the task is that of Pedemonte et al. 2020, abstract, with both equilibria of its
    section 4 (eq. (17)–(24)); search and proof are this project's.

    >>> import cdprlab as cl
    >>> world = cl.load_world("planar_mcdpr")
    >>> far = cl.Pose([[2.6, 1.2], [3.2, 1.4]])
    >>> weight = cl.gravity_wrench(world.robot, world.pose)
    >>> moved = place_bases(world.robot, far, weight)
    >>> bool(cl.distribute_tensions(cl.wrench_matrix(moved, far), weight, 1, 100).feasible.all())
    True
    """
    if not 0 <= margin <= 1:
        raise InvalidInput(f"margin must be between 0 and 1, got {quoted(margin)}")
    as_count(evaluations, "evaluations")
    duty = _checked(robot, poses, wrenches, tipping)
    search = Search(robot, duty, evaluations)
    if search.at(search.here)[0] >= margin:
        return robot
    proven = why_impossible(robot, duty)
    if proven:
        raise NoPlacement(f"no base poses can serve every pose: {proven}", robot)
    value, x = search.best(margin)
    placed = search.moved(x)
    if value < margin:
        raise NoPlacement(f"no base poses were found that serve every pose, none among {search.tried} placements tried "
                          f"(a search, no proof): {why_not_found(placed, duty, value, margin)}", placed)
    return placed


def _checked(robot: Robot, poses: Pose, wrenches: ArrayLike, tipping: bool) -> Duty:
    if not any(base.speed_max.any() for base in robot.bases):
        raise InvalidInput("this robot has no base that can drive: every speed limit is 0"
                           if robot.bases
                           else "this robot has no bases")
    check_dimension(robot, poses)
    d, n = robot.dimension, robot.n_dof
    many = Pose.of(poses.position.reshape(-1, d), poses.rotation.reshape(-1, d, d))
    given, count = as_array(wrenches, "wrenches", (n,), "N, N m", batch=True), len(many)
    loads = given.reshape(1, -1, n) if given.ndim <= 2 else given
    if loads.ndim != 3 or loads.shape[0] not in (1, count) or not loads.size or not count:
        raise InvalidInput(f"wrenches must be ({n},), (k, {n}) or ({count}, k, {n}) for {count} poses, "
                           f"got shape {given.shape}")
    return Duty(many, np.broadcast_to(loads, (count, *loads.shape[1:])), tipping)
