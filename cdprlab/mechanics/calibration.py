"""Calibration: where a robot's points really are, from cable lengths at poses that a tracker measured."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_array, checked, frozen, frozen_dataclass
from ..errors import InvalidInput, quoted
from ..robot import Robot
from ..robot.pose import Pose
from .cables import cable_lengths, cables_at, check_dimension, exits_from_anchors
from .optimization import least_squares
from .statics import gravity_wrench, wrench_matrix

TOLD = 0.010
"""[m], of the mass 1 %: a direction whose standard deviation is larger is undetermined, and stays as believed."""

NOTHING = 1e3
"""[m] the standard deviation of a direction that the poses say nothing about."""

_CABLE = ("exit_points", "anchor_points", "length_offsets", "pulley_radius")
_PLATFORM = ("mass", "center_of_mass")

Problem = Callable[[Array], tuple[Array, Array]]
"""Unknowns (K,) → what is left (k,), and its slopes (k, K)."""


@frozen_dataclass
class Calibration:
    """What `calibrate` found: K unknowns in the order asked for, cable after cable, the platform's last.

    robot : with what was found in the place of what was believed
    length_offsets : (m,) what the winches read too much, as the robot has them [m]
    estimates : name of each unknown → its value [m, kg]
    covariance : (K, K) of them [m², kg²]; 1000² where the poses say nothing
    residual : (N, m) measured − computed lengths [m]
    undetermined : directions with a standard deviation above 10 mm, of the mass 1 %, in words
    """

    robot: Robot
    length_offsets: Array
    estimates: dict[str, float]
    covariance: Array
    residual: Array
    undetermined: tuple[str, ...]

    def __repr__(self) -> str:
        left = 1e3 * np.sqrt(np.mean(self.residual**2))
        return (f"Calibration({len(self.estimates)} unknowns from {len(self.residual)} poses, {left:.3g} mm RMS left, "
                f"{len(self.undetermined)} directions undetermined)")


@checked
def calibrate(robot: Robot, poses: Pose, lengths: ArrayLike,
              unknown: Sequence[str] = ("exit_points", "length_offsets"), tensions: ArrayLike | None = None,
              length_noise: Annotated[float, "[m] > 0"] = 1e-4) -> Calibration:
    """min Σ (l(pose) + offset − l_measured)² over what is unknown of a robot.

    Mass and center of mass then follow from min Σ ‖W⁺ (W τ + w_g)‖², the noise of tensions from
    what is left. Directions that these poses cannot tell are named, and stay as believed.

    robot : as it is believed to be, its bases where they stood
    poses : (N,) as measured; their errors act as errors of the lengths
    lengths : (N, m) read from the winches [m]
    unknown : of "exit_points" (in their base's frame), "anchor_points", "length_offsets",
        "pulley_radius" (of each there is), "mass", "center_of_mass"
    tensions : (N, m) at rest [N]; both of the last two are found if unknown names neither
    length_noise : standard deviation of a length [m]
    Raises InvalidInput.
    Source: Borgstrom et al. 2009 (NIMS-PL); Merlet 2006, Parallel Robots, ch. 10.

    >>> import cdprlab as cl
    >>> robot = cl.load_world("caroca").robot
    >>> poses = cl.Pose([[0, 0, 1], [1, 0, 2], [0, 1, 2]])
    >>> found = calibrate(robot, poses, cl.cable_lengths(robot, poses) + 0.02, ["length_offsets"])
    >>> found.length_offsets.round(6)[:2]
    array([0.02, 0.02])
    """
    from scipy.linalg import block_diag

    check_dimension(robot, poses)
    if len(poses.batch_shape) != 1 or not len(poses):
        raise InvalidInput(f"poses must be a batch (N,) of at least one pose, got shape {poses.batch_shape}")
    as_array([poses.position, *np.moveaxis(poses.rotation, -1, 0)], "poses", ("k", "N", "d"))
    shape, kinds = (len(poses), robot.n_cables), list(unknown)
    measured = as_array(lengths, "lengths", shape, "m")
    pulls = None if tensions is None else as_array(tensions, "tensions", shape, "N")
    if pulls is not None and not {*kinds} & {*_PLATFORM}:
        kinds += _PLATFORM
    # What is believed of each cable, as `length_slopes` orders it; radius 0 without pulley.
    table = np.array([[*cable.exit_point, *cable.anchor_point, cable.length_offset,
                       cable.pulley.radius if cable.pulley else 0.0] for cable in robot.cables])
    places, names = _chosen(robot, kinds)
    own = [k for k in places if k < table.size]
    sought = [k - table.size for k in places[len(own):]]
    if pulls is None and sought:
        raise InvalidInput("mass and center_of_mass follow from tensions at rest: give tensions, (N, m) [N]")

    def too_long(x: Array) -> tuple[Array, Array]:
        table.flat[own] = x
        changed = _rebuilt(robot, table)
        return ((cable_lengths(changed, poses) + table[:, -2] - measured).ravel(),
                length_slopes(changed, poses).reshape(measured.size, -1)[:, own])

    x, covariance, told = _fit(too_long, table.flat[own], length_noise, names)
    left, found = -too_long(x)[0], _rebuilt(robot, table)
    if pulls is not None:
        body = np.append(1.0, robot.platform.center_of_mass)   # 1 % of the mass counts as 10 mm
        heavy = _too_heavy(found, poses, pulls, body, sought)
        # First as if every newton told; what is then left says how large their noise is.
        unbalanced = heavy(_fit(heavy, body[sought], 0.0, names)[0])[0]
        freedom = np.linalg.matrix_rank(wrench_matrix(found, poses)).sum() - len(sought)
        pull_noise = np.linalg.norm(unbalanced) / np.sqrt(max(freedom, 1))
        y, more, untold = _fit(heavy, body[sought], pull_noise, names[x.size:])
        body[sought] = y
        found = replace(found, platform=replace(robot.platform, mass=robot.mass * body[0], center_of_mass=body[1:]))
        scale = np.append(robot.mass, np.ones(robot.dimension))[sought]
        x = np.append(x, scale * y)
        covariance = block_diag(covariance, more * np.outer(scale, scale))
        told += untold
    return Calibration(found, found.length_offsets, dict(zip(names, x.tolist())), frozen(covariance),
                       frozen(left.reshape(shape)), told)


def length_slopes(robot: Robot, poses: Pose) -> Array:
    """∂l/∂A = u, ∂l/∂b = −Rᵀ u, ∂l/∂offset = 1, ∂l/∂r = (l − u · (A − B)) / r, as l of A − B and r is homogeneous.

    Returns (N, m, m (2 d + 2)): cable after cable its exit point in its base's frame, anchor
    point, offset, radius of its pulley.

    >>> import cdprlab as cl
    >>> length_slopes(cl.load_world("caroca").robot, cl.Pose([[0, 0, 1]])).shape
    (1, 8, 64)
    """
    u, lengths, _ = cables_at(robot, poses)
    exits = (u[:, :, None] @ robot.exit_rotations)[:, :, 0]
    along = (u * exits_from_anchors(robot, poses)).sum(axis=-1)
    radii = [cable.pulley.radius if cable.pulley else np.inf for cable in robot.cables]
    own = np.concatenate([exits, -u @ poses.rotation, np.stack([np.ones_like(lengths), (lengths - along) / radii],
                                                               axis=-1)], axis=-1)
    return (own[:, :, None] * np.eye(robot.n_cables)[:, :, None]).reshape(*lengths.shape, -1)


def _rebuilt(robot: Robot, table: Array) -> Robot:
    d = robot.dimension
    return replace(robot, cables=tuple(replace(
        cable, exit_point=row[:d], anchor_point=row[d:2 * d], length_offset=row[-2],
        # A step of the search may pass zero.
        pulley=cable.pulley and replace(cable.pulley, radius=max(row[-1], 1e-6)))
                                       for cable, row in zip(robot.cables, table)))


def _chosen(robot: Robot, kinds: list[str]) -> tuple[list[int], list[str]]:
    """Places of the unknowns in the table, and after it in the platform's mass and center; and their names."""
    if not kinds or len({*kinds}) < len(kinds) or not {*kinds} <= {*_CABLE, *_PLATFORM}:
        raise InvalidInput(f"unknown must be some of {', '.join(_CABLE + _PLATFORM)}, each once, got {quoted(kinds)}")
    if "anchor_points" in kinds and not robot.pattern.turns:
        raise InvalidInput(f"in {robot.motion_pattern} all cables meet at P: anchor_points cannot be unknown")
    if "pulley_radius" in kinds and not robot.pulleys.size:
        raise InvalidInput("no cable of this robot leaves over a pulley: pulley_radius cannot be unknown")
    axes, names = "xyz"[:robot.dimension], []
    for i, cable in enumerate(robot.cables, 1):
        names += [f"exit_points {i} {axis}" for axis in axes]
        names += [f"anchor_points {i} {axis}" for axis in axes]
        if robot.motion_pattern == "2R3T":   # they stay on the x′ axis
            names[-2:] = "", ""
        names += [f"length_offsets {i}", f"pulley_radius {i}" if cable.pulley else ""]
    names += ["mass", *(f"center_of_mass {axis}" for axis in axes)]
    places = [k for kind in sorted(kinds, key=_PLATFORM.__contains__) for k, name in enumerate(names)
              if name.startswith(kind)]
    return places, [names[k] for k in places]


def _too_heavy(robot: Robot, poses: Pose, tensions: Array, body: Array, sought: list[int]) -> Problem:
    """W⁺ (W τ + w_g) [N], least squares of tensions; ``sought`` of body: mass over that believed, center of mass."""
    W = wrench_matrix(robot, poses)
    inverse = np.linalg.pinv(W, rcond=1e-9)
    held = (inverse @ W @ tensions[..., None]).ravel()
    weights = [gravity_wrench(
        replace(robot, platform=replace(robot.platform, center_of_mass=center)), poses)
               for center in np.eye(len(body))[:, 1:]]
    per = (inverse @ np.stack(weights, axis=-1)).reshape(held.size, -1)
    per[:, 1:] -= per[:, :1]   # per mass, and per mass times each coordinate

    def heavy(y: Array) -> tuple[Array, Array]:
        body[sought] = y
        whole = per @ [1.0, *body[1:]]
        return held + body[0] * whole, np.column_stack([whole, body[0] * per[:, 1:]])[:, sought]

    return heavy


def _fit(problem: Problem, start: Array, noise: float,
         names: Sequence[str]) -> tuple[Array, Array, tuple[str, ...]]:
    """Least squares along what is told; returns x (K,), its covariance (K, K), and in words what is not told."""
    ways, deviations = _directions(problem(start)[1], noise)
    along, x = ways[deviations <= TOLD].T, start
    if along.size:
        x = start + along @ least_squares(lambda z: problem(start + along @ z)[0], np.zeros(along.shape[1]),
                                          lambda z: problem(start + along @ z)[1] @ along)
    ways, deviations = _directions(problem(x)[1], noise)
    covariance = (ways.T * deviations**2) @ ways
    words, untold = [], ways[deviations > TOLD]
    projector = untold.T @ untold
    for _ in untold:   # directions that span the same, each of few unknowns
        way = projector[np.diag(projector).argmax()]
        way = way / np.linalg.norm(way)
        projector = projector - np.outer(way, way)
        shares = [f"{share:+.2f} {name}" for share, name in zip(way, names) if abs(share) > 0.1]
        words.append(f"{' '.join(shares)} (standard deviation {np.sqrt(way @ covariance @ way):.2g})")
    return x, covariance, tuple(words)


def _directions(J: Array, noise: float) -> tuple[Array, Array]:
    """(K, K) directions of the unknowns, a row each, and the standard deviation (K,) of each."""
    s, ways = np.linalg.svd(np.pad(J, ((0, J.shape[1]), (0, 0))), full_matrices=False)[1:]
    rounding = 1e-12 * s.max(initial=1e-300)
    return ways, np.where(s > rounding, np.minimum(noise / np.maximum(s, rounding), NOTHING), NOTHING)
