"""Every step in the plane: where the platform and its cables are, and how the reels must turn."""

import math

from ..arrays import Array
from .columns import put_cables
from .jit import compiled_for


@compiled_for(1, 0, 0, 1, 2, 2, 2, writes=(1, 2))
def look(motion: Array, dt: float, reach: float, center: Array, exit_points: Array,
         anchor_points: Array, pulleys: Array,
         seen: Array, W: Array) -> bool:
    """Where the platform is about to be, and the cables there.

    Returns False where it is beyond reach of the origin [m], or turns by more than 2π in a
    step, or where a cable has no direction.

    motion : (6,) the center of mass's x, y, angle and their rates [m, rad, m/s, rad/s]
    center, anchor_points : (2,) of mass and (m, 2), in the platform's frame [m]
    exit_points : (m, 2) [m]
    pulleys : (m or 0, 3) radius and axis of each [m]
    seen : (9 + m,) becomes position, rotation (row by row), twist of P, lengths
    W : (3, m) becomes the whole wrench matrix
    """
    x, y, angle, vx, vy, spin = motion
    x, y, angle = x + vx * dt, y + vy * dt, angle + spin * dt
    c, s = math.cos(angle), math.sin(angle)
    rx, ry = center[0] * c - center[1] * s, center[0] * s + center[1] * c
    x, y = x - rx, y - ry
    seen[:9] = x, y, c, -s, s, c, vx + spin * ry, vy - spin * rx, spin
    lengths = seen[9:]
    put_cables(exit_points, anchor_points, seen[:2], seen[2:6].reshape(2, 2), pulleys, lengths, W)
    return (abs(x) < reach and abs(y) < reach and abs(spin * dt) < math.tau
            and lengths.min() > 0)


@compiled_for(1, 1, 0, 2, 2, writes=(1,))
def reel(motion: Array, lengths: Array, dt: float, W: Array, exit_velocities: Array,
         velocities: Array) -> None:
    """How fast the reels must go to keep their ropes to these lengths by the end of a step [m/s].

    motion, W : as `look` has them; lengths : (m,) [m]
    exit_velocities : (m, 2) of what the reels stand on
    velocities : x and y of one body after the other: the first is the platform, which keeps its
        own, and the last m become the reels'
    """
    first, rate = velocities.size - 2 * lengths.size, -1 / dt
    velocities[0], velocities[1] = motion[3], motion[4]
    for i, length in enumerate(lengths):
        for k in range(2):
            velocities[first + 2 * i + k] = exit_velocities[i, k] + length * rate * W[k, i]
