"""pymunk behind the `Simulator` interface: imported only when a planar world is simulated.

Three facts about the engine, Chipmunk, shape this file.

It moves bodies before it accelerates them, so a step's new speed shows in the position one step
late. Reported is therefore where a body is about to be, p + v dt: forces and ropes then act
where the platform is said to be.

A `SlideJoint` is a rope that never pushes, but while it is taut the engine lets it only
shorten: paid out, a load would fall and be caught in turn; and by default it corrects 0.6 % of
its error a millisecond, 80 mm behind a winch of 0.5 m/s. Each rope is therefore a joint of
length zero to a reel, a static body whose speed (a conveyor belt's: it goes nowhere) pays out
along the rope what the joint would correct: what remains is l(t + dt) ≤ the winch's length.
"""

from functools import cache, partial
from struct import Struct
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_count, frozen
from ..errors import needed_by
from ..robot import Robot
from ..robot.pose import Pose
from ..world import World
from .planar_bases import PlanarBases
from .planar_space import PlanarSpace, solving_order
from .ropes import RopeLaw
from .simulator import Simulator


class PlanarSimulator(Simulator):
    """A planar world in its own pymunk space.

    world : a planar World
    cables : "length" (ropes paid in and out by winches), "elastic" (such ropes, that stretch),
        "tension" or "force" (both ideal: in the plane every cable pulls its anchor point with the
        tension commanded)
    dt : time step [s]
    solver_iterations : of Chipmunk's constraint solver; default as many as the ropes need, 10
        to 1000
    """

    def __init__(self, world: World, cables: str = "tension", dt: float = 1e-3, *,
                 solver_iterations: int | None = None) -> None:
        super().__init__(world, cables, dt)
        from ..compiled import reels

        self._pymunk, self._compiled, robot = import_pymunk(), reels, world.robot
        self._over_pulleys = robot.pulleys.size > 0
        self.carrying = robot
        self._order, rounds = solving_order(world)
        self._iterations = rounds if solver_iterations is None else as_count(solver_iterations, "solver_iterations")
        self._center = robot.platform.center_of_mass
        # What every step is written into: the platform and the cables as `sample` tells them, and W.
        self._seen, self._W = np.zeros(9 + robot.n_cables), np.zeros((3, robot.n_cables))
        self._position, self._rotation, self._twist, self._lengths = np.split(self._seen, (2, 6, 9))
        # What ropes are to be wound to; of a few numbers `Struct` makes an array quicker than
        # numpy.
        self._wound: Any = np.zeros(robot.n_cables)
        self._pack = Struct(f"{robot.n_cables}d").pack_into
        self._space: PlanarSpace | None = None
        self.reset()

    # --- the interface
    # ----------------------------------------------------------------------------
    def place(self, start: Pose) -> None:
        self.close()
        robot = self.world.robot
        self.bases = PlanarBases(robot, self.dt)
        self._pulls = [0.0] * robot.n_cables
        self._reach = 20 * (1 + float(np.abs(robot.exit_points).max() + np.abs(start.position).max()
                                      + abs(self.world.scene.floor_height)))
        # A new space: nothing of the last run, such as an impulse kept for the solver's start,
        # stays behind.
        self.space = self._space = PlanarSpace(self._pymunk, self.world, start,
                                               self._iterations,
                                               self._order if self.cables == "length" else ())
        # What is asked every step: most of it is always the same, and written into.
        motion, bases = self.space.motion, self.bases
        self._see = partial(self._compiled.look, motion, self.dt, self._reach, self._center, bases.exits,
                            robot.anchor_points, bases.pulleys, self._seen, self._W)
        self._turn_reels = partial(self._compiled.reel, motion, self._wound, self.dt, self._W,
                                   bases.reel_velocities, self.space.velocities)
        self.space.place_bases(bases, self.dt)
        self._look()
        self.paid_out = self.hanging_lengths() if self.is_wound else []
        if self.cables == "elastic":
            self.ropes = RopeLaw(robot, self.dt, robot.elasticity)

    def pull(self, tensions: Array, substeps: int) -> None:
        pulls = np.array(tensions, dtype=float)
        pulls[list(self.cut_cables)] = 0.0
        for _ in range(substeps):
            self._load(pulls)
            self._advance()
        self._pulls = pulls.tolist()

    def reel(self, lengths: list[float]) -> None:
        if self.cables == "elastic":
            W = np.zeros((3, len(lengths)))
            W[:self.world.robot.n_dof] = self.wrench_matrix   # a rail carries what the pattern leaves
            return self.pull(self.rope_tensions(lengths, W), 1)
        if self.pushed is not None:
            self._load(np.zeros(len(lengths)))
        dt, space = self.dt, self.space
        if self.strongest is not None:
            for rope, most in zip(space.ropes, self.strongest.tolist()):
                rope.max_force = most
        self._pack(self._wound, 0, *lengths)
        self._turn_reels()
        space.write_velocities()
        self._advance()
        self._pulls = [rope.impulse / dt for rope in space.ropes]
        for cable in self.cut_cables:
            self._pulls[cable] = 0.0

    def sever(self, cable: int) -> None:
        if self.space.ropes:
            self.space.space.remove(self.space.ropes[cable])
        self._pulls[cable] = 0.0

    def drive(self, speeds: ArrayLike) -> Array:
        """Let the mobile bases drive on at these speeds, (θ̇, ρ̇₁, ρ̇₂) of each in file order, in their own axes.

        speeds : (3p,) [rad/s, m/s, m/s]
        Returns (3p,) what they drive: clipped to each base's limits, 0 where a direction is
        held.
        """
        driven = self.bases.drive(speeds)
        self.space.place_bases(self.bases, self.dt)
        return driven

    def contact_force(self) -> float:
        return self.space.contact_force(self.dt)

    def close(self) -> None:
        if self._space is not None:
            self._space.clear()

    # --- the present state as arrays
    # ----------------------------------------------------------------
    @property
    def robot(self) -> Robot:  # type: ignore[override]
        """The robot with its bases where they are now."""
        return self.bases.robot

    @property
    def position(self) -> Array:  # type: ignore[override]
        return frozen(self._position.copy())

    @property
    def rotation(self) -> Array:  # type: ignore[override]
        return frozen(self._rotation.reshape(2, 2).copy())

    @property
    def twist(self) -> Array:  # type: ignore[override]
        return frozen(self._twist.copy())

    @property
    def exit_velocities(self) -> Array:  # type: ignore[override]
        return frozen(self.bases.reel_velocities.copy())

    @property
    def tensions(self) -> Array:  # type: ignore[override]
        return frozen(np.array(self._pulls))

    @property
    def directions(self) -> Array:  # type: ignore[override]
        return self._W[:2].T.copy()

    @property
    def base_poses(self) -> Array:  # type: ignore[override]
        return self.bases.poses

    @property
    def lengths(self) -> Array:  # type: ignore[override]
        return frozen(self._lengths.copy())

    @property
    def wrench_matrix(self) -> Array:  # type: ignore[override]
        return self._W[:self.world.robot.n_dof].copy()

    def sample(self) -> list[float]:
        return self._seen.tolist() + self._pulls

    # --- every step
    def _load(self, pulls: Array) -> None:
        """Sum of the pulls and the push, at the center of mass: held by the engine for one step."""
        wrench = self._W @ pulls
        if self.pushed is not None:
            wrench += self.pushed
        fx, fy, moment = wrench.tolist()
        x, y = (self._rotation.reshape(2, 2) @ self._center).tolist()
        self.space.body.force, self.space.body.torque = (fx, fy), moment + y * fx - x * fy

    def _advance(self) -> None:
        moving = self.bases.moving
        if moving:
            self.space.place_bases(self.bases, self.dt)
        self.space.space.step(self.dt)
        if moving:
            self.bases.advance()
        self.steps += 1
        self._look()

    def _look(self) -> None:
        """Where the platform is about to be, and the cables there."""
        self.space.read_motion()
        if not self._see():
            if not self._lengths.all() and np.isfinite(self._position).all():
                self.jump_off()
            self.diverge()
        if self._over_pulleys:
            # A rope on a pulley pulls as a straight one as long would, from the end of which its reel stands.
            anchors = self._position + self.world.robot.anchor_points @ self._rotation.reshape(2, 2).T
            self.bases.lead(anchors + self._lengths[:, None] * self._W[:2].T)
            self.space.place_reels(self.bases)


@cache
def import_pymunk() -> Any:
    """The engine; raises MissingDependency saying how to get it."""
    with needed_by("the planar engine", "spatial worlds, tensions and sets work without it"):
        import pymunk
        import pymunk.batch
    return pymunk
