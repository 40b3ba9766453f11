"""What every engine does: the interface and its checks, winches within their limits, cuts and pushes."""

import math
from abc import ABC, abstractmethod
from functools import cached_property
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_answer, as_array, as_count, checked, frozen
from ..errors import InvalidInput, SimulationDiverged, quoted
from ..mechanics.cables import Cables, cables_at, tangent_points, why_no_direction
from ..mechanics.statics import gravity_wrench
from ..robot import Robot
from ..robot.pose import Pose
from ..tensions import distribute_tensions
from ..world import World
from ..world.model import check_pose
from .ropes import RopeLaw
from .state import State

WOUND = ("length", "elastic")
"""Cable models that take lengths, not tensions: winches wind by inverse kinematics of the reference."""


_AMPLE = 1.0  # m: a cut rope does not become taut in any one step


class Simulator(ABC):
    """One robot in one engine; several may live in one process. Use it in a ``with`` block, or close it.

    world, cables, dt : what it was made for; dt is the engine's time step [s]
    robot : with its bases where they are now; carrying : with the payload it is known to carry
    boxes : pose and (3,) size [m] of each loose box
    position, rotation, twist, tensions : the present state, as in `State`
    wrench_matrix, lengths : (n, m) and (m,) [m] of the present pose
    paid_out : (m,) what the winches have let out of each rope [m], empty where tensions are
        commanded
    cut_cables : indices
    exit_velocities : (m, d) of the exit points [m/s]; directions : (m, d) of the cables
    base_poses : (p, 3) x, y and heading of each base [m, rad]
    strongest : (m,) what the winches can pull with, None: anything. A rope that pulls harder slips:
        ``slipping`` (m,) says which did [N]
    offsets : what the winches read too much; of an engine that is known as it is: nothing [m]
    """

    boxes: Any = ()
    bases: Any
    offsets: float | Array = 0.0
    exit_velocities: Array
    whole_wrenches: Array   # W in all rows
    _row: Array   # what `columns` says

    def __init__(self, world: World, cables: str, dt: float) -> None:
        self.world, self.cables, self.dt = world, cables, float(dt)
        self.elasticity = world.robot.elasticity if cables == "elastic" else None
        if cables == "elastic" and self.elasticity is None:
            raise InvalidInput(f"cables=\"elastic\" needs the ropes' stiffness: world {world.name!r} has no "
                               "`cable: {axial_stiffness: …}` block")
        self.is_wound, self._d = cables in WOUND, world.robot.dimension
        self._most = world.robot.speed_max * self.dt   # wound in one step
        self._surely = float(self._most.min())
        ends = np.cumsum([math.prod(shape) for shape, _ in self.columns().values()]).tolist()
        self._position, self._rotation, self._twist, self._lengths, self._tensions = map(slice, [0, *ends], ends)

    # --- what each engine does in its own way
    # --------------------------------------------------------
    @abstractmethod
    def place(self, start: Pose) -> None:
        """Put the robot at rest at a pose, all cables whole."""

    @abstractmethod
    def pull(self, tensions: Array, substeps: int) -> None:
        """Advance by ``substeps`` × dt with these (m,) cable tensions held [N]."""

    @abstractmethod
    def reel(self, lengths: Array) -> None:
        """Advance by dt, by whose end no rope is longer than these (m,) lengths [m]."""

    @abstractmethod
    def sever(self, cable: int) -> None:
        """Cut a cable that is whole, given by index."""

    @abstractmethod
    def contact_force(self) -> float:
        """Sum of the normal contact forces on the platform during the last step [N]."""

    @abstractmethod
    def close(self) -> None:
        """Release the engine; safe to call twice."""

    def drive(self, speeds: ArrayLike) -> Array:
        """Let the mobile bases drive on at these speeds, (θ̇, ρ̇₁, ρ̇₂) of each in file order, in their own axes.

        speeds : (3p,) [rad/s, m/s, m/s]
        Returns (3p,) what they drive: clipped to each base's limits, 0 where a direction is
        held.
        """
        return np.asarray(self.bases.drive(speeds))

    # --- the interface
    # ----------------------------------------------------------------------------
    @checked
    def reset(self, pose: Pose | None = None) -> State:
        """Put the robot at rest at a pose (default the world's), all cables whole; time starts at 0."""
        start, robot = self.world.pose if pose is None else pose, self.world.robot
        check_pose(start, robot, ("pose",))
        self.steps = 0
        self.strongest: Array | None = None
        self.cut_cables: set[int] = set()
        self.pushed: Array | None = None
        # Of the scene: a fall ends on the floor, however deep that lies.
        self._extent = 1 + float(np.abs(robot.exit_points).max() + np.abs(start.position).max()
                                 + abs(self.world.scene.floor_height))
        self.carry(0.0, np.zeros(self._d))
        self._stand: Array | None = None
        self.place(start)
        self._stand, self._present = self.base_poses, robot
        self.paid_out = self.hanging_lengths() if self.is_wound else np.zeros(0)
        return self.state()

    def step(self, tensions: ArrayLike, substeps: int = 1) -> None:
        """Advance by ``substeps`` × dt with these (m,) cable tensions held, none negative [N]."""
        if self.is_wound:
            raise InvalidInput(f"cables={self.cables!r} takes rope lengths: use wind(lengths), not step(tensions)")
        m = self.world.robot.n_cables
        held = as_answer(tensions, "tensions", m, "N", self.time)
        if min(held.tolist()) < 0:
            raise InvalidInput(f"tensions must not be negative [N] (cables only pull), got {quoted(held.tolist())} "
                               f"at t = {self.time:.4g} s")
        self.pull(held, as_count(substeps, "substeps"))

    def wind(self, lengths: ArrayLike, substeps: int = 1) -> bool:
        """Advance by ``substeps`` × dt while the winches bring the ropes evenly to these lengths.

        lengths : (m,) at the end of the last substep [m]
        Returns False where a winch's speed limit kept a rope from its length.
        Raises InvalidInput unless ``cables`` is "length" or "elastic".
        """
        if not self.is_wound:
            raise InvalidInput(f"cables={self.cables!r} takes tensions: use step(tensions), or open the simulator "
                               "with cables=\"length\"")
        wanted = as_answer(lengths, "rope lengths", len(self.paid_out), "m", self.time)
        return self.bring(wanted.copy(), as_count(substeps, "substeps"))

    def bring(self, lengths: Array, substeps: int) -> bool:
        """What `wind` does with (m,) numbers, which it keeps; a loop asks for nothing else."""
        before, after, reached = self.paid_out, lengths, True
        wishes = lengths.tolist()
        # Mostly all ropes together change by less than any one of them may.
        if not (math.dist(wishes, before.tolist()) < self._surely * substeps and min(wishes) > 0):
            if not all(0 < wish < math.inf for wish in wishes):
                raise InvalidInput(f"rope lengths must be {len(before)} positive numbers [m], got {quoted(wishes)}")
            # A winch exactly at its limit must not fail by rounding.
            farthest = self._most * substeps + 1e-9
            after = np.clip(lengths, before - farthest, before + farthest)
            reached = bool((after == lengths).all())
        ways = [after]
        if substeps > 1:
            ways = [before + k / substeps * (after - before) for k in range(1, substeps)] + ways
        for held in ways:
            self.reel(held)
            self.paid_out = held
            if self.strongest is not None:
                self._slip(self.strongest)
        return reached and (self.strongest is None or not self.slipping.any())

    def rope_tensions(self, lengths: Array, W: Array) -> Array:
        """(m,) of ropes let out to these lengths by the step's end, as `ropes` has them; W : in all rows [N]."""
        wound = lengths
        if self.cut_cables:
            cut = list(self.cut_cables)
            wound = lengths.copy()
            wound[cut] = self.lengths[cut] + _AMPLE
        if self.world.robot.bases:   # one that drives away in the step needs that much more rope
            wound = wound - self.dt * self.drawn
        pulls = self.ropes(W, self.rotation, self.twist, self.lengths, self.paid_out, wound,
                           np.zeros(len(W)) if self.pushed is None else self.pushed)
        return pulls if self.strongest is None else np.minimum(pulls, self.strongest)

    @cached_property
    def ropes(self) -> RopeLaw:
        """How ropes of commanded length pull; which of them were taut is its memory."""
        return RopeLaw(self.carrying, self.dt, self.elasticity)

    def _slip(self, strongest: Array) -> None:
        """Let out what ropes drew that pull as hard as their winches can."""
        held, drawn = self.paid_out, self.lengths
        if self.elasticity is not None:
            drawn = self.elasticity.unstrained(drawn, self.tensions)
        # A reaction is known to a small part of it: legs have tips.
        self.slipping = (self.tensions > 0.99 * strongest) & (drawn > held)
        self.paid_out = np.where(self.slipping, drawn, held)

    def carry(self, mass: float, position: Array) -> None:
        """Let those who command, and ropes of commanded length, know the payload that hangs on them now.

        mass : [kg]; position : (d,) in the platform frame [m]
        """
        self.carrying = self.world.robot.with_payload(mass, position) if mass else self.world.robot
        vars(self).pop("ropes", None)

    def cut(self, cables: ArrayLike | None = None) -> None:
        """Cut cables by index from 0 (default all): they carry nothing until the next reset."""
        m = self.world.robot.n_cables
        for i in range(m) if cables is None else cable_indices(cables, m):
            if i not in self.cut_cables:
                self.cut_cables.add(i)
                self.sever(i)

    def push(self, wrench: ArrayLike) -> None:
        """Apply an external (n,) wrench at P during every further step [N, N m]; zero to stop."""
        robot = self.world.robot
        given = as_array(wrench, "external wrench", (robot.n_dof,), "N, N m")
        self.pushed = robot.pattern.basis(self.rotation) @ given if given.any() else None

    # --- the present state
    # -------------------------------------------------------------------------
    @property
    def position(self) -> Array:
        return self._row[self._position]

    @property
    def rotation(self) -> Array:
        return self._row[self._rotation].reshape(self._d, self._d)

    @property
    def twist(self) -> Array:
        return self._row[self._twist]

    @property
    def lengths(self) -> Array:
        return self._row[self._lengths]

    @property
    def tensions(self) -> Array:
        return self._row[self._tensions]

    @property
    def directions(self) -> Array:
        return self.whole_wrenches[:self._d].T

    @property
    def wrench_matrix(self) -> Array:
        robot, W = self.world.robot, self.whole_wrenches
        return W if len(W) == robot.n_dof else robot.pattern.project(W, self.rotation)

    @property
    def drawn(self) -> Array:
        """(m,) −B_b q̇_b, what driving bases draw of the cables: −u · Ȧ [m/s]."""
        return (self.directions * self.exit_velocities).sum(axis=1)

    @property
    def base_poses(self) -> Array:
        return np.asarray(self.bases.poses)

    @property
    def robot(self) -> Robot:
        """The robot with its bases where they are now."""
        stand, robot = self.base_poses, self.world.robot
        if stand is not self._stand:
            self._stand = stand
            self._present = robot.with_bases(dict(zip((base.name for base in robot.bases), stand)))
        return self._present

    @property
    def time(self) -> float:
        """Since the reset [s]."""
        return self.steps * self.dt

    def cables_at(self, pose: Pose) -> Cables:
        """Directions, lengths and wrench matrix if the platform were at a pose, the bases where they are."""
        return cables_at(self.robot, pose)

    @property
    def pose(self) -> Pose:
        return Pose.of(self.position, self.rotation)

    @property
    def shifts(self) -> Array | None:
        """(m, d) from exit to tangent points, None where no cable has a pulley [m]."""
        robot = self.robot
        return tangent_points(robot, self.pose) - robot.exit_points if robot.pulleys.size else None

    def hanging_lengths(self) -> Array:
        """(m,) rope lengths at which the robot hangs where it is: stretching ropes are wound shorter."""
        if self.elasticity is None:
            return self.lengths
        robot = self.robot
        held = distribute_tensions(self.wrench_matrix, gravity_wrench(robot, self.pose), robot.tension_min,
                                   robot.tension_max, "relaxed")
        return self.elasticity.unstrained(self.lengths, held.tensions)

    @property
    def rope_lengths(self) -> Array | None:
        """What the winches have let out of each rope, None where there are none [m]."""
        return frozen(self.paid_out.copy()) if self.is_wound else None

    def sample(self) -> Array:
        """Position, rotation (row by row), twist, lengths and tensions as one row of a log."""
        return self._row

    def columns(self) -> dict[str, tuple[tuple[int, ...], str]]:
        """Name → shape and unit of what `sample` gives, in its order."""
        robot = self.world.robot
        d, m = robot.dimension, robot.n_cables
        return {"position": ((d,), "m"), "rotation": ((d, d), ""),
                "twist": ((3 * (d - 1),), "m/s, rad/s"),
                "lengths": ((m,), "m"), "measured_tensions": ((m,), "N")}

    def state(self) -> State:
        """The present state."""
        return State(self.time, self.robot, self.position, self.rotation, self.twist, self.tensions,
                     self.world.scene, self.rope_lengths, tuple(self.boxes) if self.boxes else (), self.lengths,
                     self.bases.frames)

    def diverge(self) -> None:
        """Raise SimulationDiverged, which names the cable that pulls hardest."""
        pulls = np.where(np.isfinite(self.tensions), np.abs(self.tensions), np.inf)
        worst = int(pulls.argmax())
        raise SimulationDiverged(
            f"the simulation diverged at t = {self.time:.4g} s: the platform left the scene; cable {worst + 1} carried "
            f"most, {pulls[worst]:.3g} N; take a smaller dt or lower gains (K_d times the control period must stay "
            "below 2)", self.time, worst + 1)

    def jump_off(self) -> None:
        """Raise SimulationDiverged, which names the cable that cannot lie on its pulley."""
        cable = int(self.lengths.argmin())
        reason = why_no_direction(self.robot, self.pose)
        raise SimulationDiverged(f"at t = {self.time:.4g} s {reason or f'cable {cable + 1} jumped off its pulley'}",
                                 self.time, cable + 1)

    def __reduce__(self) -> Any:
        raise InvalidInput("a simulator cannot be pickled or copied: open one where it is needed")

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def cable_indices(cables: ArrayLike, m: int) -> list[int]:
    """Which of m cables are to be cut; raises InvalidInput unless they are indices from 0."""
    given = as_array(cables, "cables to cut", (), batch=True).ravel()
    if not np.isin(given, range(m)).all():
        raise InvalidInput(f"cables to cut are given by index, 0 to {m - 1}, got {quoted(cables)}")
    return [int(index) for index in given]
