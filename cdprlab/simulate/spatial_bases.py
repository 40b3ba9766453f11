"""Mobile bases as bodies in PyBullet: they stand on wheels, drive, tip over, and carry their cables' legs.

A base hangs on six joints of its own, two along the floor, one about the vertical, one up, two
to tilt, so that driving is commanded exactly while rising and tilting are left to physics. Its
wheels are spheres without friction: driving is the joints' business, and a sphere touches at
the one point the footprint names. Everything of a base, legs included, is one multibody, which
Bullet solves without the slip a constraint between bodies would bring.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_array, frozen
from ..errors import InvalidInput
from ..robot import Base, Robot
from ..robot.parts import box_inertia
from .bullet import ORIGIN, STRAIGHT, Bullet, Link, turn_z_to
from .legs import Leg, leg_joints, leg_links

_ALONG, _ACROSS, _ABOUT, _BODY = 0, 1, 2, 6   # joints that drive, and the link that is the base
_WHEEL = 0.05      # m
_TRACTION = 0.8    # of the weight: the most the drives push with, rubber on concrete
_WORLD = (*np.eye(3).ravel(), 0.0, 0.0, 0.0)   # rotation and place of what stands still
_GAINS = 0.1, 1.0, 0.0    # of a speed motor, as PyBullet has them; named ones take twice the time of the call


class SpatialBases:
    """The bases of a robot that are bodies, steered within limits, coupled by a link, their wheels weighed.

    robot : whose bases stand; until they are built nothing moves
    is_stabilized : whether they stand on feet, which are where the wheels are: then none drives
    bodies : of the bases, in file order
    frames : (p, 3, 4) rotation and center of mass of each, None where none is a body
    exits : (m, 3) exit points now [m]; exit_steps : (m, 3) how far they, on pulleys the tangent
        points, went with the bases in the last step [m]
    pulleys : (m or 0, 4) as `Robot.pulleys` has them, now
    shifts : (m, 3) from exit to tangent points as last seen, if there are pulleys [m]
    """

    def __init__(self, bullet: Bullet, robot: Robot, tip_mass: float) -> None:
        self._bullet, self._robot, self._tip_mass = bullet, robot, tip_mass
        # The exit points and the pulleys' axes by [R c]ᵀ of every base and, last, of the world, one on the other.
        m, centers = robot.n_cables, [base.center_of_mass for base in robot.bases] + [np.zeros(3)]
        mounted, axes = np.zeros((2, m, len(centers), 4))
        for i, (cable, k) in enumerate(zip(robot.cables, robot.base_indices)):
            mounted[i, k] = *(cable.exit_point - centers[k]), 1.0
            if cable.pulley is not None:
                axes[i, k, :3] = cable.pulley.axis
        self._mounted, self._axes = mounted.reshape(m, -1), axes.reshape(m, -1)
        self.bodies: list[int] = []
        self.frames: Any = None
        self.exits, self.pulleys = robot.exit_points, robot.pulleys
        self.exit_steps = np.zeros_like(robot.exit_points)
        self._poses: Array | None = frozen(np.array([base.pose for base in robot.bases]).reshape(-1, 3))

    def build(self, anchors: Array, middle: Array) -> dict[int, Leg]:
        """Anew where the world puts them; returns the leg of each of their cables, by its index.

        anchors : (m, 3) [m]; middle : (3,) of where the platform is to be [m]
        """
        robot, legs, self.bodies = self._robot, {}, []
        self._link, self.is_stabilized, self._speeds = -1, False, np.zeros_like(self._robot.base_speed_max)
        self._targets = [list(base.pose) for base in robot.bases]
        for k, base in enumerate(robot.bases):
            cables = [i for i, of in enumerate(robot.base_indices) if of == k]
            exits = [robot.cables[i].exit_point for i in cables]
            body = _add_base(self._bullet, base, exits, anchors[cables], middle, self._tip_mass)
            self.bodies.append(body)
            legs.update({i: (body, _BODY + 3 * (place + 1)) for place, i in enumerate(cables)})
        self.exits, self.shifts = robot.exit_points, np.zeros((robot.n_cables, 3))
        self._frames = np.zeros((len(robot.bases) + 1, 3, 4))
        self.look()
        return legs

    # --- every step
    # -------------------------------------------------------------------------------
    def steer(self, period: float) -> None:
        """Let the motors drive on for so long [s]."""
        b, client = self._bullet
        control, speed = b.setJointMotorControl2, b.VELOCITY_CONTROL
        for k, (base, body, goal, now, (spin, along, across)) in enumerate(zip(
                self._robot.bases, self.bodies, self._targets, self.poses.tolist(),
                self._speeds.reshape(-1, 3).tolist())):
            towed = self.is_coupled and k == 1
            force = 0.0 if towed else _TRACTION * base.mass * self._robot.gravity
            heading = goal[2] + spin * period / 2
            c, s = math.cos(heading), math.sin(heading)
            for joint, rate in ((_ALONG, c * along - s * across),
                                (_ACROSS, s * along + c * across), (_ABOUT, spin)):
                # Bullet's own position motors lag behind where a step has substeps: half of
                # what is missing a step.
                missing = (goal[joint] - now[joint]) / (2 * period)
                goal[joint] += rate * period
                control(body, joint, speed, 0.0, missing + rate, force, *_GAINS, client)

    def look(self) -> None:
        """See where they have come to."""
        self._poses = None
        b, client = self._bullet
        rows = []
        for body in self.bodies:
            place, quaternion = b.getLinkState(body, _BODY, 0, 1, client)[:2]
            rows.append(b.getMatrixFromQuaternion(quaternion) + place)
        # Per base and, last, of the world, rotation and center of mass side by side.
        values = np.array([*rows, _WORLD])
        frames = np.concatenate([values[:, :9].reshape(-1, 3, 3), values[:, 9:, None]], axis=2)
        stacked = frames.swapaxes(1, 2).reshape(-1, 3)
        exits = self._mounted @ stacked
        self.exit_steps = exits - self.exits
        if self.pulleys.size:   # the tangent point as a point of the base
            before, after = (part[list(self._robot.base_indices), :, :3] for part in (self._frames, frames))
            self.exit_steps += ((after - before) @ (before.swapaxes(1, 2) @ self.shifts[:, :, None]))[:, :, 0]
            self.pulleys = frozen(np.column_stack([self.pulleys[:, 0], self._axes @ stacked]))
        self._frames, self.frames, self.exits = frames, frozen(frames)[:-1], frozen(exits)

    def press(self, forces: Array, points: Array) -> None:
        """Let the coming engine call press on the cables' bases with these (m, 3) forces at points [N, m]."""
        b, client = self._bullet
        for force, point, k in zip(forces.tolist(), points.tolist(), self._robot.base_indices):
            if k >= 0:
                b.applyExternalForce(self.bodies[k], _BODY, force, point, b.WORLD_FRAME, client)

    # --- the interface
    # ----------------------------------------------------------------------------
    @property
    def poses(self) -> Array:
        """(p, 3) x, y and heading of each base [m, rad]."""
        if self._poses is None:
            read, client = self._bullet.engine.getJointStates, self._bullet.client
            self._poses = frozen(np.array([[state[0] for state in read(body, (_ALONG, _ACROSS, _ABOUT), client)]
                                           for body in self.bodies]))
        return self._poses

    @property
    def tilts(self) -> Array:
        """(p,) angle of each base's mast from the vertical [rad]."""
        return np.arccos(np.minimum(self.frames[:, 2, 2], 1.0))

    def wheel_loads(self, substeps: int) -> dict[str, Array]:
        """Base name → (k,) normal force on each footprint contact, in file order [N].

        substeps : of the last engine call
        """
        loads = {}
        for base, body, frame in zip(self._robot.bases, self.bodies, self.frames):
            feet = base.footprint - base.center_of_mass[:2]
            touched = self._bullet.getContactPoints(bodyA=body, linkIndexA=_BODY)
            points = (np.reshape([contact[5] for contact in touched], (-1, 3)) - frame[:, 3]) @ frame[:, :2]
            nearest = ((feet[:, None] - points)**2).sum(axis=2).argmin(axis=0)
            forces: Any = np.bincount(nearest, [contact[9] for contact in touched], len(feet))
            loads[base.name] = forces * float(substeps)   # Bullet divides a substep's impulse by the whole step
        return loads

    def drive(self, speeds: ArrayLike) -> Array:
        """Drive on at these (3p,) speeds; returns them as their limits allow [rad/s, m/s]."""
        if not self.bodies:
            raise InvalidInput("SpatialSimulator has no bases that drive: planar worlds have")
        wanted = as_array(speeds, "base speeds", self._robot.base_speed_max.shape, "rad/s, m/s")
        fastest = np.zeros_like(wanted) if self.is_stabilized else self._robot.base_speed_max
        self._speeds = wanted.clip(-fastest, fastest)
        return self._speeds

    @property
    def is_coupled(self) -> bool:
        """Whether the link is closed."""
        return self._link >= 0

    def couple(self) -> None:
        """Close the electromagnetic link: the second base then goes where the first one drives.

        Raises InvalidInput unless there are two bases.
        """
        if len(self.bodies) != 2:
            raise InvalidInput(f"the link couples two bases, this robot has {len(self.bodies)}")
        if not self.is_coupled:
            self._link = self._bullet.fix(self.bodies[0], _BODY, self.bodies[1], _BODY)

    def uncouple(self) -> None:
        """Open the link; the second base stands where it then is."""
        if self.is_coupled:
            self._bullet.removeConstraint(self._link)
            self._targets[1] = self.poses[1].tolist()
            self._link = -1

    def lock(self, platform: int) -> None:
        """Fix the platform to the first base until the next reset, as for a drive on which no cable moves."""
        self._bullet.fix(self.bodies[0], _BODY, platform, -1)

    def lower_stabilizers(self) -> None:
        """Stand on feet: every base stays as it is, and does not drive."""
        self.is_stabilized = True
        self._speeds = np.zeros_like(self._speeds)
        self._targets = self.poses.tolist()

    def raise_stabilizers(self) -> None:
        """Stand on wheels again."""
        self.is_stabilized = False


def _add_base(bullet: Bullet, base: Base, exits: list[Array], anchors: Array, middle: Array, tip_mass: float) -> int:
    """The body of a base where the world puts it, its legs reaching to the anchor points.

    exits : (3,) of its cables, in its own frame [m]; anchors, middle : in the world [m]
    """
    com, n = base.center_of_mass, len(base.footprint)
    wheels = bullet.createCollisionShapeArray(
        shapeTypes=[bullet.GEOM_SPHERE] * n, radii=[_WHEEL] * n,
        collisionFramePositions=[[x - com[0], y - com[1], _WHEEL - com[2]] for x, y in base.footprint.tolist()])
    slide, swing = bullet.JOINT_PRISMATIC, bullet.JOINT_REVOLUTE
    free = [(slide, [1, 0, 0]), (slide, [0, 1, 0]), (swing, [0, 0, 1]),
            (slide, [0, 0, 1]), (swing, [1, 0, 0]), (swing, [0, 1, 0])]
    links: list[Link] = [(0.0, -1, ORIGIN, STRAIGHT, k, kind, axis) for k, (kind, axis) in enumerate(free)]
    links.append((base.mass, wheels, com.tolist(), STRAIGHT, _BODY, bullet.JOINT_FIXED, [0, 0, 1]))
    joints = [*base.pose, 0.0, 0.0, 0.0, 0.0]
    seen, ends = ((points - base.origin) @ base.rotation for points in (middle, anchors))   # in the base's frame
    for exit_point, anchor in zip(exits, ends):
        aim = turn_z_to(seen - exit_point)
        links += leg_links(bullet, tip_mass, len(links), _BODY + 1, (exit_point - com).tolist(), aim)
        joints += leg_joints(bullet, aim, anchor - exit_point)
    body = bullet.add_chain(links, joints)
    # Of a box over the footprint, twice as high as its center of mass.
    inertia = box_inertia(base.mass, (*np.ptp(base.footprint, axis=0), 2 * com[2]))
    bullet.changeDynamics(body, _BODY, localInertiaDiagonal=inertia.diagonal().tolist())
    bullet.changeDynamics(body, _BODY, lateralFriction=0.0)
    return body
