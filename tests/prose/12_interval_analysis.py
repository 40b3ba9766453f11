"""Lesson 12: numbers in its prose."""

SETUP = """
natural = [x[np.array(rows[f"{name}, natural form"])] for name in ("A124", "A123")]
y_range = [0.70 + 0.70 * share for share in (region(exits[[1, 2, 3]], 0.02, 0.05).window(line[0], line[-1])[0],
                                             region(exits[[0, 1, 2]], 0.02, 0.05).window(line[0], line[-1])[1])]
"""
RESULTS = [
    ("both bars overlap (gray) for about {5} cm of the way", "100 * (end - begin) * (G - S)[0]"),
    ("there is a gap of {5} cm instead", "100 * (natural[1].min() - natural[0].max())"),
    ("between y = {0.90} and {1.38} m both triplets are certainly inside", "tuple(y_range)"),
]
GIVEN = ["The paper prints a switch at y = 0.88 m"]
OPEN = ["At 6.5 cm the best sequence"]
