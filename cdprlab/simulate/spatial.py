"""PyBullet behind the `Simulator` interface: imported only when a spatial world is simulated.

A cable is a UPS leg: universal joint at the exit point, an actuated prismatic joint, a point mass at the tip, and
a point-to-point constraint from the tip to the platform's anchor point. A pull on the prismatic joint is the
tension. With a 1e-4 kg tip the leg reproduces an ideal massless cable to about 1 µm and 0.001 N.
"""

from __future__ import annotations

import contextlib
import ctypes
import math
import os
import sys
from collections.abc import Iterator
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_array, frozen
from ..compiled.columns import cables as compiled_cables
from ..errors import InvalidInput, MissingDependency, SimulationDiverged
from ..mechanics.cables import Cables
from ..mechanics.statics import gravity_wrench
from ..robot import Robot
from ..robot.pose import Pose
from ..tensions import distribute_tensions
from ..world import World
from .ropes import RopeLaw, rope_law
from .simulator import Simulator
from .state import State

DEFAULT_TIP_MASS = 1e-4  # kg
Leg = tuple[int, int]
"""A cable: the body it belongs to, and that body's prismatic joint, whose link is the tip."""

_NOTHING = (0.0, 0.0, 0.0)
_ROUNDING = 1e-9  # m: a reel exactly at its limit must not fail by it
_AMPLE = 1.0  # m: a cut rope does not become taut in any one step


class SpatialSimulator(Simulator):
    """A spatial world in its own PyBullet client (DIRECT mode, no window).

    world : a spatial World
    cables : "tension" (UPS legs), "force" (external forces on the platform), "length" (UPS legs that pull as ropes
        wound to a length do) or "elastic" (such ropes, that stretch as the world's ``cable:`` block says)
    dt : time step [s]
    tip_mass : point mass at each leg's tip [kg]; the tension error is about tip_mass (g + a)
    solver_iterations : of Bullet's constraint solver; for cables 5 give the digits of 200, contacts want 10 to 50
    """

    def __init__(self, world: World, cables: str = "tension", dt: float = 1e-3, *,
                 tip_mass: float = DEFAULT_TIP_MASS, solver_iterations: int = 5) -> None:
        self.world, self.robot, self.dt, self.cables = world, world.robot, float(dt), cables
        self.tip_mass = float(tip_mass)
        self._bullet = import_pybullet()
        with quiet():  # connect() prints its arguments
            self._client = self._bullet.connect(self._bullet.DIRECT)
        self._camera: Any = None
        self._exits = world.robot.exit_points
        self._ropes = self._make_ropes()
        self._reel_limits = world.robot.speed_max
        self._step_limits = self._reel_limits * self.dt + _ROUNDING
        self.rope_lengths: Array | None = None
        self._frame = _BodyFrame(self.robot)
        # Threshold 0: the default ends the iterations early, at a moment that depends on the motion.
        self._set(fixedTimeStep=self.dt, numSolverIterations=solver_iterations, solverResidualThreshold=0)
        self._bullet.setGravity(0, 0, -self.robot.gravity, physicsClientId=self._client)
        self._substeps = 1
        self._platform = self._make_platform()
        self._make_scene()
        self._legs: tuple[Leg, ...] = ()
        self.reset()

    # --- the interface ----------------------------------------------------------------------------
    def reset(self, pose: Pose | None = None) -> State:
        start = self.world.pose if pose is None else pose
        b, client = self._bullet, self._client
        for body in dict.fromkeys(body for body, _ in self._legs):
            b.removeBody(body, physicsClientId=client)  # takes its constraints along
        b.resetBasePositionAndOrientation(self._platform, *self._frame.body_pose(start), physicsClientId=client)
        b.resetBaseVelocity(self._platform, [0, 0, 0], [0, 0, 0], physicsClientId=client)
        self._legs = () if self.cables == "force" else self._make_legs(start)
        self._constraints = [self._tie(*leg, i) for i, leg in enumerate(self._legs)]
        self._cut = np.zeros(self.robot.n_cables, dtype=bool)
        self._any_cut = False
        self._push: Array | None = None
        self._steps = 0
        self.tensions = np.zeros(self.robot.n_cables)
        self._reach = 5 * (1 + float(np.abs(self.robot.exit_points).max() + np.abs(start.position).max()))
        self._read()
        self._ropes = self._make_ropes()  # anew: which ropes were taut is the last flight's memory
        self.rope_lengths = self._wound_at_rest() if self._ropes is not None else None
        return self.state()

    def step(self, tensions: Array, substeps: int = 1) -> None:
        if self._ropes is not None:
            raise InvalidInput(f"cables={self.cables!r} takes rope lengths: use wind(lengths), not step(tensions)")
        self._pulled(tensions, substeps)

    def wind(self, lengths: ArrayLike, substeps: int = 1) -> bool:
        """Advance by ``substeps`` × dt while the winches bring the ropes evenly to these lengths.

        lengths : (m,) at the end of the last substep [m]
        Returns False where a winch's speed limit kept a rope from its length.
        Raises InvalidInput unless ``cables`` is "length" or "elastic".
        """
        if self._ropes is None or self.rope_lengths is None:
            raise InvalidInput(f"cables={self.cables!r} takes tensions: use step(tensions), or open the simulator "
                               "with cables=\"length\"")
        before = self.rope_lengths
        after = self._reachable(np.asarray(lengths, dtype=float), before, self.dt * substeps)
        for k in range(1, substeps):
            self._wound(before + k / substeps * (after - before))
        self._wound(after)
        return after is lengths or bool(np.array_equal(after, lengths))

    def _wound(self, lengths: Array) -> None:
        """One step, by whose end no rope is longer than this."""
        held = np.where(self._cut, self.lengths + _AMPLE, lengths) if self._any_cut else lengths
        assert self._ropes is not None and self.rope_lengths is not None
        self._pulled(self._ropes(self.wrench_matrix, self.rotation, self.twist, self.lengths, self.rope_lengths, held,
                                 self._push), 1)
        self.rope_lengths = lengths

    def _reachable(self, wanted: Array, now: Array, period: float) -> Array:
        """The wanted lengths as far as the winches' speed limits allow; the same array if they all do."""
        farthest = self._step_limits if period == self.dt else self._reel_limits * period + _ROUNDING
        if wanted.shape == now.shape and (np.abs(wanted - now) <= farthest).all():
            return wanted
        if wanted.shape != now.shape or not (np.isfinite(wanted).all() and wanted.min() > 0):
            raise InvalidInput(f"rope lengths must be {now.shape[0]} positive numbers [m], got {wanted.tolist()}")
        return now + np.clip(wanted - now, -farthest, farthest)

    def _pulled(self, tensions: Array, substeps: int) -> None:
        if substeps != self._substeps:
            self._set_substeps(substeps)
        if self._any_cut:
            tensions = np.where(self._cut, 0.0, tensions)
        if self._push is not None:
            self._apply(self._push)
        if self._legs:
            self._pull(tensions)
        else:
            self._apply(self.robot.pattern.basis(self.rotation) @ (self.wrench_matrix @ tensions))
        before = self.directions
        self._bullet.stepSimulation(self._client)
        self._steps += substeps
        self._read()
        # A reaction belongs to the geometry its (sub)step began with.
        self.tensions = (self._reactions(before if substeps == 1 else self.directions) if self._legs
                         else np.array(tensions))
        if self._ropes is not None:  # what a slack leg's tip weighs is no rope's tension
            self.tensions = np.maximum(self.tensions, 0.0)

    def state(self) -> State:
        return State(self._steps * self.dt, self.robot, self.position, self.rotation, self.twist, self.tensions)

    def cut(self, cables: ArrayLike | None = None) -> None:
        m = self.robot.n_cables
        indices = range(m) if cables is None else np.atleast_1d(np.asarray(cables, dtype=int)).tolist()
        for i in indices:
            if not 0 <= i < m:
                raise InvalidInput(f"cables to cut are given by index, 0 to {m - 1}, got {i}")
            if self._constraints and not self._cut[i]:
                self._bullet.removeConstraint(self._constraints[i], physicsClientId=self._client)
                self._constraints[i] = -1
            self._cut[i] = self._any_cut = True

    def push(self, wrench: ArrayLike) -> None:
        given = as_array(wrench, "external wrench", (self.robot.n_dof,), "N, N m")
        self._push = self.robot.pattern.basis(self.rotation) @ given if given.any() else None

    def contact_force(self) -> float:
        contacts = self._bullet.getContactPoints(bodyA=self._platform, physicsClientId=self._client)
        return float(sum(contact[9] for contact in contacts))

    def render(self, width: int = 640, height: int = 480) -> Any:
        from ..view.camera import Camera

        if self._camera is None:
            self._camera = Camera(self.world)
        tensions = np.where(self._cut, np.nan, self.tensions)
        return self._camera.picture(Pose.of(self.position, self.rotation), tensions, width, height,
                                    rope_lengths=self.rope_lengths)

    def close(self) -> None:
        if self._client >= 0:
            self._bullet.disconnect(physicsClientId=self._client)
            self._client = -1
        if self._camera is not None:
            self._camera.close()
            self._camera = None

    # --- every step -------------------------------------------------------------------------------
    def _pull(self, tensions: Array) -> None:
        control, torque, client = self._bullet.setJointMotorControl2, self._bullet.TORQUE_CONTROL, self._client
        for (leg, drum), tension in zip(self._legs, tensions.tolist()):
            # Joint torques last one step; positive lengthens the leg. All by position (targets and gains,
            # here unused, stand in between): PyBullet parses keywords in twice the time of the call.
            control(leg, drum, torque, 0.0, 0.0, -tension, 0.0, 0.0, 0.0, client)

    def _reactions(self, directions: Array) -> Array:
        """(m,) tensions of the last step: each constraint's force along its cable."""
        read, client = self._bullet.getConstraintState, self._client
        # Plain floats: eight products of three are cheaper so than through an array.
        # Bullet reports the force on the child, the leg's tip; the platform (parent) gets its opposite.
        if self._any_cut:
            forces = [read(constraint, client) if constraint >= 0 else _NOTHING for constraint in self._constraints]
        else:
            forces = [read(constraint, client) for constraint in self._constraints]
        return np.array([-(a * x + b * y + c * z) for (a, b, c), (x, y, z) in zip(forces, directions.tolist())])

    def _apply(self, wrench: Array) -> None:
        """A full wrench [f; m] at P in world axes, for the next step."""
        b, client = self._bullet, self._client
        force = wrench[:3].tolist()
        # Applied at P as a world point, so that Bullet adds the moment about the center of mass.
        b.applyExternalForce(self._platform, -1, force, self.position.tolist(), b.WORLD_FRAME, physicsClientId=client)
        if wrench[3:].any():
            b.applyExternalTorque(self._platform, -1, wrench[3:].tolist(), b.WORLD_FRAME, physicsClientId=client)

    def _read(self) -> None:
        b, client = self._bullet, self._client
        place, quaternion = b.getBasePositionAndOrientation(self._platform, client)
        linear, angular = b.getBaseVelocity(self._platform, client)
        x, y, z = place
        if not abs(x) + abs(y) + abs(z) < self._reach:  # also false for NaN
            self._diverged()
        matrix = b.getMatrixFromQuaternion(quaternion)
        # One array for all that was read: each conversion costs more than cutting it up.
        values = frozen(np.array(place + matrix + linear + angular))
        self.position, self.rotation, self.twist = values[:3], values[3:12].reshape(3, 3), values[12:]
        if not self._frame.is_platform_frame:
            self.position, self.rotation, self.twist = self._frame.to_platform(self.position, self.rotation, self.twist)
        self.directions, self.lengths, self.wrench_matrix = self._cables(self.position, self.rotation)

    def _cables(self, position: Array, rotation: Array) -> Cables:
        """`cables_at`, the exit points where they are now."""
        robot = self.world.robot
        lengths, W = compiled_cables(self._exits, robot.anchor_points, position[None], rotation[None])
        return Cables(W[0, :3].T, lengths[0], robot.pattern.project(W[0], rotation))

    def _diverged(self) -> None:
        now = self._steps * self.dt
        pulls = np.where(np.isfinite(self.tensions), np.abs(self.tensions), np.inf)
        worst = int(pulls.argmax())
        raise SimulationDiverged(
            f"the simulation diverged at t = {now:.4g} s: the platform left the scene; cable {worst + 1} carried "
            f"most, {self.tensions[worst]:.3g} N; take a smaller dt or lower gains (K_d times the control period "
            "must stay below 2)", now, worst + 1)

    def _set_substeps(self, substeps: int) -> None:
        if substeps < 1:
            raise InvalidInput(f"substeps must be at least 1, got {substeps}")
        # One engine call for all substeps: torques are held over them and Python waits once.
        self._substeps = substeps
        self._set(fixedTimeStep=self.dt * substeps, numSubSteps=substeps if substeps > 1 else 0)

    def _set(self, **parameters: Any) -> None:
        self._bullet.setPhysicsEngineParameter(**parameters, physicsClientId=self._client)

    # --- building ---------------------------------------------------------------------------------
    def _make_ropes(self) -> RopeLaw | None:
        if self.cables not in ("length", "elastic"):
            return None
        elasticity = self.robot.elasticity if self.cables == "elastic" else None
        if self.cables == "elastic" and elasticity is None:
            raise InvalidInput(f"cables=\"elastic\" needs the ropes' stiffness: world {self.world.name!r} has no "
                               "`cable: {axial_stiffness: …}` block")
        return rope_law(self.robot, self.dt, elasticity)

    def _wound_at_rest(self) -> Array:
        """(m,) rope lengths at which the robot hangs where it is: stretching ropes are wound shorter."""
        if self.cables == "length" or self.robot.elasticity is None:
            return self.lengths
        robot, pose = self.robot, Pose.of(self.position, self.rotation)
        held = distribute_tensions(self.wrench_matrix, gravity_wrench(robot, pose), robot.tension_min,
                                   robot.tension_max, "relaxed")
        return self.lengths / (1 + held.tensions / self.robot.elasticity.axial_stiffness)

    def _make_platform(self) -> int:
        b, client, body = self._bullet, self._client, self.robot.platform
        offset, turn = self._frame.to_body(body.center), self._frame.quaternion_to_body
        shape = b.createCollisionShape(b.GEOM_BOX, halfExtents=(body.size / 2).tolist(),
                                       collisionFramePosition=offset.tolist(), collisionFrameOrientation=turn,
                                       physicsClientId=client)
        platform = b.createMultiBody(body.mass, shape, physicsClientId=client)
        # Bullet's default damping of 0.04 would triple the tracking error.
        b.changeDynamics(platform, -1, localInertiaDiagonal=self._frame.principal.tolist(), linearDamping=0,
                         angularDamping=0, activationState=b.ACTIVATION_STATE_DISABLE_SLEEPING, physicsClientId=client)
        return int(platform)

    def _make_scene(self) -> None:
        b, client, scene = self._bullet, self._client, self.world.scene
        floor = b.createCollisionShape(b.GEOM_PLANE, physicsClientId=client)
        b.createMultiBody(0, floor, basePosition=[0, 0, scene.floor_height], physicsClientId=client)
        for box in scene.boxes:
            shape = b.createCollisionShape(b.GEOM_BOX, halfExtents=(box.size / 2).tolist(), physicsClientId=client)
            b.createMultiBody(0, shape, basePosition=box.position.tolist(),
                              baseOrientation=b.getQuaternionFromEuler([0, 0, box.yaw]), physicsClientId=client)

    def _make_legs(self, start: Pose) -> tuple[Leg, ...]:
        """One fixed-base multibody per cable: faster than one body with all joints."""
        anchors, middle = start.position + self.robot.anchor_points @ start.rotation.T, self._middle(start)
        return tuple((self._make_leg(exit_point, middle, anchor), 2)
                     for exit_point, anchor in zip(self.robot.exit_points, anchors))

    def _middle(self, start: Pose) -> Array:
        """Of where the platform is to be: legs aimed there keep their universal joints far from singular."""
        places = [self.world.pose.position, start.position]
        places += [end.position for task in self.world.tasks.values() for end in (task.start, task.end)]
        return np.mean(places, axis=0)

    def _make_leg(self, exit_point: Array, middle: Array, anchor: Array) -> int:
        b, client = self._bullet, self._client
        aim = turn_z_to(middle - exit_point)
        still = [0, 0, 0, 1]
        leg = b.createMultiBody(
            0, -1, basePosition=exit_point.tolist(), baseOrientation=aim,
            # All the mass sits at the tip without inertia: the constraint's three rows then decouple.
            linkMasses=[0, 0, self.tip_mass], linkCollisionShapeIndices=[-1] * 3, linkVisualShapeIndices=[-1] * 3,
            linkPositions=[[0, 0, 0]] * 3, linkOrientations=[still] * 3, linkInertialFramePositions=[[0, 0, 0]] * 3,
            linkInertialFrameOrientations=[still] * 3, linkParentIndices=[0, 1, 2],
            linkJointTypes=[b.JOINT_REVOLUTE, b.JOINT_REVOLUTE, b.JOINT_PRISMATIC],
            linkJointAxis=[[1, 0, 0], [0, 1, 0], [0, 0, 1]], physicsClientId=client)
        # Joints start with motors of 1000 N that would hold the robot in place.
        b.setJointMotorControlArray(leg, [0, 1, 2], b.VELOCITY_CONTROL, forces=[0, 0, 0], physicsClientId=client)
        # The default of 100 m/s caps the tension at 100 m_tip/dt. In a call of its own: given together with
        # a link's other settings, Bullet applies all of them to the base.
        b.changeDynamics(leg, -1, maxJointVelocity=1e9, physicsClientId=client)
        for link in range(-1, 3):
            b.changeDynamics(leg, link, linearDamping=0, angularDamping=0, jointDamping=0, physicsClientId=client)
        rotation = np.array(b.getMatrixFromQuaternion(aim)).reshape(3, 3)
        for joint, value in enumerate(leg_joints(rotation.T @ (anchor - exit_point))):
            b.resetJointState(leg, joint, value, physicsClientId=client)
        return int(leg)

    def _tie(self, leg: int, tip: int, i: int) -> int:
        """The platform as parent; pivots are in center-of-mass frames, and the tip's mass is its origin."""
        pivot = self._frame.to_body(self.robot.anchor_points[i]).tolist()
        b = self._bullet
        return int(b.createConstraint(self._platform, -1, leg, tip, b.JOINT_POINT2POINT, [0, 0, 0], pivot, [0, 0, 0],
                                      physicsClientId=self._client))


class _BodyFrame:
    """Bullet's body frame: at the center of mass, along the principal axes of inertia."""

    def __init__(self, robot: Robot) -> None:
        platform = robot.platform
        if np.count_nonzero(platform.inertia - np.diag(np.diag(platform.inertia))):
            self.principal, axes = np.linalg.eigh(platform.inertia)
            self.axes = axes * np.sign(np.linalg.det(axes))  # right-handed
        else:
            self.principal, self.axes = np.diag(platform.inertia).copy(), np.eye(3)
        self.center = platform.center_of_mass
        self.is_platform_frame = not self.center.any() and np.array_equal(self.axes, np.eye(3))

    @property
    def quaternion_to_body(self) -> list[float]:
        """Orientation of the platform frame seen from the body frame."""
        return quaternion_of(self.axes.T)

    def to_body(self, point: Array) -> Array:
        """A point of the platform frame in the body frame [m]."""
        return self.axes.T @ (point - self.center)

    def body_pose(self, pose: Pose) -> tuple[list[float], list[float]]:
        position = pose.position + pose.rotation @ self.center
        return position.tolist(), quaternion_of(pose.rotation @ self.axes)

    def to_platform(self, place: Array, rotation: Array, twist: Array) -> tuple[Array, Array, Array]:
        """Position of P, platform rotation and twist of P from the body's."""
        turned = frozen(rotation @ self.axes.T)
        arm = turned @ self.center
        velocity = twist[:3] - np.cross(twist[3:], arm)
        return frozen(place - arm), turned, frozen(np.concatenate([velocity, twist[3:]]))


@cache
def import_pybullet() -> Any:
    """The engine, its start-up banner kept off the terminal; raises MissingDependency naming the ways out."""
    try:
        with quiet():
            import pybullet
    except ImportError:
        raise MissingDependency(
            "spatial worlds run in PyBullet, which is not installed; it has wheels for Linux x86-64 and Python up to "
            "3.11: use `uv venv --python 3.11`, `conda create -n cdprlab python=3.11` or the python:3.11 container, "
            "then `pip install pybullet` (planar worlds, tensions and sets work without it)") from None
    return pybullet


@contextlib.contextmanager
def quiet() -> Iterator[None]:
    """Silence C code that prints: Python's own redirection does not reach file descriptors 1 and 2."""
    libc = ctypes.CDLL(None)
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(Exception):
            stream.flush()
    saved, nothing = [os.dup(1), os.dup(2)], os.open(os.devnull, os.O_WRONLY)
    libc.fflush(None)
    try:
        os.dup2(nothing, 1)
        os.dup2(nothing, 2)
        yield
    finally:
        libc.fflush(None)  # C buffers its output; it must leave before the descriptors come back
        for descriptor, copy in zip((1, 2), saved):
            os.dup2(copy, descriptor)
            os.close(copy)
        os.close(nothing)


def quaternion_of(rotation: Array) -> list[float]:
    from scipy.spatial.transform import Rotation

    quaternion: list[float] = Rotation.from_matrix(rotation).as_quat().tolist()
    return quaternion


def turn_z_to(direction: Array) -> list[float]:
    """Quaternion of the shortest turn from the z axis to a direction."""
    x, y, z = direction / np.linalg.norm(direction)
    if z < -1 + 1e-9:
        return [1.0, 0.0, 0.0, 0.0]
    scale = math.sqrt(2 * (1 + z))
    return [-y / scale, x / scale, 0.0, scale / 2]


def leg_joints(vector: Array) -> tuple[float, float, float]:
    """Joint values (a, b, ρ) with Rx(a) Ry(b) [0, 0, ρ] = vector, in the leg's base frame."""
    length = float(np.linalg.norm(vector))
    x, y, z = (vector / length).tolist()
    return math.atan2(-y, z), math.asin(x), length
