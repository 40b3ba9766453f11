"""Lesson 04: numbers in its prose."""

SETUP = """
def bead(lam):
    return lam * np.ones(2) + [-15, 15]

ends_1, ends_2 = (10 + 15, 100 + 15), (10 - 15, 100 - 15)
inside = max(ends_1[0], ends_2[0]), min(ends_1[1], ends_2[1])
corner_pose = cl.Pose([-1.5, -0.6, 1.6], rpy=[0.02, 0.15, -0.15])
W_c, w_c = cl.wrench_matrix(caroca.robot, corner_pose), cl.gravity_wrench(caroca.robot, corner_pose)

def fails_above(method):
    "The smallest tension_min, to 1 N, at which a method breaks the limits of the explorer [N]."
    return next(low for low in range(50, 500) if not cl.distribute_tensions(W_c, w_c, low, 3720.0, method).feasible)

jump = float(next(line for line in table.lines() if line[0] == "linear_program")[-4])
"""
RESULTS = [
    ("between {25} and {115} N, of cable 2 between {−5} and {85} N. Both: {25} to {85} N, tensions from ({10}, {40}) "
     "to ({70}, {100}) N", "*ends_1, *ends_2, *inside, *bead(inside[0]), *bead(inside[1])"),
    ("The closed form goes first, at about {120} N", "fails_above('closed_form')", 5),
    ("falls out at about {215} N", "fails_above('pseudo_inverse')", 3),
    ("vanishes at about {315} N", "fails_above('linear_program')", 3),
    ("beyond {5300} N the middle", "strongest"),
    ("by about {1000} N in a single step", "jump", 100),
    ("a jump of {1000} N shakes", "jump", 100),
]
GIVEN = ["starts at 3720 N"]
