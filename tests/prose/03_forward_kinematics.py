"""Lesson 03: numbers in its prose."""

SETUP = """
W_astray = cl.wrench_matrix(three, astray)
tau_astray = np.linalg.solve(W_astray, -cl.gravity_wrench(three, astray))

four = six_cables(4)
long_2 = cl.cable_lengths(four, truth) + [0, 0.1, 0, 0]
hung = cl.equilibrium(four, long_2, truth).pose
shared = cl.forward_kinematics(four, long_2, truth, tolerance=np.inf)
circle_top = 3 + np.sqrt(3**2 - 1.8**2)
"""
RESULTS = [
    ("In the other pose cable 3 would have to push with {28} N", "-tau_astray[2]"),
    ("rope 4 goes slack by {113} mm, and the platform hangs {6} cm from the least-squares pose",
     "1e3 * (long_2 - cl.cable_lengths(four, hung))[3], 100 * np.linalg.norm(hung.position - shared.position)"),
    ("is at (1.8, {0.6}) or at (1.8, {5.4}) m", "2 * 3 - circle_top, circle_top"),
]
GIVEN = ["1 m and 7 m; 2 m and 2.5 m", "- 2 m and 2.5 m:", "with the guess turned by −140°", "guess turned by 170°",
         "and the guess turned by −140°", "turned by 30°, 60°, …", "about 95 % lie inside"]
