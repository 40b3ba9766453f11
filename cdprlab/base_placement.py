"""Where mobile bases must stand so that the cables can do what is wanted at every wanted pose."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from .arrays import Array, as_array
from .errors import InvalidInput, NoPlacement
from .pose import Pose
from .robot import Robot
from .statics import wrench_matrix

_SMALLEST_STEP = 0.02
"""[m, rad] Finer than a mobile base is driven."""

_BLOCKED = -1e3
"""Value of a placement in which something stands in something else; above it, the smaller overlap is better."""


def place_bases(robot: Robot, poses: Pose, wrenches: ArrayLike, *, margin: float = 0.0,
                evaluations: int = 300) -> Robot:
    """Base poses for which tensions within the limits balance every wrench at every pose.

    Found by a pattern search over the directions in which the bases can drive (speed limit above 0), from their
    present poses and from layouts around the wanted ones. It maximizes the worst margin s, one linear program a
    placement: max s with W τ + w_e = 0 and τ_min + s h ≤ τ ≤ τ_max − s h at all poses, h half the range of each
    cable. Bases keep clear of each other, and masts of the platform. A placement found does serve; the search is
    no proof that there is none.

    robot : with mobile bases; returned as it is where its bases serve already
    poses : single or a batch (N,) of platform poses
    wrenches : (n,), (k, n) or (N, k, n) external wrenches w_e, gravity included: each of the k at each pose [N, N m]
    margin : smallest s asked for, 0 to 1
    evaluations : placements tried at most
    Returns the robot with its bases moved.
    Raises NoPlacement with the pose, and the wrench and cable or the height, that stand in the way; InvalidInput for
    a robot without bases that can drive.
    Source: the search is this project's; the task is that of Pedemonte et al. 2020, abstract and section 4.

    >>> import cdprlab as cl
    >>> world = cl.load_world("planar_mcdpr")
    >>> far = cl.Pose([[2.6, 1.2], [3.2, 1.4]])
    >>> weight = cl.gravity_wrench(world.robot, world.pose)
    >>> moved = place_bases(world.robot, far, weight)
    >>> bool(cl.distribute_tensions(cl.wrench_matrix(moved, far), weight, 1, 100).feasible.all())
    True
    """
    directions = _directions(robot)
    wanted, loads = _checked(robot, poses, wrenches)
    if not 0 <= margin <= 1:
        raise InvalidInput(f"margin must be between 0 and 1, got {margin!r}")
    beyond = _beyond_any_placement(robot, wanted, loads)
    if beyond:
        raise NoPlacement(f"no base poses can serve every pose: {beyond}", robot)
    search = _Search(robot, wanted, loads, directions, evaluations)
    value, x = search.value(np.zeros(len(directions))), np.zeros(len(directions))
    if value < margin:
        value, x = search.best(margin)
    moved = _moved(robot, directions, x) if x.any() else robot
    if value < margin:
        raise NoPlacement(_reason(moved, wanted, loads, value, margin), moved)
    return moved


class _Direction(NamedTuple):
    """One coordinate that may change: which base, and 0 θ, 1 ρ₁ or 2 ρ₂."""

    base: int
    axis: int


class _Search:
    """Placements and their values, each worked out once."""

    def __init__(self, robot: Robot, poses: Pose, loads: Array, directions: list[_Direction], evaluations: int) -> None:
        self.robot, self.poses, self.loads, self.directions = robot, poses, loads, directions
        self.left = evaluations

    def value(self, x: Array) -> float:
        """The worst margin at a placement x of the free coordinates; far below 0 where it is blocked."""
        self.left -= 1
        placed = _moved(self.robot, self.directions, x)
        overlap = _overlap(placed, self.poses)
        if overlap > 0:
            return _BLOCKED * (1 + overlap)
        return _worst_margin(placed, self.poses, self.loads)

    def best(self, demand: float) -> tuple[float, Array]:
        """The best placement found, from the most promising start first; ends at one that meets the demand."""
        starts = _starts(self.robot, self.poses, self.directions)
        values = [self.value(start) for start in starts]
        found = (-np.inf, starts[0])
        for i in np.argsort(values)[::-1]:
            if found[0] < demand:
                found = max(found, self.climb(starts[i], values[i], demand), key=lambda end: end[0])
        return found

    def climb(self, start: Array, value: float, demand: float) -> tuple[float, Array]:
        """Pattern search uphill: one coordinate at a time, the step halved where none helps."""
        x, best = start, value
        step = 0.25 * _span(self.robot, self.poses)
        while step > _SMALLEST_STEP and best < demand and self.left > 0:
            here = best
            for move in step * np.eye(len(x)):
                x, best = max(((x, best), *((there, self.value(there)) for there in (x + move, x - move))),
                              key=lambda end: end[1])
                if best >= demand:
                    break
            if best <= here + 1e-9:
                step /= 2
        return best, x


def _directions(robot: Robot) -> list[_Direction]:
    free = [_Direction(k, axis) for k, base in enumerate(robot.bases) for axis in range(3) if base.speed_max[axis] > 0]
    if not free:
        raise InvalidInput("this robot has no base that can drive: every speed limit is 0" if robot.bases
                           else "this robot has no bases")
    return free


def _checked(robot: Robot, poses: Pose, wrenches: ArrayLike) -> tuple[Pose, Array]:
    """A batch (N,) of poses and (N, k, n) wrenches."""
    if poses.dimension != robot.dimension:
        raise InvalidInput(f"a {robot.motion_pattern} robot lives in {robot.dimension} dimensions, "
                           f"the poses have {poses.dimension}")
    d = robot.dimension
    many = Pose.of(poses.position.reshape(-1, d), poses.rotation.reshape(-1, d, d))
    given = as_array(wrenches, "wrenches", (robot.n_dof,), "N, N m", batch=True)
    if given.ndim <= 2:
        given = np.unique(np.atleast_2d(given), axis=0)[None]
    if given.ndim != 3 or given.shape[0] not in (1, len(many)) or not given.size or not len(many):
        raise InvalidInput(f"wrenches must be ({robot.n_dof},), (k, {robot.n_dof}) or "
                           f"({len(many)}, k, {robot.n_dof}) for {len(many)} poses, got shape {np.shape(wrenches)}")
    return many, np.broadcast_to(given, (len(many), *given.shape[1:]))


def _moved(robot: Robot, directions: list[_Direction], x: Array) -> Robot:
    """The bases moved from where the robot has them: θ about their own centers, ρ along their present axes."""
    shifts = np.zeros((len(robot.bases), 3))
    for direction, amount in zip(directions, x):
        shifts[direction.base, direction.axis] = amount
    return robot.with_bases({base.name: (*(base.position + base.rotation[:2, :2] @ shift[1:]), base.heading + shift[0])
                             for base, shift in zip(robot.bases, shifts)})


def _starts(robot: Robot, poses: Pose, directions: list[_Direction]) -> list[Array]:
    """Where searches begin: here, and the layout brought over the middle of the poses, narrower or wider."""
    places = np.array([base.position for base in robot.bases])
    middle = np.zeros(2)
    floor = 2 if robot.dimension == 3 else 1
    middle[:floor] = (poses.position[:, :floor].min(axis=0) + poses.position[:, :floor].max(axis=0)) / 2
    center = places.mean(axis=0)
    starts = [np.zeros(len(directions))]
    for factor in (1.0, 0.7, 1.4, 2.0):
        shift = middle - center + (factor - 1) * (places - center)
        shift[:, floor:] = 0.0
        along = [base.rotation[:2, :2].T @ move for base, move in zip(robot.bases, shift)]
        starts.append(np.array([0.0 if axis == 0 else along[k][axis - 1] for k, axis in directions]))
    return starts


def _span(robot: Robot, poses: Pose) -> float:
    """How far apart things are on the floor [m]."""
    floor = 2 if robot.dimension == 3 else 1
    places = np.concatenate([np.array([base.position[:floor] for base in robot.bases]), poses.position[:, :floor]])
    return max(float(np.ptp(places, axis=0).max()), 0.5)


def _overlap(robot: Robot, poses: Pose) -> float:
    """How far bases stand in each other, or masts in the platform, as circles seen from above [m]."""
    floor = 2 if robot.dimension == 3 else 1
    centers = np.array([base.position[:floor] for base in robot.bases])
    radii = np.array([np.linalg.norm(base.footprint, axis=1).max(initial=0.05) for base in robot.bases])
    apart = np.linalg.norm(centers[:, None] - centers, axis=-1) - radii[:, None] - radii
    body = float(np.linalg.norm(robot.platform.size[:floor]) / 2 + np.linalg.norm(robot.platform.center[:floor]))
    carried = [i for i, k in enumerate(robot.base_indices) if k >= 0]
    masts = robot.exit_points[carried, :floor]
    clear = np.linalg.norm(poses.position[:, None, :floor] - masts, axis=-1) - body
    pairs = apart[np.triu_indices(len(centers), 1)]
    return max(0.0, -float(np.concatenate([pairs, clear.ravel()]).min(initial=0.0)))


def _worst_margin(robot: Robot, poses: Pose, loads: Array) -> float:
    """max s over all poses and wrenches at once; −1e3 where not even broken limits balance them."""
    return _margin_program(wrench_matrix(robot, poses), loads, robot)[0]


def _margin_program(W: Array, loads: Array, robot: Robot) -> tuple[float, Array]:
    """The linear program of `place_bases`: s and the tensions (N, k, m)."""
    from scipy.optimize import linprog
    from scipy.sparse import block_diag, csr_matrix, eye, hstack, vstack

    (N, k), m = loads.shape[:2], robot.n_cables
    blocks = block_diag([W[i] for i in range(N) for _ in range(k)], format="csr")
    half = np.tile((robot.tension_max - robot.tension_min) / 2, N * k)[:, None]
    low, high = (np.tile(limit, N * k) for limit in (robot.tension_min, robot.tension_max))
    tau = eye(N * k * m, format="csr")
    cost = np.append(np.zeros(N * k * m), -1.0)
    found = linprog(cost, A_ub=vstack([hstack([-tau, csr_matrix(half)]), hstack([tau, csr_matrix(half)])]),
                    b_ub=np.concatenate([-low, high]), bounds=[(None, None)] * (N * k * m) + [(None, 1.0)],
                    A_eq=hstack([blocks, csr_matrix((N * k * W.shape[1], 1))]), b_eq=-loads.ravel(), method="highs")
    if found.status != 0:
        return _BLOCKED, np.full((N, k, m), np.nan)
    return float(found.x[-1]), found.x[:-1].reshape(N, k, m)


def _beyond_any_placement(robot: Robot, poses: Pose, loads: Array) -> str:
    """Why no placement at all can serve, or '': driving on the floor changes no height, so what pulls up stays."""
    d = robot.dimension
    if robot.n_dof < d:
        return ""
    anchors = poses.position[:, None] + robot.anchor_points @ np.swapaxes(poses.rotation, -1, -2)
    lifting = robot.exit_points[:, -1] > anchors[..., -1]
    able = (lifting * robot.tension_max).sum(axis=-1)
    missing = -loads[..., d - 1] - able[:, None]
    i, j = np.unravel_index(int(missing.argmax()), missing.shape)
    if missing[i, j] <= 0:
        return ""
    return (f"pose {i + 1} of {len(poses)} (at {np.round(poses.position[i], 3).tolist()} m) needs "
            f"{-loads[i, j, d - 1]:.4g} N upwards; {int(lifting[i].sum())} of {robot.n_cables} cables have their exit "
            f"point above their anchor point there and could pull {able[i]:.4g} N at most")


def _reason(robot: Robot, poses: Pose, loads: Array, best: float, demand: float) -> str:
    """What stands in the way at the best placement found."""
    tried = "no base poses were found that serve every pose"
    if best <= _BLOCKED:
        blocked = _overlap(robot, poses) > 0
        why = ("bases would stand in each other or masts in the platform" if blocked
               else "at some pose the cables cannot exert the wrench at all, whatever their tensions")
        return f"{tried}: {why}"
    W = wrench_matrix(robot, poses)
    margins = [_margin_program(W[i:i + 1], loads[i:i + 1], robot) for i in range(len(poses))]
    i = int(np.argmin([s for s, _ in margins]))
    tensions = margins[i][1].reshape(-1, robot.n_cables)
    excess = np.maximum(robot.tension_min - tensions, tensions - robot.tension_max)
    j, cable = np.unravel_index(int(excess.argmax()), excess.shape)
    low, high = robot.tension_min[cable], robot.tension_max[cable]
    need = f"with margin {best:.3g} instead of {demand:g}" if best >= 0 else (
        f"cable {cable + 1} would need {tensions[j, cable]:.4g} N, allowed {low:g} to {high:g} N")
    return (f"{tried}: at the best placement, pose {i + 1} of {len(poses)} (at "
            f"{np.round(poses.position[i], 3).tolist()} m) under the wrench {np.round(loads[i, j], 3).tolist()}: "
            f"{need}; allow larger tensions, ask for fewer poses, or let more bases drive")
