"""The closed loop: tracking, measured tensions, models that agree, infeasible steps, the log."""

import csv
import json
from dataclasses import replace

import numpy as np
import pytest

import cdprlab as cl
from cdprlab.errors import InfeasibleTensions, InvalidInput, MissingDependency

try:
    from cdprlab.simulate.bullet import import_pybullet

    import_pybullet()
except MissingDependency as missing:
    pytest.skip(str(missing), allow_module_level=True)


@pytest.fixture(scope="module")
def caroca():
    return cl.load_world("caroca")


@pytest.fixture(scope="module")
def flown(caroca):
    return cl.run(caroca)


def with_task(world, name, task):
    return replace(world, tasks={**world.tasks, name: task})


def rms(values):
    return float(np.sqrt(np.mean(np.square(values))))


def test_caroca_tracks_within_half_a_millimeter(flown):
    """K_p = K_d = 100 at 1 ms; 0.3 mm of it is the integrator's v dt / 2."""
    assert flown.position_errors.max() <= 0.5e-3
    assert flown.feasible.all()


def test_measured_tensions_are_measured(caroca, flown):
    """A tip of 1e-4 kg hides; one of 1e-2 kg shows its weight and inertia, m_tip (g + a) ≈ 0.05 N RMS."""
    assert rms(flown.measured_tensions - flown.commanded_tensions) <= 0.01
    heavy = cl.run(caroca, tip_mass=1e-2)
    assert 0.03 <= rms(heavy.measured_tensions - heavy.commanded_tensions) <= 0.08


def test_constraint_cables_agree_with_forces(caroca, flown):
    ideal = cl.run(caroca, cables="force")
    assert np.abs(ideal.poses.position - flown.poses.position).max() <= 1e-6


def test_two_runs_are_bit_identical(caroca, flown):
    again = cl.run(caroca)
    for name in ("commanded_tensions", "measured_tensions", "lengths", "errors", "twists"):
        np.testing.assert_array_equal(getattr(again, name), getattr(flown, name))


def test_log_keeps_the_laws(caroca, flown):
    """Lengths are those of the poses; commanded tensions exert what the controller wanted."""
    np.testing.assert_allclose(cl.cable_lengths(caroca.robot, flown.poses), flown.lengths, atol=1e-12)
    assert (flown.commanded_tensions >= caroca.robot.tension_min).all()
    speeds = np.einsum("kmn,kn->km", cl.jacobian(caroca.robot, flown.poses), flown.twists)
    # The integrator's difference is the mean of two speeds: off by a dt / 2, with a ≤ 5.77 · 2.67 m / (4 s)² for the
    # quintic, so 0.5 mm/s; a tenth more for the cables' turning.
    np.testing.assert_allclose((flown.lengths[2:] - flown.lengths[:-2]) / 2e-3, speeds[1:-1], atol=5.3e-4)


def test_orientation_is_tracked_too(caroca):
    """The controller turns the platform as asked: the thesis' code left rotation alone."""
    end = cl.Pose([0.3, 0.2, 1.0], rpy=[0.1, -0.05, 0.2])
    caroca = with_task(caroca, "turn", cl.world.Task("quintic", cl.Pose([0, 0, 1.0]), end, 2.0, 1.0))
    run = cl.run(caroca, "turn")
    assert np.abs(run.errors[:, 3:]).max() < 1e-3
    assert np.abs(run.poses.rpy[-1] - [0.1, -0.05, 0.2]).max() < 1e-3


def test_five_degrees_of_freedom_are_tracked():
    """2R3T: a rod hung by its axis; the turn about the rod itself is nobody's."""
    exits = [[-3, -2, 4], [-3, 2, 4], [3, -2, 4], [3, 2, 4], [-3, 0, 0.2], [3, 0, 0.2]]
    cables = [{"exit_point": [float(x) for x in exit_point], "anchor_point": [x, 0.0, 0.0]}
              for exit_point, x in zip(exits, [-0.5, -0.5, 0.5, 0.5, -0.5, 0.5])]
    rod = cl.World.from_dict({
        "name": "rod", "motion_pattern": "2R3T", "cables": cables, "cable_limits": {"tension": [5.0, 800.0]},
        "platform": {"mass": 10.0, "size": [1.0, 0.1, 0.1], "pose": {"position": [0.0, 0.0, 1.5]}},
        "tasks": {"default": {"kind": "quintic", "to": {"position": [0.4, 0.2, 1.8], "rpy": [0.0, -0.1, -0.1]},
                              "duration": 2.0, "hold": 1.0}}})
    run = cl.run(rod)
    assert run.errors.shape[1] == 5 and run.feasible.all()
    assert np.abs(run.errors).max() < 0.5e-3


def test_control_period_may_be_longer(caroca):
    run = cl.run(caroca, control_period=0.01)
    assert run.time.size == 500
    assert run.position_errors.max() <= 0.5e-3
    with pytest.raises(InvalidInput, match="whole multiple"):
        cl.run(caroca, control_period=1.5e-3)


def test_own_controller_and_own_method(caroca):
    """Plain functions are enough; a PD law with the weight holds the platform."""
    def hold(t, state, reference):
        error = np.concatenate([reference.pose.position - state.position, np.zeros(3)])
        return 1e4 * error - 3e3 * state.twist - cl.gravity_wrench(state.robot, state.pose)

    def projection(W, w_e, low, high):
        return cl.distribute_tensions(W, w_e, low, high, "pseudo_inverse")

    caroca = with_task(caroca, "still", cl.world.Task("hold", caroca.pose, caroca.pose, 0.3))
    run = cl.run(caroca, "still", method=projection, controller=hold)
    assert run.position_errors.max() < 1e-3 and run.method == "projection"


@pytest.mark.parametrize("wrench, message", [
    (lambda t: [0.0, 0.0, 1.0] if t > 0.01 else np.zeros(6), r"wrench at t = 0\.011 s must be 6 numbers"),
    (lambda t: np.full(6, np.nan if t > 0.01 else 0.0), r"wrench at t = 0\.011 s must be finite.*nan"),
])
def test_a_controller_that_makes_no_sense_is_named(caroca, wrench, message):
    with pytest.raises(InvalidInput, match=message):
        cl.run(caroca, duration=0.05, controller=lambda t, state, reference: wrench(t))


def test_gains_that_do_not_fit_are_named(caroca):
    with pytest.raises(InvalidInput, match="numbers or 6 of them"):
        cl.run(caroca, duration=0.01, controller=cl.ComputedTorque(np.ones(3), 100))
    with pytest.raises(InvalidInput, match="kd must be at least 0"):
        cl.ComputedTorque(100, -1)


def test_external_wrench_is_felt(caroca):
    """A steady push f leaves the error f / (m K_p) of a proportional law."""
    caroca = with_task(caroca, "still", cl.world.Task("hold", caroca.pose, caroca.pose, 6.0))
    run = cl.run(caroca, "still", external_wrench=[30.0, 0, 0, 0, 0, 0], dt=2e-3)
    # Settles with K_p/K_d = 1 per second: e⁻⁶ = 0.25 % is left after 6 s.
    assert run.errors[-1, 0] == pytest.approx(-30 / (150 * 100), rel=5e-3)


def test_infeasible_steps(caroca):
    """A payload no cable may lift: relaxed, held or stopped, and never silent."""
    weak = replace(caroca, robot=caroca.robot.with_payload(5e4, [0, 0, 0]))
    relaxed = cl.run(weak, duration=0.05)
    assert not relaxed.feasible.any()
    assert (relaxed.commanded_tensions <= caroca.robot.tension_max).all()
    with pytest.raises(InfeasibleTensions, match=r"t = 0 s") as caught:
        cl.run(weak, duration=0.05, infeasible="stop")
    assert not caught.value.distribution.feasible
    held = cl.run(weak, duration=0.05, infeasible="hold")
    np.testing.assert_array_equal(held.commanded_tensions[0], held.commanded_tensions[-1])
    with pytest.raises(InvalidInput, match="relax, stop, hold, send"):
        cl.run(weak, infeasible="ignore")


def test_save_writes_named_arrays_with_units(flown, tmp_path):
    flown.save(tmp_path / "out")
    log = np.load(tmp_path / "out" / "log.npz")
    units = json.loads(str(log["units"]))
    assert units["commanded_tension"] == "N" and set(units) | {"units"} == set(log.files)
    np.testing.assert_array_equal(log["commanded_tension"], flown.commanded_tensions)
    with (tmp_path / "out" / "log.csv").open(encoding="utf-8") as file:
        header, first, *_ = csv.reader(file)
    assert header[0] == "time [s]" and len(header) == len(first)
    again = cl.load_world(tmp_path / "out" / "world.yaml")
    np.testing.assert_array_equal(again.robot.exit_points, flown.world.robot.exit_points)


def test_progress_counts_every_step(caroca):
    counts = []
    cl.run(caroca, duration=0.25, progress=lambda done, total: counts.append((done, total)))
    assert counts[-1] == (250, 250) and [done for done, _ in counts] == sorted(done for done, _ in counts)


def test_a_cable_cut_in_flight_carries_nothing_and_is_not_counted_on(caroca):
    """The method works on the other seven: W without the column and without the cable give the same tensions."""
    run = cl.run(caroca, duration=0.4, cut={0.2: [7]}, dt=2e-3)
    after = run.time >= 0.2
    before = ~after
    assert (run.commanded_tensions[before] >= 50).all() and run.commanded_tensions[before].shape == (100, 8)
    assert not run.commanded_tensions[after, 7].any() and not run.measured_tensions[after, 7].any()
    others = [0, 1, 2, 3, 4, 5, 6]
    assert (run.commanded_tensions[after][:, others] >= 50 - 1e-4).all() and run.settings["cut"] == {0.2: [7]}
    for k in np.flatnonzero(after):
        W = cl.wrench_matrix(caroca.robot, run.poses[k])[:, others]
        exerted = W @ run.commanded_tensions[k, others]
        found = cl.distribute_tensions(W, -exerted, 50, 1e4)
        assert found.feasible
        if run.feasible[k]:
            np.testing.assert_allclose(run.commanded_tensions[k, others], found.tensions, rtol=1e-6)


@pytest.mark.filterwarnings("ignore:.*no cable can:cdprlab.errors.CdprWarning")   # it is sent all the same
def test_every_method_learns_of_a_cut(caroca):
    for method in ("linear_program", "pseudo_inverse", "closed_form", "improved_closed_form", "puncture", "relaxed"):
        infeasible = "send" if method == "pseudo_inverse" else "relax"   # it breaks limits, and is asked all the same
        run = cl.run(caroca, method=method, duration=0.1, cut={0.05: 7, 0.08: [2]}, dt=5e-3, infeasible=infeasible)
        after, later = run.time >= 0.05, run.time >= 0.08 - 1e-9
        assert run.commanded_tensions[~after, 7].all() and not run.commanded_tensions[after, 7].any(), method
        assert run.commanded_tensions[~later, 2].all() and not run.commanded_tensions[later, 2].any(), method

    limits = []

    def own(W, w_e, low, high):
        limits.append((bool(W[:, 3].any()), low[3], high[3]))
        return cl.distribute_tensions(W, w_e, low, high, "relaxed").tensions

    cl.run(caroca, method=own, duration=0.04, cut={0.02: 3}, dt=1e-2)
    assert limits == [(True, 50.0, 10000.0)] * 2 + [(False, 0.0, 0.0)] * 2


def test_held_tensions_forget_a_cut_cable(caroca):
    weak = replace(caroca, robot=caroca.robot.with_payload(5e4, [0, 0, 0]))
    held = cl.run(weak, duration=0.05, infeasible="hold", cut={0.02: [0]})
    assert held.commanded_tensions[0, 0] > 0 and not held.commanded_tensions[20:, 0].any()
    np.testing.assert_array_equal(held.commanded_tensions[0, 1:], held.commanded_tensions[-1, 1:])


def test_ropes_can_be_cut_too(caroca):
    run = cl.run(caroca, cables="length", duration=0.1, cut={0.05: [6]})
    assert run.measured_tensions[:50, 6].all() and not run.measured_tensions[50:, 6].any()


@pytest.mark.parametrize("cut, message", [({0.2: [0]}, "within the run, 0 to 0.1 s"), ({-1.0: [0]}, "within the run"),
                                          ({0.05: [8]}, "0 to 7"), ({0.05: [-1]}, "0 to 7"), ({0.05: 1.5}, "0 to 7")])
def test_what_cannot_be_cut(caroca, cut, message):
    with pytest.raises(InvalidInput, match=message):
        cl.run(caroca, duration=0.1, cut=cut)
