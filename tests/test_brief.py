"""A brief's verdict is that of linear programs, and every kind of wrong design hears its own reason."""

import copy

import numpy as np
import pytest
from scipy.optimize import linprog

import cdprlab as cl
from cdprlab import course
from cdprlab.course.brief import workshop_brief

BRIEF = workshop_brief()
ANCHORS = [[0.4, -0.3, -0.2], [-0.4, 0.3, 0.2], [-0.4, -0.3, 0.2], [0.4, 0.3, -0.2],
           [-0.4, -0.3, -0.2], [0.4, 0.3, 0.2], [0.4, -0.3, 0.2], [-0.4, 0.3, -0.2]]


def design(exits, anchors):
    return {"name": "mine", "motion_pattern": "3R3T",
            "platform": {"mass": 80.0, "size": [0.8, 0.6, 0.4], "pose": {"position": [0, 0, 1.0]}},
            "cable_limits": {"tension": [15, 700]},
            "cables": [{"exit_point": list(a), "anchor_point": list(b)} for a, b in zip(exits, anchors)]}


def eight(low=3.2):
    """CAROCA's pattern in the hall's corners; cables to the load's lower corners start lower."""
    corners = [[sx * 3.0, sy * 2.2] for sy in (-1, 1) for sx in (-1, -1, 1, 1)]
    return design([[x, y, low if b[2] < 0 else 3.6] for (x, y), b in zip(corners, ANCHORS)], ANCHORS)


def six():
    """Three cables and their mirror images."""
    exits, anchors = [[2, 2.2, 3.6], [1, 2.2, 3.6], [-3, -2.2, 3.6]], [[0.4, 0, -0.2], [0.4, -0.3, 0.2], [0, 0, 0.2]]
    return design([*exits, *([-x, y, z] for x, y, z in exits)], [*anchors, *([-x, y, z] for x, y, z in anchors)])


GOOD = {"eight": eight, "six": six}
every_design = pytest.mark.parametrize("good", GOOD.values(), ids=GOOD)


@every_design
def test_both_reference_designs_meet_the_brief_also_between_its_poses(good):
    assert BRIEF.judge(good()).met and BRIEF.judge(good()).reasons == ()
    assert BRIEF.judge(good(), BRIEF.poses(seed=1)).met


@every_design
def test_the_margin_is_that_of_a_linear_program(good):
    robot, poses = cl.World.from_dict(good()).robot, BRIEF.poses(seed=2, count=12)
    m, least = robot.n_cables, np.inf
    for k in range(12):
        W, weight = cl.wrench_matrix(robot, poses[k]), cl.gravity_wrench(robot, poses[k])
        for push in BRIEF.wrenches:
            # Variables τ and s: the largest s with τ_min + s ≤ τ ≤ τ_max − s.
            rows = np.block([[-np.eye(m), np.ones((m, 1))], [np.eye(m), np.ones((m, 1))]])
            answer = linprog(-np.eye(m + 1)[m], rows, np.r_[-robot.tension_min, robot.tension_max],
                             np.c_[W, np.zeros(6)], -(weight + push), bounds=(None, None))
            least = min(least, -answer.fun)
    assert BRIEF.judge(good(), poses).margin == pytest.approx(least, abs=1e-6 * 700)


def test_worlds_mappings_and_files_are_judged_alike(tmp_path):
    world = cl.World.from_dict(six())
    path = world.save(tmp_path / "six.yaml")
    assert BRIEF.judge(world) == BRIEF.judge(six()) == BRIEF.judge(path) == BRIEF.judge(str(path))


def changed(**edits):
    """The eight-cable design with some of its parts replaced: "platform.mass" is written platform__mass."""
    document = copy.deepcopy(eight())
    for place, value in edits.items():
        node = document
        *keys, last = [int(part) if part.isdigit() else part for part in place.split("__")]
        for key in keys:
            node = node[key]
        node[last] = value
    return document


def few(m):
    document = six()
    document["cables"] = document["cables"][:m]
    return document


UNCROSSED = [[-0.4 if k // 2 % 2 == 0 else 0.4, -0.3 if k < 4 else 0.3, 0.2 if k % 2 else -0.2] for k in range(8)]
TRIANGLE = [[0, 0.3, 0.2]] * 2 + [[0.4, -0.3, 0.2]] * 2 + [[-0.4, -0.3, 0.2]] * 2
EXITS = [cable["exit_point"] for cable in eight()["cables"]]
WRONG = [
    (few(5), "number of cables", "seventh cable"),
    ({**eight(), "cables": eight()["cables"] + eight()["cables"][:1]}, "number of cables", "9, allowed are 8"),
    (changed(platform__mass=8.0), "the load", "mass"),
    (changed(platform__inertia=[1.0, 1.0, 1.0]), "the load", "inertia"),
    (changed(platform__center_of_mass=[0, 0, -0.2]), "the load", "center of mass"),
    (changed(gravity=1.62), "the load", "gravity"),
    (changed(cable_limits__tension=[15, 7000]), "the winches", "in stock"),
    (changed(cables__2__exit_point=[4.0, -2.2, 3.6]), "exit points", "cable 3 has exit points outside"),
    (changed(cables__2__anchor_point=[1.4, -0.3, 0.2]), "anchor points", "cable 3 has anchor points beyond"),
    (changed(cables__2__anchor_point=[0.0, 0.0, 0.0]), "cables run freely", "through the load"),
    (eight(low=3.6), "cables keep apart", "38 mm"),
    (design(EXITS, UNCROSSED), "holds the load everywhere", "cross the cables"),
    (design([[x, y, 2.0] for x, y, _ in EXITS], ANCHORS), "holds the load everywhere", "more than its winch has"),
    (design([[3, 2.2, 3.6]] * 3 + [[-3, -2.2, 3.6]] * 3, [[0, 0, 0.2]] * 6), "holds the load everywhere", "lost rank"),
    (design([[-3, 2.2, 3.6], [3, 2.2, 3.6], [3, 2.2, 3.6], [0, -2.2, 3.6], [0, -2.2, 3.6], [-3, 2.2, 3.6]], TRIANGLE),
     "holds the load everywhere", "short of what keeps it taut"),
    (changed(cables__0__exit_point=[0.4, -0.3, 0.4]), "every cable has a direction", "cable 1 has no length"),
    (changed(motion_pattern="3T"), "a world file", "cable 1: anchor_point"),
    (changed(cables__0__exit_point=[1.0, 2.0]), "a world file", "cable 1: exit_point"),
    ("no_such_file.yaml", "a world file", "no_such_file"),
    (None, "a world file", "NoneType"),
    ("point_mass", "six degrees of freedom", "3T"),
]


@pytest.mark.parametrize(("document", "point", "words"), WRONG, ids=[wrong[1] for wrong in WRONG])
def test_a_wrong_design_hears_why(document, point, words):
    verdict = BRIEF.judge(document)
    assert not verdict.met
    assert any(reason.startswith(point) and words in reason for reason in verdict.reasons), verdict.reasons
    assert "✗" in str(verdict)


def test_fewer_cables_can_be_asked_for():
    assert "8, allowed are 6" in workshop_brief(6).judge(eight()).reasons[0]
    assert workshop_brief(6).judge(six()).met
    assert "at most 6" in str(workshop_brief(6))


def test_the_designer_judges_the_brief_with_every_edit():
    designer = course.robot_designer(cl.World.from_dict(eight()), BRIEF)
    assert "The brief is met" in designer.text
    designer.do(designer.session.edit, ("cables", 0, "exit_point", 0), 5.0)
    assert "The brief is not met" in designer.text and "✗" in designer.brief.value
    designer.do(designer.session.undo)
    assert "The brief is met" in designer.text
    designer.close()
