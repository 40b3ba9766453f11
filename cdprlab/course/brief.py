"""A brief: what a robot is wanted for, judged point by point on anybody's world, with reasons that help."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from textwrap import fill
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Array, checked
from ..errors import InvalidInput
from ..mechanics.cables import cable_lengths
from ..mechanics.statics import gravity_wrench, wrench_matrix
from ..robot import Robot, box_inertia
from ..robot.pose import Pose
from ..workspace.capacity import best_tensions
from ..workspace.grids import low_discrepancy_poses
from ..workspace.interference import cable_distances, cable_pairs, obstacle_distances, piercing_cables
from ..world import World, load_world
from ..world.document import parsed, plain
from .text_table import cable_names, in_brackets

_WORKSHOP = Path(__file__).with_name("workshop.yaml")
_ROUNDING = 1e-6
_AXES = ("f_x", "f_y", "f_z", "m_x", "m_y", "m_z")


class Point(NamedTuple):
    """One point of a brief.

    words : what was found
    margin : smallest distance of a tension from its limits over the box, negative if it breaks
        them [N]; −inf for a point that does not look at tensions
    """

    name: str
    met: bool
    words: str
    margin: float = -np.inf


class Verdict(NamedTuple):
    """What became of a brief, point by point; prints as a list.

    points : Point a requirement; those that could not be looked at are missing
    margin : the one that was found, else −inf [N]
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
    tension : (2,) smallest and largest, of every winch [N]
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
    tension: Array
    clearance: float
    most_cables: int

    def __str__(self) -> str:
        def to(low: Array, high: Array) -> str:
            return " × ".join(f"{a:g} to {b:g}" for a, b in zip(low, high))

        pushes = ", ".join(f"{axis} {push:g} {'N' if axis[0] == 'f' else 'N m'}"
                           for axis, push in zip(_AXES, self.pushes) if push)
        return (
            f"load            {self.mass:g} kg, a box of {' × '.join(f'{edge:g}' for edge in self.size)} m, "
            "P at its center\n"
            f"positions of P  {to(self.lower, self.upper)} m\n"
            f"orientation     level, turned by up to {np.rad2deg(self.yaw):g}° either way about the vertical\n"
            f"pushes          {pushes}; either way, one at a time\n"
            f"exit points     {to(*self.hall)} m\n"
            f"winches         {self.tension[0]:g} to {self.tension[1]:g} N\n"
            f"clearance       {self.clearance:g} m between cables\n"
            f"cables          at most {self.most_cables}")

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
        shares = np.array([*product((0.0, 0.5, 1.0), repeat=4)])
        return Pose(self.lower + shares[:, :3] * (self.upper - self.lower),
                    rpy=self.yaw * (2 * shares[:, 3:] - 1) * [0.0, 0.0, 1.0])

    def judge(self, design: World | Mapping[str, Any] | str | Path, poses: Pose | None = None) -> Verdict:
        """Look at a design, point by point; a point that others build on ends the list if it is not met.

        design : World, the mapping of a world file, or the path of one
        poses : Pose of batch (N,) to be held; default ``poses()``
        """
        try:
            world = _world(design)
        except InvalidInput as error:
            return Verdict((Point("a world file", False, str(error)),), -np.inf)
        points = tuple(_points(self, world, self.poses() if poses is None else poses))
        return Verdict(points, max(point.margin for point in points))

    def margins(self, robot: Robot, poses: Pose) -> Array:
        """(k, N) distance of the tensions from their limits at best, push by push of ``wrenches``, pose by pose [N]."""
        return self.best_tensions(robot, poses)[0]

    def best_tensions(self, robot: Robot, poses: Pose) -> tuple[Array, Array]:
        """Those margins, and (k, N, m) the tensions that have them [N]."""
        W, weight = wrench_matrix(robot, poses), gravity_wrench(robot, poses)
        margins, tensions = zip(*(best_tensions(W, weight + push, robot.tension_min, robot.tension_max)
                                  for push in self.wrenches))
        return np.array(margins), np.array(tensions)


@checked
def workshop_brief(most_cables: int = 8) -> Brief:
    """The brief of the capstone lesson: engine blocks in a workshop.

    >>> workshop_brief().judge("caroca").reasons[0][:9]
    'the load:'
    """
    said: dict[str, Any] = plain(parsed(_WORKSHOP.read_text(encoding="utf-8"), _WORKSHOP.name))
    arrays = {name: np.array(value) for name, value in said.items() if isinstance(value, list)}
    return Brief(**said | arrays, most_cables=most_cables)


# --- point by point -----------------------------------------------------------------------------------------
def _points(brief: Brief, world: World, poses: Pose) -> Iterator[Point]:
    """The most basic first; one that the others build on is the last if it is not met."""
    robot, pattern, m = world.robot, world.robot.motion_pattern, world.robot.n_cables
    free, enough = pattern == "3R3T", 6 <= m <= brief.most_cables
    yield Point("six degrees of freedom", free, pattern if free else
                f"the load must not swing or turn: 3R3T is needed, got {pattern}")
    if not free:
        return
    yield Point("number of cables", enough, f"{m}, allowed are {brief.most_cables}" if m >= 6 else
                f"{m} cables cannot balance every push: W has {m} columns, pushes and weight need 6 "
                "independent ones. Six is the least, with the weight as the seventh cable")
    if not enough:
        return
    yield _load(brief, robot)
    low, high = brief.tension
    limits = np.transpose([robot.tension_min - low, robot.tension_max - high])
    yield _cables("the winches", limits, f"as given, {low:g} to {high:g} N",
                  f"other limits than {low:g} to {high:g} N; these winches are in stock")
    exits, beyond = robot.exit_points, np.abs(robot.anchor_points) - brief.size / 2
    yield _cables("exit points", exits - exits.clip(*brief.hall), "all in the hall", "exit points outside the hall")
    yield _cables("anchor points", beyond.clip(min=0.0), "all on the load",
                  "anchor points beyond the box of the load: there is nothing to fix a cable to")
    limp = (cable_lengths(robot, poses) < 1e-9).T
    yield _cables("every cable has a direction", limp, "yes", "no length at some pose")
    if limp.any():
        return
    yield _held(brief, robot, poses)
    yield _apart(brief, robot, poses)
    inside = (beyond < -_ROUNDING).all(axis=1)
    pierces: Any = inside if inside.any() else piercing_cables(robot, poses).any(axis=0)
    touched = [f"a cable touches {box.name or 'a box'} of the scene" for box in world.scene.boxes
               if (obstacle_distances(robot, poses, box) < brief.clearance).any()]
    if touched and not pierces.any():
        yield Point("cables run freely", False, touched[0])
    else:
        yield _cables("cables run freely", pierces[:, None], "none touches the load or what stands around",
                      "to pass through the load itself. Anchor it on a face, an edge or a corner that looks "
                      "towards its exit point")


def _load(brief: Brief, robot: Robot) -> Point:
    body, uniform = robot.platform, box_inertia(brief.mass, brief.size)
    off = {"mass": body.mass - brief.mass, "size": body.size - brief.size, "center of mass": body.center_of_mass,
           "box center": body.center, "inertia": 1e-3 * (body.inertia - uniform) / uniform.max(),
           "gravity": robot.gravity - 9.81}
    changed = ", ".join(name for name, error in off.items() if np.abs(error).max() > _ROUNDING)
    return Point("the load", not changed,
                 f"another {changed} than the brief's; the customer's load is not yours to change"
                 if changed else f"as given, {brief.mass:g} kg")


def _held(brief: Brief, robot: Robot, poses: Pose) -> Point:
    margins, tensions = brief.best_tensions(robot, poses)
    k, i = np.unravel_index(margins.argmin(), margins.shape)
    least = float(margins[k, i])
    where = f"{_place(poses[int(i)])}, {_push(brief.wrenches[k])}"
    if least >= -_ROUNDING * brief.tension[1]:
        return Point("holds the load everywhere", True, f"with {least:.0f} N to spare at {where}", least)
    held = (margins.min(axis=0) >= 0).sum()
    return Point("holds the load everywhere", False,
                 f"{held} of {margins.shape[1]} poses are held. The worst is {where}: "
                 f"{_advice(robot, tensions[k, i], -least)}", least)


def _apart(brief: Brief, robot: Robot, poses: Pose) -> Point:
    pairs = cable_pairs(robot)
    if not pairs:
        return Point("cables keep apart", True, "none can cross")
    gaps = cable_distances(robot, poses)
    nearest = gaps.min(axis=0)
    near = [f"{pairs[k][0] + 1} and {pairs[k][1] + 1} ({1e3 * nearest[k]:.0f} mm)"
            for k in np.argsort(nearest) if nearest[k] < brief.clearance]
    place = _place(poses[int(gaps.min(axis=1).argmin())])
    return Point("cables keep apart", not near,
                 f"too near come cables {', '.join(near)}; the nearest at {place}. "
                 "Cables that share an exit or an anchor point never cross"
                 if near else f"by {1e3 * nearest.min():.0f} mm at least")


def _cables(name: str, errors: Any, well: str, ill: str) -> Point:
    """Met where no cable is wrong; else which cables have what.

    errors : (m, …) of each; what is as small as rounding is none
    """
    wrong = (np.abs(errors) > _ROUNDING).any(axis=1)
    return Point(name, not wrong.any(), f"{cable_names(wrong)} {'has' if wrong.sum() == 1 else 'have'} {ill}"
                 if wrong.any() else well)


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


def _advice(robot: Robot, tau: Array, missing: float) -> str:
    if not np.isfinite(missing):
        return ("no tensions at all balance that, for W has lost rank there. Spread exit points and anchor points, so "
                "that the cables' lines do not all meet")
    low, high = robot.tension_min - tau, tau - robot.tension_max
    if low.max() > high.max() + 1e-6:      # as much of both is missing: the winch is told
        i = low.argmax()
        return (f"at best cable {i + 1} has {tau[i]:.0f} N, {missing:.0f} N short of what keeps it taut. The others do "
                "its work there: move its exit point outwards, or its anchor point to the other side")
    i = high.argmax()
    return (f"at best cable {i + 1} needs {tau[i]:.0f} N, {missing:.0f} N more than its winch has. Flat cables pull "
            "hard and lift little, parallel ones turn nothing: move exit points up, or cross the cables")


def _place(pose: Pose) -> str:
    return f"{in_brackets(pose.position, 2)} m, turned by {np.rad2deg(pose.rpy[2]):.0f}°"


def _push(wrench: Array) -> str:
    if not wrench.any():
        return "not pushed"
    k = np.argmax(np.abs(wrench))
    return f"pushed with {_AXES[k]} = {wrench[k]:g} {'N' if k < 3 else 'N m'}"
