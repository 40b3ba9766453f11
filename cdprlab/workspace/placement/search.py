"""A pattern search for base poses that serve, where bases must not stand, and what is in the way of the best."""

from operator import itemgetter

import numpy as np

from ...arrays import Array
from ...mechanics.statics import tipping_rows, wrench_matrix
from ...robot import Robot
from ...robot.pose import Pose
from ..capacity import standing_margin
from .program import UNREACHABLE, Duty, worst_margin

Found = tuple[float, Array]
"""The worst margin of a placement, and the placement."""

_VALUE = itemgetter(0)
_SMALLEST_STEP = 0.02
"""[m, rad] Finer than a mobile base is driven."""


class Search:
    """Placements and their values, as changes x of the coordinates in which the bases can drive.

    evaluations : placements tried at most, roughly: a round begun is ended
    """

    def __init__(self, robot: Robot, duty: Duty, evaluations: int) -> None:
        self.robot, self.duty, self.evaluations, self.tried = robot, duty, evaluations, 0
        self.free = np.array([base.speed_max > 0 for base in robot.bases])     # θ, ρ₁, ρ₂ of each
        self.here = np.zeros(self.free.sum())

    def at(self, x: Array) -> Found:
        """The worst margin at a placement, far below 0 where it is blocked, and the placement."""
        self.tried += 1
        placed = self.moved(x)
        blocked = overlap(placed, self.duty.poses)
        return (UNREACHABLE * (1 + blocked) if blocked > 0 else worst_margin(placed, self.duty)[0]), x

    def best(self, demand: float) -> Found:
        """The best placement found, from the most promising start first; ends at one that meets the demand."""
        layouts = [layout[self.free] for layout in _layouts(self.robot, self.duty.poses)]
        starts = sorted(map(self.at, [self.here, *layouts]), key=_VALUE, reverse=True)
        found = starts[0]
        for start in starts:
            if found[0] < demand:
                found = max(found, self.climb(start, demand), key=_VALUE)
        return found

    def climb(self, best: Found, demand: float) -> Found:
        """Pattern search uphill: one coordinate at a time, the step halved where none helps."""
        step = 0.25 * _span(self.robot, self.duty.poses)
        while step > _SMALLEST_STEP and best[0] < demand and self.tried < self.evaluations:
            here = best[0]
            for move in step * np.eye(len(self.here)):
                if best[0] < demand:
                    best = max(best, self.at(best[1] + move), self.at(best[1] - move), key=_VALUE)
            if best[0] <= here + 1e-9:
                step /= 2
        return best

    def moved(self, x: Array) -> Robot:
        """The bases moved from where the robot has them: θ about their own centers, ρ along their present axes."""
        shifts = np.zeros(self.free.shape)
        shifts[self.free] = x
        return self.robot.with_bases({
            base.name: (*(base.position + base.rotation[:2, :2] @ shift[1:]),
                        base.heading + shift[0])
            for base, shift in zip(self.robot.bases, shifts)})


def _layouts(robot: Robot, poses: Pose) -> list[Array]:
    """Moves (p, 3) with which searches begin: over the middle of the poses, narrower, wider, to every side of them."""
    places, wanted = np.array([base.position for base in robot.bases]), poses.position[:, :2]
    center, floor = places.mean(axis=0), np.eye(robot.dimension - 1, 2)
    over = (wanted.min(axis=0) + wanted.max(axis=0)) / 2 - center
    aside = _span(robot, poses) * floor
    layouts = [over + (factor - 1) * (places - center) for factor in (1.0, 0.7, 1.4, 2.0)]
    layouts += [over + way + 0 * places for way in (*aside, *-aside)]
    return [np.array([[0.0, *(base.rotation[:2, :2].T @ (move * floor.sum(axis=0)))]
                      for base, move in zip(robot.bases, layout)])
            for layout in layouts]


def _span(robot: Robot, poses: Pose) -> float:
    """How far apart things are on the floor [m]."""
    floor = robot.dimension - 1
    places = np.vstack([*(base.position[:floor] for base in robot.bases), poses.position[:, :floor]])
    return max(float(np.ptp(places, axis=0).max()), 0.5)


def overlap(robot: Robot, poses: Pose) -> float:
    """How far bases stand in each other, or masts in the platform, as circles seen from above [m]."""
    floor = robot.dimension - 1
    centers = np.array([base.position[:floor] for base in robot.bases])
    radii = np.array([np.linalg.norm(base.footprint, axis=1).max(initial=0.05)
                      for base in robot.bases])
    apart = np.linalg.norm(centers[:, None] - centers, axis=-1) - radii[:, None] - radii
    body = np.linalg.norm(robot.platform.size[:floor]) / 2 + np.linalg.norm(robot.platform.center[:floor])
    masts = robot.exit_points[np.array(robot.base_indices) >= 0, :floor]
    clear = np.linalg.norm(poses.position[:, None, :floor] - masts, axis=-1) - body
    pairs = apart[np.triu_indices(len(centers), 1)]
    return -float(np.concatenate([pairs, clear.ravel()]).min(initial=0.0))


# --- why it found none ------------------------------------------------------------------------------
def why_not_found(robot: Robot, duty: Duty, best: float, demand: float) -> str:
    """The pose and wrench that are worst served there, and the cable or the base that is short."""
    if best <= UNREACHABLE:
        return ("bases would stand in each other or masts in the platform"
                if overlap(robot, duty.poses) > 0
                else "at some pose the cables cannot exert the wrench at all, whatever their tensions")
    i, j = min(np.ndindex(*duty.loads.shape[:2]), key=lambda at: worst_margin(robot, duty.one(*at))[0])
    worst = duty.one(i, j)
    alone, tensions = worst_margin(robot, worst._replace(tipping=False))
    short = f"margin {best:.3g} instead of {demand:g}"
    if best < 0:
        short = _tipping(robot, worst) if alone >= 0 else _pulling(robot, tensions[0, 0], best < alone - 1e-6)
    return f"at the best placement, {duty.named(i, j)}: {short}"


def _pulling(robot: Robot, tensions: Array, tips: bool) -> str:
    cable = int(np.maximum(robot.tension_min - tensions, tensions - robot.tension_max).argmax())
    too = ", and every base must stand" if tips else ""
    return (f"cable {cable + 1} would need {tensions[cable]:.4g} N, allowed {robot.tension_min[cable]:g} to "
            f"{robot.tension_max[cable]:g} N{too}; allow larger tensions, ask for fewer poses, or let more bases drive")


def _tipping(robot: Robot, worst: Duty) -> str:
    """The base that tips most, each asked for alone; or that they tip together only."""
    pose = worst.poses[0]
    W, load = wrench_matrix(robot, pose), worst.loads[0, 0]
    stands = {name: standing_margin(robot, W, load, rows.matrix, -rows.offset)
              for name, rows in tipping_rows(robot, pose).items()}
    name, spare = min(stands.items(), key=itemgetter(1))
    what = (f"base {name!r} tips, a moment of {-spare:.4g} N m too much about an edge of its footprint at least"
            if spare < 0 else "one base or another tips, whichever is relieved")
    return (f"the cables could within their limits, but {what}; let bases weigh more or stand wider, ask for fewer "
            "poses, or ask of the cables alone with tipping=False")
