"""How well a placement serves: one linear program over the tensions at all poses under all wrenches."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ...arrays import Array
from ...mechanics.optimization import largest_last
from ...mechanics.statics import tipping_rows, wrench_matrix
from ...robot import Robot
from ...robot.pose import Pose
from ...tensions.law import forgiven

UNREACHABLE = -1e3
"""Margin where the cables cannot exert a wrench at all, whatever their tensions."""


_GENEROUS = 100.0
"""A cable's range counts up to so many times the smallest: without a limit it would be the measure of all."""


class Duty(NamedTuple):
    """What a placement is to serve.

    poses : (N,); loads : (N, k, n) external wrenches [N, N m]; tipping : whether bases must
        stand
    """

    poses: Pose
    loads: Array
    tipping: bool

    def one(self, i: int, j: int) -> Duty:
        """Its pose i under its wrench j alone."""
        return self._replace(poses=self.poses[i:i + 1], loads=self.loads[i:i + 1, j:j + 1])

    def named(self, i: int, j: int) -> str:
        """Its pose i under its wrench j, in words."""
        return (f"pose {i + 1} of {len(self.poses)} (at {np.round(self.poses.position[i], 3).tolist()} m) under the "
                f"wrench {np.round(self.loads[i, j], 3).tolist()}")


def worst_margin(robot: Robot, duty: Duty) -> tuple[float, Array]:
    """The s of `place_bases` over all poses and wrenches at once, and tensions (N, k, m) that have it."""
    (N, k), m = duty.loads.shape[:2], robot.n_cables
    rows, sides = _limits(robot, duty)
    balance = np.pad(np.repeat(wrench_matrix(robot, duty.poses), k, axis=0), ((0, 0), (0, 0), (0, 1)))
    s, tensions = largest_last(_blocks(rows), sides.ravel(), _blocks(balance), -duty.loads.ravel(),
                               [*[(None, None)] * (N * k * m), (None, 1.0)])
    return s if np.isfinite(s) else UNREACHABLE, tensions.reshape(N, k, m)


def _limits(robot: Robot, duty: Duty) -> tuple[Array, Array]:
    """Rows (N k, f, m + 1) and sides (N k, f): tension limits, then footprint edges; the last column is that of s."""
    k, m = duty.loads.shape[1], robot.n_cables
    half = (robot.tension_max - robot.tension_min) / 2
    half = np.minimum(half, _GENEROUS * half[half > 0].min(initial=np.inf))
    eye = np.eye(m)
    rows = [np.broadcast_to(np.column_stack([sign * eye, half]), (len(duty.poses), m, m + 1))
            for sign in (-1.0, 1.0)]
    slack = forgiven(np.abs(duty.loads).max(axis=1), robot.tension_min)
    sides = [slack + side for side in (-robot.tension_min, robot.tension_max)]
    for edges in tipping_rows(robot, duty.poses).values() if duty.tipping else ():
        holds = np.abs(edges.offset).mean(axis=-1, keepdims=True)
        rows.append(np.concatenate([edges.matrix, np.broadcast_to(holds, edges.offset.shape)[..., None]], axis=-1))
        sides.append(-edges.offset)
    return np.repeat(np.concatenate(rows, axis=1), k, axis=0), np.repeat(np.concatenate(sides, axis=1), k, axis=0)


def _blocks(rows: Array) -> Any:
    """Sparse: each block of rows (B, f, m + 1) over its own m tensions, and over the one s they share, the last."""
    from scipy.sparse import block_diag, coo_array, hstack

    return hstack([block_diag(rows[..., :-1]), coo_array(rows[..., -1:].reshape(-1, 1))], format="csr")
