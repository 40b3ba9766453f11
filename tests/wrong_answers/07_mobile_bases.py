"""Plausible mistakes in lesson 7; each must earn nothing."""

ROWS = '''
def base_rows(u, exit_points, center, heading):
    """Wrong on purpose."""
    arm, velocity = {arm}, np.zeros((*u.shape, 3))
    velocity[:, 0, 0], velocity[:, 1, 0] = {turn}
    velocity[:, 0, 1], velocity[:, 1, 1] = {ahead}
    velocity[:, 0, 2], velocity[:, 1, 2] = {aside}
    return {sign}np.einsum("kd,kdc->kc", u, velocity)
'''
RIGHT = {"arm": "exit_points - center", "turn": "-arm[:, 1], arm[:, 0]", "sign": "-",
         "ahead": "np.cos(heading), np.sin(heading)", "aside": "-np.sin(heading), np.cos(heading)"}

HOLD = '''
def hold_still(robot, pose, name, speeds):
    """Wrong on purpose."""
    k = [base.name for base in robot.bases].index(name)
    B = cl.base_jacobian(robot, pose)
    return {}
'''
HOLD_PRINTED = '''
def hold_still(robot, pose, name, speeds):
    """Wrong on purpose."""
    k = [base.name for base in robot.bases].index(name)
    B = np.array(cl.base_jacobian(robot, pose))
    velocity = np.cross([0.0, 0.0, 1.0], np.append(pose.position, 0.0)[:3])[:robot.dimension]
    carried = np.array(robot.base_indices) == k
    B[carried, 3 * k] -= cl.cable_directions(robot, pose)[carried] @ velocity
    return -B[:, 3 * k:3 * k + 3] @ speeds
'''

SHARE = '''
def share_twist(J, B, twist, weights):
    """Wrong on purpose."""
    G = np.hstack([B, np.eye(len(J))])
    {}
'''

SCALE = '''
def largest_scale(J, B, twist, base_limits, cable_limits):
    """Wrong on purpose."""
    rows = np.column_stack([{sign}B, J @ twist])
    cost = np.zeros(rows.shape[1])
    cost[-1] = -1.0
    bounds = {bounds}
    return linprog(cost, A_ub={matrix}, b_ub={right}, bounds=bounds).x[-1]
'''
BOTH = {"sign": "-", "bounds": "[(-limit, limit) for limit in base_limits] + [(0, 1)]",
        "matrix": "np.vstack([rows, -rows])", "right": "np.r_[cable_limits, cable_limits]"}

WRONG_ANSWERS: dict[str, list[tuple[str, str]]] = {
    "base-rows-answer": [
        ("the minus of B_b forgotten", ROWS.format(**{**RIGHT, "sign": ""})),
        ("turns about the world's origin", ROWS.format(**{**RIGHT, "arm": "exit_points"})),
        ("drives along the world's axes", ROWS.format(**{**RIGHT, "ahead": "1.0, 0.0", "aside": "0.0, 1.0"})),
        ("turns clockwise", ROWS.format(**{**RIGHT, "turn": "arm[:, 1], -arm[:, 0]"})),
        ("second axis to the right instead of to the left",
         ROWS.format(**{**RIGHT, "aside": "np.sin(heading), -np.cos(heading)"})),
        ("heading in degrees", ROWS.format(**{
            **RIGHT, "ahead": "np.cos(np.radians(heading)), np.sin(np.radians(heading))",
            "aside": "-np.sin(np.radians(heading)), np.cos(np.radians(heading))"})),
        ("counts the rotation twice, as printed",
         ROWS.format(**{**RIGHT, "turn": "-arm[:, 1] - exit_points[:, 1], arm[:, 0] + exit_points[:, 0]"})),
    ],
    "hold-answer": [
        ("sign", HOLD.format("B[:, 3 * k:3 * k + 3] @ speeds")),
        ("columns of another base", HOLD.format("-B[:, :3] @ speeds")),
        ("the turn left out", HOLD.format("-B[:, 3 * k + 1:3 * k + 3] @ speeds[1:]")),
        ("every cable at the speed of the base", HOLD.format("-np.linalg.norm(speeds) * np.sign(B[:, 3 * k + 1])")),
        ("turns about the world's origin",
         HOLD.format('-cl.base_jacobian(robot, pose, pivot="world")[:, 3 * k:3 * k + 3] @ speeds')),
        ("the printed formula", HOLD_PRINTED),
    ],
    "share-answer": [
        ("weights ignored: least norm", SHARE.format("return np.linalg.pinv(G) @ (J @ twist)")),
        ("divided the wrong way: a dear speed is used most",
         SHARE.format("cheap = G.T * weights[:, None]\n    return cheap @ np.linalg.solve(G @ cheap, J @ twist)")),
        ("weights squared",
         SHARE.format("cheap = G.T / weights[:, None]**2\n    return cheap @ np.linalg.solve(G @ cheap, J @ twist)")),
        ("the winches do it all", SHARE.format("return np.concatenate([np.zeros(B.shape[1]), J @ twist])")),
        ("B with the sign of the model's other side",
         SHARE.format("G[:, :B.shape[1]] *= -1\n    cheap = G.T / weights[:, None]\n"
                      "    return cheap @ np.linalg.solve(G @ cheap, J @ twist)")),
    ],
    "scale-answer": [
        ("cables limited in one direction only",
         SCALE.format(**{**BOTH, "matrix": "rows", "right": "cable_limits"})),
        ("bases without limits", SCALE.format(**{**BOTH, "bounds": "[(None, None)] * len(base_limits) + [(0, 1)]"})),
        ("bases that only drive ahead",
         SCALE.format(**{**BOTH, "bounds": "[(0, limit) for limit in base_limits] + [(0, 1)]"})),
        ("more than the whole twist",
         SCALE.format(**{**BOTH, "bounds": "[(-limit, limit) for limit in base_limits] + [(0, None)]"})),
        ("the winches alone", '''
def largest_scale(J, B, twist, base_limits, cable_limits):
    """Wrong on purpose."""
    return min(1.0, float(np.min(cable_limits / np.abs(J @ twist))))
'''),
    ],
}
