"""A brief: what a robot is wanted for, judged point by point on anybody's world, with reasons that help."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Array
from ..errors import InvalidInput, WorldError
from ..mechanics.cables import cable_lengths
from ..mechanics.statics import gravity_wrench, wrench_matrix
from ..robot import Robot
from ..robot.pose import Pose
from ..workspace.capacity import best_tensions
from ..workspace.grids import low_discrepancy_poses
from ..workspace.interference import cable_distances, cable_pairs, obstacle_distances, platform_distances
from ..world import World, load_world

_ROUNDING = 1e-6
_AXES = ("f_x", "f_y", "f_z", "m_x", "m_y", "m_z")


class Point(NamedTuple):
    """One point of a brief: its name, whether it is met, and what was found."""

    name: str
    met: bool
    words: str


class Verdict(NamedTuple):
    """What became of a brief, point by point; prints as a list.

    points : Point a requirement; those that could not be looked at are missing
    margin : smallest distance of a tension from its limits over the box, negative if it breaks them [N]
    """

    points: tuple[Point, ...]
    margin: float

    @property
    def met(self) -> bool:
        """Whether every point is."""
        return all(point.met for point in self.points)

    @property
    def reasons(self) -> tuple[str, ...]:
        """Why not, most basic first; empty if all is met."""
        return tuple(f"{point.name}: {point.words}" for point in self.points if not point.met)

    def __str__(self) -> str:
        return "\n".join(f"{'✓' if point.met else '✗'} {point.name}: {point.words}" for point in self.points)


class _Unusable(Exception):
    """A point that the following ones build on is not met."""


@dataclass(frozen=True, eq=False)
class Brief:
    """A load to be held over a box of poses, by given winches in a given hall, with few cables.

    mass, size : of the platform with its load, a uniform box with P at its center [kg], (3,) [m]
    lower, upper : (3,) corners of the box of positions of P [m]
    yaw : largest turn about the vertical, either way [rad]
    pushes : (6,) external forces and moments either way, one at a time [N, N m]
    hall : (2, 3) corners of where exit points may be mounted [m]
    tension : smallest and largest, of every winch [N]
    clearance : between cables, of those that share no end [m]
    most_cables : allowed
    """

    mass: float
    size: Array
    lower: Array
    upper: Array
    yaw: float
    pushes: Array
    hall: Array
    tension: tuple[float, float]
    clearance: float
    most_cables: int

    def __str__(self) -> str:
        def to(low: Array, high: Array) -> str:
            return " × ".join(f"{a:g} to {b:g}" for a, b in zip(low, high))

        pushes = ", ".join(f"{axis} {push:g} {'N' if axis[0] == 'f' else 'N m'}"
                           for axis, push in zip(_AXES, self.pushes) if push)
        lines = {
            "load": f"{self.mass:g} kg, a box of {' × '.join(f'{edge:g}' for edge in self.size)} m, P at its center",
            "positions of P": f"{to(self.lower, self.upper)} m",
            "orientation": f"level, turned by up to {np.rad2deg(self.yaw):g}° either way about the vertical",
            "pushes": f"{pushes}; either way, one at a time",
            "exit points": f"{to(*self.hall)} m",
            "winches": f"{self.tension[0]:g} to {self.tension[1]:g} N",
            "clearance": f"{self.clearance:g} m between cables",
            "cables": f"at most {self.most_cables}",
        }
        return "\n".join(f"{name:<16}{words}" for name, words in lines.items())

    @property
    def wrenches(self) -> Array:
        """(k, 6) no push, and every push either way [N, N m]."""
        single = np.diag(self.pushes)[self.pushes > 0]
        return np.concatenate([np.zeros((1, 6)), single, -single])

    def poses(self, seed: int | None = None, count: int = 200) -> Pose:
        """The corners, edges, faces and the middle of the box at three headings; with a seed, ``count`` in between."""
        if seed is not None:
            spread = low_discrepancy_poses(self.lower, self.upper, count, seed, turn=self.yaw)
            return Pose(spread.position, rpy=spread.rpy * [0.0, 0.0, 1.0])
        shares = np.stack(np.meshgrid(*[[0.0, 0.5, 1.0]] * 4, indexing="ij"), axis=-1).reshape(-1, 4)
        turns = self.yaw * (2 * shares[:, 3:] - 1)
        return Pose(self.lower + shares[:, :3] * (self.upper - self.lower), rpy=np.pad(turns, ((0, 0), (2, 0))))

    def judge(self, design: World | Mapping[str, Any] | str | Path, poses: Pose | None = None) -> Verdict:
        """Look at a design, point by point; a point that others build on ends the list if it is not met.

        design : World, the mapping of a world file, or the path of one
        poses : Pose of batch (N,) to be held; default ``poses()``
        """
        points: list[Point] = []
        margin = -np.inf
        at = self.poses() if poses is None else poses

        def look(name: str, words: Callable[[], tuple[bool, str]], needed: bool = False) -> None:
            met, said = words()
            points.append(Point(name, met, said))
            if needed and not met:
                raise _Unusable

        try:
            world = _world(design)
        except (WorldError, InvalidInput) as error:
            return Verdict((Point("a world file", False, str(error)),), margin)
        robot = world.robot
        try:
            look("six degrees of freedom", lambda: _spatial(robot), needed=True)
            look("number of cables", lambda: self._count(robot), needed=True)
            look("the load", lambda: self._load(robot))
            look("the winches", lambda: self._winches(robot))
            look("exit points", lambda: self._exits(robot))
            look("anchor points", lambda: self._anchors(robot))
            look("every cable has a direction", lambda: _directed(robot, at), needed=True)
            margin, at_worst = self._worst(robot, at)
            look("holds the load everywhere", lambda: at_worst)
            look("cables keep apart", lambda: self._apart(robot, at))
            look("cables run freely", lambda: self._free(world, at))
        except _Unusable:
            pass
        return Verdict(tuple(points), margin)

    # --- points -----------------------------------------------------------------------------------------------
    def _count(self, robot: Robot) -> tuple[bool, str]:
        m = robot.n_cables
        if m < robot.n_dof:
            return False, (f"{m} cables cannot balance every push: W has {m} columns, pushes and weight need 6 "
                           "independent ones. Six is the least, with the weight as the seventh cable")
        return m <= self.most_cables, f"{m}, allowed are {self.most_cables}"

    def _load(self, robot: Robot) -> tuple[bool, str]:
        body = robot.platform
        uniform = self.mass / 12 * ((self.size**2).sum() - self.size**2)
        wrong = {"mass": abs(body.mass - self.mass) > _ROUNDING,
                 "size": np.abs(body.size - self.size).max() > _ROUNDING,
                 "center of mass": np.abs(body.center_of_mass).max() > _ROUNDING,
                 "box center": np.abs(body.center).max() > _ROUNDING,
                 "inertia": np.abs(body.inertia - np.diag(uniform)).max() > 1e-3 * uniform.max(),
                 "gravity": abs(robot.gravity - 9.81) > _ROUNDING}
        changed = [name for name, is_wrong in wrong.items() if is_wrong]
        return not changed, (f"as given, {self.mass:g} kg" if not changed else f"another {', '.join(changed)} than the "
                             "brief's; the customer's load is not yours to change")

    def _winches(self, robot: Robot) -> tuple[bool, str]:
        low, high = self.tension
        wrong = (np.abs(robot.tension_min - low) > _ROUNDING) | (np.abs(robot.tension_max - high) > _ROUNDING)
        given = f"{low:g} to {high:g} N"
        return not wrong.any(), (f"as given, {given}" if not wrong.any() else
                                 f"{_cables(wrong)} other limits than {given}; these winches are in stock")

    def _exits(self, robot: Robot) -> tuple[bool, str]:
        low, high = self.hall
        out = ((robot.exit_points < low - _ROUNDING) | (robot.exit_points > high + _ROUNDING)).any(axis=1)
        return not out.any(), "all in the hall" if not out.any() else f"{_cables(out)} outside the hall"

    def _anchors(self, robot: Robot) -> tuple[bool, str]:
        off = (np.abs(robot.anchor_points) > self.size / 2 + _ROUNDING).any(axis=1)
        return not off.any(), "all on the load" if not off.any() else (
            f"{_cables(off)} beyond the box of the load: there is nothing to fix a cable to")

    def margins(self, robot: Robot, poses: Pose) -> Array:
        """(k, N) distance of the tensions from their limits at best, push by push of ``wrenches``, pose by pose [N]."""
        return np.array([s for s, _ in self._best(robot, poses)])

    def _best(self, robot: Robot, poses: Pose) -> list[tuple[Array, Array]]:
        W = wrench_matrix(robot, poses)
        weight = np.broadcast_to(gravity_wrench(robot, poses), W.shape[:-1])
        return [best_tensions(W, weight + push, robot.tension_min, robot.tension_max) for push in self.wrenches]

    def _worst(self, robot: Robot, poses: Pose) -> tuple[float, tuple[bool, str]]:
        """The smallest margin over all poses and pushes, and what to say about the place where it is."""
        found = self._best(robot, poses)
        margins = np.array([s for s, _ in found])
        k, i = np.unravel_index(int(np.argmin(margins)), margins.shape)
        least, tau = float(margins[k, i]), found[k][1][i]
        where = f"{_place(poses[int(i)])}, {_push(self.wrenches[k])}"
        if least >= -_ROUNDING * self.tension[1]:
            return least, (True, f"with {least:.0f} N to spare at {where}")
        held = int((margins.min(axis=0) >= 0).sum())
        share = f"{held} of {margins.shape[1]} poses are held. The worst is {where}: "
        if not np.isfinite(least):
            return least, (False, share + "no tensions at all balance that, for W has lost rank there. Spread exit "
                                          "points and anchor points, so that the cables' lines do not all meet")
        return least, (False, share + _advice(robot, tau, -least))

    def _apart(self, robot: Robot, poses: Pose) -> tuple[bool, str]:
        pairs = cable_pairs(robot)
        gaps = cable_distances(robot, poses) if pairs else np.full((len(poses.position), 1), np.inf)
        i, k = np.unravel_index(int(np.argmin(gaps)), gaps.shape)
        if gaps[i, k] < self.clearance:
            one, other = pairs[k]
            return False, (f"cables {one + 1} and {other + 1} come as near as {1e3 * gaps[i, k]:.0f} mm, at "
                           f"{_place(poses[int(i)])}. Cables that share an exit or an anchor point never cross")
        spare = float(gaps.min())
        return True, "none can cross" if not np.isfinite(spare) else f"by {1e3 * spare:.0f} mm at least"

    def _free(self, world: World, poses: Pose) -> tuple[bool, str]:
        robot = world.robot
        inside = (np.abs(robot.anchor_points) < self.size / 2 - _ROUNDING).all(axis=1)
        through = (platform_distances(robot, poses) < 1e-9) & ~inside
        if through.any() or inside.any():
            bad = inside if inside.any() else through.any(axis=0)
            return False, (f"{_cables(bad)} to pass through the load itself. Anchor it on a face, an edge or a corner "
                           "that looks towards its exit point")
        for box in world.scene.boxes:
            if (obstacle_distances(robot, poses, box) < self.clearance).any():
                return False, f"a cable touches {box.name or 'a box'} of the scene"
        return True, "none touches the load or what stands around"


def workshop_brief(most_cables: int = 8) -> Brief:
    """The brief of the capstone lesson: engine blocks in a workshop.

    >>> workshop_brief().judge("caroca").reasons[0][:9]
    'the load:'
    """
    return Brief(
        mass=80.0, size=np.array([0.8, 0.6, 0.4]), lower=np.array([-0.8, -0.5, 0.6]), upper=np.array([0.8, 0.5, 1.4]),
        yaw=float(np.deg2rad(10)), pushes=np.array([40.0, 40.0, 0.0, 4.0, 4.0, 4.0]),
        hall=np.array([[-3.0, -2.2, 0.0], [3.0, 2.2, 3.6]]), tension=(15.0, 700.0), clearance=0.05,
        most_cables=most_cables)


# --- words ----------------------------------------------------------------------------------------------------
def _world(design: Any) -> World:
    if isinstance(design, World):
        return design
    if isinstance(design, Mapping):
        return World.from_dict(design, path="your design")
    if isinstance(design, str | Path):
        return load_world(design)
    raise InvalidInput("a design is a World, the mapping of a world file, or the path of one, got "
                       f"{type(design).__name__}")


def _spatial(robot: Robot) -> tuple[bool, str]:
    said = robot.motion_pattern
    return said == "3R3T", said if said == "3R3T" else f"the load must not swing or turn: 3R3T is needed, got {said}"


def _directed(robot: Robot, poses: Pose) -> tuple[bool, str]:
    limp = (cable_lengths(robot, poses) < 1e-9).any(axis=0)
    return not limp.any(), "yes" if not limp.any() else f"{_cables(limp)} no length at some pose"


def _advice(robot: Robot, tau: Array, missing: float) -> str:
    low, high = robot.tension_min - tau, tau - robot.tension_max
    if low.max() > high.max() + 1e-6:      # as much of both is missing: the winch is told
        i = int(np.argmax(low))
        return (f"at best cable {i + 1} has {tau[i]:.0f} N, {missing:.0f} N short of what keeps it taut. The others do "
                "its work there: move its exit point outwards, or its anchor point to the other side")
    i = int(np.argmax(high))
    return (f"at best cable {i + 1} needs {tau[i]:.0f} N, {missing:.0f} N more than its winch has. Flat cables pull "
            "hard and lift little, parallel ones turn nothing: move exit points up, or cross the cables")


def _cables(which: Any) -> str:
    numbers = [str(i + 1) for i in np.flatnonzero(which)]
    return f"cable {numbers[0]} has" if len(numbers) == 1 else f"cables {', '.join(numbers)} have"


def _place(pose: Pose) -> str:
    x, y, z = pose.position
    return f"({x:.2f}, {y:.2f}, {z:.2f}) m, turned by {np.rad2deg(pose.rpy[2]):.0f}°"


def _push(wrench: Array) -> str:
    if not wrench.any():
        return "not pushed"
    k = int(np.argmax(np.abs(wrench)))
    return f"pushed with {_AXES[k]} = {wrench[k]:g} {'N' if k < 3 else 'N m'}"
