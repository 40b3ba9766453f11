"""What a box of poses holds for certain: feasible everywhere, or nowhere, for one wrench.

With σ_i = τ_i / l_i, the tension for each meter of cable, equilibrium reads V σ + w = 0, V
having columns [A_i − p − r_i; r_i × (A_i − p)]: linear in the position p, and in cos φ and sin
φ, so that sums over cables are exact.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, reduce
from operator import add

import numpy as np

from ..arrays import Array, Flags
from ..mechanics.intervals import Intervals, exact, stack
from ..robot import Robot
from ..robot.pose import Pose

_TINY = 1e-12


@dataclass(frozen=True, eq=False)
class PoseBoxes:
    """N boxes of poses.

    robot : any motion pattern but 2R3T, without pulleys
    bounds : Intervals (N, d) of the position [m]; in the plane also (N, 3), the last of the angle [rad]
    rotation : R (d, d) for all where there is no angle
    """

    robot: Robot
    bounds: Intervals
    rotation: Array

    def __getitem__(self, chosen: Flags) -> PoseBoxes:
        return PoseBoxes(self.robot, self.bounds[chosen], self.rotation)

    @property
    def position(self) -> Intervals:
        """(N, 1, d)."""
        return self.bounds[:, None, :self.robot.dimension]

    @property
    def middle(self) -> Pose:
        """(N,) poses in the middle of each."""
        d, center = self.robot.dimension, (self.bounds.lower + self.bounds.upper) / 2
        if center.shape[1] > d:
            return Pose(center[:, :d], angle=center[:, d])
        return Pose(center, matrix=self.rotation)

    @cached_property
    def turns(self) -> list[tuple[Intervals, Array]]:
        """f (N or 1, 1, 1) and exact R_k with R = Σ f_k R_k: cos φ and sin φ of angles, else 1."""
        d = self.robot.dimension
        if self.bounds.lower.shape[1] > d:
            angle = self.bounds[:, d:, None]
            return [(angle.cos(), np.eye(2)), (angle.sin(), np.array([[0.0, -1.0], [1.0, 0.0]]))]
        return [(exact(np.ones((1, 1, 1))), self.rotation)]

    @cached_property
    def arms(self) -> Intervals:
        """(N or 1, m, d) r_i = R b_i."""
        return self._turned(self.robot.anchor_points)

    @cached_property
    def lengths(self) -> Intervals:
        """(N, m) of the cables [m]."""
        way = self.robot.exit_points - self.position - self.arms
        return way.square().total().sqrt()

    @cached_property
    def weight(self) -> Intervals:
        """(N or 1, n) gravity wrench."""
        force = exact(-self.robot.mass) * (self.robot.gravity * np.eye(self.robot.dimension)[-1:])
        return self._wrench(force, _cross(self._turned(self.robot.platform.center_of_mass[None])[:, 0], force))

    def wrenches(self, sigma: Array) -> Intervals:
        """(N, k, n) V σ for exact σ (N, k, m), as narrow as positions and angle allow."""
        exits, anchors, pull, p = self.robot.exit_points, self.robot.anchor_points, exact(sigma), self.position
        arms = self._turned(pull.times(anchors))   # Σ σ_i r_i
        moments = reduce(add, (f * pull.times(_cross(exact(anchors).times(R.T), exact(exits))) for f, R in self.turns))
        return self._wrench(pull.times(exits) - arms - pull.total()[..., None] * p, moments - _cross(arms, p))

    def pulls(self, normal: Array) -> Intervals:
        """(N, m) n · [u_i; r_i × u_i] for exact n = [f; m] (N, n): (f + m × r)·(A − p) − f·r, over the length."""
        d = self.robot.dimension
        full = exact(np.pad(normal, ((0, 0), (0, d + len(_CROSS[d]) - self.robot.n_dof)))[:, None])
        way, r, force = self.robot.exit_points - self.position, self.arms, full[..., :d]
        turned = [force[..., i] for i in range(d)]
        for i, (j, k) in enumerate(_CROSS[d], d):
            turned[k] = full[..., i] * r[..., j] + turned[k]
            turned[j] = turned[j] - full[..., i] * r[..., k]
        return (stack(turned) * way - r * force).total() / self.lengths

    def _turned(self, points: Intervals | Array) -> Intervals:
        """(N or 1, k, d) R x of points (k, d) or (N, k, d)."""
        return reduce(add, (f * exact(points).times(R.T) for f, R in self.turns))

    def _wrench(self, force: Intervals, moment: Intervals) -> Intervals:
        """The motion pattern's rows."""
        rows = [part[..., i] for part in (force, moment) for i in range(part.lower.shape[-1])]
        return stack(rows[:self.robot.n_dof])


_CROSS = {2: ((0, 1),), 3: ((1, 2), (2, 0), (0, 1))}
"""j and k of each component a_j b_k − a_k b_j of a × b, in the plane and in space."""


def _cross(a: Intervals, b: Intervals) -> Intervals:
    return stack([a[..., j] * b[..., k] - a[..., k] * b[..., j]
                  for j, k in _CROSS[b.lower.shape[-1]]])


def certainly_inside(boxes: PoseBoxes, load: Array, W: Array, tensions: Array, lengths: Array) -> Flags:
    """Where some tensions within the limits balance weight and load at every pose of a box.

    With Y a right inverse of V at the center, σ = σ₀ − Y z balances the wrench where (V Y) z =
    V σ₀ + w; E = I − V Y is small, and every z̄ > 0 with |E| z̄ + |V σ₀ + w| ≤ z̄ bounds the
    solution z. Then l σ must stay inside the limits.

    W (N, n, m), tensions (N, m), lengths (N, m) : at the boxes' centers, merely good choices
    """
    robot, n = boxes.robot, W.shape[1]
    # Y asks most of cables far from their limits.
    room = np.minimum(tensions - robot.tension_min, robot.tension_max - tensions)
    least = room.min(axis=1, keepdims=True)
    weights = (np.clip(room, least, 100 * least) / lengths) ** 2
    sigma, V = tensions / lengths, W * lengths[:, None, :]
    scaled = np.swapaxes(V * weights[:, None, :], 1, 2)
    Y = scaled @ np.linalg.pinv(V @ scaled)
    forces = boxes.wrenches(np.concatenate([sigma[:, None], np.swapaxes(Y, 1, 2)], axis=1))
    rest = (forces[:, 0] + boxes.weight + load).magnitude + _TINY
    E = np.swapaxes((exact(np.eye(n)) - forces[:, 1:]).magnitude, 1, 2)
    with np.errstate(all="ignore"):
        bound = _fixed_point(E, rest)
        kept = exact(bound).times(np.swapaxes(E, 1, 2)) + rest
        proven = (bound > 0).all(axis=1) & (kept.upper <= bound).all(axis=1)
        reach = exact(bound).times(np.swapaxes(np.abs(Y), 1, 2)).upper
        low, high = (sigma - exact(reach)).lower, (sigma + exact(reach)).upper
        weakest, most = (exact(low) * boxes.lengths.lower).lower, (exact(high) * boxes.lengths.upper).upper
    return np.asarray(proven & (low >= 0).all(axis=1) & (weakest >= robot.tension_min).all(axis=1)
                      & (most <= robot.tension_max).all(axis=1))


def certainly_outside(boxes: PoseBoxes, load: Array, normal: Array) -> Flags:
    """Where no tensions within the limits balance weight and load at any pose of a box: n · (W τ + w) < 0 for all."""
    robot = boxes.robot
    with np.errstate(all="ignore"):   # a cable that may have no length proves nothing
        most = (boxes.pulls(normal) * Intervals(robot.tension_min, robot.tension_max)).total()
        wanted = ((boxes.weight + load) * normal).total()
        return np.asarray((most + wanted).upper < 0)


def _fixed_point(E: Array, rest: Array) -> Array:
    """(N, n) z̄ with E z̄ + rest a little below z̄; not positive where there is none."""
    n = E.shape[-1]
    try:
        found = np.linalg.solve(np.eye(n) - E, (rest * (1 + 1e-9))[..., None])[..., 0]
    except np.linalg.LinAlgError:
        return np.full(rest.shape, -1.0)
    return np.asarray(found * (1 + 1e-9) + _TINY)
