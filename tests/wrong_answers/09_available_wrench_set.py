"""Plausible mistakes in lesson 9; each must earn nothing."""

SUPPORT = '''
def support(W, low, high, direction):
    """Wrong on purpose."""
    tensions = {}
    return {}, tensions
'''
RIGHT_TENSIONS, RIGHT_REACH = "np.where(direction @ W > 0, high, low)", "direction @ W @ tensions"

LINES = '''
def shifted_lines(W, low, high):
    """Wrong on purpose."""
    across = np.column_stack([{across}]){unit}
    normals = np.concatenate([across, {opposite}])
    pulls = normals @ W
    return normals, {offsets}
'''
RIGHT_LINES = {"across": "-W[1], W[0]", "unit": " / np.linalg.norm(W, axis=0)[:, None]", "opposite": "-across",
               "offsets": "np.maximum(pulls * low, pulls * high).sum(axis=1)"}

ROWS = '''
def moment_rows(footprint, center_of_mass, weight, exits, u):
    """Wrong on purpose."""
    contacts = np.column_stack([footprint, np.zeros(len(footprint))])
    following = np.roll(contacts, -1, axis=0)
    edges = following - contacts
    edges = {edges}
    b = (edges * np.cross(center_of_mass - contacts, [0.0, 0.0, {weight}])).sum(axis=1)
    A = np.einsum("kd,kmd->km", edges, np.cross({arms}, {pull}))
    return A, b
'''
RIGHT_ROWS = {"edges": "edges / np.linalg.norm(edges, axis=1, keepdims=True) "
                       "* np.sign(np.cross(contacts, following)[:, 2].sum())",
              "weight": "-weight", "arms": "exits - contacts[:, None]", "pull": "-u"}

PAYLOAD = '''
def largest_payload(W, w_e, per_kg, low, high, A, b):
    """Wrong on purpose."""
    m = len(low)
    answer = linprog(np.append(np.zeros(m), {cost}), A_ub=np.column_stack([A, np.zeros(len(A))]), b_ub={limit},
                     A_eq=np.column_stack([W, {column}]), b_eq={load}, bounds={bounds})
    if answer.status != 0:
        return {none}
    return answer.x[-1], answer.x[:-1]
'''
RIGHT_PAYLOAD = {"cost": "-1.0", "limit": "-b", "column": "per_kg", "load": "-w_e",
                 "bounds": "[*zip(low, high), (0, None)]", "none": "np.nan, np.full(m, np.nan)"}
PAYLOAD_LEAST_NORM = '''
def largest_payload(W, w_e, per_kg, low, high, A, b):
    """Wrong on purpose."""
    p, tau = 0.0, -np.linalg.pinv(W) @ w_e
    step = -np.linalg.pinv(W) @ per_kg
    for _ in range(2000):
        after = tau + 0.05 * step
        if (after < low).any() or (after > high).any() or (A @ after + b > 0).any():
            break
        p, tau = p + 0.05, after
    return p, tau
'''

WRONG_ANSWERS: dict[str, list[tuple[str, str]]] = {
    "support-answer": [
        ("all cables at their upper limits", SUPPORT.format("high + 0.0", RIGHT_REACH)),
        ("hindering cables at zero", SUPPORT.format("np.where(direction @ W > 0, high, 0.0)", RIGHT_REACH)),
        ("signs swapped: the nearest point", SUPPORT.format("np.where(direction @ W > 0, low, high)", RIGHT_REACH)),
        ("by the sign of one component of the wrench", SUPPORT.format("np.where(W[-1] > 0, high, low)", RIGHT_REACH)),
        ("reach as the length of the wrench", SUPPORT.format(RIGHT_TENSIONS, "np.linalg.norm(W @ tensions)")),
        ("direction made a unit vector", SUPPORT.format(RIGHT_TENSIONS, RIGHT_REACH + " / np.linalg.norm(direction)")),
    ],
    "planes-answer": [
        ("normals along the cables", LINES.format(**{**RIGHT_LINES, "across": "W[0], W[1]"})),
        ("mirrored instead of turned", LINES.format(**{**RIGHT_LINES, "across": "W[1], W[0]"})),
        ("no unit length", LINES.format(**{**RIGHT_LINES, "unit": ""})),
        ("the same sign twice", LINES.format(**{**RIGHT_LINES, "opposite": "across"})),
        ("lower limits taken for zero",
         LINES.format(**{**RIGHT_LINES, "offsets": "np.maximum(pulls * high, 0).sum(axis=1)"})),
        ("offsets symmetric about the origin",
         LINES.format(**{**RIGHT_LINES, "offsets": "np.abs(pulls * high).sum(axis=1)"})),
    ],
    "rows-answer": [
        ("the force on the platform", ROWS.format(**{**RIGHT_ROWS, "pull": "u"})),
        ("wheels taken as counter-clockwise",
         ROWS.format(**{**RIGHT_ROWS, "edges": "edges / np.linalg.norm(edges, axis=1, keepdims=True)"})),
        ("edges of no unit length",
         ROWS.format(**{**RIGHT_ROWS, "edges": "edges * np.sign(np.cross(contacts, following)[:, 2].sum())"})),
        ("weight upwards", ROWS.format(**{**RIGHT_ROWS, "weight": "weight"})),
        ("arms from the world's origin", ROWS.format(**{**RIGHT_ROWS, "arms": "exits + 0 * contacts[:, None]"})),
        ("arms from the exits to the wheels, as printed, with the force on the base",
         ROWS.format(**{**RIGHT_ROWS, "arms": "contacts[:, None] - exits"})),
        ("turned by the sign of each edge's own moment of weight",
         ROWS.format(**{**RIGHT_ROWS, "edges": "edges / np.linalg.norm(edges, axis=1, keepdims=True) * np.sign("
                                               "contacts[:, :1] * following[:, 1:2])"})),
    ],
    "payload-answer": [
        ("tipping forgotten", PAYLOAD.format(**{**RIGHT_PAYLOAD, "limit": "np.full(len(b), 1e9)"})),
        ("sign of the base's own weight", PAYLOAD.format(**{**RIGHT_PAYLOAD, "limit": "b"})),
        ("smallest payload", PAYLOAD.format(**{**RIGHT_PAYLOAD, "cost": "1.0"})),
        ("platform forgotten", PAYLOAD.format(**{**RIGHT_PAYLOAD, "load": "0 * w_e"})),
        ("payload pushes up", PAYLOAD.format(**{**RIGHT_PAYLOAD, "column": "-per_kg"})),
        ("tensions from zero",
         PAYLOAD.format(**{**RIGHT_PAYLOAD, "bounds": "[*((0, top) for top in high), (0, None)]"})),
        ("zero instead of nan", PAYLOAD.format(**{**RIGHT_PAYLOAD, "none": "0.0, low"})),
        ("tensions of least norm only", PAYLOAD_LEAST_NORM),
    ],
}
