"""Spatial worlds whose mobile bases are bodies: steered within limits, coupled by a link, their wheels weighed."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_array, frozen, plain
from ..errors import InvalidInput
from ..mechanics.cables import Cables
from ..robot import Robot
from ..robot.pose import Pose
from ..world import World
from .base_body import ABOUT, ACROSS, ALONG, BODY, drum_joint, make_base
from .boxes import BoxSimulator
from .ropes import RopeLaw, rope_law
from .spatial import DEFAULT_TIP_MASS, Leg
from .state import State

_TRACTION = 0.8    # of the weight: the most the drives push with, rubber on concrete
_GAINS = 0.1, 1.0, 0.0    # of a speed motor, as PyBullet has them; named ones take twice the time of the call


class MobileSimulator(BoxSimulator):
    """A spatial world in which bases with a footprint are bodies of their own.

    world, cables, dt, tip_mass : as `SpatialSimulator`
    solver_iterations : 50; wheels on the floor are contacts, which want more than cables do
    """

    def __init__(self, world: World, cables: str = "tension", dt: float = 1e-3, *, tip_mass: float = DEFAULT_TIP_MASS,
                 solver_iterations: int = 50) -> None:
        robot = world.robot
        if cables == "force" or not robot.bases:
            raise InvalidInput("bases that stand and tip need a world with bases and cables that are bodies too: "
                               "\"tension\", \"length\" or \"elastic\"")
        self._bodies: list[int] = []
        self._targets = _places(robot)
        self._fastest = np.concatenate([base.speed_max for base in robot.bases])
        self._traction = [_TRACTION * base.mass * robot.gravity for base in robot.bases]
        self._feet = [np.insert(base.footprint, 2, 0.0, axis=1) - base.center_of_mass for base in robot.bases]
        self._mounted = _mounted(robot)
        super().__init__(world, cables, dt, tip_mass=tip_mass, solver_iterations=solver_iterations)

    # --- the interface ----------------------------------------------------------------------------
    def reset(self, pose: Pose | None = None) -> State:
        self._link, self._speeds = -1, np.zeros(3 * len(self.world.robot.bases))
        self.is_stabilized = False
        self.carrying = self.world.robot
        self._bodies, self._targets = [], _places(self.world.robot)
        self._present: Robot | None = None
        self._standing: Array | None = None
        return super().reset(pose)

    @property
    def robot(self) -> Robot:
        """The robot with its bases where they are now; how they tilt, `tilts` says."""
        if self._present is None:
            self._present = self.world.robot.with_bases({
                base.name: tuple(pose) for base, pose in zip(self.world.robot.bases, self.base_poses.tolist())})
        return self._present

    @robot.setter
    def robot(self, robot: Robot) -> None:
        self._present = None

    @property
    def base_poses(self) -> Array:
        """(p, 3) x, y and heading of each base [m, rad]."""
        if not self._bodies:
            return np.array(self._targets)
        if self._standing is None:
            read, client = self._bullet.getJointStates, self._client
            self._standing = frozen(np.array([
                [state[0] for state in read(body, (ALONG, ACROSS, ABOUT), client)] for body in self._bodies]))
        return self._standing

    @property
    def exit_velocities(self) -> Array:
        """(m, 3) of the exit points during the last step [m/s]."""
        return self._exit_steps / (self.dt * self._substeps)

    def cables_at(self, pose: Pose) -> Cables:
        """Directions, lengths and wrench matrix if the platform were at a pose, the bases where they are."""
        return self._cables(plain(pose.position), plain(pose.rotation))

    @property
    def tilts(self) -> Array:
        """(p,) angle of each base's mast from the vertical [rad]."""
        return np.arccos(np.minimum(self._frames[:, 2, 2], 1.0))

    def wheel_loads(self) -> dict[str, Array]:
        """Base name → (k,) normal force on each footprint contact, in file order [N]."""
        loads = {}
        for base, body, feet, frame in zip(self.world.robot.bases, self._bodies, self._feet, self._frames):
            force = np.zeros(len(feet))
            contacts = self._bullet.getContactPoints(bodyA=body, linkIndexA=BODY, physicsClientId=self._client)
            if contacts:
                points = (np.array([contact[5] for contact in contacts]) - frame[:, 3]).dot(frame[:, :3])
                nearest = ((points[:, None] - feet)**2).sum(axis=2).argmin(axis=1)
                # Bullet divides a substep's impulse by the whole step.
                np.add.at(force, nearest, [contact[9] * self._substeps for contact in contacts])
            loads[base.name] = force
        return loads

    def drive(self, speeds: ArrayLike) -> Array:
        wanted = as_array(speeds, "base speeds", (self._speeds.size,), "rad/s, m/s")
        fastest = np.zeros_like(wanted) if self.is_stabilized else self._fastest
        self._speeds = np.minimum(np.maximum(wanted, -fastest), fastest)
        return self._speeds

    def carry(self, robot: Robot) -> None:
        """Let those who command, and ropes of commanded length, know what hangs on them.

        robot : the world's with the payload it carries now
        """
        self.carrying = robot
        if self._ropes is not None:
            elasticity = robot.elasticity if self.cables == "elastic" else None
            self._ropes = self._paid_out(rope_law(robot, self.dt, elasticity))

    def couple(self) -> None:
        """Close the electromagnetic link: the second base then goes where the first one drives.

        Raises InvalidInput unless there are two bases.
        """
        if len(self._bodies) != 2:
            raise InvalidInput(f"the link couples two bases, this robot has {len(self._bodies)}")
        if self._link < 0:
            self._link = self._fixed(self._bodies[0], BODY, self._bodies[1], BODY)

    def uncouple(self) -> None:
        """Open the link; the second base stands where it then is."""
        if self._link >= 0:
            self._bullet.removeConstraint(self._link, physicsClientId=self._client)
            self._targets[1] = self.base_poses[1].tolist()
            self._link = -1

    def lock_platform(self) -> None:
        """Fix the platform to the first base until the next reset, as for a drive on which no cable moves."""
        self._fixed(self._bodies[0], BODY, self._platform, -1)

    def lower_stabilizers(self) -> None:
        """Stand on feet, which are where the wheels are: every base stays as it is, and does not drive."""
        self.is_stabilized = True
        self._speeds = np.zeros_like(self._speeds)
        self._targets = self.base_poses.tolist()

    def raise_stabilizers(self) -> None:
        """Stand on wheels again."""
        self.is_stabilized = False

    @property
    def is_coupled(self) -> bool:
        """Whether the link is closed."""
        return self._link >= 0

    # --- every step -------------------------------------------------------------------------------
    def _pulled(self, tensions: Array, substeps: int) -> None:
        self._steer(self.dt * substeps)
        super()._pulled(tensions, substeps)

    def _steer(self, period: float) -> None:
        control, client, speed = self._bullet.setJointMotorControl2, self._client, self._bullet.VELOCITY_CONTROL
        speeds, poses = self._speeds.tolist(), self.base_poses.tolist()
        for k, body in enumerate(self._bodies):
            spin, along, across = speeds[3 * k:3 * k + 3]
            goal, now, towed = self._targets[k], poses[k], self.is_coupled and k == 1
            heading, force = goal[2] + spin * period / 2, 0.0 if towed else self._traction[k]
            c, s = math.cos(heading), math.sin(heading)
            for joint, rate in ((ALONG, c * along - s * across), (ACROSS, s * along + c * across), (ABOUT, spin)):
                # Bullet's own position motors lag behind where a step has substeps: half of what is missing a step.
                missing = (goal[joint] - now[joint]) / (2 * period)
                goal[joint] += rate * period
                control(body, joint, speed, 0.0, missing + rate, force, *_GAINS, client)

    def _make_ropes(self) -> RopeLaw | None:
        law = super()._make_ropes()
        return None if law is None else self._paid_out(law)

    def _paid_out(self, law: RopeLaw) -> RopeLaw:
        """The law of ropes whose exit points move: a base that drives away in the step needs that much more rope."""
        def tensions(W: Array, rotation: Array, twist: Array, lengths: Array, now: Array, wound: Array,
                     push: Any) -> Array:
            leaving = (self.directions * self._exit_steps).sum(axis=1)
            return law(W, rotation, twist, lengths, now, wound - leaving, push)

        return tensions

    def _read(self) -> None:
        self._present = self._standing = None
        read, matrix, client = self._bullet.getLinkState, self._bullet.getMatrixFromQuaternion, self._client
        rows = []
        for body in self._bodies:
            place, quaternion = read(body, BODY, 0, 1, client)[:2]
            rows.append(matrix(quaternion) + place)
        values = np.array(rows)
        # Per base, rotation and center of mass side by side.
        self._frames = frames = np.concatenate([values[:, :9].reshape(-1, 3, 3), values[:, 9:, None]], axis=2)
        still, local = self._mounted
        exits = local.dot(frames.transpose(0, 2, 1).reshape(-1, 3)) + still
        self._exit_steps = exits - self._exits
        self._exits = frozen(exits)
        super()._read()

    def render(self, width: int = 640, height: int = 480) -> Any:
        from ..view.camera import Camera

        if self._camera is None:
            self._camera = Camera(self.world)
        tensions = np.where(self._cut, np.nan, self.tensions)
        boxes = [(self.box_pose(name), self._box_sizes[name]) for name in self._boxes]
        return self._camera.picture(Pose.of(self.position, self.rotation), tensions, width, height,
                                    rope_lengths=self.rope_lengths, robot=self.robot, boxes=boxes, tray=bool(boxes))

    def _make_legs(self, start: Pose) -> tuple[Leg, ...]:
        robot, middle = self.world.robot, self._middle(start)
        anchors = start.position + robot.anchor_points @ start.rotation.T
        legs: dict[int, Leg] = {}
        for base in robot.bases:
            cables = [i for i, cable in enumerate(robot.cables) if cable.base == base.name]
            exits = np.array([robot.cables[i].exit_point for i in cables]).reshape(-1, 3)
            body = make_base(self._bullet, self._client, base, exits, anchors[cables], middle, self.tip_mass)
            self._bodies.append(body)
            legs.update({i: (body, drum_joint(k)) for k, i in enumerate(cables)})
        for i, cable in enumerate(robot.cables):
            if cable.base is None:
                legs[i] = (self._make_leg(robot.exit_points[i], middle, anchors[i]), 2)
        return tuple(legs[i] for i in range(robot.n_cables))


def _places(robot: Robot) -> list[list[float]]:
    """x, y and heading of each base [m, rad]."""
    return [list(base.pose) for base in robot.bases]


def _mounted(robot: Robot) -> tuple[Array, Array]:
    """Where exit points are fixed: (m, 3) in the world, and (m, 4p) for [R c]ᵀ of every base, one below the other."""
    m = robot.n_cables
    still, local = np.zeros((m, 3)), np.zeros((m, len(robot.bases), 4))
    for i, (cable, k) in enumerate(zip(robot.cables, robot.base_indices)):
        if k < 0:
            still[i] = cable.exit_point
        else:
            local[i, k] = [*(cable.exit_point - robot.bases[k].center_of_mass), 1.0]
    return still, local.reshape(m, -1)
