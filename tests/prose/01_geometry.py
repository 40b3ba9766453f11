"""Lesson 01: numbers in its prose."""

SETUP = """
def changed(up, yaw):
    "How much longer the cables are after a move of CAROCA from the middle of the room [cm]."
    before, after = cl.Pose([0, 0, 1.2]), cl.Pose([0, 0, 1.2 + up], rpy=[0, 0, yaw])
    return 100 * (cl.cable_lengths(room.robot, after) - cl.cable_lengths(room.robot, before))

up, turn_left = -changed(0.1, 0), changed(0, np.radians(20))
lower = turn_left[[0, 3, 4, 7]], -turn_left[[1, 2, 5, 6]]
late_A = off_the_path(0.001)
l, EA, g, r = 5.0, 1e5, 9.81, 40.0  # the examples' [m, N, m/s², mm]
sag = {tau: 1e3 * 0.05 * g * l**2 / (8 * tau) for tau in (300, 50)}
longer = {tau: 1e3 * (0.05 * g)**2 * l**3 / (24 * tau**2) for tau in (300, 50)}
"""
RESULTS = [
    ("All cables become shorter, by {4} to {6} cm", "up.min(), up.max()"),
    ("cables 1, 4, 5 and 8 (lower corners) become longer by {13} to {19} cm, and 2, 3, 6 and 7 (upper corners) shorter "
     "by {16} to {18} cm", "lower[0].min(), lower[0].max(), lower[1].min(), lower[1].max()"),
    ("what was paid out | $\\tau\\,l/(EA)$ | {15} mm", "1e3 * 300 * l / EA"),
    ("hangs {5} mm, yet only {0.01} mm longer; at 50 N: {31} mm and {0.5} mm",
     "sag[300], longer[300], sag[50], longer[50]"),
    ("{20} mm or {0.8} mm for 0.5 rad", "r * 0.5, r * (0.5 - np.sin(0.5))"),
    ("The little jump at {1.6} s", "late_A[0][1000:][np.abs(np.diff(late_A[1][1000:2200], 2)).argmax() + 1]", 0.1),
]
GIVEN = ["tension $\\tau$ = 300 N", "pulley radius $r$ = 40 mm"]
