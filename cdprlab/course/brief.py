"""A brief: what a robot is wanted for, judged point by point on anybody's world, with reasons that help."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from textwrap import fill
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Array, checked
from ..errors import InvalidInput, WorldError
from ..mechanics.cables import cable_lengths
from ..mechanics.statics import gravity_wrench, wrench_matrix
from ..robot import Robot, box_inertia
from ..robot.pose import Pose
from ..workspace.capacity import best_tensions
from ..workspace.grids import low_discrepancy_poses
from ..workspace.interference import cable_distances, cable_pairs, obstacle_distances, piercing_cables
from ..world import World, load_world
from .text_table import cable_names, in_brackets

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
    margin : smallest distance of a tension from its limits over the box, negative if it breaks
        them [N]
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
        return "\n".join(fill(f"{'✓' if point.met else '✗'} {point.name}: {point.words}", 95,
                              subsequent_indent="  ") for point in self.points)


@dataclass(frozen=True, eq=False)
class Brief:
    """A load to be held over a box of poses, by given winches in a given hall, with few cables.

    mass, size : of the platform with its load, a uniform box with P at its center [kg], (3,)
        [m]
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
        return Pose(self.lower + shares[:, :3] * (self.upper - self.lower),
                    rpy=np.pad(turns, ((0, 0), (2, 0))))

    def judge(self, design: World | Mapping[str, Any] | str | Path, poses: Pose | None = None) -> Verdict:
        """Look at a design, point by point; a point that others build on ends the list if it is not met.

        design : World, the mapping of a world file, or the path of one
        poses : Pose of batch (N,) to be held; default ``poses()``
        """
        try:
            world = _world(design)
        except (WorldError, InvalidInput) as error:
            return Verdict((Point("a world file", False, str(error)),), -np.inf)
        case = _Case(self, world, self.poses() if poses is None else poses)
        points: list[Point] = []
        for name, needed, look in _POINTS:
            met, words = look(case)
            points.append(Point(name, met, words))
            if needed and not met:
                return Verdict(tuple(points), -np.inf)
        return Verdict(tuple(points), case.worst.margin)

    def margins(self, robot: Robot, poses: Pose) -> Array:
        """(k, N) distance of the tensions from their limits at best, push by push of ``wrenches``, pose by pose [N]."""
        return np.array([s for s, _ in self.best_tensions(robot, poses)])

    def best_tensions(self, robot: Robot, poses: Pose) -> list[tuple[Array, Array]]:
        """For each push of ``wrenches`` those margins (N,) and the tensions (N, m) that have them [N]."""
        W = wrench_matrix(robot, poses)
        weight = np.broadcast_to(gravity_wrench(robot, poses), W.shape[:-1])
        return [best_tensions(W, weight + push, robot.tension_min, robot.tension_max)
                for push in self.wrenches]


_Found = tuple[bool, str]
"""Whether a point is met, and what to say of it."""


class _Worst(NamedTuple):
    """The smallest margin over all poses and pushes, the tensions there, where it is, and how many poses are held."""

    margin: float
    tensions: Array
    where: str
    held: str


@dataclass(frozen=True, eq=False)
class _Case:
    """A design before its brief; a method a point, each says whether it is met and what was found."""

    brief: Brief
    world: World
    poses: Pose

    @property
    def robot(self) -> Robot:
        return self.world.robot

    def freedoms(self) -> _Found:
        said = self.robot.motion_pattern
        if said == "3R3T":
            return True, said
        return False, f"the load must not swing or turn: 3R3T is needed, got {said}"

    def count(self) -> _Found:
        m = self.robot.n_cables
        if m < self.robot.n_dof:
            return False, (f"{m} cables cannot balance every push: W has {m} columns, pushes and weight need 6 "
                           "independent ones. Six is the least, with the weight as the seventh cable")
        return m <= self.brief.most_cables, f"{m}, allowed are {self.brief.most_cables}"

    def load(self) -> _Found:
        body, brief = self.robot.platform, self.brief
        uniform = box_inertia(brief.mass, brief.size)
        wrong = {"mass": abs(body.mass - brief.mass) > _ROUNDING,
                 "size": np.abs(body.size - brief.size).max() > _ROUNDING,
                 "center of mass": np.abs(body.center_of_mass).max() > _ROUNDING,
                 "box center": np.abs(body.center).max() > _ROUNDING,
                 "inertia": np.abs(body.inertia - uniform).max() > 1e-3 * uniform.max(),
                 "gravity": abs(self.robot.gravity - 9.81) > _ROUNDING}
        changed = ", ".join(name for name, is_wrong in wrong.items() if is_wrong)
        return not changed, (f"another {changed} than the brief's; the customer's load is not yours to change"
                             if changed else f"as given, {brief.mass:g} kg")

    def winches(self) -> _Found:
        low, high = self.brief.tension
        wrong = np.abs(self.robot.tension_min - low) > _ROUNDING
        wrong |= np.abs(self.robot.tension_max - high) > _ROUNDING
        given = f"{low:g} to {high:g} N"
        return _none(wrong, f"as given, {given}",
                     f"other limits than {given}; these winches are in stock")

    def exits(self) -> _Found:
        low, high = self.brief.hall
        exits = self.robot.exit_points
        out = ((exits < low - _ROUNDING) | (exits > high + _ROUNDING)).any(axis=1)
        return _none(out, "all in the hall", "exit points outside the hall")

    def anchors(self) -> _Found:
        off = (np.abs(self.robot.anchor_points) > self.brief.size / 2 + _ROUNDING).any(axis=1)
        return _none(off, "all on the load",
                     "anchor points beyond the box of the load: there is nothing to fix a cable to")

    def directions(self) -> _Found:
        limp = (cable_lengths(self.robot, self.poses) < 1e-9).any(axis=0)
        return _none(limp, "yes", "no length at some pose")

    @cached_property
    def worst(self) -> _Worst:
        found = self.brief.best_tensions(self.robot, self.poses)
        margins = np.array([s for s, _ in found])
        k, i = np.unravel_index(np.argmin(margins), margins.shape)
        held = int((margins.min(axis=0) >= 0).sum())
        return _Worst(float(margins[k, i]), found[k][1][i],
                      f"{_place(self.poses[int(i)])}, {_push(self.brief.wrenches[k])}",
                      f"{held} of {margins.shape[1]} poses are held")

    def holds(self) -> _Found:
        least, tau, where, held = self.worst
        if least >= -_ROUNDING * self.brief.tension[1]:
            return True, f"with {least:.0f} N to spare at {where}"
        advice = _advice(self.robot, tau, -least) if np.isfinite(least) else \
            "no tensions at all balance that, for W has lost rank there. Spread exit points and anchor points, so " \
            "that the cables' lines do not all meet"
        return False, f"{held}. The worst is {where}: {advice}"

    def apart(self) -> _Found:
        pairs = cable_pairs(self.robot)
        if not pairs:
            return True, "none can cross"
        gaps = cable_distances(self.robot, self.poses)
        nearest, worst = gaps.min(axis=0), gaps.argmin(axis=0)
        near = [f"{pairs[k][0] + 1} and {pairs[k][1] + 1} ({1e3 * nearest[k]:.0f} mm)"
                for k in np.argsort(nearest) if nearest[k] < self.brief.clearance]
        if near:
            place = _place(self.poses[int(worst[nearest.argmin()])])
            return False, (f"too near come cables {', '.join(near)}; the nearest at {place}. "
                           "Cables that share an exit or an anchor point never cross")
        return True, f"by {1e3 * nearest.min():.0f} mm at least"

    def free(self) -> _Found:
        robot, poses = self.robot, self.poses
        inside = (np.abs(robot.anchor_points) < self.brief.size / 2 - _ROUNDING).all(axis=1)
        bad = inside if inside.any() else piercing_cables(robot, poses).any(axis=0)
        if bad.any():
            return _none(bad, "", "to pass through the load itself. Anchor it on a face, an edge or a corner that "
                                  "looks towards its exit point")
        for box in self.world.scene.boxes:
            if (obstacle_distances(robot, poses, box) < self.brief.clearance).any():
                return False, f"a cable touches {box.name or 'a box'} of the scene"
        return True, "none touches the load or what stands around"


_POINTS: tuple[tuple[str, bool, Callable[[_Case], _Found]], ...] = (
    ("six degrees of freedom", True, _Case.freedoms),
    ("number of cables", True, _Case.count),
    ("the load", False, _Case.load),
    ("the winches", False, _Case.winches),
    ("exit points", False, _Case.exits),
    ("anchor points", False, _Case.anchors),
    ("every cable has a direction", True, _Case.directions),
    ("holds the load everywhere", False, _Case.holds),
    ("cables keep apart", False, _Case.apart),
    ("cables run freely", False, _Case.free),
)
"""Name, whether the points after it build on it, and who looks; the most basic first."""


@checked
def workshop_brief(most_cables: int = 8) -> Brief:
    """The brief of the capstone lesson: engine blocks in a workshop.

    >>> workshop_brief().judge("caroca").reasons[0][:9]
    'the load:'
    """
    return Brief(
        mass=80.0, size=np.array([0.8, 0.6, 0.4]), lower=np.array([-0.8, -0.5, 0.6]),
        upper=np.array([0.8, 0.5, 1.4]),
        yaw=float(np.deg2rad(10)), pushes=np.array([40.0, 40.0, 0.0, 4.0, 4.0, 4.0]),
        hall=np.array([[-3.0, -2.2, 0.0], [3.0, 2.2, 3.6]]), tension=(15.0, 700.0),
        clearance=0.05,
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


def _none(wrong: Any, well: str, ill: str) -> _Found:
    """Met where no cable is wrong; else which cables have what."""
    have = "has" if wrong.sum() == 1 else "have"
    return not wrong.any(), f"{cable_names(wrong)} {have} {ill}" if wrong.any() else well


def _advice(robot: Robot, tau: Array, missing: float) -> str:
    low, high = robot.tension_min - tau, tau - robot.tension_max
    if low.max() > high.max() + 1e-6:      # as much of both is missing: the winch is told
        i = np.argmax(low)
        return (f"at best cable {i + 1} has {tau[i]:.0f} N, {missing:.0f} N short of what keeps it taut. The others do "
                "its work there: move its exit point outwards, or its anchor point to the other side")
    i = np.argmax(high)
    return (f"at best cable {i + 1} needs {tau[i]:.0f} N, {missing:.0f} N more than its winch has. Flat cables pull "
            "hard and lift little, parallel ones turn nothing: move exit points up, or cross the cables")


def _place(pose: Pose) -> str:
    return f"{in_brackets(pose.position, 2)} m, turned by {np.rad2deg(pose.rpy[2]):.0f}°"


def _push(wrench: Array) -> str:
    if not wrench.any():
        return "not pushed"
    k = np.argmax(np.abs(wrench))
    return f"pushed with {_AXES[k]} = {wrench[k]:g} {'N' if k < 3 else 'N m'}"
