"""Lesson 11: the exercises' kind of input, the mutants that answer the same, and other right answers."""

from __future__ import annotations

import numpy as np


def triplets(rng, lesson):
    m = rng.integers(3, 7)
    exits = np.column_stack([rng.uniform(-3, 3, (m, 2)), rng.uniform(2, 4, m)])
    return [("holding_triplets", (exits, np.append(rng.uniform(-2, 2, 2), rng.uniform(0, 4))))]


def hang(rng, lesson):
    angle = rng.uniform(0, 2 * np.pi) + np.array([0, 2.1, 4.2]) + rng.uniform(-0.4, 0.4, 3)
    exits = np.column_stack([2 * np.cos(angle), 2 * np.sin(angle), rng.uniform(2.5, 3.5, 3)])[rng.permutation(3)]
    load = np.append(rng.uniform(-1, 1, 2), rng.uniform(0, 1.8))
    lengths = np.linalg.norm(exits - load, axis=1)
    return [("hang", (exits, lengths)), ("hang", (exits, lengths * rng.uniform(0.3, 1.2)))]


def score(rng, lesson):
    exits = rng.uniform(-3, 3, (5, 3)) + [0, 0, 6]
    steps = [(rng.uniform(-2, 2, 3), tuple(int(i) for i in rng.permutation(5)[:3] + 1)) for _ in range(4)]
    return [("score", (exits, steps, [int(change) for change in rng.choice([0, 4], 2)]))]


def change(rng, lesson):
    m = rng.integers(4, 7)
    a, b, old, new = (int(i) for i in rng.permutation(m)[:4] + 1)
    return [("change_lengths", (rng.uniform(1, 4, m), (a, b, old), (a, new, b), rng.uniform(0.05, 0.3),
                                int(rng.integers(2, 6))))]


DRAWS = {"triplets": triplets, "hang": hang, "score": score, "change": change}
AROUND = "walks round the triangle the other way: all three sides change their sign, and both signs count"
NORMAL = "the normal turns round, and its sign is taken out again"
PLANE = "another corner of the same plane"
EQUIVALENT: dict[str, dict[str, str]] = {
    "triplets": {
        ("line 13: edges[:, 0] * to_load[:, 1] - edges[:, 1] * to_load[:, 0] → "
         "edges[:, 1] * to_load[:, 0] - edges[:, 0] * to_load[:, 1]"): AROUND,
        "line 12: np.roll(a, -1, axis=0) - a → a - np.roll(a, -1, axis=0)": AROUND,
        "line 12: -1 → 1": AROUND,
        "line 12: 1 → 2": AROUND,
        "line 14: np.cross(a[1] - a[0], a[2] - a[0]) → np.cross(a[2] - a[0], a[1] - a[0])": NORMAL,
        "line 14: a[1] - a[0] → a[0] - a[1]": NORMAL,
        "line 14: a[2] - a[0] → a[0] - a[2]": NORMAL,
        "line 14: a[0] → a[1]": "two edges of the triangle span its plane, whichever they are",
        "line 14: 0 → 1": "two edges of the triangle span its plane, whichever they are",
        "line 15: normal @ to_load[0] → to_load[0] @ normal": "a dot product",
        "line 15: to_load[0] → to_load[1]": PLANE,
        "line 15: 0 → 1": PLANE,
    },
    "hang": {
        "line 12: x0 @ x0 → x0 @ x0": "a dot product with itself",
        "line 15: np.cross(a[0], a[1]) → np.cross(a[1], a[0])": "both points are compared, whichever is called first",
    },
    "score": {
        ("line 13: corners[:, :2] - np.asarray(position)[:2] → np.asarray(position)[:2] - corners[:, :2]"):
            "a distance has no direction",
    },
}
OTHERS = {
    "triplets": [("by the tensions", """
def holding_triplets(exit_points, position):
    found = []
    for chosen in combinations(range(len(exit_points)), 3):
        pulls = exit_points[list(chosen)] - position
        if abs(np.linalg.det(pulls)) > 1e-9 and np.all(np.linalg.solve(pulls.T, [0, 0, 1]) > 1e-9):
            found.append([i + 1 for i in chosen])
    return np.array(found)
""")],
    "score": [("loops", """
def score(exit_points, steps, transition_scores):
    places = []
    for (x, y, z), chosen in steps:
        d = [((exit_points[i - 1][0] - x)**2 + (exit_points[i - 1][1] - y)**2)**0.5 for i in chosen]
        places.append(float(min(4, 5 * (1 - min(d) / max(d)) // 1)))
    return [places, np.float32(sum(places) + sum(transition_scores))]
""")],
    "change": [("row by row", """
def change_lengths(exact, old, new, slack, count):
    comes, = set(new) - set(old)
    goes, = set(old) - set(new)
    row = [length + slack * (i not in old) for i, length in enumerate(exact, start=1)]
    rows = [list(row)]
    for rope, step in ((comes, -slack / count), (goes, slack / count)):
        for _ in range(count):
            row[rope - 1] += step
            rows.append(list(row))
    return rows
""")],
}
