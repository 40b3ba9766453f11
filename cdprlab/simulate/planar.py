"""pymunk behind the `Simulator` interface: imported only when a planar world is simulated.

Three facts about the engine, Chipmunk, shape this file.

It moves bodies before it accelerates them, so a step's new speed shows in the position one step late. Reported is
therefore where a body is about to be, p + v dt: forces and ropes then act where the platform is said to be.

A `SlideJoint` is a rope that never pushes, but while it is taut the engine lets it only shorten: paid out, a load
would fall and be caught in turn; and by default it corrects 0.6 % of its error a millisecond, 80 mm behind a winch
of 0.5 m/s. Each rope is therefore a joint of length zero to a reel, a static body whose speed (a conveyor belt's: it
goes nowhere) pays out along the rope what the joint would correct: what remains is l(t + dt) ≤ the winch's length.
"""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_array
from ..errors import InvalidInput, MissingDependency, SimulationDiverged
from ..robot import Robot
from ..robot.pose import Pose
from ..view.planar_camera import PlanarCamera
from ..world import World
from .planar_bases import DrivenBases
from .planar_space import PlanarSpace, solving_order
from .simulator import Simulator
from .state import State


class PlanarSimulator(Simulator):
    """A planar world in its own pymunk space.

    world : a planar World
    cables : "length" (ropes paid in and out by winches), "tension" or "force" (both ideal: in the plane every
        cable pulls its anchor point with the tension commanded)
    dt : time step [s]
    solver_iterations : of Chipmunk's constraint solver; default as many as the ropes need, 10 to 1000
    """

    _lengths: list[float]
    _directions: list[tuple[float, float]]

    def __init__(self, world: World, cables: str = "tension", dt: float = 1e-3, *,
                 solver_iterations: int | None = None) -> None:
        self.world, self.dt, self.cables = world, float(dt), cables
        self._pymunk = import_pymunk()
        # What runs every step comes straight from the engine's library: pymunk's own checks would double its time.
        from pymunk._chipmunk_cffi import lib

        self._step_space = lib.cpSpaceStep
        self._set_velocity, self._impulse = lib.cpBodySetVelocity, lib.cpConstraintGetImpulse
        self._getters = (lib.cpBodyGetPosition, lib.cpBodyGetVelocity, lib.cpBodyGetAngle, lib.cpBodyGetAngularVelocity)
        self._order, rounds = solving_order(world)
        self._iterations = solver_iterations or rounds
        self._center = [float(x) for x in world.robot.platform.center_of_mass]
        self._anchors = (world.robot.anchor_points - world.robot.platform.center_of_mass).tolist()
        self._speed_max = world.robot.speed_max.tolist()
        self._most_wound = (world.robot.speed_max * self.dt).tolist()   # in one step
        self._camera: Any = None
        self.reset()

    # --- the interface ----------------------------------------------------------------------------
    def reset(self, pose: Pose | None = None) -> State:
        start = self.world.pose if pose is None else pose
        self._bases = DrivenBases(self.world.robot, self.dt)
        self._steps = 0
        self._cut: set[int] = set()
        self._push: tuple[float, float, float] | None = None
        self._pulls = [0.0] * self.world.robot.n_cables
        self._reach = 20 * (1 + float(np.abs(self.world.robot.exit_points).max() + np.abs(start.position).max()))
        if (last := getattr(self, "_space", None)) is not None:
            last.clear()
        # A new space: nothing of the last run, such as an impulse kept for the solver's start, stays behind.
        self._space = PlanarSpace(self._pymunk, self.world, start, self._iterations)
        self._body, self._platform = self._space.body, self._space.body._body
        self._engine = self._space.space._space
        self._space.place_bases(self._bases, self.dt)
        self._string()
        self._look()
        self._paid_out = self._lengths
        self._ropes = self._space.tie(self._bases.exits, self._anchors, self._order) if self.cables == "length" else []
        self._joints = [rope._constraint for rope in self._ropes]
        self._reels = [rope.a._body for rope in self._ropes]
        return self.state()

    def step(self, tensions: Array, substeps: int = 1) -> None:
        if self._ropes:
            raise InvalidInput("cables=\"length\" takes rope lengths: use wind(lengths), not step(tensions)")
        pulls = [0.0 if i in self._cut else float(tension) for i, tension in enumerate(tensions)]
        for _ in range(substeps):
            self._load(pulls)
            self._advance()
        self._pulls = pulls

    def wind(self, lengths: ArrayLike, substeps: int = 1) -> bool:
        """Advance by ``substeps`` × dt while the winches bring the ropes evenly to these lengths.

        lengths : (m,) at the end of the last substep [m]
        Returns False where a winch's speed limit kept a rope from its length.
        Raises InvalidInput unless ``cables="length"``.
        """
        if not self._ropes:
            raise InvalidInput(f"cables={self.cables!r} takes tensions: use step(tensions), or open the simulator "
                               "with cables=\"length\"")
        before = self._paid_out
        after = wanted = lengths if isinstance(lengths, list) else np.asarray(lengths, dtype=float).tolist()
        if len(wanted) != len(before):
            raise InvalidInput(f"lengths must be {len(before)} numbers [m], got {len(wanted)}")
        for now, wish, most in zip(before, wanted, self._most_wound):
            if not (wish > 0 and abs(wish - now) <= most * substeps):
                after = self._reachable(wanted, self.dt * substeps)
                break
        for k in range(1, substeps):
            self._reel([a + k / substeps * (b - a) for a, b in zip(before, after)])
            self._advance()
        self._reel(after)
        self._advance()
        self._paid_out = after
        if self._cut:
            self._pulls = self._rope_tensions()
        else:
            impulse, dt = self._impulse, self.dt
            self._pulls = [impulse(rope) / dt for rope in self._joints]
        return after is wanted

    def drive(self, speeds: ArrayLike) -> Array:
        """Let the mobile bases drive on at these speeds, (θ̇, ρ̇₁, ρ̇₂) of each in file order, in their own axes.

        speeds : (3p,) [rad/s, m/s, m/s]
        Returns (3p,) what they drive: clipped to each base's limits, 0 where a direction is held.
        """
        driven = self._bases.drive(speeds)
        self._space.place_bases(self._bases, self.dt)
        for rope, place in zip(self._ropes, self._bases.exits):  # where they stay if nothing drives on
            rope.a.position = place
        return driven

    def state(self) -> State:
        return State(self._steps * self.dt, self.robot, self.position, self.rotation, self.twist, self.tensions)

    def cut(self, cables: ArrayLike | None = None) -> None:
        m = len(self._anchors)
        for i in range(m) if cables is None else np.atleast_1d(np.asarray(cables, dtype=int)).tolist():
            if not 0 <= i < m:
                raise InvalidInput(f"cables to cut are given by index, 0 to {m - 1}, got {i}")
            if self._ropes and i not in self._cut:
                self._space.space.remove(self._ropes[i])
            self._cut.add(i)
            self._pulls[i] = 0.0

    def push(self, wrench: ArrayLike) -> None:
        given = as_array(wrench, "external wrench", (self.world.robot.n_dof,), "N, N m").tolist()
        fx, fy, moment = (given + [0.0, 0.0])[:3]
        self._push = (fx, fy, moment) if any(given) else None

    def contact_force(self) -> float:
        return self._space.contact_force(self.dt)

    def render(self, width: int = 640, height: int = 480) -> Any:
        if self._camera is None:
            self._camera = PlanarCamera(self.world)
        tensions = self.tensions
        tensions[list(self._cut)] = np.nan
        return self._camera.picture(Pose.of(self.position, self.rotation), tensions, width, height,
                                    rope_lengths=self.rope_lengths, robot=self.robot)

    def close(self) -> None:
        self._camera = None
        self._space.clear()

    # --- the present state as arrays ----------------------------------------------------------------
    @property
    def robot(self) -> Robot:  # type: ignore[override]
        """The robot with its bases where they are now."""
        return self._bases.robot

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
    def rope_lengths(self) -> Array | None:
        """What the winches have let out of each rope, None where there are none [m]."""
        return np.array(self._paid_out) if self._ropes else None

    @property
    def wrench_matrix(self) -> Array:  # type: ignore[override]
        c, s = self._turn
        x, y = self._arm
        rows = [(ux, uy, (bx * c - by * s + x) * uy - (bx * s + by * c + y) * ux)
                for (ux, uy), (bx, by) in zip(self._directions, self._anchors)]
        return np.array(rows).T[:self.world.robot.n_dof]

    def sample(self) -> tuple[float, ...]:
        """Position (2), rotation (4), twist (3), lengths (m) and tensions (m) as one row of a log."""
        c, s = self._turn
        return (*self._place, c, -s, s, c, *self._twist, *self._lengths, *self._pulls)

    # --- every step -------------------------------------------------------------------------------
    def _reachable(self, wanted: list[float], period: float) -> list[float]:
        """The wanted lengths as far as the winches' speed limits allow; the same list if they all do."""
        if not all(0 < wish < math.inf for wish in wanted):
            raise InvalidInput(f"rope lengths must be positive [m], got {wanted}")
        # A speed exactly at its limit must not fail by rounding: 1 nm.
        farthest = [limit * period + 1e-9 for limit in self._speed_max]
        reached = [min(max(wish, now - far), now + far) for now, wish, far in zip(self._paid_out, wanted, farthest)]
        return wanted if reached == wanted else reached

    def _reel(self, lengths: list[float]) -> None:
        """Let every rope end the coming step no longer than this."""
        if self._push is not None:
            self._load(())
        if self._bases.moving:
            self._reel_from_driven_bases(lengths)
            return
        set_velocity, rate = self._set_velocity, -1 / self.dt
        for reel, (ux, uy), length in zip(self._reels, self._directions, lengths):
            speed = length * rate
            set_velocity(reel, (speed * ux, speed * uy))

    def _reel_from_driven_bases(self, lengths: list[float]) -> None:
        """The same, the reels being where their bases are and moving with them."""
        for rope, place, (vx, vy), (ux, uy), length in zip(
                self._ropes, self._bases.exits, self._bases.exit_velocities(), self._directions, lengths):
            speed = length / self.dt
            rope.a.position, rope.a.velocity = place, (vx - speed * ux, vy - speed * uy)

    def _rope_tensions(self) -> list[float]:
        return [0.0 if i in self._cut else self._impulse(rope) / self.dt for i, rope in enumerate(self._joints)]

    def _load(self, pulls: Any) -> None:
        """Sum of the pulls and the push, at the center of mass: held by the engine for one step."""
        c, s = self._turn
        fx, fy, moment = 0.0, 0.0, 0.0
        if self._push is not None:
            fx, fy, moment = self._push
            moment += self._arm[1] * fx - self._arm[0] * fy
        for tension, (ux, uy), (bx, by) in zip(pulls, self._directions, self._anchors):
            fx += tension * ux
            fy += tension * uy
            moment += tension * ((bx * c - by * s) * uy - (bx * s + by * c) * ux)
        self._body.force, self._body.torque = (fx, fy), moment

    def _advance(self) -> None:
        if self._bases.moving:
            self._space.place_bases(self._bases, self.dt)
        self._step_space(self._engine, self.dt)
        if self._bases.moving:
            self._bases.advance()
            self._string()
        self._steps += 1
        self._look()

    def _string(self) -> None:
        """Both ends of every cable in one list, exit point and anchor point, which `_look` runs through quicker."""
        self._ends = [(*exit_point, *anchor) for exit_point, anchor in zip(self._bases.exits, self._anchors)]

    def _look(self) -> None:
        """Where the platform is about to be, and the cables there; plain floats, which are quicker than arrays."""
        (get_position, get_velocity, get_angle, get_spin), body, dt = self._getters, self._platform, self.dt
        position, velocity, spin = get_position(body), get_velocity(body), get_spin(body)
        vx, vy, reach = velocity.x, velocity.y, self._reach
        x, y, angle = position.x + vx * dt, position.y + vy * dt, get_angle(body) + spin * dt
        if not (-reach < x < reach and -reach < y < reach and -math.tau < spin * dt < math.tau):
            self._diverged()
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
        self._arm, self._place = (cx, cy), (x - cx, y - cy)
        self._twist = (vx + spin * cy, vy - spin * cx, spin)

    def _diverged(self) -> None:
        now, pulls = self._steps * self.dt, self._rope_tensions() if self._ropes else self._pulls
        pulls = [abs(pull) if math.isfinite(pull) else math.inf for pull in pulls]
        worst = pulls.index(max(pulls))
        raise SimulationDiverged(
            f"the simulation diverged at t = {now:.4g} s: the platform left the scene; cable {worst + 1} pulled "
            f"hardest, {pulls[worst]:.3g} N; take a smaller dt or lower gains (K_d times the control period "
            "must stay below 2)", now, worst + 1)


@cache
def import_pymunk() -> Any:
    """The engine; raises MissingDependency saying how to get it."""
    try:
        import pymunk
    except ImportError:
        raise MissingDependency("planar worlds run in pymunk, which is not installed: `pip install pymunk` "
                                "(spatial worlds, tensions and sets work without it)") from None
    return pymunk
