"""Available twist set: how fast the platform can move at a pose, with the bases standing or driving."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_array, frozen
from ..errors import InvalidInput
from ..mechanics.kinematics import Pivot, base_jacobian, jacobian
from ..robot import Robot
from ..robot.pose import Pose
from .polytope import Image, Polytope
from .subspace import null_space
from .zonotope import MOST_COMBINATIONS, hyperplane_shifting, n_choices


def available_twist_set(robot: Robot, pose: Pose, moving: str | Sequence[str] = "all",
                        pivot: Pivot = "base") -> Polytope:
    """ATS = {t : |J t − B_b q̇_b| ≤ l̇_max for some |q̇_b| ≤ q̇_b,max}, exactly; fixed bases: {t : |J t| ≤ l̇_max}.

    robot : m cables, p bases
    pose : one pose
    moving : bases that may drive: "all", "none", a name or several names
    pivot : what θ turns a base about: "base" its own center, "world" the origin O₀; the two sets differ
    Returns Polytope of twists [v; ω] [m/s, rad/s].
    Raises InvalidInput for unknown bases or a batch of poses.
    Source: Lessanibahri et al. 2018; Rasheed et al. 2018, sec. 3, whose construction is `submatrix_twist_set`.

    >>> import cdprlab as cl
    >>> robot = cl.load_world("caroca").robot
    >>> float(available_twist_set(robot, cl.Pose([0, 0, 1])).axis_section()[2, 1].round(2))   # 10 m/s of cable
    16.97
    """
    columns = moving_columns(robot, moving)
    J, B = jacobian(robot, one_pose(pose)), base_jacobian(robot, pose, pivot)[:, columns]
    return twist_set(J, B, robot.speed_max, base_speeds(robot)[columns])


def twist_set(J: ArrayLike, B: ArrayLike, speed_max: ArrayLike, base_speed_max: ArrayLike) -> Polytope:
    """{t : |J t − B q̇| ≤ l̇_max, |q̇| ≤ q̇_max} for any matrices, bases that share an actuator included.

    J : (m, n); B : (m, a); speed_max : (m,) may be inf; base_speed_max : (a,)
    """
    j, b, cable, base = _checked(J, B, speed_max, base_speed_max)
    driving = (base > 0) & b.any(axis=0)
    b, base = b[:, driving], base[driving]
    (m, n), a = j.shape, len(base)
    if not a:
        return Polytope.from_rows(np.concatenate([j, -j]), np.concatenate([cable, cable]))
    rows = np.block([[j, -b], [-j, b], [np.zeros((a, n)), np.eye(a)], [np.zeros((a, n)), -np.eye(a)]])
    known = n_choices(m, m + a) <= MOST_COMBINATIONS
    return Image(frozen(np.eye(n, n + a)), frozen(rows), frozen(np.concatenate([cable, cable, base, base])),
                 frozen(np.zeros(n)), (lambda: _outer_rows(j, b, cable, base)) if known else None)


class SubmatrixTwistSet(NamedTuple):
    """The papers' construction.

    set : Polytope
    exact : whether it is certain to equal `twist_set`
    reason : why it is not; '' when exact
    """

    set: Polytope
    exact: bool
    reason: str


def submatrix_twist_set(J: ArrayLike, B: ArrayLike, speed_max: ArrayLike,
                        base_speed_max: ArrayLike) -> SubmatrixTwistSet:
    """What all square sub-matrices of J allow together: ∩ₖ {Jₖ⁻¹ (l̇ₖ + Bₖ q̇)}, singular ones left out.

    Always contains the available twist set, and equals it when every base moves by itself (its block of B is its
    cables' rows of J times the base's own Jacobian) and J has full column rank.

    J : (m, n); B : (m, a); speed_max : (m,); base_speed_max : (a,)
    Raises InvalidInput where no sub-matrix is regular.
    Source: Rasheed et al. 2018, eq. (16)–(17).

    >>> found = submatrix_twist_set([[1], [1]], [[1], [-1]], [2, 2], [0.8])
    >>> found.exact, float(found.set.support([1.0]))
    (False, 2.8)
    """
    j, b, cable, base = _checked(J, B, speed_max, base_speed_max)
    m, n = j.shape
    rows, limits = [], []
    for k in combinations(range(m), n):
        square, chosen = j[list(k)], list(k)
        if not np.isfinite(cable[chosen]).all() or np.linalg.cond(square) > 1e10:
            continue
        generators = np.linalg.solve(square, np.concatenate([np.diag(cable[chosen]), b[chosen] * base], axis=1))
        normals, offsets = hyperplane_shifting(np.zeros(n), generators)
        rows.append(normals)
        limits.append(offsets)
    if not rows:
        raise InvalidInput(f"no {n} of the {m} cables determine the twist: J has no regular sub-matrix here, so the "
                           "construction says nothing; use available_twist_set")
    reason = _why_not_exact(j, b * base)
    return SubmatrixTwistSet(Polytope.from_rows(np.concatenate(rows), np.concatenate(limits)), not reason, reason)


def one_pose(pose: Pose) -> Pose:
    """The pose itself; raises InvalidInput for a batch."""
    if pose.batch_shape:
        raise InvalidInput(f"a set belongs to one pose, got a batch of shape {pose.batch_shape}; ask pose by pose")
    return pose


def base_speeds(robot: Robot) -> Array:
    """(3p,) limits of (θ̇, ρ̇₁, ρ̇₂), base after base [rad/s, m/s, m/s]."""
    return np.concatenate([np.zeros(0), *(base.speed_max for base in robot.bases)])


def moving_columns(robot: Robot, moving: str | Sequence[str]) -> list[int]:
    """Columns of the bases that may drive; raises InvalidInput for a name that is none."""
    names = [base.name for base in robot.bases]
    chosen = {"all": names, "none": []}.get(moving, [moving]) if isinstance(moving, str) else list(moving)
    for name in chosen:
        if name not in names:
            raise InvalidInput(f"moving must be 'all', 'none' or names of bases, got {name!r}; "
                               f"{'there are ' + ', '.join(names) if names else 'this robot has no bases'}")
    return [3 * k + i for k, name in enumerate(names) if name in chosen for i in range(3)]


def _checked(J: ArrayLike, B: ArrayLike, speed_max: ArrayLike, base_speed_max: ArrayLike) -> tuple[Array, ...]:
    j = as_array(J, "J", ("m", "n"))
    b = as_array(B, "B", (j.shape[0], "a"))
    cable, base = np.asarray(speed_max, dtype=float), as_array(base_speed_max, "base_speed_max", (b.shape[1],))
    as_array(np.where(np.isposinf(cable), 0.0, cable), "speed_max", (j.shape[0],), "m/s")
    if (cable < 0).any() or (base < 0).any():
        raise InvalidInput(f"speed limits must not be negative, got {cable.tolist()} and {base.tolist()}")
    return j, b, cable, base


def _outer_rows(J: Array, B: Array, cable: Array, base: Array) -> tuple[Array, Array]:
    """J t lies in the zonotope of all l̇ + B q̇: the zonotope's planes, read as rows over t.

    A plane of the zonotope is orthogonal to all but |F| + 1 cables' axes and to |F| columns of B.
    """
    limited = np.isfinite(cable)
    generators = np.concatenate([np.diag(cable[limited]), (B * base)[limited]], axis=1)
    normals, offsets = hyperplane_shifting(np.zeros(len(generators)), generators)
    return normals @ J[limited], offsets


def _why_not_exact(J: Array, B: Array) -> str:
    if null_space(J).shape[1]:
        return "J has no full column rank"
    for rows, columns in _blocks(B):
        part, moves = J[rows], B[np.ix_(rows, columns)]
        left = moves - part @ np.linalg.lstsq(part, moves, rcond=None)[0]
        if np.abs(left).max() > 1e-9 * np.abs(moves).max():
            return (f"cables {', '.join(str(i + 1) for i in rows)} share actuators that do not move their exits like "
                    "one base")
    return ""


def _blocks(B: Array) -> list[tuple[list[int], list[int]]]:
    """Cables and columns of B that have to do with each other."""
    blocks: list[tuple[set[int], set[int]]] = []
    for column in range(B.shape[1]):
        rows = set(np.flatnonzero(B[:, column]).tolist())
        if rows:
            merged = [block for block in blocks if block[0] & rows]
            blocks = [block for block in blocks if not block[0] & rows]
            blocks.append((rows.union(*(block[0] for block in merged)),
                           {column}.union(*(block[1] for block in merged))))
    return [(sorted(rows), sorted(columns)) for rows, columns in blocks]
