"""Plausible mistakes in lesson 04; each must earn nothing."""

INTERVAL = '''
def admissible_interval(tau_p, h, tau_min, tau_max):
    """Wrong on purpose."""
    low, high = (tau_min - tau_p) / h, (tau_max - tau_p) / h
    {}
'''

POLYGON = '''
def feasible_corners(tau_p, N, tau_min, tau_max):
    """Wrong on purpose."""
    rows, values = {rows}
    found = []
    for pair in combinations(range(len(rows)), 2):
        two = rows[list(pair)]
        if abs(np.linalg.det(two)) < 1e-12:
            continue
        crossing = np.linalg.solve(two, values[list(pair)])
        tau = tau_p + N @ crossing
        if {kept}:
            found.append(crossing)
    if not found:
        return np.zeros((0, 2))
    x, y = (np.array(found) - np.mean(found, axis=0)).T
    return np.array(found){order}


def centroid(corners):
    """Maybe wrong on purpose."""
    after = np.roll(corners, -1, axis=0)
    c = corners[:, 0] * after[:, 1] - after[:, 0] * corners[:, 1]
    return {centroid}
'''
RIGHT = {
    "rows": "np.vstack([N, N]), np.concatenate([tau_min - tau_p, tau_max - tau_p])",
    "kept": "np.all(tau >= tau_min - 1e-9 * np.max(tau_max)) and np.all(tau <= tau_max + 1e-9 * np.max(tau_max))",
    "order": "[np.argsort(np.arctan2(y, x))]",
    "centroid": "(corners + after).T @ c / (3 * c.sum())",
}

CLOSED = '''
def closed_form(W, w_e, tau_min, tau_max):
    """Wrong on purpose."""
    middle = (tau_min + tau_max) / 2
    tau = {}
    return tau, {}
'''
PROJECTED = "middle - np.linalg.pinv(W) @ (w_e + W @ middle)"
INSIDE = "bool(np.all(tau >= tau_min) and np.all(tau <= tau_max))"

LEAST = '''
def least_tensions(W, w_e, tau_min, tau_max):
    """Wrong on purpose."""
    judge = linprog(np.ones(W.shape[1]), A_eq=W, b_eq=-w_e, bounds=list(zip(tau_min, tau_max)))
    tau_p, N = -np.linalg.pinv(W) @ w_e, null_space(W)
    if judge.status != 0:
        return {none}
    C, b = {limits}
    lam = quadprog.solve_qp(np.eye(N.shape[1]), -N.T @ tau_p, C, b)[0]
    return {answer}
'''
LIMITS = "np.vstack([N, -N]).T, np.concatenate([tau_min - tau_p, tau_p - tau_max])"
LEAST_RIGHT = {"none": "None", "limits": LIMITS, "answer": "tau_p + N @ lam"}

BREAK = '''
def may_break(robot, pose, method):
    """Maybe wrong on purpose."""
    W, w_e, found = cl.wrench_matrix(robot, pose), cl.gravity_wrench(robot, pose), []
    for i in range(robot.n_cables):
        low, high = np.delete(robot.tension_min, i), np.delete(robot.tension_max, i)
        answer = cl.distribute_tensions(np.delete(W, i, axis=1), w_e, low, high, {method})
        if answer.feasible:
            found.append({number})
    return found


def forgiving_pose(robot):
    """Maybe wrong on purpose."""
    rng = np.random.default_rng(0)
    while True:
        pose = cl.Pose(rng.uniform([-0.8, -0.3, 1.5], [0.8, 0.3, 2.3]), rpy=rng.uniform(-0.3, 0.3, 3))
        if len(may_break(robot, pose, "linear_program")) >= {least}:
            return pose
'''
BREAK_RIGHT = {"method": "method", "number": "i + 1", "least": "7"}

WRONG_ANSWERS: dict[str, list[tuple[str, str]]] = {
    "interval-answer": [
        ("ends of negative h not swapped", INTERVAL.format("return low.max(), high.min()")),
        ("the union instead of what all share",
         INTERVAL.format("ends = np.stack([low, high])\n    return ends.min(), ends.max()")),
        ("upper limits forgotten", INTERVAL.format("return np.minimum(low, high).max(), np.inf")),
        ("h made positive", INTERVAL.format("return (low * np.sign(h)).max(), (high * np.sign(h)).min()")),
        ("an empty interval sorted away",
         INTERVAL.format("ends = np.stack([low, high])\n    "
                         "return tuple(sorted([ends.min(axis=0).max(), ends.max(axis=0).min()]))")),
    ],
    "polygon-answer": [
        ("every crossing kept", POLYGON.format(**RIGHT | {"kept": "True"})),
        ("upper limits forgotten", POLYGON.format(**RIGHT | {
            "rows": "N, tau_min - tau_p", "kept": "np.all(tau >= tau_min - 1e-9 * np.max(tau_max))"})),
        ("corners in the order they are found", POLYGON.format(**RIGHT | {"order": ""})),
        ("mean of the corners instead of the centroid",
         POLYGON.format(**RIGHT | {"centroid": "corners.mean(axis=0)"})),
        ("solution to start from forgotten", POLYGON.format(**RIGHT | {
            "rows": "np.vstack([N, N]), np.concatenate([tau_min, tau_max])"})),
    ],
    "closed-answer": [
        ("external wrench with the wrong sign",
         CLOSED.format("middle - np.linalg.pinv(W) @ (W @ middle - w_e)", INSIDE)),
        ("the middle itself not balanced away", CLOSED.format("middle - np.linalg.pinv(W) @ w_e", INSIDE)),
        ("always says yes", CLOSED.format(PROJECTED, "True")),
        ("looks at the lower limit only", CLOSED.format(PROJECTED, "bool(np.all(tau >= tau_min))")),
        ("clips, which breaks the balance", CLOSED.format(f"np.clip({PROJECTED}, tau_min, tau_max)", "True")),
        ("nearest to zero instead of the middle", CLOSED.format("-np.linalg.pinv(W) @ w_e", INSIDE)),
    ],
    "least-answer": [
        ("limits ignored", LEAST.format(**LEAST_RIGHT | {"answer": "tau_p"})),
        ("the linear program's corner", LEAST.format(**LEAST_RIGHT | {"answer": "judge.x"})),
        ("clips the shortest tensions", LEAST.format(**LEAST_RIGHT | {"answer": "np.clip(tau_p, tau_min, tau_max)"})),
        ("upper limits forgotten", LEAST.format(**LEAST_RIGHT | {"limits": "N.T.copy(), tau_min - tau_p"})),
        ("returns something where there is nothing", LEAST.format(**LEAST_RIGHT | {"none": "tau_p"})),
    ],
    "break-answer": [
        ("numbered from 0", BREAK.format(**BREAK_RIGHT | {"number": "i"})),
        ("one method for all", BREAK.format(**BREAK_RIGHT | {"method": "'linear_program'"})),
        ("five cables will do", BREAK.format(**BREAK_RIGHT | {"least": "5"})),
    ],
}
