"""Laws of cable configurations: equilibrium, sampled perturbations, the paper's tables where they are right."""

from itertools import combinations

import numpy as np
import pytest

import cdprlab as cl
import robots
from cdprlab.configurations import (
    Configuration,
    classify_configurations,
    compatible_configurations,
    plan_configurations,
    plan_detour,
    reset_by_marks,
    taut_configurations,
)
from cdprlab.configurations.accuracy import position_sensitivity
from cdprlab.configurations.region import region
from cdprlab.configurations.sequence import location_score
from cdprlab.configurations.sides import FORMS, side_range
from cdprlab.course.props.slack import slack_length
from cdprlab.errors import InvalidInput

EXITS = np.array([[0.12, 0.08, 3.10], [2.78, 0.11, 3.10], [2.79, 2.29, 3.10], [-0.08, 2.18, 3.10]])
S, G = [0.60, 0.80, 0.80], [1.90, 1.10, 0.50]


@pytest.fixture(scope="module")
def marionet():
    """Ramadour and Merlet 2014, section V."""
    return robots.build("3T", EXITS, np.zeros((4, 3)), (0.0, 1000.0), center_of_mass=[0, 0, 0])


def random_robot(rng, m):
    """A point mass below m exit points that are not in one plane."""
    angle = np.sort(rng.uniform(0, 2 * np.pi, m))
    exits = np.stack([2 * np.cos(angle), 2 * np.sin(angle), rng.uniform(2.5, 3.5, m)], axis=1)
    return robots.build("3T", exits, np.zeros((m, 3)), (0.0, 1000.0), center_of_mass=[0, 0, 0])


def pulls(exits, M):
    """Tensions of three cables that hold 1 N at M."""
    u = exits - M
    u = u / np.linalg.norm(u, axis=1, keepdims=True)
    return np.linalg.solve(u.T, [0, 0, 1.0])


# --- classes ----------------------------------------------------------------------------------------------
def test_classes_of_start_and_goal(marionet):
    assert classify_configurations(marionet, S) == {(1, 2, 3): "outside", (1, 2, 4): "inside", (1, 3, 4): "inside",
                                                    (2, 3, 4): "outside"}
    assert classify_configurations(marionet, G) == {(1, 2, 3): "inside", (1, 2, 4): "outside", (1, 3, 4): "outside",
                                                    (2, 3, 4): "inside"}


def test_both_uncertainties_are_needed_to_leave_one_sequence(marionet):
    """Section VI.A: with one of them alone, A124 holds all the way and nothing need be changed."""
    start, goal = [0.86, 0.66, 1.80], [1.64, 0.84, 1.80]
    assert [s.configurations for s in plan_configurations(marionet, start, goal)] == [((1, 2, 4), (1, 2, 3))]
    for alone in ({"position_uncertainty": 0.0}, {"exit_uncertainty": 0.0}):
        assert [s.configurations for s in plan_configurations(marionet, start, goal, **alone)] == [((1, 2, 4),)]


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("form", ["corners", "translated", "natural"])
def test_classes_never_contradict_sampled_perturbations(seed, form):
    rng = np.random.default_rng(seed)
    robot, M = random_robot(rng, 4), np.append(rng.uniform(-1.2, 1.2, 2), rng.uniform(0.5, 2.9))
    classes = classify_configurations(robot, M, 0.05, 0.02, form=form)
    moved = M + rng.uniform(-0.05, 0.05, (1250, 3))
    exits = robot.exit_points + rng.uniform(-0.02, 0.02, (1250, 4, 3))
    for chosen, verdict in classes.items():
        u = exits[:, chosen.indices] - moved[:, None]
        up = np.broadcast_to([[0.0], [0.0], [1.0]], (1250, 3, 1))
        holds = (np.linalg.solve(np.swapaxes(u, 1, 2), up)[..., 0] > 0).all(axis=1)
        assert verdict == "uncertain" or (holds.all() if verdict == "inside" else not holds.any())


@pytest.mark.parametrize("seed", range(6))
def test_the_polygon_in_plan_is_what_is_certainly_inside(seed):
    rng = np.random.default_rng(seed)
    exits, height = random_robot(rng, 3).exit_points, rng.uniform(0.5, 3.4)
    known = region(exits, 0.02, 0.05)
    corners = known.polygon(exits[:, :2], height)
    for x, y in rng.uniform(-2, 2, (300, 2)):
        low = known.certainty(np.array([x, y, height]))[0]
        edge = np.roll(corners, -1, axis=0) - corners
        side = edge[:, 0] * (y - corners[:, 1]) - edge[:, 1] * (x - corners[:, 0])
        assert (low > 0) == (len(corners) > 2 and ((side > 0).all() or (side < 0).all())) or abs(low) < 1e-9


def test_above_the_exits_nothing_holds(marionet):
    assert set(classify_configurations(marionet, [1.0, 1.0, 3.3]).values()) == {"outside"}
    assert set(classify_configurations(marionet, [1.0, 1.0, 3.1]).values()) <= {"uncertain", "outside"}


@pytest.mark.parametrize("seed", range(5))
def test_interval_forms_hold_each_other(seed):
    """corners ⊂ every other form: the exact range is in every over-estimate; the contractor comes back to it."""
    rng = np.random.default_rng(seed)
    a, b, m = rng.uniform(-2, 2, (3, 2))
    ranges = {form: side_range(a, b, m, 0.02, 0.05, form) for form in FORMS}
    low, high = ranges["corners"]
    values = [(q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]) for p, q, r in
              zip(a + rng.uniform(-0.02, 0.02, (500, 2)), b + rng.uniform(-0.02, 0.02, (500, 2)),
                  m + rng.uniform(-0.05, 0.05, (500, 2)))]
    assert low <= min(values) and max(values) <= high
    assert all(r[0] <= low + 1e-12 and high - 1e-12 <= r[1] for r in ranges.values())
    assert ranges["contractor"] == pytest.approx((low, high), abs=1e-4)  # twenty halvings of less than 20 m²


def test_intervals_leave_the_rounding_of_everything_else_alone():
    """A process that rounds upward prints 1.38 as 1.3800000000000001, and every sum is a little too large."""
    for _ in range(2):
        low, high = side_range(np.array([0.1, 0.0]), np.array([0.3, 0.0]), np.array([0.0, 0.1]), 0.0, 0.0, "natural")
        assert low < high  # 0.1 is no binary number: a sharp answer would be no enclosure
        assert float("1.38") == 1.38 and repr(float("1.38")) == "1.38"
        assert -(-1.0 - 2.0**-60) == 1.0 and 1.0 + 2.0**-60 == 1.0


def test_the_natural_form_loses_the_safe_change(marionet):
    """The paper's own transition at x = 1.40 is certain for every form but the one with A_i written twice."""
    M = np.array(S) + (1.38 - 0.60) / 1.30 * (np.array(G) - S)
    safe = {form: classify_configurations(marionet, M, form=form) for form in FORMS}
    for form in ("corners", "contractor", "translated"):
        assert safe[form][1, 2, 4] == safe[form][1, 2, 3] == "inside", form
    assert "uncertain" in (safe["natural"][1, 2, 4], safe["natural"][1, 2, 3])


@pytest.mark.parametrize("seed", range(10))
def test_taut_configurations_are_those_that_pull(seed):
    rng = np.random.default_rng(seed)
    robot, M = random_robot(rng, 5), np.append(rng.uniform(-1, 1, 2), 1.0)
    expected = {c for c in combinations(range(1, 6), 3) if (pulls(robot.exit_points[np.array(c) - 1], M) > 0).all()}
    assert set(taut_configurations(robot, M)) == expected


def test_on_a_line_two_cables_hold_and_below_an_exit_one(marionet):
    middle = (EXITS[0] + EXITS[2]) / 2
    on_diagonal = taut_configurations(marionet, [*middle[:2], 1.0])
    assert (1, 3) in on_diagonal and not any({1, 3} < set(c) for c in on_diagonal)
    assert taut_configurations(marionet, [*EXITS[0, :2], 1.0]) == ((1,),)


# --- sequences ----------------------------------------------------------------------------------------------
def test_the_three_sequences_of_the_paper(marionet):
    found = plan_configurations(marionet, S, G)
    assert [(s.configurations, s.score, s.safe) for s in found] == [
        (((1, 2, 4), (1, 2, 3)), 4, True),
        (((1, 3, 4), (1, 2, 3)), 10, False),
        (((1, 2, 4), (2, 3, 4)), 11, False),   # the paper's 10 scores G in A123
    ]
    safe, first, second = found
    assert 1.3549 - 1e-4 <= safe.steps[1][0][0] <= 1.4037 + 1e-4
    np.testing.assert_allclose(first.steps[1][0], [1.1406, 0.9248, 0.6752], atol=1e-4)
    np.testing.assert_allclose(second.steps[1][0][:2], [1.530, 1.015], atol=5e-4)
    assert all(s.steps[0][0].tolist() == S and s.steps[-1][0].tolist() == G for s in found)


def test_a_change_on_an_edge_is_not_safe_however_well_the_edge_is_known(marionet):
    found = plan_configurations(marionet, S, G, position_uncertainty=0.0, exit_uncertainty=0.0)
    assert [(s.score, s.safe) for s in found] == [(4, True), (10, False), (11, False)]


@pytest.mark.parametrize("position, cables, distances, score", [
    (S, (1, 3, 4), (0.87, 2.65, 1.54), 3), ((1.1406, 0.9248), (1, 3, 4), (1.32, 2.14, 1.75), 1),
    ((1.1406, 0.9248), (1, 2, 3), (1.32, 1.83, 2.14), 1), (G, (1, 2, 3), (2.05, 1.32, 1.49), 1),
    (S, (1, 2, 4), (0.87, 2.29, 1.54), 3), ((1.40, 0.98), (1, 2, 4), (1.56, 1.63, 1.91), 0),
    ((1.40, 0.98), (1, 2, 3), (1.56, 1.63, 1.91), 0)])
def test_tables_one_and_two(position, cables, distances, score):
    exits = EXITS[np.array(cables) - 1]
    M = np.array([*position[:2], 0.5])
    d = np.linalg.norm(exits[:, :2] - M[:2], axis=1)
    if cables == (1, 2, 3) and position == (1.40, 0.98):
        distances = (1.56, 1.63, 1.91)  # the table repeats the row above: the third distance is to A3
        assert d[:2] == pytest.approx(distances[:2], abs=0.01) and d[2] == pytest.approx(1.91, abs=0.01)
    else:
        assert d == pytest.approx(distances, abs=0.011)  # printed to two decimals, some cut instead of rounded
    assert location_score(exits, M) == score


@pytest.mark.parametrize("method", ["stability", "accuracy"])
@pytest.mark.parametrize("seed", range(6))
def test_sequences_hold_all_the_way(method, seed):
    """Between two steps the step's configuration pulls; safe steps are certain; changes are the fewest."""
    rng = np.random.default_rng(seed)
    robot = random_robot(rng, 5)
    start, goal = (np.append(rng.uniform(-0.9, 0.9, 2), rng.uniform(0.5, 2.0)) for _ in range(2))
    try:
        found = plan_configurations(robot, start, goal, method)
    except InvalidInput:
        assert not taut_configurations(robot, start) or not taut_configurations(robot, goal)
        return
    for sequence in found:
        for (a, chosen), (b, after) in zip(sequence.steps, sequence.steps[1:]):
            if chosen != after:
                assert np.array_equal(a, b)
                continue
            for share in np.linspace(0.001, 0.999, 7):
                tau = pulls(robot.exit_points[chosen.indices], a + share * (b - a))
                assert (tau > -1e-6).all()
        if sequence.safe:
            for M, chosen in sequence.steps:
                # On the border of certainty, where a grade is best, the last digit may fall either way.
                classes = classify_configurations(robot, M, 0.05 - 1e-9, 0.02)
                assert classes[chosen] == "inside"
    assert len({len(sequence.configurations) for sequence in found}) <= 1


def test_method_two_changes_inside_the_certain_window(marionet):
    best = plan_configurations(marionet, [1.85, 1.40, 1.60], [1.85, 0.70, 1.30], "accuracy")[0]
    assert best.configurations == ((2, 3, 4), (1, 2, 3)) and best.safe
    assert 0.904 - 1e-3 <= best.steps[1][0][1] <= 1.384 + 1e-3
    assert best.score == max(best.location_scores)


@pytest.mark.parametrize("seed", range(10))
def test_the_sensitivity_bounds_what_length_errors_do(seed):
    rng = np.random.default_rng(seed)
    exits = random_robot(rng, 3).exit_points
    M = np.append(rng.uniform(-0.5, 0.5, 2), 0.8)
    bound = float(position_sensitivity(exits, M, 0.05, 0.02))
    nominal = float(position_sensitivity(exits, M))
    worst = 0.0
    for _ in range(300):
        u = exits + rng.uniform(-0.02, 0.02, (3, 3)) - (M + rng.uniform(-0.05, 0.05, 3))
        inverse = np.linalg.inv(u / np.linalg.norm(u, axis=1, keepdims=True))
        worst = max(worst, np.abs(inverse).sum(axis=1).max())
    assert nominal <= bound and worst <= bound
    u = exits - M
    inverse = np.linalg.inv(u / np.linalg.norm(u, axis=1, keepdims=True))
    assert nominal == pytest.approx(np.abs(inverse).sum(axis=1).max(), rel=1e-12)


def test_no_change_is_two_steps_and_staying_is_allowed(marionet):
    for goal in ([0.7, 0.75, 0.9], S):
        for sequence in plan_configurations(marionet, S, goal):
            assert len(sequence.steps) == 2 and sequence.transition_scores == ()


CROSSING = [1.43019, 1.03966, 1.0]  # of the diagonals, in plan: no triplet is certain there


def test_a_start_that_no_triplet_is_certain_of_counts_nominally_and_is_not_safe(marionet):
    assert "inside" not in classify_configurations(marionet, CROSSING).values()
    found = plan_configurations(marionet, CROSSING, [2.3, 1.0, 1.0])
    assert found and not any(sequence.safe for sequence in found)


def test_around_the_crossing_there_is_a_safe_way(marionet):
    start, goal = [0.5, 0.4, 0.8], [2.3, 1.9, 0.8]
    assert not any(s.safe for s in plan_configurations(marionet, start, goal))
    around = plan_detour(marionet, start, goal)
    assert around is not None and around.safe
    for M, chosen in around.steps:
        assert classify_configurations(marionet, M, 0.05 - 1e-9)[chosen] == "inside"
    for (a, before), (b, after) in zip(around.steps, around.steps[1:]):
        assert before == after or np.array_equal(a, b)


def test_a_detour_from_the_crossing_starts_with_the_nearest_certain_point(marionet):
    around = plan_detour(marionet, CROSSING, [2.3, 1.0, 1.0])
    assert around is not None and not around.safe
    (_, first), (M0, second) = around.steps[:2]
    assert first == second and classify_configurations(marionet, M0, 0.05 - 1e-9)[second] == "inside"
    assert np.linalg.norm(M0 - CROSSING) < 0.3


# --- measurements -------------------------------------------------------------------------------------------
@pytest.mark.parametrize("seed", range(20))
def test_the_true_configuration_is_never_excluded(seed):
    rng = np.random.default_rng(seed)
    robot = random_robot(rng, 4)
    M = np.append(rng.uniform(-1, 1, 2), rng.uniform(0.5, 2.0))
    for chosen in taut_configurations(robot, M):
        slack = rng.uniform(0, 0.3, 4)
        slack[chosen.indices] = 0
        lengths = np.linalg.norm(robot.exit_points - M, axis=1) + slack + rng.uniform(-0.01, 0.01, 4)
        assert chosen in compatible_configurations(robot, lengths, 0.01)


@pytest.mark.parametrize("position, chosen", [(S, (1, 2, 4)), (S, (1, 3, 4)), (G, (1, 2, 3)), (G, (2, 3, 4))])
def test_the_slack_length_is_the_smallest_that_makes_the_choice_certain(marionet, position, chosen):
    slack = slack_length(marionet, position, chosen, 0.01)
    lengths = np.linalg.norm(EXITS - position, axis=1)
    loose = np.array([i + 1 not in chosen for i in range(4)])
    assert compatible_configurations(marionet, lengths + slack * loose, 0.01) == (chosen,)
    assert compatible_configurations(marionet, lengths + (slack - 1e-3) * loose, 0.01) != (chosen,)
    assert 0.01 < slack < 0.20  # with 1 cm of error, the paper's 20 cm are on the safe side here


def test_the_slack_length_is_the_first_that_is_certain(marionet):
    """At longer slack another triplet may come into question again, where its cables just meet."""
    place = [1.64, 0.84, 1.80]
    slack = slack_length(marionet, place, (1, 2, 3), 0.005)
    lengths = np.linalg.norm(EXITS - place, axis=1)
    assert len(compatible_configurations(marionet, lengths + [0, 0, 0, 0.62], 0.005)) > 1
    assert slack < 0.05 and compatible_configurations(marionet, lengths + [0, 0, 0, slack], 0.005) == ((1, 2, 3),)


def test_marks_put_a_drifting_length_right():
    true = np.linspace(2.0, 4.0, 201)
    drum = 2.0 + (true - 2.0) * 1.02   # 2 % more than there is
    marks = [(int(np.searchsorted(true, x)), x) for x in (2.5, 3.0, 3.5)]
    assert np.abs(drum - true).max() == pytest.approx(0.04)
    assert np.abs(reset_by_marks(drum, marks) - true).max() <= 0.02 * 0.51  # drift since the last mark, one step late


# --- mistakes -----------------------------------------------------------------------------------------------
def test_mistakes_are_named(marionet):
    with pytest.raises(InvalidInput, match="3R3T"):
        classify_configurations(robots.robot_3r3t(), [0, 0, 1])
    with pytest.raises(InvalidInput, match=r"start \[5.0, 5.0, 1.0\].*below the exit points"):
        plan_configurations(marionet, [5, 5, 1], G)
    with pytest.raises(InvalidInput, match="goal"):
        plan_configurations(marionet, S, [1.0, 1.0, 3.2])
    with pytest.raises(InvalidInput, match="'stability' or 'accuracy'"):
        plan_configurations(marionet, S, G, "speed")
    with pytest.raises(InvalidInput, match=r"corners, translated, natural, contractor"):
        classify_configurations(marionet, S, form="exact")
    with pytest.raises(InvalidInput, match="exit_uncertainty"):
        classify_configurations(marionet, S, exit_uncertainty=-0.1)
    with pytest.raises(InvalidInput, match="too near an edge"):
        slack_length(marionet, (EXITS[0] + EXITS[2]) / 2 - [0, 0, 2], (1, 2, 3))


def test_a_configuration_prints_as_in_the_paper_and_knows_its_rows():
    chosen = Configuration((4, 1, 2))
    assert (str(chosen), chosen.indices.tolist(), chosen == (1, 2, 4)) == ("A124", [0, 1, 3], True)
    assert str(Configuration((1, 2, 10))) == "A1,2,10"
    assert cl.load_world("point_mass").robot.n_cables == 4
