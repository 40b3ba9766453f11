"""What a controller may know: its own model of the robot, and what sensors tell of the one that flies."""

from collections import deque
from typing import Annotated, Any, Literal

import numpy as np

from ..arrays import Array, as_array, as_seed, frozen, frozen_dataclass
from ..errors import InvalidInput
from ..mechanics.cables import Cables, cables_at
from ..mechanics.dynamics import mass_and_bias, pose_error
from ..mechanics.kinematics import moved, nearby_pose
from ..robot import Robot
from ..robot.pose import Pose
from ..simulate.state import State
from ..world import World
from .log import Columns

Meters = Annotated[float, "[m] ≥ 0"]


@frozen_dataclass
class Sensors:
    """What is measured of a robot as it flies; noise is Gaussian, its numbers standard deviations.

    pose : "true", as a tracker sees it, or "from_lengths": forward kinematics of the measured
        lengths, started from the last pose
    position_noise, rotation_noise : of each coordinate of the pose [m], and about each axis [rad]
    length_noise : [m]; length_offset : read too much, a number or (m,) [m]
    tension_noise : [N]
    quantization : step of the measured lengths, 0 for none [m]
    rate : samples a second, None: one each control step [1/s]
    delay : from a sample to the controller [s]
    seed : of the noise
    observer_frequency : of the double pole of the observer that the twist comes from [Hz]
    Raises InvalidInput for negative numbers.

    >>> Sensors(position_noise=1e-3, delay=0.01).pose
    'true'
    """

    pose: Literal["true", "from_lengths"] = "true"
    position_noise: Meters = 0.0
    rotation_noise: Annotated[float, "[rad] ≥ 0"] = 0.0
    length_noise: Meters = 0.0
    length_offset: Annotated[float | Array, "(…) [m]"] = 0.0
    tension_noise: Annotated[float, "[N] ≥ 0"] = 0.0
    quantization: Meters = 0.0
    rate: Annotated[float, "[1/s] > 0"] | None = None
    delay: Annotated[float, "[s] ≥ 0"] = 0.0
    seed: int = 0
    observer_frequency: Annotated[float, "[Hz] > 0"] = 3.0

    def __post_init__(self) -> None:
        as_seed(self.seed)


_SOON = 1e-9   # s: what rounding leaves of a time


class Observer:
    """Position, rotation and twist: predicted with the wrench just commanded, corrected by the pose then measured.

    p̂ += (1 − z²) e, v̂ += (1 − z)² e / T with e = measured − predicted and z = exp(−2π f T): a
    double pole, whatever the time T between two samples.

    pose : where the robot rests at first; frequency : f [Hz]
    """

    def __init__(self, robot: Robot, pose: Pose, frequency: float) -> None:
        self.pose, self.twist = pose, np.zeros(3 * (robot.dimension - 1))
        self._speed = 2 * np.pi * frequency

    def predict(self, robot: Robot, wrench: Array | None, period: float) -> None:
        """A period later, under a wrench of the cables (n,); without one at the same twist."""
        rotation = self.pose.rotation
        if wrench is not None:
            M, h = mass_and_bias(robot, rotation, self.twist)
            S = robot.pattern.basis(rotation)
            self.twist = self.twist + period * S @ np.linalg.solve(S.T @ M @ S, wrench - h @ S)
        self.pose = self.pose.displaced(period * self.twist)

    def correct(self, error: Array, elapsed: float) -> None:
        """By how far the measured pose was from the predicted one, so long after the last time [m, rad; s]."""
        z = np.exp(-self._speed * elapsed)
        self.pose = self.pose.displaced((1 - z**2) * error)
        self.twist = self.twist + (1 - z)**2 / elapsed * error


class Belief:
    """An engine as those who command it see it: their own robot in the place of the one that flies, and measurements.

    engine : the Simulator that flies the real robot; all else that is asked of a Belief, it answers
    world : what is believed
    sensors : None: the pose, twist, lengths and tensions there are
    period : control step [s]
    """

    def __init__(self, engine: Any, world: World, sensors: Sensors | None, period: float) -> None:
        real, believed = engine.world.robot, world.robot
        flies, told = ((robot.motion_pattern, robot.n_cables, [base.name for base in robot.bases])
                       for robot in (real, believed))
        if flies != told:
            raise InvalidInput(f"the real robot must have the cables, bases and motion pattern of the one believed "
                               f"in, {believed!r}, got {real!r}")
        self.engine, self.world, self.sensors, self.period = engine, world, sensors, period
        self.carrying = believed
        self.offsets = real.length_offsets - believed.length_offsets
        """(m,) what the winches read too much [m]."""
        if sensors is not None:
            self._read_too_much = self.offsets + as_array(
                sensors.length_offset, "length_offset", (real.n_cables,) if np.ndim(sensors.length_offset) else (), "m")

    def __getattr__(self, name: str) -> Any:
        if name in ("position", "rotation", "twist", "tensions"):
            return getattr(self.state(), name)
        return getattr(self.cables_now if name in ("directions", "wrench_matrix") else self.engine, name)

    # --- what is commanded ------------------------------------------------------------------------
    def reset(self, pose: Pose | None = None) -> State:
        """As the engine does; the sensors begin anew."""
        self._home = self.world.pose if pose is None else pose
        self.engine.reset(self._home)
        self._seen_at, self._wrench = -1, None
        return self.state()

    def carry(self, mass: float, position: Array) -> None:
        """As the engine does."""
        self.engine.carry(mass, position)
        robot = self.world.robot
        self.carrying = robot.with_payload(mass, position) if mass else robot

    def pull(self, tensions: Array, substeps: int) -> None:
        """As the engine does."""
        self._wrench = self.wrench_matrix @ tensions
        self.engine.pull(tensions, substeps)

    def bring(self, lengths: Array, substeps: int) -> bool:
        """As the engine does; the lengths are what encoders shall read."""
        return self.engine.bring(lengths - self.offsets, substeps)

    # --- what is seen -----------------------------------------------------------------------------
    @property
    def robot(self) -> Robot:
        """The one believed in, its bases where they are."""
        real = self.engine.robot
        if real is self.engine.world.robot:
            return self.world.robot
        return self.world.robot.with_bases({base.name: base.pose for base in real.bases})

    def state(self) -> State:
        """What is known now; measured once a control step."""
        engine = self.engine
        if self._seen_at != engine.steps:
            self._seen_at = engine.steps
            true = engine.state()
            self._state = (true._replace(robot=self.robot, lengths=frozen(engine.lengths + self.offsets))
                           if self.sensors is None else self._sense(true, self.sensors))
            self._cables: Cables | None = None
        return self._state

    def cables_at(self, pose: Pose) -> Cables:
        """Directions, lengths and wrench matrix at a pose, the bases where they are."""
        return cables_at(self.robot, pose)

    @property
    def cables_now(self) -> Cables:
        """The same at the pose that is known."""
        state = self.state()
        if self._cables is None:
            self._cables = cables_at(state.robot, state.pose)
        return self._cables

    @property
    def rope_lengths(self) -> Array | None:
        wound = self.engine.rope_lengths
        return None if wound is None else wound + self.offsets

    def columns(self) -> Columns:
        """Those of the engine, and what was known."""
        true = self.engine.columns()
        return {**true, **{f"sensed_{name.removeprefix('measured_')}": kind for name, kind in true.items()}}

    def sample(self) -> Array:
        """The engine's, and what is known."""
        state = self.state()
        return np.concatenate((self.engine.sample(), state.position, state.rotation, state.twist, state.lengths,
                               state.tensions), axis=None)

    # --- sensors ----------------------------------------------------------------------------------
    def _sense(self, true: State, sensors: Sensors) -> State:
        """The last sample that has arrived, and the observer's twist."""
        now, robot = true.time, self.robot
        if not self.engine.steps:   # at home all is known from the start
            self._rng, self._fitted = np.random.default_rng(sensors.seed), self._home
            self._observer = Observer(robot, self._home, sensors.observer_frequency)
            self._measured, _ = self._look(true, sensors, robot)
            self._observer.pose = self._measured.pose
            self._samples, self._taken = deque[tuple[State, Array]](), 1
        else:
            self._observer.predict(self.carrying, self._wrench, self.period)
            if sensors.rate is None or now >= self._taken / sensors.rate - _SOON:
                self._taken += 1
                self._samples.append(self._look(true, sensors, robot))
            while self._samples and self._samples[0][0].time + sensors.delay <= now + _SOON:
                arrived, error = self._samples.popleft()
                self._observer.correct(error, arrived.time - self._measured.time)
                self._measured = arrived
        seen = self._measured
        return true._replace(robot=robot, position=seen.position, rotation=seen.rotation,
                             twist=frozen(self._observer.twist), tensions=seen.tensions, lengths=seen.lengths)

    def _look(self, true: State, sensors: Sensors, robot: Robot) -> tuple[State, Array]:
        """What is measured now, and how far the pose then is from the observer's."""
        m, n, normal = robot.n_cables, robot.n_dof, self._rng.normal
        lengths = self.engine.lengths + self._read_too_much + sensors.length_noise * normal(size=m)
        if sensors.quantization:
            lengths = np.round(lengths / sensors.quantization) * sensors.quantization
        pose = true.pose
        if sensors.pose == "from_lengths":
            pose = self._fitted = nearby_pose(robot, lengths, self._fitted)
        turns = len(robot.pattern.turn_axes)
        size = np.repeat([sensors.position_noise, sensors.rotation_noise], [n - turns, turns])
        pose = moved(robot, pose, size * normal(size=n))
        tensions = true.tensions + sensors.tension_noise * normal(size=m)
        return true._replace(position=pose.position, rotation=pose.rotation, lengths=frozen(lengths),
                             tensions=frozen(tensions)), pose_error(self._observer.pose, pose)
