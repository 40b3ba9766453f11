"""Lesson 15: numbers in its prose; what a student's own design has is printed, never written."""

RESULTS: list[tuple[str, str]] = []
GIVEN = ["Try an exit height of 2.4 m"]
