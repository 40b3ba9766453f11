"""Numbers in the prose of pages that stand in none of their generated tables: results, and what is given."""

PAGES = {
    "cable_failure": {
        "RESULTS": [("the weight's {1471} N", "cl.load_world('caroca').robot.mass * 9.81", 0.6)],
        "GIVEN": ["CAROCA (150 kg", "from (0.9, 0.9, 0.5) to (-0.9, -0.9, 1.3) m", "below 10 mm and 5°",
                  "exceeds 0.1 m",
                  "within 10 mm at t"],
    },
    "fastkit": {
        "SETUP": """
robot = cl.load_world("fastkit_suspended").robot

def held(pose):
    weight = -cl.gravity_wrench(robot, pose)
    return cl.available_wrench_set(robot, pose, tipping=True).contains(weight + 7.0 * robot.gravity * np.eye(6)[2])

line = [max(z for z in np.arange(0.2, 2.01, 0.1) if held(cl.Pose([x, 0.0, z]))) for x in (2.4, 0.0)]
""",
        "RESULTS": [("carry the {118} N of platform and payload", "(5 + 7) * 9.81"),
                    ("if they rise by {0.35} m a meter", "np.tan(np.arcsin((5 + 7) * 9.81 / (8 * 45)))"),
                    ("that ends at P = {1.76} m",
                     "2.4 - (5 / 2 - 0.64 / 2) * np.tan(np.arcsin((5 + 7) * 9.81 / (8 * 45))) + 0.22 / 2"),
                    ("at that height {45} N and {92} % of the motors' torque",
                     "tables['carry'][-5], 100 * tables['carry'][-4] / 0.6", 0.5),
                    ("below a line that sags from {1.8} m near the bases to {1.2} m in the middle",
                     "line[0], line[-1]")],
        "GIVEN": ["±3.2 m", "80 kg", "5.6 m apart", "0.6 × 0.36 × 0.2 m", "0.4 × 0.3 × 0.15 m",
                  "outside 0.64 × 0.4 × 0.22 m",
                  "P at x = 0.8 m", "from x = −0.8 m to 0.8 m", "gains of 900 and 60"],
    },
    "marionet": {
        "SETUP": """
from cdprlab.course import position_sensitivity, region

exits = cl.load_world("marionet").robot.exit_points
S, G = np.array([0.60, 0.80, 0.80]), np.array([1.90, 1.10, 0.50])
start, end = np.array([1.85, 0.70, 1.30]), np.array([1.85, 1.40, 1.60])

def certain(ropes, a, b):
    return region(exits[[rope - 1 for rope in ropes]], 0.02, 0.05).window(a, b)

y = np.linspace(0.7, 1.4, 141)
there = np.stack([np.full_like(y, 1.85), y, 1.3 + 0.3 * (y - 0.7) / 0.7], axis=-1)
old, new = (position_sensitivity(exits[chosen], there, 0.0, 0.0) for chosen in ([1, 2, 3], [0, 1, 2]))
from_5, way_5 = np.array([1.60, 1.10]), np.array([-1.40, -0.40])    # S and G − S of Fig. 5, seen from above

def crossing(a, b):
    one, other = exits[a - 1, :2], exits[b - 1, :2]
    return from_5 + way_5 * np.linalg.solve(np.column_stack([way_5, one - other]), one - from_5)[0]

window = [0.60 + 1.30 * share for share in (certain((1, 2, 3), S, G)[0], certain((1, 2, 4), S, G)[1])]
both = [0.70 + 0.70 * share for share in (certain((2, 3, 4), start, end)[0], certain((1, 2, 3), start, end)[1])]
""",
        "RESULTS": [("from {1.3549} to {1.4037} m", "tuple(window)"), ("from {0.904} to {1.384} m", "tuple(both)"),
                    ("at its upper end, y = {1.384} m", "both[1]"),
                    ("on that way z = {1.377} m", "1.30 + 0.30 * (0.88 - 0.70) / 0.70"),
                    ("A234 is better all along by about {0.35} %", "100 * (1 - old / new).mean()"),
                    ("meets the diagonals at ({1.22}, {0.99}) and ({1.47}, {1.06})",
                     "(*crossing(1, 3), *crossing(2, 4))")],
        "GIVEN": ["(1.51, 1.01)", "x = 1.85 m",
                  "S = (0.86, 0.66, 1.80), G = (1.64, 0.84, 1.80), printed M = (1.40, 0.78, 1.80)",
                  "(1.85, 0.80, 1.30)", "(1.85, 0.88, 0.38)", "(1.85, 0.70, 1.30)", "(1.85, 0.88, 1.38)",
                  "at y = 0.88 m",
                  "printed 0.88 m", "70 kg, 0.4 m/s", "(0.4 to 0.6 m at S and G"],
    },
    "mission": {"GIVEN": ["section 2.3", "270°"]},
    "picking": {
        "RESULTS": [("on the same way round its shelf, {4.4} m",
                     "np.hypot(*(np.array(cl.load_world('fastkit_constrained').task('pick_and_place').coupled['active'][:2])"
                     " - cl.load_world('fastkit_constrained').robot.base('active').position))")],
        # The page names the test that asks for it at every 5 cm.
        "GIVEN": ["50 kN", "section 2.2", "1.15 m", "(each for 0.1 s)", "5.5 N from its limits"],
    },
    "pulleys": {"GIVEN": ["wheels of 45 mm", "with 70 kg"]},
    "thesis_chapter6": {
        "RESULTS": [("middle of the limits, {3250} N", "(1 + 6500) / 2", 1),
                    ("grow by factors of {4.4} and {6.3}",
                     "tables['maxima'][8] / tables['maxima'][2], tables['maxima'][14] / tables['maxima'][2]")],
        "GIVEN": ["(reported: 8.4 and 22.7 for the linear, 3.4 and 10.7 for", "z = 3.5 m", "(6.28)", "(6.29)",
                  "(6.19) to (6.21)",
                  "(6.1), (6.2), (6.5)", "(2.24)", "from 0 to 93 m"],
    },
    "workspaces": {"GIVEN": ["(Fig. 2.5)"]},
}
