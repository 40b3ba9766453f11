"""The base explorer: rates are the derivatives of its lengths, and every control answers at both ends of its range."""

import itertools

import numpy as np
import pytest

import cdprlab as cl
from cdprlab import course
from cdprlab.errors import InvalidInput
from robots import moved

WORLDS = ("planar_mcdpr", "fastkit_planar", "mobile_four_bases")
# Central differences over 1e-6 s of lengths of a few metres: rounding 1e-16 / 1e-6 times some ten, curvature 1e-12.
STEP, DIFFERENCE = 1e-6, 1e-8


@pytest.fixture(params=WORLDS)
def explorer(request):
    explorer = course.base_explorer(cl.load_world(request.param))
    yield explorer
    explorer.close()


def somewhere(explorer, seed):
    """Random values within every slider's range."""
    rng = np.random.default_rng(seed)
    explorer.set(**{name: rng.uniform(control.low, control.high) for name, control in explorer.controls.items()
                    if hasattr(control, "low")})
    return explorer.motion(explorer.values)


@pytest.mark.parametrize("seed", range(4))
def test_rates_are_the_derivatives_of_the_lengths(explorer, seed):
    motion = somewhere(explorer, seed)

    def lengths(t):
        bases = {base.name: (*(base.position + base.rotation[:2, :2] @ speeds[1:] * t), base.heading + speeds[0] * t)
                 for base, speeds in zip(motion.robot.bases, motion.base_speeds.reshape(-1, 3))}
        return cl.cable_lengths(motion.robot.with_bases(bases), moved(motion.robot, motion.pose, motion.twist * t))

    measured = (lengths(STEP) - lengths(-STEP)) / (2 * STEP)
    np.testing.assert_allclose(motion.rates, measured, atol=DIFFERENCE)


def test_bases_stand_where_the_sliders_put_them():
    explorer = course.base_explorer(cl.load_world("planar_mcdpr"))
    explorer.set(left_along=0.4, right_along=-0.2)
    motion = explorer.motion(explorer.values)
    assert [base.position[0] for base in motion.robot.bases] == [0.4, 1.8]
    np.testing.assert_array_equal(motion.lengths, cl.cable_lengths(motion.robot, motion.pose))
    explorer.close()


def test_every_control_answers_at_both_ends_of_its_range(explorer):
    for name, control in explorer.controls.items():
        start = explorer.values[name]
        for end in (control.low, control.high) if hasattr(control, "low") else control.options:
            explorer.set(**{name: end})
            assert explorer.picture.startswith(b"\x89PNG")
            assert "length [m]" in explorer.text and "platform at" in explorer.alt_text
        explorer.set(**{name: start})


def test_all_corners_in_the_plane():
    explorer = course.base_explorer(cl.load_world("planar_mcdpr"))
    names = ("left_along", "right_along", "x", "y", "speed_along")
    for corner in itertools.product(*((explorer.controls[name].low, explorer.controls[name].high) for name in names)):
        explorer.set(**dict(zip(names, corner)))
        assert np.isfinite(explorer.motion(explorer.values).rates).all()
    explorer.close()


def test_the_picture_follows_the_bases():
    explorer = course.base_explorer(cl.load_world("planar_mcdpr"))
    before = explorer.picture
    explorer.set(left_along=0.3)
    driven = explorer.picture
    assert driven != before
    explorer.set(left_along=0.0)
    assert explorer.picture == before
    explorer.close()


def test_only_the_chosen_base_drives_and_its_limits_hold():
    explorer = course.base_explorer(cl.load_world("planar_mcdpr"))
    explorer.set(drives="right", speed_along=0.8)
    np.testing.assert_array_equal(explorer.motion(explorer.values).base_speeds, [0, 0, 0, 0, 0.8, 0])
    assert "Cables 3, 4 paid out" in explorer.text
    explorer.close()


def test_a_winch_too_slow_is_named():
    explorer = course.base_explorer(cl.load_world("planar_mcdpr"))
    explorer.set(v_x=1.15, v_y=1.675)   # Rasheed et al. 2018, sec. 4.1: out of reach unless a base drives along
    assert "cable 1 too fast for the winch" in explorer.text
    explorer.set(drives="left", speed_along=0.4)
    assert "too fast" not in explorer.text
    explorer.close()


def test_a_cable_without_length_has_no_rate():
    world = cl.load_world("planar_mcdpr").to_dict()
    world["cables"][0]["exit_point"] = [0.4, 1.6]
    explorer = course.base_explorer(cl.World.from_dict(world))
    explorer.set(left_along=0.6, x=1.0, y=1.6)
    assert "Cable 1 has no length" in explorer.text
    explorer.close()


def test_what_cannot_drive_is_named():
    with pytest.raises(InvalidInput, match="'caroca' has no base that can drive"):
        course.base_explorer(cl.load_world("caroca"))
    with pytest.raises(InvalidInput, match="must be a World, got '"):
        course.base_explorer("planar_mcdpr")
    with pytest.raises(InvalidInput, match="base 'passive' cannot drive"):
        course.base_explorer(cl.load_world("fastkit_planar"), bases=("passive",))
    with pytest.raises(InvalidInput, match="at least one base"):
        course.base_explorer(cl.load_world("fastkit_planar"), bases=())
