"""Lesson 07: numbers in its prose."""

SETUP = """
moved_wrong = flights["slide and lean", "as_printed"][0]
wrong_turn = np.abs(printed - about_center).max(axis=(1, 2))
off_axis = distance * np.hypot(1, 0.5)
winches = cl.jacobian(planar.robot, cl.Pose([1.0, 1.6], angle=0.0)) @ [1.15, 1.675]
"""
RESULTS = [
    ("is already wrong by {5} cm per radian when the platform is {6} cm away",
     "100 * wrong_turn[1], 100 * off_axis[1]"),
    ("would have to be paid out at {2.03} m/s", "winches.max()"),
    ("by a tenth of a millimeter after two steps, 4 ms, and by {14} cm after a second", "100 * moved_wrong[-1]"),
]
OPEN = ["make them pull with some 90 kN"]
