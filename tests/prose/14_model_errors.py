"""Lesson 14: numbers in its prose."""

SETUP = """
wound_run, pulled_run = flights["wound to length"], flights["tension control"]

def first_slack(seed, low=0.0, high=0.02):
    "The error of the exit points at which a cable of that robot goes slack [mm]."
    def is_slack(error):
        return (wound(cl.perturbed(world, exit_points=error, seed=seed).robot).tensions == 0).any()
    while high - low > 2e-5:
        middle = (low + high) / 2
        low, high = (low, middle) if is_slack(middle) else (middle, high)
    return np.ceil(1e4 * high) / 10  # the slider's steps

def heap(rests):
    off = 1e3 * np.array([rest.pose.position - goal.position for rest in rests])
    return np.linalg.norm(off, axis=1).mean(), np.sqrt(off.var(axis=0).sum())

many, one_robot = (heap(rests) for rests in ends.values())
"""
RESULTS = [
    ("change its length by $5^2/(2\\cdot3000)$ mm, {4} µm", "1e3 * 5**2 / (2 * 3000)"),
    ("the platform weighs {49} N, the cables hold 45 N", "robot.mass * robot.gravity"),
    ("5 mm would make {62} N", "50e3 / 4 * 5e-3", 0.6),
    ("the others pull up to {26} N", "wound_run.measured_tensions.max()"),
    ("it is {12} mm off at worst", "1e3 * wound_run.position_errors.max()"),
    ("smooth tensions between {8} and {15} N, as wanted, and at most {0.4} mm",
     "pulled_run.measured_tensions.min() - 0.5, pulled_run.measured_tensions.max(), 1e3 * "
     "pulled_run.position_errors.max()"),
    ("comes between {1.1} mm (robot 9) and {13.2} mm (robot 5)", "first_slack(9), first_slack(5)"),
    ("At {1.3} mm. Up to there", "first_slack(1)"),
    ("the robots scatter by {6} mm around the goal", "many[1]"),
    ("scattered by {0.6} mm, and the heap is {4.5} mm beside the goal", "one_robot[1], one_robot[0]"),
]
GIVEN = ["(ISO 9283)"]
