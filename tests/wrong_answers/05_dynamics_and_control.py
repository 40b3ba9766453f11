"""Plausible mistakes in lesson 05; each must earn nothing."""

QUINTIC = '''
def quintic_coefficients(x0, v0, a0, x1, v1, a1, T):
    """Wrong on purpose."""
    ends = np.array([[T**3, T**4, T**5], [3 * T**2, 4 * T**3, 5 * T**4], [6 * T, 12 * T**2, 20 * T**3]])
    missing = [{missing}]
    c = np.concatenate([[x0, v0, {bend}], np.linalg.solve(ends, missing)])
    return c{order}
'''
MISSING = "x1 - x0 - v0 * T - a0 * T**2 / 2, v1 - v0 - a0 * T, a1 - a0"

PRINTED = '''
def quintic_coefficients(x0, v0, a0, x1, v1, a1, T):
    """Wrong on purpose: as printed in the thesis, (6.16) to (6.21)."""
    d = x1 - x0
    return np.array([x0, v0, a0 / 2, (20 * d - (8 * v1 + 12 * v0) * T - (3 * a1 - a0) * T**2) / (2 * T**3),
                     (30 * d + (14 * v1 + 16 * v0) * T + (3 * a1 - 2 * a0) * T**2) / (2 * T**4),
                     (12 * d - (6 * v1 + v0) * T - (a1 - a0) * T**2) / (2 * T**5)])
'''

WRENCH = '''
def body_wrench(mass, inertia, R, omega, a, alpha, gravity=9.81):
    """Wrong on purpose."""
    turned = {turned}
    force = mass * (np.asarray(a) {weight} np.array([0.0, 0.0, gravity]))
    moment = turned @ alpha + {gyroscopic}
    return np.concatenate([force, moment])
'''
TURNED, GYROSCOPIC = "R @ inertia @ R.T", "np.cross(omega, turned @ omega)"

CONTROLLER = '''
def my_controller(t, state, reference, kp=100.0, kd=20.0):
    """Wrong on purpose."""
    turn = {turn}
    error = {sign} np.concatenate([reference.pose.position - state.position, turn])
    wish = {ahead}kd * (reference.twist - state.twist) + kp * error
    platform = state.robot.platform
    return body_wrench(platform.mass, platform.inertia, {rotation}, state.twist[3:], wish[:3], wish[3:],
                       state.robot.gravity)
'''
FLIES = {"turn": "rotation_vector(reference.pose.rotation @ state.rotation.T)", "sign": "+",
         "ahead": "reference.acceleration + ", "rotation": "state.rotation"}

CLOCK = '''
def largest_stable_kd(kp, dt):
    """Wrong on purpose."""
    return {limit}
'''

TUNE = '''
def choose_gains(dt, jitter, jump, most, time):
    """Wrong on purpose."""
    kp = {kp}
    if 5 / np.sqrt(kp) > time:
        raise ValueError("too much")
    return kp, 2 * np.sqrt(kp)
'''

WRONG_ANSWERS: dict[str, list[tuple[str, str]]] = {
    "quintic-answer": [
        ("the printed coefficients", PRINTED),
        ("highest power first", QUINTIC.format(missing=MISSING, bend="a0 / 2", order="[::-1]")),
        ("acceleration not halved", QUINTIC.format(missing=MISSING.replace("a0 * T**2 / 2", "a0 * T**2"), bend="a0",
                                                   order="")),
        ("velocity at the start forgotten",
         QUINTIC.format(missing=MISSING.replace(" - v0 * T", ""), bend="a0 / 2", order="")),
    ],
    "wrench-answer": [
        ("weight with the wrong sign", WRENCH.format(turned=TURNED, weight="-", gyroscopic=GYROSCOPIC)),
        ("inertia not turned", WRENCH.format(turned="inertia", weight="+", gyroscopic=GYROSCOPIC)),
        ("turned the wrong way round", WRENCH.format(turned="R.T @ inertia @ R", weight="+", gyroscopic=GYROSCOPIC)),
        ("no gyroscopic moment", WRENCH.format(turned=TURNED, weight="+", gyroscopic="np.zeros(3)")),
        ("cross product reversed",
         WRENCH.format(turned=TURNED, weight="+", gyroscopic="np.cross(turned @ omega, omega)")),
    ],
    "controller-answer": [
        ("error with the wrong sign", CONTROLLER.format(**FLIES | {"sign": "-"})),
        ("reference's acceleration left out", CONTROLLER.format(**FLIES | {"ahead": ""})),
        ("rotation left alone", CONTROLLER.format(**FLIES | {"turn": "np.zeros(3)"})),
        ("rotation error in platform axes",
         CONTROLLER.format(**FLIES | {"turn": "rotation_vector(state.rotation.T @ reference.pose.rotation)"})),
        ("inertia at the reference's rotation", CONTROLLER.format(**FLIES | {"rotation": "reference.pose.rotation"})),
    ],
    "clock-answer": [
        ("without K_p", CLOCK.format(limit="2 / dt")),
        ("one step and no overshoot", CLOCK.format(limit="1 / dt")),
        ("K_p counted twice", CLOCK.format(limit="2 / dt - kp * dt")),
    ],
    "tune-answer": [
        ("the tensions alone", TUNE.format(kp="0.9 * most / jump")),
        ("the clock alone", TUNE.format(kp="(0.22 / (dt * (1 + jitter)))**2")),
        ("the same for all", "def choose_gains(dt, jitter, jump, most, time):\n    return 100.0, 20.0\n"),
    ],
}
