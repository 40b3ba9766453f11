"""Laws of the mission: engine and geometry see the same, the pair gets there, every failure has a name."""

from copy import copy
from dataclasses import replace
from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest

import cdprlab as cl
from cdprlab.errors import InvalidInput

pytest.importorskip("pybullet", reason="PyBullet has no wheel here")

from test_explorers import kinematic_run

from cdprlab.fastkit import (
    ARRIVED,
    DONE,
    STOPPED,
    EnginePair,
    Hall,
    Mission,
    Stage,
    Vehicle,
    Walker,
    cast,
    in_hall,
    mission_scene,
    pair_pose,
    pick_and_place,
    run_mission,
    walk_through,
)
from cdprlab.fastkit.job.phases import job_phases
from cdprlab.fastkit.mission.engine_pair import moved_pair
from cdprlab.fastkit.mission.states import at_the_shelf
from cdprlab.fastkit.plane import turn
from cdprlab.view import save_scene

BOUNDS = [[-5, -6], [7, 2]]
PALLETS = [[2.6, -3.0, 0.8, 1.2, 0.3], [-1.5, -2.2, 1.2, 0.8, 0.0]]
START = [5.0, -3.5, 1.8]


@pytest.fixture(scope="module")
def world():
    return in_hall(cl.load_world("fastkit_suspended"), BOUNDS, PALLETS)


def coupled(world):
    task = world.task("pick_and_place")
    return replace(world, robot=world.robot.with_bases(task.coupled), pose=task.start, tasks={})


def through(world, task):
    """Work that is done at once, and leaves the bases coupled."""
    states = "coupled", "approach", "return", DONE
    events = tuple(SimpleNamespace(time=0.1 * k, state=state) for k, state in enumerate(states))
    bases = world.robot.with_bases(world.task(task).coupled).bases
    stand = np.array([[[*base.position, base.heading] for base in bases]])
    return SimpleNamespace(state=DONE, reason="", events=events, time=np.array([0.0, 0.3]), world=world,
                           base_poses=stand, table=lambda: {"state": DONE})


@pytest.fixture(scope="module")
def mission(world):
    return run_mission(world, BOUNDS, START, seed=3, beams=91, work=through,
                       walkers=(Walker([[2.5, -1.0], [6.0, -1.0]]),))


def test_beams_end_where_the_engine_s_rays_do(world):
    pair, hall = Vehicle.of(world.robot, 1.6), Hall.of_world(world, BOUNDS)
    with EnginePair(coupled(world), pair, hall, START) as bases:
        for scanner in pair.scanners:
            origin, directions = scanner.beams_from(bases.pose)
            ends = np.insert(origin + scanner.range * directions, 2, scanner.height, axis=1).tolist()
            hits = bases.engine.bullet.rayTestBatch([[*origin, scanner.height]] * len(ends), ends)
            rays = np.array([scanner.range * hit[2] if hit[0] >= 0 else np.inf for hit in hits])
            exact = bases.rays(scanner)
            np.testing.assert_array_equal(exact, cast(origin, directions, hall.segments))
            seen = np.isfinite(rays)
            assert seen.sum() > 50
            np.testing.assert_array_equal(seen, exact < 3.0)
            # Bullet keeps places as 32-bit numbers, and boxes have a margin of their own.
            np.testing.assert_allclose(rays[seen], exact[seen], atol=5e-3)


def test_the_pair_drives_in_the_engine_as_its_kinematics_say(world):
    pair, hall = Vehicle.of(world.robot, 1.6), Hall.of_world(world, BOUNDS)
    twist = np.array([0.08, 0.05, 0.05])
    with EnginePair(coupled(world), pair, hall, START) as bases:
        before = np.array(bases.pose)
        for _ in range(20):
            bases.drive(twist, 0.1)
        stands, both = np.array(bases.pose), bases.engine.base_poses
    assert np.ptp([stands[2] - before[2], 0.1]) <= 5e-3                    # 0.05 rad/s for 2 s
    np.testing.assert_allclose(pair.bases(stands)[1], both[1], atol=0.01)  # the link holds
    c, s = np.cos(before[2] + 0.05), np.sin(before[2] + 0.05)
    np.testing.assert_allclose(stands[:2] - before[:2], [0.16 * c - 0.1 * s, 0.16 * s + 0.1 * c], atol=5e-3)


def test_a_moved_pair_is_the_same_pair(world):
    berth, spacing = pair_pose(coupled(world))
    there = moved_pair(coupled(world), START)
    np.testing.assert_allclose(pair_pose(there)[0], START, atol=1e-12)
    np.testing.assert_allclose(cl.cable_lengths(there.robot, there.pose),
                               cl.cable_lengths(coupled(world).robot, coupled(world).pose), atol=1e-12)
    assert spacing == pytest.approx(1.6) and berth[2] == 0


def test_the_mission_gets_to_the_shelf_and_through_all_its_states(mission):
    assert [event.state for event in mission.events] == [
        "navigation", "undeployed", "deployed", "pick and place", "return", "home", DONE]
    assert mission.state == DONE and mission.reason == ""
    way = mission.journey
    assert way.state == ARRIVED and way.clearance.min() > 0.03
    off = way.errors[-1]
    assert np.linalg.norm(off[:2]) <= 0.05 and abs(off[2]) <= np.radians(2)
    assert np.linalg.norm(way.poses[-1, :2] - way.goal[:2]) <= 0.05


def test_the_pair_comes_home_coupled_to_where_it_began(mission, world):
    way, berth = mission.way_home, pair_pose(coupled(world))[0]
    assert way.state == ARRIVED and way.clearance.min() > 0.03
    # It begins where the work left the pair, and what it believed on arrival.
    np.testing.assert_allclose(way.poses[0], mission.journey.poses[-1], atol=1e-3)
    assert np.linalg.norm(way.errors[0, :2]) <= 0.05
    # Straight out of the berth to the station first, as straight as it came in.
    plan = next(plan for _, plan in way.plans if plan.found)       # the first may wait for the person to walk on
    np.testing.assert_allclose(plan.poses[1], berth + [0.2, -0.4, 0.0], atol=1e-12)
    np.testing.assert_array_equal(way.goal, START)
    assert np.linalg.norm(way.poses[-1, :2] - START[:2]) <= 0.05
    assert mission.now == pytest.approx(mission.journey.time[-1] + 0.3 + way.time[-1])
    assert [event.time for event in mission.events] == sorted(event.time for event in mission.events)


def test_bases_that_do_not_come_together_do_not_drive_home(world):
    def ajar(there, task):
        job = through(there, task)
        job.base_poses[-1, 0, 0] -= 0.03
        return job

    berth = pair_pose(coupled(world))[0]
    stopped = run_mission(world, BOUNDS, berth + [0.2, -0.4, 0.0], beams=91, work=ajar)
    assert stopped.state == STOPPED and stopped.way_home is None
    assert stopped.reason == "in return: the bases are not together: one is 30 mm off its coupled place"


@pytest.mark.long
def test_folding_is_the_deployment_turned_round(monkeypatch):
    """The platform holds still, the base ends where it began, and the link is closed again."""
    world = cl.load_world("fastkit_suspended")
    task = replace(world.task("pick_and_place"), coupled={"active": (-2.6, 0.0, 0.0)}, aside=-0.1)
    world = replace(world, tasks={"pick_and_place": task})
    phases = job_phases(world, task, fold=True)
    out, back = (([phase for phase in part if phase.drives]) for part in (phases[:6], phases[-5:-1]))
    assert [phase.name for phase in back] == ["step out", "fold", "close up"]
    stops = [task.coupled, *(phase.drives for phase in out)]
    assert [phase.drives for phase in back] == stops[-2::-1]
    np.testing.assert_allclose([phase.duration for phase in back], [phase.duration for phase in out[::-1]])
    only = (*phases[:6], *phases[-5:])
    monkeypatch.setattr("cdprlab.fastkit.job.job.job_phases", lambda *_, **__: only)
    job = pick_and_place(world, fold=True)
    assert job.state == DONE and job.events[-2].state == "link"
    assert np.linalg.norm(job.poses.position - task.start.position, axis=1).max() <= 1e-3
    np.testing.assert_allclose(job.base_poses[-1], job.base_poses[0], atol=1e-4)
    robot = world.robot
    assert (job.measured_tensions[1:] >= robot.tension_min).all() and (job.measured_tensions <= robot.tension_max).all()


def test_who_has_nothing_to_fold_is_told():
    world = cl.load_world("fastkit_constrained")
    task = replace(world.task("pick_and_place"), coupled={})
    world = replace(world, tasks={"pick_and_place": task})
    with pytest.raises(InvalidInput, match="names no `coupled:` base"):
        pick_and_place(world, fold=True)


def test_no_wheel_lifts_and_no_cable_moves_on_the_way(mission, world):
    for way in (mission.journey, mission.way_home):
        measured = way.measured
        # The first rows are wheels finding the floor.
        assert measured["wheels"][3:].min() > 10 and measured["tilts"].max() < np.radians(0.5)
        np.testing.assert_allclose(measured["tensions"], world.robot.tension_min[0], atol=0.05)  # tips weigh 1e-3 N
        assert len(measured) == len(way.time) - 1


def test_the_work_begins_where_the_pair_stands(mission, world):
    there, task = mission.job.world, mission.job.world.task("pick_and_place")
    standing = Vehicle.of(world.robot, 1.6).bases(mission.journey.poses[-1])
    np.testing.assert_allclose(task.coupled["active"], standing[0], atol=1e-9)
    passive = there.robot.base("passive")
    np.testing.assert_allclose([*passive.position, passive.heading], standing[1], atol=1e-9)
    gap = there.robot.base("active").position - passive.position
    asked = world.robot.base("active").position - world.robot.base("passive").position
    assert np.linalg.norm(gap) == pytest.approx(np.linalg.norm(asked), abs=1e-9)


def test_the_journey_is_drawn_with_words_for_those_who_cannot_see_it(mission):
    from cdprlab.fastkit.pictures.hall_figure import plot_journey

    figure = plot_journey(mission.journey)
    assert "reaches its goal" in figure.alt_text and len(figure.axes) == 3
    way = next(line for line in figure.axes[0].lines if line.get_label() == "way driven (middle)")
    np.testing.assert_array_equal(way.get_xydata(), mission.journey.poses[:, :2])


@pytest.mark.long
def test_the_mission_repeated_is_identical(mission, world):
    again = run_mission(world, BOUNDS, START, seed=3, beams=91, work=through,
                        walkers=(Walker([[2.5, -1.0], [6.0, -1.0]]),))
    np.testing.assert_array_equal(again.journey.poses, mission.journey.poses)
    np.testing.assert_array_equal(again.journey.estimates, mission.journey.estimates)
    np.testing.assert_array_equal(again.journey.measured["wheels"], mission.journey.measured["wheels"])
    np.testing.assert_array_equal(again.way_home.poses, mission.way_home.poses)
    np.testing.assert_array_equal(again.way_home.measured["wheels"], mission.way_home.measured["wheels"])
    assert again.events == mission.events


def test_no_way_to_the_shelf_stops_with_the_reason(world):
    walled = in_hall(world, [[-4.9, -5.9], [6.9, 1.9]], [[1.0, -1.4, 12.0, 0.2, 0.0]])
    stopped = run_mission(walled, BOUNDS, START, beams=91, work=through)
    assert stopped.state == STOPPED and stopped.job is None
    assert stopped.reason.startswith("in navigation: there is no way of 1.49 m width")


def test_no_room_to_dock_stops_with_the_reason(world):
    narrow = in_hall(world, [[-4.9, -5.9], [6.9, 1.9]], [[2.4, 0.6, 0.8, 0.12, 0.0]])
    stopped = run_mission(narrow, BOUNDS, START, beams=91, work=through)
    assert stopped.state == STOPPED and "no room to dock" in stopped.reason


@pytest.mark.parametrize("failing", ["first", "second", "third"])
def test_a_shut_guard_ends_in_the_safe_state_and_nothing_further_is_done(world, failing):
    done = []
    names = ("first", "second", "third")
    states = tuple(Stage(name, name, lambda _, name=name: done.append(name),
                         lambda _, name=name: "the door is shut" if name == failing else "") for name in names)
    events = list(walk_through(Mission(world, "pick_and_place", 0), states))
    assert done == list(names[:names.index(failing) + 1])
    assert events[-1].state == STOPPED and events[-1].why == f"in {failing}: the door is shut"


def having_gone(mission, journey):
    object.__setattr__(mission, "journey", journey)   # what a guard asks of it, and nothing else
    return mission


def test_a_pair_that_is_not_sure_of_its_place_does_not_deploy(world):
    unsure = SimpleNamespace(state=ARRIVED, reason="", goal=np.zeros(3), estimates=np.zeros((1, 3)),
                             deviations=np.array([[0.03, 0.001, 0.001]]))
    assert "off its berth" in at_the_shelf(having_gone(Mission(world, "pick_and_place", 0), unsure))


def test_wrong_requests_are_named(world):
    with pytest.raises(InvalidInput, match="of kind quintic"):
        run_mission(world, BOUNDS, START, "default")
    with pytest.raises(InvalidInput, match="a pair is a base 'active'"):
        pair_pose(cl.load_world("caroca"))
    with pytest.raises(InvalidInput, match="start"):
        run_mission(world, BOUNDS, [0, 0])


def test_the_film_shows_each_state_at_its_time(mission):
    """From above where the pair truly is; the job here has no pictures of its own, so only the drives are drawn."""
    from mission_pictures import MissionFilm

    from cdprlab.view.style import SKY

    film = MissionFilm(replace(mission, job=None, events=[event for event in mission.events if event.time < 1.0]))
    blue, places = np.array([int(SKY[i:i + 2], 16) for i in (1, 3, 5)]), []
    for t in (2.0, mission.journey.time[-1] - 2.0):
        seen = (np.asarray(film.frame_at(t)) == blue).all(axis=-1)[:450]        # without the key
        rows, columns = np.nonzero(seen)
        places.append([columns.mean(), -rows.mean()])
    k = [int(np.searchsorted(mission.journey.time, t - 1e-9)) for t in (2.0, mission.journey.time[-1] - 2.0)]
    moved = np.diff(mission.journey.vehicle.bases(mission.journey.poses[k])[:, 0, :2], axis=0)[0]
    drawn = np.diff(places, axis=0)[0]
    assert np.abs(drawn / np.linalg.norm(drawn) - moved / np.linalg.norm(moved)).max() < 0.05


def test_the_drives_are_drawn(mission):
    from mission_pictures import plot_drives

    figure = plot_drives(mission)
    assert [panel.get_title(loc="left") or panel.get_title() for panel in figure.axes[:2]] == ["way there", "way home"]
    np.testing.assert_array_equal(figure.axes[0].lines[0].get_ydata(), mission.journey.clearance)
    assert f"{mission.way_home.clearance.min():.2f} m of room" in figure.alt_text


def test_a_mission_is_a_scene_from_its_start_to_its_end(mission, tmp_path):
    """The pair carries bases and platform as one body, people stand where they stood, the page is small."""
    worked, stopped, job = copy(mission), copy(mission), kinematic_run(mission.world)
    worked.job, stopped.job = job, None
    shown = mission_scene(worked)
    assert [*shown] == ["way there", "work", "way home"]
    for part, journey in (("way there", mission.journey), ("way home", mission.way_home)):
        k = [int(np.argmin(np.abs(journey.time - state.time))) for state in shown[part]]
        beside = [turn(journey.poses[row, 2]).T @ (state.position[:2] - journey.poses[row, :2])
                  for row, state in zip(k, shown[part])]
        apart = [np.linalg.norm(state.robot.exit_points - state.position, axis=1) for state in shown[part]]
        for carried in (beside, apart):
            np.testing.assert_allclose(carried, np.broadcast_to(carried[0], np.shape(carried)), atol=1e-9)
        people = [[box.position[:2] for box in state.scene.boxes if box.name == "person"] for state in shown[part]]
        np.testing.assert_allclose(people, journey.people[k][..., :2])
    np.testing.assert_allclose(shown["way there"][-1].position, job.poses.position[0], atol=1e-9)
    np.testing.assert_allclose(shown["way home"][0].position, job.poses.position[-1], atol=1e-9)
    page = save_scene(shown, tmp_path / "scene.html", "mission")
    assert page.stat().st_size < 3_000_000
    with pytest.raises(InvalidInput, match="never came to it"):
        mission_scene(stopped)


@pytest.mark.long
def test_the_command_line_writes_the_journey(tmp_path, capsys, monkeypatch):
    from cdprlab.cli import mission_command

    def refused(there, task):
        job = through(there, task)
        job.state, job.reason, job.events = STOPPED, "the link does not open", ()
        return job

    monkeypatch.setattr(mission_command, "run_mission", partial(run_mission, work=refused))
    mission_command.fly_mission(SimpleNamespace(out=tmp_path, no_pictures=False), cl.load_world("fastkit_suspended"))
    assert "stopped safely: in deployed: the link does not" in capsys.readouterr().out
    assert sorted(path.name for path in tmp_path.iterdir()) == ["journey.png", "way_there.csv"]
