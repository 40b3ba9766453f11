"""Calibration: where a robot's points really are, from cable lengths at poses that a tracker measured."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, Flags, Indices, as_array, as_number, checked, frozen, lasting
from ..errors import InvalidInput, quoted
from ..robot import Robot
from ..robot.pose import Pose
from .cables import cable_directions, cable_lengths, check_dimension
from .statics import gravity_wrench, wrench_matrix

TOLD = 0.010
"""[m], of the mass 1 %: a direction whose standard deviation is larger is undetermined, and stays as believed."""

NOTHING = 1e3
"""[m] the standard deviation of a direction that the poses say nothing about."""

_PLATFORM = ("mass", "center_of_mass")

Problem = Callable[[Array], tuple[Array, Array]]
"""Unknowns (K,) → what is left (k,), and its slopes (k, K)."""


@lasting
@dataclass(frozen=True, eq=False)
class Calibration:
    """What `calibrate` found: K unknowns in the order asked for, cable after cable, the platform's last.

    robot : with what was found in the place of what was believed
    length_offsets : (m,) what the winches read too much [m]
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
              length_noise: float = 1e-4) -> Calibration:
    """min Σ (l(pose) + offset − l_measured)² over what is unknown of a robot.

    Mass and center of mass then follow from min Σ ‖W⁺ (W τ + w_g)‖², the noise of tensions from
    what is left. Directions that these poses cannot tell are named, and stay as believed.

    robot : as it is believed to be, its bases where they stood
    poses : (N,) as measured; their errors act as errors of the lengths
    lengths : (N, m) read from the winches [m]
    unknown : of "exit_points" (in their base's frame), "anchor_points", "length_offsets",
        "mass", "center_of_mass"
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
    shape, kinds = (len(poses), robot.n_cables), list(unknown)
    measured = as_array(lengths, "lengths", shape, "m")
    noise = as_number(length_noise, "length_noise", "m", positive=True)
    pulls = None if tensions is None else as_array(tensions, "tensions", shape, "N")
    if pulls is not None and not {*kinds} & {*_PLATFORM}:
        kinds += _PLATFORM
    places, names = _chosen(robot, kinds)
    sought = np.isin(_PLATFORM, kinds).repeat([1, robot.dimension])
    if sought.any() and pulls is None:
        raise InvalidInput("mass and center_of_mass follow from tensions at rest: give tensions, (N, m) [N]")
    table = _table(robot)

    def too_long(x: Array) -> tuple[Array, Array]:
        table.flat[places] = x
        changed = _rebuilt(robot, table)
        return ((cable_lengths(changed, poses) + table[:, -1] - measured).ravel(),
                length_slopes(changed, poses).reshape(measured.size, -1)[:, places])

    x, covariance, ways = _fit(too_long, table.flat[places], noise)
    left, values, undetermined = -too_long(x)[0], x, _in_words(ways, covariance, names)
    found = _rebuilt(robot, table)
    if pulls is not None and sought.any():
        body = np.concatenate([[1.0], robot.platform.center_of_mass])   # 1 % of the mass counts as 10 mm
        heavy = _too_heavy(found, poses, pulls, body, sought)
        # First as if every newton told; what is then left says how large their noise is.
        unbalanced = heavy(_fit(heavy, body[sought], 0.0)[0])[0]
        freedom = max(int(np.linalg.matrix_rank(wrench_matrix(found, poses)).sum()) - int(sought.sum()), 1)
        y, more, ways = _fit(heavy, body[sought], float(np.linalg.norm(unbalanced)) / np.sqrt(freedom))
        undetermined += _in_words(ways, more, names[x.size:])
        kilograms = np.where(np.array(names[x.size:]) == "mass", robot.mass, 1.0)
        values = np.concatenate([x, y * kilograms])
        covariance = block_diag(covariance, more * np.outer(kilograms, kilograms))
        body[sought] = y
        found = replace(found, platform=replace(robot.platform, mass=robot.mass * body[0], center_of_mass=body[1:]))
    return Calibration(found, frozen(table[:, -1].copy()), dict(zip(names, values.tolist())), frozen(covariance),
                       frozen(left.reshape(shape)), tuple(undetermined))


def length_slopes(robot: Robot, poses: Pose) -> Array:
    """∂l/∂A = u, ∂l/∂b = −Rᵀ u, ∂l/∂offset = 1.

    Returns (N, m, m (2 d + 1)): cable after cable its exit point in its base's frame, anchor
    point, offset.

    >>> import cdprlab as cl
    >>> length_slopes(cl.load_world("caroca").robot, cl.Pose([[0, 0, 1]])).shape
    (1, 8, 56)
    """
    u = cable_directions(robot, poses)
    exits = u.copy()
    for i, base in enumerate(robot.base_indices):
        if base >= 0:
            exits[:, i] = u[:, i] @ robot.bases[base].rotation
    own = np.concatenate([exits, -u @ poses.rotation, np.ones((*u.shape[:2], 1))], axis=-1)
    return (own[:, :, None] * np.eye(robot.n_cables)[:, :, None]).reshape(*u.shape[:2], -1)


def _table(robot: Robot) -> Array:
    """(m, 2 d + 1): what is believed of each cable, as `length_slopes` orders it."""
    return np.array([[*cable.exit_point, *cable.anchor_point, 0.0] for cable in robot.cables])


def _rebuilt(robot: Robot, table: Array) -> Robot:
    d = robot.dimension
    return replace(robot, cables=tuple(replace(cable, exit_point=row[:d], anchor_point=row[d:2 * d])
                                       for cable, row in zip(robot.cables, table)))


def _chosen(robot: Robot, kinds: list[str]) -> tuple[Indices, list[str]]:
    """Places of the unknowns in the table, and the names of all of them, the platform's last."""
    axes, turns = "xyz"[:robot.dimension], len(robot.pattern.turn_axes)
    turning = axes[:1] if turns == 2 else axes * bool(turns)   # 2R3T's anchor points lie on x′, those of 3T at P
    labels = [*(("exit_points", f" {axis}") for axis in axes), *(("anchor_points", f" {axis}") for axis in axes),
              ("length_offsets", "")]
    known = {*dict(labels), *_PLATFORM}
    if not kinds or len({*kinds}) < len(kinds) or not {*kinds} <= known:
        raise InvalidInput(f"unknown must be some of {', '.join(sorted(known))}, each once, got {quoted(kinds)}")
    places, names = [], []
    for kind in kinds:
        here = [(i, k, axis) for i in range(robot.n_cables) for k, (label, axis) in enumerate(labels)
                if label == kind and (kind != "anchor_points" or axis[1] in turning)]
        if not here and kind not in _PLATFORM:
            raise InvalidInput(f"{kind} cannot be unknown: this {robot.motion_pattern} robot has none")
        places += [i * len(labels) + k for i, k, _ in here]
        names += [f"{kind} {i + 1}{axis}" for i, _, axis in here]
    names += [name for name in ("mass", *(f"center_of_mass {axis}" for axis in axes)) if name.split()[0] in kinds]
    return np.array(places, dtype=int), names


def _too_heavy(robot: Robot, poses: Pose, tensions: Array, body: Array, sought: Flags) -> Problem:
    """W⁺ (W τ + w_g) [N], least squares of tensions; ``sought`` of body: mass over that believed, center of mass."""
    W, d = wrench_matrix(robot, poses), robot.dimension
    inverse = np.linalg.pinv(W, rcond=1e-9)
    held = (inverse @ W @ tensions[..., None]).ravel()
    one = [replace(robot.platform, center_of_mass=center) for center in np.eye(d + 1)[:, 1:]]
    weights = np.stack([gravity_wrench(replace(robot, platform=platform), poses) for platform in one], axis=-1)
    per = (inverse @ weights).reshape(held.size, -1)
    per[:, 1:] -= per[:, :1]   # per mass, and per mass times each coordinate

    def heavy(y: Array) -> tuple[Array, Array]:
        body[sought] = y
        mass, *center = body
        whole = per @ [1.0, *center]
        return held + mass * whole, np.column_stack([whole, mass * per[:, 1:]])[:, sought]

    return heavy


def _fit(problem: Problem, start: Array, noise: float) -> tuple[Array, Array, Array]:
    """Least squares along the directions that are told; x (K,), covariance (K, K), what is not told (q, K)."""
    from scipy.optimize import least_squares

    ways, deviations = _directions(problem(start)[1], noise)
    along, x = ways[deviations <= TOLD].T, start
    if along.size:
        tight = 4 * np.finfo(float).eps
        x = start + along @ least_squares(lambda z: problem(start + along @ z)[0], np.zeros(along.shape[1]),
                                          lambda z: problem(start + along @ z)[1] @ along,
                                          xtol=tight, ftol=tight, gtol=tight).x
    ways, deviations = _directions(problem(x)[1], noise)
    return x, (ways.T * deviations**2) @ ways, ways[deviations > TOLD]


def _directions(J: Array, noise: float) -> tuple[Array, Array]:
    """(K, K) directions of the unknowns, a row each, and the standard deviation (K,) of each."""
    s, ways = np.linalg.svd(np.pad(J, ((0, J.shape[1]), (0, 0))), full_matrices=False)[1:]
    told = np.maximum(s, 1e-12 * s.max(initial=1e-300))   # what is below is rounding
    return ways, np.minimum(np.where(s < told, NOTHING, noise / told), NOTHING)


def _in_words(ways: Array, covariance: Array, names: list[str]) -> list[str]:
    """Directions (q, K) that span the same as these, each of few names, with its standard deviation."""
    projector, told = ways.T @ ways, []
    for _ in ways:
        way = projector[np.diag(projector).argmax()]
        way = way / np.linalg.norm(way)
        projector = projector - np.outer(way, way)
        terms = [f"{share:+.2f} {name}" for share, name in zip(way, names) if abs(share) > 0.1]
        told.append(f"{' '.join(terms)} (standard deviation {np.sqrt(way @ covariance @ way):.2g})")
    return told
