"""Quintic motions: their ends, their derivatives, their rest."""

import numpy as np
import pytest
from scipy.linalg import expm

import cdprlab as cl
from cdprlab.robot.pose import cross_matrix, rotation_vector, rotation_vector_jacobian, rotation_vector_jacobian_rate
from robots import case

BOUNDARY = ("start_twist", "end_twist", "start_acceleration", "end_acceleration")


def random_motion(d, seed, moving):
    """A path between two random poses (turns up to 2.5 rad), with random rates at its ends if ``moving``."""
    rng = np.random.default_rng(seed)
    n = 3 if d == 2 else 6

    def pose():
        place = rng.uniform(-1, 1, d)
        return cl.Pose(place, angle=rng.uniform(-1, 1)) if d == 2 else cl.Pose(place, rng.uniform(-0.8, 0.8, 3))

    rates = {name: rng.normal(size=n) for name in BOUNDARY} if moving else {}
    return cl.quintic(pose(), pose(), rng.uniform(1, 4), **rates), rates


ALL = pytest.mark.parametrize("d, seed, moving", [(d, s, m) for d in (2, 3) for s in range(4) for m in (False, True)])


@ALL
def test_ends_are_the_ones_asked_for(d, seed, moving):
    path, rates = random_motion(d, seed, moving)
    n = 3 if d == 2 else 6
    for t, pose, end in ((0.0, path.start, "start"), (path.duration, path.end, "end")):
        at = path(t)
        np.testing.assert_allclose(at.pose.position, pose.position, atol=1e-13)
        np.testing.assert_allclose(at.pose.rotation, pose.rotation, atol=1e-13)
        np.testing.assert_allclose(at.twist, rates.get(f"{end}_twist", np.zeros(n)), atol=1e-12)
        np.testing.assert_allclose(at.acceleration, rates.get(f"{end}_acceleration", np.zeros(n)), atol=1e-11)


@ALL
def test_twist_and_acceleration_are_derivatives(d, seed, moving):
    path, _ = random_motion(d, seed, moving)
    h = 1e-5
    for t in np.linspace(2 * h, path.duration - 2 * h, 7):
        here, before, after = path(t), path(t - h), path(t + h)
        turn = rotation_vector(after.pose.rotation @ before.pose.rotation.T)
        step = np.concatenate([after.pose.position - before.pose.position, turn])
        # rates of a few units: h² times third derivatives below 1e3, rounding 1e-15 / h
        np.testing.assert_allclose(here.twist, step / (2 * h), atol=1e-7)
        np.testing.assert_allclose(here.acceleration, (after.twist - before.twist) / (2 * h), atol=1e-6)


def test_derivatives_where_the_turn_starts_small():
    path = cl.quintic(cl.Pose([0, 0, 0], [0.3, 0.2, 0.1]), cl.Pose([0, 0, 0], [0.31, 0.19, 0.11]), 1.0,
                      start_twist=[0, 0, 0, 0.02, -0.01, 0.03], end_twist=[0, 0, 0, -0.3, 0.2, 0.1])
    h = 1e-5
    for t in np.linspace(2 * h, 1 - 2 * h, 40):
        slope = (path(t + h).twist - path(t - h).twist) / (2 * h)
        np.testing.assert_allclose(path(t).acceleration, slope, atol=1e-8)


@pytest.mark.parametrize("angle", [0.0, 1e-6, 1e-3, 0.0099, 0.0101, 0.0499, 0.0501, 0.5, 2.0, 3.1])
def test_rate_of_the_rotation_vector_jacobian(angle):
    """Both sides of each border between series and quotient; h = 3e-5 leaves 2e-11 from h², 4e-12 from rounding."""
    axis, rate, h = np.array([2, -1, 2]) / 3, np.array([0.9, 0.3, -0.4]), 3e-5
    slope = rotation_vector_jacobian(angle * axis + h * rate) - rotation_vector_jacobian(angle * axis - h * rate)
    np.testing.assert_allclose(rotation_vector_jacobian_rate(angle * axis, rate), slope / (2 * h), rtol=0, atol=1e-10)


@pytest.mark.parametrize("seed", range(4))
def test_rest_to_rest_is_the_textbook_polynomial_about_one_axis(seed):
    path, _ = random_motion(3, seed, moving=False)
    turn = rotation_vector(path.start.rotation.T @ path.end.rotation)
    for s in np.linspace(0, 1, 9):
        share = 10 * s**3 - 15 * s**4 + 6 * s**5
        at = path(s * path.duration)
        between = path.start.position + share * (path.end.position - path.start.position)
        np.testing.assert_allclose(at.pose.position, between, atol=1e-13)
        np.testing.assert_allclose(at.pose.rotation, path.start.rotation @ expm(cross_matrix(share * turn)), atol=1e-13)
        np.testing.assert_allclose(np.cross(at.twist[3:], path.start.rotation @ turn), 0, atol=1e-12)


@ALL
def test_arrays_of_times(d, seed, moving):
    path, _ = random_motion(d, seed, moving)
    times = np.linspace(-0.5, path.duration + 0.5, 12).reshape(3, 4)
    many = path(times)
    assert many.pose.batch_shape == times.shape
    for index in np.ndindex(times.shape):
        one = path(times[index])
        np.testing.assert_allclose(many.pose.position[index], one.pose.position, atol=1e-14)
        np.testing.assert_allclose(many.pose.rotation[index], one.pose.rotation, atol=1e-14)
        np.testing.assert_allclose(many.twist[index], one.twist, atol=1e-13)
        np.testing.assert_allclose(many.acceleration[index], one.acceleration, atol=1e-13)


def test_it_rests_before_and_after():
    path, _ = random_motion(3, 1, moving=True)
    for t, pose in ((-1.0, path.start), (path.duration + 1e-9, path.end), (path.duration + 9, path.end)):
        at = path(t)
        np.testing.assert_allclose(at.pose.position, pose.position, atol=1e-13)
        np.testing.assert_allclose(at.pose.rotation, pose.rotation, atol=1e-13)
        assert not at.twist.any() and not at.acceleration.any()


def test_hold_stays():
    _, pose = case("3R3T", 1)
    held = cl.hold(pose, 2.0)([0.0, 0.7, 3.0])
    np.testing.assert_array_equal(held.pose.position, np.broadcast_to(pose.position, (3, 3)))
    np.testing.assert_allclose(held.pose.rotation, np.broadcast_to(pose.rotation, (3, 3, 3)), atol=1e-15)
    assert not held.twist.any()


def test_a_long_slow_motion_keeps_its_end():
    """Ten minutes: powers up to 1e13 must not eat the end pose."""
    path = cl.quintic(cl.Pose([0, 0, 1]), cl.Pose([3, -2, 1], [0, 0, 1]), 600.0)
    np.testing.assert_allclose(path(600.0).pose.position, [3, -2, 1], atol=1e-11)
    np.testing.assert_allclose(path(600.0).twist, 0, atol=1e-12)


@pytest.mark.parametrize("start, end, duration, more", [
    ([0, 0, 0], [0, 0], 1.0, {}), ([[0, 0, 0]] * 2, [0, 0, 0], 1.0, {}), ([0, 0], [1, 1], 0.0, {}),
    ([0, 0], [1, 1], -1.0, {}), ([0, 0], [1, 1], np.nan, {}), ([0, 0], [1, 1], 1.0, {"start_twist": np.zeros(6)}),
    ([0, 0], [1, 1], 1.0, {"end_acceleration": [0, 0, np.nan]})])
def test_input_that_makes_no_motion(start, end, duration, more):
    with pytest.raises(cl.errors.InvalidInput):
        cl.quintic(cl.Pose(start), cl.Pose(end), duration, **more)
