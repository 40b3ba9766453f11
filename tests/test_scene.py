"""The k3d scene: the robot's geometry over time, tensions as color and as number, a page that needs nothing else."""

import json
import re

import numpy as np
import pytest
from test_explorers import kinematic_run, planar_world

import cdprlab as cl
from cdprlab.errors import InvalidInput
from cdprlab.view import save_scene
from cdprlab.view.scene import MotionScene, states_of
from cdprlab.view.style import DECK, OBSTACLE

LARGEST_PAGE = 3_000_000


def flown(name="caroca", **changed):
    from dataclasses import replace

    run = kinematic_run(planar_world() if name == "planar" else cl.load_world(name))
    return replace(run, **changed)


def played(scene):
    """What the player in the page is told."""
    return json.loads(re.search(r"const motion = (\{.*?\});", scene.plot.additional_js_code).group(1))


@pytest.mark.parametrize("name", ["caroca", "mobile_four_bases", "planar"])
def test_cables_run_from_exits_to_anchors_at_every_frame(name):
    run = flown(name)
    scene = MotionScene(states_of(run))
    assert len(scene.cables.vertices) == len(scene.times) == len(run.time)
    for time, points in scene.cables.vertices.items():
        k = int(np.argmin(np.abs(run.time - float(time))))
        ends = points.reshape(run.world.robot.n_cables, -1, 3)
        vectors = ends[:, 0] - ends[:, -1]
        if name == "planar":
            assert np.abs(vectors[:, 1]).max() == 0.0   # the plane y = 0
            vectors = vectors[:, [0, 2]]
        np.testing.assert_allclose(vectors, cl.cable_vectors(run.world.robot, run.poses[k]), atol=1e-5)  # float32


def test_slack_cables_hang_are_grey_and_say_so():
    tau = np.array(flown().measured_tensions)
    tau[:, 0], tau[:, 1] = np.nan, 0.0
    scene = MotionScene(states_of(flown(measured_tensions=tau)))
    ropes = next(iter(scene.cables.vertices.values())).reshape(8, -1, 3)
    for k, rope in enumerate(ropes):
        straight = np.linspace(rope[0], rope[-1], len(rope))
        below = (straight - rope)[:, 2].max()
        assert (below > 0.05) == (k < 2)
    shades = next(iter(scene.cables.attribute.values())).reshape(8, -1)
    assert (shades[:2] < 0).all() and (shades[2:] > 0).all()
    assert all(row[:2] == [0.0, 0.0] for row in played(scene)["tensions"])


def test_the_player_is_told_the_log():
    run = flown()
    told = played(MotionScene({"there": states_of(run)}))
    np.testing.assert_allclose(told["times"], run.time, atol=5e-4)
    np.testing.assert_allclose(told["tensions"], run.measured_tensions, atol=0.051)
    assert told["notes"] == ["there"] * len(run.time)
    assert told["largest"] == pytest.approx(run.measured_tensions.max(), rel=0.01)


def test_long_runs_are_thinned_and_end_where_they_end():
    run = flown()
    states = [state._replace(time=0.01 * k) for k, state in enumerate(100 * states_of(run))]
    scene = MotionScene(states)
    assert len(scene.times) <= 160 and scene.times[-1] == pytest.approx(states[-1].time)


def test_bases_that_drive_and_boxes_that_are_carried_move():
    world = cl.load_world("planar_mcdpr")
    driven = []
    with cl.open_simulator(world, cables="length") as engine:
        for _ in range(20):
            engine.drive(np.array([0.0, 0.5, 0.0, 0.0, 0.0, 0.0]))
            engine.wind(cl.cable_lengths(engine.robot, world.pose))
            driven.append(engine.state())
    scene = MotionScene(driven)
    moving = [thing for thing in scene.plot.objects if thing.type == "Mesh" and isinstance(thing.vertices, dict)]
    ways = [np.ptp([points[:, 0].mean() for points in thing.vertices.values()]) for thing in moving]
    assert max(ways) > 1e-3


def test_boxes_of_the_scene_are_solid():
    document = cl.load_world("caroca").to_dict()
    wall = {"position": [0, -1.95, 1.75], "size": [7, 0.02, 3.5]}
    world = cl.World.from_dict({**document, "scene": {**document["scene"], "obstacles": [wall]}})
    solid, = (thing for thing in MotionScene(states_of(kinematic_run(world, steps=2))).plot.objects
              if thing.type == "Mesh" and thing.color == int(OBSTACLE.removeprefix("#"), 16))
    np.testing.assert_allclose(np.ptp(solid.vertices, axis=0), [7, 0.02, 3.5], rtol=1e-5)


def test_the_page_needs_nothing_else_and_stays_small(tmp_path):
    path = save_scene(flown(), tmp_path / "scene.html")
    page = path.read_text(encoding="utf-8")
    assert path.stat().st_size <= LARGEST_PAGE
    assert not re.findall(r"<(?:script|link)[^>]+(?:src|href)=", page.replace("\n", " "))
    assert 'class="cdprlab-still"' in page and 'alt="CAROCA' in page


def test_no_states_are_refused():
    with pytest.raises(InvalidInput, match="one state at least"):
        MotionScene([])


def test_a_base_that_tips_is_drawn_leaning():
    """Cables run from where the engine has the exit points of bodies that tip, and decks lean as their bases do."""
    world = cl.load_world("fastkit_suspended")
    with cl.open_simulator(world, bodies=True) as engine:
        pulls = np.where(np.array(world.robot.base_indices) == 0, 95.0, 5.0)
        while engine.tilts.max() < np.radians(3):
            engine.step(pulls)
        scene = MotionScene([engine.state(), engine.state()._replace(time=engine.time + 1)])
        exits, leans = engine.bases.exits, engine.tilts.max()
    assert np.abs(exits - world.robot.exit_points).max() > 0.05
    np.testing.assert_allclose(scene.cables.vertices.reshape(8, -1, 3)[:, 0], exits, atol=1e-5)   # float32
    decks = next(part for part in scene.plot.objects if getattr(part, "color", None) == int(DECK[1:], 16))
    up = [np.cross(deck[1] - deck[0], deck[2] - deck[0]) for deck in decks.vertices.reshape(-1, 8, 3)]
    tilts = [np.arccos(abs(normal / np.linalg.norm(normal)).max()) for normal in up]
    assert max(tilts) == pytest.approx(leans, abs=1e-4)
