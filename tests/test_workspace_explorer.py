"""The workspace explorer: its map is what independent programs say, limits do what they must, every control answers."""

from itertools import product

import numpy as np
import pytest
from scipy.optimize import linprog

import cdprlab as cl
from cdprlab import course
from cdprlab.course.explorers.workspaces import CRITERIA
from cdprlab.errors import InvalidInput

NAMES = ("planar_rigid", "planar_suspended", "planar_point", "planar_point_3", "kntu_planar", "planar_mcdpr")

explored = pytest.mark.parametrize("name", NAMES)


def holds(robot, pose, pushes, low, high):
    """Whether tensions within limits balance weight and each push, says a linear program of its own."""
    W, weight = cl.wrench_matrix(robot, pose), cl.gravity_wrench(robot, pose)
    return all(linprog(np.zeros(robot.n_cables), A_eq=W, b_eq=-weight - push, bounds=(low, high)).status == 0
               for push in pushes)


@pytest.mark.parametrize("name", ["planar_rigid", "planar_point_3", "kntu_planar"])
def test_every_control_answers_at_both_ends_of_its_range(name):
    explorer = course.workspace_explorer(cl.load_world(name))
    start = explorer.values
    for criterion in CRITERIA:
        for control in explorer.controls.values():
            ends = control.options if control.name == "criterion" else (control.low, control.high)
            for end in ends:
                explorer.set(**{**start, "criterion": criterion, control.name: end})
                assert explorer.picture.startswith(b"\x89PNG") and "inside" in explorer.text
                assert criterion.replace("_", " ") in explorer.alt_text or control.name == "criterion"
    assert 'role="alert"' not in explorer.mistake.value
    explorer.close()


@pytest.mark.parametrize("name", ["planar_rigid", "planar_suspended", "planar_point_3"])
def test_feasible_cells_are_those_an_independent_program_finds(name):
    world = cl.load_world(name)
    explorer = course.workspace_explorer(world)
    angle = {"angle": 10.0} if world.robot.n_dof == 3 else {}
    low, high, push = 6.0, explorer.controls["tension_max"].low, explorer.controls["push"].high / 4
    explorer.set(tension_min=low, tension_max=high, push=push, **angle)
    state, places = explorer.state(explorer.values), explorer.grid.poses.position
    pushes = [np.array([x, y, 0.0][:world.robot.n_dof]) * push for x, y in product((-1, 1), repeat=2)]
    chosen = np.random.default_rng(1).choice(len(places), 60, replace=False)
    chosen = chosen[np.abs(state.margin.ravel()[chosen]) > 1e-6]
    turn = np.deg2rad(angle.get("angle", 0.0))
    expected = [holds(world.robot, cl.Pose(places[k], angle=turn), pushes, low, high) for k in chosen]
    assert state.inside.ravel()[chosen].tolist() == expected
    assert len(set(expected)) == 2, "both kinds must be among the cells"
    explorer.close()


@explored
def test_narrower_limits_and_stronger_pushes_never_add_a_cell(name):
    explorer = course.workspace_explorer(cl.load_world(name))
    start = explorer.state(explorer.values)
    for slider, value in (("tension_min", "high"), ("tension_max", "low"), ("push", "high")):
        explorer.set(**{slider: getattr(explorer.controls[slider], value)})
        after = explorer.state(explorer.values)
        if slider == "tension_max" and explorer.values[slider] > start.robot.tension_max.min():
            continue
        assert not (after.inside & ~start.inside).any(), slider
        start = after
    explorer.close()


@explored
def test_closure_and_static_equilibrium_know_no_limits(name):
    explorer = course.workspace_explorer(cl.load_world(name))
    for criterion in ("wrench_closure", "static_equilibrium"):
        explorer.set(criterion=criterion)
        before = explorer.state(explorer.values).inside
        explorer.set(tension_min=explorer.controls["tension_min"].high, push=explorer.controls["push"].high)
        assert np.array_equal(explorer.state(explorer.values).inside, before)
    explorer.close()


def test_closure_of_a_point_is_the_polygon_of_its_exits():
    explorer = course.workspace_explorer(cl.load_world("planar_point_3"))
    explorer.set(criterion="wrench_closure")
    x, y = explorer.grid.poses.position.T
    # Exits at (±2, 3) and (0, 0) m: inside is above both edges.
    height = y - 1.5 * np.abs(x)
    clear = np.abs(height) > 1e-9  # centers on an edge may fall on either side
    assert np.array_equal(explorer.state(explorer.values).inside.ravel()[clear], height[clear] > 0)
    explorer.close()


def test_borders_lie_half_way_between_cells_that_differ():
    explorer = course.workspace_explorer(cl.load_world("planar_rigid"))
    inside, grid = explorer.state(explorer.values).inside, explorer.grid
    line = np.concatenate([path.vertices for path in explorer.border.get_paths()])
    steps = (line - [places[0] for places in grid.axes.values()]) / grid.step
    low, high = (inside[tuple(side(steps.round(6)).astype(int).T)] for side in (np.floor, np.ceil))
    assert (low != high).all() and np.allclose(np.sort(steps.round(6) % 1, axis=1), [0, 0.5])
    changes = (inside[1:] != inside[:-1]).sum() + (inside[:, 1:] != inside[:, :-1]).sum()
    assert len(np.unique(line.round(6), axis=0)) == changes > 0
    explorer.close()


def test_the_platform_is_told_with_its_best_tensions():
    world = cl.load_world("planar_rigid")
    explorer = course.workspace_explorer(world)
    tau, margin = explorer.tensions(explorer.values), explorer.state(explorer.values).here[1]
    robot, pose = world.robot, world.pose
    np.testing.assert_allclose(cl.wrench_matrix(robot, pose) @ tau + cl.gravity_wrench(robot, pose), 0, atol=1e-9)
    assert min((tau - robot.tension_min).min(), (robot.tension_max - tau).min()) == pytest.approx(margin)
    assert f"{margin:.1f} N" in explorer.text
    explorer.set(criterion="wrench_closure")
    h = explorer.tensions(explorer.values)
    np.testing.assert_allclose(cl.wrench_matrix(robot, pose) @ h, 0, atol=1e-9)
    explorer.set(criterion="static_equilibrium")
    assert explorer.tensions(explorer.values) is None
    explorer.close()


def test_robots_that_do_not_move_in_a_plane_are_named():
    with pytest.raises(InvalidInput, match="world 'caroca' is 3R3T"):
        course.workspace_explorer(cl.load_world("caroca"))
    with pytest.raises(InvalidInput, match="must be a World, got Robot"):
        course.workspace_explorer(cl.load_world("planar_rigid").robot)
