"""Winches: laws of motor and gear, each of which a change of the code breaks, and their limits in every cable model."""

import ast
import inspect
from dataclasses import replace
from importlib.util import find_spec
from types import ModuleType

import numpy as np
import pytest

import cdprlab as cl
from cdprlab.errors import CdprWarning, InvalidInput
from cdprlab.mechanics import winch as mechanics
from cdprlab.robot import Winch

WINCH = Winch(drum_radius=0.05, gear_ratio=4.0, efficiency=0.8, torque=2.0, coulomb=0.03, viscous=4e-4,
              static=0.05, inertia=2e-4, speed=90.0)
IDLE = replace(WINCH, coulomb=0.0, viscous=0.0, static=0.0, inertia=0.0)


# --- the equations --------------------------------------------------------------------------------------
def friction_law(w):
    """f_s at breakaway, f_c + f_v q̇ once it turns, half-way as the Stribeck curve says; against the motion."""
    friction = w.Friction(0.05, 0.03, 4e-4)
    fast, slow = 200.0, 5.0 * w.BREAKAWAY
    assert np.isclose(w.friction_torque(friction, fast), 0.03 + 4e-4 * fast, rtol=1e-9)
    bend = np.exp(-(slow / w.STRIBECK)**2)
    assert np.isclose(w.friction_torque(friction, slow), 0.03 + 0.02 * bend + 4e-4 * slow, rtol=2e-4)
    assert np.isclose(w.friction_torque(friction, 0.01) / 0.01, 0.05 / w.BREAKAWAY + 4e-4, rtol=1e-3)
    assert np.isclose(w.friction_torque(w.Friction(0.0, 0.03, 0.0), 0.01), w.friction_torque(
        w.Friction(0.03, 0.03, 0.0), 0.01)), "static friction is never below Coulomb's"
    speed = np.linspace(-9, 9, 37)
    assert np.allclose(w.friction_torque(friction, -speed), -w.friction_torque(friction, speed))


def gear_law(w):
    """Driven, the motor gives t v / η; driven back, it takes η t v: never more than the cable brings."""
    t, v = 45.0, 1.0
    turning = w.motor_speed(WINCH, -v)
    assert np.isclose(turning, v * 4.0 / 0.05)
    assert np.isclose(w.motor_torque(IDLE, t, -v) * turning, t * v / 0.8)
    assert np.isclose(w.motor_torque(IDLE, t, v) * turning, t * v * 0.8)
    slow = np.array([-0.5, 0.0, 0.5])
    gear = w.gear_torque(IDLE, t, slow * w.BREAKAWAY)
    assert np.allclose(gear, t * 0.05 / 4.0 * 0.8**-np.tanh(slow)), "no jump at rest"
    assert np.isclose(w.motor_torque(replace(IDLE, inertia=0.3), 0.0, 0.0, -v), 0.3 * 80.0)
    rates = np.random.default_rng(0).uniform(-2, 2, 500)
    lost = w.motor_torque(WINCH, t, rates) * w.motor_speed(WINCH, rates) + t * rates
    assert (lost >= 0).all(), "energy from nothing"
    assert np.allclose(w.motor_torque(WINCH, t, v), w.motor_torque(IDLE, t, v) + w.friction_torque(WINCH, -turning))


def damping_law(w):
    """The slope of all that is lost, by a coarser difference than its own."""
    for q in (-20.0, -0.7, 0.3, 3.0):
        def lost(at):
            return float(w.motor_torque(replace(WINCH, inertia=0.0), 30.0, at * -0.05 / 4.0))
        assert np.isclose(w.motor_damping(WINCH, 30.0, q), (lost(q + 1e-3) - lost(q - 1e-3)) / 2e-3, rtol=1e-4)


def drive(seed):
    """Rates, l̈₀ and A of a platform on four cables, and tensions."""
    rng = np.random.default_rng(seed)
    W, M = rng.normal(size=(3, 4)), np.diag([9.0, 9.0, 0.7])
    return rng.uniform(-0.5, 0.5, 4), rng.normal(0, 5, 4), W.T @ np.linalg.solve(M, W), rng.uniform(20, 80, 4)


def balance_law(w):
    """The tensions behind the torques that tensions and their acceleration take are those tensions."""
    h, wide = 1e-3, replace(WINCH, torque=1e3, speed=np.inf)
    for seed in range(4):
        rates, loose, yielding, tensions = drive(seed)
        acceleration = loose - yielding @ tensions
        for damping in (0.0, np.array([0.0, 0.1, 0.2, 0.3])):
            torques = (w.motor_torque(WINCH, tensions, rates, acceleration)
                       + h * damping * w.motor_speed(WINCH, acceleration))
            found, given = w.cable_tensions(wide, torques, rates, loose, yielding, h, damping)
            assert np.allclose(found, tensions) and np.allclose(given, torques)


def limits_law(w):
    """Torque within its limit either way; speed at the step's end within its, by as little torque as that takes."""
    h, heavy, limited = 0.02, replace(WINCH, inertia=1e-3), []
    for seed in range(6):
        rates, loose, yielding, pulls = drive(seed)
        torques = 500.0 * np.random.default_rng(seed).normal(size=4)
        wide = replace(heavy, speed=np.inf, torque=1e9)
        tensions, given = w.cable_tensions(wide, torques, rates, loose, yielding, h, 0.0)
        assert (given == torques).all() and tensions.min() == 0
        tensions, given = w.cable_tensions(replace(wide, torque=2.0), torques, rates, loose, yielding, h, 0.0)
        assert np.allclose(given, np.clip(torques, -2, 2)) and (tensions <= 2 * 4 / 0.05).all()
        # Too fast at the step's end, some of four: only as much torque as the limit takes.
        rates, pulls = 0.6 * rates, pulls + 200.0
        acceleration = np.random.default_rng(seed).normal(0, 14, 4)
        loose = acceleration + yielding @ pulls
        wanted = w.motor_torque(wide, pulls, rates, acceleration)
        slower = replace(wide, torque=1e3, speed=30.0)
        tensions, given = w.cable_tensions(slower, wanted, rates, loose, yielding, h, 0.0)
        changed = ~np.isclose(given, wanted)
        ahead = w.motor_speed(slower, rates + h * (loose - yielding @ tensions))
        if (tensions > 0).all():
            unlimited = w.motor_speed(slower, rates + h * acceleration)
            assert np.allclose(ahead[changed], 30.0 * np.sign(unlimited[changed]))
            assert (changed == (np.abs(unlimited) > 30.0)).all()
            limited.append(int(changed.sum()))
        # The load may be stronger than the motors.
        _, given = w.cable_tensions(replace(slower, torque=0.2), wanted, rates, loose, yielding, h, 0.0)
        assert (np.abs(given) <= 0.2).all()
    assert {1, 2} <= set(limited), limited
    slipped, _ = w.cable_tensions(replace(heavy, torque=0.5), np.array([0.5]), np.array([0.5]), np.array([90.0]),
                                  np.array([[1.0]]), 1e-3, 0.0)
    assert np.allclose(slipped, 0.5 * 4.0 / 0.05), "a cable carries what the motor's torque holds, and slips"


LAWS = [friction_law, gear_law, damping_law, balance_law, limits_law]


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.__name__)
def test_laws(law):
    law(mechanics)
    with pytest.MonkeyPatch.context() as patch:   # which is 1, and multiplies as well as it divides
        patch.setattr(mechanics, "BREAKAWAY", 0.8)
        law(mechanics)


SWAPS = {ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult, ast.Gt: ast.Lt,
         ast.MatMult: ast.Mult}


class Change(ast.NodeTransformer):
    """Changes one operator, sign, number or limit of a file's functions: the first of those with this number."""

    def __init__(self, number):
        self.left, self.told = number, ""

    def visit(self, node):
        if isinstance(node, ast.Module):
            node.body = [self.visit(item) if isinstance(item, ast.FunctionDef) else item for item in node.body]
            return node
        node, before = self.generic_visit(node), ast.unparse(node)
        other = self.other(node)
        if other is None:
            return node
        self.left -= 1
        if self.left != -1:
            return node
        self.told = f"line {node.lineno}: {before}"
        return ast.copy_location(other, node)

    def other(self, node):
        if isinstance(node, ast.BinOp) and type(node.op) in SWAPS:
            return ast.BinOp(node.left, SWAPS[type(node.op)](), node.right)
        if isinstance(node, ast.UnaryOp):
            return node.operand
        if isinstance(node, ast.Compare) and type(node.ops[0]) in SWAPS:
            return ast.Compare(node.left, [SWAPS[type(node.ops[0])]()], node.comparators)
        if isinstance(node, ast.Constant) and type(node.value) in (int, float):
            return ast.Constant(node.value + 1)
        if isinstance(node, ast.Call) and ast.unparse(node.func) in ("np.clip", "max", "np.tanh", "np.sign", "np.exp"):
            return node.args[0]
        return None


def changed():
    """Each change in turn: what it is, and the file with it."""
    source = inspect.getsource(mechanics)
    for number in range(1000):
        change = Change(number)
        tree = ast.fix_missing_locations(change.visit(ast.parse(source)))
        if not change.told:
            return
        yield change.told, tree


def test_every_change_of_the_equations_breaks_a_law():
    lived = []
    for told, tree in changed():
        module = ModuleType("changed")
        module.__package__ = "cdprlab.mechanics"
        with np.errstate(all="ignore"):
            try:
                exec(compile(tree, "changed", "exec"), module.__dict__)
                module.BREAKAWAY = 0.8
                for law in LAWS:
                    law(module)
            except Exception:
                continue
        lived.append(told)
    assert lived == []


# --- in flight ------------------------------------------------------------------------------------------
def crane(planar, lift=0.1, duration=0.5, mass=4.0, hold=0.1, **winch):
    """A load on one rope, lifted; 0.48 N m on a drum of 40 mm radius behind 5:1 are 60 N."""
    zero = [0.0] * (2 if planar else 3)
    start, end, top = zero[1:] + [1.0], zero[1:] + [1.0 + lift], zero[1:] + [3.0]
    return cl.World.from_dict({
        "name": "crane", "motion_pattern": "2T" if planar else "3T",
        "platform": {"mass": mass, "size": [0.2] * len(zero), "pose": {"position": start}},
        "winch": {"drum_radius": 0.04, "gear_ratio": 5, "torque": 0.48} | winch, "cable": {"axial_stiffness": 1e5},
        "cables": [{"exit_point": top, "anchor_point": zero, "tension": [0, 500]}],
        "tasks": {"default": {"kind": "quintic", "to": {"position": end}, "duration": duration, "hold": hold}}})


FLIES = pytest.mark.skipif(find_spec("pybullet") is None, reason="PyBullet has no wheel here")
MODELS = [(True, cables) for cables in ("tension", "force", "length", "elastic")] + [
    pytest.param(False, cables, marks=FLIES) for cables in ("tension", "force", "length", "elastic")]
LOSSY = {"efficiency": 0.7, "friction": {"coulomb": 0.02, "viscous": 2e-4, "static": 0.03}}
quiet = pytest.mark.filterwarnings("ignore::cdprlab.errors.CdprWarning")


@quiet
@pytest.mark.parametrize(("planar", "cables"), MODELS)
def test_a_motor_gives_what_it_can(planar, cables):
    """60 N at most, where the lift asks for more; the log says so, and an ideal winch gives more."""
    world = crane(planar, lift=1.0, mass=5.5)   # 54 N of weight, and up to 31 N to speed it up
    assert world.robot.tension_max == pytest.approx(60.0)
    run = cl.run(world, cables=cables, method="pseudo_inverse", infeasible="send")
    assert 59.0 < run.measured_tensions.max() < 60.0 + 0.01      # a leg's tip weighs a millinewton
    assert not run.feasible.all() and run.motor_torques.max() <= 0.48 * (1 + 1e-9)
    ideal = cl.run(world, cables=cables, winch="ideal", duration=0.2)
    assert ideal.feasible.all() and ideal.measured_tensions.max() > 80 and ideal.motor_torques is None


@pytest.mark.parametrize("planar", [True, pytest.param(False, marks=FLIES)])
def test_losses_that_are_known_do_not_show(planar):
    """Same world, no inertia: the motor makes up for all that friction and gear lose: the flight is the ideal one."""
    world = crane(planar, torque=5.0, **LOSSY)
    real, ideal = (cl.run(world, cables="force", winch=winch, duration=0.3) for winch in ("real", "ideal"))
    np.testing.assert_allclose(real.poses.position, ideal.poses.position, atol=1e-12)
    assert real.feasible.all() and np.ptp(real.motor_torques) > 0.05


def swinging(**winch):
    """Four cables in the plane that turn as they are wound, on quick winches with heavy rotors."""
    world = cl.load_world("planar_suspended")
    document = world.to_dict() | {"winch": {"drum_radius": 0.05, "gear_ratio": 10, "inertia": 1e-4} | LOSSY | winch}
    start = world.pose.position
    document["tasks"] = {"default": {"kind": "quintic", "to": {"position": (start + [0.9, 0.4]).tolist(), "angle": 0.2},
                                     "duration": 1.5}}
    document["cable"] = {"axial_stiffness": 1e5, "damping": 0.05}
    return cl.World.from_dict(document)


@quiet
@pytest.mark.parametrize(("cables", "share"), [("tension", 2e-3), ("length", 1e-9), ("elastic", 1e-9)])
def test_the_motors_equation_holds_in_flight(cables, share):
    """τ = I q̈ + f(q̇) + gear, with q̈ from the speeds as logged; friction and inertia are found again."""
    run = cl.run(swinging(), cables=cables)
    winch, turning = run.world.robot.winch, np.diff(run.motor_speeds, axis=0) / run.control_period
    rates = run.motor_speeds[:-1] * (-winch.drum_radius / winch.gear_ratio)
    needed = mechanics.motor_torque(winch, run.measured_tensions[:-1], rates) + winch.inertia * turning
    taut = run.measured_tensions[:-1].min(axis=1) > 1.0
    off = np.abs(needed - run.motor_torques[:-1])[taut][3:].max()
    assert off < share * winch.inertia * np.abs(turning[taut][3:]).max()
    friction, inertia = cl.identify_friction(run)
    np.testing.assert_allclose(friction, (0.03, 0.02, 2e-4), rtol=0.05)
    assert inertia == pytest.approx(1e-4, rel=0.02)


def test_friction_that_was_found_is_made_up_for():
    """Believed to be without friction, winches drag the platform along; found from that run, they do not."""
    real, law = swinging(), cl.ComputedTorque(100, 20)
    naive = replace(real.robot.winch, coulomb=0.0, viscous=0.0, static=0.0, inertia=0.0)

    def flown(believed):
        return cl.run(replace(real, robot=replace(real.robot, winch=believed)), real=real, controller=law, duration=0.6)

    first, known = flown(naive), cl.run(real, controller=law, duration=0.6)
    again = flown(replace(naive, **cl.identify_friction(first)[0]._asdict()))
    assert first.position_errors.max() > 1.5 * known.position_errors.max()
    assert again.position_errors.max() == pytest.approx(known.position_errors.max(), rel=0.01)


@quiet
@pytest.mark.parametrize(("planar", "cables"), MODELS)
def test_no_motor_turns_faster_than_it_can(planar, cables):
    """Lifted by 0.2 m at up to 0.75 m/s, its winch at most at 0.4 m/s: late, and said."""
    world = crane(planar, lift=0.2, hold=0.3, torque=5.0, speed=50.0, inertia=1e-4)
    assert world.robot.speed_max == pytest.approx(0.4)
    run = cl.run(world, cables=cables)
    rate = np.abs(np.gradient(run.lengths[:, 0], run.time)).max()
    assert 0.38 < rate < 0.4 * 1.05 and not run.feasible.all()    # elastic ropes ring a little
    assert run.position_errors[-1] < 0.05


@pytest.mark.parametrize(("planar", "cables"), MODELS)
def test_a_load_that_runs_away_ends_the_run(planar, cables):
    """98 N on 60 N and 10 rad/s: said at once, and ended when the load turns the motor faster than it can turn."""
    world = crane(planar, mass=10.0, speed=10.0)
    with pytest.warns(CdprWarning) as told:
        run = cl.run(world, cables=cables)
    told = " ".join(str(warning.message) for warning in told)
    assert "do not hold the platform where it starts" in told and "the run ends there" in told
    assert "WinchOverrun" in run.cut_short and 0.01 < run.time[-1] < 0.1 and not run.feasible[:-1].any()
    assert run.measured_tensions.max() < 60.01


@quiet
@pytest.mark.parametrize("cables", ["tension", "length"])
def test_a_load_gives_back_no_more_than_it_had(cables):
    """Let down and lifted again, energy goes one way: from the motor; let down it gets back less than the load had."""
    world = crane(True, lift=-0.5, mass=4.0, hold=0.2, inertia=1e-4, torque=5.0, **LOSSY)
    run = cl.run(world, cables=cables)
    work = float((run.motor_torques * run.motor_speeds).sum() * run.control_period)
    assert -4.0 * 9.81 * 0.5 * 0.7 < work < -1.0
    back = cl.run(crane(True, lift=0.5, mass=4.0, hold=0.2, inertia=1e-4, torque=5.0, **LOSSY), cables=cables)
    assert float((back.motor_torques * back.motor_speeds).sum() * back.control_period) > 4.0 * 9.81 * 0.5 / 0.7


def test_limits_are_the_smaller_ones_and_the_file_keeps_its_own():
    world = crane(True, speed=50.0, efficiency=0.7)
    assert world.robot.tension_max == pytest.approx(0.48 * 5 * 0.7 / 0.04)
    assert world.robot.speed_max == pytest.approx(50 * 0.04 / 5)
    document = world.to_dict()
    assert document["cables"][0]["tension"] == [0, 500] and "speed" not in document["cables"][0]
    weak = replace(world.robot, cables=(replace(world.robot.cables[0], tension_max=10.0),))
    assert weak.tension_max == 10.0
    document["cables"][0]["tension"] = [50, 500]
    with pytest.raises(cl.CdprError, match="cable 1: tension: the winch gives at most 42 N"):
        cl.World.from_dict(document)


def test_what_is_asked_of_winches_is_checked():
    world = crane(True)
    with pytest.raises(InvalidInput, match="winch must be 'real' or 'ideal'"):
        cl.run(world, winch="none")
    with pytest.raises(InvalidInput, match="nothing is known of motors"):
        cl.identify_friction(cl.run(world, winch="ideal", duration=0.01))
