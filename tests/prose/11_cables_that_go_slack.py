"""Lesson 11: numbers in its prose."""

SETUP = """
away = {label: wound(table)[0].max() for label, table in tables.items()}
rope = room.to_dict()["cable"]["axial_stiffness"]
a, b, c, d = exits[:, :2]
along = np.linalg.solve(np.column_stack([c - a, b - d]), b - a)
crossing_point = a + along[0] * (c - a)
"""
RESULTS = [
    ("the load sinks by some {8} cm and comes back; paying out first lets it down by {16} cm",
     "100 * away['at once'], 100 * away['pay out first']"),
    ("the crossing of the diagonals, ({1.38}, {1.12})", "tuple(crossing_point)"),
]
GIVEN = ["Move G to y = 1.34"]
