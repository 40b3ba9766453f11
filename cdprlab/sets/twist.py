"""Available twist set: how fast the platform can move at a pose, with the bases standing or driving."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from math import comb

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_array, checked
from ..errors import InvalidInput, quoted
from ..mechanics.kinematics import Pivot, base_jacobian, jacobian
from ..robot import Robot
from ..robot.pose import Pose
from .polytope import Polytope
from .zonotope import MOST_COMBINATIONS, hyperplane_shifting


@checked
def available_twist_set(robot: Robot, pose: Pose, moving: str | Sequence[str] = "all",
                        pivot: Pivot = "base") -> Polytope:
    """ATS = {t : |J t − B_b q̇_b| ≤ l̇_max for some |q̇_b| ≤ q̇_b,max}, exactly; fixed bases: {t : |J t| ≤ l̇_max}.

    robot : m cables, p bases
    pose : one pose
    moving : bases that may drive: "all", "none", a name or several names
    pivot : what θ turns a base about: "base" its own center, "world" the origin O₀; the two
        sets differ
    Returns Polytope of twists [v; ω] [m/s, rad/s].
    Raises InvalidInput for unknown bases or a batch of poses.
    Source: Lessanibahri et al. 2018; Rasheed et al. 2018, sec. 3, whose construction
    `course.submatrix_twist_set` is.

    >>> import cdprlab as cl
    >>> robot = cl.load_world("caroca").robot
    >>> float(available_twist_set(robot, cl.Pose([0, 0, 1])).axis_section()[2, 1].round(2))   # 10 m/s of cable
    16.97
    """
    columns = moving_columns(robot, moving)
    J, B = jacobian(robot, one_pose(pose)), base_jacobian(robot, pose, pivot)[:, columns]
    return twist_set(J, B, robot.speed_max, robot.base_speed_max[columns])


def twist_set(J: ArrayLike, B: ArrayLike, speed_max: ArrayLike, base_speed_max: ArrayLike) -> Polytope:
    """{t : |J t − B q̇| ≤ l̇_max, |q̇| ≤ q̇_max} for any matrices, bases that share an actuator included.

    J : (m, n); B : (m, a); speed_max : (m,) may be inf; base_speed_max : (a,)
    """
    j, b, cable, base = checked_speeds(J, B, speed_max, base_speed_max)
    driving = (base > 0) & b.any(axis=0)
    b, base = b[:, driving], base[driving]
    (m, n), a = j.shape, len(base)
    one_way = np.block([[j, -b], [np.zeros((a, n)), np.eye(a)]])
    known = a and comb(m + a, m - 1) <= MOST_COMBINATIONS
    return Polytope(np.eye(n, n + a), np.concatenate([one_way, -one_way]), np.tile(np.append(cable, base), 2),
                    np.zeros(n),
                    partial(_outer_rows, j, b, cable, base) if known else None)   # pickles, as no lambda does


def one_pose(pose: Pose) -> Pose:
    """The pose itself; raises InvalidInput for a batch."""
    if pose.batch_shape:
        raise InvalidInput(f"a set belongs to one pose, got a batch of shape {pose.batch_shape}; ask pose by pose")
    return pose


def moving_columns(robot: Robot, moving: str | Sequence[str]) -> list[int]:
    """Columns of the bases that may drive; raises InvalidInput for a name that is none."""
    names = [base.name for base in robot.bases]
    chosen = {"all": names, "none": []}.get(moving, [moving]) if isinstance(moving, str) else list(moving)
    for name in chosen:
        if name not in names:
            raise InvalidInput(f"moving must be 'all', 'none' or names of bases, got {quoted(name)}; "
                               f"{'there are ' + ', '.join(names) if names else 'this robot has no bases'}")
    return [3 * k + i for k, name in enumerate(names) if name in chosen for i in range(3)]


def checked_speeds(J: ArrayLike, B: ArrayLike, speed_max: ArrayLike,
                   base_speed_max: ArrayLike) -> tuple[Array, Array, Array, Array]:
    """The arguments of `twist_set` as arrays; raises InvalidInput where they do not fit or a limit is negative."""
    j = as_array(J, "J", ("m", "n"))
    b = as_array(B, "B", (j.shape[0], "a"))
    cable = as_array(speed_max, "speed_max", (j.shape[0],), "m/s", limit=np.inf, minimum=0.0)
    return j, b, cable, as_array(base_speed_max, "base_speed_max", (b.shape[1],), minimum=0.0)


def _outer_rows(J: Array, B: Array, cable: Array, base: Array) -> tuple[Array, Array]:
    """J t lies in the zonotope of all l̇ + B q̇: the zonotope's planes, read as rows over t.

    A plane of the zonotope is orthogonal to all but |F| + 1 cables' axes and to |F| columns of
    B.
    """
    limited = np.isfinite(cable)
    generators = np.concatenate([np.diag(cable[limited]), (B * base)[limited]], axis=1)
    normals, offsets = hyperplane_shifting(generators)
    return normals @ J[limited], offsets
