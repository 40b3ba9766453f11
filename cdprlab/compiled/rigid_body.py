"""Where a platform and its cables are and what they carry, from what an engine tells of the platform's body."""

import numpy as np

from ..arrays import Array
from .columns import put_cables
from .jit import compiled_for
from .linear_algebra import cross


@compiled_for(1, 2, 1, 2, 2, 2, 2, 0)
def platform_and_cables(told: Array, axes: Array, center: Array, exit_points: Array, anchor_points: Array,
                        pulleys: Array, before: Array, substeps: float) -> tuple[Array, Array]:
    """[p, R row by row, v, ω, l, τ] (18 + 2 m,) of the platform at P and its cables, and W (6, m).

    told : place, quaternion (x, y, z, w), velocity and ω of the body's frame, in world axes, and the
        (3 m,) forces on the cables' ends [N]: the platform feels their opposites
    axes, center : (3, 3) and (3,) of the body's frame, seen from the platform's
    exit_points, anchor_points : (m, 3) [m]; pulleys : (m or 0, 4)
    before : W as the step began, to which the forces belong where it was one step
    """
    x, y, z, w = told[3:7]
    s = 2.0 / (x * x + y * y + z * z + w * w)
    Q = np.array([[1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)],
                  [s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x)],
                  [s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y)]])
    m = exit_points.shape[0]
    row, W = np.zeros(18 + 2 * m), np.empty((6, m))
    p, R = row[:3], row[3:12].reshape(3, 3)
    # R = Q axesᵀ, r = R c, p = body − r, v = v_body − ω × r
    r, omega = np.zeros(3), told[10:13]
    for i in range(3):
        for j in range(3):
            for k in range(3):
                R[i, j] += Q[i, k] * axes[j, k]
            r[i] += R[i, j] * center[j]
        p[i] = told[i] - r[i]
    swing = cross(omega, r)
    for i in range(3):
        row[12 + i] = told[7 + i] - swing[i]
        row[15 + i] = omega[i]
    put_cables(exit_points, anchor_points, p, R, pulleys, row[18:18 + m], W)
    u = before if substeps == 1 else W
    for i in range(m):
        for k in range(3):
            row[18 + m + i] -= told[13 + 3 * i + k] * u[k, i]
    return row, W
