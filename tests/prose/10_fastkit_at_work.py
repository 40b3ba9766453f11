"""Lesson 10: numbers in its prose."""

RESULTS = [
    ("the pair ends up to {20} cm from where it should be",
     "100 * max(abs(one[2][0] - there[0]) for one in arrivals['long bare walls'])", 1.5),
]
GIVEN = ["**Time:** 120 minutes", "With fine steps it is 44.7 N",
         "carries a laser scanner: 270°", "0° or ±180°", "lie 95 % of normal errors",
         "179° and −179° are two degrees apart"]
OPEN = ["17 cm for what two rows of cells may hide", "2. Beyond 23 cm: 24 are too much."]
