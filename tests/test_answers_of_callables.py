"""What callables of the caller's answer is checked at every step; what they are handed is not for them to change."""

from contextlib import suppress
from dataclasses import replace

import numpy as np
import pytest

import cdprlab as cl
from cdprlab.errors import InfeasibleTensions, InvalidInput
from cdprlab.run import INFEASIBLE

WORLDS = ["planar_rigid", "caroca"]
NONSENSE = {"None": lambda n: None, "NaN": lambda n: np.full(n, np.nan), "infinite": lambda n: np.full(n, np.inf),
            "one less": lambda n: np.ones(n - 1), "a column": lambda n: np.ones((n, 1)), "a number": lambda n: 5.0,
            "text": lambda n: ["1"] * n, "complex": lambda n: np.ones(n) * 1j, "enormous": lambda n: np.full(n, 1e31),
            "masked": lambda n: np.ma.masked_array(np.ones(n), np.arange(n) == 0)}


@pytest.mark.parametrize("answer", NONSENSE.values(), ids=NONSENSE)
@pytest.mark.parametrize("name", WORLDS)
def test_nonsense_is_refused_whenever_it_comes_and_the_moment_is_named(name, answer):
    world = cl.load_world(name)
    robot, law = world.robot, cl.ComputedTorque()
    bad = answer(robot.n_dof), answer(robot.n_cables)

    def controller(t, state, reference):
        return law(t, state, reference) if t < 0.0045 else bad[0]

    calls = []

    def method(W, w_e, low, high):
        calls.append(1)
        return bad[1] if len(calls) > 5 else cl.distribute_tensions(W, w_e, low, high).tensions

    def push(t):
        return np.zeros(robot.n_dof) if t < 0.0045 else bad[0]

    for how in ({"controller": controller}, {"external_wrench": push},
                *({"method": method, "infeasible": infeasible} for infeasible in INFEASIBLE)):
        calls.clear()
        with pytest.raises(InvalidInput, match=r"at t = 0\.005 s must be") as caught:
            cl.run(world, duration=0.02, **how)
        assert caught.value.run.time.size == 5


@pytest.mark.parametrize("answer", NONSENSE.values(), ids=NONSENSE)
def test_speeds_of_bases_that_are_none(answer):
    world = cl.load_world("fastkit_planar")
    n = 3 * len(world.robot.bases)
    for cables in ("tension", "length"):
        with pytest.raises(InvalidInput, match=r"base_speeds at t = 0\.005 s must be"):
            cl.run(world, duration=0.02, cables=cables,
                   base_speeds=lambda t: np.zeros(n) if t < 0.0045 else answer(n))


@pytest.mark.parametrize("options", [{}, {"cables": "force"}, {"real": True}, {"sensors": cl.Sensors()}], ids=str)
@pytest.mark.parametrize("name", WORLDS)
def test_what_callables_are_handed_is_not_the_engine_s(name, options):
    """Whoever scribbles into it changes nothing: each array refuses, or is the callable's own."""
    world, law = cl.load_world(name), cl.ComputedTorque()
    if "real" in options:
        options = {"real": cl.perturbed(world, exit_points=1e-3)}

    def scribble(*arrays):
        for array in arrays:
            with suppress(ValueError):   # read-only
                array[...] = 1e3

    def controller(t, state, reference):
        wrench = law(t, state, reference)
        scribble(state.position, state.rotation, state.twist, state.tensions, state.lengths, state.pose.position,
                 state.robot.exit_points, state.robot.tension_max, reference.pose.position, reference.pose.rotation,
                 reference.twist, reference.acceleration)
        return wrench

    def method(W, w_e, low, high):
        tensions = cl.distribute_tensions(W, w_e, low, high, "relaxed").tensions.copy()
        scribble(W, w_e, low, high)
        return tensions

    def plain(W, w_e, low, high):
        return cl.distribute_tensions(W, w_e, low, high, "relaxed").tensions

    own = cl.run(world, **options, duration=0.02, controller=controller, method=method)
    true = cl.run(world, **options, duration=0.02, method=plain)
    for column, (values, _) in true.columns().items():
        np.testing.assert_array_equal(own.columns()[column][0], values, err_msg=column)


@pytest.mark.parametrize("name", WORLDS)
@pytest.mark.parametrize("cables", ["tension", "force"])
def test_an_engine_takes_what_cables_can_carry(name, cables):
    world = cl.load_world(name)
    m = world.robot.n_cables
    with cl.open_simulator(world, cables) as simulator:
        for tensions in (*(answer(m) for answer in NONSENSE.values()), np.full(m, -1.0), [1.0] * (m - 1) + [-1e-6]):
            with pytest.raises(InvalidInput, match="tensions"):
                simulator.step(tensions)
        for substeps in (0, -1, 1.5, "2"):
            with pytest.raises(InvalidInput, match="substeps"):
                simulator.step(np.ones(m), substeps)
        assert simulator.time == 0
        simulator.step([10] * m)
        assert simulator.time == simulator.dt


@pytest.mark.parametrize("name", WORLDS)
def test_winches_take_lengths(name):
    world = cl.load_world(name)
    m = world.robot.n_cables
    with cl.open_simulator(world, "length") as simulator:
        for lengths in (*(answer(m) for key, answer in NONSENSE.items()), np.full(m, -1.0), ["1"] * m, [None] * m):
            with pytest.raises(InvalidInput, match="rope lengths"):
                simulator.wind(lengths)
        with pytest.raises(InvalidInput, match="substeps"):
            simulator.wind(simulator.lengths, 0)
        assert simulator.time == 0 and simulator.wind(simulator.lengths)


# --- infeasible means the same for all methods ----------------------------------------------------------
def out_of_balance(W, w_e, low, high):
    return cl.distribute_tensions(W, w_e, 0 * low, high).tensions + 1.0


def beyond(W, w_e, low, high):
    return -np.linalg.pinv(W) @ w_e


@pytest.mark.parametrize("name", WORLDS)
@pytest.mark.filterwarnings("ignore:.*no cable can:cdprlab.errors.CdprWarning")   # it is sent all the same
@pytest.mark.parametrize("method", [out_of_balance, beyond, "pseudo_inverse"])
def test_every_method_is_judged(name, method):
    world = cl.load_world(name)
    smallest = 250.0 if name == "caroca" else 120.0   # more than the least norm gives
    limited = [replace(cable, tension_min=smallest) for cable in world.robot.cables]
    world = replace(world, robot=replace(world.robot, cables=tuple(limited)))
    robot = world.robot
    with pytest.raises(InfeasibleTensions, match=r"at t = 0 s: \S") as caught:
        cl.run(world, method=method, duration=0.02, infeasible="stop")
    assert not caught.value.distribution.feasible and not caught.value.run.time.size
    relaxed = cl.run(world, method=method, duration=0.02)
    np.testing.assert_array_equal(relaxed.commanded_tensions,
                                  cl.run(world, method="relaxed", duration=0.02).commanded_tensions)
    sent = cl.run(world, method=method, duration=0.02, infeasible="send")
    reference = world.task().trajectory()(0.0)
    with cl.open_simulator(world) as simulator:
        simulator.reset(world.task().start)
        w_e = -cl.ComputedTorque()(0.0, simulator.state(), reference)
    asked = cl.wrench_matrix(robot, sent.poses[0]), w_e, robot.tension_min, robot.tension_max
    answer = method(*asked) if callable(method) else cl.distribute_tensions(*asked, method).tensions
    np.testing.assert_allclose(sent.commanded_tensions[0], answer, rtol=1e-9)
    np.testing.assert_allclose(sent.measured_tensions[0], answer, atol=0.05)   # even where that pushes
    assert not sent.feasible.any()


def test_a_method_without_an_answer_has_nothing_to_send():
    world = cl.load_world("planar_rigid")

    def none(W, w_e, low, high):
        return cl.distribute_tensions(W, w_e * 1e6, low, high, "linear_program")

    with pytest.raises(InfeasibleTensions, match="at t = 0 s"):
        cl.run(world, method=none, duration=0.01, infeasible="send")
    assert cl.run(world, method=none, duration=0.01).feasible.all()   # relaxed: the wrench itself is no burden
