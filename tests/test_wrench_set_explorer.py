"""The wrench set explorer: its sets hold what tensions reach, its tipping facets are where a base is about to go."""

import itertools

import numpy as np
import pytest
from scipy.optimize import linprog

import cdprlab as cl
from cdprlab import course
from cdprlab.errors import InvalidInput
from cdprlab.mechanics.statics import tipping_rows

WORLDS = ("planar_mcdpr", "fastkit_planar", "fastkit_suspended", "planar_point")


@pytest.fixture(params=WORLDS)
def explorer(request):
    explorer = course.wrench_set_explorer(cl.load_world(request.param))
    yield explorer
    explorer.close()


@pytest.fixture
def planar():
    explorer = course.wrench_set_explorer(cl.load_world("planar_mcdpr"))
    yield explorer
    explorer.close()


def somewhere(explorer, seed):
    """Random values within every slider's range."""
    rng = np.random.default_rng(seed)
    explorer.set(**{name: rng.uniform(control.low, control.high) for name, control in explorer.controls.items()})
    return explorer.capability(explorer.values)


def box_corners(robot):
    return np.array(list(itertools.product(*zip(robot.tension_min, robot.tension_max))))


def all_rows(found):
    rows = tipping_rows(found.robot, found.pose).values()
    return np.concatenate([r.matrix for r in rows]), -np.concatenate([r.offset for r in rows])


def can_exert(found, force, slack=0.0):
    """Independent of Polytope: is there a τ within the limits, no base tipping, that gives the force?"""
    A, b = all_rows(found)
    return linprog(np.zeros(A.shape[1]), A_ub=A, b_ub=b + slack, A_eq=cl.wrench_matrix(found.robot, found.pose),
                   b_eq=force, bounds=list(zip(found.robot.tension_min, found.robot.tension_max))).status == 0


@pytest.mark.parametrize("seed", range(4))
def test_the_set_of_the_limits_is_spanned_by_the_images_of_the_box_corners(planar, seed):
    found = somewhere(planar, seed)
    images = box_corners(found.robot) @ cl.wrench_matrix(found.robot, found.pose).T
    ways = np.random.default_rng(seed).normal(size=(50, 2))
    np.testing.assert_allclose(found.limits.support(ways), (images @ ways.T).max(axis=0), rtol=1e-12)


@pytest.mark.parametrize("seed", range(4))
def test_no_base_tips_within_the_standing_set_and_one_does_outside(planar, seed):
    found = somewhere(planar, seed)
    corners = found.standing.vertices
    for corner in corners:
        assert can_exert(found, corner, slack=1e-6)
    for ends in found.facets:
        middle, along = ends.mean(axis=0), ends[1] - ends[0]
        outward = np.array([along[1], -along[0]]) / np.linalg.norm(along)
        step = 1e-3 * np.ptp(corners, axis=0).max() * outward
        assert can_exert(found, middle - step) and not can_exert(found, middle + step)


@pytest.mark.parametrize("seed", range(4))
def test_the_largest_moment_of_an_edge_is_taken_at_a_corner_of_the_box(explorer, seed):
    found = somewhere(explorer, seed)
    moments = cl.tipping_moments(found.robot, found.pose, box_corners(found.robot))
    largest = np.concatenate([np.zeros(0), *(values.max(axis=0) for values in moments.values())])
    np.testing.assert_allclose([edge.moment for edge in found.edges], largest, rtol=1e-9, atol=1e-9)
    assert all(edge.share == 0 for edge in found.edges if edge.moment <= 0)
    assert all(-1e-9 < edge.share < 1 + 1e-9 for edge in found.edges)


@pytest.mark.parametrize("seed", range(6))
def test_the_payload_is_what_a_linear_program_finds(planar, seed):
    found = somewhere(planar, seed)
    W, (A, b) = cl.wrench_matrix(found.robot, found.pose), all_rows(found)
    g, w_g = found.robot.gravity, cl.gravity_wrench(found.robot, found.pose)
    bounds = [*zip(found.robot.tension_min, found.robot.tension_max), (0, None)]
    for tipping in (False, True):
        rows = {"A_ub": A, "b_ub": b} if tipping else {}
        empty = linprog(np.zeros(4), A_eq=W, b_eq=-w_g, bounds=bounds[:4], **rows)
        rows = {"A_ub": np.c_[A, np.zeros(len(A))], "b_ub": b} if tipping else {}
        best = linprog([0, 0, 0, 0, -1], A_eq=np.c_[W, [0, -g]], b_eq=-w_g, bounds=bounds, **rows)
        if empty.status == 0:
            assert found.payloads[int(tipping)] == pytest.approx(best.x[-1], abs=1e-6)
        else:
            assert np.isnan(found.payloads[int(tipping)])


def test_heavy_bases_take_nothing_away(planar):
    planar.set(base_mass=120)
    found = planar.capability(planar.values)
    assert max(edge.moment for edge in found.edges) < 0 and len(found.facets) == 0
    assert found.standing.volume == pytest.approx(found.limits.volume, rel=1e-9)
    assert "No facet comes from tipping" in planar.text


def test_light_bases_cannot_even_hold_the_platform(planar):
    planar.set(base_mass=10)
    assert "hold the platform without tipping a base" in planar.text and "none" in planar.text


def test_every_control_answers_at_both_ends_of_its_range(explorer):
    for name, control in explorer.controls.items():
        start = explorer.values[name]
        for end in (control.low, control.high):
            explorer.set(**{name: end})
            assert explorer.picture.startswith(b"\x89PNG")
            assert "payload [kg]" in explorer.text and "platform at" in explorer.alt_text
        explorer.set(**{name: start})


def test_all_corners_in_the_plane(planar):
    for corner in itertools.product(*((control.low, control.high) for control in planar.controls.values())):
        planar.set(**dict(zip(planar.controls, corner)))
        found = planar.capability(planar.values)
        assert found.standing.volume <= found.limits.volume * (1 + 1e-9)


def test_the_picture_follows_the_mass(planar):
    before = planar.picture
    planar.set(base_mass=30)
    assert planar.picture != before and "left 1" in planar.alt_text
    planar.set(base_mass=60)
    assert planar.picture == before


def test_what_has_no_set_in_the_plane_is_named():
    with pytest.raises(InvalidInput, match="must be a World, got '"):
        course.wrench_set_explorer("planar_mcdpr")
    with pytest.raises(InvalidInput, match="single degree of freedom"):
        course.wrench_set_explorer(one_cable_direction())


def one_cable_direction():
    document = cl.load_world("planar_point").to_dict()
    document["motion_pattern"] = "1T"
    return cl.World.from_dict(document)
