"""Plausible mistakes in lesson 03; each must earn nothing."""

CIRCLES = '''
def hanging_point(A1, A2, l1, l2):
    """Wrong on purpose."""
    d = np.linalg.norm(A2 - A1)
    e = (A2 - A1) / d
    s = {s}
    if l1**2 < s**2:
        {refuse}
    beside = np.sqrt(l1**2 - s**2) * np.array([-e[1], e[0]])
    return {point}
'''
OFFSET = "(l1**2 - l2**2 + d**2) / (2 * d)"
REFUSE = 'raise ValueError("no such point")'
LOWER = "min(A1 + s * e + beside, A1 + s * e - beside, key=lambda point: point[1])"

NEWTON = '''
def gauss_newton_step(robot, lengths, pose):
    """Wrong on purpose."""
    residuals = lengths - cl.cable_lengths(robot, pose)
    J = cl.jacobian(robot, pose)
    return moved(pose, {step})


def gauss_newton(robot, lengths, guess, tolerance=1e-12, most=50):
    """Wrong on purpose."""
    poses = [guess]
    for _ in range({most}):
        poses.append(gauss_newton_step(robot, lengths, poses[{start}]))
        if np.abs(cl.cable_lengths(robot, poses[-1]) - cl.cable_lengths(robot, poses[-2])).max() <= tolerance:
            break
    return poses
'''
STEP = "np.linalg.pinv(J) @ residuals"

COVARIANCE = '''
def pose_covariance(robot, pose, sigma):
    """Wrong on purpose."""
    J = cl.jacobian(robot, pose)
    return {covariance}


def simulated_errors(robot, pose, sigma, count, seed):
    """Wrong on purpose."""
    rng = np.random.default_rng(seed)
    lengths = cl.cable_lengths(robot, pose) + {noise}
    found = cl.forward_kinematics(robot, lengths, pose, tolerance=np.inf)
    return np.column_stack([found.position{position}, found.angle{angle}])
'''
RIGHT = {"covariance": "sigma**2 * np.linalg.inv(J.T @ J)", "noise": "rng.normal(0, sigma, (count, robot.n_cables))",
         "position": " - pose.position", "angle": " - pose.angle"}

FAULT = '''
def leave_one_out(robot, lengths, guess):
    """Wrong on purpose."""
    left = []
    for i in range(robot.n_cables):
        others, kept = without_cable(robot, {i}), np.delete(lengths, {j})
        found = cl.forward_kinematics(others, kept, {guess}, tolerance=np.inf)
        left.append({left})
    return np.array(left)
'''
LEFT = "np.linalg.norm(kept - cl.cable_lengths(others, found))"

ASTRAY = '''
def misleading_guess(robot, pose):
    """Wrong on purpose."""
    return {guess}
'''

WRONG_ANSWERS: dict[str, list[tuple[str, str]]] = {
    "circles-answer": [
        ("takes the upper crossing", CIRCLES.format(s=OFFSET, refuse=REFUSE, point=LOWER.replace("min", "max"))),
        ("always turns left", CIRCLES.format(s=OFFSET, refuse=REFUSE, point="A1 + s * e - beside")),
        ("answers where there is no answer", CIRCLES.format(s=OFFSET, refuse="return A1 + s * e", point=LOWER)),
    ],
    "newton-answer": [
        ("steps backward", NEWTON.format(step="-" + STEP, most="most", start="-1")),
        ("forgets the rotation", NEWTON.format(step=f"({STEP}) * (np.arange(J.shape[1]) < pose.dimension)", most="most",
                                               start="-1")),
        ("steps from the guess again and again", NEWTON.format(step=STEP, most="most", start="0")),
    ],
    "astray-answer": [
        ("the true pose, turned a little", ASTRAY.format(guess="cl.Pose(pose.position, angle=pose.angle + 0.3)")),
        ("turned by 60 degrees, whatever the true pose",
         ASTRAY.format(guess="cl.Pose(pose.position, angle=pose.angle + 1)")),
        ("far away, where nothing is found",
         ASTRAY.format(guess="cl.Pose(pose.position + 30, angle=pose.angle + 2)")),
    ],
    "covariance-answer": [
        ("sigma not squared", COVARIANCE.format(**RIGHT | {"covariance": "sigma * np.linalg.inv(J.T @ J)"})),
        ("uniform noise",
         COVARIANCE.format(**RIGHT | {"noise": "rng.uniform(-sigma, sigma, (count, robot.n_cables))"})),
        ("the same error for all cables", COVARIANCE.format(**RIGHT | {"noise": "rng.normal(0, sigma, (count, 1))"})),
    ],
    "fault-answer": [
        ("residuals of the fit to all cables", '''
def leave_one_out(robot, lengths, guess):
    """Wrong on purpose."""
    found = cl.forward_kinematics(robot, lengths, guess, tolerance=np.inf)
    return np.abs(lengths - cl.cable_lengths(robot, found))
'''),
        ("cables counted from 1", FAULT.format(i="(i + 1) % 6", j="(i + 1) % 6", guess="guess", left=LEFT)),
        ("largest residual instead of the norm",
         FAULT.format(i="i", j="i", guess="guess", left=LEFT.replace("linalg.norm(", "max(np.abs(") + ")")),
    ],
}
