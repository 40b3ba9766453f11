"""A hall around the shelf, in which the command line and the pages fly the mission; `run_mission` takes any other."""

from ..navigation.driving import Walker

BOUNDS = ((-5.0, -6.0), (7.0, 2.0))
PALLETS = ((2.6, -3.0, 0.8, 1.2, 0.3), (-1.5, -2.2, 1.2, 0.8, 0.0))
START = (5.0, -3.5, 1.8)
PEOPLE = (Walker([[2.5, -1.0], [6.0, -1.0]]),)  # type: ignore[arg-type]
