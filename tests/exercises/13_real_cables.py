"""Lesson 13: the exercises' kind of input, the mutants that answer the same, and other right answers."""

from __future__ import annotations

import numpy as np


def pulley(rng, lesson):
    d, radius = int(rng.integers(2, 4)), rng.uniform(0.02, 0.4)
    axis, A = rng.normal(size=d), rng.normal(size=d)
    axis /= np.linalg.norm(axis)
    reach = rng.normal(size=d)
    # Every fifth one lies inside the wheel.
    reach *= (rng.uniform(0.1, 0.3) if rng.integers(5) == 0 else rng.uniform(3, 9)) * radius / np.linalg.norm(reach)
    across = reach - (reach @ axis) * axis
    return [("over_pulley", (A, A + radius * across / np.linalg.norm(across) + reach, axis, radius))]


def sag(rng, lesson):
    span = rng.uniform(2, 9, int(rng.integers(2, 4))) * rng.choice([-1, 1])
    return [("least_pull", (span, rng.uniform(0.02, 0.4), rng.uniform(5e4, 5e5), rng.uniform(0.003, 0.05)))]


def stiffness(rng, lesson):
    m = int(rng.integers(1, 7))
    u = rng.normal(size=(m, 2))
    return [("planar_stiffness", (u / np.linalg.norm(u, axis=1, keepdims=True), rng.normal(size=(m, 2)) / 2,
                                  rng.uniform(0.5, 4, m), rng.uniform(0, 200, m), rng.uniform(50, 2000, m)))]


def friction(rng, lesson):
    k = int(rng.integers(20, 60))
    speed, change, load = rng.normal(size=k) * 40 + 5, rng.normal(size=k) * 200, rng.normal(size=k)
    speed[::10] = 0.0
    torque = 0.03 * np.sign(speed) + 2e-3 * speed + 5e-4 * change + load + rng.normal(size=k) * 1e-2
    return [("fit_friction", (speed, change, torque, load))]


DRAWS = {"pulley": pulley, "sag": sag, "stiffness": stiffness, "friction": friction}
EQUIVALENT: dict[str, dict[str, str]] = {
    "pulley": {"line 13: d @ axis → axis @ d": "a dot product of two vectors",
               "line 17: x - radius → radius - x": "the hypotenuse does not ask for signs",
               "line 19: x - radius → radius - x": "it is squared"},
    "sag": {"line 14: 1.2 * chord → chord": "what is straight enough here is shorter than the chord",
            "line 14: 1.2 → 2.2": "halved often enough, a longer interval ends at the same length",
            "line 15: 60 → 61": "halved once more",
            "line 18: 1001 → 1002": "one point more"},
    "stiffness": {"line 15: np.outer(u_i, u_i) → np.outer(u_i, u_i)": "both factors are the same vector",
                  "line 17: r_i @ u_i → u_i @ r_i": "a dot product of two vectors"},
}
OTHERS = {
    "pulley": [("complex numbers", """
def over_pulley(A, B, axis, radius):
    d = [b - a for a, b in zip(A, B)]
    z = sum(p * q for p, q in zip(d, axis))
    across = [p - z * q for p, q in zip(d, axis)]
    x = sum(p * p for p in across) ** 0.5
    from_center = complex(x - radius, z)
    if abs(from_center) < radius:
        raise ValueError("inside")
    s = (abs(from_center)**2 - radius**2) ** 0.5
    leaving = from_center / complex(s, radius)          # along the free part, seen as (across, along)
    wrap = np.angle(1j * leaving.conjugate()) % (2 * np.pi)
    T = [a + radius * (1 - np.cos(wrap)) * p / x + radius * np.sin(wrap) * q for a, p, q in zip(A, across, axis)]
    return [radius * wrap + s, T]
""")],
    "sag": [("brentq on the length", """
def least_pull(span, density, axial_stiffness, sag):
    from scipy.optimize import brentq
    chord = np.linalg.norm(span)
    def more(length):
        points = cl.sagging_cable(span, length, density, axial_stiffness).points(301)
        along = np.linalg.norm(points[:, :-1], axis=1) / np.linalg.norm(span[:-1])
        return (along * span[-1] - points[:, -1]).max() - sag
    length = brentq(more, chord / 1.04, 1.2 * chord)
    return float(np.linalg.norm(cl.sagging_cable(span, length, density, axial_stiffness).force_at_anchor))
""")],
    "stiffness": [("all cables at once", """
def planar_stiffness(u, r, lengths, tensions, springs):
    M = np.zeros((len(u), 2, 3))
    M[:, 0, 0] = M[:, 1, 1] = 1
    M[:, 0, 2], M[:, 1, 2] = -r[:, 1], r[:, 0]
    along = u[:, :, None] * u[:, None, :]
    inner = springs[:, None, None] * along + (tensions / lengths)[:, None, None] * (np.eye(2) - along)
    K = np.einsum("mia,mij,mjb->ab", M, inner, M)
    K[2, 2] += np.sum(tensions * np.sum(r * u, axis=1))
    return K.tolist()
""")],
    "friction": [("normal equations", """
def fit_friction(speed, change, torque, load):
    rows = [[float(v > 0) - float(v < 0), v, a] for v, a in zip(speed, change)]
    M = np.array(rows)
    return np.linalg.solve(M.T @ M, M.T @ (np.array(torque) - load)).tolist()
""")],
}
