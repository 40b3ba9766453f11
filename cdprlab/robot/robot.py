"""A whole robot: its parts, arrays over its cables, and changed copies of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_array, frozen, frozen_dataclass
from ..errors import InvalidInput, quoted, under
from .parts import Base, Cable, Elasticity, Platform, Winch
from .pattern import MotionPattern
from .pose import lever

STANDARD_GRAVITY = 9.81


@frozen_dataclass
class Robot:
    """A cable-driven parallel robot: platform, cables, the bases some of them may stand on.

    linear_density : of the cables, for `sagging_lengths` and drawings [kg/m]

    Raises InvalidInput where the parts do not fit: dimension, unknown base, an anchor point the
    motion pattern forbids.

    >>> import cdprlab as cl
    >>> cl.load_world("caroca").robot
    Robot(3R3T, 8 cables, 150 kg)
    """

    pattern: MotionPattern
    platform: Platform
    cables: tuple[Cable, ...]
    bases: tuple[Base, ...] = ()
    gravity: Annotated[float, "[m/s²] ≥ 0"] = STANDARD_GRAVITY
    winch: Winch | None = None
    elasticity: Elasticity | None = None
    linear_density: Annotated[float, "[kg/m] ≥ 0"] = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "cables", tuple(self.cables))
        object.__setattr__(self, "bases", tuple(self.bases))
        if len(self._base_of) != len(self.bases):
            raise InvalidInput("two bases have the same name", ("bases",))
        for k, base in enumerate(self.bases):
            with under("bases", k):
                self._check_size(base.center_of_mass, "center_of_mass")
        if not self.cables:
            raise InvalidInput("a robot needs at least one cable", ("cables",))
        with under("platform"):
            self._check_size(self.platform.center_of_mass, "center_of_mass")
        for i, cable in enumerate(self.cables):
            with under("cables", i):
                self._check_cable(cable)

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
                                else self.base(cable.base).to_world(cable.exit_point)
                                for cable in self.cables]))

    @cached_property
    def base_speed_max(self) -> Array:
        """(3p,) limits of (θ̇, ρ̇₁, ρ̇₂), base after base [rad/s, m/s, m/s]."""
        return frozen(np.array([base.speed_max for base in self.bases]).ravel())

    @cached_property
    def anchor_points(self) -> Array:
        """(m, d) B_i in the platform frame [m]."""
        return self._of_cables("anchor_point")

    @cached_property
    def exit_rotations(self) -> Array:
        """(m, d, d) from the frame of each exit point, that of its base or none, to the world."""
        return frozen(np.array([np.eye(self.dimension) if cable.base is None else self.base(cable.base).rotation
                                for cable in self.cables]))

    @cached_property
    def pulleys(self) -> Array:
        """(m, 1 + d) radius [m] and axis in the world, zeros where a cable has none; (0, 1 + d) where none has."""
        rows = np.zeros((self.n_cables, 1 + self.dimension))
        for row, turn, cable in zip(rows, self.exit_rotations, self.cables):
            if cable.pulley is not None:
                row[0], row[1:] = cable.pulley.radius, turn @ cable.pulley.axis
        return frozen(rows if rows.any() else rows[:0])

    @cached_property
    def tension_min(self) -> Array:
        """(m,) [N]."""
        return self._of_cables("tension_min")

    @cached_property
    def tension_max(self) -> Array:
        """(m,) the smaller of the cable's limit and what the winch gives [N]."""
        return frozen(np.minimum(self._of_cables("tension_max"), getattr(self.winch, "tension_max", np.inf)))

    @cached_property
    def speed_max(self) -> Array:
        """(m,) largest |l̇|, the smaller of the cable's and the winch's [m/s]."""
        return frozen(np.minimum(self._of_cables("speed_max"), getattr(self.winch, "speed_max", np.inf)))

    @cached_property
    def length_offsets(self) -> Array:
        """(m,) what the winches' encoders read, minus the lengths there are [m]."""
        return self._of_cables("length_offset")

    def _of_cables(self, name: str) -> Array:
        return frozen(np.array([getattr(cable, name) for cable in self.cables]))

    @cached_property
    def _base_of(self) -> dict[str, int]:
        return {base.name: k for k, base in enumerate(self.bases)}

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
            known = f"there are {', '.join(self._base_of)}" if self.bases else "this robot has no bases"
            raise InvalidInput(f"unknown base {quoted(name)}; {known}")
        return self.bases[self._base_of[name]]

    # --- changed copies ---------------------------------------------------------------------------
    def with_bases(self, poses: Mapping[str, ArrayLike]) -> Robot:
        """A copy with some bases elsewhere.

        poses : base name → (x, y, heading) [m, m, rad]
        Raises InvalidInput for an unknown base.
        """
        if not poses:
            return self
        moved = dict(zip(self._base_of, self.bases))
        for name, pose in poses.items():
            place = as_array(pose, f"pose of base {quoted(name)}", (3,))
            moved[name] = replace(self.base(name), position=place[:2], heading=place[2])
        return replace(self, bases=tuple(moved.values()))

    def with_payload(self, mass: Annotated[float, "[kg] ≥ 0"], position: ArrayLike) -> Robot:
        """A copy that carries a point mass; mass, center of mass and inertia follow (parallel axes).

        mass : [kg]
        position : (d,) in the platform frame [m]

        >>> import cdprlab as cl
        >>> cl.load_world("caroca").robot.with_payload(50.0, [0, 0, -0.4]).platform.center_of_mass
        array([ 0. ,  0. , -0.1])
        """
        place = as_array(position, "payload position", (self.dimension,), "m")
        body = self.platform
        total = body.mass + mass
        center = (body.mass * body.center_of_mass + mass * place) / total
        # Two points' inertia about what they have in the middle is m₁ m₂ / (m₁ + m₂) times the way between squared.
        turns = lever(place - body.center_of_mass)
        inertia = body.inertia + np.squeeze(body.mass * mass / total * turns.T @ turns)
        return replace(self, platform=replace(body, mass=total, center_of_mass=center, inertia=inertia))

    def __repr__(self) -> str:
        bases = f", {len(self.bases)} bases" if self.bases else ""
        return f"Robot({self.motion_pattern}, {self.n_cables} cables, {self.mass:g} kg{bases})"

    # --- checks -----------------------------------------------------------------------------------
    def _check_size(self, vector: Array, name: str) -> None:
        as_array(vector, f"{name} in a {self.motion_pattern} robot", (self.dimension,), "m", location=(name,))

    def _check_cable(self, cable: Cable) -> None:
        self._check_size(cable.exit_point, "exit_point")
        if self.winch is not None and self.winch.tension_max < cable.tension_min:
            raise InvalidInput(f"the winch gives at most {self.winch.tension_max:.4g} N, less than this cable's "
                               f"smallest tension of {cable.tension_min:g} N", ("tension",))
        if cable.base is not None:
            with under("base"):
                self.base(cable.base)
        anchor = cable.anchor_point
        if not self.pattern.turns and anchor.any():
            raise InvalidInput(f"in {self.motion_pattern} all cables meet at P: anchor_point must be "
                               f"{[0] * self.dimension}, got {anchor.tolist()}",
                               ("anchor_point",))
        if self.motion_pattern == "2R3T" and anchor[1:].any():
            raise InvalidInput("in 2R3T all anchor points lie on the platform's x′ axis: anchor_point must be "
                               f"[x, 0, 0], got {anchor.tolist()}", ("anchor_point",))
