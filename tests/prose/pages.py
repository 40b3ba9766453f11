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
        "GIVEN": ["(1.51, 1.01)", "x = 1.85 m",
                  "S = (0.86, 0.66, 1.80), G = (1.64, 0.84, 1.80), printed M = (1.40, 0.78, 1.80)",
                  "(1.85, 0.80, 1.30)", "(1.85, 0.88, 0.38)", "(1.85, 0.70, 1.30)", "(1.85, 0.88, 1.38)",
                  "at y = 0.88 m",
                  "printed 0.88 m", "70 kg, 0.4 m/s", "(0.4 to 0.6 m at S and G"],
        "OPEN": ["from 1.3549 to 1.4037 m", "z = 1.377 m", "by about 0.35 %", "from 0.904 to 1.384 m", "y = 1.384 m",
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
