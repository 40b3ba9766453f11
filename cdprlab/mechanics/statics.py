"""Forces in balance: wrench matrix, gravity wrench, stiffness, and the moments that tip mobile bases."""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_array, checked, common_batch, frozen, lasting
from ..errors import InvalidInput
from ..robot import Base, Robot
from ..robot.pose import Pose, cross, lever
from .cables import anchor_offsets, cable_directions, cables_at, check_dimension, straight_lengths, tangent_points


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
    force, arm = _weight(robot.mass * robot.gravity, robot.dimension), pose.rotation @ robot.platform.center_of_mass
    wrench = np.concatenate([np.broadcast_to(force, arm.shape), cross(arm, force)], axis=-1)
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
    directions, lengths, W = cables_at(robot, pose)
    elastic = (W * ((ea + tau) / lengths)[..., None, :]) @ np.swapaxes(W, -1, -2)
    basis = robot.pattern.basis(pose.rotation)
    r = anchor_offsets(robot, pose)
    geometric = _geometric_stiffness(r, directions, tau, _swing(robot, pose.position[..., None, :] + r, directions, tau,
                                                                lengths))
    if weight:
        geometric = geometric + _weight_stiffness(robot, pose)
    return elastic + np.swapaxes(basis, -1, -2) @ geometric @ basis


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
    axes : (edges, 3 or 1) of the edges
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
            aside = _turned(self.axes[:, None], (shifts @ rotation)[..., None, :, :])
            levers = levers - aside * (np.abs(levers).max(axis=(0, 2)) > 0)[:, None]   # of its own cables
        matrix = (levers * pulls).sum(axis=-1)
        offset = self.center @ (self.weight @ rotation)
        return TippingRows(frozen(matrix), frozen(np.broadcast_to(offset, matrix.shape[:-1])))


def footings(robot: Robot) -> list[Footing]:
    """The footing of each base that has a footprint, in file order."""
    found = []
    for k, base in enumerate(robot.bases):
        if not base.footprint.shape[0]:
            continue
        contacts, axes = _edges(base)
        # The moment of a force f at p about an edge: axis · ((p − contact) × f) = (axis ×
        # (p − contact)) · f.
        levers = np.zeros((len(contacts), robot.n_cables, robot.dimension))
        for i, carrier in enumerate(robot.base_indices):
            if carrier == k:   # the cable pulls its exit point with −τ u
                levers[:, i] = -_turned(axes, robot.cables[i].exit_point - contacts)
        found.append(Footing(k, levers, _turned(axes, base.center_of_mass - contacts),
                             _weight(base.mass * robot.gravity, robot.dimension), axes))
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
    directions, shifts = cable_directions(robot, pose), None
    if robot.pulleys.size:
        shifts = tangent_points(robot, pose) - robot.exit_points
    return {robot.bases[footing.base].name: footing.rows(directions, robot.bases[footing.base].rotation, shifts)
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


def _swing(robot: Robot, anchors: Array, u: Array, tau: Array, lengths: Array) -> Array:
    """(…, m, d, d) G with τ du = −G db as anchor points (…, m, d) move: v vᵀ and n nᵀ as `stiffness` has them."""
    across = np.eye(robot.dimension) - u[..., :, None] * u[..., None, :]
    if not robot.pulleys.size:
        return across * (tau / lengths)[..., None, None]
    away, radii, axes = anchors - robot.exit_points, robot.pulleys[:, 0], robot.pulleys[:, 1:]
    straight = straight_lengths(away, robot.pulleys)
    G = across * (tau / straight)[..., None, None]
    if robot.dimension == 3:   # in the plane wheels do not swivel
        aside = np.cross(axes, away)   # x n
        x = np.where(radii > 0, np.linalg.norm(aside, axis=-1), 1.0)
        other = tau * (np.linalg.norm(np.cross(axes, u), axis=-1) / x - 1 / straight) / x**2
        G += other[..., None, None] * aside[..., :, None] * aside[..., None, :]
    return G


def _geometric_stiffness(r: Array, u: Array, tau: Array, swing: Array) -> Array:
    """Σ τ_i K_i in full twist coordinates: from τ du = −swing (dp + dφ × r) and dr = dφ × r."""
    d = r.shape[-1]
    moves = np.concatenate([np.broadcast_to(np.eye(d), swing.shape), lever(r)], axis=-1)
    full = np.swapaxes(moves, -1, -2) @ swing @ moves
    full[..., d:, d:] += tau[..., None, None] * _moment_loss(r, u)
    return full.sum(axis=-3)


def _moment_loss(arm: Array, force: Array) -> Array:
    """By how much the moment r × f of a force falls as its arm turns, dr = dφ × r."""
    return np.swapaxes(lever(force), -1, -2) @ lever(arm)


def _weight_stiffness(robot: Robot, pose: Pose) -> Array:
    """−d w_g / dx in full twist coordinates: the weight's arm turns with the platform."""
    d, n = robot.dimension, 3 * (robot.dimension - 1)
    full = np.zeros((*pose.batch_shape, n, n))
    full[..., d:, d:] = _moment_loss(pose.rotation @ robot.platform.center_of_mass,
                                     _weight(robot.mass * robot.gravity, d))
    return full


def _weight(size: float, d: int) -> Array:
    """(d,) a force downwards [N]."""
    return np.asarray(-size * np.eye(d)[-1])


def _edges(base: Base) -> tuple[Array, Array]:
    """(k, d) a point and (k, 3 or 1) the axis of each edge, seen from the base; positive moments tip outwards."""
    if base.center_of_mass.shape[0] == 2:
        outward = np.sign(base.footprint[:, 0] - base.footprint[::-1, 0])
        return base.footprint, -outward[:, None]
    contacts = np.pad(base.footprint, ((0, 0), (0, 1)))
    edges = np.roll(contacts, -1, axis=0) - contacts
    return contacts, edges / np.linalg.norm(edges, axis=-1, keepdims=True)


def _turned(axes: Array, arms: Array) -> Array:
    """axis × arm, (…, k, d); in the plane the axis is along z."""
    return np.asarray((lever(arms) @ axes[..., None])[..., 0])
