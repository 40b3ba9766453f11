"""Lesson 14: the exercises' kind of input, the mutants that answer the same, and other right answers."""

from __future__ import annotations

import numpy as np


def units(rng, m, d):
    u = rng.normal(size=(m, d))
    return u / np.linalg.norm(u, axis=1, keepdims=True)


def lengths(rng, lesson):
    m, d = int(rng.integers(1, 9)), int(rng.integers(2, 4))
    R = np.linalg.qr(rng.normal(size=(d, d)))[0]
    return [("length_errors", (units(rng, m, d), R * np.sign(np.linalg.det(R)) if d == 3 else R,
                               *(0.01 * rng.normal(size=(2, m, d))), 0.01 * rng.normal(size=m)))]


def tensions(rng, lesson):
    n, m = [(1, 2), (2, 4), (3, 4), (3, 3), (6, 8)][rng.integers(5)]
    return [("tension_errors", (rng.normal(size=(n, m)), rng.uniform(1e3, 1e5, m), 0.01 * rng.normal(size=m)))]


def exit_point(rng, lesson):
    d = int(rng.integers(2, 4))
    B, A = rng.uniform(-1, 1, (20, d)), np.array([2.0, -1.5, 2.5])[:d] + rng.uniform(-0.2, 0.2, d)
    o = rng.uniform(-0.02, 0.02)
    read = np.linalg.norm(A - B, axis=1) + o + 1e-3 * rng.normal(size=20)
    return [("find_exit", (B, read, A + rng.uniform(-0.05, 0.05, d), o + 0.01))]


def ten(rng, lesson):
    count, m, d = int(rng.integers(20, 60)), int(rng.integers(1, 9)), int(rng.integers(2, 4))
    u = np.stack([units(rng, m, d) for _ in range(count)])
    return [("choose", (np.concatenate([u, np.ones((count, m, 1))], axis=2), int(rng.integers(5, 12))))]


DRAWS = {"reading": lengths, "tensions": tensions, "exit": exit_point, "ten": ten}
EQUIVALENT: dict[str, dict[str, str]] = {
    "exit": {"line 10: 20 → 21": "a step more, where nothing changes any more"},
    "ten": {"line 10: 1e-06 * np.eye(rows.shape[2]) → np.eye(rows.shape[2])":
            "a prior as strong as one row: judged by what is achieved",
            "line 10: 1e-06 → 1.000001": "the same",
            "line 10: 1e-06 * np.eye(rows.shape[2]) → 1e-06":
            "the first choices are arbitrary then, the later ones make up for it: judged by what is achieved"},
}
OTHERS = {
    "reading": [("a loop over the cables", """
def length_errors(u, R, dA, db, offsets):
    errors = []
    for along, exit_error, anchor_error, zero in zip(u, dA, db, offsets):
        errors.append(float(along @ exit_error - along @ (R @ anchor_error) + zero))
    return errors
""")],
    "tensions": [("both unknowns at once", """
def tension_errors(W, k, delta):
    n, m = W.shape
    # springs: tau / k + W' x = delta; balance: W tau = 0
    system = np.block([[np.diag(1 / k), W.T], [W, np.zeros((n, n))]])
    solved = np.linalg.solve(system, np.r_[delta, np.zeros(n)])
    return solved[m:], solved[:m]
"""), ("weighted least squares", """
def tension_errors(W, k, delta):
    root = np.sqrt(k)
    x = np.linalg.lstsq(root[:, None] * W.T, root * delta, rcond=None)[0]
    return [x.tolist(), (k * (delta - W.T @ x)).tolist()]
""")],
    "exit": [("scipy's least squares", """
def find_exit(B, lengths, A, o):
    from scipy.optimize import least_squares

    found = least_squares(lambda z: np.linalg.norm(z[:-1] - B, axis=1) + z[-1] - lengths, np.append(A, o),
                          xtol=1e-15, ftol=1e-15, gtol=1e-15).x
    return found[:-1].tolist(), found[-1]
""")],
    "ten": [("a weaker prior", """
def choose(rows, count):
    information, chosen = [1e-8 * np.eye(rows.shape[2]) for _ in rows[0]], []
    for _ in range(count):
        gains = [-np.inf if k in chosen else sum(np.linalg.slogdet(total + np.outer(row, row))[1]
                                                 for total, row in zip(information, pose))
                 for k, pose in enumerate(rows)]
        chosen.append(gains.index(max(gains)))
        information = [total + np.outer(row, row) for total, row in zip(information, rows[chosen[-1]])]
    return chosen
"""), ("corners of a search by luck", """
def choose(rows, count):
    rng, best, found = np.random.default_rng(0), np.inf, None
    for _ in range(5000):
        indices = rng.permutation(len(rows))[:count]
        some = rows[indices]
        total = np.einsum("kia,kib->iab", some, some) + 1e-9 * np.eye(rows.shape[2])
        worst = np.diagonal(np.linalg.inv(total), axis1=1, axis2=2)[:, :-1].max()
        if worst < best:
            best, found = worst, indices
    for _ in range(3):
        for place in range(count):
            for other in set(range(len(rows))) - set(found.tolist()):
                tried = found.copy()
                tried[place] = other
                some = rows[tried]
                total = np.einsum("kia,kib->iab", some, some) + 1e-9 * np.eye(rows.shape[2])
                worst = np.diagonal(np.linalg.inv(total), axis1=1, axis2=2)[:, :-1].max()
                if worst < best:
                    best, found = worst, tried
    return found
"""), ("least trace instead of largest determinant", """
def choose(rows, count):
    chosen, total = [], np.tile(1e-4 * np.eye(rows.shape[2]), (rows.shape[1], 1, 1))
    for _ in range(count):
        costs = []
        for pose in rows:
            after = total + pose[:, :, None] * pose[:, None, :]
            costs.append(np.trace(np.linalg.inv(after), axis1=1, axis2=2).sum())
        best = min(set(range(len(rows))) - set(chosen), key=lambda k: costs[k])
        chosen.append(best)
        total = total + rows[best][:, :, None] * rows[best][:, None, :]
    return chosen
""")],
}
