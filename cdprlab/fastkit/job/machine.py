"""A state machine a person can read: phases in order, each with its guard, and faults that end in a safe state."""

from collections.abc import Callable
from dataclasses import field
from typing import Annotated, Any, NamedTuple

import numpy as np

from ...arrays import Array, checked, frozen_dataclass, lasting
from ...errors import InvalidInput
from ...robot.pose import Pose
from ..events import DONE, STOPPED, Event, as_reason

SETTLING = 0.1
"""[s] the engine's wheels take to find the floor."""


@lasting
class Readings(NamedTuple):
    """What the machine may look at.

    time : [s]
    error : distance of the platform from its reference [m]
    turn_error : angle between the two [rad]
    tensions : (m,) measured [N]; overloaded : [s] for how long they have been off their limits
    missing : [s] for how long no tensions balanced the wanted wrench
    wheels : base name → (k,) load of each wheel [N]
    base_error : farthest of any base from where it should be [m]
    gripped : whether the gripper is closed
    slipped : distance of the box from where the gripper holds it, or would take it [m]
    """

    time: float
    error: float
    turn_error: float
    tensions: Array
    overloaded: float
    missing: float
    wheels: dict[str, Array]
    base_error: float
    gripped: bool
    slipped: float


Guard = Callable[[Readings], str]
"""'' if the phase may end (fault: if all is well), else what is in the way."""


def settled(sensors: Readings) -> str:
    """The guard of most phases: the platform within 5 mm and 1° of where it should be."""
    if sensors.error > 5e-3:
        return f"the platform is {sensors.error * 1e3:.0f} mm off its reference"
    return f"the platform is {np.degrees(sensors.turn_error):.1f}° off" if sensors.turn_error > 0.0175 else ""


def box_there(sensors: Readings) -> str:
    """The guard before the gripper closes: a box within 2 cm of where it is to be taken."""
    if sensors.slipped > 0.02:
        return f"no box to grip: it is {sensors.slipped * 1e3:.0f} mm from where it should be"
    return settled(sensors)


@frozen_dataclass
class Phase:
    """One step of a job.

    name : of the state; what : the same in words
    duration : of its motion [s]
    to : where the platform goes, None: it stays
    stroke : (2,) share of the gripper's stroke the box is held at, at its begin and end; 0
        drawn in, 1 on its board
    drives : base name → (x, y, heading) it drives to
    begin : done to the engine as the phase begins: link, grip, release
    guard : asked once the motion is over; the next phase begins when it answers ''
    """

    name: str
    what: str
    duration: Annotated[float, "[s] ≥ 0"]
    to: Pose | None = None
    stroke: tuple[float, float] | None = None
    drives: dict[str, tuple[float, float, float]] = field(default_factory=dict)
    begin: Callable[[Any], None] | None = None
    guard: Guard = settled


@checked
class Machine:
    """Runs phases one after the other; a fault, or a guard that stays shut, leads to ``STOPPED``.

    phases : in order
    faults : asked every step, whatever the phase
    patience : how long a guard may stay shut after its phase's motion [s]
    """

    def __init__(self, phases: tuple[Phase, ...], faults: tuple[Guard, ...],
                 patience: Annotated[float, "[s] ≥ 0 or inf"] = 3.0) -> None:
        if not len(phases):
            raise InvalidInput("a machine needs a phase to begin with")
        self.phases, self.faults, self.patience = phases, faults, patience
        self.index = 0
        self.ended = ""          # or DONE, or STOPPED
        self.history = [Event(0.0, phases[0].name)]

    @property
    def phase(self) -> Phase:
        """The phase of now, or the last one there was."""
        return self.phases[self.index]

    @property
    def began(self) -> float:
        """When the state of now did [s]."""
        return self.history[-1].time

    @property
    def state(self) -> str:
        """Name of the state of now."""
        return self.ended or self.phase.name

    def step(self, sensors: Readings) -> bool:
        """Look, decide; True if a new state begins now."""
        if self.ended:
            return False
        now = sensors.time
        trouble = next(filter(None, (as_reason(fault(sensors), now) for fault in self.faults)), "")
        late = now - self.began - self.phase.duration
        if not trouble and late < -1e-9:
            return False
        if not trouble and (missing := as_reason(self.phase.guard(sensors), now)):
            if late <= self.patience:
                return False
            trouble = f"waited {self.patience:g} s: {missing}"
        if trouble:
            self.ended, trouble = STOPPED, f"in {self.phase.name}: {trouble}"
        elif self.index + 1 == len(self.phases):
            self.ended = DONE
        else:
            self.index += 1
        self.history.append(Event(now, self.state, trouble))
        return True


@checked
def least_edge_loads(wheels: Annotated[Array, "(…, k) [N]"]) -> Array:
    """(…) what the two wheels of a base's least loaded edge carry, from its (…, k) wheel loads [N]."""
    # Not np.roll, which takes four times as long: this is asked in every control step.
    return (wheels + wheels[..., np.arange(wheels.shape[-1]) - 1]).min(axis=-1, initial=np.inf)


def standing(sensors: Readings) -> str:
    """Fault: a base stands on fewer than two loaded corners' worth of wheels: one of its edges carries nothing."""
    if sensors.time < SETTLING:
        return ""
    for name, load in sensors.wheels.items():
        if least_edge_loads(load) < 1.0:   # N
            return f"base {name!r} lifts its wheels"
    return ""


def cables_within_limits(sensors: Readings) -> str:
    """Fault: a cable was off its limits for longer than a tenth of a second."""
    if sensors.overloaded > 0.1:
        return f"cables off their limits, {sensors.tensions.min():.1f} to {sensors.tensions.max():.1f} N"
    return "no tensions within the limits balance the platform" if sensors.missing > 0.1 else ""


def on_its_path(sensors: Readings) -> str:
    """Fault: the platform is farther from its reference than it may ever be."""
    return f"the platform is {sensors.error * 1e3:.0f} mm off its path" if sensors.error > 0.05 else ""


def box_in_hand(sensors: Readings) -> str:
    """Fault: a gripped box is not where the gripper holds it."""
    off = sensors.gripped and sensors.slipped > 0.03
    return f"the box slipped by {sensors.slipped * 1e3:.0f} mm" if off else ""


FAULTS: tuple[Guard, ...] = (standing, cables_within_limits, on_its_path, box_in_hand)
