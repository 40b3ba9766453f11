"""Plausible mistakes in lesson 00; each must earn nothing."""

HARDEST = '''
def hardest_pull(time, tensions):
    """Wrong on purpose."""
    row, column = np.unravel_index(np.argmax(tensions), np.shape(tensions))
    return {}
'''
SUPPORT = '''
def support_force(exit_points, anchor_points, tensions):
    """Wrong on purpose."""
    vectors = exit_points - anchor_points
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    return {}
'''
CUT = '''
def cut_and_fall(world, tensions, cable, duration):
    """Wrong on purpose."""
    with cl.open_simulator(world) as simulator:
        {}
        path = []
        for _ in range(round(duration / simulator.dt)):
            simulator.step({})
            path.append(simulator.position)
        return np.array(path{})
'''

WRONG_ANSWERS: dict[str, list[tuple[str, str]]] = {
    "hardest-answer": [
        ("counts cables from 0", HARDEST.format("column, time[row], tensions[row, column]")),
        ("returns the row instead of the time", HARDEST.format("column + 1, row, tensions[row, column]")),
        ("looks at the end of the flight only",
         HARDEST.format("np.argmax(tensions[-1]) + 1, time[-1], np.max(tensions[-1])")),
    ],
    "support-answer": [
        ("pulls from the exit to the anchor", SUPPORT.format("-(vectors / lengths).T @ tensions")),
        ("forgets to normalize", SUPPORT.format("vectors.T @ tensions")),
        ("adds tensions as numbers", SUPPORT.format("np.array([0.0, 0.0, np.sum(tensions)])")),
        ("one length for all cables", SUPPORT.format("vectors.T @ tensions / lengths.mean()")),
    ],
    "cut-answer": [
        ("cuts the next cable", CUT.format("simulator.cut([cable % 8])", "tensions", "")),
        ("cuts nothing", CUT.format("pass", "tensions", "")),
        ("cuts all cables", CUT.format("simulator.cut()", "tensions", "")),
        ("lets the other winches go slack", CUT.format("simulator.cut([cable - 1])", "0 * tensions", "")),
        ("returns the way, not the place",
         CUT.format("simulator.cut([cable - 1])", "tensions", ") - (world.pose.position")),
    ],
}
