"""Where a platform and its cables are, from what an engine tells of the platform's body."""

import numpy as np

from ..arrays import Array
from .columns import cables
from .jit import compiled_for


@compiled_for(1, 2, 1, 2, 2, 2)
def platform_and_cables(body: Array, axes: Array, center: Array, exit_points: Array,
                        anchor_points: Array, pulleys: Array) -> tuple[Array, Array, Array]:
    """[p, R row by row, v, ω] (18,) of the platform at P, l (m,) and W (6, m) as `cables` has them.

    body : (13,) of the body's frame: position, quaternion (x, y, z, w), velocity, angular
        velocity, in world axes
    axes, center : (3, 3) and (3,) of the body's frame, seen from the platform's
    exit_points, anchor_points : (m, 3) [m]; pulleys : (m or 0, 4)
    """
    x, y, z, w = body[3], body[4], body[5], body[6]
    s = 2.0 / (x * x + y * y + z * z + w * w)
    Q = np.array([[1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)],
                  [s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x)],
                  [s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y)]])
    state = np.zeros(18)
    p, R = state[:3].reshape(1, 3), state[3:12].reshape(1, 3, 3)
    # R = Q axesᵀ, r = R c, p = body − r, v = v_body − ω × r
    r, v, omega = np.zeros(3), body[7:10], body[10:13]
    for i in range(3):
        for j in range(3):
            for k in range(3):
                R[0, i, j] += Q[i, k] * axes[j, k]
            r[i] += R[0, i, j] * center[j]
        p[0, i] = body[i] - r[i]
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        state[12 + i] = v[i] - (omega[j] * r[k] - omega[k] * r[j])
        state[15 + i] = omega[i]
    lengths, W = cables(exit_points, anchor_points, p, R, pulleys)
    return state, lengths[0], W[0]
