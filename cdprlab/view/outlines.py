"""Robot and scene as points, segments and solids, for whatever draws: planar and spatial alike."""

from collections.abc import Sequence
from itertools import combinations, product
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_array
from ..mechanics.cables import anchor_offsets, cable_lengths, cable_vectors, have_directions, tangent_points
from ..mechanics.catenary import drawn_lengths
from ..robot import Platform, Robot
from ..robot.parts import DECK_HEIGHT, Base
from ..robot.pose import Pose
from ..world.model import Scene
from .style import BOX, DECK, LOAD, OBSTACLE, PLATFORM, STEEL

EMPTY = Scene(frame=None, floor_height=0.0, boxes=())
"""Around a robot that comes without a world."""


class Solid(NamedTuple):
    """A box in the world: its (2^d, d) corners in the order of ``box_edges`` [m], and its color."""

    corners: Array
    color: str


def box_corners(size: Array, pose: Pose, center: Array | float = 0.0) -> Array:
    """(2^d, d) corners of a box, in the order of ``box_edges`` [m].

    pose : of the body it is part of; center : (d,) of the box in that body's frame [m]
    """
    signs = np.array(list(product((-0.5, 0.5), repeat=len(size))))
    return np.asarray(pose.position + (signs * size + center) @ pose.rotation.T)


def box_edges(dimension: int) -> Array:
    """(e, 2) pairs of corners that an edge joins: those that differ in one sign.

    >>> box_edges(2).tolist()
    [[0, 1], [0, 2], [1, 3], [2, 3]]
    """
    return np.array([(i, j) for i, j in combinations(range(2**dimension), 2)
                     if bin(i ^ j).count("1") == 1])


def box_faces(dimension: int) -> Array:
    """(f, 4) corners of each face, going round; in the plane the box itself."""
    if dimension == 2:
        return np.array([[0, 1, 3, 2]])
    return np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4],
                     [1, 5, 7, 3]])


# --- the robot ----------------------------------------------------------------------------------------------
def platform_corners(robot: Robot, pose: Pose) -> Array:
    """(2^d, d) corners of the platform's box in the world [m]."""
    return box_corners(robot.platform.size, pose, robot.platform.center)


def platform_solids(robot: Robot, pose: Pose, loads: Sequence[tuple[Pose, Array]] = ()) -> list[Solid]:
    """The platform; with loads a tray of floor and end walls, 2 cm thick and open along y, so that they are seen.

    loads : pose and size [m] of each loose box
    """
    if not loads:
        return [Solid(platform_corners(robot, pose), PLATFORM)]
    parts = [Solid(box_corners(size, pose, center), PLATFORM)
             for center, size in _tray(robot.platform)]
    return parts + [Solid(box_corners(size, place), LOAD) for place, size in loads]


def _tray(platform: Platform) -> list[tuple[Array, Array]]:
    (x, y, z), thin = platform.size, 0.02
    floor = np.array([0, 0, thin - z]) / 2, np.array([x, y, thin])
    walls = [(np.array([side * (x - thin) / 2, 0, 0]), np.array([thin, y, z]))
             for side in (-1, 1)]
    return [(platform.center + center, size) for center, size in (floor, *walls)]


def hanging(start: Array, end: Array, length: float, pieces: int = 96) -> Array:
    """(pieces + 1, d) points of a rope of this length between two points: straight, or a parabola hanging through.

    start, end : (d,) [m]; length : [m], too short counts as straight

    >>> points = hanging(np.zeros(3), np.array([2.0, 0, 0]), 3.0)
    >>> float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum().round(6))
    3.0
    """
    from scipy.optimize import brentq

    shares = np.linspace(0, 1, pieces + 1)[:, None]
    line = (1 - shares) * start + shares * end
    if length <= np.linalg.norm(end - start) * (1 + 1e-6):
        return line
    bow = 4 * shares * (1 - shares) * -np.eye(start.size)[-1]

    def excess(sag: float) -> float:
        return float(np.linalg.norm(np.diff(line + sag * bow, axis=0), axis=1).sum() - length)

    return line + brentq(excess, 0.0, float(length)) * bow


def cable_lines(robot: Robot, pose: Pose, tensions: ArrayLike, rope_lengths: ArrayLike | None, starts: Array,
                arcs: Array, pieces: int = 96, loose: float = 1.0) -> Array:
    """(m, pieces + 1, d) the cables: those that pull sag by the weight that the world gives them, others hang through.

    tensions : (m,) [N], NaN of a cut cable; rope_lengths : (m,) let out, None where nobody knows [m]
    starts, arcs : where the straight parts begin, and what lies on wheels, see `strung`
    loose : how much longer than straight a cable without tension is whose length nobody knows
    """
    anchors = pose.position + anchor_offsets(robot, pose)
    lengths = drawn_lengths(robot, pose, tensions)
    if robot.gravity > 0:
        rest = loose * np.linalg.norm(anchors - starts, axis=1)
        if rope_lengths is not None:
            rest = as_array(rope_lengths, "rope_lengths", arcs.shape, "m") - arcs
        lengths = np.where(np.greater(tensions, 0), lengths, rest)
    return np.stack([hanging(*cable, pieces) for cable in zip(starts, anchors, lengths)])


def strung(robot: Robot, pose: Pose) -> tuple[Array, Array, Array]:
    """Where the cables' straight parts begin (m, d), what lies on wheels (m,), and the wheels' outlines (k, 25, d) [m].

    Where a cable cannot lie on its pulley, all are drawn from their exit points.
    """
    if not robot.pulleys.size:
        return robot.exit_points, np.zeros(robot.n_cables), np.zeros((0, 25, robot.dimension))
    starts, arcs = robot.exit_points, np.zeros(robot.n_cables)
    if have_directions(robot, pose):
        starts = tangent_points(robot, pose)
        arcs = cable_lengths(robot, pose) - np.linalg.norm(cable_vectors(robot, pose), axis=-1)
    with_wheel = robot.pulleys[:, 0] > 0
    exits, radii, axes = (part[with_wheel] for part in (robot.exit_points, robot.pulleys[:, :1], robot.pulleys[:, 1:]))
    away = pose.position + anchor_offsets(robot, pose)[with_wheel] - exits
    out = away - (away * axes).sum(axis=1, keepdims=True) * axes
    out = out / np.maximum(np.linalg.norm(out, axis=1, keepdims=True), 1e-12)
    turns = np.linspace(0, 2 * np.pi, 25)[:, None, None]
    wheels = exits + radii * ((1 - np.cos(turns)) * out + np.sin(turns) * axes)
    return starts, arcs, wheels.swapaxes(0, 1)


# --- what stands around it ----------------------------------------------------------------------------------
def floor_height(robot: Robot, scene: Scene) -> float:
    """The scene's, or lower where a robot hangs below it [m]."""
    return min(scene.floor_height, float(robot.exit_points[:, -1].min()))


def frame_segments(robot: Robot, scene: Scene) -> Array:
    """(k, 2, d) what carries the exit points: the frame's edges, else masts [m]."""
    d, segments = robot.dimension, []
    if scene.frame is not None:
        middle, size = scene.frame.mean(axis=0), scene.frame[1] - scene.frame[0]
        segments += list(box_corners(size, Pose(middle))[box_edges(d)])
    decks = {base.name for base in robot.bases if len(base.footprint)}
    for cable, point in zip(robot.cables, robot.exit_points):
        if cable.base is not None or scene.frame is None:
            foot = floor_height(robot, scene) + (DECK_HEIGHT if cable.base in decks else 0.0)
            segments.append(np.stack([[*point[:-1], min(foot, point[-1])], point]))
    return np.reshape(segments, (-1, 2, d))


def surroundings(robot: Robot, scene: Scene, frames: Array | None = None) -> list[Solid]:
    """Frame or masts, the decks of mobile bases, and the scene's boxes.

    frames : of bases that lean, see `leaned`
    """
    thickness = 0.005 * float(np.linalg.norm(np.ptp(landmarks(robot, scene), axis=0)))
    segments = frame_segments(robot, scene)
    masts = [k for k in robot.base_indices if k >= 0 or scene.frame is None]
    owners = [-1] * (len(segments) - len(masts)) + masts
    found = [Solid(leaned(robot, k, _beam(start, end, thickness), frames), STEEL)
             for k, (start, end) in zip(owners, segments)]
    found += [Solid(leaned(robot, k, _deck(base), frames), DECK)
              for k, base in enumerate(robot.bases) if len(base.footprint)]
    return found + [Solid(box_corners(box.size, box.pose),
                          OBSTACLE if box.kind == "obstacle" else BOX)
                    for box in scene.boxes]


def _beam(start: Array, end: Array, thickness: float) -> Array:
    """A square beam between two points, as long as its ends' corners."""
    d = len(start)
    # Any two directions across will do: those that QR finds.
    across = np.linalg.qr(np.column_stack([end - start, np.eye(d)[:, np.argsort(np.abs(end - start))[:d - 1]]]))[0]
    size = np.full(d, thickness)
    size[0] += np.linalg.norm(end - start)
    return box_corners(size, Pose.of((start + end) / 2, across))


def _deck(base: Base) -> Array:
    """The box over a base's footprint, as high as a base that is solid."""
    planar = base.center_of_mass.size == 2
    low, high = base.footprint.min(axis=0), base.footprint.max(axis=0)
    low, high = (np.array([*ends[:1 if planar else 2], z])
                 for ends, z in ((low, 0.0), (high, DECK_HEIGHT)))
    return box_corners(high - low, Pose.of(base.origin, base.rotation), (low + high) / 2)


def leaned(robot: Robot, k: int, points: Array, frames: Array | None) -> Array:
    """Points of base k as it stands upright, where they are as it leans.

    points : (…, 3) [m]; k : −1 for what no base carries
    frames : (p, 3, 4) rotation and center of mass of each base; None where all stand upright
    """
    if k < 0 or frames is None:
        return points
    base = robot.bases[k]
    upright = base.origin + base.rotation @ base.center_of_mass
    return frames[k, :, 3] + (points - upright) @ base.rotation @ frames[k, :, :3].T


def landmarks(robot: Robot, scene: Scene, poses: Pose | None = None) -> Array:
    """(k, d) points that must be in the picture: exits, frame, bases, boxes, the platform at some poses [m]."""
    groups = [robot.exit_points, frame_segments(robot, scene).reshape(-1, robot.dimension)]
    groups += [box_corners(box.size, box.pose) for box in scene.boxes]
    groups += [_deck(base) for base in robot.bases if len(base.footprint)]
    groups += [robot.exit_points + side * robot.pulleys[:, :1] for side in (-1, 1) if robot.pulleys.size]
    if poses is not None:
        groups += [platform_corners(robot, pose)
                   for pose in (poses if poses.batch_shape else [poses])]
    points = np.concatenate(groups)
    grounded = points.copy()
    grounded[:, -1] = floor_height(robot, scene)
    return np.concatenate([points, grounded])


def floor_tiles(points: Array, height: float) -> Array:
    """(k, 4, d) tiles of 1 m (10 m and so on for large worlds) below the points; in the plane one strip.

    In space tiles come row by row, an odd number in each, so that every other one makes a
    chessboard.
    """
    low, high = points.min(axis=0), points.max(axis=0)
    if points.shape[1] == 2:
        (left, right), depth = (low[0] - 0.5, high[0] + 0.5), 0.04 * float(np.ptp(points, axis=0).max())
        return np.array([[[left, height], [right, height], [right, height - depth],
                          [left, height - depth]]])
    tile = 10.0 ** max(0, np.ceil(np.log10(max(*(high - low)[:2], 1.0) / 25)))
    first, last = np.floor(low[:2] / tile - 0.25), np.ceil(high[:2] / tile + 0.25)
    last[1] += (last[1] - first[1] + 1) % 2
    corners = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]) * tile
    return np.array([[i * tile, j * tile, height] + corners
                     for i in np.arange(first[0], last[0])
                     for j in np.arange(first[1], last[1])])
