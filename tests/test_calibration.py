"""Calibration: planted errors are found from lengths, as well as the covariance says; what is not told is named."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2
from test_pulleys import PULLEYED, poses_of

import cdprlab as cl
from cdprlab.errors import InvalidInput
from cdprlab.mechanics.calibration import length_slopes
from robots import ROBOTS, differences, random_poses

NOISE = 1e-4
EVERY = ["exit_points", "anchor_points", "length_offsets", "pulley_radius"]


def changed(robot, table):
    """The robot with the numbers of a table (m, 2 d + 2) added, but for the offsets in its last column but one."""
    d = robot.dimension
    return replace(robot, cables=tuple(
        replace(cable, exit_point=cable.exit_point + row[:d], anchor_point=cable.anchor_point + row[d:2 * d],
                pulley=cable.pulley and replace(cable.pulley, radius=cable.pulley.radius + row[-1]))
        for cable, row in zip(robot.cables, table)))


def planted(robot, rng, unknown, size=0.02):
    """Errors of ± size [m] in what is unknown, as a table."""
    d = robot.dimension
    table = rng.uniform(-size, size, (robot.n_cables, 2 * d + 2))
    for kind, columns in zip(EVERY, (slice(d), slice(d, 2 * d), -2, -1)):
        if kind not in unknown:
            table[:, columns] = 0.0
    if robot.motion_pattern == "2R3T":   # its anchor points stay on x'
        table[:, d + 1:2 * d] = 0.0
    return table


def read(robot, table, poses, rng, noise=NOISE):
    """What the winches of the robot with these errors say."""
    return cl.cable_lengths(changed(robot, table), poses) + table[:, -2] + rng.normal(0, noise,
                                                                                     (len(poses), robot.n_cables))


def some_poses(robot, count, seed=0):
    """Random ones, not turned where all cables meet at P."""
    poses = random_poses(robot, count, seed)
    return poses if robot.pattern.turns else cl.Pose(poses.position)


@pytest.mark.parametrize("name", ROBOTS)
@pytest.mark.parametrize("pulleys", [False, True])
def test_slopes_are_finite_differences(name, pulleys):
    robot = PULLEYED[name] if pulleys else ROBOTS[name]()
    if not robot.pattern.turns or robot.motion_pattern == "2R3T":   # whose anchor points must not move
        robot = replace(robot, pattern=ROBOTS["1R2T" if robot.dimension == 2 else "3R3T"]().pattern)
    poses, m = poses_of(robot, 3, 5), robot.n_cables

    def lengths(x):
        table = x.reshape(m, -1)
        return cl.cable_lengths(changed(robot, table), poses) + table[:, -2]

    expected = differences(lengths, m * (2 * robot.dimension + 2), 1e-6)
    np.testing.assert_allclose(length_slopes(robot, poses), expected, atol=1e-8)


@pytest.mark.parametrize("name", ROBOTS)
def test_exits_planted_20_mm_off_are_recovered_from_random_poses(name):
    robot, rng = ROBOTS[name](), np.random.default_rng(3)
    poses, table = some_poses(robot, 40), planted(robot, rng, ["exit_points"])
    found = cl.calibrate(robot, poses, read(robot, table, poses, rng), unknown=["exit_points"])
    off = found.robot.exit_points - changed(robot, table).exit_points
    assert np.linalg.norm(off, axis=1).max() < 2e-3 and found.undetermined == ()
    # 40 poses and two or three unknowns a cable: what is left is the noise.
    assert found.residual.std() == pytest.approx(NOISE, rel=0.2)


@pytest.mark.parametrize("world", ["caroca", "marionet", "planar_rigid", "fastkit_planar"])
def test_exits_with_offsets_are_recovered_from_poses_that_tell(world):
    world = cl.load_world(world)
    robot, rng = world.robot, np.random.default_rng(4)
    poses, table = cl.calibration_poses(world, 40), planted(robot, rng, ["exit_points", "length_offsets"])
    found = cl.calibrate(robot, poses, read(robot, table, poses, rng))
    assert np.linalg.norm(found.robot.exit_points - changed(robot, table).exit_points, axis=1).max() < 2e-3
    np.testing.assert_allclose(found.length_offsets, table[:, -2], atol=2e-3)


def test_a_calibrated_robot_knows_its_encoders():
    world = cl.load_world("caroca")
    real = cl.perturbed(world, exit_points=0.01, lengths=0.005, seed=3)
    poses = random_poses(world.robot, 40, 0)
    read_there = cl.cable_lengths(real.robot, poses) + real.robot.length_offsets
    found = cl.calibrate(world.robot, poses, read_there)
    np.testing.assert_allclose(found.robot.length_offsets, real.errors["lengths"], atol=1e-9)
    # Offsets that are believed in stay where they are no unknowns.
    known = replace(world.robot, cables=tuple(replace(cable, length_offset=cable_there.length_offset)
                                              for cable, cable_there in zip(world.robot.cables, real.robot.cables)))
    again = cl.calibrate(known, poses, read_there, ["exit_points"])
    np.testing.assert_allclose(again.robot.exit_points, real.robot.exit_points, atol=1e-9)
    np.testing.assert_array_equal(again.length_offsets, real.robot.length_offsets)


@pytest.mark.parametrize("name", ROBOTS)
def test_without_noise_everything_is_exact(name):
    robot, rng = ROBOTS[name](), np.random.default_rng(6)
    unknown = EVERY[:3] if robot.pattern.turns else ["exit_points", "length_offsets"]
    poses, table = some_poses(robot, 60, 1), planted(robot, rng, unknown)
    found = cl.calibrate(robot, poses, read(robot, table, poses, rng, 0.0), unknown, length_noise=1e-7)
    np.testing.assert_allclose(found.residual, 0.0, atol=1e-9)
    if not found.undetermined:   # a cable that is always nearly parallel to itself keeps what cannot be told
        np.testing.assert_allclose(found.robot.exit_points, changed(robot, table).exit_points, atol=1e-7)
        np.testing.assert_allclose(found.robot.anchor_points, changed(robot, table).anchor_points, atol=1e-7)
        np.testing.assert_allclose(found.length_offsets, table[:, -2], atol=1e-7)
    assert not found.undetermined or name == "1T"


@pytest.mark.parametrize("name", ["2T", "1R2T", "3R3T", "two bases"])
def test_radii_of_pulleys_are_found(name):
    robot, rng = PULLEYED[name], np.random.default_rng(9)
    poses, table = poses_of(robot, 40, 3), planted(robot, rng, ["pulley_radius", "length_offsets"], 0.01)
    found = cl.calibrate(robot, poses, read(robot, table, poses, rng), ["pulley_radius", "length_offsets"])
    wheels = [i for i, cable in enumerate(robot.cables) if cable.pulley]
    assert list(found.estimates)[:len(wheels)] == [f"pulley_radius {i + 1}" for i in wheels]
    off = np.array(list(found.estimates.values())) - [
        *(changed(robot, table).cables[i].pulley.radius for i in wheels), *table[:, -2]]
    assert (np.abs(off) < 4 * np.sqrt(found.covariance.diagonal())).all() and np.abs(off).max() < 3e-3
    assert found.robot.cables[wheels[0]].pulley.radius == found.estimates[f"pulley_radius {wheels[0] + 1}"]


def coverage(trials):
    """Shares of trials, and of cables in them, whose 95 % ellipsoid holds the truth."""
    robot, whole, single = ROBOTS["3R3T"](), [], []
    for seed in range(trials):
        rng = np.random.default_rng(seed)
        poses, table = random_poses(robot, 40, seed), planted(robot, rng, ["exit_points"])
        found = cl.calibrate(robot, poses, read(robot, table, poses, rng), ["exit_points"])
        off = np.array(list(found.estimates.values())) - changed(robot, table).exit_points.ravel()
        whole.append(off @ np.linalg.solve(found.covariance, off) < chi2.ppf(0.95, off.size))
        for k in range(0, off.size, 3):
            block = found.covariance[k:k + 3, k:k + 3]
            single.append(off[k:k + 3] @ np.linalg.solve(block, off[k:k + 3]) < chi2.ppf(0.95, 3))
    return np.mean(whole), np.mean(single)


def test_the_covariance_says_how_far_off():
    assert 0.90 <= coverage(25)[1] <= 0.99   # 200 ellipsoids, one a cable


@pytest.mark.long
def test_the_covariance_says_how_far_off_in_200_trials():
    assert all(0.90 <= share <= 0.99 for share in coverage(200))


def test_a_platform_that_never_turns_cannot_tell_exits_from_anchors():
    robot, rng = ROBOTS["3R3T"](), np.random.default_rng(7)
    poses = cl.Pose(random_poses(robot, 40, 0).position)
    table = planted(robot, rng, ["exit_points", "anchor_points"])
    found = cl.calibrate(robot, poses, read(robot, table, poses, rng), ["exit_points", "anchor_points"])
    assert len(found.undetermined) == 3 * robot.n_cables
    assert all("exit_points" in told and "anchor_points" in told for told in found.undetermined)
    # What can be told is: where exits are as seen from anchors. The rest stays as believed.
    moved_exits = found.robot.exit_points - robot.exit_points
    moved_anchors = found.robot.anchor_points - robot.anchor_points
    np.testing.assert_allclose(moved_exits - moved_anchors, table[:, :3] - table[:, 3:6], atol=2e-3)
    np.testing.assert_allclose(moved_exits + moved_anchors, 0.0, atol=1e-9)


@pytest.mark.parametrize("name", ["1R2T", "3R3T", "two bases"])
def test_mass_and_center_of_mass_from_tensions_at_rest(name):
    robot, rng = ROBOTS[name](), np.random.default_rng(8)
    poses = random_poses(robot, 40, 2)
    body = replace(robot.platform, mass=1.1 * robot.mass, center_of_mass=robot.platform.center_of_mass + 0.03)
    real = replace(robot, platform=body)
    W = cl.wrench_matrix(real, poses)
    tau = -(np.linalg.pinv(W) @ cl.gravity_wrench(real, poses)[..., None])[..., 0] + rng.normal(0, 0.5, W.shape[::2])
    lengths = cl.cable_lengths(robot, poses)
    found = cl.calibrate(robot, poses, lengths, ["length_offsets", "mass", "center_of_mass"], tau)
    deviations = np.sqrt(found.covariance.diagonal())[robot.n_cables:]
    off = np.array([found.robot.mass, *found.robot.platform.center_of_mass]) - [body.mass, *body.center_of_mass]
    assert (np.abs(off) < 4 * deviations).all() and deviations[0] < 0.05 * body.mass
    assert list(found.estimates)[robot.n_cables:][0] == "mass"
    # Asked for by the tensions alone, they come last.
    assert list(cl.calibrate(robot, poses, lengths, ["length_offsets"], tau).estimates) == list(found.estimates)
    # Each alone, the other as it is.
    alone = cl.calibrate(real, poses, lengths, ["mass"], tau)
    assert alone.robot.mass == pytest.approx(body.mass, abs=4 * np.sqrt(alone.covariance[0, 0]))
    level = cl.Pose(poses.position)
    W = cl.wrench_matrix(real, level)
    tau = -(np.linalg.pinv(W) @ cl.gravity_wrench(real, level)[..., None])[..., 0] + rng.normal(0, 0.1, W.shape[::2])
    still = cl.calibrate(robot, level, cl.cable_lengths(robot, level), ["center_of_mass"], tau)
    up = "y" if robot.dimension == 2 else "z"
    assert any(f"center_of_mass {up}" in told for told in still.undetermined)
    assert still.robot.platform.center_of_mass[-1] == pytest.approx(robot.platform.center_of_mass[-1], abs=1e-9)


@pytest.mark.parametrize(("options", "message"), [
    ({"unknown": ["exits"]}, "unknown must be some of exit_points, anchor_points"),
    ({"unknown": []}, "unknown must be some of"),
    ({"unknown": ["mass", "mass"]}, "each once"),
    ({"unknown": ["mass"]}, "give tensions"),
    ({"unknown": ["pulley_radius"]}, "no cable of this robot leaves over a pulley"),
    ({"length_noise": 0}, "length_noise must be positive"),
    ({"lengths": np.ones((5, 7))}, r"lengths must be an array of shape \(5, 8\)"),
    ({"tensions": np.ones((4, 8))}, r"tensions must be an array of shape \(5, 8\)"),
    ({"poses": cl.Pose([0, 0, 1])}, "poses must be a batch"),
    ({"poses": cl.Pose([[0, 1]])}, "lives in 3 dimensions"),
])
def test_what_cannot_be_calibrated_is_said(options, message):
    robot = ROBOTS["3R3T"]()
    poses = random_poses(robot, 5, 0)
    given = {"robot": robot, "poses": poses, "lengths": cl.cable_lengths(robot, poses), **options}
    with pytest.raises(InvalidInput, match=message):
        cl.calibrate(**given)


def test_anchors_where_all_cables_meet_are_no_unknowns():
    robot = ROBOTS["3T"]()
    poses = some_poses(robot, 5)
    with pytest.raises(InvalidInput, match="in 3T all cables meet at P"):
        cl.calibrate(robot, poses, cl.cable_lengths(robot, poses), ["anchor_points"])


@pytest.mark.parametrize("name", ["caroca", "fastkit_planar", "planar_point"])
def test_calibration_poses_are_held_and_tell_more_than_random_ones(name):
    world = cl.load_world(name)
    robot = world.robot
    poses = cl.calibration_poses(world, 12)
    assert poses == cl.calibration_poses(world, 12, seed=0) != cl.calibration_poses(world, 12, seed=1)
    assert cl.workspace(robot, poses, cl.WrenchFeasible()).inside.all()
    assert len(np.unique(poses.position, axis=0)) == 12

    def spread(poses):
        return cl.calibrate(robot, poses, cl.cable_lengths(robot, poses)).covariance.diagonal().max()

    rng = np.random.default_rng(0)
    near = cl.Pose.of(poses.position[0] + rng.uniform(-0.5, 0.5, poses.position.shape), poses.rotation)
    assert spread(poses) < 0.5 * spread(near)


def test_where_too_few_poses_are_held_that_is_said():
    world = cl.load_world("planar_suspended")
    heavy = replace(world, robot=world.robot.with_payload(1e6, [0, 0]))
    with pytest.raises(InvalidInput, match="only 0 are held within the tension limits"):
        cl.calibration_poses(heavy, 5)
