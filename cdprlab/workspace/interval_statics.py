"""What a box of poses holds for certain: feasible everywhere, or nowhere, for one wrench.

With σ_i = τ_i / l_i, the tension for each meter of cable, equilibrium reads V σ + w = 0, V having columns
[A_i − p − r_i; r_i × (A_i − p)]: linear in the position p, and in cos φ and sin φ, so that sums over cables are exact.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..arrays import Array, Flags
from ..mechanics.intervals import Intervals, exact, stack
from ..robot import Robot
from ..robot.pose import Pose

_TINY = 1e-12


@dataclass(frozen=True, eq=False)
class PoseBoxes:
    """N boxes of poses: positions (N, d) and, in the plane, angles; in space one rotation (3, 3) for all.

    robot : any motion pattern but 2R3T
    position : Intervals (N, d) [m]
    angle : Intervals (N,) [rad], or None in space
    rotation : (3, 3), or None in the plane
    """

    robot: Robot
    position: Intervals
    angle: Intervals | None
    rotation: Array | None

    def __getitem__(self, chosen: Flags) -> PoseBoxes:
        angle = None if self.angle is None else self.angle[chosen]
        return PoseBoxes(self.robot, self.position[chosen], angle, self.rotation)

    @cached_property
    def arms(self) -> Intervals:
        """(N or 1, m, d) r_i = R b_i."""
        return self._turned(self.robot.anchor_points)

    @cached_property
    def lengths(self) -> Intervals:
        """(N, m) of the cables [m]."""
        way = self.robot.exit_points - self.position[:, None, :] - self.arms
        return way.square().total().sqrt()

    @cached_property
    def weight(self) -> Intervals:
        """(N, n) gravity wrench."""
        d, pull = self.robot.dimension, exact(-self.robot.mass) * self.robot.gravity
        c = self._turned(self.robot.platform.center_of_mass[None])[:, 0]
        zero = exact(np.zeros(len(self.position.lower)))
        if d == 2:
            return _rows([zero, zero + pull, zero + c[:, 0] * pull], self.robot)
        return _rows([zero, zero, zero + pull, zero + c[:, 1] * pull, zero - c[:, 0] * pull, zero], self.robot)

    def wrenches(self, sigma: Array) -> Intervals:
        """(N, k, n) V σ for exact σ (N, k, m), as narrow as positions and angle allow."""
        robot, p = self.robot, self.position[:, None, :]
        S = _over_cables(sigma, np.ones((robot.n_cables, 1)))
        A = _over_cables(sigma, robot.exit_points)
        B = self._turned_sums(sigma, robot.anchor_points)
        force = A - B - S * p
        products = robot.anchor_points[:, :, None] * exact(robot.exit_points[:, None, :])   # b_j A_k of each cable
        if robot.dimension == 2:
            (c, s), moments = self._cos_sin, [_over_cables(sigma, part[:, None]) for part in (
                products[:, 0, 1] - products[:, 1, 0],              # b × A
                exact(0.0) - products[:, 1, 1] - products[:, 0, 0])]   # b⊥ × A, b⊥ = (−b_y, b_x)
            m_z = c[:, None] * moments[0][..., 0] + s[:, None] * moments[1][..., 0]
            m_z = m_z - (B[..., 0] * p[..., 1] - B[..., 1] * p[..., 0])
            return _rows([force[..., 0], force[..., 1], m_z], robot)
        r, exits = self.arms[0], robot.exit_points
        rows = [force[..., i] for i in range(3)]
        for j, k in ((1, 2), (2, 0), (0, 1)):
            spun = _over_cables(sigma, (r[:, j] * exits[:, k] - r[:, k] * exits[:, j])[:, None])[..., 0]
            rows.append(spun - (B[..., j] * p[..., k] - B[..., k] * p[..., j]))
        return _rows(rows, robot)

    def pulls(self, normal: Array) -> Intervals:
        """(N, m) n · [u_i; r_i × u_i] for exact n (N, n)."""
        d, n = self.robot.dimension, self.robot.n_dof
        full = np.zeros((len(normal), 3 if d == 2 else 6))
        full[:, :n] = normal
        way, r = self.robot.exit_points - self.position[:, None, :], self.arms
        m = exact(full[:, None, d:])
        if d == 2:   # n·[q − r; r × q] = (f + m r⊥')·q − f·r
            turned = [0.0 - m[..., 0] * r[..., 1], m[..., 0] * r[..., 0]]
        else:
            turned = [m[..., j] * r[..., k] - m[..., k] * r[..., j] for j, k in ((1, 2), (2, 0), (0, 1))]
        along = exact(np.zeros(1))
        for i in range(d):
            force = full[:, None, i]
            along = along + (turned[i] + force) * way[..., i] - r[..., i] * force
        return along / self.lengths

    @cached_property
    def _cos_sin(self) -> tuple[Intervals, Intervals]:
        assert self.angle is not None
        return self.angle.cos(), self.angle.sin()

    def _turned(self, points: Array) -> Intervals:
        """(N or 1, k, d) R x of exact points (k, d)."""
        if self.rotation is not None:
            return exact(points[None]).times(self.rotation.T)
        c, s = (part[:, None] for part in self._cos_sin)
        x, y = points[:, 0], points[:, 1]
        return stack([c * x - s * y, s * x + c * y])

    def _turned_sums(self, sigma: Array, points: Array) -> Intervals:
        """(N, k, d) Σ σ_i R b_i."""
        if self.rotation is not None:
            return _over_cables(sigma, self._turned(points)[0])
        sums = _over_cables(sigma, points)
        (c, s), x, y = self._cos_sin, sums[..., 0], sums[..., 1]
        c, s = c[:, None], s[:, None]
        return stack([c * x - s * y, s * x + c * y])


def certainly_inside(boxes: PoseBoxes, load: Array, W: Array, tensions: Array, lengths: Array) -> Flags:
    """Where some tensions within the limits balance weight and load at every pose of a box.

    With Y a right inverse of V at the center, σ = σ₀ − Y z balances the wrench where (V Y) z = V σ₀ + w; E = I − V Y is
    small, and every z̄ > 0 with |E| z̄ + |V σ₀ + w| ≤ z̄ bounds the solution z. Then l σ must stay inside the limits.

    W (N, n, m), tensions (N, m), lengths (N, m) : at the boxes' centers, merely good choices
    """
    robot = boxes.robot
    sigma, Y = _center(W, tensions, lengths, robot)
    n = Y.shape[-1]
    forces = boxes.wrenches(np.concatenate([sigma[:, None], np.swapaxes(Y, 1, 2)], axis=1))
    rest = (forces[:, 0] + boxes.weight + load).magnitude + _TINY
    E = np.swapaxes((exact(np.eye(n)) - forces[:, 1:]).magnitude, 1, 2)
    with np.errstate(all="ignore"):
        bound = _fixed_point(E, rest)
        kept = exact(bound).times(np.swapaxes(E, 1, 2)) + rest
        proven = (bound > 0).all(axis=1) & (kept.upper <= bound).all(axis=1)
        reach = exact(bound).times(np.swapaxes(np.abs(Y), 1, 2)).upper
        low, high = (sigma - exact(reach)).lower, (sigma + exact(reach)).upper
        least, most = (exact(low) * boxes.lengths.lower).lower, (exact(high) * boxes.lengths.upper).upper
    return np.asarray(proven & (low >= 0).all(axis=1) & (least >= robot.tension_min).all(axis=1)
                      & (most <= robot.tension_max).all(axis=1))


def certainly_outside(boxes: PoseBoxes, load: Array, normal: Array) -> Flags:
    """Where no tensions within the limits balance weight and load at any pose of a box: n · (W τ + w) < 0 for all."""
    robot = boxes.robot
    with np.errstate(all="ignore"):   # a cable that may have no length proves nothing
        most = (boxes.pulls(normal) * Intervals(robot.tension_min, robot.tension_max)).total()
        wanted = ((boxes.weight + load) * normal).total()
        return np.asarray((most + wanted).upper < 0)


def centers(boxes: PoseBoxes) -> Pose:
    """(N,) poses in the middle."""
    middle = (boxes.position.lower + boxes.position.upper) / 2
    if boxes.angle is not None:
        return Pose(middle, angle=(boxes.angle.lower + boxes.angle.upper) / 2)
    return Pose(middle, matrix=boxes.rotation)


def _center(W: Array, tensions: Array, lengths: Array, robot: Robot) -> tuple[Array, Array]:
    """σ₀ (N, m), and Y (N, m, n) that asks most of cables far from their limits."""
    room = np.minimum(tensions - robot.tension_min, robot.tension_max - tensions)
    least = room.min(axis=1, keepdims=True)
    weights = (np.clip(room, least, 100 * least) / lengths) ** 2
    V = W * lengths[:, None, :]
    scaled = np.swapaxes(V * weights[:, None, :], 1, 2)
    return tensions / lengths, np.asarray(scaled @ np.linalg.pinv(V @ scaled))


def _fixed_point(E: Array, rest: Array) -> Array:
    """(N, n) z̄ with E z̄ + rest a little below z̄; not positive where there is none."""
    n = E.shape[-1]
    try:
        found = np.linalg.solve(np.eye(n) - E, (rest * (1 + 1e-9))[..., None])[..., 0]
    except np.linalg.LinAlgError:
        return np.full(rest.shape, -1.0)
    return np.asarray(found * (1 + 1e-9) + _TINY)


def _over_cables(sigma: Array, values: Array | Intervals) -> Intervals:
    """Σ_i σ_i x_i: (N, k, m) and (m, d) → (N, k, d)."""
    x = exact(values)
    result = x[0] * sigma[..., 0, None]
    for i in range(1, sigma.shape[-1]):
        result = result + x[i] * sigma[..., i, None]
    return result


def _rows(rows: list[Intervals], robot: Robot) -> Intervals:
    """The motion pattern's rows."""
    return stack(rows[:robot.n_dof])
