"""A run from its request: checked, given an engine, commanded, and logged."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from typing import Annotated, Any, Literal
from warnings import warn

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, Progress, as_answer, as_number, as_seed, checked, frozen
from ..errors import CdprWarning, InvalidInput, NoConvergence, WinchOverrun, quoted
from ..mechanics.cables import cable_lengths
from ..mechanics.rest import equilibrium
from ..mechanics.statics import gravity_wrench, wrench_matrix
from ..mechanics.trajectory import Reference
from ..robot import Robot
from ..simulate import WOUND, Simulator, open_simulator
from ..simulate.simulator import cable_indices
from ..tensions import distribute_tensions
from ..world import World
from .controllers import ComputedTorque, Controller, described
from .distributor import Distributor
from .log import Log
from .loop import Command, Flight, LengthCommand, StretchedLengths, TensionCommand, fly
from .motors import Motors
from .record import Run
from .sensors import Belief, Sensors
from .winches import TorqueControl, VelocityControl, WinchControl

Cuts = Mapping[float, ArrayLike]
"""Time [s] → the cables cut then, by index from 0."""

caution = partial(warn, category=CdprWarning, stacklevel=2)

_WOUND = 1e-9   # m: what rounding leaves of a rope's length

_MOST_STEPS = 10_000_000
"""Control steps of one run; its log would not fit into memory."""


@checked
def run(world: World, task: str = "default",
        method: str | Callable[..., Any] = "quadratic_program",
        cables: str = "tension",
        controller: Controller | TorqueControl | VelocityControl | None = None,
        dt: Annotated[float, "[s] > 0"] = 1e-3,
        control_period: Annotated[float, "[s] > 0"] | None = None, infeasible: str = "relax",
        external_wrench: Any = None, duration: Annotated[float, "[s] > 0"] | None = None,
        seed: int = 0, *, base_speeds: Any = None,
        cut: Cuts | None = None, winch: Literal["real", "ideal"] = "real",
        real: World | None = None, sensors: Sensors | None = None,
        progress: Progress | None = None, simulator: Simulator | None = None, **engine_options: Any) -> Run:
    """Move a world's robot along a task in its engine and log every control step.

    world, task : what moves, and one of its tasks' names
    method : a tension method's name, or a callable (W, w_e, tension_min, tension_max) →
        tensions or TensionDistribution
    cables : "tension" (constraint cables under torque), "force" (ideal massless baseline) or
        "length" (winches pay ropes in and out by inverse kinematics of the reference; method,
        controller and infeasible then have no say; a step is feasible where the platform is held
        as commanded: see `Run`) or "elastic" (the same with ropes that stretch: wound shorter by
        what the method's tensions stretch them)
    controller : (t, state, reference) → wrench the cables shall exert; default
        ComputedTorque(100, 100). A `TorqueControl` or `VelocityControl` commands the winches itself:
        method and infeasible then have no say, and velocity control winds ropes, elastic ones
        where the world says how they stretch
    dt, control_period : engine step and control step [s], the second a multiple of the first;
        default equal
    infeasible : what is commanded where the method's tensions break a limit or miss the wrench:
        "relax" (least wrench error inside the limits), "stop" (raise), "hold" (last tensions) or
        "send" (those tensions as they are, which push where they are negative)
    external_wrench : (n,) at P or t → (n,), felt by the platform and not told to the controller
        [N, N m]
    duration : of the run; default the task's motion and hold [s]
    seed : kept with the log for whatever draws random numbers; the loop itself draws none
    base_speeds : (3p,) θ̇, ρ̇₁, ρ̇₂ of each mobile base or t → (3p,), driven while the cables
        work, clipped to the bases' limits; winches and tensions follow the bases; planar worlds
        [rad/s, m/s]
    cut : time [s] → cables cut then, by index from 0; methods know at once: limits 0 to 0, and
        a zero column of W
    winch : "real" (a world's `winch:` is in force: what its motors cannot give is not given, and
        the run says so; the loop makes up for the friction it knows of) or "ideal" (as if the
        world had none)
    real : the world that the engine flies; the world is then what controller, method and winches
        believe in. See `perturbed`. Where lengths are commanded it begins at rest on these ropes
    sensors : what is measured of it; default the truth
    progress : called as (steps done, steps in all), about a hundred times
    simulator : an open Simulator to use (and leave open) instead of a new one
    engine_options : passed to ``open_simulator``
    A load that runs away with a winch ends the run, with a warning. Raises InvalidInput;
    InfeasibleTensions with infeasible="stop"; SimulationDiverged. These,
    Ctrl-C and errors in a caller's own code carry ``.run``: what was flown until then, whose
    ``cut_short`` says why.

    >>> import cdprlab as cl
    >>> cl.run(cl.load_world("nowhere"))
    Traceback (most recent call last):
    ...
    cdprlab.errors.WorldError: unknown world 'nowhere'; there are ...
    """
    told, flown = world, real or world
    if winch == "ideal":
        world, flown = (replace(one, robot=replace(one.robot, winch=None)) for one in (world, flown))
    if real is not None and simulator is not None and simulator.world is not real:
        raise InvalidInput("the simulator must be one of the real world: open_simulator(real)")
    job, robot = world.task(task), world.robot
    if isinstance(controller, WinchControl):
        cables = controller.cables(world, cables)
    wound = cables in WOUND
    ahead = wound and controller is None   # a wish is of where the platform is by a step's end
    distributor = Distributor(robot, method, infeasible)
    substeps, period = control_steps(dt, control_period)
    length = job.duration + job.hold if duration is None else duration
    if length > _MOST_STEPS * period:
        raise InvalidInput(f"a run of {length:g} s has more than {_MOST_STEPS} control steps of {period:g} s: "
                           "shorten it or take longer steps")
    if length < period * (1 - 1e-9):
        raise InvalidInput(f"duration must be at least one control step, {period:g} s, got {length:g} s")
    moments: Array = np.arange(round(length / period) + 1, dtype=float) * period
    times, steps = moments[:-1], len(moments) - 1
    name = method if isinstance(method, str) else getattr(method, "__name__", "own method")
    command: Command
    if isinstance(controller, WinchControl):
        command, name, ruler = controller, controller.name, described(controller)
    elif ahead:
        stretches = cables == "elastic" and robot.elasticity is not None
        command = StretchedLengths(distributor) if stretches else LengthCommand()
        name = ruler = "inverse_kinematics"
    elif wound:
        raise InvalidInput(f"cables={quoted(cables)} winds by inverse kinematics and takes no controller but "
                           "VelocityControl")
    else:
        law = ComputedTorque() if controller is None else controller
        command, ruler = TensionCommand(law, distributor), described(law)
    cuts = _cut_steps(cut or {}, robot.n_cables, steps, period)
    path = job.trajectory()(moments)
    frozen(path.twist)   # a controller is handed its rows
    frozen(path.acceleration)
    reference = path.rows(slice(-1))
    settings = {"dt": dt, "control_period": period, "controller": ruler,
                "infeasible": infeasible,
                "external_wrench": None if external_wrench is None else str(external_wrench),
                "duration": steps * period, "seed": as_seed(seed), **engine_options}
    if base_speeds is not None:
        settings["base_speeds"] = str(base_speeds)
    if sensors is not None:
        settings["sensors"] = {name: np.asarray(value).tolist() for name, value in vars(sensors).items()}
    if cut:
        settings["cut"] = {float(at): np.ravel(indices).tolist() for at, indices in cut.items()}
    settings["idle_keys"] = list(world.idle_keys(
        cables, driven=base_speeds is not None, bodies=engine_options.get("bodies") is True,
        sensed=real is not None or sensors is not None))
    body = simulator or open_simulator(flown, cables, dt, **engine_options)
    engine: Any = body if sensors is None and real in (None, told) else Belief(body, world, sensors, period)
    if flown.robot.winch is not None:
        engine = Motors(engine, body, robot.winch, period)
        settings["winch"] = winch
        start = distribute_tensions(wrench_matrix(robot, job.start), gravity_wrench(robot, job.start),
                                    robot.tension_min, robot.tension_max)
        if not start.feasible:
            caution(f"the winches do not hold the platform where it starts: {start.reason}")
    base_poses: list[Array] = []

    def drive(now: float) -> Robot:
        """Set the coming step's base speeds; returns the robot with its bases where they will be at the step's end."""
        stands, speeds = engine.robot, base_speeds
        if callable(speeds):
            speeds = as_answer(speeds(now), "base_speeds", 3 * len(stands.bases), "rad/s, m/s", now)
        driven = engine.drive(speeds).reshape(-1, 3)
        base_poses.append(engine.base_poses)
        return stands.with_bases({
            base.name: (*(base.position + base.rotation[:2, :2] @ speed[1:] * period), base.heading + speed[0] * period)
            for base, speed in zip(stands.bases, driven)})

    wanted: Iterable[Any] = map(Reference, *(path.rows(slice(1, None)) if ahead else reference))
    if base_speeds is None and isinstance(command, LengthCommand):
        wanted = cable_lengths(robot, path.pose[1:])
    stretched, pushed = isinstance(command, StretchedLengths), callable(external_wrench)

    def wishes() -> Iterator[Any]:
        """What is asked for, step after step, and what else happens as each begins."""
        if wound:
            _hang(engine, body, command, path.rows(0))
        if external_wrench is not None and not pushed:
            engine.push(external_wrench)
        if not (cuts or pushed or stretched or progress) and base_speeds is None:
            yield from wanted
            return
        for k, wish in enumerate(wanted):
            now = k * period
            if progress is not None and k % max(1, steps // 100) == 0:
                progress(k, steps)
            stand = None if base_speeds is None else drive(now)
            if k in cuts:
                for cut_off in (engine.cut, distributor.cut, command.cut):
                    cut_off(cuts[k])
            if pushed:
                engine.push(as_answer(external_wrench(now), "external_wrench", robot.n_dof, "N, N m", now))
            if stretched:
                wish = wish, stand
            elif ahead and stand is not None:
                wish = cable_lengths(stand, wish.pose)
            yield wish
        if progress is not None:
            progress(steps, steps)

    def record(flight: Flight) -> Run:
        seen, flown_steps = flight.seen, flight.steps
        run = Run.of(flight, reference, world=told, real=real, task=task, method=name, cables=cables,
                     time=frozen(times[:flown_steps]),
                     real_time_factor=flown_steps * period / flight.elapsed, dt=dt, control_period=period,
                     settings=settings,
                     base_poses=None if base_speeds is None else
                     frozen(np.reshape(base_poses[:flown_steps], (flown_steps, len(robot.bases), 3))))
        carried = run.commanded_tensions
        if run.motor_torques is not None:
            carried = seen["driven_tensions"][1:]
            _tell_short(times, seen)
        if run.commanded_lengths is not None:
            let_out = run.commanded_lengths - engine.offsets
            longer = seen["lengths"][1:] - let_out
            # By how much a cable that is held may be longer, or slack, than its rope: 1 mm and the stretch.
            allowed: Any = 1e-3
            if body.elasticity is not None:
                stretch = seen["lengths"][1:] * run.measured_tensions / body.elasticity.axial_stiffness
                allowed = 1e-3 + stretch.max(axis=1, keepdims=True)
            if not flight.cut_short:
                bad = (longer > np.max(allowed)) & run.feasible[:, None]
                bad[:, list(body.cut_cables)] = False
                for k, cable in np.argwhere(bad)[:1]:
                    caution(f"at t = {times[k]:.4g} s cable {cable + 1} spans {longer[k, cable]:.3g} m more than the "
                            f"{let_out[k, cable]:.4g} m of its rope: something holds the platform, or the engine does "
                            "not; a smaller dt may help")
            return replace(run, feasible=run.feasible & (np.abs(longer) <= allowed).all(axis=1))
        if not flight.cut_short:
            _mistrust(run, carried)
        return run

    try:
        engine.reset(job.start)
        return fly(engine, command, wishes(), record, substeps)
    except WinchOverrun as error:
        caution(f"{error}: the run ends there")
        return error.run
    finally:
        if simulator is None:
            body.close()


def _hang(engine: Any, body: Simulator, command: Command, begin: Reference) -> None:
    """At rest on the ropes that are let out as the run begins."""
    lengths = (command.wound(begin) if isinstance(command, StretchedLengths | VelocityControl) else
               cable_lengths(engine.robot, begin.pose)) - engine.offsets
    if np.abs(lengths - body.paid_out).max() > _WOUND:
        stiffness = None if body.elasticity is None else body.elasticity.axial_stiffness
        try:
            engine.reset(equilibrium(body.robot, lengths, begin.pose, axial_stiffness=stiffness).pose)
        except (NoConvergence, InvalidInput) as error:
            caution(f"the run begins where its task does, not at rest: {error}")
        body.paid_out = lengths


@checked
def control_steps(dt: Annotated[float, "[s] > 0"],
                  control_period: Annotated[float, "[s] > 0"] | None) -> tuple[int, float]:
    """Engine steps in a control step, and its length [s]; the second must be a multiple of the first.

    >>> control_steps(1e-3, 4e-3)
    (4, 0.004)
    """
    period = dt if control_period is None else control_period
    substeps = round(period / dt)
    if not 1 <= substeps <= _MOST_STEPS or abs(substeps * dt - period) > 1e-9 * period:
        raise InvalidInput(f"control_period must be a whole multiple of dt, got {period:g} s and {dt:g} s")
    return substeps, substeps * dt


def _tell_short(times: Array, seen: Log) -> None:
    """Warn where a motor first gave less than was asked of it."""
    short = seen["short"][1:].astype(int)
    for k in np.flatnonzero(short)[:1]:
        torque, speed = (seen[name][k + 1, short[k] - 1] for name in ("driven_torques", "driven_speeds"))
        caution(f"at t = {times[k]:.4g} s the motor of cable {short[k]} could not do what was asked of it: it gave "
                f"{torque:.3g} N m at {speed:.3g} rad/s; {np.count_nonzero(short)} of {short.size} steps are like that")


def _mistrust(run: Run, commanded: Array) -> None:
    """Warn where cables did not carry what was commanded, or pushed: by more than 1 N and 1 % of the largest."""
    off = np.abs(run.measured_tensions - commanded)
    allowed = 1 + 0.01 * np.abs(commanded).max(axis=1, keepdims=True)
    for k, cable in np.argwhere((off > allowed) | (run.measured_tensions < -allowed))[:1]:
        asked, carried = commanded[k, cable], run.measured_tensions[k, cable]
        remedy = ("no cable can: let the method keep its limits, infeasible=\"relax\"" if asked < 0 else
                  "do not trust it; cables=\"force\" or a smaller dt may help")
        caution(f"at t = {run.time[k]:.4g} s cable {cable + 1} was to carry {asked:.4g} N and carried {carried:.4g} N: "
             f"{remedy}")


def _cut_steps(cut: Cuts, m: int, steps: int, period: float) -> dict[int, list[int]]:
    """Control step → the cables cut as it begins."""
    due: dict[int, list[int]] = {}
    for moment, cables in cut.items():
        at = as_number(moment, "the time of a cut", "s")
        step = int(np.ceil(at / period - 1e-9))
        if not 0 <= step < steps:
            raise InvalidInput(f"a cut must fall within the run, 0 to {steps * period:g} s, got {at:g} s")
        due.setdefault(step, []).extend(cable_indices(cables, m))
    return due
