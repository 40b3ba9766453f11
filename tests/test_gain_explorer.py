"""The gain explorer: its loop is a real engine's, its verdict is the eigenvalues', every slider goes to both ends."""

from dataclasses import replace

import numpy as np
import pytest

import cdprlab as cl
from cdprlab import course
from cdprlab.course.explorers.explorer import Slider
from cdprlab.course.explorers.gains import error_decay, judge, sampled_error, step_matrix
from cdprlab.errors import InvalidInput, MissingDependency

try:
    from cdprlab.simulate.bullet import import_pybullet

    import_pybullet()
    ENGINE = True
except MissingDependency:
    ENGINE = False


flies = pytest.mark.skipif(not ENGINE, reason="PyBullet is not installed")


@pytest.fixture(scope="module")
def explorer():
    made = course.gain_explorer()
    yield made
    made.close()


def random_loops(count, seed):
    rng = np.random.default_rng(seed)
    return zip(rng.uniform(1, 2000, count), rng.uniform(1, 2000, count), 10 ** rng.uniform(-4, -1.7, count))


def test_the_sampled_error_is_the_loop_written_out():
    for kp, kd, dt in [*random_loops(20, 0), (0.0, 50.0, 0.01), (50.0, 0.0, 0.01)]:
        e, rate, errors = 1.0, 0.0, []
        for _ in range(50):
            errors.append(e)
            rate += dt * (-kd * rate - kp * e)
            e += dt * rate
        known = np.abs(errors) < 1e6
        # Fifty steps of rounding, in sums as large as the largest error.
        np.testing.assert_allclose(sampled_error(kp, kd, dt, 50)[known], np.array(errors)[known], rtol=1e-9,
                                   atol=1e-12 * np.abs(np.array(errors)[known]).max())


def test_the_limit_is_where_the_largest_eigenvalue_leaves_the_circle():
    for kp, _, dt in random_loops(50, 1):
        largest = judge(kp, 1.0, dt).largest_kd
        if largest <= 0:
            assert np.abs(np.linalg.eigvals(step_matrix(kp, 1.0, dt))).max() > 1
            continue
        for factor, stable in ((0.999, True), (1.001, False)):
            verdict = judge(kp, factor * largest, dt)
            assert verdict.stable is stable and bool(np.abs(verdict.poles).max() < 1) is stable


def test_the_continuous_error_solves_its_equation():
    for kp, kd in [(100, 20), (100, 100), (100, 3), (1200, 1200), (100, 20.0000001), (0, 40), (50, 0)]:
        t, h = np.linspace(0.05, 1, 20), 1e-4
        before, now, after = (error_decay(kp, kd, t + s * h) for s in (-1, 0, 1))
        # Second differences: rounding 4 ε/h² ≈ 1e-7, truncation h²/12 of the fourth derivative, K_p² or so.
        left = (after - 2 * now + before) / h**2 + kd * (after - before) / (2 * h) + kp * now
        np.testing.assert_allclose(left, 0, atol=1e-5 * (1 + kp + kd))
        assert error_decay(kp, kd, 0.0) == pytest.approx(1, abs=1e-12)


def test_a_fast_clock_is_the_continuous_equation():
    for kp, kd in [(100, 20), (100, 100), (100, 3)]:
        gap = [np.abs(sampled_error(kp, kd, 1 / n, n) - error_decay(kp, kd, np.arange(n) / n)).max()
               for n in (1000, 10_000)]
        # First order in Δt: a tenth of the step, a tenth of the gap.
        assert gap[1] == pytest.approx(gap[0] / 10, rel=0.1)


@flies
def test_an_engine_does_what_the_step_matrix_says():
    """The CAROCA on ideal cables, its goal jumping by 10 mm: the error falls as the matrix has it."""
    world = cl.load_world("caroca")
    kp, kd, dt, jump = 100.0, 300.0, 2e-3, np.array([0.0, 0.0, 0.01])
    law = cl.ComputedTorque(kp, kd)

    def shifted(t, state, reference):
        return law(t, state, reference._replace(pose=cl.Pose(reference.pose.position + jump)))

    pose = cl.Pose([0, 0, 1.0])
    still = replace(world, tasks={"default": cl.world.Task("hold", pose, pose, 0.2)})
    run = cl.run(still, cables="force", controller=shifted, dt=dt)
    error = jump[2] + run.errors[:, 2]
    # Bullet rounds positions to single precision, 1e-7 of a meter.
    np.testing.assert_allclose(error, jump[2] * sampled_error(kp, kd, dt, run.time.size), atol=5e-7)


@pytest.mark.parametrize("kd, dt, says", [
    (800, 1.0, "stable"), (800, 4.2, "UNSTABLE"), (1200, 1.0, "chatters"), (0, 1.0, "nothing brakes"),
    (10, 1.0, "swings"), (20, 1.0, "well damped"), (100, 1.0, "creeps")])
def test_the_verdict_in_words(explorer, kd, dt, says):
    explorer.set(kp=100, kd=kd, dt=dt)
    assert says in explorer.text.splitlines()[1] and says in explorer.alt_text


def test_both_ends_of_every_slider(explorer):
    start = {name: control.start for name, control in explorer.controls.items()}
    for name, control in explorer.controls.items():
        assert isinstance(control, Slider)
        for value in (control.low, control.high):
            explorer.set(**{**start, name: value})
            assert explorer.picture.startswith(b"\x89PNG") and "nan" not in explorer.text + explorer.alt_text
    for corner in np.ndindex(2, 2, 2, 2):
        explorer.set(**{name: (c.low, c.high)[at] for at, (name, c) in zip(corner, explorer.controls.items())})
        assert "nan" not in explorer.text


def test_gains_out_of_range_are_named():
    with pytest.raises(InvalidInput, match="kd"):
        course.gain_explorer(kd=5000)
