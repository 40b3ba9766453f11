"""Lesson 08: numbers in its prose."""

SETUP = """
start, wish = cl.Pose([1.0, 1.6], angle=0.0), np.array([1.15, 1.675])
left, right = (base.name for base in planar.robot.bases)

def scale(moving):
    return float(cl.available_twist_set(planar.robot, start, moving).scale(wish))

def rise(moving, y=1.6):
    return cl.available_twist_set(planar.robot, cl.Pose([1.0, y], angle=0.0), moving).axis_section()[1, 1]

missing = (cl.jacobian(planar.robot, start) @ wish).max() - 2
lift = np.linspace(0.4, 1.8, 141)
highest = np.array([rise("none", y) for y in lift])
chart = bars["largest component"], bars["largest pure twist"]
"""
RESULTS = [
    ("The cable vector is (−1, {−1.35}) m", "0.25 - 1.6"),
    ("the scale is {0.985}, whatever the right one does. With the right base at 0 it is {1.184}",
     "scale(right), scale(left)"),
    ("and {0.0305} m/s are missing: {0.0512} m/s is the least",
     "missing, missing / abs(cl.jacobian(planar.robot, start)[0, 0])"),
    ("From {2.489} to {3.082} m/s", "rise('none'), rise('all')"),
    ("The best height is about {1.1} m, with {2.99} m/s", "lift[highest.argmax()], rise('none', 1.1)"),
    ("{2.34} m/s, then it keeps that speed", "1.15 * np.linalg.norm(wish)"),
    ("{10.3} against {8.0} m/s", "chart[0]['bases fixed'][1], chart[1]['bases fixed'][1]"),
]
GIVEN = ["pass it at 0.06"]
