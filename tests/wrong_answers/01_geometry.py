"""Plausible mistakes in lesson 01; each must earn nothing."""

VECTORS = '''
def cable_vectors(exit_points, anchor_points, position, rotation):
    """Wrong on purpose."""
    return {}
'''
LENGTHS = '''
def directions_and_lengths(vectors):
    """Wrong on purpose."""
    vectors = np.asarray(vectors)
    {}
'''
JACOBIAN = '''
def jacobian(directions, anchor_points, rotation):
    """Wrong on purpose."""
    arms = {arms}
    return {rows}
'''
WINCHES = '''
def winch_speeds(robot, reference):
    """Wrong on purpose."""
    J = cl.jacobian(robot, reference.pose)
    return {speeds}


def shortest_duration(speeds, speed_max, duration):
    """Wrong on purpose."""
    return {duration}
'''

ARMS = "anchor_points @ rotation.T"
ROWS = "-np.concatenate([directions, np.cross(arms, directions)], axis=1)"
SPEEDS = "(J @ reference.twist[..., None])[..., 0]"
DURATION = "duration * np.max(np.abs(speeds) / speed_max)"

WRONG_ANSWERS: dict[str, list[tuple[str, str]]] = {
    "cable-vectors-answer": [
        ("forgets the rotation", VECTORS.format("exit_points - position - anchor_points")),
        ("turns the anchor points the wrong way round",
         VECTORS.format("exit_points - position - anchor_points @ rotation")),
        ("runs from exit to anchor", VECTORS.format("position + anchor_points @ rotation.T - exit_points")),
        ("adds the anchor points", VECTORS.format("exit_points - position + anchor_points @ rotation.T")),
    ],
    "lengths-answer": [
        ("one length for all cables together",
         LENGTHS.format("lengths = np.linalg.norm(vectors)\n    return vectors / lengths, lengths")),
        ("takes the length over the cables, not the axes",
         LENGTHS.format("lengths = np.linalg.norm(vectors, axis=0)\n    return vectors / lengths, lengths")),
        ("forgets the root",
         LENGTHS.format("lengths = (vectors**2).sum(axis=-1)\n    return vectors / lengths[..., None], lengths")),
        ("directions from exit to anchor",
         LENGTHS.format("lengths = np.linalg.norm(vectors, axis=-1)\n"
                        "    return -vectors / lengths[..., None], lengths")),
        ("right for a single pose only",
         LENGTHS.format("lengths = np.sqrt((vectors**2).sum(axis=1))\n    return (vectors.T / lengths).T, lengths")),
    ],
    "jacobian-answer": [
        ("forgets the minus", JACOBIAN.format(arms=ARMS, rows=ROWS.removeprefix("-"))),
        ("forgets to rotate the arm", JACOBIAN.format(arms="anchor_points", rows=ROWS)),
        ("cross product the wrong way round", JACOBIAN.format(
            arms=ARMS, rows="-np.concatenate([directions, np.cross(directions, arms)], axis=1)")),
        ("leaves the cross product out", JACOBIAN.format(
            arms=ARMS, rows="-np.concatenate([directions, 0 * arms], axis=1)")),
        ("angular part first", JACOBIAN.format(
            arms=ARMS, rows="-np.concatenate([np.cross(arms, directions), directions], axis=1)")),
    ],
    "winches-answer": [
        ("sign of the wrench matrix", WINCHES.format(speeds="-" + SPEEDS, duration=DURATION)),
        ("the first pose's Jacobian all along", WINCHES.format(speeds="reference.twist @ J[0].T", duration=DURATION)),
        ("looks at paying out only", WINCHES.format(speeds=SPEEDS, duration="duration * np.max(speeds / speed_max)")),
        ("ratio the wrong way round", WINCHES.format(
            speeds=SPEEDS, duration="duration / np.max(np.abs(speeds) / speed_max)")),
        ("one limit for all winches", WINCHES.format(
            speeds=SPEEDS, duration="duration * np.max(np.abs(speeds)) / np.max(speed_max)")),
    ],
}
