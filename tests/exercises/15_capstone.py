"""Lesson 15: the exercises' kind of input, the mutants that answer the same, and other right answers."""

from __future__ import annotations


def margin(rng, lesson):
    n, m = [(1, 2), (2, 4), (3, 3), (3, 5), (6, 8)][rng.integers(5)]
    low = rng.uniform(0, 30, m)
    high, W = low + rng.uniform(20, 200, m), rng.normal(size=(n, m))
    if rng.integers(8) == 0:
        W[-1] = 0.0  # nothing balances a push along the last axis
    weight = -W @ rng.uniform(low, high)
    return [("worst_push", (W, weight, rng.normal(size=(4, n)) * rng.choice([3.0, 300.0]), low, high))]


def a_design(name):
    return lambda rng, lesson: [(name, ())]


DRAWS = {"margin": margin, "design": a_design("my_design"), "six": a_design("six_cables")}
MEETS = "another design that meets the brief: a design is judged by what it achieves"
EQUIVALENT: dict[str, dict[str, str]] = {
    "margin": {"line 15: 1.0 → 2.0": "twice the cost has the same minimizer"},
    "design": dict.fromkeys([
        ("line 8: [[x, -y, -z], [-x, y, z], [-x, -y, z], [x, y, -z], [-x, -... → "
         "[[-x, y, z], [x, -y, -z], [-x, -y, z], [x, y, -z], [-x, -..."),
        "line 8: -x → x", "line 8: -y → y", "line 9: -x → x", "line 13: 3.2 if anchor[2] < 0 else 3.6 → 3.2",
        "line 13: 0 → 1"], MEETS),
    "six": {**dict.fromkeys(["line 9: [2.0, 2.2, 3.6] → [2.2, 2.0, 3.6]", "line 9: 2.0 → 3.0", "line 9: 1.0 → 2.0",
                             "line 9: -3.0 → 3.0"], MEETS),
            "line 10: [0.0, 0.0, 0.2] → [0.0, 0.0, 0.2]": "both zeros are the same"},
}
OTHERS = {
    "margin": [("all pushes in one program's matrices, answer as a list", """
def worst_push(W, weight, pushes, tension_min, tension_max):
    m, margins = len(tension_min), []
    for push in pushes:
        rows = np.vstack([np.c_[np.ones(m), -np.eye(m)], np.c_[np.ones(m), np.eye(m)]])
        found = linprog([-1.0] + [0.0] * m, A_ub=rows,
                        b_ub=[*-tension_min, *tension_max], A_eq=np.c_[np.zeros(len(W)), W], b_eq=-weight - push,
                        bounds=[(None, None)] * (m + 1))
        margins.append(-found.fun if found.success else float("-inf"))
    least = min(margins)
    return [least, margins.index(least)]
"""), ("tensions as shares between the limits", """
def worst_push(W, weight, pushes, tension_min, tension_max):
    middle, half = (tension_min + tension_max) / 2, (tension_max - tension_min) / 2
    worst = (np.inf, -1)
    for k, push in enumerate(pushes):
        # tau = middle + d, |d| + s <= half
        m = len(middle)
        A = np.block([[np.eye(m), np.ones((m, 1))], [-np.eye(m), np.ones((m, 1))]])
        found = linprog(np.r_[np.zeros(m), -1], A, np.r_[half, half], np.c_[W, np.zeros(len(W))],
                        -(W @ middle + weight + push), bounds=(None, None))
        s = np.float32(found.x[-1]) if found.status == 0 else -np.inf
        worst = min(worst, (s, k))
    return worst
""")],
    "design": [("a World", """
def my_design():
    anchors = [[0.4, -0.3, -0.2], [-0.4, 0.3, 0.2], [-0.4, -0.3, 0.2], [0.4, 0.3, -0.2],
               [-0.4, -0.3, -0.2], [0.4, 0.3, 0.2], [0.4, -0.3, 0.2], [-0.4, 0.3, -0.2]]
    corners = [(-3, -2.2), (-3, -2.2), (3, -2.2), (3, -2.2), (-3, 2.2), (-3, 2.2), (3, 2.2), (3, 2.2)]
    exits = np.array([[x, y, 3.1 if b[2] < 0 else 3.6] for (x, y), b in zip(corners, anchors)])
    return cl.World.from_dict(robot_file(exits, np.array(anchors), "crossed"))
""")],
    "six": [("a saved file's path", """
def six_cables():
    three = [([2.0, 2.2, 3.6], [0.4, 0.0, -0.2]), ([1.0, 2.2, 3.6], [0.4, -0.3, 0.2]), ([-3.0, -2.2, 3.6], [0, 0, 0.2])]
    both = three + [([-a[0], *a[1:]], [-b[0], *b[1:]]) for a, b in three]
    cl.World.from_dict(robot_file(*zip(*both), "six")).save("my_six.yaml")
    return "my_six.yaml"
""")],
}
