"""Lesson 05: numbers in its prose; the thesis' own (Okoli 2016, Table 6.1) are given."""

SETUP = """
moving_minus_still = tensions[:, 0] - tensions[:, 1]

def appears_about_y(spin, steps=1500, dt=1e-3, kp=100.0, kd=20.0):
    "Largest error about y [rad] of the ideal loop without the exact rate, 0.1 rad off about x, the reference spinning."
    turn = course.rotation_from_vector
    w_d, w, R_d, R = np.array([0, 0, spin]), np.array([0, 0, spin]), np.eye(3), turn(np.array([-0.1, 0, 0]))
    seen = []
    for _ in range(steps):
        e = course.rotation_vector(R_d @ R.T)
        seen.append(abs(e[1]))
        w = w + dt * (kd * (w_d - w) + kp * e)
        R_d, R = turn(dt * w_d) @ R_d, turn(dt * w) @ R
    return max(seen)

thesis_path = light.task("thesis").trajectory()(np.linspace(0, 100, 401)).pose
flown = cl.distribute_tensions(cl.wrench_matrix(light.robot, thesis_path), cl.gravity_wrench(light.robot, thesis_path),
                               1.0, 6500.0, "closed_form").tensions
away = np.linalg.norm(thesis_path[0].position - [0, 0, 1.5])
"""
RESULTS = [
    ("At first cable 2 pulls up to {73} N more", "moving_minus_still[:, 1].max()"),
    ("so −{73} N). Then it lets go by {61} N while cable 1 pulls {31} N more",
     "moving_minus_still[:, 1].max(), -moving_minus_still[:, 1].min(), moving_minus_still[60:, 0].max()"),
    ("up to {0.03} rad appear about y", "appears_about_y(3.0)"),
    ("at 0.8 m/s and 1 ms {0.4} mm", "1e3 * 0.5 * 0.8 * 1e-3"),
    ("this controller runs {240} times a second", "1 / 4.2e-3", 3),
    ("that is {500} in the place of {480}", "2 / 4e-3, (2 - 1e4 * 4e-3**2 / 2) / 4e-3"),
    ("{125} times a second to and fro", "1 / (2 * 4e-3)"),
    ("an error is down to {4} % after", "100 * (1 + 5) * np.exp(-5)"),
    ("The weight is {10} N", "light.robot.mass * light.robot.gravity"),
    ("the path's start is {2.06} m away, and $m_P K_p\\, e$ is {206} N", "away, 100 * light.robot.mass * away"),
    ("the middle of the limits, {3250} N", "(1 + 6500) / 2", 1),
    ("Flown on the path that is {428} N at *every* gain", "flown.max()"),
]
GIVEN = ["| linear program | 54 N | 456 N | 1224 N |", "| quadratic program | 32 N | 110 N | 342 N |",
         "| pseudo-inverse | 117 N | 117 N | 117 N |", "| closed form | 267 N | 385 N | 517 N |", "in its Fig. 6.21",
         "Why it is 117 N", "That the thesis has 267, 385 and 517 N"]
