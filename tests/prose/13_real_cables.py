"""Lesson 13: numbers in its prose."""

SETUP = """
sag_50 = 0.02 * 9.81 * 6**2 / (8 * 50)

def stiffness_at(level):
    "With springs of the cables' own, so that only the geometric part changes."
    robot, pose = rigid.robot, cl.Pose([0.0, 1.5], angle=0.0)
    l = cl.cable_lengths(robot, pose)
    u = cl.cable_directions(robot, pose)
    return np.diag(planar_stiffness(u, robot.anchor_points, l, held + level * h, 2e4 / l))

gain = 100 * (stiffness_at(tight) / stiffness_at(loose) - 1)
free = with_winches(0.08, 1e-3).to_dict()
free["winch"]["inertia"] = 0.0
free["winch"]["friction"] = {"coulomb": coulomb, "viscous": viscous}
here = cl.World.from_dict(free)
no_inertia = cl.run(here, real=here)
off_blind, off_told, off_free = (1e3 * np.linalg.norm(run.errors[:, :2], axis=1).max()
                                 for run in (blind, told, no_inertia))
span = np.hypot(6.0, 2.0)
wheel = over_pulley(np.zeros(2), np.array([6.0, -2.0]), np.array([0.0, 1.0]), 0.045)[0] - span
"""
RESULTS = [
    ("sags by {2} cm over 6 m", "100 * sag_50"),
    ("pretension is worth {1} to {4} %", "gain.min(), gain.max()"),
    ("a hundredth of a micrometer of {0.27} mm at 25 N", "np.linalg.norm(moved[0])"),
    ("leaves the platform {84} mm off its path", "off_blind"),
    ("it stays within {3} mm", "off_told"),
    ("in the cell above {0.2} mm are left", "off_free"),
    ("an error of about {0.4} %",
     "100 * np.linalg.norm(moved[0] - predicted['elastic part only'][0]) / np.linalg.norm(moved[0])",
     0.06),
    ("(a) The wheel, {43} mm", "1e3 * wheel"),
    ("and the stretch, {31} mm, are of one size", "1e3 * 500 * span / 1e5", 1),
    ("CAROCA's point model misses {5} to {8} cm; zeroing at one pose takes a good half of that, and {3} cm stay",
     "more.min() / 10, more.max() / 10, np.abs(zeroed).max() / 10"),
]
GIVEN = ["on 201 points", "at 800 N"]
