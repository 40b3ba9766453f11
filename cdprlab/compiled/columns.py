"""The columns of W, cable after cable, and the cables' lengths: what every loop, sweep, engine and set asks for."""

import math

import numpy as np

from ..arrays import Array
from .jit import compiled, compiled_for

# [m] nearer to the line that its cable comes along, an anchor point does not say which way its pulley swivels.
ON_AXIS = 1e-9


@compiled
def over_pulley(vx: float, vy: float, vz: float, r: float, ax: float, ay: float, az: float,
                ) -> tuple[float, float, float, float]:
    """Length l = r φ + ‖T − B‖ of a cable that leaves over a pulley, and u from B to its tangent point T.

    v = A − B [m]; r : the pulley's radius [m]; a : the axis that the cable comes along
    It cannot where B is on the axis, inside the wheel, or wraps more than half a turn: l is 0 then, u NaN.
    """
    # B from A: h along the axis and x e away from it; s² is what the tangent leaves of ‖B − C‖², C = A + r e
    h = -(vx * ax + vy * ay + vz * az)
    ex, ey, ez = -vx - h * ax, -vy - h * ay, -vz - h * az
    x = math.sqrt(ex * ex + ey * ey + ez * ez)
    squared = h * h + x * (x - 2 * r)
    if not (x > ON_AXIS and squared > 0 and (h >= 0 or x >= 2 * r)):
        return 0.0, math.nan, math.nan, math.nan
    s = math.sqrt(squared)
    # tan φ/2 = x / (s + h) = (s − h) / (x − 2 r): the one that loses no digits
    rise, run = x, s + h
    if h < 0:
        rise, run = s - h, x - 2 * r
    scale = 1 / (rise * rise + run * run)
    # the cable travels along a cos φ + e sin φ, and pulls the other way
    along, out = (run * run - rise * rise) * scale, 2 * rise * run * scale / x
    length = s + 2 * r * math.atan2(rise, run)
    return length, -along * ax - out * ex, -along * ay - out * ey, -along * az - out * ez


@compiled
def put_cables(exit_points: Array, anchor_points: Array, p: Array, R: Array, pulleys: Array,
               lengths: Array, W: Array) -> None:
    """Lengths and whole wrench matrix of `cables` at one pose, written into ``lengths`` and ``W``."""
    last, over = p.size - 1, len(pulleys) > 0
    space = last - 1.0   # 0 in the plane: a factor; branches in its place made the loop three times as slow
    # Numbers of their own: an array that is written into might be the one that is read.
    x, y, xx, xy, yx, yy = p[0], p[1], R[0, 0], R[0, 1], R[1, 0], R[1, 1]
    z, xz, yz = space * p[last], space * R[0, last], space * R[1, last]
    zx, zy, zz = space * R[last, 0], space * R[last, 1], space * R[last, last]
    for i in range(len(exit_points)):
        bx, by, bz = anchor_points[i, 0], anchor_points[i, 1], anchor_points[i, last]
        # r = R B
        rx = xx * bx + xy * by + xz * bz
        ry = yx * bx + yy * by + yz * bz
        rz = zx * bx + zy * by + zz * bz
        # v = A − p − r, l = ‖v‖, u = v / l
        vx = exit_points[i, 0] - x - rx
        vy = exit_points[i, 1] - y - ry
        vz = space * exit_points[i, last] - z - rz
        if over and pulleys[i, 0] > 0:
            length, ux, uy, uz = over_pulley(
                vx, vy, vz, pulleys[i, 0], pulleys[i, 1], pulleys[i, 2], space * pulleys[i, last + 1])
        else:
            length = np.sqrt(vx * vx + vy * vy + vz * vz)
            ux, uy, uz = vx / length, vy / length, vz / length
        lengths[i] = length
        W[0, i] = ux
        W[1, i] = uy
        # r × u
        W[-1, i] = rx * uy - ry * ux
        if last == 2:
            W[2, i] = uz
            W[3, i] = ry * uz - rz * uy
            W[4, i] = rz * ux - rx * uz


@compiled_for(2, 2, 2, 3, 2)
def cables(exit_points: Array, anchor_points: Array, positions: Array, rotations: Array,
           pulleys: Array) -> tuple[Array, Array]:
    """Lengths l (k, m) and whole wrench matrices W (k, 3 planar or 6 spatial, m) at k poses.

    exit_points A, anchor_points B : (m, d) [m]; positions p : (k, d) [m]; rotations R : (k, d, d)
    pulleys : (m, 1 + d), or (0, 1 + d), as `Robot.pulleys` has them
    Column i of W is [u_i; r_i × u_i]: its first d rows are the directions. Of a cable without
    length it is NaN.
    """
    count, d = positions.shape
    m = exit_points.shape[0]
    lengths, W = np.empty((count, m)), np.empty((count, 3 * (d - 1), m))
    for k in range(count):
        put_cables(exit_points, anchor_points, positions[k], rotations[k], pulleys, lengths[k], W[k])
    return lengths, W
