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
from ..robot.pose import Pose
from ..world import World
from .planar_bases import PlanarBases
from .planar_space import PlanarSpace, solving_order
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
        from ..compiled import reels

        super().__init__(world, cables, dt)
        self._pymunk, self._compiled = import_pymunk(), reels
        order, rounds = solving_order(world)
        self._order = order if cables == "length" else ()
        self._iterations = rounds if solver_iterations is None else as_count(solver_iterations, "solver_iterations")
        # What every step is written into: the platform and the cables as `sample` tells them, and W.
        m = world.robot.n_cables
        self._seen, self._W = np.zeros(9 + 2 * m), np.zeros((3, m))
        # Of a few numbers `Struct` makes an array quicker than numpy.
        self._pulls: Any = self._seen[-m:]
        self._pack = Struct(f"{m}d").pack_into
        self._over_pulleys = world.robot.pulleys.size > 0
        self._space: PlanarSpace | None = None
        self.reset()

    # --- the interface
    # ----------------------------------------------------------------------------
    def place(self, start: Pose) -> None:
        self.close()
        self.bases = PlanarBases(self.world.robot, self.dt)
        self._pulls[:] = 0.0
        self._kept: Array | None = None
        # A new space: nothing of the last run, such as an impulse kept for the solver's start,
        # stays behind.
        self.space = self._space = PlanarSpace(self._pymunk, self.world, start, self._iterations, self._order)
        self.space.place_bases(self.bases, self.dt)
        # What is asked every step: most of it is always the same, and written into.
        robot, bases = self.world.robot, self.bases
        self._see = partial(self._compiled.look, self.space.motion, self.dt, 20 * self._extent,
                            robot.platform.center_of_mass, bases.exits, robot.anchor_points, bases.pulleys,
                            self._seen[:-robot.n_cables], self._W)
        self._look()

    def pull(self, tensions: Array, substeps: int) -> None:
        self._pulls[:] = tensions
        for cable in self.cut_cables:
            self._pulls[cable] = 0.0
        for _ in range(substeps):
            self._load(self._pulls)
            self._advance()

    def reel(self, lengths: Array) -> None:
        if self.cables == "elastic":
            W = self._W.copy()
            W[self.world.robot.n_dof:] = 0.0   # a rail carries what the pattern leaves
            return self.pull(self.rope_tensions(lengths, W), 1)
        if self.pushed is not None:
            self._load(np.zeros(len(lengths)))
        dt, space = self.dt, self.space
        if self.strongest is not None:
            for rope, most in zip(space.ropes, self.strongest.tolist()):
                rope.max_force = most
        self._compiled.reel(space.motion, lengths, dt, self._W, self.bases.reel_velocities, space.velocities)
        space.write_velocities()
        self._advance()
        self._pack(self._pulls, 0, *[rope.impulse / dt for rope in space.ropes])
        for cable in self.cut_cables:
            self._pulls[cable] = 0.0

    def sever(self, cable: int) -> None:
        if self.space.ropes:
            self.space.space.remove(self.space.ropes[cable])
        self._pulls[cable], self._kept = 0.0, None

    def drive(self, speeds: ArrayLike) -> Array:
        driven = super().drive(speeds)
        self.space.place_bases(self.bases, self.dt)
        return driven

    def contact_force(self) -> float:
        forces: list[float] = []
        self.space.body.each_arbiter(lambda arbiter: forces.append(
            abs(arbiter.total_impulse.dot(arbiter.contact_point_set.normal)) / self.dt))
        return sum(forces)

    def close(self) -> None:
        if self._space is not None:
            self._space.clear()

    @property
    def exit_velocities(self) -> Array:  # type: ignore[override]
        return frozen(self.bases.reel_velocities.copy())

    @property
    def whole_wrenches(self) -> Array:  # type: ignore[override]
        return frozen(self._W.copy())

    @property
    def _row(self) -> Array:  # type: ignore[override]
        if self._kept is None:
            self._kept = frozen(self._seen.copy())
        return self._kept

    def sample(self) -> Array:
        return self._seen

    # --- every step
    def _load(self, pulls: Array) -> None:
        """Sum of the pulls and the push, at the center of mass: held by the engine for one step."""
        wrench = self._W @ pulls
        if self.pushed is not None:
            wrench += self.pushed
        fx, fy, moment = wrench.tolist()
        x, y = (self._seen[2:6].reshape(2, 2) @ self.world.robot.platform.center_of_mass).tolist()
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
        self._kept = None
        self.space.read_motion()
        if not self._see():
            if not self.lengths.all() and np.isfinite(self.position).all():
                self.jump_off()
            self.diverge()
        if self._over_pulleys:
            # A rope on a pulley pulls as a straight one as long would, from the end of which its reel stands.
            anchors = self.position + self.world.robot.anchor_points @ self.rotation.T
            self.bases.lead(anchors + self.lengths[:, None] * self.directions)
            self.space.place_reels(self.bases)


@cache
def import_pymunk() -> Any:
    """The engine; raises MissingDependency saying how to get it."""
    with needed_by("the planar engine", "spatial worlds, tensions and sets work without it"):
        import pymunk
        import pymunk.batch
    return pymunk
