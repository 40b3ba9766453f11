"""PyBullet behind the `Simulator` interface: spatial worlds, their cables legs, forces or ropes."""

from itertools import chain
from struct import Struct
from typing import Annotated, Any
from warnings import warn

import numpy as np

from ..arrays import Array, as_count, checked, frozen
from ..errors import CdprWarning, InvalidInput
from ..mechanics.cables import Cables, straight_lengths
from ..robot.pose import Pose
from ..world import World
from .boxes import Boxes
from .bullet import Bullet, import_pybullet, quaternion_of
from .legs import Legs, fixed_leg
from .simulator import Simulator
from .spatial_bases import SpatialBases

_FELT = 0.01   # of the platform's mass: what its cables' tips may weigh
_TOLD = 1e-12  # of it: what they must weigh to be told apart from nothing beside it, in double precision


def closed(*_: Any) -> Any:
    """In the place of what an engine does, once it is closed."""
    raise InvalidInput("this simulator is closed: open another one")


class SpatialSimulator(Simulator):
    """A spatial world in a PyBullet client of its own.

    world : a spatial World
    cables : "tension" (UPS legs), "force" (external forces on the platform), "length" (UPS legs
        that pull as ropes wound to a length do) or "elastic" (such ropes, that stretch as the
        world's ``cable:`` block says)
    dt : time step [s]
    bodies : whether mobile bases are bodies that stand on wheels, drive and tip
    tip_mass : point mass at each leg's tip, 1e-12 of the platform's at least [kg]; the tension
        error is about tip_mass (g + a)
    solver_iterations : of Bullet's constraint solver; for cables 5 give the digits of 200,
        contacts want 10 to 50

    Its parts are public: ``bullet`` and ``platform``, the engine and the body; ``bases``;
    ``boxes``, none at first. ``carrying`` is the robot with the payload it is known to carry.
    ``shifts`` (m, 3) lead from exit to tangent points, None where no cable has a pulley [m].
    """

    shifts: Array | None = None

    @checked
    def __init__(self, world: World, cables: str = "tension", dt: float = 1e-3, *,
                 bodies: bool = False, tip_mass: Annotated[float, "[kg] > 0"] = 1e-4,
                 solver_iterations: int | None = None) -> None:
        from ..compiled.rigid_body import platform_and_cables

        super().__init__(world, cables, dt)
        self._platform_and_cables, robot = platform_and_cables, world.robot
        if bodies and (cables == "force" or not robot.bases):
            raise InvalidInput("bases that stand and tip need a world with bases and cables that are bodies too: "
                               "\"tension\", \"length\" or \"elastic\"")
        tip_mass = max(tip_mass, _TOLD * robot.mass)
        tips = robot.n_cables * tip_mass
        if cables != "force" and tips > _FELT * robot.mass:
            warn(f"the platform of {robot.mass:g} kg feels its cables' tips of {tips:g} kg together; "
                 "use cables=\"force\" or a smaller tip_mass", CdprWarning, stacklevel=3)
        self._tip_mass, self._bodies = tip_mass, bodies
        engine, inertia = import_pybullet(), robot.platform.inertia
        self.bullet = Bullet(engine, engine.connect(engine.DIRECT))   # with options it would print them
        # Bullet's body frame: at the center of mass, along the principal axes of inertia.
        self._axes = np.eye(3)
        if np.count_nonzero(inertia - np.diag(np.diag(inertia))):
            axes = np.linalg.eigh(inertia)[1]
            self._axes = axes * np.sign(np.linalg.det(axes))   # right-handed
        # Threshold 0: the default ends the iterations early, at a moment that depends on the
        # motion.
        self.bullet.setPhysicsEngineParameter(
            fixedTimeStep=self.dt, solverResidualThreshold=0,
            numSolverIterations=as_count((50 if bodies else 5) if solver_iterations is None else
                                         solver_iterations, "solver_iterations", maximum=100_000))
        self.bullet.setGravity(0, 0, -robot.gravity)
        self._substeps = 1
        # What Bullet tells of a step; of plain numbers `Struct` makes an array quicker than numpy.
        self._told: Any = np.zeros(13 + 3 * robot.n_cables)
        ties = 0 if cables == "force" else robot.n_cables
        self._pack = Struct(f"{13 + 3 * ties}d").pack_into
        self.platform = self._add_platform()
        floor = self.bullet.createCollisionShape(self.bullet.GEOM_PLANE)
        self.bullet.createMultiBody(0, floor, basePosition=[0, 0, world.scene.floor_height])
        for box in world.scene.boxes:
            self.bullet.add_box(box.size, box.position, box.yaw)
        self.boxes = Boxes(self.bullet, self.platform)
        self.bases = SpatialBases(self.bullet, robot, tip_mass)
        self._legs = Legs(self.bullet, [], self.platform, np.zeros((0, 3)))
        self.reset()

    # --- the interface
    # ----------------------------------------------------------------------------
    def place(self, start: Pose) -> None:
        b, robot = self.bullet, self.world.robot
        self.boxes.release()
        self._legs.remove()
        center = start.position + start.rotation @ robot.platform.center_of_mass
        b.resetBasePositionAndOrientation(self.platform, center.tolist(), quaternion_of(start.rotation @ self._axes))
        b.resetBaseVelocity(self.platform, [0, 0, 0], [0, 0, 0])
        if self.cables != "force":
            self._legs = self._add_legs(start)
        self.whole_wrenches = np.zeros((6, robot.n_cables))
        self._read(1)

    def pull(self, tensions: Array, substeps: int) -> None:
        if substeps != self._substeps:
            # One engine call for all substeps: torques are held over them and Python waits
            # once.
            self._substeps = substeps
            self.bullet.setPhysicsEngineParameter(fixedTimeStep=self.dt * substeps,
                                                  numSubSteps=substeps if substeps > 1 else 0)
        if self.cut_cables:
            tensions = np.array(tensions)
            tensions[list(self.cut_cables)] = 0.0
        if self.pushed is not None:
            self._apply(self.pushed)
        if self._bodies:
            self.bases.steer(self.dt * substeps)
        beside = None
        if self.cables == "force":
            self._apply(self.whole_wrenches @ tensions)
            beside = tensions
        elif self.bases.pulleys.size:
            beside = self._pull_over_pulleys(tensions)
        else:
            self._legs.pull(tensions)
        self.bullet.engine.stepSimulation(self.bullet.client)
        self.steps += substeps
        self._read(substeps, beside)

    def reel(self, lengths: Array) -> None:
        self.pull(self.rope_tensions(lengths, self.whole_wrenches), 1)

    def sever(self, cable: int) -> None:
        m, row = self.world.robot.n_cables, self._row.copy()
        row[cable - m] = 0.0
        self._row = frozen(row)
        if self.cables != "force":
            self._legs.cut(cable)

    def contact_force(self) -> float:
        contacts = self.bullet.getContactPoints(bodyA=self.platform)
        return float(sum(contact[9] for contact in contacts))

    def close(self) -> None:
        if self.bullet.client >= 0:
            self.bullet.disconnect()
            self.bullet = self.bullet._replace(client=-1)
            for deed in ("pull", "reel", "place", "sever"):
                setattr(self, deed, closed)

    def cables_at(self, pose: Pose) -> Cables:
        """Directions, lengths and wrench matrix if the platform were at a pose, the bases where they are."""
        from ..compiled.columns import cables

        robot = self.world.robot
        lengths, W = cables(self.bases.exits, robot.anchor_points, pose.position[None],
                            pose.rotation[None], self.bases.pulleys)
        return Cables(W[0, :3].T, lengths[0], robot.pattern.project(W[0], pose.rotation))

    # --- mobile bases
    # -----------------------------------------------------------------------------
    @property
    def exit_velocities(self) -> Array:  # type: ignore[override]
        """(m, 3) of the exit points during the last step [m/s]."""
        return self.bases.exit_steps / (self.dt * self._substeps)

    @property
    def tilts(self) -> Array:
        """(p,) angle of each base's mast from the vertical [rad]."""
        return self.bases.tilts

    def wheel_loads(self) -> dict[str, Array]:
        """Base name → (k,) normal force on each footprint contact, in file order [N]."""
        return self.bases.wheel_loads(self._substeps)

    # --- every step
    # -------------------------------------------------------------------------------
    def _pull_over_pulleys(self, tensions: Array) -> Array:
        """Pull with τ u: the legs with τ (u · u_leg); the rest, τ u − τ (u · u_leg) u_leg, acts at the anchor points.

        A base feels −τ u along the same line. Returns what the rest is of the tensions, (m,) [N].
        """
        u, ways = self.directions, self._legs_pull
        shares = (u * ways).sum(axis=1)
        self._legs.pull(tensions * shares)
        rest = tensions[:, None] * (u - shares[:, None] * ways)
        arms = self._anchors - self.position
        self._apply(np.concatenate([rest.sum(axis=0), np.cross(arms, rest).sum(axis=0)]))
        if self._bodies:
            self.bases.press(-rest, self._anchors)
        return np.asarray(tensions * (1 - shares**2))

    def _apply(self, wrench: Array) -> None:
        """A full wrench [f; m] at P in world axes, for the next step."""
        b, client = self.bullet
        force = wrench[:3].tolist()
        # Applied at P as a world point, so that Bullet adds the moment about the center of
        # mass.
        b.applyExternalForce(self.platform, -1, force, self.position.tolist(),
                             b.WORLD_FRAME, client)
        if wrench[3:].any():
            b.applyExternalTorque(self.platform, -1, wrench[3:].tolist(), b.WORLD_FRAME, client)

    def _read(self, substeps: int, beside: Array | None = None) -> None:
        """Where the last engine call has brought platform and cables, and what these carry.

        beside : (m,) of it that is not the legs' [N]
        """
        b, client = self.bullet
        place, quaternion = b.getBasePositionAndOrientation(self.platform, client)
        linear, angular = b.getBaseVelocity(self.platform, client)
        x, y, z = place
        if not abs(x) + abs(y) + abs(z) < 5 * self._extent:  # also false for NaN
            self.diverge()
        if self._bodies:
            self.bases.look()
        self._pack(self._told, 0, *place, *quaternion, *linear, *angular, *chain.from_iterable(self._legs.forces()))
        robot, bases = self.world.robot, self.bases
        row, W = self._platform_and_cables(self._told, self._axes, robot.platform.center_of_mass, bases.exits,
                                           robot.anchor_points, bases.pulleys, self.whole_wrenches, substeps)
        carried = row[self._tensions]
        if beside is not None:
            carried += beside
        if self.is_wound:   # what a slack leg's tip weighs is no rope's tension
            np.maximum(carried, 0.0, out=carried)
        # Controllers and methods are handed views of these.
        self._row, self.whole_wrenches = frozen(row), frozen(W)
        if bases.pulleys.size:
            self._see_pulleys()

    def _see_pulleys(self) -> None:
        """From exit points to tangent points, and which way the legs, which stay at the exit points, pull."""
        if not self.lengths.all():
            self.jump_off()
        self._anchors = self.position + self.world.robot.anchor_points @ self.rotation.T
        ways = self.bases.exits - self._anchors
        self._legs_pull = ways / np.linalg.norm(ways, axis=1, keepdims=True)
        straight = straight_lengths(-ways, self.bases.pulleys)
        self.shifts = self.bases.shifts = frozen(straight[:, None] * self.directions - ways)

    # --- building
    # ---------------------------------------------------------------------------------
    def _add_platform(self) -> int:
        b, body = self.bullet, self.world.robot.platform
        place = (body.center - body.center_of_mass) @ self._axes
        shape = b.createCollisionShape(b.GEOM_BOX, halfExtents=(body.size / 2).tolist(),
                                       collisionFramePosition=place.tolist(),
                                       collisionFrameOrientation=quaternion_of(self._axes.T))
        platform = b.createMultiBody(body.mass, shape)
        principal = self._axes.T @ body.inertia @ self._axes
        # Bullet's default damping of 0.04 would triple the tracking error.
        b.changeDynamics(platform, -1, localInertiaDiagonal=principal.diagonal().tolist(), linearDamping=0,
                         angularDamping=0, activationState=b.ACTIVATION_STATE_DISABLE_SLEEPING)
        return int(platform)

    def _add_legs(self, start: Pose) -> Legs:
        robot, world = self.world.robot, self.world
        anchors = start.position + robot.anchor_points @ start.rotation.T
        places = [world.pose.position, start.position]
        places += [end.position for task in world.tasks.values() for end in (task.start, task.end)]
        middle = np.mean(places, axis=0)   # of where the platform is to be
        carried = self.bases.build(anchors, middle) if self._bodies else {}
        legs = [carried[i] if i in carried else
                fixed_leg(self.bullet, robot.exit_points[i], anchors[i], middle, self._tip_mass)
                for i in range(robot.n_cables)]
        pivots = (robot.anchor_points - robot.platform.center_of_mass) @ self._axes
        return Legs(self.bullet, legs, self.platform, pivots)
