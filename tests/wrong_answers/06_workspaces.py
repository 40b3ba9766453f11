"""Plausible mistakes in lesson 06; each must earn nothing."""

PROGRAM = '''
def {name}:
    """Wrong on purpose."""
    n, m = W.shape
    one, zero = np.ones((m, 1)), np.zeros((m, 1))
    found = linprog(np.append(np.zeros(m), -1.0),
                    A_ub=np.block([[{lower}], [{upper}]]), b_ub=np.concatenate([{sides}]),
                    A_eq=np.hstack([W, np.zeros((n, 1))]), b_eq={wrench}, bounds={bounds})
    return {answer}
'''
MARGIN = {"name": "tension_margin(W, w_e, low, high)", "lower": "-np.eye(m), one", "upper": "np.eye(m), one",
          "sides": "-low, high", "wrench": "-w_e", "bounds": "(None, None)",
          "answer": "found.x[-1] if found.status == 0 else -np.inf"}
LEAST = {**MARGIN, "name": "largest_minimum(W, w_e, high)", "upper": "np.eye(m), zero", "sides": "np.zeros(m), high"}

AREA = '''
def area_bounds(inside, lower, upper, n):
    """Wrong on purpose."""
    x, y = (np.linspace(lower[k], upper[k], {points}) for k in (0, 1))
    found = inside(np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)).reshape({points}, {points})
    corners = found[1:, 1:].astype(int) + found[1:, :-1] + found[:-1, 1:] + found[:-1, :-1]
    cell = {cell}
    return {answer}
'''
CELLS = {"points": "n + 1", "cell": "(upper[0] - lower[0]) * (upper[1] - lower[1]) / n**2",
         "answer": "cell * np.sum(corners == 4), cell * np.sum(corners > 0)"}
CENTERS = '''
def area_bounds(inside, lower, upper, n):
    """Wrong on purpose."""
    x, y = (lower[k] + (upper[k] - lower[k]) * (np.arange(n) + 0.5) / n for k in (0, 1))
    found = inside(np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2))
    area = found.mean() * (upper[0] - lower[0]) * (upper[1] - lower[1])
    return area, area
'''

WRONG_ANSWERS: dict[str, list[tuple[str, str]]] = {
    "margin-answer": [
        ("external wrench with the wrong sign", PROGRAM.format(**{**MARGIN, "wrench": "w_e"})),
        ("linprog's own bounds: nothing may be negative", PROGRAM.format(**{**MARGIN, "bounds": "(0, None)"})),
        ("margin from the lower limits only", PROGRAM.format(**{**MARGIN, "upper": "np.eye(m), zero"})),
        ("margin from the upper limits only", PROGRAM.format(**{**MARGIN, "lower": "-np.eye(m), zero"})),
        ("limits loosened by s instead of tightened",
         PROGRAM.format(**{**MARGIN, "lower": "-np.eye(m), -one", "upper": "np.eye(m), -one",
                           "bounds": "(-1e4, 1e4)"})),
        ("outside is 0",
         PROGRAM.format(**{**MARGIN, "answer": "max(found.x[-1], 0.0) if found.status == 0 else -np.inf"})),
        ("0 where nothing balances",
         PROGRAM.format(**{**MARGIN, "answer": "found.x[-1] if found.status == 0 else 0.0"})),
        ("margin of the least-norm tensions", '''
def tension_margin(W, w_e, low, high):
    """Wrong on purpose."""
    tau = -np.linalg.pinv(W) @ w_e
    if not np.allclose(W @ tau, -w_e):
        return -np.inf
    return min((tau - low).min(), (high - tau).min())
'''),
    ],
    "area-answer": [
        ("n points a side instead of n cells", AREA.format(**{**CELLS, "points": "n"})),
        ("a share instead of an area", AREA.format(**{**CELLS, "cell": "1 / n**2"})),
        ("one number judged at the cells' centers", CENTERS),
        ("most before least",
         AREA.format(**{**CELLS, "answer": "cell * np.sum(corners > 0), cell * np.sum(corners == 4)"})),
        ("the border alone instead of the larger bound",
         AREA.format(**{**CELLS, "answer":
                        "cell * np.sum(corners == 4), cell * np.sum((corners > 0) & (corners < 4))"})),
        ("square cells whatever the box", AREA.format(**{**CELLS, "cell": "((upper[0] - lower[0]) / n)**2"})),
    ],
    "minimum-answer": [
        ("the margin again", PROGRAM.format(**{**LEAST, "upper": "np.eye(m), one"})),
        ("external wrench with the wrong sign", PROGRAM.format(**{**LEAST, "wrench": "w_e"})),
        ("upper limits forgotten", PROGRAM.format(**{**LEAST, "sides": "np.zeros(m), np.full(m, 1e6)"})),
        ("never negative", PROGRAM.format(**{**LEAST, "bounds": "(0, None)"})),
        ("the smallest of the least-norm tensions", '''
def largest_minimum(W, w_e, high):
    """Wrong on purpose."""
    tau = -np.linalg.pinv(W) @ w_e
    return tau.min() if (tau <= high).all() else -np.inf
'''),
        ("the smallest of the cheapest tensions", '''
def largest_minimum(W, w_e, high):
    """Wrong on purpose."""
    found = linprog(np.ones(len(high)), A_eq=W, b_eq=-w_e, bounds=[(-1e6, h) for h in high])
    return found.x.min() if found.status == 0 else -np.inf
'''),
    ],
}
