"""Plausible mistakes in lesson 02; each must earn nothing."""

MATRIX = '''
def build_wrench_matrix(u, r):
    """Wrong on purpose."""
    u, r = np.asarray(u), np.asarray(r)
    flat = u.shape[1] == 2
    moments = {}
    return {}
'''
CROSS = "(r[:, 0] * u[:, 1] - r[:, 1] * u[:, 0])[:, None] if flat else np.cross(r, u)"
TURNED = "(u[:, 0] * r[:, 1] - u[:, 1] * r[:, 0])[:, None] if flat else np.cross(u, r)"
MIXED = "(r[:, 0] * u[:, 1] - r[:, 1] * u[:, 0])[:, None] if flat else np.cross(u, r)"
TIMES = "(r[:, 0] * u[:, 0] + r[:, 1] * u[:, 1])[:, None] if flat else r * u"
STACK = "np.hstack([u, moments]).T"

TWO = '''
def two_cable_tensions(exit_points, position, mass, push, gravity=9.81):
    """Wrong on purpose."""
    vectors = np.asarray(exit_points) - np.asarray(position)
    u = vectors / np.linalg.norm(vectors, axis=1, keepdims=True)
    weight = np.array([0.0, -mass * gravity])
    return {}
'''
CLOSURE = '''
def has_wrench_closure(W):
    """Wrong on purpose."""
    n, m = W.shape
    {}
'''
PROGRAM = "linprog(np.zeros(m), A_eq=W, b_eq=np.zeros(n), bounds=({}, None)).status == 0"
RANK = "np.linalg.matrix_rank(W) == n and "

TAUT = '''
def taut_tensions(W, w_e, tension_min):
    """Wrong on purpose."""
    least = {}np.linalg.pinv(W) @ w_e
    h = null_space(W)[:, 0]
    {}
'''
SIGN = "h = h * np.sign(h[0])\n    "

WRONG_ANSWERS: dict[str, list[tuple[str, str]]] = {
    "matrix-answer": [
        ("moment u × r instead of r × u", MATRIX.format(TURNED, STACK)),
        ("right in the plane, u × r in space", MATRIX.format(MIXED, STACK)),
        ("products instead of a cross product", MATRIX.format(TIMES, STACK)),
        ("moments above the forces", MATRIX.format(CROSS, "np.hstack([moments, u]).T")),
        ("the Jacobian: sign and transpose forgotten", MATRIX.format(CROSS, "-np.hstack([u, moments]).T")),
        ("transposed", MATRIX.format(CROSS, "np.hstack([u, moments])")),
    ],
    "two-cables-answer": [
        ("external force with the wrong sign", TWO.format("np.linalg.solve(u.T, weight + push)")),
        ("push forgotten", TWO.format("np.linalg.solve(u.T, -weight)")),
        ("u in rows instead of columns", TWO.format("np.linalg.solve(u, -weight - push)")),
        ("vectors not scaled to length 1", TWO.format("np.linalg.solve(vectors.T, -weight - push)")),
        ("negative tensions made positive", TWO.format("np.abs(np.linalg.solve(u.T, -weight - push))")),
        ("gravity fixed to the Earth's",
         TWO.format("np.linalg.solve(u.T, np.array([0.0, mass * 9.81]) - push)")),
    ],
    "closure-answer": [
        ("counts cables", CLOSURE.format("return m > n")),
        ("counts cables and rank", CLOSURE.format(f"return {RANK}m > n")),
        ("h = 0 allowed", CLOSURE.format(f"return {RANK}{PROGRAM.format(0)}")),
        ("rank forgotten", CLOSURE.format("return " + PROGRAM.format(1))),
        ("looks at one null vector only, as it comes",
         CLOSURE.format(f"return {RANK}m > n and bool(np.all(null_space(W)[:, 0] > 0))")),
        ("looks at one null vector only, of either sign",
         CLOSURE.format(f"return {RANK}m > n and abs(np.sign(null_space(W)[:, 0]).sum()) == m")),
    ],
    "taut-answer": [
        ("clips, which breaks the balance", TAUT.format("-", "return np.maximum(least, tension_min)")),
        ("sign of the null vector left to chance",
         TAUT.format("-", "return least + np.max((tension_min - least) / h) * h")),
        ("the least demanding cable decides",
         TAUT.format("-", SIGN + "return least + np.min((tension_min - least) / h) * h")),
        ("external wrench with the wrong sign",
         TAUT.format("", SIGN + "return least + np.max((tension_min - least) / h) * h")),
        ("adds far more than needed", TAUT.format("-", SIGN + "return least + 1e4 * h / np.min(h)")),
        ("minimum of zero whatever is asked", TAUT.format("-", SIGN + "return least + np.max(-least / h) * h")),
    ],
}
