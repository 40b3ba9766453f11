"""Numbers in the prose of pages that stand in none of their generated tables: results, and what is given."""

PAGES = {
    "cable_failure": {
        "RESULTS": [("the weight's {1471} N", "cl.load_world('caroca').robot.mass * 9.81", 0.6)],
        "GIVEN": ["CAROCA (150 kg", "from (0.9, 0.9, 0.5) to (-0.9, -0.9, 1.3) m", "below 10 mm and 5°",
                  "exceeds 0.1 m",
                  "within 10 mm at t"],
    },
    "fastkit": {
        "RESULTS": [("carry the {118} N of platform and payload", "(5 + 7) * 9.81"),
                    ("if they rise by {0.35} m a meter", "np.tan(np.arcsin((5 + 7) * 9.81 / (8 * 45)))")],
        "GIVEN": ["±3.2 m", "80 kg", "5.6 m apart", "0.6 × 0.36 × 0.2 m", "0.4 × 0.3 × 0.15 m",
                  "outside 0.64 × 0.4 × 0.22 m",
                  "P at x = 0.8 m", "from x = −0.8 m to 0.8 m", "gains of 900 and 60"],
        "OPEN": ["sags from 1.8 m", "ends at P = 1.75 m", "45 N and 92 % of"],
    },
    "marionet": {
        "SETUP": """
from cdprlab.course import region

exits = cl.load_world("marionet").robot.exit_points
S, G = np.array([0.60, 0.80, 0.80]), np.array([1.90, 1.10, 0.50])
start, end = np.array([1.85, 0.70, 1.30]), np.array([1.85, 1.40, 1.60])

def certain(ropes, a, b):
    return region(exits[[rope - 1 for rope in ropes]], 0.02, 0.05).window(a, b)

window = [0.60 + 1.30 * share for share in (certain((1, 2, 3), S, G)[0], certain((1, 2, 4), S, G)[1])]
both = [0.70 + 0.70 * share for share in (certain((2, 3, 4), start, end)[0], certain((1, 2, 3), start, end)[1])]
""",
        "RESULTS": [("from {1.3549} to {1.4037} m", "tuple(window)"), ("from {0.904} to {1.384} m", "tuple(both)"),
                    ("at its upper end, y = {1.384} m", "both[1]"),
                    ("on that way z = {1.377} m", "1.30 + 0.30 * (0.88 - 0.70) / 0.70")],
        "GIVEN": ["(1.51, 1.01)", "x = 1.85 m",
                  "S = (0.86, 0.66, 1.80), G = (1.64, 0.84, 1.80), printed M = (1.40, 0.78, 1.80)",
                  "(1.85, 0.80, 1.30)", "(1.85, 0.88, 0.38)", "(1.85, 0.70, 1.30)", "(1.85, 0.88, 1.38)",
                  "at y = 0.88 m",
                  "printed 0.88 m", "70 kg, 0.4 m/s", "(0.4 to 0.6 m at S and G"],
        "OPEN": ["by about 0.35 %",
                 "(1.22, 0.99) and (1.47, 1.06)"],
    },
    "mission": {"GIVEN": ["section 2.3", "270°"]},
    "picking": {"GIVEN": ["50 kN", "section 2.2", "1.15 m", "(each for 0.1 s)"],
                "OPEN": ["5.5 N from its limits", "round its shelf, 4.4 m"]},
    "pulleys": {"GIVEN": ["wheels of 45 mm", "with 70 kg"]},
    "thesis_chapter6": {
        "RESULTS": [("middle of the limits, {3250} N", "(1 + 6500) / 2", 1),
                    ("grow by factors of {4.4} and {6.3}",
                     "tables['maxima'][8] / tables['maxima'][2], tables['maxima'][14] / tables['maxima'][2]")],
        "GIVEN": ["(reported: 8.4 and 22.7 for the linear, 3.4 and 10.7 for", "z = 3.5 m", "(6.28)", "(6.29)",
                  "(6.19) to (6.21)",
                  "(6.1), (6.2), (6.5)", "(2.24)"],
        "OPEN": ["from 0 to 93 m"],
    },
    "workspaces": {"GIVEN": ["(Fig. 2.5)"]},
}
