"""Plausible mistakes in lesson 11; each must earn nothing."""

TRIPLETS = '''
def holding_triplets(exit_points, position):
    """Wrong on purpose."""
    found = []
    for chosen in combinations(range(len(exit_points)), 3):
        a = exit_points[list(chosen)]
        edges, to_load = np.roll(a, -1, axis=0) - a, position - a
        sides = edges[:, 0] * to_load[:, 1] - edges[:, 1] * to_load[:, 0]
        normal = np.cross(a[1] - a[0], a[2] - a[0])
        below = {below}
        inside = {inside}
        if {condition}:
            found.append(tuple({number} for i in chosen))
    return found
'''
RIGHT_TRIPLETS = {"below": "normal @ to_load[0] * np.sign(normal[2]) < 0",
                  "inside": "np.all(sides > 0) or np.all(sides < 0)", "condition": "inside and below",
                  "number": "i + 1"}

HANG = '''
def hang(exit_points, lengths):
    """Wrong on purpose."""
    A1, rho = exit_points[0], np.asarray(lengths)
    a = exit_points[1:] - A1
    x0 = np.linalg.lstsq(2 * a, {right_side}, rcond=None)[0]
    square = rho[0]**2 - x0 @ x0
    {refuse}
    n = np.cross(a[0], a[1])
    beside = np.sqrt(abs(square)) * n / np.linalg.norm(n)
    return {answer}
'''
RIGHT_HANG = {"right_side": "rho[0]**2 - rho[1:]**2 + np.sum(a**2, axis=1)",
              "refuse": "if square < 0: raise ValueError('ropes too short')",
              "answer": "min(A1 + x0 + beside, A1 + x0 - beside, key=lambda point: point[2])"}

SCORE = '''
def score(exit_points, steps, transition_scores):
    """Wrong on purpose."""
    places = []
    for position, chosen in {steps}:
        corners = np.asarray(exit_points)[np.array(chosen) - {first}]
        d = np.linalg.norm({vector}, axis=1)
        places.append({place})
    return places, {total}
'''
RIGHT_SCORE = {"steps": "steps", "first": "1", "vector": "corners[:, :2] - np.asarray(position)[:2]",
               "place": "min(4, int(np.floor(5 * (1 - d.min() / d.max()))))",
               "total": "sum(places) + sum(transition_scores)"}

CHANGE = '''
def change_lengths(exact, old, new, slack, count):
    """Wrong on purpose."""
    m = len(exact)
    loose = [np.array([slack * (i + {first} not in chosen) for i in range(m)]) for chosen in {order}]
    between = {between}
    share = np.linspace(0, 1, count + 1)[:, None]
    take_up = loose[0] + share * (between - loose[0])
    pay_out = between + share * (loose[1] - between)
    return {lengths} + np.vstack([take_up, pay_out[1:]])
'''
RIGHT_CHANGE = {"first": "1", "order": "(old, new)", "between": "np.minimum(*loose)", "lengths": "exact"}


def wrong(template, right, **mistake):
    """A right answer with something in it that is not."""
    return template.format(**{**right, **mistake})


WRONG_ANSWERS: dict[str, list[tuple[str, str]]] = {
    "triplets-answer": [
        ("counter-clockwise only", wrong(TRIPLETS, RIGHT_TRIPLETS, inside="np.all(sides > 0)")),
        ("height ignored", wrong(TRIPLETS, RIGHT_TRIPLETS, condition="inside")),
        ("below the lowest exit point instead of below the plane",
         wrong(TRIPLETS, RIGHT_TRIPLETS, below="position[2] < a[:, 2].min()")),
        ("two sides are enough", wrong(TRIPLETS, RIGHT_TRIPLETS, inside="abs(np.sign(sides[:2]).sum()) == 2")),
        ("numbered from 0", wrong(TRIPLETS, RIGHT_TRIPLETS, number="i")),
    ],
    "hang-answer": [
        ("the upper point", wrong(HANG, RIGHT_HANG, answer=RIGHT_HANG["answer"].replace("min", "max"))),
        ("the sign left to the order of the ropes", wrong(HANG, RIGHT_HANG, answer="A1 + x0 - beside")),
        ("squares of the exit points forgotten", wrong(HANG, RIGHT_HANG, right_side="rho[0]**2 - rho[1:]**2")),
        ("relative to rope 1, never moved back", wrong(HANG, RIGHT_HANG, answer="min(x0 + beside, x0 - beside, "
                                                       "key=lambda point: point[2])")),
        ("an answer where there is none", wrong(HANG, RIGHT_HANG, refuse="")),
    ],
    "score-answer": [
        ("distances in space", wrong(SCORE, RIGHT_SCORE, vector="corners - np.asarray(position)")),
        ("ropes numbered from 0", wrong(SCORE, RIGHT_SCORE, first="0 - len(exit_points)")),
        ("rounded to the nearest", wrong(SCORE, RIGHT_SCORE, place="min(4, round(5 * (1 - d.min() / d.max())))")),
        ("up to 5", wrong(SCORE, RIGHT_SCORE, place="int(np.floor(5 * (1 - d.min() / d.max())))")),
        ("changes forgotten", wrong(SCORE, RIGHT_SCORE, total="sum(places)")),
        ("M counted once", wrong(SCORE, RIGHT_SCORE, steps="steps[:1] + steps[2:]")),
    ],
    "change-answer": [
        ("at once", wrong(CHANGE, RIGHT_CHANGE, between="(loose[0] + loose[1]) / 2")),
        ("pays out first", wrong(CHANGE, RIGHT_CHANGE, between="np.maximum(*loose)")),
        ("backwards", wrong(CHANGE, RIGHT_CHANGE, order="(new, old)")),
        ("ropes numbered from 0", wrong(CHANGE, RIGHT_CHANGE, first="0")),
        ("slack only, without the lengths", wrong(CHANGE, RIGHT_CHANGE, lengths="0 * exact")),
        ("the slack scales with the length", wrong(CHANGE, RIGHT_CHANGE, lengths="exact * slack")),
    ],
}
