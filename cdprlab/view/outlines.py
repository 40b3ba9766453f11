"""Robot and scene as corners and edges, for whatever draws lines: planar and spatial alike."""

from __future__ import annotations

from itertools import combinations, product

import numpy as np

from ..arrays import Array
from ..robot import Robot
from ..robot.pose import Pose
from ..world.model import Scene

EMPTY = Scene(frame=None, floor_height=0.0, boxes=())
"""Around a robot that comes without a world."""


def box_corners(size: Array, center: Array, pose: Pose) -> Array:
    """(2^d, d) corners of a box, in the order of ``box_edges`` [m]."""
    signs = np.array(list(product((-0.5, 0.5), repeat=len(size))))
    return np.asarray(pose.position + (signs * size + center) @ pose.rotation.T)


def box_edges(dimension: int) -> Array:
    """(e, 2) pairs of corners that an edge joins: those that differ in one sign.

    >>> box_edges(2).tolist()
    [[0, 1], [0, 2], [1, 3], [2, 3]]
    """
    return np.array([(i, j) for i, j in combinations(range(2**dimension), 2) if bin(i ^ j).count("1") == 1])


def box_faces(dimension: int) -> Array:
    """(f, 4) corners of each face, going round; in the plane the box itself."""
    if dimension == 2:
        return np.array([[0, 1, 3, 2]])
    return np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])


def platform_corners(robot: Robot, pose: Pose) -> Array:
    """(2^d, d) corners of the platform's box in the world [m]."""
    return box_corners(robot.platform.size, robot.platform.center, pose)


def floor_height(robot: Robot, scene: Scene) -> float:
    """The scene's, or lower where a robot hangs below it [m]."""
    return min(scene.floor_height, float(robot.exit_points[:, -1].min()))


def frame_segments(robot: Robot, scene: Scene) -> Array:
    """(k, 2, d) what carries the exit points: the frame's edges, else masts; footprints of mobile bases."""
    d, segments = robot.dimension, []
    if scene.frame is not None:
        middle, size = scene.frame.mean(axis=0), scene.frame[1] - scene.frame[0]
        segments.append(box_corners(size, np.zeros(d), Pose(middle))[box_edges(d)])
    height = floor_height(robot, scene)
    masts = [point for cable, point in zip(robot.cables, robot.exit_points)
             if cable.base is not None or scene.frame is None]
    if masts:
        feet = np.array(masts)
        feet[:, -1] = height
        segments.append(np.stack([feet, np.array(masts)], axis=1))
    for base in robot.bases:
        corners = base.to_world(np.insert(base.footprint, 2, 0.0, axis=1) if d == 3 else base.footprint)
        segments.append(np.stack([corners, np.roll(corners, -1, axis=0)], axis=1))
    return np.concatenate(segments) if segments else np.zeros((0, 2, d))


def scene_boxes(scene: Scene) -> list[Array]:
    """(2^d, d) corners of every solid box around the robot [m]."""
    found = []
    for box in scene.boxes:
        d = len(box.size)
        pose = Pose(box.position, angle=box.yaw) if d == 2 else Pose(box.position, rpy=[0, 0, box.yaw])
        found.append(box_corners(box.size, np.zeros(d), pose))
    return found


def landmarks(robot: Robot, scene: Scene, poses: Pose) -> Array:
    """(k, d) points that must be in the picture: exits, frame, boxes, and the platform at each of some poses [m]."""
    groups = [robot.exit_points, frame_segments(robot, scene).reshape(-1, robot.dimension), *scene_boxes(scene)]
    groups += [platform_corners(robot, pose) for pose in (poses if poses.batch_shape else [poses])]
    points = np.concatenate(groups)
    grounded = points.copy()
    grounded[:, -1] = floor_height(robot, scene)
    return np.concatenate([points, grounded])


def floor_segments(points: Array, height: float) -> Array:
    """(k, 2, d) a grid of 1 m (10 m and so on for large worlds) below the points; in the plane one line."""
    low, high = points.min(axis=0), points.max(axis=0)
    if points.shape[1] == 2:
        return np.array([[[low[0] - 0.5, height], [high[0] + 0.5, height]]])
    tile = 10.0 ** max(0, np.ceil(np.log10(max(*(high - low)[:2], 1.0) / 25)))
    first, last = np.floor(low[:2] / tile - 0.1), np.ceil(high[:2] / tile + 0.1)
    x, y = (tile * np.arange(first[i], last[i] + 1) for i in (0, 1))
    along_y = [[[v, y[0], height], [v, y[-1], height]] for v in x]
    along_x = [[[x[0], v, height], [x[-1], v, height]] for v in y]
    return np.array(along_y + along_x)
