"""Plausible mistakes in lesson 14; each must earn nothing."""

LENGTHS = '''
def length_errors(u, R, dA, db, offsets):
    """Wrong on purpose."""
    return {}
'''

TENSIONS = '''
def tension_errors(W, k, delta):
    """Wrong on purpose."""
    WK = {stiff}
    x = np.linalg.solve(WK @ W.T, {load})
    return x, {tensions}
'''
RIGHT_TENSIONS = {"stiff": "W * k", "load": "WK @ delta", "tensions": "k * (delta - W.T @ x)"}

EXIT = '''
def find_exit(B, lengths, A, o):
    """Wrong on purpose."""
    for _ in range({steps}):
        v = A - B
        far = np.linalg.norm(v, axis=1)
        J = np.column_stack([{slope}, np.ones(len(far))])
        step = np.linalg.lstsq(J, {residual})[0]
        A, o = A + step[:-1], {offset}
    return A, o
'''
RIGHT_EXIT = {"steps": "20", "slope": "v / far[:, None]", "residual": "lengths - far - o", "offset": "o + step[-1]"}

TEN = '''
def choose(rows, count):
    """Wrong on purpose."""
    return {}
'''
GREEDY = '''
def choose(rows, count):
    """Wrong on purpose."""
    told = rows[..., :, None] * rows[..., None, :]
    total, chosen = 1e-6 * np.eye(rows.shape[2]), []
    for _ in range(count):
        gain = np.linalg.slogdet(total + told)[1].sum(axis=1)
        {}
    return chosen
'''


def tensions(**wrong):
    return TENSIONS.format(**{**RIGHT_TENSIONS, **wrong})


def exit_point(**wrong):
    return EXIT.format(**{**RIGHT_EXIT, **wrong})


WRONG_ANSWERS = {
    "reading-answer": [
        ("the anchor's errors in world axes", LENGTHS.format("(u * (dA - db)).sum(axis=1) + offsets")),
        ("turned the other way", LENGTHS.format("(u * (dA - db @ R)).sum(axis=1) + offsets")),
        ("anchor and exit point add", LENGTHS.format("(u * (dA + db @ R.T)).sum(axis=1) + offsets")),
        ("encoders forgotten", LENGTHS.format("(u * (dA - db @ R.T)).sum(axis=1)")),
        ("the size of the error instead of its part along the cable",
         LENGTHS.format("np.linalg.norm(dA - db @ R.T, axis=1) + offsets")),
    ],
    "tensions-answer": [
        ("the platform cannot move", tensions(tensions="k * delta")),
        ("all cables equally stiff", tensions(stiff="W")),
        ("moved the wrong way", tensions(tensions="k * (delta + W.T @ x)")),
        ("stiffness forgotten on the right", tensions(load="W @ delta")),
        ("slack cables pull no less than nothing", tensions(tensions="np.maximum(k * (delta - W.T @ x), 0)")),
    ],
    "exit-answer": [
        ("one step only", exit_point(steps="1")),
        ("the residual's sign", exit_point(residual="far + o - lengths")),
        ("the offset is never used", exit_point(residual="lengths - far")),
        ("the offset is not updated", exit_point(offset="o")),
        ("directions not normalized", exit_point(slope="v")),
    ],
    "ten-answer": [
        ("the first ones", TEN.format("list(range(count))")),
        ("at random", TEN.format("np.random.default_rng(1).permutation(len(rows))[:count]")),
        ("one pose again and again", TEN.format("[0] * count")),
        ("sorted by what each tells alone", GREEDY.format("return np.argsort(-gain)[:count]")),
        ("never added up", GREEDY.format("gain[chosen] = -np.inf; chosen.append(int(gain.argmax()))")),
    ],
}
