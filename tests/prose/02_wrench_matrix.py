"""Lesson 02: numbers in its prose."""

SETUP = """
lamp2 = point_load(2)

def two(push, extra=(0, 0), where=(0.0, 1.0)):
    "The tensions of two cables that hold the load there [N], and its acceleration when cables only pull [m/s²]."
    W = cl.wrench_matrix(lamp2, cl.Pose(list(where), angle=0.0))
    w_e = np.array([push, -lamp2.mass * lamp2.gravity])
    tau = -np.linalg.solve(W, w_e)
    left = W @ np.maximum(tau + extra, 0) + w_e
    return tau, np.linalg.norm(left) / lamp2.mass

def three(position, lam):
    "Tensions at λ [N], the λ at which each cable is about to go slack, the load's acceleration [m/s²]."
    W = cl.wrench_matrix(triangle, cl.Pose(list(position), angle=0.0))
    w_e = np.array([0.0, -triangle.mass * triangle.gravity])
    h = null_space(W)[:, 0]
    h = h / np.abs(h).max() * np.sign(h[2])
    tau = -np.linalg.pinv(W) @ w_e
    return tau + lam * h, -tau / h, np.linalg.norm(W @ np.maximum(tau + lam * h, 0) + w_e) / triangle.mass
"""
RESULTS = [
    ("reaches zero at a push of {98.1} N", "two(0)[0][1] / (two(0)[0][1] - two(1)[0][1])"),
    ("At 140 N cable 2 should push {29.6} N away from its exit point", "-two(140)[0][1]"),
    ("leaves *towards* exit 2, at {3} m/s²", "two(140)[1]", 0.05),
    ("it leaves towards exit 1, at {4} m/s²", "two(0, (40, 0))[1]", 0.05),
    ("Below about {57} N cable 3 would have to push", "three((0, 1.5), 0)[1][2]"),
    ("only between about {21} and {44} N", "tuple(sorted(three((1.5, 0.5), 0)[1])[1:])"),
    ("it starts down at {5.7} m/s²", "three((0, 1.5), 0)[2]"),
    ("of {1471.5} N weight", "caroca.robot.mass * 9.81"),
    ("{5} % of cable 1's tension", "100 * left_over[0] / balanced[0]", 0.01),
]
GIVEN = ["both cables at 45°", "Predict it for a push of 140 N", "At 140 N cable 2",
         "with λ = 0, with 100 and with 200 N",
         "At 100 and at 200 N it stays"]
