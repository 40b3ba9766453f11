"""The job itself: the machine's phases become references, a controller moves the robot, and all is written down."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial
from itertools import count
from typing import Any
from warnings import warn

import numpy as np

from ...arrays import Array, Progress, as_number, checked, frozen
from ...errors import CdprWarning, InvalidInput, WinchOverrun, quoted
from ...mechanics.dynamics import pose_error
from ...mechanics.trajectory import Reference, Trajectory, hold, quintic, rest_to_rest
from ...robot.pose import Pose
from ...run import Log
from ...run.loop import Flight, fly
from ...run.motors import Motors
from ...run.sensors import Belief, Sensors
from ...run.start import control_steps
from ...run.winches import WinchControl, winch_control
from ...simulate.spatial import SpatialSimulator
from ...world import World
from ...world.model import PickAndPlace
from ..events import STOPPED
from ..plane import relative
from .job_record import Job
from .machine import FAULTS, Guard, Machine, Readings
from .phases import ACCELERATION, BOX, driving_speed, job_phases, payload

_ROLLERS = 0.1         # the box's factor of 0.05 with a board: boards that a box is drawn from have rollers
_AFTERMATH = 1.5       # s that a stopped job is watched: bases brake within 1 s
_SLACK = 0.5           # N: how far off its limits a cable may be before it counts, about what friction leaves


@checked
def pick_and_place(world: World, task: str = "pick_and_place",
                   control: str | WinchControl = "torque", *, speed: float = 0.5,
                   dt: float = 2e-3, control_period: float = 4e-3,
                   faults: tuple[Guard, ...] = FAULTS, fold: bool = False,
                   real: World | None = None, sensors: Sensors | None = None,
                   progress: Progress | None = None) -> Job:
    """Deploy the bases, take a box from a shelf, put it in its place, return; stop safely where something fails.

    world, task : spatial, with bases that have footprints, and a task of kind pick_and_place
    control : "torque", "velocity", or a controller of one's own
    speed : the platform's largest [m/s]
    dt, control_period : engine step and control step, the second a multiple of the first [s]
    faults : what stops the job, see `machine`
    fold : in the end drive the bases together again and couple them; who works on at the same
        shelf need not
    real, sensors : the world that the engine flies, and what is measured of it, as `run` takes them
    progress : called as (milliseconds done, in all)
    Returns Job: `.state` is "done" or "stopped", `.reason` why.
    Raises InvalidInput for another kind of task; SimulationDiverged.
    Source: Pedemonte et al. 2020, section 2.

    >>> import cdprlab as cl
    >>> pick_and_place(cl.load_world("caroca"), "default")
    Traceback (most recent call last):
    ...
    cdprlab.errors.InvalidInput: task 'default' is of kind quintic, not pick_and_place: use cl.run(world, ...)
    """
    job = world.task(task)
    if not isinstance(job, PickAndPlace):
        raise InvalidInput(f"task {quoted(task)} is of kind {job.kind}, not pick_and_place: use cl.run(world, ...)")
    substeps, period = control_steps(dt, control_period)
    law = winch_control(control)
    begin, flown = (replace(one, robot=one.robot.with_bases(job.coupled), pose=job.start,
                            tasks={task: job}) for one in (world, real or world))
    machine = Machine(job_phases(world, job, as_number(speed, "speed", "m/s", minimum=1e-3), fold=fold), faults)
    cables = law.cables(world)
    if flown.robot.winch is None:
        raise InvalidInput("winches are to do a job, but the world has no `winch:` block")
    with SpatialSimulator(flown, cables, dt, bodies=True, solver_iterations=20) as body:
        engine: Any = body
        if sensors is not None or real not in (None, world):
            engine = Belief(body, begin, sensors, period)
        motors: Any = Motors(engine, body, begin.robot.winch, period)
        motors.reset()
        engine.boxes.add(BOX, job.box_position, job.box_size, job.box_mass, friction=_ROLLERS)
        work = _Work(engine, job, machine, law, period)
        record = partial(work.record, world=world, real=real, task=task, method=law.name,
                         cables=cables, dt=dt, control_period=period,
                         settings={"dt": dt, "control_period": period, "speed": speed})
        try:
            return fly(motors, law, work.wishes(progress), record, substeps)
        except WinchOverrun as error:
            warn(f"{error}: the job ends there", CdprWarning, stacklevel=2)
            return error.run


@dataclass(eq=False)
class _Work:
    """One job under way: what changes from step to step."""

    engine: SpatialSimulator
    task: PickAndPlace
    machine: Machine
    law: WinchControl
    period: float
    stroke: float = 1.0
    carried: tuple[float, ...] = ()
    overloaded: float = 0.0
    missing: float = 0.0

    def __post_init__(self) -> None:
        self._follow(hold(self.task.start, 1.0))
        self.empty = self.engine.world.robot
        bases = self.empty.bases
        self.limits = np.array([base.speed_max for base in bases])
        self.driven, self.offset = np.zeros(self.limits.size), np.zeros(3)
        self.log = Log({"base_poses": (self.limits.shape, "m, m, rad"), "tilts": ((len(bases),), "rad"),
                        "wheels": ((len(bases), len(bases[0].footprint)), "N"),
                        "box_positions": ((3,), "m"), "box_rotations": ((3, 3), ""),
                        "stroke": ((), ""), "carried": ((), "kg"), "states": ((), "")})
        self.wished: list[Reference] = []

    def wishes(self, progress: Progress | None) -> Iterator[Reference]:
        """Where the platform should be, step after step, until the job is done or has been stopped for a while."""
        engine, machine = self.engine, self.machine
        total = round(1e3 * sum(phase.duration for phase in machine.phases))
        self._enter()
        for step in count():
            now = step * self.period
            if machine.ended and now > machine.began + _AFTERMATH:
                return
            wish = self.sampled[min(round((now - machine.began) / self.period),
                                    len(self.sampled) - 1)]
            self._drive(now)
            self._draw(now)
            box = engine.boxes.pose(BOX)
            sensors = self._look(now, wish, box)
            self.wished.append(wish)
            self.log.keep(engine.base_poses, engine.tilts, *sensors.wheels.values(), box.position,
                          box.rotation, self.stroke, self.carried[0], len(machine.history) - 1)
            yield wish
            # For how long cables have been off their limits, and wrenches unbalanced, now that the step is over.
            tau, robot = engine.tensions, self.empty
            beyond = np.maximum(robot.tension_min - tau, tau - robot.tension_max).max()
            self.overloaded = self.overloaded + self.period if beyond > _SLACK else 0.0
            self.missing = 0.0 if self.law.feasible else self.missing + self.period
            if machine.step(sensors._replace(time=(step + 1) * self.period)):
                self._enter()
            if progress is not None and step % 100 == 0:
                progress(min(round(1e3 * now), total), total)

    # --- phases -----------------------------------------------------------------------------------
    def _follow(self, path: Trajectory) -> None:
        """Sampled at once: a single sample costs as much as a hundred."""
        self.path = path
        self.sampled = list(map(Reference, *path(np.arange(round(path.duration / self.period) + 1) * self.period)))

    def _enter(self) -> None:
        """A phase begins, or the job has ended: then all stays as it is."""
        engine, machine, end = self.engine, self.machine, self.path.end
        if machine.ended == STOPPED:
            end = Pose.of(engine.position, engine.rotation)
        if machine.ended:
            return self._follow(hold(end, 1.0))
        phase = machine.phase
        if phase.begin is not None:
            phase.begin(engine)
        self._follow(hold(end, phase.duration)
                     if phase.to is None else quintic(end, phase.to, phase.duration))
        if engine.boxes.is_gripped(BOX) and not self.offset.any():
            self.offset = self._held(engine.boxes.pose(BOX)) - self._drawn()
        stood = engine.base_poses
        self.places = np.array([phase.drives.get(base.name, pose) for base, pose in zip(self.empty.bases, stood)])
        self.ways = relative(self.places, stood)[:, [2, 0, 1]]   # θ, ρ₁, ρ₂, a rest-to-rest drive along each

    def _drive(self, now: float) -> None:
        machine, speeds = self.machine, 0 * self.driven
        if machine.ended == STOPPED:   # brake, not stop dead: the cables would feel it
            slower = np.abs(self.driven) - ACCELERATION * self.period
            speeds = np.sign(self.driven) * np.maximum(slower, 0.0)
        elif machine.phase.drives and not machine.ended:
            t = now - machine.began + self.period / 2
            speeds = driving_speed(t, self.ways, self.limits, ACCELERATION).ravel()
        self.driven = self.engine.drive(speeds)

    def _draw(self, now: float) -> None:
        """The gripper's stroke, and what the platform is known to carry."""
        phase, engine = self.machine.phase, self.engine
        if phase.stroke is not None and not self.machine.ended:
            before, after = phase.stroke
            share = rest_to_rest((now - self.machine.began) / phase.duration)
            self.stroke = float(before + share * (after - before))
            engine.boxes.draw(BOX, self._drawn())
        load, place = payload(self.task, self.stroke) if engine.boxes.is_gripped(BOX) else (0.0, self.task.seat)
        if (load, *place) != self.carried:
            self.carried = load, *place
            engine.carry(load, place)

    # --- looking and writing down -----------------------------------------------------------------
    def _drawn(self) -> Array:
        """(3,) from a box on its board to where the gripper has drawn it [m]."""
        return (self.stroke - 1) * self.task.stroke

    def _held(self, box: Pose) -> Array:
        """(3,) the box's center in the platform frame [m]."""
        return (box.position - self.engine.position) @ self.engine.rotation

    def _look(self, now: float, wish: Reference, box: Pose) -> Readings:
        engine, gripped = self.engine, self.engine.boxes.is_gripped(BOX)
        place = self.offset + self._drawn() if gripped else self.task.seat + self.task.stroke
        error = pose_error(Pose.of(engine.position, engine.rotation), wish.pose)
        astray = np.hypot(*(engine.base_poses - self.places)[:, :2].T)
        return Readings(now, math.hypot(*error[:3]), math.hypot(*error[3:]), engine.tensions, self.overloaded,
                        self.missing, engine.wheel_loads(), astray.max(), gripped,
                        math.hypot(*self._held(box) - place))

    def record(self, flight: Flight, **about: Any) -> Job:
        """The job from what `fly` kept of it and what was noted beside."""
        steps = flight.steps
        poses, *rates = zip(*self.wished or self.sampled[:1])
        wanted = Pose.of(np.array([pose.position for pose in poses]),
                         np.array([pose.rotation for pose in poses]))
        kept: dict[str, Any] = {name: self.log[name][:steps] for name in self.log.units}
        boxes = Pose.of(kept.pop("box_positions"), kept.pop("box_rotations"))
        return Job.of(flight, Reference(wanted, *map(np.array, rates)),
                      time=frozen(np.arange(steps, dtype=float) * self.period), events=tuple(self.machine.history),
                      states=kept.pop("states").astype(int),
                      words={phase.name: phase.what for phase in self.machine.phases},
                      box_poses=boxes, real_time_factor=steps * self.period / flight.elapsed, **kept, **about)
