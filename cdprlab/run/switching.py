"""Cable configurations put to work: a sequence followed in the engine, by a robot that is a little off."""

from itertools import groupby
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Flags, as_count, checked, frozen, seeds
from ..configurations.measured import hanging_position
from ..configurations.sequence import ConfigurationSequence
from ..configurations.winding import winding_plan
from ..errors import SimulationDiverged
from ..mechanics.trajectory import Reference
from ..robot.pose import Pose
from ..simulate import open_simulator
from ..world import World
from ..world.perturbation import perturbed
from .loop import Flight, LengthCommand, fly
from .record import Run
from .sensors import Belief

TAUT = 1.0
"""[N] a cable that carries less counts as slack."""


@checked
def follow_sequence(world: World, sequence: ConfigurationSequence, *, slack: float = 0.2,
                    speed: float = 0.2,
                    reeling: float = 0.05, real: World | None = None) -> Run:
    """Lead a point mass along a sequence by rope lengths alone, in the engine.

    world : what the planner knows; sequence : from `plan_configurations`
    slack : let out of every cable that shall not carry; 0 is the naive way, all ropes by
        inverse kinematics [m]
    speed, reeling : the load's largest, and of slack taken up and let out [m/s]
    real : the world that the engine flies, see `perturbed`; default the one the planner knows
    Returns Run; its reference is the planned motion, its errors what the load was off, and
    ``taut_cables`` reads off which cables carried.
    Raises InvalidInput, SimulationDiverged.

    >>> import cdprlab as cl
    >>> world = cl.load_world("marionet")
    >>> best = cl.plan_configurations(world.robot, [0.6, 0.8, 0.8], [0.7, 0.8, 0.8])[0]
    >>> bool(follow_sequence(world, best, slack=0.05).position_errors.max() < 1e-5)
    True
    """
    plan = winding_plan(world.robot, sequence, slack, speed, reeling)
    with open_simulator(real or world, "length") as body:
        engine: Any = Belief(body, world, None, body.dt)
        # At rest where these ropes hold the load; those that are slack there are let out at
        # their winches' speed.
        hanging = hanging_position(body.robot, plan.lengths[0] - engine.offsets)[0]
        engine.reset(Pose(hanging))
        while not engine.bring(plan.lengths[0], 1):
            pass
        dt, settings = engine.dt, {"slack": float(slack), "speed": float(speed), "reeling": float(reeling)}
        twist = np.gradient(np.pad(plan.positions, ((0, 0), (0, 3))), dt, axis=0)   # nothing turns
        planned = Reference(Pose(plan.positions), twist, np.gradient(twist, dt, axis=0))

        def record(flight: Flight) -> Run:
            steps = flight.steps
            return Run.of(flight, planned, at_end=True, world=world, real=real, task="sequence",
                          method="cable_configurations", cables="length", time=frozen(plan.time[:steps]),
                          real_time_factor=steps * dt / flight.elapsed, dt=dt, control_period=dt, settings=settings)

        return fly(engine, LengthCommand(), plan.lengths, record)


@checked
def taut_cables(run: Run) -> Flags:
    """(N, m) whether each cable carried more than ``TAUT`` newtons."""
    return run.measured_tensions > TAUT


class Trial(NamedTuple):
    """How one robot with errors fared, from the moment when the first slack is out: before, chance decides who carries.

    off_path : largest distance from the planned motion [m]
    under_constrained : longest time with fewer than three taut cables [s]
    unplanned : longest time during which other cables carried than the plan had [s]
    """

    off_path: float
    under_constrained: float
    unplanned: float


@checked
def try_errors(world: World, sequence: ConfigurationSequence, trials: int, *,
               slack: float = 0.2, speed: float = 0.2,
               reeling: float = 0.05, length_error: float = 0.01, exit_error: float = 0.02,
               seed: int = 0) -> list[Trial]:
    """The same sequence followed by robots whose ropes and exit points are off, drawn evenly within the errors.

    world, sequence, slack, speed, reeling : as `follow_sequence`
    trials : how many; length_error, exit_error : half widths, of each rope and each coordinate
        of each exit [m]
    seed : of the errors
    Returns one Trial each; a load that leaves the scene counts as off by infinity.
    """
    as_count(trials, "trials")
    plan = winding_plan(world.robot, sequence, slack, speed, reeling)
    found = []
    for drawn in seeds(seed, trials):
        real = perturbed(world, exit_points=exit_error, lengths=length_error, seed=drawn)
        try:
            run = follow_sequence(world, sequence, slack=slack, speed=speed, reeling=reeling, real=real)
        except SimulationDiverged:
            found.append(Trial(np.inf, np.inf, np.inf))
            continue
        out = int(np.argmin(plan.taut.all(axis=1)))
        taut, planned = taut_cables(run)[out:], plan.taut[out:]
        found.append(Trial(float(run.position_errors[out:].max()), _longest(taut.sum(axis=1) < 3) * run.dt,
                           _longest((taut & ~planned).any(axis=1)) * run.dt))
    return found


def _longest(true: Any) -> int:
    """Length of the longest row of true values."""
    return max((len(list(row)) for value, row in groupby(true) if value), default=0)
