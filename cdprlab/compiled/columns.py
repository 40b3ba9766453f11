"""The columns of W, cable after cable, and the cables' lengths: what every loop, sweep, engine and set asks for."""

import numpy as np

from ..arrays import Array
from .jit import compiled_for


@compiled_for(2, 2, 2, 3)
def cables(exit_points: Array, anchor_points: Array, positions: Array, rotations: Array) -> tuple[Array, Array]:
    """Lengths l (k, m) and whole wrench matrices W (k, 3 planar or 6 spatial, m) at k poses.

    exit_points A, anchor_points B : (m, d) [m]; positions p : (k, d) [m]; rotations R :
        (k, d, d)
    Column i of W is [u_i; r_i × u_i]: its first d rows are the directions. Of a cable without
    length it is NaN.
    """
    count, d = positions.shape
    m = exit_points.shape[0]
    lengths, W = np.empty((count, m)), np.empty((count, 3 * (d - 1), m))
    rz = vz = 0.0   # in the plane
    for k in range(count):
        R, p = rotations[k], positions[k]
        for i in range(m):
            A, B = exit_points[i], anchor_points[i]
            # r = R B
            rx = R[0, 0] * B[0] + R[0, 1] * B[1]
            ry = R[1, 0] * B[0] + R[1, 1] * B[1]
            if d == 3:
                rx += R[0, 2] * B[2]
                ry += R[1, 2] * B[2]
                rz = R[2, 0] * B[0] + R[2, 1] * B[1] + R[2, 2] * B[2]
                vz = A[2] - p[2] - rz
            # v = A − p − r, l = ‖v‖, u = v / l
            vx = A[0] - p[0] - rx
            vy = A[1] - p[1] - ry
            length = np.sqrt(vx * vx + vy * vy + vz * vz)
            ux, uy, uz = vx / length, vy / length, vz / length
            lengths[k, i] = length
            W[k, 0, i] = ux
            W[k, 1, i] = uy
            # r × u
            W[k, -1, i] = rx * uy - ry * ux
            if d == 3:
                W[k, 2, i] = uz
                W[k, 3, i] = ry * uz - rz * uy
                W[k, 4, i] = rz * ux - rx * uz
    return lengths, W
