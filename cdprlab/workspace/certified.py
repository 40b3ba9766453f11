"""Certified workspaces: boxes of poses that are inside or outside beyond doubt, and what is left between them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, Flags, Progress, as_array, as_number, lasting
from ..errors import InvalidInput
from ..mechanics.cables import cable_lengths
from ..mechanics.intervals import Intervals
from ..mechanics.statics import gravity_wrench, wrench_matrix
from ..robot import Robot
from ..robot.pose import Pose
from .capacity import best_tensions, capacity_margins, external_wrenches
from .interval_statics import PoseBoxes, certainly_inside, certainly_outside

_MOST_BOXES, _CHUNK = 2_000_000, 4096


@lasting
@dataclass(frozen=True, eq=False)
class CertifiedWorkspace:
    """Boxes over (x, y), (x, y, z) or, with an angle, (x, y, φ); together they fill what was asked for.

    lower, upper : (N, k) corners [m, rad]
    verdict : (N,) 1 certainly inside, −1 certainly outside, 0 undecided
    varying : (k,) axes along which boxes have a size; the others are held
    """

    lower: Array
    upper: Array
    verdict: Array
    varying: Flags

    @property
    def inside(self) -> Array:
        """(N, 2, k) boxes certainly inside."""
        return self._boxes(1)

    @property
    def outside(self) -> Array:
        """(N, 2, k) boxes certainly outside."""
        return self._boxes(-1)

    @property
    def undecided(self) -> Array:
        """(N, 2, k) boxes neither proof settled at the resolution asked for."""
        return self._boxes(0)

    @property
    def bounds(self) -> tuple[float, float]:
        """The true length, area or volume lies between these [m, m², m³, times rad with an angle]."""
        sizes = np.prod((self.upper - self.lower)[:, self.varying], axis=1)
        least = float(sizes[self.verdict == 1].sum())
        return least, least + float(sizes[self.verdict == 0].sum())

    def verdict_at(self, points: ArrayLike) -> Array:
        """(…) 1, −1 or 0 for points (…, k): the verdict of a box they lie in, 0 beyond all boxes."""
        x = as_array(points, "points", (self.lower.shape[1],), batch=True)
        found = np.zeros(x.shape[:-1])
        for index in np.ndindex(found.shape):
            within = ((self.lower <= x[index]) & (x[index] <= self.upper)).all(axis=1)
            found[index] = self.verdict[within].sum()   # neighbors never contradict each other
        return np.sign(found)

    def _boxes(self, verdict: int) -> Array:
        chosen = self.verdict == verdict
        return np.stack([self.lower[chosen], self.upper[chosen]], axis=1)


def certify(robot: Robot, lower: ArrayLike, upper: ArrayLike, *, resolution: float = 0.05,
            rpy: ArrayLike | None = None, angle: float = 0.0, wrenches: ArrayLike | None = None,
            progress: Progress | None = None) -> CertifiedWorkspace:
    """Wrench feasibility under the weight, proven box by box with intervals rounded outward (branch and bound).

    Inside: tensions that follow the pose are proven to balance the wrench within the limits all
    over the box. Outside: one hyperplane separates the wrench from all that the cables can do,
    all over the box. Robot and limits are taken as given, in floating point, and not one newton
    is forgiven.

    lower, upper : (d,) corners [m]; in the plane (x, y, φ) as well [m, rad]; equal ends hold an
        axis
    resolution : boxes that are neither are halved down to this size [m; rad for φ]
    rpy, angle : the orientation where it is held [rad]
    wrenches : (k, n) or (n,) external wrenches besides the weight; inside needs all of them
        [N, N m]
    progress : called with (share decided in percent, 100)
    Raises InvalidInput for a 2R3T robot, one with pulleys, or where the boxes get too many.
    Source: Gouttefarde, Daney and Merlet 2011 (interval-analysis-based determination of the
    wrench-feasible workspace); the proofs are chosen anew.

    >>> import cdprlab as cl
    >>> found = certify(cl.load_world("planar_point").robot, [-0.5, 0.5], [0.5, 1.5], resolution=0.2)
    >>> found.bounds[0] <= found.bounds[1] <= 1.0
    True
    """
    low, high = _domain(robot, lower, upper, angle)
    least = as_number(resolution, "resolution", "m", positive=True)
    loads, rotation = external_wrenches(wrenches, robot.n_dof), Pose(np.zeros(robot.dimension), rpy).rotation
    varying = np.asarray(high > low)
    kept: list[tuple[Array, Array, Array]] = []
    boxes, total, decided = (low[None], high[None]), float(np.prod((high - low)[varying])), 0.0
    while len(boxes[0]):
        verdict = np.concatenate([_verdicts(robot, boxes[0][k:k + _CHUNK],
                                            boxes[1][k:k + _CHUNK], rotation, loads)
                                  for k in range(0, len(boxes[0]), _CHUNK)])
        small = ((boxes[1] - boxes[0]) <= least * (1 + 1e-9)).all(axis=1)
        done = (verdict != 0) | small
        kept.append((boxes[0][done], boxes[1][done], verdict[done]))
        decided += float(np.prod((boxes[1] - boxes[0])[done][:, varying], axis=1).sum())
        boxes = _halved(boxes[0][~done], boxes[1][~done])
        if len(boxes[0]) + sum(len(part[0]) for part in kept) > _MOST_BOXES:
            raise InvalidInput(f"more than {_MOST_BOXES} boxes at a resolution of {least:g} m: ask for a coarser one")
        if progress is not None:
            progress(min(100, round(100 * decided / total)), 100)
    a, b, found = (np.concatenate(parts) for parts in zip(*kept))
    return CertifiedWorkspace(a, b, found, varying)


def _verdicts(robot: Robot, low: Array, high: Array, rotation: Array, loads: Array) -> Array:
    """(N,) 1, −1 or 0: inside for all loads, outside for one."""
    d = robot.dimension
    middle, position = (low + high) / 2, Intervals(low[:, :d], high[:, :d])
    if d == 2:
        boxes = PoseBoxes(robot, position, Intervals(low[:, 2], high[:, 2]))
        poses = Pose(middle[:, :2], angle=middle[:, 2])
    else:
        boxes, poses = PoseBoxes(robot, position, rotation), Pose(middle, matrix=rotation)
    lengths = cable_lengths(robot, poses)
    sound = lengths.all(axis=1)
    if not sound.all():   # an exit point in the very middle: such a box is halved
        verdict = np.zeros(len(low))
        if sound.any():
            verdict[sound] = _verdicts(robot, low[sound], high[sound], rotation, loads)
        return verdict
    W, weight = wrench_matrix(robot, poses), np.broadcast_to(gravity_wrench(robot, poses),
                                                             (len(low), robot.n_dof))
    inside, outside = np.ones(len(low), dtype=bool), np.zeros(len(low), dtype=bool)
    for load in loads:
        s, tau = best_tensions(W, weight + load, robot.tension_min, robot.tension_max)
        good, bad = s > 0, (s < 0) & ~outside
        inside &= good
        if good.any():
            inside[good] &= certainly_inside(boxes[good], load, W[good], tau[good],
                                             lengths[good])
        if bad.any():
            normal = capacity_margins(W[bad], weight[bad], load[None], np.zeros(robot.n_dof),
                                      robot.tension_min,
                                      robot.tension_max)[1]
            outside[bad] = certainly_outside(boxes[bad], load, normal)
    return inside.astype(float) - outside


def _domain(robot: Robot, lower: ArrayLike, upper: ArrayLike, angle: float) -> tuple[Array, Array]:
    """Corners over all axes, the angle's among them in the plane."""
    if robot.motion_pattern == "2R3T":
        raise InvalidInput("a 2R3T robot's wrench turns with its rod: only the other motion patterns can be certified")
    d = robot.dimension
    low = as_array(lower, "lower", ("k",), "m")
    high = as_array(upper, "upper", low.shape, "m")
    if low.size not in (d, 3):
        raise InvalidInput(f"lower must be {d} numbers [m]{', or x, y and angle' if d == 2 else ''}, got {low.size}")
    if (low > high).any() or not (high > low).any():
        raise InvalidInput(f"lower and upper must be corners, lower first, and apart, got {low.tolist()} and "
                           f"{high.tolist()}")
    if low.size < 3:
        low, high = np.append(low, angle), np.append(high, angle)
    return low, high


def _halved(low: Array, high: Array) -> tuple[Array, Array]:
    """Across their longest edge."""
    rows, longest = np.arange(len(low)), (high - low).argmax(axis=1)
    middle = (low[rows, longest] + high[rows, longest]) / 2
    first, second = high.copy(), low.copy()
    first[rows, longest] = second[rows, longest] = middle
    return np.concatenate([low, second]), np.concatenate([first, high])
