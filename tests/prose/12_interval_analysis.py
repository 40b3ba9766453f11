"""Lesson 12: numbers in its prose."""

SETUP = """
def safe(uncertainty):
    return cl.plan_configurations(robot, S, G, position_uncertainty=uncertainty)[0].safe

uncertainties = np.arange(5, 40) * 0.005
first_unsafe = next(w for w in uncertainties if not safe(w))
change = cl.plan_configurations(robot, S, G, position_uncertainty=first_unsafe)[0].transition_scores[0]
both = [region(exits[chosen], 0.02, 0.05).window(line[0], line[-1]) for chosen in ([0, 1, 2], [1, 2, 3])]
natural = [x[np.array(rows[f"{name}, natural form"])] for name in ("A124", "A123")]
"""
RESULTS = [
    ("both bars overlap (gray) for about {5} cm of the way", "100 * (end - begin) * (G - S)[0]"),
    ("there is a gap of {5} cm instead", "100 * (natural[1].min() - natural[0].max())"),
    ("Up to {6} cm. The window closes", "100 * (first_unsafe - 0.005)"),
    ('At {6.5} cm the best sequence is marked "not safe", and its change scores {4}', "100 * first_unsafe, change"),
    ("at y = {0.80} m, a little lower, or nowhere", "y[equal][0]"),
    ("between y = {0.90} and {1.38} m both triplets are certainly inside",
     "0.7 + 0.7 * max(first for first, _ in both), 0.7 + 0.7 * min(last for _, last in both)"),
]
GIVEN = ["The paper prints a switch at y = 0.88 m"]
