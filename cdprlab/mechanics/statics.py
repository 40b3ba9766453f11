"""Forces in balance: wrench matrix, gravity wrench, stiffness, and the moments that tip mobile bases."""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_array, checked, common_batch, frozen, lasting
from ..errors import InvalidInput
from ..robot import Base, Robot
from ..robot.pose import Pose, lever
from .cables import (
    anchor_offsets,
    cable_directions,
    cables_at,
    check_dimension,
    exits_from_anchors,
    straight_lengths,
    tangent_points,
)


@checked
def wrench_matrix(robot: Robot, pose: Pose) -> Array:
    """W = −Jᵀ: column i is [u_i; (R b_i) × u_i], so that equilibrium reads W τ + w_e = 0.

    robot, pose : single or batched
    Returns (…, n, m); wrench = [f; m] at P in world axes [N, N m].
    Source: Okoli 2016, eq. (2.10) and (2.15).

    >>> import cdprlab as cl
    >>> wrench_matrix(cl.load_world("caroca").robot, cl.Pose([0, 0, 1])).shape
    (6, 8)
    """
    return cables_at(robot, pose).wrench_matrix


@checked
def gravity_wrench(robot: Robot, pose: Pose) -> Array:
    """Wrench of the weight at P: [f; (R c) × f] with f = −m g e_up.

    robot, pose : single or batched
    Returns (…, n) [N, N m].
    Source: Okoli 2016, eq. (2.24), whose sign (2.17), (6.1) and (6.2) contradict.

    >>> import cdprlab as cl
    >>> gravity_wrench(cl.load_world("caroca").robot, cl.Pose([0, 0, 1])) + 0.0
    array([    0. ,     0. , -1471.5,     0. ,     0. ,     0. ])
    """
    check_dimension(robot, pose)
    force = _weight(robot, robot.mass)
    arm = np.tensordot(pose.rotation, robot.platform.center_of_mass, 1)
    wrench = np.concatenate([np.broadcast_to(force, arm.shape), -arm @ lever(force)], axis=-1)
    return robot.pattern.project(wrench[..., None], pose.rotation)[..., 0]


@checked
def stiffness(robot: Robot, pose: Pose, tensions: ArrayLike,
              axial_stiffness: Annotated[ArrayLike, "(…) [N] ≥ 0"], *,
              weight: bool = False) -> Array:
    """K with dw = −K dx for the cables' wrench w = W τ at constant unstrained lengths.

    K = W diag((EA + τ)/l) Wᵀ + Σ τ_i K_i, the second (geometric) part from the turning of each
    cable, the first k_i = EA/l_0i = (EA + τ_i)/l_i. It is symmetric where the cables' moment at
    P is zero, as it is at rest with the center of mass at P; else K − Kᵀ holds that moment.
    A force τ u turns as (I − u uᵀ)/l; on a pulley as v vᵀ/s + n nᵀ |u·e|/x, with s = ‖T − B‖, x
    from B to the pulley's axis, e that way, n = axis × e, v = n × u. Its arc stretches, too.

    robot, pose : single or batched
    tensions : (…, m) [N]
    axial_stiffness : EA, a number or (m,) [N]
    weight : add what the weight's moment changes by when the platform turns; at equilibrium the
        whole is symmetric
    Returns (…, n, n) in the twist's axes at the pose [N/m, N, N m/rad].
    Source: Behzadipour and Khajepour 2006; Okoli 2016, eq. (2.25)–(2.28).

    >>> import cdprlab as cl
    >>> robot, pose = cl.load_world("caroca").robot, cl.Pose([0, 0, 1])
    >>> stiffness(robot, pose, np.full(8, 400.0), 1e5).shape
    (6, 6)
    """
    tau = _tensions(robot, pose, tensions)
    ea = np.asarray(axial_stiffness)
    if ea.shape not in ((), (robot.n_cables,)):
        raise InvalidInput(f"axial_stiffness must be a number or {robot.n_cables} numbers [N], got shape {ea.shape}")
    u, lengths, W = cables_at(robot, pose)
    elastic = (W * ((ea + tau) / lengths)[..., None, :]) @ np.swapaxes(W, -1, -2)
    d = robot.dimension
    r = anchor_offsets(robot, pose)
    # In full twist coordinates: from τ du = −swing (dp + dφ × r) and dr = dφ × r.
    moves = np.concatenate([np.broadcast_to(np.eye(d), (*u.shape, d)), lever(r)], axis=-1)
    geometric = np.swapaxes(moves, -1, -2) @ _swing(robot, pose, u, tau, lengths) @ moves
    geometric[..., d:, d:] += tau[..., None, None] * _moment_loss(r, u)
    full = geometric.sum(axis=-3)
    if weight:
        full[..., d:, d:] += _moment_loss(pose.rotation @ robot.platform.center_of_mass, _weight(robot, robot.mass))
    basis = robot.pattern.basis(pose.rotation)
    return elastic + np.swapaxes(basis, -1, -2) @ full @ basis


@lasting
class TippingRows(NamedTuple):
    """One row per footprint edge: ``matrix @ tensions + offset ≤ 0`` where the base stands.

    matrix : (…, edges, m) [m]
    offset : (…, edges) [N m], the base's own weight
    """

    matrix: Array
    offset: Array


class Footing(NamedTuple):
    """How forces tip one base, seen from the base itself: the same wherever it stands.

    base : which one
    levers : (edges, m, d): cable i's moment about an edge is lever · u_i per newton, zero for
        other bases' cables [m]
    center : (edges, d): the weight's is center · f [m]
    weight : (d,) f in the world [N]
    axes : (edges, m, 3 or 1) of the edges, zero for other bases' cables
    """

    base: int
    levers: Array
    center: Array
    weight: Array
    axes: Array

    def rows(self, directions: Array, rotation: Array, shifts: Array | None = None) -> TippingRows:
        """The edges' rows, given the cables' directions (…, m, d) and the base's rotation (d, d).

        shifts : (…, m, d) T − A, from exit to tangent points, where there are pulleys [m]
        """
        levers, pulls = self.levers, (directions @ rotation)[..., None, :, :]
        if shifts is not None:
            levers = levers - _turned(self.axes, (shifts @ rotation)[..., None, :, :])
        matrix = (levers * pulls).sum(axis=-1)
        offset = self.center @ (self.weight @ rotation)
        return TippingRows(frozen(matrix), frozen(offset + np.zeros(matrix.shape[:-1])))


def footings(robot: Robot) -> list[Footing]:
    """The footing of each base that has a footprint, in file order."""
    found = []
    for k, base in enumerate(robot.bases):
        if base.footprint.size:
            contacts, axes = _edges(base)
            # The moment of a force f at p about an edge: axis · ((p − contact) × f) = (axis ×
            # (p − contact)) · f. The cable pulls its exit point with −τ u.
            own = axes[:, None] * np.equal(robot.base_indices, k)[:, None]
            exits = np.array([cable.exit_point for cable in robot.cables])
            found.append(Footing(k, -_turned(own, exits - contacts[:, None]),
                                 _turned(axes, base.center_of_mass - contacts), _weight(robot, base.mass), own))
    return found


@checked
def tipping_rows(robot: Robot, pose: Pose) -> dict[str, TippingRows]:
    """For each base with a footprint, the moments about its edges as rows over the tensions.

    robot, pose : single or batched
    Returns base name → TippingRows; edges counter-clockwise from the first listed contact, and
    in the plane one row per contact. The cables pull their exit points, on pulleys the tangent
    points, with −τ u.
    Source: Pedemonte et al. 2020, eq. (21)–(24), contacts counter-clockwise.

    >>> import cdprlab as cl
    >>> tipping_rows(cl.load_world("caroca").robot, cl.Pose([0, 0, 1]))
    {}
    """
    directions = cable_directions(robot, pose)
    shifts = tangent_points(robot, pose) - robot.exit_points if robot.pulleys.size else None
    bases = robot.bases
    return {bases[footing.base].name: footing.rows(directions, bases[footing.base].rotation, shifts)
            for footing in footings(robot)}


@checked
def tipping_moments(robot: Robot, pose: Pose, tensions: ArrayLike) -> dict[str, Array]:
    """Moment about each edge of each base's footprint: it stands while all are ≤ 0.

    robot, pose : single or batched
    tensions : (…, m) [N]
    Returns base name → (…, edges) [N m].
    Source: as `tipping_rows`.

    >>> import cdprlab as cl
    >>> tipping_moments(cl.load_world("caroca").robot, cl.Pose([0, 0, 1]), np.full(8, 400.0))
    {}
    """
    tau = _tensions(robot, pose, tensions)
    return {name: (rows.matrix @ tau[..., None])[..., 0] + rows.offset
            for name, rows in tipping_rows(robot, pose).items()}


def _tensions(robot: Robot, pose: Pose, tensions: ArrayLike) -> Array:
    tau = as_array(tensions, "tensions", (robot.n_cables,), "N", batch=True)
    common_batch(tensions=tau.shape[:-1], poses=pose.batch_shape)
    return tau


def _swing(robot: Robot, pose: Pose, u: Array, tau: Array, lengths: Array) -> Array:
    """(…, m, d, d) G with τ du = −G db as anchor points (…, m, d) move: v vᵀ and n nᵀ as `stiffness` has them."""
    away, radii, axes = -exits_from_anchors(robot, pose), robot.pulleys[:, 0], robot.pulleys[:, 1:]
    straight = straight_lengths(away, robot.pulleys) if robot.pulleys.size else lengths
    G = (np.eye(robot.dimension) - u[..., :, None] * u[..., None, :]) * (tau / straight)[..., None, None]
    if robot.pulleys.size and robot.dimension == 3:   # in the plane wheels do not swivel
        aside = np.cross(axes, away)   # x n
        x = np.where(radii > 0, np.linalg.norm(aside, axis=-1), 1.0)
        other = tau * (np.linalg.norm(np.cross(axes, u), axis=-1) / x - 1 / straight) / x**2
        G += other[..., None, None] * aside[..., :, None] * aside[..., None, :]
    return G


def _moment_loss(arm: Array, force: Array) -> Array:
    """By how much the moment r × f of a force falls as its arm turns, dr = dφ × r."""
    return np.swapaxes(lever(force), -1, -2) @ lever(arm)


def _weight(robot: Robot, mass: float) -> Array:
    """(d,) the force of a mass downwards [N]."""
    return np.asarray(-mass * robot.gravity * np.eye(robot.dimension)[-1])


def _edges(base: Base) -> tuple[Array, Array]:
    """(k, d) a point and (k, 3 or 1) the axis of each edge, seen from the base; positive moments tip outwards."""
    if base.center_of_mass.size == 2:
        outward = np.sign(base.footprint[:, 0] - base.footprint[::-1, 0])
        return base.footprint, -outward[:, None]
    contacts = np.pad(base.footprint, ((0, 0), (0, 1)))
    edges = np.roll(contacts, -1, axis=0) - contacts
    return contacts, edges / np.linalg.norm(edges, axis=-1, keepdims=True)


def _turned(axes: Array, arms: Array) -> Array:
    """axis × arm, (…, k, d); in the plane the axis is along z."""
    return np.asarray((lever(arms) @ axes[..., None])[..., 0])
