"""What every engine does: the interface and its checks, winches within their limits, cuts and pushes."""

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
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
    """

    boxes: Any = ()
    robot: Robot
    carrying: Robot
    exit_velocities: Array
    position: Array
    rotation: Array
    twist: Array
    tensions: Array
    wrench_matrix: Array
    lengths: Array
    directions: Array
    base_poses: Array
    ropes: RopeLaw

    def __init__(self, world: World, cables: str, dt: float) -> None:
        if cables == "elastic" and world.robot.elasticity is None:
            raise InvalidInput(f"cables=\"elastic\" needs the ropes' stiffness: world {world.name!r} has no "
                               "`cable: {axial_stiffness: …}` block")
        self.world, self.cables, self.dt = world, cables, float(dt)
        self.is_wound = cables in WOUND
        self.paid_out: list[float] = []
        self._most = (world.robot.speed_max * self.dt).tolist()   # wound in one step
        self._surely = min(self._most)

    # --- what each engine does in its own way
    # --------------------------------------------------------
    @abstractmethod
    def place(self, start: Pose) -> None:
        """Put the robot at rest at a pose, all cables whole, and what its winches have paid out to what holds it."""

    @abstractmethod
    def pull(self, tensions: Array, substeps: int) -> None:
        """Advance by ``substeps`` × dt with these (m,) cable tensions held [N]."""

    @abstractmethod
    def reel(self, lengths: list[float]) -> None:
        """Advance by dt, by whose end no rope is longer than these (m,) lengths [m]."""

    @abstractmethod
    def sever(self, cable: int) -> None:
        """Cut a cable that is whole, given by index."""

    @abstractmethod
    def sample(self) -> Sequence[float]:
        """Position, rotation (row by row), twist, lengths and tensions as one row of a log."""

    @abstractmethod
    def contact_force(self) -> float:
        """Sum of the normal contact forces on the platform during the last step [N]."""

    @abstractmethod
    def close(self) -> None:
        """Release the engine; safe to call twice."""

    def drive(self, speeds: ArrayLike) -> Array:
        """Let the mobile bases drive on at these (3p,) speeds; returns them as their limits allow [rad/s, m/s]."""
        raise InvalidInput(f"{type(self).__name__} has no bases that drive: planar worlds have")

    # --- the interface
    # ----------------------------------------------------------------------------
    @checked
    def reset(self, pose: Pose | None = None) -> State:
        """Put the robot at rest at a pose (default the world's), all cables whole; time starts at 0."""
        start = self.world.pose if pose is None else pose
        check_pose(start, self.world.robot, ("pose",))
        self.steps = 0
        self.strongest: Array | None = None
        self.cut_cables: set[int] = set()
        self.pushed: Array | None = None
        self.place(start)
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
        return self.bring(wanted.tolist(), as_count(substeps, "substeps"))

    def bring(self, lengths: list[float], substeps: int) -> bool:
        """What `wind` does with (m,) numbers; a loop asks for nothing else."""
        before, after = self.paid_out, lengths
        # Mostly all ropes together change by less than any one of them may.
        if not (math.dist(lengths, before) < self._surely * substeps and min(lengths) > 0):
            after = self._reachable(lengths, substeps)
        ways = [after]
        if substeps > 1:
            ways = [[a + k / substeps * (b - a) for a, b in zip(before, after)] for k in range(1, substeps)] + ways
        for held in ways:
            self.reel(held)
            self.paid_out = held
            if self.strongest is not None:
                self._slip(self.strongest)
        return after is lengths and (self.strongest is None or not self.slipping.any())

    def rope_tensions(self, lengths: list[float], W: Array) -> Array:
        """(m,) of ropes let out to these lengths by the step's end, as `ropes` has them; W : in all rows [N]."""
        wound = np.array(lengths)
        if self.cut_cables:
            cut = list(self.cut_cables)
            wound[cut] = self.lengths[cut] + _AMPLE
        if self.world.robot.bases:   # one that drives away in the step needs that much more rope
            wound -= self.dt * (self.directions * self.exit_velocities).sum(axis=1)
        pulls = self.ropes(W, self.rotation, self.twist, self.lengths, np.array(self.paid_out), wound,
                           np.zeros(len(W)) if self.pushed is None else self.pushed)
        return pulls if self.strongest is None else np.minimum(pulls, self.strongest)

    def _slip(self, strongest: Array) -> None:
        """Let out what ropes drew that pull as hard as their winches can."""
        elastic = self.world.robot.elasticity if self.cables == "elastic" else None
        held, drawn = np.array(self.paid_out), self.lengths
        if elastic is not None:
            drawn = elastic.unstrained(drawn, self.tensions)
        # A reaction is known to a small part of it: legs have tips.
        self.slipping = (self.tensions > 0.99 * strongest) & (drawn > held)
        self.paid_out = np.where(self.slipping, drawn, held).tolist()

    def _reachable(self, wanted: list[float], substeps: int) -> list[float]:
        """The wanted lengths as far as the winches' speed limits allow; the same list if they all do."""
        now = self.paid_out
        if not all(0 < wish < math.inf for wish in wanted):
            raise InvalidInput(f"rope lengths must be {len(now)} positive numbers [m], got {quoted(wanted)}")
        # A winch exactly at its limit must not fail by rounding.
        farthest = [most * substeps + 1e-9 for most in self._most]
        reached = [min(max(wish, rope - far), rope + far)
                   for wish, rope, far in zip(wanted, now, farthest)]
        return wanted if reached == wanted else reached

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

    @property
    def time(self) -> float:
        """Since the reset [s]."""
        return self.steps * self.dt

    def cables_at(self, pose: Pose) -> Cables:
        """Directions, lengths and wrench matrix if the platform were at a pose, the bases where they are."""
        return cables_at(self.robot, pose)

    @property
    def shifts(self) -> Array | None:
        """(m, d) from exit to tangent points, None where no cable has a pulley [m]."""
        robot = self.robot
        if not robot.pulleys.size:
            return None
        return tangent_points(robot, Pose.of(self.position, self.rotation)) - robot.exit_points

    def hanging_lengths(self) -> list[float]:
        """(m,) rope lengths at which the robot hangs where it is: stretching ropes are wound shorter."""
        robot, lengths = self.robot, self.lengths
        if self.cables == "elastic" and robot.elasticity is not None:
            held = distribute_tensions(self.wrench_matrix, gravity_wrench(robot, Pose.of(self.position, self.rotation)),
                                       robot.tension_min, robot.tension_max, "relaxed")
            lengths = robot.elasticity.unstrained(lengths, held.tensions)
        wound: list[float] = lengths.tolist()
        return wound

    @property
    def rope_lengths(self) -> Array | None:
        """What the winches have let out of each rope, None where there are none [m]."""
        return frozen(np.array(self.paid_out)) if self.is_wound else None

    def columns(self) -> dict[str, tuple[tuple[int, ...], str]]:
        """Name → shape and unit of what `sample` gives, in its order."""
        robot = self.world.robot
        d, m = robot.dimension, robot.n_cables
        return {"position": ((d,), "m"), "rotation": ((d, d), ""),
                "twist": ((3 * (d - 1),), "m/s, rad/s"),
                "lengths": ((m,), "m"), "measured_tensions": ((m,), "N")}

    @property
    def base_frames(self) -> Array | None:
        """(p, 3, 4) rotation and center of mass of each base that may lean; None where none can."""
        return None

    def state(self) -> State:
        """The present state."""
        return State(self.time, self.robot, self.position, self.rotation, self.twist,
                     self.tensions,
                     self.world.scene, self.rope_lengths, tuple(self.boxes) if self.boxes else (),
                     self.lengths, self.base_frames)

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
        reason = why_no_direction(self.robot, Pose.of(self.position, self.rotation))
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
    indices: list[int] = given.astype(int).tolist()
    return indices
