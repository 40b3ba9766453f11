"""Robots built by hand, one per motion pattern and two with mobile bases, and random poses well inside them."""

import itertools

import numpy as np

from cdprlab.mechanics.cables import cable_directions
from cdprlab.robot import MOTION_PATTERNS, Base, Cable, Platform, Robot
from cdprlab.robot.pose import Pose


def platform(d, center_of_mass=None, mass=12.0):
    """A box of 12 kg, its center of mass off P unless told otherwise."""
    com = [0.05, -0.08, 0.03][:d] if center_of_mass is None else center_of_mass
    return Platform(mass, 0.7 if d == 2 else np.diag([0.4, 0.5, 0.6]), com, [0.4] * d, [0.0] * d)


def build(pattern, exits, anchors, limits=(10.0, 2000.0), bases=(), carriers=None, **body):
    """A robot from lists of points; ``carriers`` names each cable's base."""
    pattern = MOTION_PATTERNS[pattern]
    carriers = carriers or [None] * len(exits)
    cables = tuple(Cable(a, b, *limits, base=k) for a, b, k in zip(exits, anchors, carriers))
    return Robot(pattern, platform(pattern.dimension, **body), cables, tuple(bases))


def robot_1t():
    """Two cables on a line: only x is theirs."""
    return build("1T", [[-2, 1], [2, 1.2]], [[0, 0]] * 2)


def robot_2t():
    """Three cables meeting at P in the plane."""
    return build("2T", [[-2, 3], [2, 3], [0.3, -2]], [[0, 0]] * 3)


def robot_1r2t():
    """Four cables on a planar platform."""
    return build("1R2T", [[-2, -2], [2, -2], [2, 2], [-2, 2]],
                 [[-0.2, 0.15], [0.25, 0.1], [0.2, -0.2], [-0.15, -0.2]])


def robot_3t():
    """Four cables meeting at P in space."""
    return build("3T", [[-2, -2, 4], [2, -2, 4.2], [2.1, 2, 4], [-2, 2, -1]], [[0, 0, 0]] * 4)


def robot_2r3t():
    """Six cables to a rod along x′."""
    return build("2R3T", [[-3, -2, 3], [-3, 2, 3.2], [-3, 0, -1], [3, -2, 3], [3, 2.1, 3], [3, 0.2, -1]],
                 [[-0.4, 0, 0], [-0.4, 0, 0], [-0.3, 0, 0], [0.4, 0, 0], [0.35, 0, 0], [0.4, 0, 0]])


CAROCA_EXITS = [[x, y, 3.5] for y in (-2, 2) for x in (-3.5, -3.5, 3.5, 3.5)]
CAROCA_ANCHORS = [[0.6, -0.3, -0.2], [-0.6, 0.3, 0.2], [-0.6, -0.3, 0.2], [0.6, 0.3, -0.2],
                  [-0.6, -0.3, -0.2], [0.6, 0.3, 0.2], [0.6, -0.3, 0.2], [-0.6, 0.3, -0.2]]


def robot_3r3t():
    """CAROCA: eight cables, 150 kg, suspended."""
    return build("3R3T", CAROCA_EXITS, CAROCA_ANCHORS, (50.0, 10000.0), center_of_mass=[0, 0, 0], mass=150.0)


def two_bases():
    """Eight cables, three on each of two turned, off-center bases, two on the frame."""
    bases = (Base("left", [-3.2, 0.4], 0.5, 60.0, [0.05, -0.02, 0.6],
                  [[0.5, 0.5], [-0.5, 0.5], [-0.5, -0.5], [0.5, -0.5]], [0.2, 0.2, 0.1]),
             Base("right", [3.1, -0.3], -2.1, 55.0, [-0.03, 0.04, 0.5],
                  [[0.6, 0.0], [-0.4, 0.5], [-0.4, -0.5]], [0.3, 0.2, 0.0]))
    exits = [[0.1, 0.3, 2.5], [-0.1, -0.4, 2.4], [0.2, 0.0, 0.3], [0.2, 0.3, 2.6], [-0.2, -0.3, 2.5], [0.1, 0.1, 0.4],
             [0.5, 3.5, 3.0], [-0.4, -3.6, 2.8]]
    carriers = ["left", "left", "left", "right", "right", "right", None, None]
    return build("3R3T", exits, CAROCA_ANCHORS, bases=bases, carriers=carriers)


def two_planar_bases():
    """Four cables in the plane, two on each of two bases."""
    bases = (Base("left", [-3.0, 0.0], 0.2, 60.0, [0.05, 0.6], [[0.5, 0.0], [-0.5, 0.0]], [0.0, 0.2, 0.0]),
             Base("right", [3.2, 0.0], 0.0, 50.0, [-0.1, 0.5], [[-0.4, 0.0], [0.45, 0.0]], [0.0, 0.2, 0.0]))
    exits = [[0.1, 2.5], [0.2, 0.3], [-0.2, 2.6], [-0.1, 0.4]]
    return build("1R2T", exits, [[-0.2, 0.1], [-0.25, -0.1], [0.2, 0.15], [0.2, -0.2]], bases=bases,
                 carriers=["left", "left", "right", "right"])


ROBOTS = {"1T": robot_1t, "2T": robot_2t, "1R2T": robot_1r2t, "3T": robot_3t, "2R3T": robot_2r3t,
          "3R3T": robot_3r3t, "two bases": two_bases, "two planar bases": two_planar_bases}
BASED = {name: ROBOTS[name] for name in ("two bases", "two planar bases")}


def random_poses(robot, count, seed, turn=0.6):
    """A batch of rotated poses around the origin (z or y around 1), half a meter or more from every exit."""
    rng = np.random.default_rng(seed)
    d = robot.dimension
    position = rng.uniform(-0.6, 0.6, (count, d))
    position[:, -1] += 1.0 if d == 3 else 0.3
    if d == 2:
        return Pose(position, angle=rng.uniform(-turn, turn, count))
    return Pose(position, rng.uniform(-turn, turn, (count, 3)))


def random_pose(robot, seed, turn=0.6):
    """One of them."""
    return random_poses(robot, 1, seed, turn)[0]


def case(name, seed):
    """(robot, random pose) by the robot's name."""
    robot = ROBOTS[name]()
    return robot, random_pose(robot, seed)


def full_twist(robot, pose, twist):
    """(v, ω) in world axes from the pattern's twist, written out pattern by pattern."""
    d, t = robot.dimension, np.asarray(twist, dtype=float)
    if robot.motion_pattern == "2R3T":
        return t[:3], pose.rotation[:, 1] * t[3] + pose.rotation[:, 2] * t[4]
    full = np.concatenate([t, np.zeros((3 if d == 2 else 6) - t.size)])
    return full[:d], full[d:]


def moved(robot, pose, twist):
    """The pose after a step ``twist`` (a small displacement in the pattern's rows), by the exponential map."""
    from scipy.linalg import expm
    v, w = full_twist(robot, pose, twist)
    turn = [[0, -w[0]], [w[0], 0]] if robot.dimension == 2 else \
        [[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]]
    return Pose(pose.position + v, matrix=expm(np.array(turn, dtype=float)) @ pose.rotation)


def differences(function, n, step):
    """(…, n) central differences of ``function(x)`` at x = 0."""
    return np.stack([(function(step * e) - function(-step * e)) / (2 * step) for e in np.eye(n)], axis=-1)


def cases(count):
    """(name, seed) for parametrize."""
    return list(itertools.product(ROBOTS, range(count)))


def in_rows(robot, pose, force, moment):
    """A wrench in the pattern's rows, by virtual work: w · t = f · v + m · ω."""
    twists = [full_twist(robot, pose, e) for e in np.eye(robot.n_dof)]
    return np.array([force @ v + moment @ w for v, w in twists])


def cross(a, b):
    """a × b, in the plane its z component as an array of one."""
    return np.atleast_1d(a[0] * b[1] - a[1] * b[0]) if a.size == 2 else np.cross(a, b)


def spatial_twin(robot):
    """(x, y, φ) as (x, 0, y): each planar point (x, y) at (x, 0, y), each base along x."""
    def lift(p):
        return [p[0], 0.0, p[1]]
    return build("3R3T", [lift(a) for a in robot.exit_points], [lift(b) for b in robot.anchor_points],
                 center_of_mass=lift(robot.platform.center_of_mass), mass=robot.mass)


def pulls_on(robot, pose, base, tau):
    """[(point, force)] on one base: its weight, and the cables, each pulled towards the platform."""
    weight = np.zeros(robot.dimension)
    weight[-1] = -base.mass * robot.gravity
    loads = [(base.to_world(base.center_of_mass), weight)]
    return loads + [(a, -t * u) for a, t, u, cable in zip(robot.exit_points, tau, cable_directions(robot, pose),
                                                          robot.cables) if cable.base == base.name]
