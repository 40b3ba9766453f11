"""The twist set explorer: its verdicts are an independent LP's, and every control answers at both ends of its range."""

import itertools

import numpy as np
import pytest
from scipy.optimize import linprog

import cdprlab as cl
from cdprlab import course
from cdprlab.errors import InvalidInput

# HiGHS keeps its rows to 1e-7; scales are of size 1.
LINEAR_PROGRAM = 1e-6


@pytest.fixture(scope="module")
def planar():
    explorer = course.twist_set_explorer(cl.load_world("planar_mcdpr"))
    yield explorer
    explorer.close()


@pytest.fixture(scope="module")
def fastkit():
    explorer = course.twist_set_explorer(cl.load_world("fastkit_suspended"), components=(0, 2))
    yield explorer
    explorer.close()


def largest_scale(found, driving):
    """max s with |s J t − B q̇| ≤ l̇_max and |q̇| ≤ q̇_max."""
    robot, q = found.robot, np.concatenate([base.speed_max for base in found.robot.bases]) * driving
    B = cl.base_jacobian(robot, found.pose)
    rows = np.column_stack([-B, cl.jacobian(robot, found.pose) @ found.twist])
    sides = np.concatenate([robot.speed_max, robot.speed_max])
    return -linprog(-np.eye(len(q) + 1)[-1], A_ub=np.concatenate([rows, -rows]), b_ub=sides,
                    bounds=[*zip(-q, q), (0, None)], method="highs").fun


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("name", ["planar", "fastkit"])
def test_scales_and_verdicts_are_a_linear_programs(name, seed, request):
    explorer, rng = request.getfixturevalue(name), np.random.default_rng(seed)
    explorer.set(**{key: rng.uniform(control.low, control.high) for key, control in explorer.controls.items()})
    found = explorer.reach(explorer.values)
    expected = [largest_scale(found, driving) for driving in (0, 1)]
    np.testing.assert_allclose(found.scales, expected, rtol=LINEAR_PROGRAM)
    for driving, scale in enumerate(expected):
        assert found.verdict(bool(driving)).startswith("inside" if scale >= 1 else "OUTSIDE")
        assert found.verdict(bool(driving)) in explorer.alt_text
    assert found.shares.feasible


def test_the_papers_twist_needs_driving_bases(planar):
    planar.set(v_x=1.15, v_y=1.675, x=1.0, y=1.6, left_along=0.8, right_along=0.8, cable_speed=2.0)
    assert "bases fixed    OUTSIDE, scale at most 0.985" in planar.text
    assert "bases driving  inside, scale at most 1.220" in planar.text
    assert "2.03!" in planar.text and "13.66 fixed, 22.58 driving" in planar.text
    planar.set(left_along=0.0, right_along=0.0)
    assert planar.text.count("OUTSIDE, scale at most 0.985") == 2


def test_no_twist_is_available_at_any_scale(planar):
    planar.set(v_x=0.0, v_y=0.0)
    assert planar.text.count("inside, any scale") == 2


def test_a_base_that_the_world_holds_has_no_slider(fastkit):
    assert not any(name.startswith("passive") for name in fastkit.controls)
    assert {"active_turn", "active_along", "active_across", "v_x", "v_z"} <= set(fastkit.controls)
    assert "base passive: stands" in fastkit.text


@pytest.mark.parametrize("name", ["planar", "fastkit"])
def test_every_control_answers_at_both_ends_of_its_range(name, request):
    explorer = request.getfixturevalue(name)
    for key, control in explorer.controls.items():
        start = explorer.values[key]
        for end in (control.low, control.high):
            explorer.set(**{key: end})
            assert explorer.picture.startswith(b"\x89PNG")
            assert "scale" in explorer.text and "with the bases driving" in explorer.alt_text
        explorer.set(**{key: start})


def test_all_corners_in_the_plane(planar):
    for corner in itertools.product(*((control.low, control.high) for control in planar.controls.values())):
        found = planar.reach(dict(zip(planar.controls, corner)))
        fixed, driving = found.scales
        assert 0 < fixed <= driving * (1 + LINEAR_PROGRAM) and found.shares.feasible


def test_a_move_changes_the_picture(planar):
    before = planar.picture
    planar.set(x=0.8, v_x=1.0)
    assert planar.picture != before


def test_robots_without_bases_have_one_set():
    explorer = course.twist_set_explorer(cl.load_world("caroca_light"))
    found = explorer.reach(explorer.values)
    assert "base" not in "".join(explorer.controls)
    np.testing.assert_allclose(found.fixed.component_range(), found.moving.component_range())
    explorer.close()


def test_what_does_not_fit_is_named():
    with pytest.raises(InvalidInput, match="must be a World, got Robot"):
        course.twist_set_explorer(cl.load_world("planar_mcdpr").robot)
    with pytest.raises(InvalidInput, match="two different numbers from 0 to 5 of one unit"):
        course.twist_set_explorer(cl.load_world("fastkit_suspended"), components=(0, 3))
    document = cl.load_world("planar_point").to_dict()
    del document["cable_limits"]["speed"]
    with pytest.raises(InvalidInput, match="without a speed limit"):
        course.twist_set_explorer(cl.World.from_dict(document))
