"""Lesson 04: the exercises' kind of input, the mutants that answer the same, and other right answers."""

from __future__ import annotations

import numpy as np
from scipy.linalg import null_space

import cdprlab as cl


def interval(rng, lesson):
    m = int(rng.integers(2, 7))
    return [("admissible_interval", (rng.uniform(-300, 500, m), rng.choice([-1, 1], m) * rng.uniform(0.1, 3, m),
                                     rng.uniform(0, 60, m), rng.uniform(150, 600, m)))]


def turned(rng):
    return cl.Pose(rng.uniform([-1.5, -1, 0.6], [1.5, 1, 2.4]), rpy=rng.uniform(-0.25, 0.25, 3))


def held(rng, lesson):
    """W, w_e and limits of CAROCA, or of a platform in the plane."""
    robot, pose = lesson["caroca"].robot, turned(rng)
    if rng.integers(3) == 0:
        robot = lesson["planar"].robot
        pose = cl.Pose(rng.uniform([-0.8, 0.5], [0.8, 2]), angle=rng.uniform(-0.3, 0.3))
    m = robot.n_cables
    low, high = (rng.uniform(20, 250, m), rng.uniform(400, 1500, m)) if m == 8 else (
        rng.uniform(5, 60, m), rng.uniform(150, 400, m))
    return cl.wrench_matrix(robot, pose), cl.gravity_wrench(robot, pose), low, high


def polygon(rng, lesson):
    robot, pose = lesson["caroca"].robot, turned(rng)
    W, w_e = cl.wrench_matrix(robot, pose), cl.gravity_wrench(robot, pose)
    angles, place = np.sort(rng.uniform(0, 2 * np.pi, int(rng.integers(3, 8)))), rng.normal(size=2) * 10
    corners = place + rng.uniform(2, 5) * np.column_stack([np.cos(angles), np.sin(angles)])
    return [("feasible_corners", (-np.linalg.pinv(W) @ w_e, null_space(W), rng.uniform(20, 120, 8),
                                  rng.uniform(350, 1500, 8))), ("centroid", (corners,))]


def closed(rng, lesson):
    return [("closed_form", held(rng, lesson))]


def least(rng, lesson):
    return [("least_tensions", held(rng, lesson))]


def breaks(rng, lesson):
    robot = lesson["caroca"].robot.with_payload(rng.uniform(1, 80), rng.uniform(-0.1, 0.1, 3))
    method = str(rng.choice(["linear_program", "closed_form", "improved_closed_form", "pseudo_inverse"]))
    return [("may_break", (robot, turned(rng), method)), ("forgiving_pose", (robot,))]


DRAWS = {"interval": interval, "polygon": polygon, "closed": closed, "least": least, "break": breaks}
ORDER = "the order of lines, or of the two ends of each, is of no account"
AROUND = "corners may be walked around either way, from any of them"
EQUIVALENT: dict[str, dict[str, str]] = {
    "interval": {"line 10: [(tau_min - tau_p) / h, (tau_max - tau_p) / h] → "
                 "[(tau_max - tau_p) / h, (tau_min - tau_p) / h]": ORDER},
    "polygon": {
        "line 10: [N, N] → [N, N]": "both halves are the same",
        "line 10: [tau_min - tau_p, tau_max - tau_p] → [tau_max - tau_p, tau_min - tau_p]": ORDER,
        "line 11: 1e-09 * np.max(tau_max) → 1e-09": "another size of rounding",
        "line 11: np.max(tau_max) → np.min(tau_max)": "another size of rounding",
        "line 22: np.array(found) - np.mean(found, axis=0) → np.mean(found, axis=0) - np.array(found)": AROUND,
        "line 34: -1 → 1": AROUND,
        "line 35: corners[:, 0] * after[:, 1] - after[:, 0] * corners[:, 1] → "
        "after[:, 0] * corners[:, 1] - corners[:, 0] * after[:, 1]": AROUND},
    "least": {"line 16: -N.T → N.T": "N.T @ tau_p is zero for τ_p = −W⁺ w_e, as the lesson says"},
    "break": {"line 27: 0 → 1": "other poses are tried; any that forgives is right",
              "line 29: -0.8 → 0.8": "poses at one border of the range are in it",
              "line 29: -0.3 → 0.3": "poses at one border of the range are in it",
              "line 31: 6 → 7": "a pose that forgives eight forgives seven",
              "line 29: 0.8 → 1.8": "poses beyond the range forgive no more: what is found lies in it"},
}
OTHERS = {
    "interval": [("cable by cable", """
def admissible_interval(tau_p, h, tau_min, tau_max):
    lo, hi = -np.inf, np.inf
    for start, slope, low, high in zip(tau_p, h, tau_min, tau_max):
        one, other = (low - start) / slope, (high - start) / slope
        if slope < 0:
            one, other = other, one
        lo, hi = max(lo, one), min(hi, other)
    return [float(lo), float(hi)]
""")],
    "polygon": [("cut the plane line by line, walk the other way round", """
def feasible_corners(tau_p, N, tau_min, tau_max):
    size = 1e6
    corners = [np.array(c, float) for c in ([-size, -size], [size, -size], [size, size], [-size, size])]
    for row, low, high in zip(N, tau_min - tau_p, tau_max - tau_p):
        for normal, most in ((row, high), (-row, -low)):
            kept = []
            for k, here in enumerate(corners):
                there = corners[(k + 1) % len(corners)]
                a, b = most - normal @ here, most - normal @ there
                if a >= 0:
                    kept.append(here)
                if a * b < 0:
                    kept.append(here + a / (a - b) * (there - here))
            corners = kept
    return np.array(corners[::-1]).reshape(-1, 2)


def centroid(corners):
    total, moment = 0.0, np.zeros(2)
    for k in range(1, len(corners) - 1):
        a, b = corners[k] - corners[0], corners[k + 1] - corners[0]
        area = (a[0] * b[1] - a[1] * b[0]) / 2
        total, moment = total + area, moment + area * (corners[0] + corners[k] + corners[k + 1]) / 3
    return list(moment / total)
""")],
    "closed": [("least squares", """
def closed_form(W, w_e, tau_min, tau_max):
    tau = [0.5 * (low + high) for low, high in zip(tau_min, tau_max)]
    tau = np.array(tau) - np.linalg.lstsq(W, W @ tau + w_e, rcond=None)[0]
    kept = all(low <= one <= high for one, low, high in zip(tau, tau_min, tau_max))
    return list(tau), kept
""")],
    "least": [("the library's", """
def least_tensions(W, w_e, tau_min, tau_max):
    found = cl.distribute_tensions(W, w_e, tau_min, tau_max, "quadratic_program")
    return list(found.tensions) if found.feasible else None
""")],
    "break": [("limits of zero, a batch of poses", """
def may_break(robot, pose, method):
    W, w_e = cl.wrench_matrix(robot, pose), cl.gravity_wrench(robot, pose)
    broken = {}
    for i in range(W.shape[1]):
        rest = [k for k in range(W.shape[1]) if k != i]
        found = cl.distribute_tensions(W[:, rest], w_e, robot.tension_min[rest], robot.tension_max[rest], method)
        broken[i + 1] = bool(found.feasible)
    return {i for i, holds in broken.items() if holds}


def forgiving_pose(robot):
    rng = np.random.default_rng(3)
    while True:
        position = rng.uniform([-0.8, -0.3, 1.5], [0.8, 0.3, 2.3])
        for _ in range(20):
            pose = cl.Pose(position, rpy=rng.uniform(-0.3, 0.3, 3))
            if len(may_break(robot, pose, "quadratic_program")) >= 7:
                return pose
""")],
}
