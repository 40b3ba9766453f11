"""Plausible mistakes in lesson 13; each must earn nothing."""

PULLEY = '''
def over_pulley(A, B, axis, radius):
    """Wrong on purpose."""
    d = B - A
    z = d @ axis
    across = d - z * axis
    x = np.linalg.norm(across)
    e = {e}
    if np.hypot(x - radius, z) < {least}:
        raise ValueError("inside")
    s = {s}
    wrap = {wrap}
    T = A + radius * (1 {sign} np.cos(wrap)) * e + radius * np.sin(wrap) * axis
    return {length}, T
'''
WHEEL = {"e": "across / x", "least": "radius", "s": "np.sqrt((x - radius)**2 + z**2 - radius**2)",
         "wrap": "np.arctan2(x - radius, z) + np.arctan2(radius, s)", "sign": "-", "length": "radius * wrap + s"}
SAG = '''
def least_pull(span, density, axial_stiffness, sag):
    """Wrong on purpose."""
    return {pull}
'''
FRICTION = '''
def fit_friction(speed, change, torque, load):
    """Wrong on purpose."""
    matrix = np.column_stack([{columns}])
    return tuple(np.linalg.lstsq(matrix, {rest}, rcond=None)[0][{order}])
'''
FIT = {"columns": "np.sign(speed), speed, change", "rest": "torque - load", "order": "[0, 1, 2]"}

STIFFNESS = '''
def planar_stiffness(u, r, lengths, tensions, springs):
    """Wrong on purpose."""
    K = np.zeros((3, 3))
    for u_i, r_i, l_i, tau, k in zip(u, r, lengths, tensions, springs):
        M = np.array([[1.0, 0.0, {side}r_i[1]], [0.0, 1.0, r_i[0]]])
        along = np.outer(u_i, u_i)
        K += M.T @ ({middle}) @ M
        K[2, 2] += {lever}
    return K
'''
RIGHT = {"side": "-", "middle": "k * along + tau / l_i * (np.eye(2) - along)", "lever": "tau * (r_i @ u_i)"}

WRONG_ANSWERS: dict[str, list[tuple[str, str]]] = {
    "pulley-answer": [
        ("the other tangent", PULLEY.format(**{**WHEEL, "wrap": "np.arctan2(x - radius, z) - np.arctan2(radius, s)"})),
        ("the wheel on the other side", PULLEY.format(**{**WHEEL, "e": "-across / x"})),
        ("no arc", PULLEY.format(**{**WHEEL, "length": "s"})),
        ("the chord to the center", PULLEY.format(**{**WHEEL, "s": "np.hypot(x - radius, z)"})),
        ("the wheel's center at A", PULLEY.format(**{**WHEEL, "s": "np.sqrt(x**2 + z**2 - radius**2)",
                                                     "wrap": "np.arctan2(x, z) + np.arctan2(radius, s)"})),
        ("nothing refused", PULLEY.format(**{**WHEEL, "least": "-1.0"})),
        ("too much refused", PULLEY.format(**{**WHEEL, "least": "2 * radius"})),
        ("T on the far side", PULLEY.format(**{**WHEEL, "sign": "+"})),
    ],
    "sag-answer": [
        ("the parabola, level", SAG.format(pull="density * 9.81 * np.linalg.norm(span[:-1])**2 / (8 * sag)")),
        ("the weight", SAG.format(pull="density * 9.81 * np.linalg.norm(span)")),
        ("half the pull", SAG.format(pull="density * 9.81 * span @ span / (16 * sag)")),
    ],
    "stiffness-answer": [
        ("springs only", STIFFNESS.format(**{**RIGHT, "middle": "k * along", "lever": "0.0"})),
        ("levers that turn forgotten", STIFFNESS.format(**{**RIGHT, "lever": "0.0"})),
        ("levers with the wrong sign", STIFFNESS.format(**{**RIGHT, "lever": "-tau * (r_i @ u_i)"})),
        ("levers always stiffen", STIFFNESS.format(**{**RIGHT, "lever": "tau * abs(r_i @ u_i)"})),
        ("pulls that turn along the cable too",
         STIFFNESS.format(**{**RIGHT, "middle": "k * along + tau / l_i * np.eye(2)"})),
        ("geometric part subtracted",
         STIFFNESS.format(**{**RIGHT, "middle": "k * along - tau / l_i * (np.eye(2) - along)"})),
        ("tension instead of tension over length",
         STIFFNESS.format(**{**RIGHT, "middle": "k * along + tau * (np.eye(2) - along)"})),
        ("anchor points turn the other way", STIFFNESS.format(**{**RIGHT, "side": "+"})),
    ],
    "friction-answer": [
        ("inertia forgotten", FRICTION.format(**{**FIT, "columns": "np.sign(speed), speed, 0 * change"})),
        ("the load not taken off", FRICTION.format(**{**FIT, "rest": "torque"})),
        ("the load added", FRICTION.format(**{**FIT, "rest": "torque + load"})),
        ("Coulomb friction without its sign",
         FRICTION.format(**{**FIT, "columns": "np.ones_like(speed), speed, change"})),
        ("viscous and Coulomb swapped", FRICTION.format(**{**FIT, "order": "[1, 0, 2]"})),
        ("a motor that stands rubs",
         FRICTION.format(**{**FIT, "columns": "np.where(speed >= 0, 1, -1), speed, change"})),
    ],
}
