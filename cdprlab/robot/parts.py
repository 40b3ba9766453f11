"""The parts of a robot: frozen `Cable`, `Pulley`, `Platform`, `Base`, …, each checked as it is made."""

from dataclasses import dataclass
from itertools import combinations
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_array, checked, frozen, frozen_dataclass
from ..errors import InvalidInput
from .pose import cross, turned_to

DECK_HEIGHT = 0.25
"""[m] Up to which a mobile base is drawn and, in the plane, solid."""

Vector = Annotated[Array, "(d,) [m]"]

_UNIT = 1e-3
"""How far from 1 a unit vector's length may be written."""


@frozen_dataclass
class Pulley:
    """What a cable runs over at its exit point A: it comes along ``axis`` to A and wraps from there.

    The pulley swivels freely about the line that it comes along, so that its wheel always faces
    the anchor point.

    radius : of the wheel, to the middle of the cable [m]
    axis : (d,) unit, the way the cable travels towards A, in the frame of its exit point
    """

    radius: Annotated[float, "[m] > 0"]
    axis: Annotated[Array, "(d,)"]

    def __post_init__(self) -> None:
        size = np.linalg.norm(self.axis)
        if abs(size - 1) > _UNIT:
            raise InvalidInput("axis of a pulley must be a unit vector, the way the cable travels towards its exit "
                               f"point, got {self.axis.tolist()}, of length {size:.4g}", ("axis",))
        object.__setattr__(self, "axis", frozen(self.axis / size))


@frozen_dataclass
class Cable:
    """One cable from its exit point A (frame or base) to its anchor point B (platform).

    exit_point : (d,) in the world frame, or in the base's frame if ``base`` is given [m]
    anchor_point : (d,) in the platform frame [m]
    tension_min, tension_max : limits [N], 0 ≤ min ≤ max
    speed_max : largest |l̇| [m/s]
    base : name of the mobile base that carries the exit point
    pulley : that it leaves over, None: straight from the exit point
    length_offset : what its winch's encoder reads, minus the length there is [m]
    """

    exit_point: Vector
    anchor_point: Vector
    tension_min: Annotated[float, "[N] ≥ 0"]
    tension_max: Annotated[float, "[N] ≥ 0"]
    speed_max: Annotated[float, "[m/s] > 0 or inf"] = float("inf")
    base: str | None = None
    pulley: Pulley | None = None
    length_offset: Annotated[float, "[m]"] = 0.0

    def __post_init__(self) -> None:
        check_order(self.tension_min, self.tension_max)
        _check_size(self.anchor_point, "anchor_point", self.exit_point)
        if self.pulley is not None:
            as_array(self.pulley.axis, "axis of a pulley", self.exit_point.shape, location=("pulley", "axis"))


@frozen_dataclass
class Platform:
    """The moving platform, a rigid body; its frame's origin is the reference point P.

    mass : [kg]
    inertia : about the center of mass, platform axes: three principal values, six (xx yy zz xy xz yz)
        or (3, 3), in the plane one number [kg m²]
    center_of_mass : (d,) in the platform frame [m]
    size : (d,) edges of the box that is drawn and collided [m]
    center : (d,) where that box's center lies in the platform frame [m]
    """

    mass: Annotated[float, "[kg] > 0"]
    inertia: Array
    center_of_mass: Vector
    size: Annotated[Array, "(d,) [m] > 0"]
    center: Vector

    def __post_init__(self) -> None:
        _check_size(self.size, "size", self.center_of_mass)
        _check_size(self.center, "center", self.center_of_mass)
        object.__setattr__(self, "inertia", _inertia(self.inertia, self.size.size))


@frozen_dataclass
class Base:
    """A mobile base: it stands on the floor and carries exit points.

    position : (2,) of the base's frame in the world: (x, y) on the floor, or in the plane [m]
    heading : counter-clockwise angle [rad]
    mass : [kg]
    center_of_mass : (d,) in the base's frame [m]
    footprint : (k, 2) floor contacts in the base's frame, counter-clockwise from the first
        listed [m]
    speed_max : (3,) of (θ, ρ₁, ρ₂) [rad/s, m/s, m/s]; 0 holds that direction
    """

    name: str
    position: Annotated[Array, "(2,) [m]"]
    heading: Annotated[float, "[rad]"]
    mass: Annotated[float, "[kg] > 0"]
    center_of_mass: Vector
    footprint: Annotated[Array, "(k, 2) [m]"]
    speed_max: Annotated[Array, "(3,) [rad/s, m/s] ≥ 0"]

    def __post_init__(self) -> None:
        object.__setattr__(self, "footprint", _counter_clockwise(self.footprint, self.center_of_mass.size))

    @property
    def pose(self) -> tuple[float, float, float]:
        """(x, y, heading), as `Robot.with_bases` takes it [m, m, rad]."""
        x, y = self.position.tolist()
        return x, y, self.heading

    @property
    def rotation(self) -> Array:
        """(d, d) from the base's frame to the world."""
        return turned_to(self.heading, self.center_of_mass.size)

    @property
    def origin(self) -> Array:
        """(d,) of the base's frame in the world; spatial bases stand at z = 0 [m]."""
        return np.concatenate([self.position, np.zeros(self.center_of_mass.size - 2)])

    def to_world(self, points: ArrayLike) -> Array:
        """(…, d) points of the base's frame in the world [m]."""
        own = as_array(points, "points", self.origin.shape, "m", batch=True)
        return self.origin + own @ self.rotation.T


@checked
@dataclass(frozen=True)
class Winch:
    """What drives one cable: drum, gear and motor (FASTKIT's Table 1 is one).

    drum_radius : [m]
    gear_ratio : motor turns per drum turn
    efficiency : of the gear, 0 to 1
    torque : the motor's largest [N m]
    coulomb, viscous : friction at the motor [N m], [N m s/rad]
    static : friction at breakaway, at the motor; 0: no more than Coulomb's [N m]
    inertia : of all that turns, at the motor [kg m²]
    speed : the motor's largest [rad/s]
    """

    drum_radius: Annotated[float, "[m] > 0"]
    gear_ratio: Annotated[float, "> 0"] = 1.0
    efficiency: Annotated[float, "> 0"] = 1.0
    torque: Annotated[float, "[N m] > 0 or inf"] = float("inf")
    coulomb: Annotated[float, "[N m] ≥ 0"] = 0.0
    viscous: Annotated[float, "[N m s/rad] ≥ 0"] = 0.0
    static: Annotated[float, "[N m] ≥ 0"] = 0.0
    inertia: Annotated[float, "[kg m²] ≥ 0"] = 0.0
    speed: Annotated[float, "[rad/s] > 0 or inf"] = float("inf")

    def __post_init__(self) -> None:
        if self.efficiency > 1:
            raise InvalidInput(f"efficiency must be at most 1, got {self.efficiency:g}", ("efficiency",))

    @property
    def transmission(self) -> float:
        """G / r: how far its motor turns for a metre of cable [rad/m]."""
        return self.gear_ratio / self.drum_radius

    @property
    def tension_max(self) -> float:
        """τ G η / r: what its motor winds in with at most [N]."""
        return self.torque * self.transmission * self.efficiency

    @property
    def speed_max(self) -> float:
        """q̇ r / G [m/s]."""
        return self.speed / self.transmission


@checked
@dataclass(frozen=True)
class Elasticity:
    """How cables stretch: axial stiffness EA [N] (k = EA / l), and damping, each cable's own fraction of critical."""

    axial_stiffness: Annotated[float, "[N] > 0 or inf"] = float("inf")
    damping: Annotated[float, "≥ 0"] = 0.0

    def unstrained(self, lengths: Array, tensions: Array) -> Array:
        """l₀ = l / (1 + τ / EA): how much rope a length under a tension is.

        lengths : (…) [m]; tensions : (…) [N]

        >>> float(Elasticity(1e3).unstrained(np.array(5.05), np.array(10.0)))
        5.0
        """
        return lengths / (1 + tensions / self.axial_stiffness)


def check_order(tension_min: float, tension_max: float) -> None:
    """Raises InvalidInput unless the limits are in order [N]."""
    if tension_min > tension_max:
        raise InvalidInput(f"tension limits are crossed: smallest {tension_min:g} N > "
                           f"largest {tension_max:g} N", ("tension",))


def box_inertia(mass: float, size: ArrayLike) -> Array:
    """Inertia of a uniform box about its center: (3, 3) in space, one number in the plane [kg m²].

    I_x = m / 12 (b² + c²) for edges a, b, c along x, y, z

    mass : [kg]
    size : (d,) edges [m]

    >>> box_inertia(12.0, [1.0, 2.0, 3.0]).diagonal()
    array([13., 10.,  5.])
    """
    squares = np.square(size)
    if squares.shape == (2,):
        return np.asarray(mass / 12 * squares.sum())
    return np.diag(mass / 12 * (squares.sum() - squares))


def _check_size(vector: Array, name: str, other: Array) -> None:
    """Raises InvalidInput unless two vectors of a part are of the same dimension."""
    as_array(vector, name, other.shape, "m", location=(name,))


def _inertia(values: ArrayLike, d: int) -> Array:
    """A rigid body's inertia: (3, 3) from three principal values, six or a matrix; in the plane one number [kg m²].

    >>> _inertia([2, 3, 3, 0, 0, 0.5], 3)[1]
    array([0. , 3. , 0.5])
    """
    if d == 2:
        return as_array(values, "inertia", (), "kg m²", positive=True, location=("inertia",))
    matrix = as_array(values, "inertia", (), "kg m²", batch=True, location=("inertia",))
    if matrix.shape not in ((3,), (6,), (3, 3)):
        raise InvalidInput("inertia must be 3 numbers (principal) or 6 (xx yy zz xy xz yz) [kg m²], "
                           f"got {matrix.size}", ("inertia",))
    if matrix.ndim == 1:
        matrix = np.pad(matrix, (0, 6 - matrix.size))[[[0, 3, 4], [3, 1, 5], [4, 5, 2]]]
    if not np.allclose(matrix, matrix.T, rtol=0, atol=1e-9 * np.abs(matrix).max()):
        raise InvalidInput(f"inertia must be symmetric [kg m²], got {matrix.tolist()}", ("inertia",))
    principal = np.linalg.eigvalsh(matrix)
    # A body's principal moments obey the triangle inequality; 1e-9 covers rounding in a
    # parallel-axis shift.
    if principal[0] <= 0 or principal[2] > (principal[0] + principal[1]) * (1 + 1e-9):
        raise InvalidInput("inertia is no rigid body's: principal moments must be positive and none above the sum "
                           f"of the others, got {principal.round(6).tolist()} kg m²", ("inertia",))
    return frozen(matrix)


def _counter_clockwise(points: Array, d: int) -> Array:
    """The contacts counter-clockwise from the first listed, whichever way round they were given."""
    if not points.size:
        return points
    if d == 2:
        if len(points) != 2 or points[0, 0] == points[1, 0]:
            raise InvalidInput("a planar footprint is two contacts with different x", ("footprint",))
        return points
    # Of a convex polygon any three corners, in order, turn the same way.
    turns = {float(np.sign(cross(b - a, c - a)[0])) for a, b, c in combinations(points, 3)}
    if turns not in ({1.0}, {-1.0}):
        raise InvalidInput("footprint must be the corners of a convex polygon in order, at least 3 contacts "
                           "and none on an edge", ("footprint",))
    return points if turns == {1.0} else frozen(np.roll(points[::-1], 1, axis=0))
