"""Available wrench set: what the cables can exert on the platform, with bases fastened or standing freely."""

import numpy as np

from ..arrays import Array, as_number, checked
from ..mechanics.cables import cable_directions
from ..mechanics.statics import tipping_rows, wrench_matrix
from ..robot import Robot
from ..robot.pose import Pose
from .polytope import Polytope
from .twist import one_pose


@checked
def available_wrench_set(robot: Robot, pose: Pose, tipping: bool = False, friction: float | None = None) -> Polytope:
    """AWS = {W τ : τ_min ≤ τ ≤ τ_max}; with tipping only tensions under which every base keeps all edges down.

    What the cables exert, the weight not subtracted: the wrench one can add while holding the
    platform is ``axis_section(origin=-gravity_wrench(robot, pose))``. Where W has no full row
    rank the set is flat, and says so.

    robot : m cables
    pose : one pose
    tipping : keep `tipping_moments` ≤ 0 for every base with a footprint
    friction : between wheels and floor; given, no base slides either (`sliding_rows`)
    Returns Polytope of wrenches [f; m] [N, N m].
    Raises InvalidInput for a batch of poses.
    Source: Bouchard et al. 2010; Gouttefarde and Krut 2010; Pedemonte et al. 2020, eq. (24).

    >>> import cdprlab as cl
    >>> robot = cl.load_world("caroca").robot
    >>> bool(available_wrench_set(robot, cl.Pose([0, 0, 1])).contains([0, 0, 9.81 * 150, 0, 0, 0]))
    True
    """
    W = wrench_matrix(robot, one_pose(pose))
    box = Polytope.from_box(W, robot.tension_min, robot.tension_max)
    standing = [(rows.matrix, -rows.offset) for rows in tipping_rows(robot, pose).values()] if tipping else []
    if friction is not None:
        standing.append(sliding_rows(robot, pose, friction))
    rows, limits = map(np.concatenate, zip((box.rows, box.limits), *standing))
    return Polytope.from_image(W, rows, limits) if len(limits) > len(box.limits) else box


def sliding_rows(robot: Robot, pose: Pose, friction: float) -> tuple[Array, Array]:
    """Rows (A, b) with A τ ≤ b while friction holds every base that carries cables: |F_h| ≤ μ N as a whole.

    The circle of horizontal forces is replaced by a regular octagon inside it, which keeps at
    least 92 % of every direction (in the plane there are two directions, exactly). A base
    turning on the spot is not looked at.
    Source: named as open by Pedemonte et al. 2020, sec. 5.

    robot : m cables; pose : one pose
    friction : μ between wheels and floor
    Returns (f, m) and (f,) [N].

    >>> import cdprlab as cl
    >>> sliding_rows(cl.load_world("caroca").robot, cl.Pose([0, 0, 1]), 0.5)[0].shape
    (0, 8)
    """
    mu = as_number(friction, "friction", minimum=0.0)
    pulls = -cable_directions(robot, one_pose(pose))      # on the bases
    angles = np.pi / 4 * np.arange(8)
    ways, share = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1), float(np.cos(np.pi / 8))
    if robot.dimension == 2:
        ways, share = np.array([[1.0, 0.0], [-1.0, 0.0]]), 1.0
    carried = np.array(robot.base_indices) == np.arange(len(robot.bases))[:, None]
    # F_h·e ≤ share μ N with N = m g − (pull upwards)
    rows = carried[:, None] * (pulls @ ways.T + share * mu * pulls[:, -1:]).T
    masses = np.array([base.mass for base in robot.bases])
    return rows.reshape(-1, robot.n_cables), np.repeat(share * mu * robot.gravity * masses, len(ways))
