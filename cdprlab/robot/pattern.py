"""Motion patterns: which motions of the platform the cables control."""

from typing import NamedTuple

import numpy as np

from ..arrays import Array
from ..errors import InvalidInput, quoted


class MotionPattern(NamedTuple):
    """Which motions the cables control (Verhoeven's classes).

    name : "1T", "2T", "1R2T" (planar), "3T", "2R3T", "3R3T" (spatial)
    dimension : 2 or 3, the space it lives in
    n_dof : number of controlled degrees of freedom, the length of a twist or wrench
    rows : which of the full twist's rows it keeps; in 2R3T the last two are along the
        platform's y′ and z′
    """

    name: str
    dimension: int
    n_dof: int
    rows: tuple[str, ...]

    @property
    def engine(self) -> str:
        """"planar" (pymunk) or "spatial" (PyBullet)."""
        return "planar" if self.dimension == 2 else "spatial"

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
        if self.name != "2R3T":
            return np.eye(3 * (self.dimension - 1), self.n_dof)
        basis = np.zeros((*rotation.shape[:-2], 6, 5))
        basis[..., :3, :3] = np.eye(3)
        basis[..., 3:, 3:] = rotation[..., :, 1:]
        return basis

    def project(self, wrenches: Array, rotation: Array) -> Array:
        """Sᵀ wrenches: of whole wrenches, side by side, the rows that the pattern controls.

        wrenches : (…, 3 or 6, k) in world axes; rotation : (…, d, d)
        Returns (…, n, k).
        """
        if self.name != "2R3T":
            return wrenches[..., :self.n_dof, :]
        return np.swapaxes(self.basis(rotation), -1, -2) @ wrenches


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
        raise InvalidInput(f"unknown motion pattern {quoted(name)}; there are {', '.join(MOTION_PATTERNS)}",
                           ("motion_pattern",))
    return MOTION_PATTERNS[name]
