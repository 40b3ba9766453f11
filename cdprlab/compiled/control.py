"""What a controller asks for a thousand times a second: how far off the platform is, and what it takes to move it."""

import numpy as np

from ..arrays import Array
from ..robot.pose import turn_about_axes, turn_coefficients
from .jit import compiled, compiled_for
from .linear_algebra import cross

_log = compiled(turn_about_axes)
_coefficients = compiled(turn_coefficients)


@compiled
def put_error(p: Array, R: Array, p_d: Array, R_d: Array, error: Array) -> None:
    """e = [p_d − p; log(R_d Rᵀ)] of one pose, written into ``error``."""
    d = p.size
    turn = np.zeros((d, d))
    for i in range(d):
        error[i] = p_d[i] - p[i]
        for j in range(d):
            for k in range(d):
                turn[i, j] += R_d[i, k] * R[j, k]
    if d == 2:
        error[2] = np.arctan2(turn[1, 0], turn[0, 0])
    else:
        error[3], error[4], error[5] = _log(turn)


@compiled_for(2, 3, 2, 3)
def pose_errors(positions: Array, rotations: Array, wanted_positions: Array, wanted_rotations: Array) -> Array:
    """e (k, 3 planar or 6 spatial) of k poses, in world axes.

    positions, wanted_positions : p, p_d (k, d) [m]; rotations, wanted_rotations : R, R_d
        (k, d, d)
    """
    count, d = positions.shape
    errors = np.empty((count, 3 * (d - 1)))
    for k in range(count):
        put_error(positions[k], rotations[k], wanted_positions[k],
                  wanted_rotations[k], errors[k])
    return errors


@compiled_for(0, 2, 1, 0, 2, 1)
def mass_and_bias(mass: float, inertia: Array, center: Array, gravity: float, R: Array,
                  t: Array) -> tuple[Array, Array]:
    """M (n, n) and h (n,) of W τ = M a + h: Newton and Euler, moments taken at P, n = 3 planar or 6 spatial.

    inertia : (1, 1) or (3, 3) about the center of mass; center : (d,) of mass; both in platform
        axes
    R : (d, d); t = [v; ω] : (n,) twist of P in world axes
    """
    d, n = center.size, t.size
    # The plane is the space of which the rows of x, y and the turn about z are kept.
    r, w, L, M, h = np.zeros(3), np.zeros(3), np.zeros(3), np.zeros((6, 6)), np.zeros(6)
    for i in range(n - d):
        w[3 + d - n + i] = t[d + i]
    for i in range(d):
        for j in range(d):
            r[i] += R[i, j] * center[j]
    # R I Rᵀ, the inertia in world axes
    if d == 2:
        M[5, 5] = inertia[0, 0]
    else:
        for i in range(3):
            for j in range(3):
                for a in range(3):
                    for b in range(3):
                        M[3 + i, 3 + j] += R[i, a] * inertia[a, b] * R[j, b]
    # L = R I Rᵀ ω, f = m (ω × (ω × r) + g e_up) with r = R c
    spin = cross(w, cross(w, r))
    for i in range(3):
        h[i] = mass * spin[i]
        for j in range(3):
            L[i] += M[3 + i, 3 + j] * w[j]
    h[d - 1] += mass * gravity
    moment, swing, distance = cross(r, h), cross(w, L), r[0] * r[0] + r[1] * r[1] + r[2] * r[2]
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        # M = [m, −m [r]×; m [r]×, R I Rᵀ − m [r]×²], h = [f; r × f + ω × L]
        M[i, i] = mass
        M[i, 3 + j] = M[3 + j, i] = mass * r[k]
        M[i, 3 + k] = M[3 + k, i] = -mass * r[j]
        for a in range(3):
            M[3 + i, 3 + a] -= mass * r[i] * r[a]
        M[3 + i, 3 + i] += mass * distance
        h[3 + i] = moment[i] + swing[i]
    if d == 3:
        return M, h
    kept = np.array([0, 1, 5])
    return M[kept][:, kept], h[kept]


@compiled
def _turn_back(R: Array, R_d: Array, v: Array, turned: Array) -> None:
    """R R_dᵀ v, (3,), written into ``turned``."""
    for i in range(3):
        turned[i] = 0.0
        for j in range(3):
            for k in range(3):
                turned[i] += R[i, j] * R_d[k, j] * v[k]


@compiled_for(2, 2, 1, 0, 2, 1, 0, 1, 2, 1, 1, 2, 1, 1)
def computed_torque(K_p: Array, K_d: Array, z: Array, mass: float, inertia: Array, center: Array,
                    gravity: float,
                    p: Array, R: Array, t: Array, p_d: Array, R_d: Array, t_d: Array, a_d: Array) -> Array:
    """W τ = M a + h, (3 planar or 6 spatial,), with the a that makes ë + K_d ė + K_p e + z = 0 of `put_error`'s e.

    Along the axes, and in the plane, a = a_d + x with x = K_d ė + K_p e + z and ė = t_d − t. About
    them u = R R_dᵀ ω_d − ω = J_r(e) ė, so that α = R R_dᵀ α_d + ω × u + J_r x − J̇_r ė.

    K_p, K_d : (n, n) gains in world axes; z : (n,) what an integral adds; then as in
        `mass_and_bias` and `put_error`, and the wanted twist and a_d
    """
    n = t.size
    M, h = mass_and_bias(mass, inertia, center, gravity, R, t)
    e, rate, x, a = np.empty(n), t_d - t, z.copy(), a_d.copy()
    put_error(p, R, p_d, R_d, e)
    if n == 6:
        r, w, u, v = e[3:], t[3:], np.empty(3), rate[3:]
        b, c, b_rate, c_rate = _coefficients(np.sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]))
        _turn_back(R, R_d, t_d[3:], u)
        for i in range(3):
            u[i] -= w[i]
        # J_r⁻¹ = I + [r]×/2 − (db/dθ)/(2 θ b) [r]×²
        r_u = cross(r, u)
        r_r_u = cross(r, r_u)
        for i in range(3):
            v[i] = u[i] + 0.5 * r_u[i] - b_rate / (2 * b) * r_r_u[i]
    for i in range(n):
        for j in range(n):
            x[i] += K_d[i, j] * rate[j] + K_p[i, j] * e[j]
    if n == 6:
        along = r[0] * v[0] + r[1] * v[1] + r[2] * v[2]
        _turn_back(R, R_d, a_d[3:], a[3:])
        # J_r = I − b [r]× + c [r]×², and its rate
        r_v, r_x, w_u = cross(r, v), cross(r, x[3:]), cross(w, u)
        r_r_v, r_r_x, v_r_v = cross(r, r_v), cross(r, r_x), cross(v, r_v)
        for i in range(3):
            a[3 + i] += (w_u[i] - b * r_x[i] + c * r_r_x[i]
                         + along * (b_rate * r_v[i] - c_rate * r_r_v[i]) - c * v_r_v[i])
    for i in range(n):
        for j in range(n):
            h[i] += M[i, j] * (a[j] + x[j])
    return h
