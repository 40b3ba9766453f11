"""First-order kinematics: Jacobian, base Jacobian, and forward kinematics from cable lengths."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Annotated, Any, Literal, overload

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_array, checked, common_batch
from ..errors import InvalidInput, NoConvergence
from ..robot import Robot
from ..robot.pose import Pose, cross, rotation_vector_jacobian
from .cables import Cables, cable_directions, cables_at, check_dimension, tangent_points
from .optimization import least_squares

Pivot = Literal["base", "world"]

_STARTS = 20
"""From where other assemblies are sought."""

_NEWTON = 10
"""Steps at most; from a millimeter away two are enough."""

_ARRIVED = 1e-7
"""[m, rad] of a step whose error is then its square."""

_DISTINCT = 1e-5
"""[m], and of rotation matrices: solutions closer than this are one; a double root is found to about 1e-7."""


@checked
def jacobian(robot: Robot, pose: Pose) -> Array:
    """J with l̇ = J t: row i is −[u_i; (R b_i) × u_i]ᵀ in the motion pattern's rows.

    robot, pose : single or batched
    Returns (…, m, n); t = [v; ω] at P in world axes [m/s, rad/s].
    Source: Okoli 2016, eq. (2.15) and (2.22).

    >>> import cdprlab as cl
    >>> jacobian(cl.load_world("caroca").robot, cl.Pose([0, 0, 1])).shape
    (8, 6)
    """
    return -np.swapaxes(cables_at(robot, pose).wrench_matrix, -1, -2)


@checked
def base_jacobian(robot: Robot, pose: Pose, pivot: Pivot = "base") -> Array:
    """B_b with l̇ = J t − B_b q̇_b: row i is −uᵢᵀ ∂A_i/∂q_b, q_b = (θ, ρ₁, ρ₂) of each base in file order.

    On a pulley the tangent point T_i, as a point of the base, takes the place of the exit point A_i.

    robot, pose : single or batched
    pivot : "base": θ turns a base about its own center; "world": about the world's origin O₀
        (the papers' chain)
    Returns (…, m, 3p) [m/rad, 1, 1]; zero where a cable does not stand on the base.
    Source: Rasheed et al. 2018, eq. (7)–(9), corrected (as printed they count a base's rotation
    twice).

    >>> import cdprlab as cl
    >>> base_jacobian(cl.load_world("caroca").robot, cl.Pose([0, 0, 1])).shape
    (8, 0)
    """
    u = cable_directions(robot, pose)
    starts = tangent_points(robot, pose)
    columns = [np.zeros((*u.shape[:-1], 0))]
    for k, base in enumerate(robot.bases):
        arms = starts - (base.origin if pivot == "base" else 0.0)
        moves = np.concatenate([cross(arms[..., :2], u[..., :2]), u @ base.rotation[:, :2]], axis=-1)
        columns.append(np.where(np.equal(robot.base_indices, k)[:, None], -moves, 0.0))
    return np.concatenate(columns, axis=-1)


@overload
def forward_kinematics(robot: Robot, lengths: ArrayLike, guess: Pose, tolerance: float = ..., *,
                       all_solutions: Literal[False] = ...) -> Pose: ...


@overload
def forward_kinematics(robot: Robot, lengths: ArrayLike, guess: Pose, tolerance: float = ..., *,
                       all_solutions: Literal[True]) -> list[Pose]: ...


@checked
def forward_kinematics(robot: Robot, lengths: ArrayLike, guess: Pose,
                       tolerance: Annotated[float, "[m] > 0 or inf"] = 1e-9, *,
                       all_solutions: bool = False) -> Pose | list[Pose]:
    """The pose whose cable lengths fit best: min ‖l(pose) − l‖², from a guess (Levenberg–Marquardt, analytic J).

    robot : m cables
    lengths : (m,) or (…, m) measured cable lengths [m]
    guess : where to start; one pose, or one per set of lengths
    tolerance : largest residual accepted [m]; ``inf`` returns the least-squares pose whatever
        is left
    all_solutions : list the distinct poses found from the guess, and from 20 seeded starts within
        1 m and 1 rad of it: other assemblies; one guess and one set of lengths only
    Returns Pose, or the list of poses, that from the guess first. Motions the lengths say
    nothing about keep the guess's value (2R3T: the turn about x′).
    Raises NoConvergence, carrying the residuals, if one exceeds ``tolerance``.
    Source: Pott 2018, Cable-Driven Parallel Robots, sec. 4.3.

    >>> import cdprlab as cl
    >>> robot, pose = cl.load_world("caroca").robot, cl.Pose([0.3, 0.2, 1.0], rpy=[0.1, 0.0, -0.2])
    >>> found = forward_kinematics(robot, cl.cable_lengths(robot, pose), cl.Pose([0.2, 0.2, 1.1]))
    >>> np.allclose(found.position, pose.position, atol=1e-9)
    True
    """
    measured = as_array(lengths, "lengths", (robot.n_cables,), "m", batch=True, positive=True)
    check_dimension(robot, guess)
    batch = common_batch(lengths=measured.shape[:-1], guess=guess.batch_shape)
    if all_solutions:
        if batch:
            raise InvalidInput(f"all_solutions takes one guess and one set of lengths, got a batch of shape {batch}")
        return _assemblies(robot, measured, guess, tolerance)
    position = guess.position + np.zeros((*batch, 1))
    rotation = guess.rotation + np.zeros((*batch, 1, 1))
    measured = measured + np.zeros((*batch, 1))
    for index in np.ndindex(batch):
        found = _fit_pose(robot, measured[index], Pose.of(position[index], rotation[index]), tolerance)
        position[index], rotation[index] = found.position, found.rotation
    return Pose.of(position, rotation)


def nearby_pose(robot: Robot, lengths: Array, last: Pose) -> Pose:
    """Forward kinematics as a control loop wants it: Newton's steps min ‖l + J x − lengths‖ from a pose near by.

    robot, lengths : (m,) [m]; last : single pose, such as that of a moment ago

    >>> import cdprlab as cl
    >>> robot, pose = cl.load_world("caroca").robot, cl.Pose([0.3, 0.2, 1.0])
    >>> nearby_pose(robot, cl.cable_lengths(robot, pose), cl.Pose([0.31, 0.2, 1.0])).position.round(9)
    array([0.3, 0.2, 1. ])
    """
    pose = last
    for _ in range(_NEWTON):
        _, there, W = cables_at(robot, pose)
        step: Any = np.linalg.lstsq(-W.T, lengths - there)[0]
        pose = moved(robot, pose, step)
        if np.abs(step).max() < _ARRIVED:
            break
    return pose


def moved(robot: Robot, start: Pose, x: Array) -> Pose:
    """p = p₀ + S_v x and R = exp([S_ω x]×) R₀: away from a pose by x (…, n) in the motion pattern's rows there."""
    return start.displaced(x @ robot.pattern.basis(start.rotation).T)


def moved_rates(robot: Robot, start: Pose, x: Array) -> Array:
    """∂t/∂ẋ (n, n) of the twist t at `moved`, in the rows there: ω = J_l(r) ṙ of the turn r = S_ω x, in the plane ṙ."""
    S, d = robot.pattern.basis(start.rotation), robot.dimension
    rates, rows = np.eye(len(S)), S
    rates[d:, d:] = rotation_vector_jacobian(S[d:] @ x)
    if robot.motion_pattern == "2R3T":   # no other pattern's rows turn along
        rows = robot.pattern.basis(moved(robot, start, x).rotation)
    return rows.T @ rates @ S


def seen_from(robot: Robot, start: Pose) -> Callable[[Array], tuple[Pose, Cables]]:
    """x → the pose at `moved`, and its cables; looked at once, however many ask of the same x."""
    @cache
    def seen(x: bytes) -> tuple[Pose, Cables]:
        pose = moved(robot, start, np.frombuffer(x))
        return pose, cables_at(robot, pose)

    return lambda x: seen(x.tobytes())


def _assemblies(robot: Robot, lengths: Array, guess: Pose, tolerance: float) -> list[Pose]:
    """Distinct poses with these lengths; raises as the fit from the guess does where there are none."""
    rng, turns = np.random.default_rng(0), len(robot.pattern.turn_axes)

    def away(size: int) -> Array:
        """Any way, at most 1 long."""
        way = rng.normal(size=size)
        return way * (rng.uniform() / max(float(np.linalg.norm(way)), 1e-300))

    found: list[Pose] = []
    failures: list[NoConvergence] = []
    others = (moved(robot, guess, np.append(away(robot.n_dof - turns), away(turns)))
              for _ in range(_STARTS))
    for start in (guess, *others):
        try:
            pose = _fit_pose(robot, lengths, start, tolerance)
        except NoConvergence as error:
            failures.append(error)
            continue
        if all(np.abs(pose.position - other.position).max() + np.abs(pose.rotation - other.rotation).max() > _DISTINCT
               for other in found):
            found.append(pose)
    if not found:
        raise failures[0]
    return found


def _fit_pose(robot: Robot, lengths: Array, start: Pose, tolerance: float) -> Pose:
    near = seen_from(robot, start)

    def residuals(x: Array) -> Array:
        return near(x)[1].lengths - lengths

    def slopes(x: Array) -> Array:
        return -near(x)[1].wrench_matrix.T @ moved_rates(robot, start, x)

    # Fewer cables than freedoms leave "lm" without a square problem.
    method = "lm" if robot.n_cables >= robot.n_dof else "trf"
    try:
        x = least_squares(residuals, np.zeros(robot.n_dof), slopes, method)
    except InvalidInput as error:
        if not robot.pulleys.size:
            raise
        raise NoConvergence(f"no pose near the guess has these cable lengths: on the way to one {error}; start nearer",
                            np.full(robot.n_cables, np.nan)) from None
    left = residuals(x)
    if not np.abs(left).max() <= tolerance:
        worst = np.abs(left).argmax()
        raise NoConvergence(f"no pose near the guess has these cable lengths: cable {worst + 1} is off by "
                            f"{left[worst]:.3g} m, allowed {tolerance:g} m; check the lengths, start nearer, or "
                            "pass tolerance=inf for the least-squares pose", left)
    return near(x)[0]
