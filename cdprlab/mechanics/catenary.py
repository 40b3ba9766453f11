"""Cables that sag: Irvine's elastic catenary, and the lengths at which such cables hold a pose."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_array, as_count, checked, common_batch, frozen, frozen_dataclass, lasting
from ..errors import InfeasibleTensions, InvalidInput
from ..robot import STANDARD_GRAVITY, Robot
from ..robot.pose import Pose, cross
from .cables import anchor_offsets, cable_lengths, cable_vectors
from .statics import gravity_wrench

_MOST_STRAIN = 0.05
"""Up to which the stretch is taken as proportional to the tension."""

_MOST_STEPS = 10_000
"""Of Newton's method, with those that are halved; 60 were seen, of light cables nearly plumb up to 1000."""

_MOST_ROUNDS = 50
"""In which pulls and lengths are found; 10 were seen."""

_TINY = 1e-300
"""In the place of a force or a chord that is zero."""

_PRECISE = np.longdouble
"""A stiff cable's force is the small difference of span and length: where the machine has digits to spare, use them."""


@frozen_dataclass
class SaggingCable:
    """A cable that hangs between its exit point A and its anchor point B, at rest.

    span : (…, d) from A to B [m]
    length : (…) unstrained [m]
    weight : (…) ρ g per unstrained length [N/m]
    axial_stiffness : (…) EA [N]
    force_at_exit, force_at_anchor : (…, d) what it exerts on its ends; their sum is its weight [N]
    """

    span: Array
    length: Array
    weight: Array
    axial_stiffness: Array
    force_at_exit: Array
    force_at_anchor: Array

    def points(self, n: int) -> Array:
        """(…, n, d) from A, the origin, to B, evenly along the unstrained cable [m]."""
        along = np.linspace(0, 1, as_count(n, "points", 2)) * self.length[..., None]
        weight = self.weight[..., None]
        pull, heading = _level(self.force_at_exit[..., None, :])
        middle = self.force_at_exit[..., -1, None] + weight * along / 2
        cable = _hung((pull, middle), along, weight, self.axial_stiffness[..., None])
        return _along(heading, *cable.end)


@checked
def sagging_cable(span: Annotated[ArrayLike, "(…, d) [m]"], length: Annotated[ArrayLike, "(…) [m] > 0"],
                  linear_density: Annotated[ArrayLike, "(…) [kg/m] > 0"],
                  axial_stiffness: Annotated[ArrayLike, "(…) [N] > 0"],
                  gravity: Annotated[float, "[m/s²] > 0"] = STANDARD_GRAVITY) -> SaggingCable:
    """The elastic catenary: T(s) = (h, v + w s), dr/ds = T / |T| + T / EA, from A at s = 0 to B at s = length.

    x = h L (1 / EA + κ / T̄), z = v̄ L (1 / EA + 1 / T̄), where T̄ and v̄ are the means of |T| and v at
    the two ends, and κ L / T̄ = (arcsinh(v_B / h) − arcsinh(v_A / h)) / w. Vertical spans and
    cables that hang below both ends are included.

    span : (…, 2 or 3) from A to B, the last number upwards [m]
    length : (…) unstrained [m]
    linear_density : (…) ρ [kg/m]
    axial_stiffness : (…) EA [N]
    gravity : [m/s²]
    Returns SaggingCable.
    Raises InvalidInput for a cable that would be strained by more than 5 %, and for numbers that are
    not positive.
    Source: Irvine 1981, elastic catenary.

    >>> cable = sagging_cable([4.0, -1.0], 4.3, 0.05, 1e5)
    >>> (cable.force_at_exit + cable.force_at_anchor).round(9) + 0.0   # its weight
    array([ 0.     , -2.10915])
    """
    chord, L, density, ea = map(np.asarray, (span, length, linear_density, axial_stiffness))
    if chord.shape[-1] not in (2, 3):
        raise InvalidInput(f"span must be 2 or 3 numbers [m], got shape {chord.shape}")
    batch = common_batch(span=chord.shape[:-1], length=L.shape, linear_density=density.shape, axial_stiffness=ea.shape)
    L, density, ea = (np.broadcast_to(number, batch) for number in (L, density, ea))
    chord = np.broadcast_to(chord, (*batch, chord.shape[-1]))
    (level, heading), weight = _level(chord), density * gravity
    (h, v), cable = _hanging((level, chord[..., -1]), L, weight, ea)
    strain = np.max(np.maximum(cable.at_exit, cable.at_anchor) / ea, initial=0.0)
    if not strain <= _MOST_STRAIN:
        raise InvalidInput(f"the cable would be strained by {float(strain):.1%}, more than the 5 % up to which it "
                           "stretches in proportion: make it longer or stiffer")
    half = weight * L / 2
    return SaggingCable(*map(frozen, (chord, L, weight, ea, _along(heading, h, v - half),
                                      -_along(heading, h, v + half))))


@lasting
class SaggingLengths(NamedTuple):
    """(m,) unstrained lengths [m] and pulls at the anchor points [N] of sagging cables that hold a pose."""

    lengths: Array
    tensions: Array


@checked
def sagging_lengths(robot: Robot, pose: Pose, tensions: ArrayLike) -> SaggingLengths:
    """min ‖t − τ‖ over the pulls t at the anchor points with Σ [t e(t); (R b) × t e(t)] + w_g = 0, and their lengths.

    e(t) is the direction of the cable's own end, not of the straight line. A cable pulls equally
    hard at two lengths, nearly straight or hanging low: the shorter one is meant. Over a pulley
    the cable sags from where the straight one leaves the wheel.

    robot : with `linear_density` and `elasticity`
    pose : single
    tensions : (m,) τ, those of straight cables, say [N]
    Returns SaggingLengths: ``(lengths, tensions)``.
    Raises InvalidInput; InfeasibleTensions, which names the cable whose pull would have to be below the
    smallest that spans it.

    >>> import cdprlab as cl
    >>> world = cl.load_world("caroca")
    >>> sagging_lengths(world.robot, world.pose, np.full(8, 500.0))
    Traceback (most recent call last):
    ...
    cdprlab.errors.InvalidInput: cables that sag need `cable: {linear_density: …, axial_stiffness: …}` and gravity
    """
    given = as_array(tensions, "tensions", (robot.n_cables,), "N")
    elasticity, weight = robot.elasticity, robot.linear_density * robot.gravity
    if elasticity is None or weight <= 0:
        raise InvalidInput("cables that sag need `cable: {linear_density: …, axial_stiffness: …}` and gravity")
    if pose.batch_shape:
        raise InvalidInput("sagging_lengths takes one pose, not a batch")
    span, ea = -cable_vectors(robot, pose), elasticity.axial_stiffness
    level, heading = _level(span)
    arms, external = anchor_offsets(robot, pose), gravity_wrench(robot, pose)

    def wrenches(pulls: Array) -> Array:
        """(n, m) of (2, m) pulls at the anchor points, along the level and upwards."""
        forces = _along(heading, *pulls)
        return robot.pattern.project(np.hstack([forces, cross(arms, forces)]).T, pose.rotation)

    def pulled(lengths: Any) -> tuple[Any, Any, Any, Any]:
        """The (2, m) force (h, v) at B, its size, and how size and force grow with length."""
        (h, v), cable = _hanging((level, span[:, -1]), lengths, weight, ea)
        half = weight * lengths / 2
        # Where the end goes for a longer cable under the same force in its middle, and the force
        # that takes it back.
        turn = cable.force((-h * ((1 / cable.at_exit + 1 / cable.at_anchor) / 2 + 1 / ea),
                            -((v - half) / cable.at_exit + (v + half) / cable.at_anchor) / 2 - v / ea))
        force, slope = np.stack([h, v + half]), turn + [[0.0], [weight / 2]]
        return force, cable.at_anchor, (force * slope).sum(axis=0) / cable.at_anchor, slope

    chord = np.linalg.norm(span, axis=1)
    arcs = cable_lengths(robot, pose) - chord   # on the wheels
    shortest = chord / (1 + 1.1 * _MOST_STRAIN)
    lowest = _lowest(pulled, shortest, 4 * chord)
    least = pulled(lowest)[1].astype(float)
    lengths = np.clip(chord / (1 + given / ea), shortest, lowest)
    for k in range(_MOST_ROUNDS):
        force, pull, rate, slope = pulled(lengths)
        tried = pull.astype(float)
        W, slopes = wrenches(-force / pull), wrenches(-slope / rate)
        wanted = given + np.linalg.pinv(slopes) @ (slopes @ (tried - given) - W @ tried - external)
        # At the least pull itself the slopes are infinite: come to it step by step.
        pulls = np.maximum(np.clip(wanted, tried / 2, 2 * tried), (1 + 2.0**-k) * least)
        moved = np.abs(pulls - tried).max()
        if moved < 1e-12 * (1 + np.abs(pulls).max()):
            break
        # Newton's method for 1 / T², which is nearly linear in the length of a cable that sags.
        longer = lengths + pull / 2 * (1 - (pull / pulls)**2) / rate
        lengths = np.where(longer > lowest, (lengths + lowest) / 2, np.maximum(longer, (lengths + shortest) / 2))
    found = SaggingLengths(frozen((lengths + arcs).astype(float)), frozen(tried))
    worst = (wanted / least).argmin()
    if moved > 1e-9 * (1 + np.abs(pulls).max()) or wanted[worst] < least[worst]:
        raise InfeasibleTensions(f"near these tensions sagging cables do not hold the pose: cable {worst + 1} would "
                                 f"have to pull with {wanted[worst]:.4g} N at its anchor point, and the least that "
                                 f"spans it is {least[worst]:.4g} N", found)
    if np.abs(W @ tried + external).max() > 1e-8 * (1 + np.abs(external).max()):
        raise InfeasibleTensions("no pulls of sagging cables hold this pose", found)
    return found


def _level(vectors: Array) -> tuple[Array, Array]:
    """How far (…, d) vectors reach along the level, and (…, d − 1) unit vectors of which way."""
    level = vectors[..., :-1]
    size = np.linalg.norm(level, axis=-1)
    return size, level / np.maximum(size, _TINY)[..., None]


def _along(heading: Array, level: Array, up: Array) -> Array:
    """(…, d) vectors that reach so far along the level, the way `_level` says, and so far up."""
    return np.concatenate([heading * level[..., None], up[..., None]], axis=-1).astype(float)


def _lowest(pulled: Callable[[Any], Any], shortest: Any, longest: Any) -> Any:
    """(m,) lengths at which the cables pull least."""
    for _ in range(60):
        middle = (shortest + longest) / 2
        falling = pulled(middle)[2] < 0
        shortest, longest = np.where(falling, middle, shortest), np.where(falling, longest, middle)
    return longest


@checked
def straight_tensions(robot: Robot, pose: Pose, angle: Annotated[float, "[rad] > 0"] = 0.01) -> Array:
    """τ = ρ g d / 2 α: from there on a cable's ends turn away from the straight line by less than α.

    d is the level distance between its ends. A reason for a smallest tension: below it W, lengths and
    forward kinematics are those of other cables.

    robot : with `linear_density`; pose : single or batched
    angle : α [rad]
    Returns (…, m) [N].
    Source: Irvine 1981, parabola of small sag.

    >>> import cdprlab as cl
    >>> straight_tensions(cl.load_world("caroca").robot, cl.Pose([0, 0, 1])).max()   # it says no weight
    np.float64(0.0)
    """
    level = np.linalg.norm(cable_vectors(robot, pose)[..., :-1], axis=-1)
    return level * (robot.linear_density * robot.gravity / 2 / angle)


def drawn_lengths(robot: Robot, pose: Pose, tensions: ArrayLike) -> Array:
    """c (1 + (ρ g d / τ)² / 24), the parabola's, at most 2 c: how long a cable that pulls so hard looks.

    pose : single; tensions : (m,) [N]
    Returns (m,) [m], 0 (straight) of cables that weigh or pull nothing.

    >>> import cdprlab as cl
    >>> world = cl.load_world("caroca")
    >>> drawn_lengths(world.robot, world.pose, np.ones(8)).max()
    np.float64(0.0)
    """
    if not robot.linear_density:
        return np.zeros(robot.n_cables)
    vectors = cable_vectors(robot, pose)
    weight = robot.linear_density * robot.gravity * np.linalg.norm(vectors[:, :-1], axis=1)
    chord, shares = np.linalg.norm(vectors, axis=1), weight / np.where(np.greater(tensions, 0), tensions, np.inf)
    return np.where(shares > 0, chord * (1 + np.minimum(shares**2 / 24, 1)), 0.0)


class _Hung(NamedTuple):
    """A cable under the force (h, v) in its middle: where it ends (2, …), the slopes of that, and its tensions."""

    end: Any
    slopes: tuple[Any, Any, Any]
    at_exit: Any
    at_anchor: Any

    def force(self, way: Any) -> Any:
        """The change (2, …) of (h, v) that moves the end by so much."""
        (across, up), (level, mixed, upright) = way, self.slopes
        v = (up - mixed / level * across) / (upright - mixed / level * mixed)
        return np.stack([(across - mixed * v) / level, v])


def _hung(force: Any, length: Any, weight: Any, ea: Any) -> _Hung:
    """The catenary from the force in its middle; nothing is the difference of two numbers that are nearly equal."""
    h, v = force
    low, high = v - weight * length / 2, v + weight * length / 2
    at_exit, at_anchor = (np.maximum(np.hypot(h, end), _TINY) for end in (low, high))
    mean, product = (at_exit + at_anchor) / 2, at_exit * at_anchor
    with np.errstate(all="ignore"):
        # sinh of arcsinh(high / h) − arcsinh(low / h), whose terms differ in sign or are multiplied out.
        apart = high * at_exit - low * at_anchor
        turn = np.where(low * high > 0, 2 * weight * length * v / (high * at_exit + low * at_anchor), apart / h / h)
        flat = np.arcsinh(turn) / weight                      # ∫ ds / |T|
        steep = np.where(h == 0, apart, turn * h * h) / weight / product   # ∫ h² / |T|³ ds
        across = np.where(h == 0, 0, h * (length / ea + flat))
    return _Hung(np.stack([across, v * length * (1 / ea + 1 / mean)]),
                 (length / ea + flat - steep, -h * v * length / mean / product, length / ea + steep),
                 at_exit, at_anchor)


def _hanging(span: Any, length: Any, weight: Any, ea: Any) -> tuple[Any, _Hung]:
    """The force (h, v) in the middle of a cable that spans (across, up), and the cable.

    The end's place is the slope of the convex energy ∫ |T| + T² / 2EA ds: Newton's method, its
    steps halved until they help, finds the one force.
    """
    across, up, length, weight, ea = np.broadcast_arrays(
        *(np.asarray(number, dtype=_PRECISE) for number in (*span, length, weight, ea)))
    chord = np.maximum(np.hypot(across, up), _TINY)
    excess = chord / length - 1
    # Taut: T = EA (c / L − 1); sagging: c / L = 1 − (w L cos)² / 24 T².
    sag = (weight * length * across / chord)**2 / 24
    with np.errstate(divide="ignore", invalid="ignore"):   # 0 / 0 of a plumb cable as long as its span
        tension = ea * np.maximum(excess, 0) + np.fmin(np.cbrt(sag * ea), np.sqrt(sag / np.abs(excess)))
    span = np.stack([across, up])
    force = tension / chord * span
    cable, share, least = _hung(force, length, weight, ea), np.array(1.0), np.finfo(_PRECISE).eps * (chord + length)
    for _ in range(_MOST_STEPS):
        way = span - cable.end
        tried_force = force + share * cable.force(way)
        tried = _hung(tried_force, length, weight, ea)
        missing, left = np.hypot(*way), np.hypot(*(span - tried.end))
        helped = left < missing
        force = np.where(helped, tried_force, force)
        cable = tried if helped.all() else _hung(force, length, weight, ea)
        share = np.where(helped, 1.0, share / 2)
        # Where so little is missing and no step helps, rounding is all that is left.
        if (np.where(helped, left, missing) < np.where(helped, 2, 2**10) * least).all():
            break
    return force, cable
