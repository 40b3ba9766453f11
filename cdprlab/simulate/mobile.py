"""Spatial worlds whose mobile bases are bodies: they stand on wheels, drive, tip over, and carry their cables' legs.

A base hangs on six joints of its own, two along the floor, one about the vertical, one up, two to tilt, so that driving
is commanded exactly while rising and tilting are left to physics. Its wheels are spheres without friction: driving is
the joints' business, and a sphere touches at the one point the footprint names. Everything of a base, legs included,
is one multibody, which Bullet solves without the slip a constraint between bodies would bring.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_array, frozen
from ..control import State
from ..errors import InvalidInput
from ..fast_statics import CYCLE, CableStatics, cyclic
from ..pose import Pose
from ..robot import Base, Robot
from ..world import World
from .ropes import RopeLaw, rope_law
from .spatial import Leg, SpatialSimulator, leg_joints, quaternion_of, turn_z_to

_ALONG, _ACROSS, _ABOUT, _BODY = 0, 1, 2, 6  # joints that drive, and the link that is the base
_WHEEL = 0.05      # m
_TRACTION = 0.8    # of the weight: the most the drives push with, rubber on concrete
_STRAIGHT = [0, 0, 0, 1]
_ORIGIN = [0, 0, 0]


class MobileSimulator(SpatialSimulator):
    """A spatial world in which bases with a footprint are bodies of their own.

    world, cables, dt, tip_mass : as `SpatialSimulator`
    solver_iterations : 50; wheels on the floor are contacts, which want more than cables do
    """

    def __init__(self, world: World, cables: str = "tension", dt: float = 1e-3, *, tip_mass: float = 1e-4,
                 solver_iterations: int = 50) -> None:
        if cables == "force" or not world.robot.bases:
            raise InvalidInput("bases that stand and tip need a world with bases and cables that are bodies too: "
                               "\"tension\", \"length\" or \"elastic\"")
        self._bodies: list[int] = []
        self._boxes: dict[str, int] = {}
        self._grips: dict[str, int] = {}
        self._drawn: dict[str, tuple[Array, Array]] = {}
        self._box_sizes: dict[str, Array] = {}
        self._carried: list[tuple[int, list[int], Array]] = []
        self._targets = _places(world.robot)
        self._feet = {base.name: np.insert(base.footprint, 2, 0.0, axis=1) - base.center_of_mass
                      for base in world.robot.bases}
        super().__init__(world, cables, dt, tip_mass=tip_mass, solver_iterations=solver_iterations)

    # --- the interface ----------------------------------------------------------------------------
    def reset(self, pose: Pose | None = None) -> State:
        self._link, self._speeds = -1, np.zeros(3 * len(self.world.robot.bases))
        for name in list(self._grips):
            self.release(name)
        self._targets = _places(self.world.robot)
        self._present: Robot | None = None
        self._standing: Array | None = None
        self._bodies, self._carried = [], []
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
        b, client = self._bullet, self._client
        if not self._bodies:
            return self._targets
        if self._standing is None:
            self._standing = frozen(np.array([
                [b.getJointState(body, joint, client)[0] for joint in (_ALONG, _ACROSS, _ABOUT)]
                for body in self._bodies]))
        return self._standing

    @property
    def exit_velocities(self) -> Array:
        """(m, 3) of the exit points during the last step [m/s]."""
        return self._exit_steps.T / (self.dt * self._substeps)

    def cables_at(self, pose: Pose) -> CableStatics:
        """Directions, wrench matrix and lengths if the platform were at a pose, the bases where they are."""
        return self._statics(*cyclic(pose.position, pose.rotation))

    @property
    def tilts(self) -> Array:
        """(p,) angle of each base's mast from the vertical [rad]."""
        return np.array([np.arccos(np.clip(self._placed(body)[1][2, 2], -1, 1)) for body in self._bodies])

    def wheel_loads(self) -> dict[str, Array]:
        """Base name → (k,) normal force on each footprint contact, in file order [N]."""
        loads = {}
        for base, body in zip(self.world.robot.bases, self._bodies):
            place, turn = self._placed(body)
            corners = place + self._feet[base.name] @ turn.T
            force = np.zeros(len(corners))
            contacts = self._bullet.getContactPoints(bodyA=body, linkIndexA=_BODY, physicsClientId=self._client)
            if contacts:
                points = np.array([contact[5] for contact in contacts])
                nearest = ((points[:, None] - corners)**2).sum(axis=2).argmin(axis=1)
                # Bullet divides a substep's impulse by the whole step.
                np.add.at(force, nearest, [contact[9] * self._substeps for contact in contacts])
            loads[base.name] = force
        return loads

    def drive(self, speeds: ArrayLike) -> Array:
        wanted = as_array(speeds, "base speeds", (self._speeds.size,), "rad/s, m/s")
        limits = np.concatenate([base.speed_max for base in self.world.robot.bases])
        self._speeds = np.clip(wanted, -limits, limits)
        return self._speeds

    def couple(self) -> None:
        """Close the electromagnetic link: the second base then goes where the first one drives.

        Raises InvalidInput unless there are two bases.
        """
        if len(self._bodies) != 2:
            raise InvalidInput(f"the link couples two bases, this robot has {len(self._bodies)}")
        if self._link < 0:
            self._link = self._fixed(self._bodies[0], _BODY, self._bodies[1], _BODY)

    def uncouple(self) -> None:
        """Open the link; the second base stands where it then is."""
        if self._link >= 0:
            self._bullet.removeConstraint(self._link, physicsClientId=self._client)
            self._targets[1] = self.base_poses[1]
            self._link = -1

    @property
    def is_coupled(self) -> bool:
        """Whether the link is closed."""
        return self._link >= 0

    # --- boxes and the gripper --------------------------------------------------------------------
    def add_box(self, name: str, position: ArrayLike, size: ArrayLike, mass: float, yaw: float = 0.0,
                friction: float = 0.5) -> None:
        """Put a loose box into the world.

        position : (3,) of its center [m]; size : (3,) [m]; mass : [kg]; yaw : [rad]
        friction : the box's factor of the coefficient of friction; boards and floor have 0.5
        """
        if name in self._boxes:
            raise InvalidInput(f"there is a box {name!r} already")
        b, client = self._bullet, self._client
        half = (as_array(size, "size", (3,), "m") / 2).tolist()
        shape = b.createCollisionShape(b.GEOM_BOX, halfExtents=half, physicsClientId=client)
        place = as_array(position, "position", (3,), "m").tolist()
        self._boxes[name] = int(b.createMultiBody(mass, shape, basePosition=place, physicsClientId=client,
                                                  baseOrientation=b.getQuaternionFromEuler([0, 0, yaw])))
        b.changeDynamics(self._boxes[name], -1, lateralFriction=friction, physicsClientId=client)
        self._box_sizes[name] = 2 * np.array(half)

    def box_pose(self, name: str) -> Pose:
        """Where a loose box is."""
        place, turn = self._bullet.getBasePositionAndOrientation(self._box(name), self._client)
        matrix = np.array(self._bullet.getMatrixFromQuaternion(turn)).reshape(3, 3)
        return Pose.of(np.array(place), matrix)

    def grip(self, name: str) -> None:
        """Hold a loose box at the platform, as they are to each other now."""
        if name not in self._grips:
            # What is held must not also push: platform and box overlap where the box lies in the tray.
            self._collide(name, False)
            (pa, ra), (pb, rb) = self._placed(self._platform, -1), self._placed(self._box(name), -1)
            self._drawn[name] = ra.T @ (pb - pa), ra.T @ rb
            self._grips[name] = self._fixed(self._platform, -1, self._box(name), -1)

    def draw(self, name: str, stroke: ArrayLike) -> None:
        """Let the gripper hold a gripped box off the place where it was gripped.

        stroke : (3,) in platform axes, a little more every step or the box is torn away [m]
        """
        if name not in self._grips:
            raise InvalidInput(f"box {name!r} is not gripped; gripped are {', '.join(self._grips) or 'none'}")
        pivot = self._drawn[name][1].T @ -as_array(stroke, "stroke", (3,), "m")
        self._bullet.changeConstraint(self._grips[name], jointChildPivot=pivot.tolist(), physicsClientId=self._client)

    def is_gripped(self, name: str) -> bool:
        """Whether a loose box is held at the platform."""
        return name in self._grips

    def carry(self, robot: Robot) -> None:
        """Let ropes of commanded length know what hangs on them; tensions need not be told.

        robot : the world's with the payload it carries now
        """
        if self._ropes is not None:
            elasticity = robot.elasticity if self.cables == "elastic" else None
            self._ropes = self._paid_out(rope_law(robot, self.dt, elasticity))

    def release(self, name: str) -> None:
        """Let a box go."""
        if name in self._grips:
            self._bullet.removeConstraint(self._grips.pop(name), physicsClientId=self._client)

    def _box(self, name: str) -> int:
        if name not in self._boxes:
            raise InvalidInput(f"there is no box {name!r}; there are {', '.join(self._boxes) or 'none'}")
        return self._boxes[name]

    def _collide(self, name: str, wanted: bool) -> None:
        self._bullet.setCollisionFilterPair(self._platform, self._box(name), -1, -1, int(wanted),
                                            physicsClientId=self._client)

    def _fixed(self, a: int, link_a: int, b: int, link_b: int) -> int:
        """Hold b at a as they are now; frames are in centers of mass."""
        (pa, ra), (pb, rb) = self._placed(a, link_a), self._placed(b, link_b)
        engine = self._bullet
        constraint = engine.createConstraint(
            a, link_a, b, link_b, engine.JOINT_FIXED, [0, 0, 0], (ra.T @ (pb - pa)).tolist(), [0, 0, 0],
            parentFrameOrientation=quaternion_of(ra.T @ rb), physicsClientId=self._client)
        return int(constraint)

    # --- every step -------------------------------------------------------------------------------
    def _pulled(self, tensions: Array, substeps: int) -> None:
        self._steer(self.dt * substeps)
        super()._pulled(tensions, substeps)

    def _steer(self, period: float) -> None:
        control, b, client, now = self._bullet.setJointMotorControl2, self._bullet, self._client, self.base_poses
        for k, (base, body) in enumerate(zip(self.world.robot.bases, self._bodies)):
            spin, along, across = self._speeds[3 * k:3 * k + 3].tolist()
            towed = self.is_coupled and k == 1
            heading = self._targets[k, 2] + spin * period / 2
            c, s = np.cos(heading), np.sin(heading)
            rates = (c * along - s * across, s * along + c * across, spin)
            # Bullet's own position motors lag behind where a step has substeps: half of what is missing a step.
            missing = (self._targets[k] - now[k]) / (2 * period)
            self._targets[k] += np.array(rates) * period
            force = 0.0 if towed else _TRACTION * base.mass * self.world.robot.gravity
            for joint, rate in zip((_ALONG, _ACROSS, _ABOUT), (missing + rates).tolist()):
                control(body, joint, b.VELOCITY_CONTROL, targetVelocity=rate, force=force, physicsClientId=client)

    def _make_ropes(self) -> RopeLaw | None:
        law = super()._make_ropes()
        return None if law is None else self._paid_out(law)

    def _paid_out(self, law: RopeLaw) -> RopeLaw:
        """The law of ropes whose exit points move: a base that drives away in the step needs that much more rope."""
        def tensions(W: Array, rotation: Array, twist: Array, lengths: Array, now: Array, wound: Array,
                     push: Any) -> Array:
            leaving = (self.directions * self._exit_steps.T).sum(axis=1)
            return law(W, rotation, twist, lengths, now, wound - leaving, push)

        return tensions

    def _read(self) -> None:
        self._present = self._standing = None
        before = self._exits[:3].copy()
        for body, columns, local in self._carried:
            place, turn = self._placed(body)
            self._exits[:, columns] = (place[:, None] + turn @ local)[CYCLE]
        self._exit_steps = self._exits[:3] - before
        super()._read()

    def _placed(self, body: int, link: int = _BODY) -> tuple[Array, Array]:
        """Center of mass and rotation of a link, or of a body's base (−1)."""
        b, client = self._bullet, self._client
        place, turn = (b.getBasePositionAndOrientation(body, client) if link < 0 else
                       b.getLinkState(body, link, 0, 1, client)[:2])
        return np.array(place), np.array(b.getMatrixFromQuaternion(turn)).reshape(3, 3)

    def render(self, width: int = 640, height: int = 480) -> Any:
        from .camera import Camera

        if self._camera is None:
            self._camera = Camera(self.world)
        tensions = np.where(self._cut, np.nan, self.tensions)
        boxes = [(self.box_pose(name), self._box_sizes[name]) for name in self._boxes]
        return self._camera.picture(Pose.of(self.position, self.rotation), tensions, width, height,
                                    rope_lengths=self.rope_lengths, robot=self.robot, boxes=boxes, tray=bool(boxes))

    # --- building ---------------------------------------------------------------------------------
    def _make_legs(self, start: Pose) -> tuple[Leg, ...]:
        robot, middle = self.world.robot, self._middle(start)
        anchors = start.position + robot.anchor_points @ start.rotation.T
        legs: dict[int, Leg] = {}
        self._bodies, self._carried = [], []
        for base in robot.bases:
            cables = [i for i, cable in enumerate(robot.cables) if cable.base == base.name]
            body = self._make_base(base, cables, middle, anchors)
            local = np.array([robot.cables[i].exit_point - base.center_of_mass for i in cables]).reshape(-1, 3).T
            self._bodies.append(body)
            self._carried.append((body, cables, local))
            legs.update({i: (body, _BODY + 3 * (k + 1)) for k, i in enumerate(cables)})
        for i, cable in enumerate(robot.cables):
            if cable.base is None:
                legs[i] = (self._make_leg(robot.exit_points[i], middle, anchors[i]), 2)
        return tuple(legs[i] for i in range(robot.n_cables))

    def _make_base(self, base: Base, cables: list[int], middle: Array, anchors: Array) -> int:
        b, client = self._bullet, self._client
        com, turn = base.center_of_mass, base.rotation
        wheels = b.createCollisionShapeArray(
            shapeTypes=[b.GEOM_SPHERE] * len(base.footprint), radii=[_WHEEL] * len(base.footprint),
            collisionFramePositions=[[x - com[0], y - com[1], _WHEEL - com[2]] for x, y in base.footprint.tolist()],
            physicsClientId=client)
        slide, swing = b.JOINT_PRISMATIC, b.JOINT_REVOLUTE
        # (mass, shape, place in the parent, orientation, parent, joint, axis)
        links: list[Any] = [(0, -1, _ORIGIN, _STRAIGHT, k, kind, axis) for k, (kind, axis) in enumerate([
            (slide, [1, 0, 0]), (slide, [0, 1, 0]), (swing, [0, 0, 1]),
            (slide, [0, 0, 1]), (swing, [1, 0, 0]), (swing, [0, 1, 0])])]
        links.append((base.mass, wheels, com.tolist(), _STRAIGHT, _BODY, b.JOINT_FIXED, [0, 0, 1]))
        values = [*base.position.tolist(), base.heading, 0.0, 0.0, 0.0, 0.0]
        for i in cables:
            exit_point = self.world.robot.exit_points[i]
            aim = turn.T @ (middle - exit_point)
            frame = turn_z_to(aim)
            first = len(links)
            local = (self.world.robot.cables[i].exit_point - com).tolist()
            links += [(0, -1, local, frame, _BODY + 1, swing, [1, 0, 0]), (0, -1, _ORIGIN, _STRAIGHT, first + 1, swing,
                                                                          [0, 1, 0]),
                      (self.tip_mass, -1, _ORIGIN, _STRAIGHT, first + 2, slide, [0, 0, 1])]
            axes = np.array(b.getMatrixFromQuaternion(frame)).reshape(3, 3)
            values += leg_joints(axes.T @ turn.T @ (anchors[i] - exit_point))
        mass, shapes, places, turns, parents, kinds, axes_ = map(list, zip(*links))
        body = int(b.createMultiBody(
            0, -1, basePosition=_ORIGIN, linkMasses=mass, linkCollisionShapeIndices=shapes,
            linkVisualShapeIndices=[-1] * len(links), linkPositions=places, linkOrientations=turns,
            linkInertialFramePositions=[_ORIGIN] * len(links), linkInertialFrameOrientations=[_STRAIGHT] * len(links),
            linkParentIndices=parents, linkJointTypes=kinds, linkJointAxis=axes_, physicsClientId=client))
        b.setJointMotorControlArray(body, list(range(len(links))), b.VELOCITY_CONTROL, forces=[0] * len(links),
                                    physicsClientId=client)
        b.changeDynamics(body, -1, maxJointVelocity=1e9, physicsClientId=client)
        for link in range(-1, len(links)):
            b.changeDynamics(body, link, linearDamping=0, angularDamping=0, jointDamping=0, physicsClientId=client)
        b.changeDynamics(body, _BODY, localInertiaDiagonal=_inertia(base), physicsClientId=client)
        b.changeDynamics(body, _BODY, lateralFriction=0.0, physicsClientId=client)
        for joint, value in enumerate(values):
            b.resetJointState(body, joint, value, physicsClientId=client)
        return body


def _places(robot: Robot) -> Array:
    """(p, 3) x, y and heading of each base [m, rad]."""
    return np.array([[*base.position, base.heading] for base in robot.bases])


def _inertia(base: Base) -> list[float]:
    """Of a uniform box over the footprint, twice as high as its center of mass [kg m²]."""
    x, y = np.ptp(base.footprint, axis=0)
    z = 2 * base.center_of_mass[2]
    return (base.mass / 12 * np.array([y * y + z * z, x * x + z * z, x * x + y * y])).tolist()
