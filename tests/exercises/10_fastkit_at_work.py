"""Lesson 10: the exercises' kind of input, the mutants that answer the same, and other right answers."""

from __future__ import annotations

import numpy as np

from cdprlab.fastkit import Hall


def clearance(rng, lesson):
    shape = tuple(rng.integers(5, 20, 2))
    return [("clearance", (rng.random(shape) < rng.choice([0, 0.02, 0.2]), rng.uniform(0.02, 0.5)))]


def match(rng, lesson):
    h, angles = int(rng.integers(1, 8)), rng.uniform(-3, 3, 8)
    q0, root = rng.normal(size=3) * [3, 3, 1.5], rng.normal(size=(3, 3)) * 0.1 + 0.1 * np.eye(3)
    points, normals = rng.normal(size=(h, 2)) * 2, np.column_stack([np.cos(angles[:h]), np.sin(angles[:h])])
    return [("match_step", (q0 + rng.normal(size=3) * 0.1, q0, root @ root.T, points,
                            rng.normal(size=(h, 2)) * 0.1 + q0[:2] + points, normals, rng.uniform(0.02, 0.3)))]


def guard(rng, lesson):
    berth, allowed = rng.uniform([-5, -5, -7], [5, 5, 7]), np.array([0.05, 0.05, 0.035]) * rng.uniform(0.2, 2, 3)
    off = rng.uniform(-0.8, 0.8, 3) * allowed + [0, 0, 2 * np.pi * rng.integers(-1, 2)]
    return [("guard_at_the_shelf", (berth, berth + off, rng.uniform(0, 0.3, 3) * allowed, allowed))]


def landmark(rng, lesson):
    x, y, turn = *rng.uniform(-5, 5, 2), rng.uniform(-3, 3)
    along, width = np.array([np.cos(turn), np.sin(turn)]), rng.uniform(4.0, 5.5)
    walls = [[*([x, y] + side * (width / 2 + 0.05) * along[::-1] * [-1, 1]), 14.0, 0.1, turn] for side in (1, -1)]
    way = np.linspace([*([x, y] - 4 * along), turn], [x, y, turn], 41)
    return [("landmark", (Hall.of(walls, [[x - 9, y - 9], [x + 9, y + 9]]), way, rng.uniform([0.08, 0.02, 0.01],
                          [0.3, 0.1, 0.05]), np.array([0.055, 0.055, 0.035]), rng.uniform(0.7, 1.0)))]


def drive(rng, lesson):
    speed, acceleration = rng.uniform(0.05, 1.0, 2)
    way = rng.choice([-1, 0, 1]) * speed**2 / acceleration * 10 ** rng.uniform(-2, 1)
    t = np.linspace(-1, 4 + 2 * abs(way) / speed, int(rng.integers(20, 40)))
    return [("rest_to_rest", (t, way, speed, acceleration))]


DRAWS = {"clearance": clearance, "match": match, "guard": guard, "landmark": landmark, "drive": drive}
CHOICE = "another place that achieves what is asked"
TURN = "an angle's absolute value has no direction, and a whole turn is none"
EQUIVALENT: dict[str, dict[str, str]] = {
    "match": {"line 18: before @ (pose - predicted) → (pose - predicted) @ before": "a covariance is symmetric"},
    "guard": {
        "line 10: berth - believed → believed - berth": "a distance has no direction",
        ("line 11: (berth[2] - believed[2] + np.pi) % (2 * np.pi) - np.pi → "
         "np.pi - (berth[2] - believed[2] + np.pi) % (2 * np.pi)"): TURN,
        "line 11: berth[2] - believed[2] + np.pi → berth[2] - believed[2] - np.pi": TURN,
        "line 11: berth[2] - believed[2] → believed[2] - berth[2]": TURN,
    },
    "landmark": {
        **{f"line {line}": CHOICE for line in (
            "12: 3 → 4", "12: 13 → 14", "13: 0.2 → 1.2", "13: 0.9 → 1.9", "14: berth[2] + angle → berth[2] - angle",
            "14: berth[2] + angle → berth[2]", "14: berth[2] + angle → angle", "17: 2 → 3")},
        "line 12: 1 → 2": "the pose just before the berth",
        "landmark: the last number off by a percent": CHOICE,
    },
}
OTHERS = {
    "clearance": [("the true distance between squares, cell by cell", """
def clearance(occupied, cell):
    taken = np.argwhere(np.pad(occupied, 1, constant_values=True)) - 1
    found = []
    for i in range(len(occupied)):
        row = []
        for j in range(len(occupied[0])):
            steps = np.maximum(np.abs(taken - [i, j]) - 1, 0)
            row.append(0.0 if occupied[i][j] else cell * np.sqrt((steps**2).sum(axis=1).min()))
        found.append(row)
    return found
""")],
    "match": [("a Kalman filter's gain", """
def match_step(pose, predicted, covariance, points, feet, normals, sigma):
    c, s = np.cos(pose[2]), np.sin(pose[2])
    rows, e = [], []
    for (px, py), m, (nx, ny) in zip(points, feet, normals):
        x, y = c * px - s * py, s * px + c * py
        rows.append([nx, ny, ny * x - nx * y])
        e.append(nx * (pose[0] + x - m[0]) + ny * (pose[1] + y - m[1]))
    J = np.array(rows)
    gain = covariance @ J.T @ np.linalg.inv(J @ covariance @ J.T + sigma**2 * np.eye(len(e)))
    return predicted - gain @ (np.array(e) + J @ (predicted - pose)), (np.eye(3) - gain @ J) @ covariance
""")],
    "guard": [("component by component, in centimeters and radians", """
def guard_at_the_shelf(berth, believed, deviations, allowed):
    turn = abs(np.angle(np.exp(1j * (berth[2] - believed[2]))))
    worst = [abs(berth[0] - believed[0]), abs(berth[1] - believed[1]), turn]
    worst = [w + 2 * s for w, s in zip(worst, deviations)]
    if all(w <= a for w, a in zip(worst, allowed)):
        return ""
    return f"x: {100 * worst[0]:.1f} cm, y: {100 * worst[1]:.1f} cm, heading: {worst[2]:.3f} rad"
""")],
    "landmark": [("at random", """
def landmark(hall, way, doubt, allowed, free):
    rng = np.random.default_rng(0)
    for _ in range(300):
        pallet = [*(way[-1][:2] + rng.uniform(-3.5, 3.5, 2)), rng.uniform(0, 3)]
        if keeps_clear(hall, pallet, way, free):
            if (2 * sure_after(with_pallet(hall, pallet), way[-1], doubt) < allowed).all():
                return pallet
    raise ValueError("none found")
""")],
    "drive": [("corners of the trapezoid", """
def rest_to_rest(t, way, speed, acceleration):
    if way == 0:
        return [0.0] * len(t), 0
    peak = min(speed, (acceleration * abs(way))**0.5)
    rise = peak / acceleration
    end = abs(way) / peak + rise
    return list(np.sign(way) * np.interp(t, [0, rise, end - rise, end], [0, peak, peak, 0])), np.float32(end)
""")],
}
