"""First-order kinematics: Jacobian, base Jacobian, and forward kinematics from cable lengths."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_array
from ..errors import InvalidInput, NoConvergence
from ..robot import Base, Robot
from ..robot.pose import Pose, rotation_from_vector, rotation_vector_jacobian
from .cables import cable_directions, cable_lengths, cables_at

Pivot = Literal["base", "world"]


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


def base_jacobian(robot: Robot, pose: Pose, pivot: Pivot = "base") -> Array:
    """B_b with l̇ = J t − B_b q̇_b: row i is −uᵢᵀ ∂A_i/∂q_b, q_b = (θ, ρ₁, ρ₂) of each base in file order.

    robot, pose : single or batched
    pivot : "base": θ turns a base about its own center; "world": about the world's origin O₀ (the papers' chain)
    Returns (…, m, 3p) [m/rad, 1, 1]; zero where a cable does not stand on the base.
    Source: Rasheed et al. 2018, eq. (7)–(9), corrected (as printed they count a base's rotation twice).

    >>> import cdprlab as cl
    >>> base_jacobian(cl.load_world("caroca").robot, cl.Pose([0, 0, 1])).shape
    (8, 0)
    """
    if pivot not in ("base", "world"):
        raise InvalidInput(f"pivot must be 'base' or 'world', got {pivot!r}")
    directions = cable_directions(robot, pose)
    columns = np.zeros((*directions.shape[:-1], 3 * len(robot.bases)))
    for i, k in enumerate(robot.base_indices):
        if k >= 0:
            velocities = _exit_velocities(robot.bases[k], robot.exit_points[i], pivot)
            columns[..., i, 3 * k:3 * k + 3] = -directions[..., i, :] @ velocities.T
    return columns


def forward_kinematics(robot: Robot, lengths: ArrayLike, guess: Pose, tolerance: float = 1e-9) -> Pose:
    """The pose whose cable lengths fit best: min ‖l(pose) − l‖², from a guess (Levenberg–Marquardt, analytic J).

    robot : m cables
    lengths : (m,) or (…, m) measured cable lengths [m]
    guess : where to start; one pose, or one per set of lengths
    tolerance : largest residual accepted [m]; ``inf`` returns the least-squares pose whatever is left
    Returns Pose. Motions the lengths say nothing about keep the guess's value (2R3T: the turn about x′).
    Raises NoConvergence, carrying the residuals, if one exceeds ``tolerance``.
    Source: Pott 2018, Cable-Driven Parallel Robots, sec. 4.3.

    >>> import cdprlab as cl
    >>> robot, pose = cl.load_world("caroca").robot, cl.Pose([0.3, 0.2, 1.0], rpy=[0.1, 0.0, -0.2])
    >>> found = forward_kinematics(robot, cl.cable_lengths(robot, pose), cl.Pose([0.2, 0.2, 1.1]))
    >>> np.allclose(found.position, pose.position, atol=1e-9)
    True
    """
    measured = as_array(lengths, "lengths", (robot.n_cables,), "m", batch=True)
    if (measured <= 0).any():
        raise InvalidInput(f"cable lengths must be positive [m], got {float(measured.min()):g}")
    if not tolerance > 0:
        raise InvalidInput(f"tolerance must be positive [m], got {tolerance!r}")
    if guess.dimension != robot.dimension:
        raise InvalidInput(f"a {robot.motion_pattern} robot lives in {robot.dimension} dimensions, "
                           f"the guess has {guess.dimension}")
    try:
        batch = np.broadcast_shapes(measured.shape[:-1], guess.batch_shape)
    except ValueError:
        raise InvalidInput(f"lengths of batch shape {measured.shape[:-1]} and a guess of batch shape "
                           f"{guess.batch_shape} do not fit together") from None
    starts = Pose(np.broadcast_to(guess.position, (*batch, robot.dimension)), matrix=guess.rotation)
    measured = np.broadcast_to(measured, (*batch, robot.n_cables))
    position, rotation = np.empty(starts.position.shape), np.empty(starts.rotation.shape)
    for index in np.ndindex(batch):
        start = Pose.of(starts.position[index], starts.rotation[index])
        found = _fit_pose(robot, measured[index], start, tolerance)
        position[index], rotation[index] = found.position, found.rotation
    return Pose.of(position, rotation)


def cross(a: Array, b: Array) -> Array:
    """a × b over the last axis: (…, 3) in space, (…, 1) (the z component) in the plane.

    >>> cross(np.array([1.0, 0.0]), np.array([0.0, 2.0]))
    array([2.])
    """
    if a.shape[-1] == 2:
        return (a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])[..., None]
    return np.cross(a, b)


def _exit_velocities(base: Base, exit_point: Array, pivot: Pivot) -> Array:
    """(3, d) rows ∂A/∂θ, ∂A/∂ρ₁, ∂A/∂ρ₂ of one exit point."""
    center = base.origin if pivot == "base" else np.zeros_like(base.origin)
    arm = exit_point - center
    velocities = np.zeros((3, exit_point.shape[0]))
    velocities[0, :2] = -arm[1], arm[0]
    velocities[1:] = base.rotation[:, :2].T
    return velocities


def _fit_pose(robot: Robot, lengths: Array, start: Pose, tolerance: float) -> Pose:
    from scipy.optimize import least_squares

    def residuals(x: Array) -> Array:
        return cable_lengths(robot, _moved(robot, start, x)) - lengths

    def slope(x: Array) -> Array:
        pose = _moved(robot, start, x)
        return jacobian(robot, pose) @ _twist_per_step(robot, start, x)

    # The tightest tolerances scipy takes: it then stops where rounding does. Fewer cables than
    # freedoms leave "lm" without a square problem, so those go to the trust region method.
    method = "lm" if robot.n_cables >= robot.n_dof else "trf"
    tight = 4 * np.finfo(float).eps
    result = least_squares(residuals, np.zeros(robot.n_dof), slope, method=method, xtol=tight, ftol=tight, gtol=tight)
    left = residuals(result.x)
    if not np.abs(left).max() <= tolerance:
        worst = int(np.abs(left).argmax())
        raise NoConvergence(f"no pose near the guess has these cable lengths: cable {worst + 1} is off by "
                            f"{left[worst]:.3g} m, allowed {tolerance:g} m; check the lengths, start nearer, or "
                            "pass tolerance=inf for the least-squares pose", left)
    return _moved(robot, start, result.x)


def _moved(robot: Robot, start: Pose, x: Array) -> Pose:
    """The start pose moved by x = [translation (world axes), rotation vector (platform axes)]."""
    position = start.position.copy()
    translations = robot.n_dof - len(robot.pattern.turn_axes)
    position[:translations] += x[:translations]
    return Pose.of(position, start.rotation @ rotation_from_vector(_turn(robot, x)))


def _turn(robot: Robot, x: Array) -> Array:
    axes = list(robot.pattern.turn_axes)
    turn = np.zeros(1 if robot.dimension == 2 else 3)
    turn[axes] = x[robot.n_dof - len(axes):]
    return turn


def _twist_per_step(robot: Robot, start: Pose, x: Array) -> Array:
    """(n, n) dt/dx: translations are the twist's own; ω = R exp(r) J_r(r) ṙ for a turn r in platform axes."""
    change = np.eye(robot.n_dof)
    axes = list(robot.pattern.turn_axes)
    if robot.dimension == 2 or not axes:
        return change
    turn = _turn(robot, x)
    rate = rotation_vector_jacobian(-turn)  # J_r(r) = J_l(−r): rate in platform axes
    if robot.motion_pattern == "3R3T":
        rate = start.rotation @ rotation_from_vector(turn) @ rate
    change[3:, 3:] = rate[np.ix_(axes, axes)]
    return change
