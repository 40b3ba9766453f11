"""Lesson 12: numbers in its prose."""

RESULTS: list[tuple[str, str]] = []
GIVEN = ["The paper prints a switch at y = 0.88 m"]
OPEN = ["At 6.5 cm the best sequence"]
