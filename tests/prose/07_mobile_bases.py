"""Lesson 07: numbers in its prose."""

SETUP = """
moved_wrong = flights["slide and lean", "as_printed"][0]
wrong_turn = np.abs(printed - about_center).max(axis=(1, 2))
off_axis = distance * np.hypot(1, 0.5)
winches = cl.jacobian(planar.robot, cl.Pose([1.0, 1.6], angle=0.0)) @ [1.15, 1.675]
speeds, pose, hard = drives["slide"], leaning.pose, []
with cl.open_simulator(leaning, cables="length", dt=2e-3) as simulator:
    simulator.drive(speeds)
    lengths = cl.cable_lengths(leaning.robot, pose)
    for t in 2e-3 * np.arange(500):    # rates from the beginning of the step
        bases = {base.name: (base.position[0] + ahead * t, 0.0, base.heading + turn * t)
                 for base, (turn, ahead, _) in zip(leaning.robot.bases, speeds.reshape(-1, 3))}
        lengths = lengths - 2e-3 * cl.base_jacobian(leaning.robot.with_bases(bases), pose) @ speeds
        simulator.wind(lengths)
        hard.append(simulator.tensions.max())
"""
RESULTS = [
    ("is already wrong by {5} cm per radian when the platform is {6} cm away",
     "100 * wrong_turn[1], 100 * off_axis[1]"),
    ("would have to be paid out at {2.03} m/s", "winches.max()"),
    ("by a tenth of a millimeter after two steps, 4 ms, and by {14} cm after a second", "100 * moved_wrong[-1]"),
    ("make them pull with nearly {100} kN", "1e-3 * max(hard)", 5),
]
