"""What a cable robot is made of: frozen `Cable`, `Platform`, `Base`, `Robot`, and its motion pattern."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .arrays import Array, as_array, as_number, frozen
from .errors import InvalidInput

STANDARD_GRAVITY = 9.81


class MotionPattern(NamedTuple):
    """Which motions the cables control (Verhoeven's classes).

    name : "1T", "2T", "1R2T" (planar), "3T", "2R3T", "3R3T" (spatial)
    dimension : 2 or 3, the space it lives in
    n_dof : number of controlled degrees of freedom, the length of a twist or wrench
    rows : which of the full twist's rows it keeps; in 2R3T the last two are along the platform's y′ and z′
    """

    name: str
    dimension: int
    n_dof: int
    rows: tuple[str, ...]

    @property
    def turns(self) -> bool:
        """Whether orientation is controlled too."""
        return bool(self.turn_axes)

    @property
    def turn_axes(self) -> tuple[int, ...]:
        """Which entries of the rotation vector (platform axes; one entry in the plane) it controls."""
        return {"1R2T": (0,), "2R3T": (1, 2), "3R3T": (0, 1, 2)}.get(self.name, ())

    def basis(self, rotation: Array) -> Array:
        """S with full twist = S t and wrench = Sᵀ full wrench.

        rotation : (…, d, d) platform rotation (used by 2R3T only)
        Returns (…, 3 or 6, n), full twist [v; ω] in world axes.
        """
        full = 3 if self.dimension == 2 else 6
        if self.name != "2R3T":
            return np.eye(full)[:, :self.n_dof]
        basis = np.zeros((*rotation.shape[:-2], 6, 5))
        basis[..., :3, :3] = np.eye(3)
        basis[..., 3:, 3:] = rotation[..., :, 1:]
        return basis


MOTION_PATTERNS: dict[str, MotionPattern] = {
    pattern.name: pattern for pattern in (
        MotionPattern("1T", 2, 1, ("x",)),
        MotionPattern("2T", 2, 2, ("x", "y")),
        MotionPattern("1R2T", 2, 3, ("x", "y", "rz")),
        MotionPattern("3T", 3, 3, ("x", "y", "z")),
        MotionPattern("2R3T", 3, 5, ("x", "y", "z", "ry′", "rz′")),
        MotionPattern("3R3T", 3, 6, ("x", "y", "z", "rx", "ry", "rz")),
    )
}


def motion_pattern(name: str) -> MotionPattern:
    """The motion pattern of that name; raises InvalidInput naming the six there are.

    >>> motion_pattern("2R3T").n_dof
    5
    """
    if name not in MOTION_PATTERNS:
        raise InvalidInput(f"unknown motion pattern {name!r}; there are {', '.join(MOTION_PATTERNS)}",
                           ("motion_pattern",))
    return MOTION_PATTERNS[name]


@dataclass(frozen=True, eq=False)
class Cable:
    """One cable from its exit point A (frame or base) to its anchor point B (platform).

    exit_point : (d,) in the world frame, or in the base's frame if ``base`` is given [m]
    anchor_point : (d,) in the platform frame [m]
    tension_min, tension_max : limits [N], 0 ≤ min ≤ max
    speed_max : largest |l̇| [m/s]
    base : name of the mobile base that carries the exit point
    """

    exit_point: Array
    anchor_point: Array
    tension_min: float
    tension_max: float
    speed_max: float = float("inf")
    base: str | None = None

    def __post_init__(self) -> None:
        set_ = object.__setattr__
        set_(self, "exit_point", as_array(self.exit_point, "exit_point", ("d",), "m", location=("exit_point",)))
        d = self.exit_point.shape[0]
        set_(self, "anchor_point", as_array(self.anchor_point, "anchor_point", (d,), "m", location=("anchor_point",)))
        set_(self, "tension_min", as_number(self.tension_min, "smallest tension", "N", minimum=0.0,
                                            location=("tension",)))
        set_(self, "tension_max", as_number(self.tension_max, "largest tension", "N", minimum=0.0,
                                            location=("tension",)))
        if self.tension_min > self.tension_max:
            raise InvalidInput(f"tension limits are crossed: smallest {self.tension_min:g} N > "
                               f"largest {self.tension_max:g} N", ("tension",))
        if self.speed_max != float("inf"):
            set_(self, "speed_max", as_number(self.speed_max, "speed", "m/s", positive=True, location=("speed",)))


@dataclass(frozen=True, eq=False)
class Platform:
    """The moving platform, a rigid body; its frame's origin is the reference point P.

    mass : [kg]
    inertia : (3, 3) about the center of mass in platform axes, or one number in the plane [kg m²]
    center_of_mass : (d,) in the platform frame [m]
    size : (d,) edges of the box that is drawn and collided [m]
    center : (d,) where that box's center lies in the platform frame [m]
    """

    mass: float
    inertia: Array
    center_of_mass: Array
    size: Array
    center: Array

    def __post_init__(self) -> None:
        set_ = object.__setattr__
        set_(self, "mass", as_number(self.mass, "mass", "kg", positive=True, location=("mass",)))
        set_(self, "center_of_mass", as_array(self.center_of_mass, "center_of_mass", ("d",), "m",
                                              location=("center_of_mass",)))
        d = self.center_of_mass.shape[0]
        for name in ("size", "center"):
            set_(self, name, as_array(getattr(self, name), name, (d,), "m", location=(name,)))
        set_(self, "inertia", _checked_inertia(self.inertia, d))
        if (self.size <= 0).any():
            raise InvalidInput(f"size must be positive along every edge [m], got {self.size.tolist()}", ("size",))

    @cached_property
    def is_off_center(self) -> bool:
        """Whether the center of mass is not at P."""
        return bool(self.center_of_mass.any())


@dataclass(frozen=True, eq=False)
class Base:
    """A mobile base: it stands on the floor and carries exit points.

    position : (2,) of the base's frame in the world: (x, y) on the floor, or in the plane [m]
    heading : counter-clockwise angle [rad]
    mass : [kg]
    center_of_mass : (d,) in the base's frame [m]
    footprint : (k, 2) floor contacts in the base's frame, counter-clockwise from the first listed [m]
    speed_max : (3,) of (θ, ρ₁, ρ₂) [rad/s, m/s, m/s]; 0 holds that direction
    """

    name: str
    position: Array
    heading: float
    mass: float
    center_of_mass: Array
    footprint: Array
    speed_max: Array

    def __post_init__(self) -> None:
        set_ = object.__setattr__
        set_(self, "position", as_array(self.position, "position", (2,), "m", location=("pose", "position")))
        set_(self, "heading", as_number(self.heading, "heading", "rad", location=("pose", "heading")))
        set_(self, "mass", as_number(self.mass, "mass", "kg", positive=True, location=("mass",)))
        set_(self, "center_of_mass", as_array(self.center_of_mass, "center_of_mass", ("d",), "m",
                                              location=("center_of_mass",)))
        set_(self, "footprint", _counter_clockwise(self.footprint, self.center_of_mass.shape[0]))
        set_(self, "speed_max", as_array(self.speed_max, "speed", (3,), location=("speed",)))
        if (self.speed_max < 0).any():
            raise InvalidInput(f"speed limits must not be negative, got {self.speed_max.tolist()}", ("speed",))

    @property
    def rotation(self) -> Array:
        """(d, d) from the base's frame to the world."""
        c, s = np.cos(self.heading), np.sin(self.heading)
        rotation = np.eye(self.center_of_mass.shape[0])
        rotation[:2, :2] = [[c, -s], [s, c]]
        return rotation

    @property
    def origin(self) -> Array:
        """(d,) of the base's frame in the world; spatial bases stand at z = 0 [m]."""
        return np.concatenate([self.position, np.zeros(self.center_of_mass.shape[0] - 2)])

    def to_world(self, points: Array) -> Array:
        """(…, d) points of the base's frame in the world [m]."""
        return self.origin + points @ self.rotation.T


@dataclass(frozen=True)
class Winch:
    """What drives one cable: drum, gear and motor (FASTKIT's Table 1 is one).

    drum_radius : [m]
    gear_ratio : motor turns per drum turn
    efficiency : of the gear, 0 to 1
    torque : the motor's largest [N m]
    coulomb, viscous : friction at the motor [N m], [N m s/rad]
    """

    drum_radius: float
    gear_ratio: float = 1.0
    efficiency: float = 1.0
    torque: float = float("inf")
    coulomb: float = 0.0
    viscous: float = 0.0


@dataclass(frozen=True)
class Elasticity:
    """How the cables stretch: axial stiffness EA [N] (k = EA / l) and damping, as a fraction of critical."""

    axial_stiffness: float
    damping: float = 0.0


@dataclass(frozen=True, eq=False)
class Robot:
    """A cable-driven parallel robot: platform, cables, the bases some of them may stand on.

    Raises InvalidInput where the parts do not fit: dimension, unknown base, an anchor point the motion
    pattern forbids.

    >>> import cdprlab as cl
    >>> cl.load_world("caroca").robot
    Robot(3R3T, 8 cables, 150 kg)
    """

    pattern: MotionPattern
    platform: Platform
    cables: tuple[Cable, ...]
    bases: tuple[Base, ...] = ()
    gravity: float = STANDARD_GRAVITY
    winch: Winch | None = None
    elasticity: Elasticity | None = None
    _base_of: dict[str, int] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        set_ = object.__setattr__
        set_(self, "cables", tuple(self.cables))
        set_(self, "bases", tuple(self.bases))
        set_(self, "gravity", as_number(self.gravity, "gravity", "m/s²", minimum=0.0, location=("gravity",)))
        set_(self, "_base_of", {base.name: k for k, base in enumerate(self.bases)})
        self._check_bases()
        self._check_cables()

    # --- counts -----------------------------------------------------------------------------------
    @property
    def n_cables(self) -> int:
        """m."""
        return len(self.cables)

    @property
    def n_dof(self) -> int:
        """n."""
        return self.pattern.n_dof

    @property
    def dimension(self) -> int:
        """2 (planar) or 3 (spatial)."""
        return self.pattern.dimension

    @property
    def motion_pattern(self) -> str:
        """"1T", "2T", "1R2T", "3T", "2R3T" or "3R3T"."""
        return self.pattern.name

    # --- arrays over the cables -------------------------------------------------------------------
    @cached_property
    def exit_points(self) -> Array:
        """(m, d) A_i in the world frame, at the bases' present poses [m]."""
        return frozen(np.array([cable.exit_point if cable.base is None
                                else self.base(cable.base).to_world(cable.exit_point) for cable in self.cables]))

    @cached_property
    def anchor_points(self) -> Array:
        """(m, d) B_i in the platform frame [m]."""
        return frozen(np.array([cable.anchor_point for cable in self.cables]))

    @cached_property
    def tension_min(self) -> Array:
        """(m,) [N]."""
        return frozen(np.array([cable.tension_min for cable in self.cables]))

    @cached_property
    def tension_max(self) -> Array:
        """(m,) [N]."""
        return frozen(np.array([cable.tension_max for cable in self.cables]))

    @cached_property
    def speed_max(self) -> Array:
        """(m,) largest |l̇| [m/s]."""
        return frozen(np.array([cable.speed_max for cable in self.cables]))

    @cached_property
    def base_indices(self) -> tuple[int, ...]:
        """(m,) which base carries each cable, −1 for the frame."""
        return tuple(-1 if cable.base is None else self._base_of[cable.base] for cable in self.cables)

    # --- parts ------------------------------------------------------------------------------------
    @property
    def mass(self) -> float:
        """Platform mass [kg]."""
        return self.platform.mass

    def base(self, name: str) -> Base:
        """The base of that name; raises InvalidInput naming those there are."""
        if name not in self._base_of:
            raise InvalidInput(f"unknown base {name!r}; {_there_are(self._base_of)}")
        return self.bases[self._base_of[name]]

    # --- changed copies ---------------------------------------------------------------------------
    def with_bases(self, poses: Mapping[str, ArrayLike]) -> Robot:
        """A copy with some bases elsewhere.

        poses : base name → (x, y, heading) [m, m, rad]
        Raises InvalidInput for an unknown base.
        """
        moved = dict(zip(self._base_of, self.bases))
        for name, pose in poses.items():
            x, y, heading = as_array(pose, f"pose of base {name!r}", (3,))
            moved[name] = replace(self.base(name), position=np.array([x, y]), heading=float(heading))
        return replace(self, bases=tuple(moved.values()))

    def with_payload(self, mass: float, position: ArrayLike) -> Robot:
        """A copy that carries a point mass; mass, center of mass and inertia follow (parallel axes).

        mass : [kg]
        position : (d,) in the platform frame [m]

        >>> import cdprlab as cl
        >>> cl.load_world("caroca").robot.with_payload(50.0, [0, 0, -0.4]).platform.center_of_mass
        array([ 0. ,  0. , -0.1])
        """
        load = as_number(mass, "payload mass", "kg", minimum=0.0)
        place = as_array(position, "payload position", (self.dimension,), "m")
        body = self.platform
        total = body.mass + load
        center = (body.mass * body.center_of_mass + load * place) / total
        inertia = (body.inertia + _point_inertia(body.mass, body.center_of_mass - center)
                   + _point_inertia(load, place - center))
        return replace(self, platform=replace(body, mass=total, center_of_mass=center, inertia=inertia))

    def __repr__(self) -> str:
        bases = f", {len(self.bases)} bases" if self.bases else ""
        return f"Robot({self.motion_pattern}, {self.n_cables} cables, {self.mass:g} kg{bases})"

    # --- checks -----------------------------------------------------------------------------------
    def _check_bases(self) -> None:
        if len(self._base_of) != len(self.bases):
            raise InvalidInput("two bases have the same name", ("bases",))
        for k, base in enumerate(self.bases):
            if base.center_of_mass.shape[0] != self.dimension:
                raise InvalidInput(f"center_of_mass must be {self.dimension} numbers [m] in a "
                                   f"{self.motion_pattern} robot", ("bases", k, "center_of_mass"))

    def _check_cables(self) -> None:
        if not self.cables:
            raise InvalidInput("a robot needs at least one cable", ("cables",))
        if self.platform.center_of_mass.shape[0] != self.dimension:
            raise InvalidInput(f"platform vectors must be {self.dimension} numbers in a {self.motion_pattern} robot",
                               ("platform",))
        for i, cable in enumerate(self.cables):
            try:
                self._check_cable(cable)
            except InvalidInput as error:
                raise error.below("cables", i) from None

    def _check_cable(self, cable: Cable) -> None:
        if cable.exit_point.shape[0] != self.dimension:
            raise InvalidInput(f"exit_point must be {self.dimension} numbers [m] in a {self.motion_pattern} robot, "
                               f"got {cable.exit_point.shape[0]}", ("exit_point",))
        if cable.base is not None and cable.base not in self._base_of:
            raise InvalidInput(f"unknown base {cable.base!r}; {_there_are(self._base_of)}", ("base",))
        anchor = cable.anchor_point
        if not self.pattern.turns and anchor.any():
            raise InvalidInput(f"in {self.motion_pattern} all cables meet at P: anchor_point must be "
                               f"{[0] * self.dimension}, got {anchor.tolist()}", ("anchor_point",))
        if self.motion_pattern == "2R3T" and anchor[1:].any():
            raise InvalidInput("in 2R3T all anchor points lie on the platform's x′ axis: anchor_point must be "
                               f"[x, 0, 0], got {anchor.tolist()}", ("anchor_point",))


def inertia_matrix(values: ArrayLike, location: tuple[str | int, ...] = ()) -> Array:
    """(3, 3) from three principal values or six: xx yy zz xy xz yz [kg m²].

    >>> inertia_matrix([1, 2, 3, 0, 0, 0.5])[1]
    array([0. , 2. , 0.5])
    """
    given = as_array(values, "inertia", ("k",), "kg m²", location=location)
    if given.shape[0] not in (3, 6):
        raise InvalidInput("inertia must be 3 numbers (principal) or 6 (xx yy zz xy xz yz) [kg m²], "
                           f"got {given.shape[0]}", location)
    matrix = np.diag(given[:3])
    if given.shape[0] == 6:
        for (row, column), value in zip(((0, 1), (0, 2), (1, 2)), given[3:]):
            matrix[row, column] = matrix[column, row] = value
    return matrix


def _checked_inertia(inertia: ArrayLike, d: int) -> Array:
    if d == 2:
        value = as_array(inertia, "inertia", (), "kg m²", location=("inertia",))
        if value <= 0:
            raise InvalidInput(f"inertia must be positive [kg m²], got {float(value):g}", ("inertia",))
        return value
    matrix = as_array(inertia, "inertia", (3, 3), "kg m²", location=("inertia",))
    if not np.allclose(matrix, matrix.T, rtol=0, atol=1e-9 * np.abs(matrix).max()):
        raise InvalidInput(f"inertia must be symmetric [kg m²], got {matrix.tolist()}", ("inertia",))
    principal = np.linalg.eigvalsh(matrix)
    # A body's principal moments obey the triangle inequality; 1e-9 covers rounding in a parallel-axis shift.
    if principal[0] <= 0 or principal[2] > (principal[0] + principal[1]) * (1 + 1e-9):
        raise InvalidInput("inertia is no rigid body's: principal moments must be positive and none above the sum "
                           f"of the others, got {principal.round(6).tolist()} kg m²", ("inertia",))
    return matrix


def _point_inertia(mass: float, place: Array) -> Array:
    if place.shape[0] == 2:
        return np.asarray(mass * (place @ place))
    return mass * ((place @ place) * np.eye(3) - np.outer(place, place))


def _counter_clockwise(footprint: ArrayLike, d: int) -> Array:
    """The contacts counter-clockwise from the first listed, whichever way round they were given."""
    if np.size(footprint) == 0:
        return frozen(np.zeros((0, 2)))
    points = as_array(footprint, "footprint", ("k", 2), "m", location=("footprint",))
    if d == 2:
        return _planar_contacts(points)
    edges = np.roll(points, -1, axis=0) - points
    following = np.roll(edges, -1, axis=0)
    turns = edges[:, 0] * following[:, 1] - edges[:, 1] * following[:, 0]
    # All corners turn one way, and all the way round once: a star goes round twice.
    around = np.arctan2(turns, (edges * following).sum(axis=-1)).sum()
    if points.shape[0] < 3 or not ((turns > 0).all() or (turns < 0).all()) or abs(around) > 7:
        raise InvalidInput("footprint must be the corners of a convex polygon in order, at least 3 contacts "
                           "and none on an edge", ("footprint",))
    return points if turns[0] > 0 else frozen(np.concatenate([points[:1], points[:0:-1]]))


def _planar_contacts(points: Array) -> Array:
    if points.shape[0] != 2 or points[0, 0] == points[1, 0]:
        raise InvalidInput("a planar footprint is two contacts with different x", ("footprint",))
    return points


def _there_are(names: Mapping[str, int]) -> str:
    return f"there are {', '.join(names)}" if names else "this robot has no bases"
