"""Plausible mistakes in lesson 12; each must earn nothing."""

ARITHMETIC = '''
def add(A, B):
    """Wrong on purpose."""
    return {add}


def subtract(A, B):
    """Wrong on purpose."""
    return {subtract}


def multiply(A, B):
    """Wrong on purpose."""
    products = [a * b for a in A for b in B]
    return {multiply}
'''
RIGHT_ARITHMETIC = {"add": "A[0] + B[0], A[1] + B[1]", "subtract": "A[0] - B[1], A[1] - B[0]",
                    "multiply": "min(products), max(products)"}

FORMS = '''
def side_natural(a, b, m):
    """Wrong on purpose."""
    value = {natural}
    return value.lb(), value.ub()


def side_translated(a, b, m):
    """Wrong on purpose."""
    value = {translated}
    return value.lb(), value.ub()
'''
RIGHT_FORMS = {"natural": "(b[0] - a[0]) * (m[1] - a[1]) - (b[1] - a[1]) * (m[0] - a[0])",
               "translated": "(a[0] - m[0]) * (b[1] - m[1]) - (a[1] - m[1]) * (b[0] - m[0])"}

CORNERS = '''
def side_exact(start, end, position, exit_uncertainty, position_uncertainty):
    """Wrong on purpose."""
    centers = np.concatenate([start, end, position])
    widths = np.repeat([exit_uncertainty, position_uncertainty], {repeats})
    ax, ay, bx, by, mx, my = (centers + widths * {where}).T
    values = (bx - ax) * (my - ay) - (by - ay) * (mx - ax)
    return {answer}
'''
RIGHT_CORNERS = {"repeats": "[4, 2]", "where": "np.array(list(product((-1, 1), repeat=6)))",
                 "answer": "values.min(), values.max()"}

CLASSIFY = '''
def classify(exit_points, position, position_uncertainty, exit_uncertainty):
    """Wrong on purpose."""
    corners, M = np.asarray(exit_points)[:, :2], np.asarray(position)[:2]
    if {clockwise}:
        corners = corners[::-1]
    ranges = [side_exact(corners[i], corners[j], M, {widths})
              for i, j in ((0, 1), (1, 2), (2, 0))]
    if {inside}:
        return "inside"
    return "outside" if {outside} else "uncertain"
'''
RIGHT_CLASSIFY = {"clockwise": "side_exact(corners[0], corners[1], corners[2], 0.0, 0.0)[0] < 0",
                  "widths": "exit_uncertainty, position_uncertainty", "inside": "all(low > 0 for low, _ in ranges)",
                  "outside": "any(high < 0 for _, high in ranges)"}

CROSSING = '''
def detour(exit_points, start, goal, position_uncertainty, exit_uncertainty, longest):
    """Wrong on purpose."""
    regions = regions_of(exit_points, position_uncertainty, exit_uncertainty)
    low, high = np.min(exit_points, axis=0), np.max(exit_points, axis=0)
    for x, y in product(np.linspace(low[0], high[0], 15), np.linspace(low[1], high[1], 15)):
        V = np.array([x, y, (start[2] + goal[2]) / 2])
        length = np.linalg.norm(V - start) + np.linalg.norm(goal - V)
        if {detour}:
            return V
    {none}


def fifth_exit(exit_points, start, goal, position_uncertainty, exit_uncertainty):
    """Wrong on purpose."""
    low, high = np.min(exit_points, axis=0), np.max(exit_points, axis=0)
    for x, y in product(np.linspace(low[0], high[0], 9), np.linspace(low[1], high[1], 9)):
        A = np.array([x, y, {height}])
        regions = regions_of({ends}, position_uncertainty, exit_uncertainty)
        if {fifth}:
            return A
    {none}
'''
RIGHT_CROSSING = {"detour": "length <= longest and sure_until(regions, start, V) == sure_until(regions, V, goal) == 1",
                  "none": "raise ValueError('none')", "height": "high[2]", "ends": "np.vstack([exit_points, A])",
                  "fifth": "sure_until(regions, start, goal) == 1"}


def wrong(template, right, **mistake):
    """A right answer with something in it that is not."""
    return template.format(**{**right, **mistake})


WRONG_ANSWERS: dict[str, list[tuple[str, str]]] = {
    "arithmetic-answer": [
        ("lower minus lower", wrong(ARITHMETIC, RIGHT_ARITHMETIC, subtract="A[0] - B[0], A[1] - B[1]")),
        ("the difference's ends sorted instead of chosen",
         wrong(ARITHMETIC, RIGHT_ARITHMETIC, subtract="tuple(sorted((A[0] - B[0], A[1] - B[1])))")),
        ("a product of the ends", wrong(ARITHMETIC, RIGHT_ARITHMETIC, multiply="(A[0] * B[0], A[1] * B[1])")),
        ("a product of two ends, sorted",
         wrong(ARITHMETIC, RIGHT_ARITHMETIC, multiply="tuple(sorted((A[0] * B[0], A[1] * B[1])))")),
        ("a sum that is too wide", wrong(ARITHMETIC, RIGHT_ARITHMETIC, add="A[0] + B[0] - 1, A[1] + B[1] + 1")),
    ],
    "forms-answer": [
        ("a scalar product", wrong(FORMS, RIGHT_FORMS, natural=RIGHT_FORMS["natural"].replace(") - (", ") + ("))),
        ("the origin in A_i for both", wrong(FORMS, RIGHT_FORMS, translated=RIGHT_FORMS["natural"])),
        ("the origin in M for both", wrong(FORMS, RIGHT_FORMS, natural=RIGHT_FORMS["translated"])),
        ("the sign of the translated form",
         wrong(FORMS, RIGHT_FORMS, translated="(b[0] - m[0]) * (a[1] - m[1]) - (b[1] - m[1]) * (a[0] - m[0])")),
        ("middles instead of intervals",
         wrong(FORMS, RIGHT_FORMS, natural="Interval((b[0].mid() - a[0].mid()) * (m[1].mid() - a[1].mid()) - "
                                           "(b[1].mid() - a[1].mid()) * (m[0].mid() - a[0].mid()))")),
    ],
    "corners-answer": [
        ("only the load is uncertain", wrong(CORNERS, RIGHT_CORNERS, repeats="[0, 2]").replace(
            "np.repeat([exit_uncertainty, position_uncertainty], [0, 2])",
            "np.array([0, 0, 0, 0, position_uncertainty, position_uncertainty])")),
        ("the half widths mixed up", wrong(CORNERS, RIGHT_CORNERS, repeats="[2, 4]")),
        ("random points instead of corners",
         wrong(CORNERS, RIGHT_CORNERS, where="np.random.default_rng(0).uniform(-1, 1, (2000, 6))")),
        ("all coordinates up or all down", wrong(CORNERS, RIGHT_CORNERS, where="np.array([[-1] * 6, [1] * 6])")),
        ("twice as wide, to be on the safe side",
         wrong(CORNERS, RIGHT_CORNERS, answer="2 * values.min() - values.mean(), 2 * values.max() - values.mean()")),
    ],
    "classify-answer": [
        ("the order of the exit points taken for granted", wrong(CLASSIFY, RIGHT_CLASSIFY, clockwise="False")),
        ("outside only if all three say so",
         wrong(CLASSIFY, RIGHT_CLASSIFY, outside="all(high < 0 for _, high in ranges)")),
        ("inside if nothing excludes it",
         wrong(CLASSIFY, RIGHT_CLASSIFY, inside="all(high > 0 for _, high in ranges)")),
        ("only the larger of both half widths",
         wrong(CLASSIFY, RIGHT_CLASSIFY, widths="0.0, max(position_uncertainty, exit_uncertainty)")),
        ("the exit points taken as exact", wrong(CLASSIFY, RIGHT_CLASSIFY, widths="0.0, position_uncertainty")),
    ],
    "crossing-answer": [
        ("only the first piece", wrong(CROSSING, RIGHT_CROSSING,
                                       detour="length <= longest and sure_until(regions, start, V) == 1")),
        ("only the second piece", wrong(CROSSING, RIGHT_CROSSING,
                                        detour="length <= longest and sure_until(regions, V, goal) == 1")),
        ("however long", wrong(CROSSING, RIGHT_CROSSING,
                               detour="sure_until(regions, start, V) == sure_until(regions, V, goal) == 1")),
        ("nearly certain is enough", wrong(CROSSING, RIGHT_CROSSING, fifth="sure_until(regions, start, goal) > 0.5")),
        ("any fifth rope", wrong(CROSSING, RIGHT_CROSSING, fifth="True")),
        ("a winch above the ceiling", wrong(CROSSING, RIGHT_CROSSING, height="high[2] + 0.5")),
        ("no answer where nothing will do", wrong(CROSSING, RIGHT_CROSSING, none="return None")),
    ],
}
