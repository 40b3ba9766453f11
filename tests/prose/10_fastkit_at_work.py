"""Lesson 10: numbers in its prose."""

RESULTS: list[tuple[str, str]] = []
GIVEN = ["carries a laser scanner: 270°", "0° or ±180°", "lie 95 % of normal errors",
         "179° and −179° are two degrees apart"]
OPEN = ["17 cm for what two rows of cells may hide", "2. At 23 cm."]
