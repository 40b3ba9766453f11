"""Lesson 03: the exercises' kind of input, the mutants that answer the same, and other right answers."""

from __future__ import annotations

import numpy as np

import cdprlab as cl
from cdprlab.course import six_cables


def planar(rng, spread=1.0):
    return cl.Pose(rng.uniform([-0.6, 0.9], [0.6, 2.1]), angle=rng.uniform(-0.4, 0.4) * spread)


def spatial(rng):
    return cl.Pose(rng.uniform([-1, -0.8, 0.6], [1, 0.8, 2.0]), rpy=rng.uniform(-0.3, 0.3, 3))


def robot_and_poses(rng, lesson):
    """A robot, its pose, and a guess that lies near."""
    if rng.integers(2):
        return six_cables(int(rng.integers(3, 7))), planar(rng), planar(rng)
    return lesson["world"].robot, spatial(rng), spatial(rng)


def circles(rng, lesson):
    ends = rng.normal(size=(2, 2)) * rng.choice([0.1, 1, 3])
    load = rng.normal(size=2) * rng.choice([0.1, 1, 3])
    l1, l2 = np.linalg.norm(ends - load, axis=1) * (1 if rng.integers(4) else rng.uniform(0.2, 1, 2))
    return [("hanging_point", (*ends, float(l1), float(l2)))]


def newton(rng, lesson):
    robot, truth, guess = robot_and_poses(rng, lesson)
    lengths = cl.cable_lengths(robot, truth)
    return [("gauss_newton_step", (robot, lengths, guess)), ("gauss_newton", (robot, lengths, guess)),
            ("gauss_newton", (robot, lengths, guess, 0.05)), ("gauss_newton", (robot, lengths, guess, 1e-12, 2))]


def astray(rng, lesson):
    return [("misleading_guess", (six_cables(3), planar(rng)))]


def covariance(rng, lesson):
    robot, truth, _ = robot_and_poses(rng, lesson)
    planar_robot = six_cables(int(rng.integers(3, 7)))
    return [("pose_covariance", (robot, truth, rng.uniform(1e-4, 1e-2))),
            ("simulated_errors", (planar_robot, planar(rng), rng.uniform(1e-4, 1e-3), int(rng.integers(2, 5)),
                                  int(rng.integers(100))))]


def fault(rng, lesson):
    robot, truth, _ = robot_and_poses(rng, lesson)
    if robot.n_cables < robot.n_dof + 1:
        robot = six_cables(5)
    lengths = cl.cable_lengths(robot, truth)
    return [("leave_one_out", (robot, lengths + rng.normal(0, 0.01, len(lengths)), truth))]


ANY_GUESS = "other guesses are tried first; any that misleads is right"
SIZE = "only its size is asked for"
DRAWS = {"circles": circles, "newton": newton, "astray": astray, "covariance": covariance, "fault": fault}
EQUIVALENT: dict[str, dict[str, str]] = {
    "circles": {"line 9: A2 - A1 → A1 - A2": SIZE},
    "newton": {"line 28: cl.cable_lengths(robot, poses[-1]) - cl.cable_lengths(rob... → "
               "cl.cable_lengths(robot, poses[-2]) - cl.cable_lengths(rob...": SIZE},
    "astray": {"line 9: 0 → 1": ANY_GUESS, "line 11: 0 → 1": ANY_GUESS, "line 11: 1 → 2": ANY_GUESS,
               "line 11: 3 → 4": "in the plane the step's first three numbers count",
               "line 15: continue → pass": "what the guess before led to was near the true pose",
               "line 16: found.position - pose.position → pose.position - found.position": SIZE},
    "covariance": {"line 26: cl.cable_lengths(robot, pose) + rng.normal(0, sigma, (cou... → "
                   "cl.cable_lengths(robot, pose) - rng.normal(0, sigma, (cou...": "as likely"},
    "fault": {"line 14: kept - cl.cable_lengths(others, found) → cl.cable_lengths(others, found) - kept": SIZE},
}
OTHERS = {
    "circles": [("angles by the law of cosines", """
def hanging_point(A1, A2, l1, l2):
    across = A2 - A1
    d = np.hypot(*across)
    cosine = (l1**2 + d**2 - l2**2) / (2 * l1 * d)
    if not -1 <= cosine <= 1:
        raise ValueError("the circles miss each other")
    ends = []
    for sign in (-1, 1):
        bearing = np.arctan2(across[1], across[0]) + sign * np.arccos(cosine)
        ends.append([A1[0] + l1 * np.cos(bearing), A1[1] + l1 * np.sin(bearing)])
    return min(ends, key=lambda point: point[1])
""")],
    "newton": [("normal equations, a while loop, a tuple", """
def gauss_newton_step(robot, lengths, pose):
    J = cl.jacobian(robot, pose)
    return moved(pose, np.linalg.solve(J.T @ J, J.T @ (np.asarray(lengths) - cl.cable_lengths(robot, pose))))


def gauss_newton(robot, lengths, guess, tolerance=1e-12, most=50):
    poses, change = (guess,), np.inf
    while change > tolerance and len(poses) <= most:
        before = cl.cable_lengths(robot, poses[-1])
        poses += (gauss_newton_step(robot, lengths, poses[-1]),)
        change = max(abs(cl.cable_lengths(robot, poses[-1]) - before))
    return poses
""")],
    "astray": [("the other pose itself, from the library's list of all", """
def misleading_guess(robot, pose):
    lengths, rng = cl.cable_lengths(robot, pose), np.random.default_rng(0)
    while True:
        center = cl.Pose(pose.position + rng.normal(0, 0.5, 2), angle=pose.angle + rng.uniform(1.5, 4.5))
        for found in cl.forward_kinematics(robot, lengths, center, all_solutions=True):
            if np.linalg.norm(found.position - pose.position) > 0.06:
                return found
""")],
    "covariance": [("pseudo-inverses, one measurement after the other", """
def pose_covariance(robot, pose, sigma):
    moves = sigma * np.linalg.pinv(cl.jacobian(robot, pose))
    return moves @ moves.T


def simulated_errors(robot, pose, sigma, count, seed):
    rng, exact, errors = np.random.default_rng(seed), cl.cable_lengths(robot, pose), []
    for _ in range(count):
        noisy = exact + sigma * rng.standard_normal(robot.n_cables)
        found = cl.forward_kinematics(robot, noisy, pose, tolerance=np.inf)
        errors.append([*(found.position - pose.position), float(found.angle - pose.angle)])
    return errors
""")],
    "fault": [("a comprehension, sums of squares", """
def leave_one_out(robot, lengths, guess):
    def without(i):
        rest, kept = without_cable(robot, i), np.array([l for k, l in enumerate(lengths) if k != i])
        r = kept - cl.cable_lengths(rest, cl.forward_kinematics(rest, kept, guess, tolerance=np.inf))
        return float(r @ r) ** 0.5
    return [without(i) for i in range(len(lengths))]
""")],
}
