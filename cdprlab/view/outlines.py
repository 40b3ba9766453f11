"""Robot and scene as points, segments and solids, for whatever draws: planar and spatial alike."""

from collections.abc import Sequence
from itertools import combinations, product
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from ..mechanics.cables import anchor_offsets, cable_lengths, have_directions, tangent_points
from ..mechanics.catenary import drawn_lengths
from ..robot import Robot
from ..robot.parts import DECK_HEIGHT, Base
from ..robot.pose import Pose
from ..world.model import Scene
from .style import BOX, DECK, LOAD, OBSTACLE, PLATFORM, STEEL

_THIN = 0.02
"""Of a tray's floor and walls [m]."""

EMPTY = Scene(frame=None, floor_height=0.0, boxes=())
"""Around a robot that comes without a world."""


class Solid(NamedTuple):
    """A box in the world: its (2^d, d) corners in the order of ``box_edges`` [m], and its color."""

    corners: Array
    color: str


def box_corners(size: Array, pose: Pose, center: Array | float = 0.0) -> Array:
    """(…, 2^d, d) corners of a box, in the order of ``box_edges`` [m].

    pose : of the body it is part of; center : (d,) of the box in that body's frame [m]
    """
    signs = np.array([*product((-0.5, 0.5), repeat=len(size))])
    own = signs * size + center
    return pose.position[..., None, :] + own @ pose.rotation.swapaxes(-1, -2)


def box_edges(dimension: int) -> Array:
    """(e, 2) pairs of corners that an edge joins: those that differ in one sign.

    >>> box_edges(2).tolist()
    [[0, 1], [0, 2], [1, 3], [2, 3]]
    """
    return np.array([(i, j) for i, j in combinations(range(2**dimension), 2)
                     if (i ^ j).bit_count() == 1])


def box_faces(dimension: int) -> Array:
    """(f, 4) corners of each face, going round; in the plane the box itself.

    >>> box_faces(2).tolist()
    [[0, 1, 3, 2]]
    """
    faces = "0132 4675 0451 2376 0264 1573" if dimension == 3 else "0132"
    return np.array([[int(corner) for corner in face] for face in faces.split()])


# --- the robot ----------------------------------------------------------------------------------------------
def platform_corners(robot: Robot, pose: Pose) -> Array:
    """(…, 2^d, d) corners of the platform's box in the world [m]."""
    return box_corners(robot.platform.size, pose, robot.platform.center)


def platform_solids(robot: Robot, pose: Pose,
                    loads: Sequence[tuple[Pose, Array]] = ()) -> list[Solid]:
    """The platform; with loads a tray of floor and end walls, 2 cm thick and open along y, so that they are seen.

    loads : pose and size [m] of each loose box
    """
    if not loads:
        return [Solid(platform_corners(robot, pose), PLATFORM)]
    parts = []
    for side, axis in ((-1, 2), (-1, 0), (1, 0)):
        size, middle = robot.platform.size.copy(), robot.platform.center.copy()
        middle[axis] += side * (size[axis] - _THIN) / 2
        size[axis] = _THIN
        parts.append(Solid(box_corners(size, pose, middle), PLATFORM))
    return parts + [Solid(box_corners(size, place), LOAD) for place, size in loads]


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

    return line + brentq(excess, 0.0, length) * bow


def strung(robot: Robot, pose: Pose, tensions: ArrayLike, rope_lengths: Array | None = None,
           frames: Array | None = None, pieces: int = 96,
           loose: float = 1.0) -> tuple[Array, Array]:
    """(m, pieces + 1, d) the cables from exit to anchor, and (k, 25, d) the wheels of their pulleys [m].

    Those that pull sag by the weight that the world gives them, others hang through. Where a cable
    cannot lie on its pulley, all are drawn from their exit points.

    tensions : (m,) [N], NaN of a cut cable; rope_lengths : (m,) let out, None where nobody knows [m]
    frames : of bases that lean, see `leaned`
    loose : how much longer than straight a cable without tension is whose length nobody knows
    """
    anchors = pose.position + anchor_offsets(robot, pose)
    starts, on_wheels = robot.exit_points, np.zeros(robot.n_cables)
    wheels: Array = np.zeros((0, 25, robot.dimension))
    if robot.pulleys.size:
        radii, axes = robot.pulleys[:, :1], robot.pulleys[:, 1:]
        away = anchors - starts
        out = away - (away * axes).sum(axis=1, keepdims=True) * axes
        out = out / np.maximum(np.linalg.norm(out, axis=1, keepdims=True), 1e-12)
        turns = np.linspace(0, 2 * np.pi, 25)[:, None, None]
        wheels = (starts
                  + radii * ((1 - np.cos(turns)) * out + np.sin(turns) * axes)).swapaxes(0, 1)
        if have_directions(robot, pose):
            starts = tangent_points(robot, pose)
            on_wheels = cable_lengths(robot, pose) - np.linalg.norm(starts - anchors, axis=1)
    starts, wheels = (np.reshape([leaned(robot, k, part, frames)
                                  for k, part in zip(robot.base_indices, parts)],
                                 parts.shape) for parts in (starts, wheels))
    lengths = drawn_lengths(robot, pose, tensions)
    if robot.gravity > 0:
        rest = (loose * np.linalg.norm(anchors - starts, axis=1) if rope_lengths is None
                else rope_lengths - on_wheels)
        lengths = np.where(np.greater(tensions, 0), lengths, rest)
    return np.stack([hanging(*cable, pieces)
                     for cable in zip(starts, anchors, lengths)]), wheels


# --- what stands around it ----------------------------------------------------------------------------------
def floor_height(robot: Robot, scene: Scene) -> float:
    """The scene's, or lower where a robot hangs below it [m]."""
    return min(scene.floor_height, float(robot.exit_points[:, -1].min()))


def surroundings(robot: Robot, scene: Scene, frames: Array | None = None) -> list[Solid]:
    """Frame or masts, the decks of mobile bases, and the scene's boxes.

    frames : of bases that lean, see `leaned`
    """
    thickness = 0.005 * diagonal(landmarks(robot, scene))
    return [Solid(leaned(robot, k, _beam(points, thickness) if color == STEEL else points,
                         frames), color)
            for k, points, color in _standing(robot, scene)]


def _standing(robot: Robot, scene: Scene) -> list[tuple[int, Array, str]]:
    """Frame or masts by their (2, d) ends, decks and boxes by their corners [m].

    Returns of each the base it is part of, −1 for none, its points and its color.
    """
    found = []
    if scene.frame is not None:
        low, high = scene.frame
        edges = box_corners(high - low, Pose((low + high) / 2))[box_edges(robot.dimension)]
        found += [(-1, edge, STEEL) for edge in edges]
    for k, point in zip(robot.base_indices, robot.exit_points):
        if k >= 0 or scene.frame is None:
            deck = DECK_HEIGHT if k >= 0 and len(robot.bases[k].footprint) else 0.0
            foot = min(floor_height(robot, scene) + deck, point[-1])
            found.append((k, np.array([[*point[:-1], foot], point]), STEEL))
    found += [(k, _deck(base), DECK) for k, base in enumerate(robot.bases)
              if len(base.footprint)]
    return found + [(-1, box_corners(box.size, box.pose),
                     OBSTACLE if box.kind == "obstacle" else BOX)
                    for box in scene.boxes]


def _beam(ends: Array, thickness: float) -> Array:
    """A square beam between two points, as long as its ends' corners."""
    way = ends[1:] - ends[:1]
    # Any two directions across will do: those that QR finds.
    axes = np.linalg.qr(np.hstack([way.T, np.eye(way.size)]))[0]
    size = np.full(ends.shape[1], thickness)
    size[0] += np.linalg.norm(way)
    return box_corners(size, Pose.of(ends.mean(axis=0), axes))


def _deck(base: Base) -> Array:
    """The box over a base's footprint, as high as a base that is solid."""
    contacts = base.footprint[:, :base.center_of_mass.size - 1]
    size = np.append(np.ptp(contacts, axis=0), DECK_HEIGHT)
    middle = np.append(contacts.min(axis=0) + contacts.max(axis=0), DECK_HEIGHT) / 2
    return box_corners(size, Pose.of(base.origin, base.rotation), middle)


def leaned(robot: Robot, k: int, points: Array, frames: Array | None) -> Array:
    """Points of base k as it stands upright, where they are as it leans.

    points : (…, 3) [m]; k : −1 for what no base carries
    frames : (p, 3, 4) rotation and center of mass of each base; None where all stand upright
    """
    if k < 0 or frames is None:
        return points
    base = robot.bases[k]
    own = (points - base.to_world(base.center_of_mass)) @ base.rotation
    return frames[k, :, 3] + own @ frames[k, :, :3].T


def landmarks(robot: Robot, scene: Scene, poses: Pose | None = None) -> Array:
    """(k, d) points that must be in the picture: exits, frame, bases, boxes, the platform at some poses [m]."""
    groups = [robot.exit_points, *(points for _, points, _ in _standing(robot, scene))]
    groups += [robot.exit_points + side * robot.pulleys[:, :1] for side in (-1, 1)
               if robot.pulleys.size]
    if poses is not None:
        groups.append(platform_corners(robot, poses).reshape(-1, robot.dimension))
    points = np.concatenate(groups)
    grounded = points.copy()
    grounded[:, -1] = floor_height(robot, scene)
    return np.concatenate([points, grounded])


def diagonal(points: Array) -> float:
    """Of the box around points [m]."""
    return float(np.linalg.norm(np.ptp(points, axis=0)))


def floor_tiles(points: Array, height: float) -> Array:
    """(k, 4, d) tiles of 1 m (10 m and so on for large worlds) below the points; in the plane one strip.

    In space tiles come row by row, an odd number in each, so that every other one makes a
    chessboard.
    """
    low, high = points.min(axis=0), points.max(axis=0)
    if points.shape[1] == 2:
        left, right, below = low[0] - 0.5, high[0] + 0.5, height - 0.04 * (high - low).max()
        return np.array([[[left, height], [right, height], [right, below], [left, below]]])
    tile = 10.0 ** max(0, np.ceil(np.log10(max(*(high - low)[:2], 1.0) / 25)))
    first, last = np.floor(low[:2] / tile - 0.25), np.ceil(high[:2] / tile + 0.25)
    last[1] += (last[1] - first[1] + 1) % 2
    starts = np.array([*product(*map(np.arange, first, last))])
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    return np.insert(tile * (starts[:, None] + square), 2, height, axis=-1)
