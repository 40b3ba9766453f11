"""Lesson 10: numbers in its prose."""

SETUP = """
halls = course.planning_explorer(pair)
grid = halls.grid(halls.values)

def found(margin):
    halls.set(gap=1.0, margin=margin)
    return halls.plan(halls.values).found

kept = max(margin for margin in np.arange(0.1, 0.31, 0.01).round(2) if found(margin))
"""
RESULTS = [
    ("{17} cm for what two rows of cells may hide and {12} cm by which discs stick out",
     "200 * grid.slack, 100 * (2 * (pair.discs[:, 1].max() + pair.radius) - pair.width)"),
    ("2. Beyond {23} cm: {24} are too much.", "100 * kept, 100 * kept + 1"),
    ("the pair ends up to {20} cm from where it should be",
     "100 * max(abs(one[2][0] - there[0]) for one in arrivals['long bare walls'])", 1.5),
]
GIVEN = ["**Time:** 120 minutes", "With fine steps it is 44.7 N",
         "carries a laser scanner: 270°", "0° or ±180°", "lie 95 % of normal errors",
         "179° and −179° are two degrees apart"]
