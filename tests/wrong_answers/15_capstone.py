"""Plausible mistakes in lesson 15; each must earn nothing."""

MARGIN = '''
def worst_push(W, weight, pushes, tension_min, tension_max):
    """Wrong on purpose."""
    n, m = W.shape
    one = np.ones((m, 1))
    rows = np.block([[-np.eye(m), one], [np.eye(m), {upper}]])
    sides = np.concatenate([-tension_min, tension_max])
    balance, cost = np.hstack([W, np.zeros((n, 1))]), np.r_[np.zeros(m), -1.0]
    margins = []
    for push in pushes:
        found = linprog(cost, rows, sides, balance, {wrench}, bounds={bounds})
        margins.append(found.x[-1] if found.status == 0 else -np.inf)
    k = int(np.{worst}(margins))
    return margins[k], k
'''
RIGHT = {"upper": "one", "wrench": "-(weight + push)", "bounds": "(None, None)", "worst": "argmin"}

DESIGN = '''
def my_design():
    """Wrong on purpose."""
    x, y, z = 0.4, 0.3, 0.2
    anchors = {anchors}
    corners = [[3.0 * sx, 2.2 * sy] for sy in (-1, 1) for sx in (-1, -1, 1, 1)]
    exits = [[*corner, {height}] for corner, anchor in zip(corners, anchors)]
    design = robot_file(exits, anchors, "eight_cables")
    {then}
    return design
'''
CROSSED = "[[x, -y, -z], [-x, y, z], [-x, -y, z], [x, y, -z], [-x, -y, -z], [x, y, z], [x, -y, z], [-x, y, -z]]"
UNCROSSED = "[[-x, -y, -z], [-x, -y, z], [x, -y, -z], [x, -y, z], [-x, y, -z], [-x, y, z], [x, y, -z], [x, y, z]]"
GOOD = {"anchors": CROSSED, "height": "3.2 if anchor[2] < 0 else 3.6", "then": "pass"}

SIX = '''
def six_cables():
    """Wrong on purpose."""
    exits = np.array({exits})
    anchors = np.array({anchors})
    mirror = [-1, 1, 1]
    design = robot_file(np.vstack([exits, exits * mirror]), np.vstack([anchors, anchors * mirror]), "six_cables")
    {then}
    return design
'''
THREE = {"exits": "[[2.0, 2.2, 3.6], [1.0, 2.2, 3.6], [-3.0, -2.2, 3.6]]",
         "anchors": "[[0.4, 0.0, -0.2], [0.4, -0.3, 0.2], [0.0, 0.0, 0.2]]", "then": "pass"}

WRONG_ANSWERS: dict[str, list[tuple[str, str]]] = {
    "margin-answer": [
        ("only the lower limits keep their distance", MARGIN.format(**{**RIGHT, "upper": "0 * one"})),
        ("sign of the wrench", MARGIN.format(**{**RIGHT, "wrench": "weight + push"})),
        ("the weight is forgotten", MARGIN.format(**{**RIGHT, "wrench": "-push"})),
        ("linprog's default bounds: s may not be negative", MARGIN.format(**{**RIGHT, "bounds": "(0, None)"})),
        ("the best push instead of the worst", MARGIN.format(**{**RIGHT, "worst": "argmax"})),
    ],
    "design-answer": [
        ("straight to the nearest corner: nothing holds the heading", DESIGN.format(**{**GOOD, "anchors": UNCROSSED})),
        ("CAROCA copied: crossed cables come too near", DESIGN.format(**{**GOOD, "height": "3.6"})),
        ("pulleys at the height of the load: stronger winches needed", DESIGN.format(**{**GOOD, "height": "1.6"})),
        ("pulleys above the roof", DESIGN.format(**{**GOOD, "height": "3.8 if anchor[2] < 0 else 4.2"})),
        ("stronger winches", DESIGN.format(**{**GOOD, "then": 'design["cable_limits"]["tension"] = [0, 5000]',
                                              "height": "3.6"})),
        ("a lighter load", DESIGN.format(**{**GOOD, "then": 'design["platform"]["mass"] = 40.0'})),
        ("nine cables", DESIGN.format(**{**GOOD, "then": 'design["cables"].append(design["cables"][0])'})),
    ],
    "six-answer": [
        ("the eight of exercise 2", "def six_cables():\n    \"\"\"Wrong on purpose.\"\"\"\n    return my_design()\n"),
        ("five cables", SIX.format(**{**THREE, "then": 'design["cables"].pop()'})),
        ("all cables in the upper edges: it tilts", SIX.format(**{
            **THREE, "anchors": "[[0.4, 0.0, 0.2], [0.4, -0.3, 0.2], [0.0, 0.0, 0.2]]"})),
        ("cables to the nearest side", SIX.format(**{
            **THREE, "anchors": "[[0.4, 0.3, -0.2], [0.4, 0.3, 0.2], [-0.4, -0.3, 0.2]]"})),
    ],
}
