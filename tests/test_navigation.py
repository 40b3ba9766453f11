"""Laws of navigation: scans by geometry, grids never too generous, plans against another search, 20 halls driven."""

import numpy as np
import pytest
from practice_halls import practice_hall
from scipy.ndimage import label

import cdprlab as cl
from cdprlab.errors import InvalidInput
from cdprlab.fastkit import (
    ARRIVED,
    Follower,
    Hall,
    KinematicPair,
    Localization,
    OccupancyGrid,
    Odometry,
    Plan,
    Scanner,
    Vehicle,
    Walker,
    carried,
    cast,
    difference,
    inflated_width,
    navigate,
    plan_path,
)
from cdprlab.fastkit.navigation.driving import clearance
from cdprlab.fastkit.navigation.journey import with_berth
from cdprlab.fastkit.navigation.planner import MARGIN, between
from cdprlab.fastkit.plane import moved, placed, rectangle, rectangle_distance, relative, step_between


@pytest.fixture(scope="module")
def pair():
    """FASTKIT's bases coupled; every third degree a beam, which is plenty."""
    return Vehicle.of(cl.load_world("fastkit_suspended").robot, beams=91)


@pytest.fixture(scope="module")
def hall():
    return practice_hall(Vehicle.of(cl.load_world("fastkit_suspended").robot), seed=5).hall


# --- geometry ---------------------------------------------------------------------------------------------
def test_distance_of_rectangles_is_that_of_their_points():
    random = np.random.default_rng(1)
    for _ in range(200):
        rows = random.uniform([-1, -1, 0.2, 0.2, 0], [1, 1, 1.5, 1.5, 3], size=(2, 5))
        poses, sizes = rows[:, [0, 1, 4]], rows[:, 2:4]
        a, b = rectangle(poses, sizes)
        u, v = np.linspace(0, 1, 12), np.linspace(0, 1, 12)
        grid = np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2)
        pa, pb = (q[0] + grid @ np.stack([q[1] - q[0], q[3] - q[0]]) for q in (a, b))
        near = np.linalg.norm(pa[:, None] - pb[None], axis=-1).min()
        spacing = 1.5 * np.sqrt(2) / 11       # of the points sampled
        exact = rectangle_distance(poses[0], sizes[0], poses[1], sizes[1])
        assert near - spacing <= exact <= near + 1e-12
        np.testing.assert_allclose(rectangle_distance(poses[1], sizes[1], poses[0], sizes[0]), exact, atol=1e-12)
    # Whichever of the two has the other inside.
    inside, around = ([0.5, 0.2, 0.3], [1, 1]), ([0, 0, 0], [9, 9])
    assert rectangle_distance(*inside, *around) == rectangle_distance(*around, *inside) == 0


def test_a_pose_seen_from_another_and_put_back_is_the_same():
    random = np.random.default_rng(7)
    for frame, pose in random.uniform(-3, 3, size=(50, 2, 3)):
        back = placed(frame, relative(pose, frame))
        np.testing.assert_allclose(difference(back, pose), 0, atol=1e-12)
        np.testing.assert_allclose(difference(moved(frame, step_between(frame, pose)), pose), 0, atol=1e-12)


def test_beams_end_where_points_of_the_hall_are(hall):
    scanner = Scanner(0.3, -0.2, 0.5, noise=0.0)
    pose = np.array([5.0, 4.0, 1.0])
    origin, directions = scanner.beams_from(pose)
    far = cast(origin, directions, hall.segments)
    assert np.isfinite(far).all()                                 # four walls all around
    np.testing.assert_allclose(hall.distance(origin + far[:, None] * directions), 0, atol=1e-9)
    for share in (0.2, 0.5, 0.9, 0.99):                           # and nothing stands on the way there
        assert (hall.distance(origin + share * far[:, None] * directions) > 0).all()


def test_scans_are_within_range_and_their_points_in_the_vehicle(hall):
    scanner = Scanner(0.3, -0.2, 0.5, noise=0.0)
    pose = np.array([5.0, 4.0, 1.0])
    origin, directions = scanner.beams_from(pose)
    seen = scanner.measured(cast(origin, directions, hall.segments), np.random.default_rng(0))
    points = scanner.points(seen)
    assert len(points) == np.isfinite(seen).sum() > 20 and seen[np.isfinite(seen)].max() < 3.0
    np.testing.assert_allclose(hall.distance(carried(pose, points)), 0, atol=1e-9)


def test_two_scanners_look_all_around_the_pair(pair):
    """Whatever stands 10 cm from the pair is seen by one of them."""
    rim = rectangle([0, 0, 0], pair.size + 0.2)
    for a, b in zip(rim, np.roll(rim, -1, axis=0)):
        for share in np.linspace(0, 1, 25):
            x, y = a + share * (b - a)
            ends = [cast(*scanner.beams_from([0, 0, 0]), np.zeros((0, 2, 2)), [[x, y, 0.08]]).min()
                    for scanner in pair.scanners]
            assert min(ends) < 3.0


def test_scanner_noise_has_its_deviation_and_its_seed():
    scanner, far = Scanner(noise=0.02), np.full(271, 1.5)
    draws = np.array([scanner.measured(far, np.random.default_rng(k)) for k in range(40)])
    assert draws.std() == pytest.approx(0.02, rel=0.05)           # 10840 draws: 0.7 % expected
    np.testing.assert_array_equal(draws[3], scanner.measured(far, np.random.default_rng(3)))


# --- the vehicle ------------------------------------------------------------------------------------------
def test_base_speeds_move_the_pair_as_its_twist_says(pair):
    pose, twist, dt = np.array([1.0, 2.0, 0.7]), np.array([0.1, -0.05, 0.08]), 1e-5
    after = moved(pose, twist, dt)
    before_base, after_base = pair.bases(pose)[0], pair.bases(after)[0]
    rates = step_between(before_base, after_base) / dt
    np.testing.assert_allclose(rates[[2, 0, 1]], pair.base_speeds(twist), atol=1e-6)
    np.testing.assert_allclose(pair.pose_of(before_base), pose, atol=1e-15)
    slowed = pair.within_limits([1.0, 1.0, 1.0])
    assert (np.abs(pair.base_speeds(slowed)) <= pair.speed_max + 1e-12).all()


def test_discs_leave_no_corner_of_the_pair_out(pair):
    sides = np.linspace(0, 1, 200)[:, None]
    rim = np.concatenate([a + sides * (b - a) for a, b in zip(pair.outline([0, 0, 0]),
                                                             np.roll(pair.outline([0, 0, 0]), -1, axis=0))])
    assert np.linalg.norm(rim[:, None] - pair.discs, axis=-1).min(axis=1).max() <= pair.radius + 1e-12


# --- grid and plan ----------------------------------------------------------------------------------------
def test_clearance_is_never_more_than_there_is_nor_much_less(hall):
    grid = OccupancyGrid.of(hall)
    points = np.random.default_rng(2).uniform(*hall.bounds, size=(5000, 2))
    low, high = hall.bounds
    true = np.minimum(hall.distance(points), np.minimum(points - low, high - points).min(axis=1))
    kept = grid.clearance_at(points)
    assert (kept <= true + 1e-12).all() and (kept >= true - grid.slack - 1e-12).all()


def test_plans_keep_clear_and_where_there_is_none_another_search_finds_none_either(pair):
    found = []
    for seed in range(8):
        place = practice_hall(pair, seed, pallets=30)
        grid = OccupancyGrid.of(place.hall)
        plan = plan_path(grid, pair, place.start, place.goal)
        found.append(plan.found)
        if plan.found:
            way = np.concatenate([between(a, b, 0.02, 0.01) for a, b in zip(plan.poses, plan.poses[1:])])
            # Poses are looked at every 4 cm and 0.03 rad: what lies between them is within 5 cm of one.
            assert min(clearance(pair, pose, place.hall) for pose in way[::5]) >= MARGIN - 0.05
            np.testing.assert_array_equal(plan.poses[[0, -1]], [place.start, place.goal])
        else:
            assert plan.reason and not flooded(pair, place, inflated_width(grid, pair))
    assert 2 <= sum(found) <= 6                                   # both happen, or the test shows nothing


def flooded(pair, place, width):
    """Whether flooding all free poses from the start reaches the goal: exact distances, no grid, no graph.

    A pose is free if the rectangle, made wider until it has this width, meets no point of the hall's outlines.
    """
    grown, step = (width - pair.width) / 2 + 0.1, 0.2              # between poses 0.2 m apart up to 0.1 m are lost
    low, high = place.hall.bounds
    rims = place.hall.outlines
    points = np.concatenate([a + np.arange(0, 1, 0.08 / np.linalg.norm(b - a))[:, None] * (b - a)
                             for rim in rims for a, b in zip(rim, np.roll(rim, -1, axis=0))]).astype(np.float32)
    points = points[((points >= low - 0.01) & (points <= high + 0.01)).all(axis=1)]
    xs, ys = (np.arange(low[i] + 0.05, high[i], step) for i in (0, 1))
    headings = np.arange(32) * 2 * np.pi / 64                      # a rectangle turned round is the same
    half = np.array([pair.length, pair.width]) / 2 + grown
    free = np.ones((32, len(xs), len(ys)), dtype=bool)
    for i, x in enumerate(xs):
        for j, y in enumerate(ys):
            off = points - np.array([x, y], dtype=np.float32)
            off = off[np.linalg.norm(off, axis=1) < np.linalg.norm(half)]
            along, across = (off @ np.array([np.cos(headings + q), np.sin(headings + q)]) for q in (0.0, np.pi / 2))
            free[:, i, j] = ~((np.abs(along) <= half[0]) & (np.abs(across) <= half[1])).any(axis=0)
    parts = label(np.tile(free, (3, 1, 1)))[0]                     # three half turns, so that none is cut

    def part(pose):
        h = round(pose[2] % np.pi / (2 * np.pi / 64)) + 32
        return parts[h, int(np.abs(xs - pose[0]).argmin()), int(np.abs(ys - pose[1]).argmin())]

    return part(place.start) == part(place.goal) != 0


def test_a_goal_without_room_and_a_goal_behind_a_wall_are_named(pair):
    hall = Hall.of([[0, 0, 0.2, 6, 0]], [[-5, -3], [5, 3]])
    grid = OccupancyGrid.of(hall)
    assert "no way of 1.50 m" in plan_path(grid, pair, [-2.5, 0, 0], [2.5, 0, 0]).reason
    assert "the goal is not free" in plan_path(grid, pair, [-2.5, 0, 0], [1.5, 0, 0]).reason
    with pytest.raises(InvalidInput, match="goal"):
        plan_path(grid, pair, [-2.5, 0, 0], [2.5, 0])
    with pytest.raises(InvalidInput, match="radians"):
        plan_path(grid, pair, [-2.5, 0, 180], [2.5, 0, 0])


# --- localization -----------------------------------------------------------------------------------------
def test_localization_finds_the_pose_a_scan_was_taken_from(pair, hall):
    place = practice_hall(pair, seed=5)
    for k in range(10):
        truth = place.goal + np.random.default_rng(k).uniform(-1, 0.0, 3) * [0.3, 0.3, 0.1]
        told = truth + np.random.default_rng(k + 50).uniform(-1, 1, 3) * [0.1, 0.1, 0.05]
        where = Localization(hall, told, eyes=[(s.x, s.y) for s in pair.scanners])
        for scan in range(8):
            where.look(KinematicPair(pair, hall, truth, seed=100 * k + scan).scan())
        off = np.abs(difference(where.pose, truth))
        assert np.hypot(off[0], off[1]) <= 0.02 and off[2] <= np.radians(0.5)


def test_where_nothing_is_in_sight_the_filter_gets_unsure(pair):
    empty = Hall.of(np.zeros((0, 5)), [[-50, -50], [50, 50]])
    where, sure = Localization(empty, [0, 0, 0], (0.01, 0.01, 0.01)), []
    for _ in range(50):
        where.drive([0.1, 0, 0])
        where.look(np.zeros((0, 2)))
        sure.append(where.deviation)
    assert (np.diff(sure, axis=0) >= 0).all()
    np.testing.assert_allclose(where.pose, [5.0, 0, 0], atol=1e-12)
    # Sideways, 0.01 rad at the begin is 5 cm after 5 m, and the heading wanders on the way.
    assert where.deviation[1] > 0.05


def test_odometry_is_as_wrong_as_it_says():
    where = Localization(Hall.of(np.zeros((0, 5)), [[-9, -9], [9, 9]]), [0, 0, 0], (1e-6, 1e-6, 1e-6))
    step, ends = np.array([0.05, 0.01, 0.02]), []
    for seed in range(400):
        random, pose = np.random.default_rng(seed), np.zeros(3)
        for _ in range(30):
            d = where.odometry.measured(step, random)
            pose = moved(pose, d, 1.0)
        ends.append(pose)
    for _ in range(30):
        where.drive(step)
    np.testing.assert_allclose(np.std(ends, axis=0), where.deviation, rtol=0.15)   # 400 draws: 3.5 %, and it is bent


def test_what_is_not_on_the_map_is_noticed(pair, hall):
    place = practice_hall(pair, seed=5)
    person = Walker([place.start[:2] + [0.0, 1.5]] * 2, radius=0.25)
    driver = KinematicPair(pair, hall, place.start, (person,))
    where = Localization(hall, place.start, (0.01, 0.01, 0.01))
    points = carried(place.start, where.unexpected(driver.scan()))
    assert len(points) and np.linalg.norm(points - person.place, axis=1).max() < 0.3
    assert not len(where.unexpected(KinematicPair(pair, hall, place.start).scan()))


# --- following and the whole journey ----------------------------------------------------------------------
def test_the_follower_keeps_speed_limits_and_ends_at_the_goal(pair):
    follower, pose = Follower(pair, [[0, 0, 0], [1, 0.5, 0.3], [1.5, 0.5, -0.4]]), np.zeros(3)
    for _ in range(400):
        twist = follower.command(pose, np.zeros((0, 2)), 0.1)
        assert (np.abs(pair.base_speeds(twist)) <= pair.speed_max + 1e-9).all()
        pose = moved(pose, twist, 0.1)
        if follower.arrived(pose):
            break
    np.testing.assert_allclose(pose, [1.5, 0.5, -0.4], atol=5e-3)


def test_the_follower_never_drives_into_what_it_sees(pair):
    """Points anywhere around: whatever it commands, none within the stop distance comes nearer."""
    random = np.random.default_rng(4)
    for _ in range(100):
        points = random.uniform(-3, 3, size=(3, 2))
        follower = Follower(pair, [[0, 0, 0], random.uniform(-1, 1, 3)])
        for _ in range(5):
            twist = follower.command(np.zeros(3), points, 0.1)
        before, after = (pair.distances(pose, points) for pose in (np.zeros(3), moved(np.zeros(3), twist, 0.1)))
        assert ((after >= before - 1e-4) | (after >= 0.3)).all()


def drive(pair, place, seed, **options):
    told = place.start + np.random.default_rng(seed).standard_normal(3) * [0.05, 0.05, 0.03]
    driver = KinematicPair(pair, options.pop("truly", place.hall), place.start, place.walkers, seed=seed)
    return navigate(driver, place.hall, told, place.goal, **{"period": 0.2, **options})


@pytest.fixture(scope="module")
def journeys(pair):
    """At 0.2 s, for half the price; the test below takes some at the default, hall 3, whose only passage the person
    walks in, among them."""
    return [drive(pair, practice_hall(pair, seed), seed) for seed in range(20)]


def test_twenty_halls_goal_reached_without_contact_or_no_way(pair, journeys):
    often = [drive(pair, practice_hall(pair, seed), seed, period=0.1) for seed in (3, 8, 13, 18)]
    assert all(journey.state == ARRIVED and journey.clearance.min() > 0.05 for journey in often)
    reached = [journey.state == ARRIVED for journey in journeys]
    assert sum(reached) >= 18
    for seed, journey in enumerate(journeys):
        assert journey.clearance.min() > 0.05, seed
        if not reached[seed]:
            place = practice_hall(pair, seed)
            width = inflated_width(OccupancyGrid.of(place.hall), pair)
            assert journey.reason and not flooded(pair, place, width), seed


def test_at_the_shelf_the_pair_knows_where_it_is(journeys):
    for journey in journeys:
        if journey.state == ARRIVED:
            off, end = journey.errors[-1], difference(journey.goal, journey.poses[-1])
            assert np.linalg.norm(off[:2]) <= 0.05 and abs(off[2]) <= np.radians(2)
            assert np.linalg.norm(end[:2]) <= 0.05 and abs(end[2]) <= np.radians(2)
            # Errors are as large as the filter says: within five deviations, but at the begin told ones.
            assert (np.abs(journey.errors[1:]) <= 5 * journey.deviations[1:]).all()


@pytest.mark.parametrize("period", [0.1, 0.2])
def test_somebody_who_stays_in_the_only_door_ends_the_journey_safely(pair, period):
    """A person in the door wants out, the pair in, and neither ever steps back."""
    mouth = Hall.of([[0, 2.5, 0.2, 3.2, 0], [0, -2.5, 0.2, 3.2, 0]], [[-5, -4], [5, 4]])     # a door of 1.8 m
    stubborn = Walker([[0.5, 0.0], [-0.5, 1.6]], patience=np.inf)
    driver = KinematicPair(pair, mouth, [-3, 0, 0], (stubborn,), seed=1)
    journey = navigate(driver, mouth, [-3, 0, 0], [3, 0, 0], period=period)
    assert "not on the map" in journey.reason and journey.waiting.any() and journey.clearance.min() > 0.05


def test_a_cornered_person_steps_back_and_not_into_anything():
    wall = Hall.of([[-1.0, 0, 0.2, 4, 0]], [[-5, -4], [5, 4]])
    person = Walker([[-0.3, 0.0], [3.0, 0.0]], hall=wall)
    machine = [1.25, 0, 0], [2, 1]                                       # its front 30 cm before the person
    for _ in range(200):
        before = np.array(person.place)
        person.walk(0.1, *machine)
        assert np.linalg.norm(person.place - before) <= 0.6 * 0.1 + 1e-12
    assert person.place[0] < -0.35                                # it was care, 0.4 m, that was missing
    assert wall.distance(person.place) > person.radius
    free = np.array([0.25, 0.0]) - person.place
    assert np.linalg.norm(free) - person.radius >= 0.4 - 0.6 * 0.1


def test_somebody_walking_along_the_pair_walks_on():
    person = Walker([[-1.4, 0.99], [2.0, 0.99]])                  # 24 cm from its side: nearer than they would come
    for _ in range(60):
        person.walk(0.1, [0, 0, -0.001], [3, 1])
    assert person.place[0] > 1.0


def test_out_of_a_berth_the_first_way_is_straight(pair):
    hall = Hall.of([[0, 0.8, 4, 0.4, 0], [-2.2, 0, 0.4, 2, 0]], [[-4, -5], [6, 2]])
    berth, gate, home = np.array([0.0, 0.0, 0.0]), np.array([0.3, -0.6, 0.0]), np.array([3.0, -3.0, 1.0])
    journey = navigate(KinematicPair(pair, hall, berth, seed=2), hall, berth, home, leaving=gate, period=0.2,
                       uncertainty=(0.02, 0.02, 0.02))
    assert journey.state == ARRIVED and journey.clearance.min() > 0.05
    np.testing.assert_allclose(journey.plans[0][1].poses[:2], [journey.estimates[0], gate], atol=1e-12)
    # 10 cm are left where it stands, and nothing on the way to a gate in the shelf.
    plan = Plan(np.array([[0.0, 0.1, 0.0], home]))
    assert with_berth(hall, pair, plan, berth, leaving=True).reason.startswith("no room to leave: 0.00 m are left")


def test_people_made_it_wait(journeys):
    assert sum(journey.waiting.any() for journey in journeys) >= 2


def test_a_journey_repeated_is_identical(pair, journeys):
    again = drive(pair, practice_hall(pair, 9), 9)
    for name in ("time", "poses", "estimates", "clearance", "people"):
        np.testing.assert_array_equal(getattr(again, name), getattr(journeys[9], name))


def test_something_new_on_the_way_is_driven_around(pair, journeys):
    place = practice_hall(pair, 9, pallets=0)
    middle = journeys[9].poses[len(journeys[9].poses) // 2, :2]
    truly = place.hall.with_rectangles([[*middle, 0.5, 0.5, 0.3]])
    journey = drive(pair, place._replace(walkers=()), 9, truly=truly)
    assert journey.state == ARRIVED and len(journey.plans) > 1 and journey.clearance.min() > 0.05


def test_a_way_that_something_new_closes_ends_safely(pair):
    hall = Hall.of([[0, 1.5, 0.3, 3, 0], [0, -4.2, 0.3, 3, 0]], [[-8, -3], [5, 3]])
    start, goal = np.array([-6.0, -1.2, 0]), np.array([2.5, -1.2, 0])
    door = hall.with_rectangles([[0.2, -1.3, 0.3, 2.4, 0]])
    journey = navigate(KinematicPair(pair, door, start, seed=1), hall, start, goal)
    assert "not on the map" in journey.reason and journey.clearance.min() > 0.05
    assert np.ptp(journey.poses[-100:], axis=0).max() <= 2e-3        # it stands, but for 0.2 mm/s it may creep


def test_nothing_in_sight_is_lost_not_found(pair):
    hall = Hall.of([[9.5, 0, 1, 1, 0]], [[-10, -4], [10, 4]])      # its edges are painted: nothing to see
    slipping = Odometry(scale=1.0, per_meter=0.3)
    driver = KinematicPair(pair, hall, [-8, 0, 0], odometry=slipping)
    journey = navigate(driver, hall, [-8, 0, 0], [5, 0, 0])
    assert journey.reason.startswith("lost")
