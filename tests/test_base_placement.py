"""Where bases must stand: judged pose by pose, wrench by wrench, with the floor's reactions under every contact."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import linprog

import cdprlab as cl
from cdprlab.errors import InvalidInput, NoPlacement
from cdprlab.mechanics.statics import tipping_rows
from cdprlab.robot import Base
from cdprlab.workspace.placement import place_bases
from cdprlab.workspace.placement.program import Duty, worst_margin
from cdprlab.workspace.placement.proof import largest_share, standing_rows
from robots import BASED, build, case

WORLDS = [
    ("planar_mcdpr", [[2.6, 1.2], [3.2, 1.4]]),
    ("fastkit_planar", [[1.2, 1.6, 0.0], [1.9, 1.6, 0.1]]),
    ("mobile_four_bases", [[4.0, 3.0, 0.8], [5.0, 3.5, 1.2], [4.5, 2.5, 1.0]]),
    ("fastkit_suspended", [[-1.0, 0.0, 1.5], [1.0, 0.0, 1.5]]),
]


def share(robot, pose, load, standing=True):
    """The largest λ ≤ 1 of a load that tensions within the limits balance, and those tensions.

    Standing is asked of the floor: forces upwards, never downwards, at every contact of every footprint hold the base
    against its weight and its cables. −1 where not even λ = 0 is possible.
    """
    d, m = robot.dimension, robot.n_cables
    up, directions = np.eye(d)[-1], cl.cable_directions(robot, pose)
    bases = [base for base in robot.bases if len(base.footprint)] if standing else []
    contacts = [np.array([base.to_world(c if d == 2 else [*c, 0.0]) for c in base.footprint]) for base in bases]
    count = 1 + m + sum(map(len, contacts))
    A, b, column = [np.zeros((robot.n_dof, count))], [np.zeros(robot.n_dof)], 1 + m
    A[0][:, 0], A[0][:, 1:1 + m] = load, cl.wrench_matrix(robot, pose)
    for base, feet in zip(bases, contacts):
        rows = np.zeros((2 if d == 2 else 3, count))
        for i, cable in enumerate(robot.cables):
            if cable.base == base.name:
                rows[:, 1 + i] = on_the_floor(robot.exit_points[i], -directions[i])
        for foot in feet:
            rows[:, column] = on_the_floor(foot, up)
            column += 1
        A.append(rows)
        b.append(on_the_floor(base.to_world(base.center_of_mass), base.mass * robot.gravity * up))
    bounds = [(0, 1), *zip(robot.tension_min, robot.tension_max), *[(0, None)] * (count - 1 - m)]
    found = linprog(-np.eye(count)[0], A_eq=np.concatenate(A), b_eq=np.concatenate(b), bounds=bounds, method="highs")
    return (found.x[0], found.x[1:1 + m]) if found.status == 0 else (-1.0, np.full(m, np.nan))


def on_the_floor(point, force):
    """What a floor without grip feels of a force: upwards, and the moments that roll and pitch."""
    if point.size == 2:
        return np.array([force[1], point[0] * force[1] - point[1] * force[0]])
    return np.array([force[2], *np.cross(point, force)[:2]])


def serves(robot, poses, wrenches, standing=True):
    return all(share(robot, pose, wrench, standing)[0] > 1 - 1e-9
               for pose in poses for wrench in np.atleast_2d(wrenches))


def wanted(name, places):
    """Robot, poses and wrenches: its weight, and a push of 2 % of it to either side; FASTKIT with its load of 7 kg."""
    robot = cl.load_world(name).robot
    if name == "fastkit_suspended":
        robot = robot.with_payload(7.0, [0, 0, 0])
    places = np.array(places)
    poses = cl.Pose(places[:, :2], angle=places[:, 2]) if robot.n_dof == 3 else cl.Pose(places)
    weight = cl.gravity_wrench(robot, poses[0])
    push = 0.02 * np.abs(weight).max() * np.eye(robot.n_dof)[0]
    return robot, poses, np.stack([weight, weight + push, weight - push])


def lighter(robot, mass):
    return replace(robot, bases=tuple(replace(base, mass=mass) for base in robot.bases))


@pytest.mark.parametrize("tipping", [True, False])
@pytest.mark.parametrize("name, places", WORLDS)
def test_bases_are_placed_where_they_serve(name, places, tipping):
    """Judged by programs of its own, not by the search's; only what may drive has moved, and nothing collides."""
    robot, poses, wrenches = wanted(name, places)
    placed = place_bases(robot, poses, wrenches, tipping=tipping)
    assert serves(placed, poses, wrenches, standing=tipping)
    if placed is not robot:
        assert not serves(robot, poses, wrenches, standing=tipping)
    for before, after in zip(robot.bases, placed.bases):
        shift = before.rotation[:2, :2].T @ (after.position - before.position)
        change = np.append(after.heading - before.heading, shift)
        np.testing.assert_allclose(change[before.speed_max == 0], 0, atol=1e-12)
    for i, a in enumerate(placed.bases):
        assert all(np.linalg.norm(a.position - b.position) > 0.6 for b in placed.bases[:i])


@pytest.mark.parametrize("name, places", WORLDS)
def test_the_moments_about_every_edge_are_kept(name, places):
    robot, poses, wrenches = wanted(name, places)
    placed = place_bases(robot, poses, wrenches)
    for pose in poses:
        for wrench in wrenches:
            moments = cl.tipping_moments(placed, pose, share(placed, pose, wrench)[1])
            assert all(about.max() < 1e-6 for about in moments.values())
    assert bool(moments) == (name != "fastkit_planar")   # whose bases have no footprint


def test_fastkit_tips_where_its_cables_alone_would_have_it_stand():
    """7 kg at 1.5 m: with the cables alone asked for, the world's own bases of 80 kg end up where they fall."""
    robot, poses, (weight, *_) = wanted("fastkit_suspended", [[-1.0, 0.0, 1.5], [1.0, 0.0, 1.5]])
    falling = place_bases(robot, poses, weight, tipping=False)
    assert serves(falling, poses, weight, standing=False)
    assert not serves(falling, poses, weight)
    assert serves(place_bases(robot, poses, weight), poses, weight)


def test_planar_bases_stand_closer_together_the_lighter_they_are():
    robot, poses, wrenches = wanted("planar_mcdpr", [[2.6, 1.2], [3.2, 1.4]])
    light = lighter(robot, 5.0)
    falling = place_bases(light, poses, wrenches, tipping=False)
    assert serves(falling, poses, wrenches, standing=False) and not serves(falling, poses, wrenches)
    standing = place_bases(light, poses, wrenches)
    assert serves(standing, poses, wrenches)
    spans = [placed.bases[1].position[0] - placed.bases[0].position[0] for placed in (standing, falling)]
    assert spans[0] < spans[1]


def test_bases_that_serve_already_stay():
    world = cl.load_world("fastkit_planar")
    assert place_bases(world.robot, world.pose, cl.gravity_wrench(world.robot, world.pose)) is world.robot


def test_a_margin_can_be_asked_for():
    """A tenth of every cable's half range is kept, and a tenth of what a base's weight holds against tipping."""
    robot, poses, wrenches = wanted("planar_mcdpr", [[2.6, 1.2], [3.2, 1.4]])
    light = lighter(robot, 8.0)
    band = 0.1 * (robot.tension_max - robot.tension_min) / 2
    spare = 0.1 * 8.0 * 9.81 * 0.3          # both contacts are 0.3 m from the center of mass

    def keeps(placed):
        inner = replace(placed, cables=tuple(
            replace(cable, tension_min=cable.tension_min + b, tension_max=cable.tension_max - b)
            for cable, b in zip(placed.cables, band)))
        for pose in poses:
            rows = np.concatenate([rows.matrix for rows in tipping_rows(inner, pose).values()])
            sides = -np.concatenate([rows.offset for rows in tipping_rows(inner, pose).values()])
            for wrench in wrenches:
                if linprog(np.zeros(4), A_ub=rows, b_ub=sides - spare, A_eq=cl.wrench_matrix(inner, pose), b_eq=-wrench,
                           bounds=[*zip(inner.tension_min, inner.tension_max)], method="highs").status:
                    return False
        return True

    assert keeps(place_bases(light, poses, wrenches, margin=0.1))
    assert not keeps(place_bases(light, poses, wrenches))


@pytest.mark.parametrize("name, places", WORLDS)
def test_the_margin_is_the_worst_of_all_poses_and_wrenches(name, places):
    """s of half the range from every limit, and s of the mean moment of a base's weight about its edges."""
    robot, poses, wrenches = wanted(name, places)
    robot, m = lighter(robot, 12.0), robot.n_cables
    half = (robot.tension_max - robot.tension_min) / 2

    def margin(pose, wrench):
        rows, sides = [np.column_stack([-np.eye(m), half]), np.column_stack([np.eye(m), half])], [-robot.tension_min,
                                                                                                robot.tension_max]
        idle, pulled = cl.tipping_moments(robot, pose, np.zeros(m)), cl.tipping_moments(robot, pose, np.eye(m))
        for base in pulled:
            share = np.full(idle[base].size, np.abs(idle[base]).mean())
            rows.append(np.column_stack([(pulled[base] - idle[base]).T, share]))
            sides.append(-idle[base])
        balance = np.column_stack([cl.wrench_matrix(robot, pose), np.zeros(robot.n_dof)])
        return linprog(-np.eye(m + 1)[-1], A_ub=np.concatenate(rows), b_ub=np.concatenate(sides), A_eq=balance,
                       b_eq=-wrench, bounds=[(None, None)] * m + [(None, 1.0)], method="highs").x[-1]

    found, tensions = worst_margin(robot, Duty(poses, np.broadcast_to(wrenches, (len(poses), *wrenches.shape)), True))
    assert found == pytest.approx(min(margin(pose, wrench) for pose in poses for wrench in wrenches), abs=1e-7)
    assert tensions.shape == (len(poses), 3, m)


# --- none: proven, or not found ------------------------------------------------------------------------------
def shaken(robot, rng):
    """The bases anywhere within some meters along the directions in which they may drive."""
    places = {}
    for base in robot.bases:
        turn, *along = rng.uniform([-np.pi, -4, -4], [np.pi, 4, 4]) * (base.speed_max > 0)
        places[base.name] = (*(base.position + base.rotation[:2, :2] @ along), base.heading + turn)
    return robot.with_bases(places)


def level(robot, speeds):
    """With these speed limits; in the plane upright, for a floor without grip holds nothing that leans."""
    return replace(robot, bases=tuple(
        replace(base, speed_max=speed, heading=base.heading if robot.dimension == 3 else 0.0)
        for base, speed in zip(robot.bases, speeds)))


@pytest.mark.parametrize("name", [*BASED, "planar_mcdpr", "mobile_four_bases", "fastkit_suspended"])
@pytest.mark.parametrize("standing", [True, False])
def test_no_placement_does_better_than_the_bound(name, standing):
    """Random loads on random bases, some directions held; the bound is below 1 for some, and the law not idle."""
    rng = np.random.default_rng(3)
    bounds, reached = [], []
    for seed in range(6):
        robot, pose = case(name, seed) if name in BASED else (cl.load_world(name).robot, cl.load_world(name).pose)
        free = rng.random((len(robot.bases), 3)) < 0.5
        if robot.dimension == 2:
            free[:, [0, 2]] &= rng.random() < 0.3
        robot = lighter(level(robot, 1.0 * free), rng.uniform(5, 60))
        load = cl.gravity_wrench(robot, pose)
        force = rng.normal(size=robot.dimension)[:robot.n_dof]
        load[:robot.dimension] += force / np.linalg.norm(force) * robot.tension_max.sum() * rng.uniform(0.05, 0.8)
        bounds.append(largest_share(robot, pose, load, standing))
        reached.append(max(share(shaken(robot, rng), pose, load, standing)[0] for _ in range(40)))
    assert np.all(np.array(reached) <= np.array(bounds) + 1e-7)
    assert min(bounds) < 0.99


def test_a_turning_base_at_the_point_of_tipping_is_within_its_bound():
    """Turned any way and pulled as hard as it stands; the bound knows heights and lengths, not the turn."""
    rng, spare = np.random.default_rng(7), []
    for seed in range(40):
        robot, pose = case("two bases", seed)
        robot = level(robot, np.ones((2, 3)))
        turned = robot.with_bases({base.name: (*base.position, rng.uniform(-np.pi, np.pi)) for base in robot.bases})
        pulls = rng.uniform(0, 1, 8) * (rng.random(8) < 0.5)
        directions = cl.cable_directions(turned, pose)
        for k, base in enumerate(robot.bases):
            idle, pulled = (cl.tipping_moments(turned, pose, tau)[base.name] for tau in (0 * pulls, pulls))
            lifting = pulled > idle
            if lifting.any():
                hardest = (-idle / (pulled - idle))[lifting].min()
                rows, sides = standing_rows(robot, k, cl.cable_vectors(robot, pose)[:, -1])
                spare.append((1 - np.einsum("eid,id->e", rows, hardest * pulls[:, None] * directions) / sides).min())
    assert min(spare) > 0 and len(spare) > 50


def test_the_bound_of_a_turning_base_is_reached_over_a_corner():
    """Exit point and center of mass behind, the pull straight over the corner in front: none of the bound to spare."""
    corner = np.array([np.cos(np.pi / 8), np.sin(np.pi / 8)])     # one of the directions the bound looks along
    across = np.array([-corner[1], corner[0]])
    feet = 0.6 * np.array([corner, across, -corner, -across])
    behind = np.append(-0.3 * corner, 2.0)
    base = Base("turning", [1.0, 2.0], 0.0, 40.0, np.append(-0.1 * corner, 0.5), feet, np.ones(3))
    robot = build("3T", [behind, [0, 0, 3]], [[0, 0, 0]] * 2, bases=(base,), carriers=["turning", None])
    pose = cl.Pose(base.to_world(behind) + np.append(1.5 * corner, -1.2))
    idle, pulled = (cl.tipping_moments(robot, pose, [pull, 0.0])["turning"] for pull in (0.0, 1.0))
    hardest = (-idle / (pulled - idle))[pulled > idle].min()
    rows, sides = standing_rows(robot, 0, cl.cable_vectors(robot, pose)[:, -1])
    pulls = hardest * np.array([[1.0], [0.0]]) * cl.cable_directions(robot, pose)
    assert (1 - np.einsum("eid,id->e", rows, pulls) / sides).min() == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize("standing", [True, False])
@pytest.mark.parametrize("name", [*BASED, "planar_mcdpr", "mobile_four_bases", "fastkit_suspended"])
def test_with_bases_held_the_bound_is_reached(name, standing):
    """Nothing can drive: cables, footprints and floor allow exactly the share that the bound says."""
    robot, pose = case(name, 1) if name in BASED else (cl.load_world(name).robot, cl.load_world(name).pose)
    held = lighter(level(robot, np.zeros((len(robot.bases), 3))), 25.0)
    rng = np.random.default_rng(5)
    for _ in range(5):
        load = cl.gravity_wrench(robot, pose) + rng.normal(size=robot.n_dof) * robot.tension_max.max() / 4
        exact = share(held, pose, load, standing)[0]
        assert largest_share(held, pose, load, standing) == pytest.approx(exact, abs=1e-7)


def test_a_pose_above_all_exits_is_impossible_and_said_so():
    world = cl.load_world("planar_mcdpr")
    weight = cl.gravity_wrench(world.robot, world.pose)
    with pytest.raises(NoPlacement, match=r"no base poses can serve .*pose 2 of 2 .*needs 19\.62 N upwards; 0 of 4"):
        place_bases(world.robot, cl.Pose([[1.0, 1.0], [1.0, 2.4]]), weight)
    rising = replace(world.robot, bases=tuple(replace(base, speed_max=[0, 0.8, 0.8]) for base in world.robot.bases))
    assert largest_share(rising, cl.Pose([1.0, 2.4]), weight, False) == pytest.approx(1.0)


def test_more_than_all_cables_together_pull_is_impossible_and_said_so():
    """400 N to one side take all four cables of 100 N level and leave nothing for the weight."""
    world = cl.load_world("planar_mcdpr")
    with pytest.raises(NoPlacement, match=r"can serve .*pose 1 of 1 .*-400\.0, -19\.62\]: wherever .*"
                                          r"limits allow at most 99\.\d+ %"):
        place_bases(world.robot, cl.Pose([1.0, 1.6]), [[-400.0, -19.62]])


def test_a_held_direction_that_stands_in_the_way_is_named():
    """250 N to the left are for three cables; the right base, held where it is, has two that pull to the right."""
    world = cl.load_world("planar_mcdpr")
    held = replace(world.robot.bases[1], speed_max=np.zeros(3))
    robot = replace(world.robot, bases=(world.robot.bases[0], held))
    load = [250.0, -19.62]
    assert serves(place_bases(world.robot, world.pose, load, tipping=False), [world.pose], load, False)
    with pytest.raises(NoPlacement, match=r"can serve .*while right may not drive .*limits allow at most 7\d"):
        place_bases(robot, world.pose, load, tipping=False)


def test_a_push_that_overturns_bases_wherever_they_stand_is_impossible_and_said_so():
    robot, load = lighter(cl.load_world("planar_mcdpr").robot, 5.0), [250.0, -19.62]
    pose = cl.Pose([1.0, 1.6])
    assert serves(place_bases(robot, pose, load, tipping=False), [pose], load, False)
    with pytest.raises(NoPlacement, match=r"can serve .*would allow it, but with every base standing.* at most "):
        place_bases(robot, pose, load)


def test_two_cables_on_a_line_pull_to_one_side_together_at_most():
    """1T: bases may both stand to the left, 100 N each; 300 N are half as much again."""
    bases = tuple(Base(name, [x, 0.0], 0.0, 30.0, [0.0, 0.4], [[0.3, 0.0], [-0.3, 0.0]], [0.0, 1.0, 0.0])
                  for name, x in (("a", -2.0), ("b", 2.0)))
    robot = build("1T", [[0, 1.0], [0, 1.2]], [[0, 0]] * 2, limits=(1, 100), bases=bases, carriers=["a", "b"])
    with pytest.raises(NoPlacement, match=r"can serve .*limits allow at most 66\.67 %"):
        place_bases(robot, cl.Pose([4.0, 1.0]), [300.0])
    assert serves(place_bases(robot, cl.Pose([4.0, 1.0]), [50.0]), [cl.Pose([4.0, 1.0])], [50.0])


def test_a_base_that_drives_but_carries_nothing_changes_nothing():
    world = cl.load_world("planar_mcdpr")
    held = [replace(base, speed_max=np.zeros(3)) for base in world.robot.bases]
    idle = replace(held[0], name="idle", position=[6.0, 0.0], speed_max=[0.0, 1.0, 0.0])
    robot = replace(world.robot, bases=(*held, idle))
    load = np.array([150.0, -100.0])
    with pytest.raises(NoPlacement, match=r"while left and right may not drive .*at most ") as caught:
        place_bases(robot, world.pose, load, tipping=False)
    told = float(str(caught.value).split("at most ")[1].split(" %")[0])
    assert told == pytest.approx(100 * share(robot, world.pose, load, standing=False)[0], rel=1e-3)


def test_a_search_that_ends_says_so_and_which_cable_is_short():
    robot, poses, wrenches = wanted("fastkit_suspended", [[-1.0, 0.0, 1.8], [1.0, 0.0, 1.8]])
    with pytest.raises(NoPlacement, match=r"none among \d+ placements tried \(a search, no proof\): .*pose \d of 2 .*"
                                          r"cable \d would need .* N, allowed 1 to 45 N") as caught:
        place_bases(robot, poses, wrenches, evaluations=40)
    assert isinstance(caught.value.robot, cl.Robot)
    assert 40 <= int(str(caught.value).split("none among ")[1].split()[0]) < 60    # a round begun is ended


def test_a_search_that_ends_for_want_of_standing_names_the_base():
    """40 kg instead of 80; the cables could."""
    robot, poses, wrenches = wanted("fastkit_suspended", [[-1.0, 0.0, 1.5], [1.0, 0.0, 1.5]])
    with pytest.raises(NoPlacement, match=r"none among .*cables could within their limits, but base '\w+' tips, a "
                                          r"moment of [\d.]+ N m too much .*tipping=False") as caught:
        place_bases(lighter(robot, 40.0), poses, wrenches[:1], evaluations=60)
    assert not serves(caught.value.robot, poses, wrenches[:1])


def test_a_search_that_ends_short_of_the_margin_says_how_much():
    robot, poses, wrenches = wanted("planar_mcdpr", [[2.6, 1.2], [3.2, 1.4]])
    with pytest.raises(NoPlacement, match=r"none among .*margin 0\.\d+ instead of 0\.9"):
        place_bases(robot, poses, wrenches, margin=0.9, evaluations=30)


def test_a_platform_that_fills_the_floor_leaves_no_place_to_stand():
    world = cl.load_world("planar_mcdpr")
    held = (replace(world.robot.bases[0], position=[1.0, 0.0], speed_max=np.zeros(3)), world.robot.bases[1])
    with pytest.raises(NoPlacement, match="bases would stand in each other or masts in the platform"):
        place_bases(replace(world.robot, bases=held), world.pose, [0.0, -19.62], evaluations=20)


def test_requests_that_cannot_be_meant_are_named():
    world = cl.load_world("planar_mcdpr")
    weight = cl.gravity_wrench(world.robot, world.pose)
    with pytest.raises(InvalidInput, match="no bases"):
        place_bases(cl.load_world("planar_point").robot, world.pose, weight)
    held = replace(world.robot, bases=tuple(replace(base, speed_max=np.zeros(3)) for base in world.robot.bases))
    with pytest.raises(InvalidInput, match="no base that can drive"):
        place_bases(held, world.pose, weight)
    with pytest.raises(InvalidInput, match="lives in 2 dimensions"):
        place_bases(world.robot, cl.Pose([0, 0, 1]), weight)
    with pytest.raises(InvalidInput, match=r"wrenches must be \(2,\), \(k, 2\)"):
        place_bases(world.robot, world.pose, np.zeros((3, 2, 2)))
    with pytest.raises(InvalidInput, match="between 0 and 1"):
        place_bases(world.robot, world.pose, weight, margin=2)
    for count in (0, 2.5, True):
        with pytest.raises(InvalidInput, match="evaluations must be a whole number"):
            place_bases(world.robot, world.pose, weight, evaluations=count)
