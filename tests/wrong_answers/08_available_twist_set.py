"""Plausible mistakes in lesson 8; each must earn nothing."""

ROWS = '''
def cable_rows(J, cable_max):
    """Wrong on purpose."""
    {rows}


def is_inside(N, d, twists):
    """Wrong on purpose."""
    {test}
'''
ROWS_RIGHT = {"rows": "return np.vstack([J, -J]), np.concatenate([cable_max, cable_max])",
              "test": "return np.all(np.asarray(twists) @ N.T <= d, axis=1)"}

SUPPORT = '''
def support(c, J, B, cable_max, base_max):
    """Wrong on purpose."""
    rows = np.hstack([J, -B])
    cost = np.concatenate([-np.asarray(c, float), np.zeros(B.shape[1])])
    bounds = {bounds}
    return {sign}linprog(cost, A_ub={matrix}, b_ub={right}, bounds=bounds).fun
'''
SUPPORT_RIGHT = {"sign": "-", "bounds": "[(None, None)] * J.shape[1] + [(-limit, limit) for limit in base_max]",
                 "matrix": "np.vstack([rows, -rows])", "right": "np.concatenate([cable_max, cable_max])"}

AXES = '''
def component_range(vertices):
    """Wrong on purpose."""
    {range}


def axis_section(N, d):
    """Wrong on purpose."""
    {section}
'''
AXES_RIGHT = {"range": "return np.column_stack([vertices.min(axis=0), vertices.max(axis=0)])", "section": (
    "ends = np.empty((N.shape[1], 2))\n"
    "    for i, column in enumerate(N.T):\n"
    "        ends[i] = np.max(d[column < 0] / column[column < 0]), np.min(d[column > 0] / column[column > 0])\n"
    "    return ends")}

SCALE = '''
def largest_scale(N, d, corners):
    """Wrong on purpose."""
    {}
'''

WRONG_ANSWERS: dict[str, list[tuple[str, str]]] = {
    "rows-answer": [
        ("one direction of the winches only", ROWS.format(**{**ROWS_RIGHT, "rows": "return J, cable_max"})),
        ("one satisfied row is enough",
         ROWS.format(**{**ROWS_RIGHT, "test": "return np.any(np.asarray(twists) @ N.T <= d, axis=1)"})),
        ("the platform as slow as a cable",
         ROWS.format(**{**ROWS_RIGHT, "test": "return np.linalg.norm(twists, axis=1) <= d.min()"})),
        ("the slowest winch for all", ROWS.format(**{
            **ROWS_RIGHT, "rows": "return np.vstack([J, -J]), np.full(2 * len(J), np.min(cable_max))"})),
        ("rows made unit vectors, offsets forgotten", ROWS.format(**{
            **ROWS_RIGHT, "rows": ("J = J / np.linalg.norm(J, axis=1, keepdims=True)\n"
                                   "    return np.vstack([J, -J]), np.concatenate([cable_max, cable_max])")})),
    ],
    "support-answer": [
        ("linprog's unknowns left at ≥ 0", SUPPORT.format(**{
            **SUPPORT_RIGHT, "bounds": "[(0, None)] * J.shape[1] + [(-limit, limit) for limit in base_max]"})),
        ("linprog's smallest cost returned as it is", SUPPORT.format(**{**SUPPORT_RIGHT, "sign": ""})),
        ("bases without limits", SUPPORT.format(**{
            **SUPPORT_RIGHT, "bounds": "[(None, None)] * (J.shape[1] + B.shape[1])"})),
        ("bases that only drive ahead", SUPPORT.format(**{
            **SUPPORT_RIGHT, "bounds": "[(None, None)] * J.shape[1] + [(0, limit) for limit in base_max]"})),
        ("cables limited in one direction only",
         SUPPORT.format(**{**SUPPORT_RIGHT, "matrix": "rows", "right": "cable_max"})),
        ("base speeds just added to v_x", '''
def support(c, J, B, cable_max, base_max):
    """Wrong on purpose."""
    bounds = [(None, None)] * J.shape[1]
    still = -linprog(-np.asarray(c, float), A_ub=np.vstack([J, -J]), b_ub=np.tile(cable_max, 2), bounds=bounds).fun
    return still + abs(c[0]) * (max(base_max) if len(base_max) else 0.0)
'''),
    ],
    "axes-answer": [
        ("ranges of a symmetric set assumed", AXES.format(**{
            **AXES_RIGHT, "range": "top = np.abs(vertices).max(axis=0)\n    return np.column_stack([-top, top])"})),
        ("row by row, negative rows not told apart", AXES.format(**{
            **AXES_RIGHT, "section": ("with np.errstate(divide='ignore'):\n"
                                      "        ends = np.min(d[:, None] / np.abs(N), axis=0)\n"
                                      "    return np.column_stack([-ends, ends])")})),
        ("smallest and largest the wrong way round", AXES.format(**{
            **AXES_RIGHT, "range": "return np.column_stack([vertices.max(axis=0), vertices.min(axis=0)])"})),
        ("the offset as the reach", AXES.format(**{
            **AXES_RIGHT, "section": "return np.column_stack([-np.full(N.shape[1], d.min()), "
                                     "np.full(N.shape[1], d.min())])"})),
        ("the farthest row instead of the nearest", AXES.format(**{
            **AXES_RIGHT, "section": AXES_RIGHT["section"].replace("np.max", "np.MIN").replace("np.min", "np.max")
            .replace("np.MIN", "np.min")})),
    ],
    "scale-answer": [
        ("the first corner only", SCALE.format(
            "reach = np.asarray(corners)[0] @ N.T\n    return np.min(d[reach > 0] / reach[reach > 0])")),
        ("the mean of the corners", SCALE.format(
            "reach = np.mean(corners, axis=0) @ N.T\n    return np.min(d[reach > 0] / reach[reach > 0])")),
        ("rows that a growing twist leaves behind limit it too", SCALE.format(
            "return np.min(d / np.abs(np.asarray(corners) @ N.T))")),
        ("negative scales kept", SCALE.format("return np.min(d / (np.asarray(corners) @ N.T))")),
        ("never more than the whole", SCALE.format(
            "reach = np.asarray(corners) @ N.T\n"
            "    return min(1.0, np.min(np.broadcast_to(d, reach.shape)[reach > 0] / reach[reach > 0]))")),
    ],
}
