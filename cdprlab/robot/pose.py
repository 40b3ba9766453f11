"""Where the platform is: position and orientation, planar or spatial, single or batched."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_array, common_batch, frozen
from ..errors import InvalidInput


class Pose:
    """Position of the reference point P and rotation of the platform, x_world = position + rotation @ x_platform.

    position : (…, 2) planar or (…, 3) spatial [m]
    rpy : (…, 3) fixed-axis roll, pitch, yaw [rad], R = Rz(yaw) Ry(pitch) Rx(roll); spatial
    angle : (…) counter-clockwise [rad]; planar
    matrix : (…, d, d) rotation matrix
    Give at most one of the three; none means unrotated. Batch axes broadcast.
    Raises InvalidInput for a wrong shape, NaN or a matrix that is no rotation.

    >>> Pose([0.0, 0.0, 1.0], rpy=[0, 0, np.pi / 2]).rotation.round(6)[0]
    array([ 0., -1.,  0.])
    """

    __slots__ = ("position", "rotation")
    position: Array
    rotation: Array

    def __new__(cls, position: ArrayLike, rpy: ArrayLike | None = None, *,
                angle: ArrayLike | None = None, matrix: ArrayLike | None = None) -> Pose:
        place = as_array(position, "position", ("d",), "m", batch=True)
        d = place.shape[-1]
        if d not in (2, 3):
            raise InvalidInput(f"position must be 2 (planar) or 3 (spatial) numbers [m], got {d}")
        if sum(given is not None for given in (rpy, angle, matrix)) > 1:
            raise InvalidInput("a Pose takes one orientation: rpy, angle or matrix, not several of them")
        rotation = _rotation(d, rpy, angle, matrix)
        batch = common_batch(positions=place.shape[:-1], orientations=rotation.shape[:-2])
        return cls.of(np.broadcast_to(place, (*batch, d)), np.broadcast_to(rotation, (*batch, d, d)))

    @classmethod
    def of(cls, position: Array, rotation: Array) -> Pose:
        """A pose from arrays known to be good (no copy, no check): what loops and batches use."""
        pose = object.__new__(cls)
        object.__setattr__(pose, "position", frozen(position.view()))
        object.__setattr__(pose, "rotation", frozen(rotation.view()))
        return pose

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError("a Pose does not change; make a new one")

    @property
    def dimension(self) -> int:
        """2 (planar) or 3 (spatial)."""
        return self.position.shape[-1]

    @property
    def batch_shape(self) -> tuple[int, ...]:
        """() for a single pose."""
        return self.position.shape[:-1]

    @property
    def rpy(self) -> Array:
        """(…, 3) fixed-axis roll, pitch, yaw [rad]; spatial poses only."""
        if self.dimension != 3:
            raise InvalidInput("a planar pose has an angle, no rpy")
        R = np.moveaxis(self.rotation, (-2, -1), (0, 1))
        level = np.hypot(R[2, 1], R[2, 2])
        # Looking straight up or down only roll − yaw or roll + yaw is there to be read: yaw is
        # then 0.
        upright = level < 1e-7
        roll = np.arctan2(np.where(upright, -R[1, 2], R[2, 1]), np.where(upright, R[1, 1], R[2, 2]))
        yaw = np.where(upright, 0.0, np.arctan2(R[1, 0], R[0, 0]))
        return np.stack([roll, np.arctan2(-R[2, 0], level), yaw], axis=-1)

    @property
    def angle(self) -> Any:
        """(…) counter-clockwise angle [rad]; planar poses only."""
        if self.dimension != 2:
            raise InvalidInput("a spatial pose has rpy, no single angle")
        return rotation_vector(self.rotation)[..., 0][()]

    @property
    def orientation(self) -> Array:
        """(…, 3) rpy, or (…, 1) the angle in the plane [rad]."""
        return self.rpy if self.dimension == 3 else rotation_vector(self.rotation)

    def displaced(self, step: Array) -> Pose:
        """p + Δp, exp([Δφ]×) R: moved by (…, 3 planar or 6 spatial) [Δp; Δφ] in world axes [m, rad]."""
        d = self.dimension
        return Pose.of(self.position + step[..., :d], rotation_from_vector(step[..., d:]) @ self.rotation)

    def __len__(self) -> int:
        if not self.batch_shape:
            raise TypeError("a single Pose has no length and no index")
        return self.batch_shape[0]

    def __getitem__(self, index: Any) -> Pose:
        len(self)   # which a single Pose has not
        return Pose.of(self.position[index], self.rotation[index])

    def __iter__(self) -> Iterator[Pose]:
        return map(self.__getitem__, range(len(self)))

    def __eq__(self, other: object) -> bool:
        return (isinstance(other, Pose) and np.array_equal(self.position, other.position)
                and np.array_equal(self.rotation, other.rotation))

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[Any, ...]:
        return Pose.of, (self.position, self.rotation)

    def __repr__(self) -> str:
        if self.batch_shape:
            return f"Pose(batch {self.batch_shape}, {'planar' if self.dimension == 2 else 'spatial'})"
        turn = f"angle={float(self.angle):.6g}" if self.dimension == 2 else f"rpy={_short(self.rpy)}"
        return f"Pose({_short(self.position)}, {turn})"


def rotation_vector(rotation: Array) -> Array:
    """Rotation vector of rotation matrices: R = exp([r]×).

    rotation : (…, 3, 3), or (…, 2, 2) for the planar angle
    Returns (…, 3) [rad], or (…, 1) in the plane.

    >>> rotation_vector(Pose([0, 0], angle=0.3).rotation)
    array([0.3])
    """
    if rotation.shape[-1] == 2:
        return np.arctan2(rotation[..., 1, 0], rotation[..., 0, 0])[..., None]
    return np.stack(turn_about_axes(np.moveaxis(rotation, (-2, -1), (0, 1))), axis=-1)


def turn_about_axes(R: Any) -> tuple[Any, Any, Any]:
    """The three entries of log(R), exact near none and near half a turn: of entries that are numbers or whole batches.

    R : (3, 3, …)

    >>> turn_about_axes(np.eye(3))
    (np.float64(0.0), np.float64(0.0), np.float64(0.0))
    """
    # Four times q qᵀ of the quaternion q = (w, x, y, z): every row is q but for its length and
    # sign.
    w = 1 + R[0, 0] + R[1, 1] + R[2, 2]
    x, y, z = R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]
    xy, xz, yz = R[0, 1] + R[1, 0], R[0, 2] + R[2, 0], R[1, 2] + R[2, 1]
    rows = ((x, 2 + 2 * R[0, 0] - w, xy, xz), (y, xy, 2 + 2 * R[1, 1] - w, yz),
            (z, xz, yz, 2 + 2 * R[2, 2] - w))
    for a, b, c, d in rows:   # the longest row says it best
        longer = a*a + b*b + c*c + d*d > w*w + x*x + y*y + z*z
        shorter = 1 - longer
        w = longer * a + shorter * w
        x = longer * b + shorter * x
        y = longer * c + shorter * y
        z = longer * d + shorter * z
    sine = np.maximum(np.sqrt(x*x + y*y + z*z), 1e-150)
    factor = 2 * np.copysign(np.arctan2(sine, np.abs(w)), w) / sine
    return x * factor, y * factor, z * factor


def turned_to(heading: Array | float, d: int) -> Array:
    """(…, d, d) rotation of what stands on the floor, or in the plane, at this heading (…) [rad].

    >>> turned_to(0.0, 2)
    array([[ 1., -0.],
           [ 0.,  1.]])
    """
    c, s = np.cos(heading), np.sin(heading)
    rotation = np.zeros((*c.shape, d, d))
    rotation[..., -1, -1] = 1.0
    rotation[..., 0, 0] = rotation[..., 1, 1] = c
    rotation[..., 0, 1], rotation[..., 1, 0] = -s, s
    return rotation


def rotation_from_vector(vector: Array) -> Array:
    """Rotation matrices of rotation vectors, R = exp([r]×) = I + [r]× J_l(r).

    vector : (…, 3) [rad], or (…, 1) in the plane
    Returns (…, 3, 3), or (…, 2, 2) in the plane.

    >>> rotation_from_vector(np.array([0.0, 0.0, np.pi])).round(6)[0, 0]
    np.float64(-1.0)
    """
    if vector.shape[-1] == 1:
        return turned_to(vector[..., 0], 2)
    return np.eye(3) + cross_matrix(vector) @ rotation_vector_jacobian(vector)


_CROSSES = np.cross(np.eye(3), np.eye(3)[:, None]).reshape(3, 9)
"""[x]×, [y]× and [z]× of the axes, a row each."""


def cross_matrix(vector: Array) -> Array:
    """[v]× with [v]× w = v × w; 0 in the plane, where all turns are about one axis.

    vector : (…, 3), or (…, 1) in the plane
    Returns (…, 3, 3), or (…, 1, 1).

    >>> cross_matrix(np.array([0.0, 0.0, 1.0])) @ [1.0, 0.0, 0.0]
    array([0., 1., 0.])
    """
    if vector.shape[-1] == 1:
        return np.zeros((*vector.shape, 1))
    return (vector @ _CROSSES).reshape(*vector.shape, 3)


def lever(arm: Array) -> Array:
    """A with φ × r = A φ and r × f = Aᵀ f: [−y, x]ᵀ in the plane, −[r]× in space.

    arm : r (…, d)
    Returns (…, 2, 1) or (…, 3, 3).

    >>> lever(np.array([1.0, 2.0])) @ [0.5]
    array([-1. ,  0.5])
    """
    if arm.shape[-1] == 2:
        return (arm[..., ::-1] * [-1.0, 1.0])[..., None]
    return -cross_matrix(arm)


def cross(arm: Array, force: Array) -> Array:
    """r × f = Aᵀ f with A the `lever` of r: (…, 3) in space, (…, 1) (the z component) in the plane.

    >>> cross(np.array([1.0, 0.0]), np.array([0.0, 2.0]))
    array([2.])
    """
    return np.asarray((np.swapaxes(lever(arm), -1, -2) @ force[..., None])[..., 0])


def rotation_vector_jacobian(vector: Array) -> Array:
    """J_l with ω = J_l(r) ṙ for R = exp([r]×), ω in the axes R maps to.

    J_l = I + (1 − cos θ)/θ² [r]× + (θ − sin θ)/θ³ [r]×², θ = ‖r‖

    vector : (…, 3) [rad], or (…, 1) in the plane
    Returns (…, 3, 3), or (…, 1, 1).
    Source: Chirikjian 2011, Stochastic Models, Information Theory, and Lie Groups 2, eq.
    (10.86).

    >>> rotation_vector_jacobian(np.zeros(3))[0]
    array([1., 0., 0.])
    """
    b, c, *_ = turn_coefficients(np.linalg.norm(vector, axis=-1)[..., None, None])
    k = cross_matrix(vector)
    return np.eye(k.shape[-1]) + b * k + c * (k @ k)


def rotation_vector_jacobian_rate(vector: Array, rate: Array) -> Array:
    """dJ_l/dt of J_l = I + b [r]× + c [r]×², with b, c of the angle θ = ‖r‖ and θ̇ θ = r · ṙ.

    vector, rate : r, ṙ (…, 3) [rad, rad/s], or (…, 1) in the plane
    Returns (…, 3, 3), or (…, 1, 1).

    >>> rotation_vector_jacobian_rate(np.zeros(3), np.array([0.0, 0.0, 2.0]))[1, 0]
    np.float64(1.0)
    """
    b, c, b_slope, c_slope = turn_coefficients(np.linalg.norm(vector, axis=-1)[..., None, None])
    along = (vector * rate).sum(axis=-1)[..., None, None]
    k, k_rate = cross_matrix(vector), cross_matrix(rate)
    return along * (b_slope * k + c_slope * (k @ k)) + b * k_rate + c * (k_rate @ k + k @ k_rate)


def turn_coefficients(angle: Any) -> tuple[Any, Any, Any, Any]:
    """b = (1 − cos θ)/θ², c = (θ − sin θ)/θ³ and (db/dθ)/θ, (dc/dθ)/θ: by series where quotients would cancel.

    angle : θ (…) [rad], numbers or whole batches

    >>> turn_coefficients(np.zeros(1))[0]
    array([0.5])
    """
    # Below 0.05 rad the next term of each series is under 1e-17 of the first.
    small = angle < 0.05
    theta = np.where(small, 1.0, angle)
    square = angle * angle
    b = np.where(small, (1 - square / 12 * (1 - square / 30 * (1 - square / 56))) / 2,
                 (1 - np.cos(theta)) / theta**2)
    c = np.where(small, (1 - square / 20 * (1 - square / 42 * (1 - square / 72))) / 6,
                 (theta - np.sin(theta)) / theta**3)
    small = angle < 1e-2
    theta = np.where(small, 1.0, angle)
    b_slope = np.where(small, -1 / 12 + square / 180, (1 - square * c - 2 * b) / theta**2)
    c_slope = np.where(small, -1 / 60 + square / 1260, (b - 3 * c) / theta**2)
    return b, c, b_slope, c_slope


def _rotation(d: int, rpy: ArrayLike | None, angle: ArrayLike | None, matrix: ArrayLike | None) -> Array:
    if matrix is not None:
        R = as_array(matrix, "matrix", (d, d), batch=True)
        # 1e-6 lets float32 and printed matrices in; anything further off is a mistake, not
        # rounding.
        error = np.abs(np.swapaxes(R, -1, -2) @ R - np.eye(d)).max(initial=0.0)
        if error > 1e-6 or (np.linalg.det(R) < 0).any():
            raise InvalidInput(f"matrix must be a rotation (orthonormal, determinant +1); it is off by {error:.2g}")
        return R
    if d == 2:
        if rpy is not None:
            raise InvalidInput("a planar pose takes angle=, not rpy=", ("rpy",))
        return turned_to(as_array(0.0 if angle is None else angle, "angle", (), "rad", batch=True), 2)
    if angle is not None:
        raise InvalidInput("a spatial pose takes rpy=, not angle=", ("angle",))
    if rpy is None:
        return np.eye(3)
    angles = as_array(rpy, "rpy", (3,), "rad", batch=True)
    Rx, Ry, Rz = np.moveaxis(rotation_from_vector(angles[..., None] * np.eye(3)), -3, 0)
    return Rz @ Ry @ Rx


def _short(values: Array) -> str:
    # + 0.0 turns -0.0 into 0.0
    return "[" + ", ".join(f"{v + 0.0:.6g}" for v in values) + "]"
