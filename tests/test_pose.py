"""Poses and rotation vectors against their definitions."""

import copy
import pickle

import numpy as np
import pytest
from hypothesis import given, strategies as st
from hypothesis.extra.numpy import arrays
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

import cdprlab as cl
from cdprlab.errors import InvalidInput
from cdprlab.robot.pose import cross_matrix, rotation_from_vector, rotation_vector, rotation_vector_jacobian
from robots import differences

ANGLES = st.floats(-3.0, 3.0)


def about(axis, angle):
    """Rotation about one axis, written out."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array({"x": [[1, 0, 0], [0, c, -s], [0, s, c]], "y": [[c, 0, s], [0, 1, 0], [-s, 0, c]],
                     "z": [[c, -s, 0], [s, c, 0], [0, 0, 1]]}[axis])


@given(ANGLES, ANGLES, ANGLES)
def test_rpy_is_fixed_axis(roll, pitch, yaw):
    pose = cl.Pose([0, 0, 0], rpy=[roll, pitch, yaw])
    np.testing.assert_allclose(pose.rotation, about("z", yaw) @ about("y", pitch) @ about("x", roll), atol=1e-15)
    again = cl.Pose([0, 0, 0], rpy=pose.rpy)
    np.testing.assert_allclose(again.rotation, pose.rotation, atol=1e-14)


@pytest.mark.parametrize("pitch", [np.pi / 2, -np.pi / 2])
def test_gimbal_lock_still_gives_the_rotation_back(pitch):
    pose = cl.Pose([0, 0, 0], rpy=[0.3, pitch, -0.2])
    # an angle within 1e-8 of the pole is all arcsin can tell
    np.testing.assert_allclose(cl.Pose([0, 0, 0], rpy=pose.rpy).rotation, pose.rotation, atol=1e-7)


@given(ANGLES)
def test_planar_angle_is_counter_clockwise(angle):
    pose = cl.Pose([0, 0], angle=angle)
    np.testing.assert_allclose(pose.rotation, about("z", angle)[:2, :2], atol=1e-15)
    assert float(pose.angle) == pytest.approx(angle, abs=1e-14)


def test_without_orientation_a_pose_is_unrotated():
    np.testing.assert_array_equal(cl.Pose([1, 2]).rotation, np.eye(2))
    np.testing.assert_array_equal(cl.Pose([[1, 2, 3]] * 4).rotation, [np.eye(3)] * 4)


def test_batch_axes_broadcast_both_ways():
    places, turns = np.zeros((5, 1, 3)), np.linspace(0, 1, 12).reshape(4, 3)
    grid = cl.Pose(places, turns)
    assert grid.batch_shape == (5, 4) and grid.rotation.shape == (5, 4, 3, 3) and len(grid) == 5
    np.testing.assert_allclose(grid.rpy, np.broadcast_to(turns, (5, 4, 3)), atol=1e-14)
    assert grid[2, 1] == cl.Pose([0, 0, 0], turns[1])
    assert cl.Pose([0, 0], angle=[0.1, 0.2, 0.3]).position.shape == (3, 2)
    assert [p.batch_shape for p in grid] == [(4,)] * 5


@pytest.mark.parametrize("pose", [cl.Pose([1, 2, 3], [0.1, 0.2, 0.3]), cl.Pose([[1, 2], [3, 4]], angle=0.5)])
def test_a_pose_survives_pickling_and_copying(pose):
    for other in (pickle.loads(pickle.dumps(pose)), copy.deepcopy(pose), copy.copy(pose)):
        assert other == pose and not other.position.flags.writeable and not other.rotation.flags.writeable


def test_a_pose_does_not_change():
    given_position = np.array([1.0, 2.0, 3.0])
    pose = cl.Pose(given_position)
    given_position[0] = 9.0
    assert pose.position[0] == 1.0 and given_position.flags.writeable
    with pytest.raises(AttributeError):
        pose.position = given_position
    for array in (pose.position, pose.rotation, cl.Pose([[0, 0]] * 3).rotation):
        with pytest.raises(ValueError, match="read-only"):
            array[..., 0] = 5.0


@pytest.mark.parametrize("given, says", [
    (dict(position=[1]), "2 (planar) or 3 (spatial)"), (dict(position=1.0), "position"),
    (dict(position="here"), "'here'"), (dict(position=[0, np.nan]), "finite"),
    (dict(position=[0, 0, 0], rpy=[0, 0]), "rpy must be 3 numbers"),
    (dict(position=[0, 0, 0], rpy=[0, 0, np.inf]), "finite"),
    (dict(position=[0, 0], rpy=[0, 0, 0]), "angle="), (dict(position=[0, 0, 0], angle=0.1), "rpy="),
    (dict(position=[0, 0], angle=0.1, matrix=np.eye(2)), "one orientation"),
    (dict(position=[0, 0, 0], matrix=np.eye(2)), "(3, 3)"),
    (dict(position=[0, 0, 0], matrix=np.diag([1, 1, -1])), "determinant +1"),
    (dict(position=[0, 0, 0], matrix=1.01 * np.eye(3)), "rotation"),
    (dict(position=np.zeros((2, 3)), rpy=np.zeros((3, 3))), "do not fit together"),
])
def test_input_that_is_no_pose(given, says):
    with pytest.raises(cl.errors.InvalidInput) as raised:
        cl.Pose(**given)
    assert says in str(raised.value)


def test_asking_for_what_a_pose_has_not():
    with pytest.raises(cl.errors.InvalidInput, match="angle"):
        _ = cl.Pose([0, 0]).rpy
    with pytest.raises(cl.errors.InvalidInput, match="rpy"):
        _ = cl.Pose([0, 0, 0]).angle
    with pytest.raises(TypeError):
        len(cl.Pose([0, 0]))
    with pytest.raises(TypeError):
        cl.Pose([0, 0])[0]


def random_vectors(seed=0):
    """Rotation vectors of every size from none to almost half a turn, both sides of the series' border."""
    rng = np.random.default_rng(seed)
    axes = rng.normal(size=(14, 3))
    axes /= np.linalg.norm(axes, axis=-1, keepdims=True)
    return axes * np.array([0, 1e-12, 1e-8, 1e-4, 1e-3, 0.0499, 0.0501, 0.2, 1, 2, 2.5, 3, 3.1, 3.14])[:, None]


def test_rotation_vectors_are_the_exponential_map():
    vectors = random_vectors()
    rotations = rotation_from_vector(vectors)
    for v, rotation in zip(vectors, rotations):
        np.testing.assert_allclose(cross_matrix(v) @ [1, 2, 3], np.cross(v, [1, 2, 3]), atol=1e-15)
        np.testing.assert_allclose(rotation, expm(cross_matrix(v)), atol=1e-14)
    np.testing.assert_allclose(rotation_vector(rotations), vectors, atol=1e-13)
    plane = np.array([[-3.0], [0.0], [1.5]])
    np.testing.assert_allclose(rotation_vector(rotation_from_vector(plane)), plane, atol=1e-15)


@pytest.mark.parametrize("v", random_vectors(1))
def test_rotation_vector_jacobian_is_the_derivative(v):
    # [ω]× = Ṙ Rᵀ, column by column; step 1e-5 leaves 1e-10 from h² and 1e-11 from rounding
    slope = differences(lambda x: expm(cross_matrix(v + x)), 3, 1e-5)
    spin = np.einsum("ijk,lj->ilk", slope, expm(cross_matrix(v)))
    expected = np.stack([spin[2, 1], spin[0, 2], spin[1, 0]])
    np.testing.assert_allclose(rotation_vector_jacobian(v), expected, rtol=0, atol=1e-9)


def test_rotation_vector_jacobian_of_a_batch():
    vectors = random_vectors(2)
    np.testing.assert_array_equal(rotation_vector_jacobian(vectors), [rotation_vector_jacobian(v) for v in vectors])


@pytest.mark.parametrize("position", [["1", "2", "3"], [True, False, True], ["x", 0, 0], [[1, 2], [3]], [None] * 3])
def test_only_numbers_are_numbers(position):
    with pytest.raises(InvalidInput, match="position must be"):
        cl.Pose(position)


@given(arrays(float, 3, elements=st.floats(-3.1, 3.1)))
def test_rpy_is_what_scipy_says(rpy):
    """Also near the pole, where the pose is the same whatever roll and yaw are read."""
    expected = Rotation.from_euler("xyz", rpy).as_matrix()
    pose = cl.Pose([0, 0, 0], rpy=rpy)
    np.testing.assert_allclose(pose.rotation, expected, atol=1e-15)
    np.testing.assert_allclose(cl.Pose([0, 0, 0], rpy=pose.rpy).rotation, expected, atol=3e-8)   # the pole's width
    if abs(np.cos(rpy[1])) > 1e-3:
        read = Rotation.from_matrix(expected).as_euler("xyz")
        np.testing.assert_allclose(np.exp(1j * pose.rpy), np.exp(1j * read), atol=1e-12)   # π is −π


@pytest.mark.parametrize("pitch", [np.pi / 2, -np.pi / 2])
def test_at_the_pole_yaw_is_none(pitch):
    pose = cl.Pose([0, 0, 0], rpy=[0.3, pitch, 0.8])
    assert pose.rpy[2] == 0
    np.testing.assert_allclose(cl.Pose([0, 0, 0], rpy=pose.rpy).rotation, pose.rotation, atol=1e-15)
