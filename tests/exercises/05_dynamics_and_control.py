"""Lesson 05: the exercises' kind of input, the mutants that answer the same, and other right answers."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

import cdprlab as cl


def quintic(rng, lesson):
    return [("quintic_coefficients", (*rng.normal(size=6), rng.uniform(0.5, 3)))]


def wrench(rng, lesson):
    root = rng.normal(size=(3, 3))
    return [("body_wrench", (rng.uniform(1, 30), root @ root.T + np.eye(3),
                             Rotation.from_rotvec(rng.normal(size=3)).as_matrix(), *rng.normal(size=(3, 3)),
                             rng.uniform(1, 12)))]


def controller(rng, lesson):
    world = lesson["caroca"] if rng.integers(2) else lesson["light"]
    ends = [cl.Pose(rng.normal(size=3), rpy=rng.uniform(-1, 1, 3)) for _ in range(2)]
    wish = cl.quintic(*ends, 1.5)(rng.uniform(0.2, 1.3))
    pose = cl.Pose(wish.pose.position + rng.normal(0, 0.05, 3), rpy=wish.pose.rpy + rng.normal(0, 0.1, 3))
    state = cl.State(0.3, world.robot, pose.position, pose.rotation, rng.normal(size=6), np.zeros(8))
    return [("my_controller", (0.3, state, wish, *rng.uniform(10, 300, 2)))]


def clock(rng, lesson):
    dt = 10 ** rng.uniform(-4, -1.5)
    return [("largest_stable_kd", (rng.uniform(0.1, 2.0) / dt**2, dt))]


def tune(rng, lesson):
    dt, jitter = 10 ** rng.uniform(-3, -1.3), rng.uniform(0, 0.9)
    jump, most = rng.uniform(0.01, 0.3), rng.uniform(1, 30)
    return [("choose_gains", (dt, jitter, jump, most, rng.uniform(2, 12) * (jump / most)**0.5))]


DRAWS = {"quintic": quintic, "wrench": wrench, "controller": controller, "clock": clock, "tune": tune}
BOLDER = "other gains that achieve what is asked"
SYMMETRIC = "the inertia is symmetric"
EQUIVALENT: dict[str, dict[str, str]] = {
    "tune": {"line 12: 1 + jitter → 1": BOLDER, "line 12: dt * (1 + jitter) → dt": BOLDER,
             "line 13: 0.9 * most → most": "all that is allowed may be asked for",
             "line 17: 2 * np.sqrt(kp) → np.sqrt(kp)": BOLDER},
    "wrench": {"line 15: [0.0, 0.0, gravity] → [0.0, 0.0, gravity]": "two zeros change places",
               "line 16: turned @ alpha → alpha @ turned": SYMMETRIC,
               "line 16: turned @ omega → omega @ turned": SYMMETRIC},
}
OTHERS = {
    "quintic": [("six equations at once", """
def quintic_coefficients(x0, v0, a0, x1, v1, a1, T):
    def rows(t):
        return [[t**k for k in range(6)], [k * t**(k - 1) if k else 0 for k in range(6)],
                [k * (k - 1) * t**(k - 2) if k > 1 else 0 for k in range(6)]]
    return np.linalg.solve(np.array(rows(0.0) + rows(T), float), [x0, v0, a0, x1, v1, a1]).tolist()
""")],
    "wrench": [("in platform axes, then turned", """
def body_wrench(mass, inertia, R, omega, a, alpha, gravity=9.81):
    spin, gain = R.T @ omega, R.T @ alpha
    L = inertia @ spin
    turning = [spin[1] * L[2] - spin[2] * L[1], spin[2] * L[0] - spin[0] * L[2], spin[0] * L[1] - spin[1] * L[0]]
    moment = R @ (inertia @ gain + turning)
    return [mass * a[0], mass * a[1], mass * (a[2] + gravity), *moment]
""")],
    "controller": [("mass matrix and scipy's rotation vector", """
def my_controller(t, state, reference, kp=100.0, kd=20.0):
    R, spin, body = state.rotation, state.twist[3:], state.robot.platform
    inertia = R @ body.inertia @ R.T
    M = np.zeros((6, 6))
    M[:3, :3], M[3:, 3:] = body.mass * np.eye(3), inertia
    e = np.zeros(6)
    e[:3] = reference.pose.position - state.position
    e[3:] = Rotation.from_matrix(reference.pose.rotation @ R.T).as_rotvec()
    bias = np.array([0, 0, body.mass * state.robot.gravity, *np.cross(spin, inertia @ spin)])
    return M @ (reference.acceleration + kd * (reference.twist - state.twist) + kp * e) + bias
""")],
    "clock": [("a scan in steps of 1", """
def largest_stable_kd(kp, dt):
    kd, step = 0.0, max(1.0, 5e-4 / dt)
    def stable(kd):
        A = np.array([[1 - kp * dt**2, dt * (1 - kd * dt)], [-kp * dt, 1 - kd * dt]])
        return np.abs(np.linalg.eigvals(A)).max() < 1
    while stable(kd + step):
        kd += step
    return int(kd)
""")],
    "tune": [("a search that flies each choice", """
def choose_gains(dt, jitter, jump, most, time):
    rng = np.random.default_rng(0)
    count = int(2.2 * time / (dt * (1 - jitter))) + 2
    ways = [rng.uniform(-1, 1, count), np.ones(count), -np.ones(count), (-1.0) ** np.arange(count)]
    for kp in 0.95 * most / jump / 1.4 ** np.arange(30):
        for damping in (0.9, 1.0, 1.2):
            kd, good = 2 * damping * kp**0.5, True
            for late in ways:
                t, e, a = swing(kp, kd, jump, dt * (1 + jitter * late))
                good &= bool(np.all(np.abs(a) <= most) and np.all(np.abs(e[t > 0.95 * time]) < 0.04 * jump))
            if good and t.max() > time:
                return [kp, kd]
    raise ValueError("no gains do it")
""")],
}
