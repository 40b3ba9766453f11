"""Interference: cables that touch each other, the platform or what stands around."""

from collections.abc import Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, as_number, frozen_dataclass
from ..errors import InvalidInput
from ..mechanics.cables import anchor_offsets, tangent_points
from ..robot import Robot
from ..robot.pose import Pose
from ..world import Box
from .criterion import Criterion, Judgement
from .distances import box_distance, segment_distance

_SAME = 1e-6
"""Ends this close together are one [m]."""


@frozen_dataclass
class InterferenceFree(Criterion):
    """No cable comes nearer than the clearance to another one, to the platform or to an obstacle.

    Cables are straight lines, on pulleys from the tangent point on; two that share an end cannot
    be told apart there and are not compared. A cable meets the platform's box at its anchor
    point anyway: only what is farther from there than ten times the clearance, and 5 cm at least,
    counts, so that cables may leave the platform at 6° and more.

    clearance : [m]
    obstacles : boxes of a scene, e.g. ``world.scene.boxes``
    cables, platform : whether these are looked at; in the plane cables that cross do touch
    margin : the smallest distance less the clearance [m]; touching and passing through count as
        distance 0
    Source: Merlet 2004 (cable interference); Perreault et al. 2010; the workspace at one
    orientation is the IFCOW of Okoli 2016, sec. 2.6.2.
    """

    clearance: float = 0.0
    obstacles: Sequence[Box] = ()
    cables: bool = True
    platform: bool = True
    unit = "m"

    def judge(self, robot: Robot, poses: Pose, margin: bool = True) -> Judgement:
        clearance = as_number(self.clearance, "clearance", "m", minimum=0.0)
        found = [np.full((*poses.batch_shape, 1), np.inf)]
        if self.cables:
            found.append(cable_distances(robot, poses))
        if self.platform:
            found.append(platform_distances(robot, poses, max(0.05, 10 * clearance)))
        found += [obstacle_distances(robot, poses, box) for box in self.obstacles]
        nearest = np.concatenate(found, axis=-1).min(axis=-1)
        return Judgement((nearest >= clearance) & (nearest > _SAME), nearest - clearance)


def cable_pairs(robot: Robot) -> list[tuple[int, int]]:
    """Pairs of cables that share neither exit nor anchor point."""
    ends = np.stack([robot.exit_points, robot.anchor_points])
    apart = (np.abs(ends[:, :, None] - ends[:, None]).max(axis=-1) > _SAME).all(axis=0)
    return [(i, j) for i, j in combinations(range(robot.n_cables), 2) if apart[i, j]]


def cable_distances(robot: Robot, poses: Pose) -> Array:
    """(…, pairs) between the cables of each of `cable_pairs` [m].

    >>> import cdprlab as cl
    >>> cable_distances(cl.load_world("caroca").robot, cl.Pose([0, 0, 1])).shape
    (24,)
    """
    pairs = np.array(cable_pairs(robot), dtype=int).reshape(-1, 2)
    anchors = _anchors(robot, poses)
    exits, (one, other) = tangent_points(robot, poses), pairs.T
    return segment_distance(anchors[..., one, :], exits[..., one, :], anchors[..., other, :], exits[..., other, :])


def platform_distances(robot: Robot, poses: Pose, root: float = 0.05) -> Array:
    """(…, m) between the platform's box and each cable from ``root`` [m] after its anchor point on."""
    body = robot.platform
    exits = (tangent_points(robot, poses) - poses.position[..., None, :]) @ poses.rotation   # in the platform's frame
    way = exits - robot.anchor_points
    length = np.linalg.norm(way, axis=-1, keepdims=True)
    start = robot.anchor_points + way * np.minimum(root / np.where(length > 0, length, 1.0), 1.0)
    return box_distance(start - body.center, exits - body.center, body.size / 2)


def piercing_cables(robot: Robot, poses: Pose) -> NDArray[np.bool_]:
    """(…, m) which cables pass through the platform's box; those fixed inside it cannot but do, and do not count."""
    body = robot.platform
    inside = (np.abs(robot.anchor_points - body.center) < body.size / 2 - 1e-9).all(axis=1)
    return np.asarray((platform_distances(robot, poses) < 1e-9) & ~inside)


def obstacle_distances(robot: Robot, poses: Pose, box: Box) -> Array:
    """(…, m) between each cable and a box of the scene [m].

    Raises InvalidInput for a box of another dimension.
    """
    d = robot.dimension
    if np.shape(box.size) != (d,):
        raise InvalidInput(f"obstacle {box.name or box.kind!r} has {np.size(box.size)} edges, the robot lives in "
                           f"{d} dimensions")
    center, turn = box.pose.position, box.pose.rotation
    anchors, exits = ((points - center) @ turn
                      for points in (_anchors(robot, poses), tangent_points(robot, poses)))
    return box_distance(anchors, exits, np.asarray(box.size) / 2)


def _anchors(robot: Robot, poses: Pose) -> Array:
    return poses.position[..., None, :] + anchor_offsets(robot, poses)
