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

from __future__ import annotations

import math
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from ..errors import MissingDependency
from ..robot import Robot
from ..robot.pose import Pose
from ..world import World
from .planar_bases import PlanarBases
from .planar_space import PlanarSpace, solving_order
from .simulator import Simulator


class PlanarSimulator(Simulator):
    """A planar world in its own pymunk space.

    world : a planar World
    cables : "length" (ropes paid in and out by winches), "tension" or "force" (both ideal: in
        the plane every cable pulls its anchor point with the tension commanded)
    dt : time step [s]
    solver_iterations : of Chipmunk's constraint solver; default as many as the ropes need, 10
        to 1000
    """

    def __init__(self, world: World, cables: str = "tension", dt: float = 1e-3, *,
                 solver_iterations: int | None = None) -> None:
        super().__init__(world, cables, dt)
        self._pymunk, body = import_pymunk(), world.robot.platform
        self._order, rounds = solving_order(world)
        self._iterations = solver_iterations or rounds
        self._center = [float(x) for x in body.center_of_mass]
        self._anchors = (world.robot.anchor_points - body.center_of_mass).tolist()
        self._space: PlanarSpace | None = None
        self.reset()

    # --- the interface
    # ----------------------------------------------------------------------------
    def place(self, start: Pose) -> None:
        self.close()
        robot = self.world.robot
        self.bases = PlanarBases(robot, self.dt)
        self._pulls = [0.0] * robot.n_cables
        self._reach = 20 * (1 + float(np.abs(robot.exit_points).max() + np.abs(start.position).max()))
        # A new space: nothing of the last run, such as an impulse kept for the solver's start,
        # stays behind.
        self.space = self._space = PlanarSpace(self._pymunk, self.world, start, self._iterations,
                                               self._order if self.is_wound else ())
        self.space.place_bases(self.bases, self.dt)
        self._string()
        self._look()
        self.paid_out = self._lengths if self.is_wound else []

    def pull(self, tensions: Array, substeps: int) -> None:
        pulls = [0.0 if i in self.cut_cables else float(tension) for i, tension in enumerate(tensions)]
        for _ in range(substeps):
            self._load(pulls)
            self._advance()
        self._pulls = pulls

    def reel(self, lengths: list[float]) -> None:
        if self.pushed is not None:
            self._load([])
        dt, space, rate = self.dt, self.space, -1 / self.dt
        speeds: list[float] = []
        for length, (ux, uy) in zip(lengths, self._directions):
            speeds += length * rate * ux, length * rate * uy
        if self.bases.moving:   # the reels are where their bases are, and move with them
            speeds = (self.bases.exit_velocities.ravel() + speeds).tolist()
        space.reel(self._velocity, speeds)
        self._advance()
        self._pulls = [rope.impulse / dt for rope in space.ropes]
        for cable in self.cut_cables:
            self._pulls[cable] = 0.0

    def sever(self, cable: int) -> None:
        if self.is_wound:
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
        return np.array(self._place)

    @property
    def rotation(self) -> Array:  # type: ignore[override]
        c, s = self._turn
        return np.array(((c, -s), (s, c)))

    @property
    def twist(self) -> Array:  # type: ignore[override]
        return np.array(self._twist)

    @property
    def tensions(self) -> Array:  # type: ignore[override]
        return np.array(self._pulls)

    @property
    def lengths(self) -> Array:  # type: ignore[override]
        return np.array(self._lengths)

    @property
    def wrench_matrix(self) -> Array:  # type: ignore[override]
        from ..compiled.columns import cables

        robot = self.world.robot
        _, W = cables(self.bases.exits, robot.anchor_points, self.position[None], self.rotation[None])
        return W[0, :robot.n_dof]

    def sample(self) -> tuple[float, ...]:
        c, s = self._turn
        return (*self._place, c, -s, s, c, *self._twist, *self._lengths, *self._pulls)

    # --- every step
    # -------------------------------------------------------------------------------
    def _load(self, pulls: list[float]) -> None:
        """Sum of the pulls and the push, at the center of mass: held by the engine for one step."""
        c, s = self._turn
        fx, fy, moment = 0.0, 0.0, 0.0
        if self.pushed is not None:
            fx, fy, moment = self.pushed.tolist()
            moment += self._arm[1] * fx - self._arm[0] * fy
        for tension, (ux, uy), (bx, by) in zip(pulls, self._directions, self._anchors):
            fx += tension * ux
            fy += tension * uy
            moment += tension * ((bx * c - by * s) * uy - (bx * s + by * c) * ux)
        self.space.body.force, self.space.body.torque = (fx, fy), moment

    def _advance(self) -> None:
        moving = self.bases.moving
        if moving:
            self.space.place_bases(self.bases, self.dt)
        self.space.space.step(self.dt)
        if moving:
            self.bases.advance()
            self._string()
        self.steps += 1
        self._look()

    def _string(self) -> None:
        """Both ends of every cable in one list, exit point and anchor point, which `_look` runs through quicker."""
        self._ends = [(*exit_point, *anchor) for exit_point, anchor in zip(self.bases.exits.tolist(), self._anchors)]

    def _look(self) -> None:
        """Where the platform is about to be, and the cables there; plain floats, which are quicker than arrays."""
        dt, reach = self.dt, self._reach
        x, y, angle, vx, vy, spin = self.space.motion()
        x, y, angle = x + vx * dt, y + vy * dt, angle + spin * dt
        if not (-reach < x < reach and -reach < y < reach and -math.tau < spin * dt < math.tau):
            self.diverge()
        c, s = math.cos(angle), math.sin(angle)
        lengths, directions = [], []
        for ax, ay, bx, by in self._ends:
            dx, dy = ax - x - bx * c + by * s, ay - y - bx * s - by * c
            length = math.hypot(dx, dy) or 1e-12
            lengths.append(length)
            directions.append((dx / length, dy / length))
        self._lengths, self._directions, self._turn = lengths, directions, (c, s)
        cx, cy = self._center
        cx, cy = cx * c - cy * s, cx * s + cy * c
        self._arm, self._place, self._velocity = (cx, cy), (x - cx, y - cy), (vx, vy)
        self._twist = (vx + spin * cy, vy - spin * cx, spin)


@cache
def import_pymunk() -> Any:
    """The engine; raises MissingDependency saying how to get it."""
    try:
        import pymunk
        import pymunk.batch
    except ImportError:
        raise MissingDependency("planar worlds run in pymunk, which is not installed: `pip install pymunk` "
                                "(spatial worlds, tensions and sets work without it)") from None
    return pymunk
