"""Where a platform and its cables are, from what an engine tells of the platform's body."""

import numpy as np

from ..arrays import Array
from .columns import put_cables
from .jit import compiled_for

Numbers = tuple[float, ...]


@compiled_for((3,), (4,), (3,), (3,), 2, 1, 2, 2, 2)
def platform_and_cables(place: Numbers, quaternion: Numbers, velocity: Numbers, omega: Numbers,
                        axes: Array, center: Array, exit_points: Array,
                        anchor_points: Array, pulleys: Array) -> tuple[Array, Array]:
    """[p, R row by row, v, ω, l] (18 + m,) of the platform at P and its cables, and W (6, m).

    place, quaternion (x, y, z, w), velocity, omega : of the body's frame, in world axes
    axes, center : (3, 3) and (3,) of the body's frame, seen from the platform's
    exit_points, anchor_points : (m, 3) [m]; pulleys : (m or 0, 4)
    """
    x, y, z, w = quaternion
    s = 2.0 / (x * x + y * y + z * z + w * w)
    Q = np.array([[1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)],
                  [s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x)],
                  [s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y)]])
    m = exit_points.shape[0]
    row, W = np.zeros(18 + m), np.empty((6, m))
    p, R = row[:3], row[3:12].reshape(3, 3)
    # R = Q axesᵀ, r = R c, p = body − r, v = v_body − ω × r
    r = np.zeros(3)
    for i in range(3):
        for j in range(3):
            for k in range(3):
                R[i, j] += Q[i, k] * axes[j, k]
            r[i] += R[i, j] * center[j]
        p[i] = place[i] - r[i]
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        row[12 + i] = velocity[i] - (omega[j] * r[k] - omega[k] * r[j])
        row[15 + i] = omega[i]
    put_cables(exit_points, anchor_points, p, R, pulleys, row[18:], W)
    return row, W
