"""Move the platform; see its cables, their lengths and the wrench matrix."""

from itertools import product

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from ...arrays import Array
from ...errors import InvalidInput, quoted
from ...mechanics.cables import cable_lengths
from ...mechanics.statics import wrench_matrix
from ...robot import Robot
from ...robot.pose import Pose
from ...view.drawing import RobotDrawing
from ...view.outlines import EMPTY, floor_height
from ...view.style import INK
from ...world import World
from ..text_table import cable_table, fixed
from .explorer import Explorer, Slider, Values

EYE = Slider("azimuth", "seen from", "deg", -180.0, 180.0, 25.0, 5.0)
"""Walks around a spatial robot."""

_TURNS = {"roll": 60.0, "pitch": 60.0, "yaw": 90.0, "angle": 90.0}
"""How far sliders turn the platform either way [deg]; pitch stays clear of ±90, where rpy is not unique."""

ROW_NAMES = {"x": "f_x", "y": "f_y", "z": "f_z", "rx": "m_x [m]", "ry": "m_y [m]",
             "rz": "m_z [m]",
             "ry′": "m_y′ [m]", "rz′": "m_z′ [m]"}
"""Motion pattern's row → what the row of W gives for a tension of 1 N: N/N for forces, N m/N = m for moments."""


class Posing:
    """A robot among what stands around it, and sliders for the motions its cables control.

    subject : World or Robot
    start : Pose, single; default the world's, for a robot the middle of its exit points
    floor : how far down the sliders may go; default the scene's floor [m]
    Raises InvalidInput for anything else, or a start that does not fit.
    """

    def __init__(self, subject: World | Robot, start: Pose | None = None, floor: float
                 | None = None) -> None:
        if isinstance(subject, World):
            robot, self.scene, self.title, usual = subject.robot, subject.scene, subject.title, subject.pose
        elif isinstance(subject, Robot):
            robot, self.scene, self.title, usual = subject, EMPTY, f"{subject.motion_pattern} robot", _middle(subject)
        else:
            raise InvalidInput(f"an explorer takes a World or a Robot, got {type(subject).__name__}")
        start = usual if start is None else start
        if not isinstance(start,
                          Pose) or start.batch_shape or start.dimension != robot.dimension:
            raise InvalidInput(f"start must be a single {'planar' if robot.dimension == 2 else 'spatial'} Pose, "
                               f"got {quoted(start)}")
        self.robot, self.start = robot, start
        self.places = _position_sliders(robot, floor_height(robot, self.scene) if floor is None
                                        else floor, start)
        turns = {"angle": start.angle} if robot.dimension == 2 else dict(zip(("roll", "pitch",
                                                                              "yaw"),
                                                                             start.rpy))
        self._turned = {name: float(np.rad2deg(turn)) for name, turn in turns.items()}
        # In 2R3T the turn about x′ is not the cables' and stays.
        self.turns = [_slider(name, "deg", -_TURNS[name], _TURNS[name], turn, 1.0)
                      for axis, (name, turn) in enumerate(self._turned.items())
                      if axis in robot.pattern.turn_axes]

    def pose(self, values: Values) -> Pose:
        """Where the sliders x, y, z [m] and angle or roll, pitch, yaw [deg] say; the rest stays as at the start."""
        position = [values.get(axis, place) for axis, place in zip("xyz", self.start.position)]
        if not self.turns:
            return Pose(position, matrix=self.start.rotation)
        turned = np.deg2rad([values.get(name, turn) for name, turn in self._turned.items()])
        return Pose(position, rpy=turned) if len(turned) == 3 else Pose(position,
                                                                        angle=turned[0])

    def ends(self, beyond: ArrayLike = 0.0) -> Pose:
        """The start, and every corner of the box of positions that the sliders reach.

        beyond : (d,) by how much further things are drawn [m]
        """
        box = [(slider.low - far, slider.high + far)
               for slider, far in zip(self.places, np.broadcast_to(beyond, self.robot.dimension).tolist())]
        box += [(place, place)
                for place in self.start.position[len(box):]]  # of an axis the cables do not control
        return Pose(np.array([self.start.position, *product(*box)]), matrix=self.start.rotation)

    def drawing(self, axes: Axes, beyond: ArrayLike = 0.0) -> RobotDrawing:
        """The robot on axes that hold all it can be moved to."""
        return RobotDrawing(axes, self.robot, self.scene, self.ends(beyond))


def draw_arrow(drawing: RobotDrawing, tail: Array, way: Array, width: float = 0.012) -> None:
    """An arrow on a robot's picture from a point by so much, (d,) each [m]; none where that is nothing."""
    if np.abs(way).max() > 1e-9:
        start, end = drawing.view.flat(np.stack([tail, tail + way]))
        drawing.axes.quiver(*start, *(end - start), angles="xy", scale_units="xy", scale=1,
                            color=INK,
                            width=width, zorder=9)


def velocity(robot: Robot, twist: Array) -> Array:
    """(d,) of P in a twist (n,) [m/s]."""
    return np.append(twist, 0.0)[:robot.dimension]   # 1T has no v_y


def no_length(lengths: Array) -> str:
    """Which of the cables with lengths (m,) have none."""
    return f"Cable {', '.join(str(k + 1) for k in np.flatnonzero(lengths == 0))} has no length"


class PoseExplorer(Explorer):
    """Sliders for the pose; the picture, the cable lengths and W answer.

    world_or_robot : World or Robot of any motion pattern
    start : Pose, single; default the world's, for a robot the middle of its exit points
    Raises InvalidInput for anything else, or a start that does not fit.

    >>> import cdprlab as cl
    >>> print(pose_explorer(cl.load_world("point_mass")).text.splitlines()[1])
    length [m] 3.202 3.202 3.202 3.202
    """

    def __init__(self, world_or_robot: World | Robot, start: Pose | None = None) -> None:
        self.posing = Posing(world_or_robot, start)
        self.robot = self.posing.robot
        eye = [EYE] if self.robot.dimension == 3 else []
        super().__init__([*self.posing.places, *self.posing.turns, *eye], self.posing.title)

    @property
    def pose(self) -> Pose:
        """Where the sliders put the platform."""
        return self.posing.pose(self.values)

    def build(self, figure: Figure) -> None:
        """The robot at its start."""
        self.drawing = self.posing.drawing(figure.subplots())

    def draw(self, values: Values) -> None:
        """Move platform, cables and eye."""
        self.drawing.turn(values.get("azimuth", EYE.start))
        self.drawing.move(self.posing.pose(values))

    def numbers(self, values: Values) -> str:
        """Cable lengths, and W below them column by column."""
        pose = self.posing.pose(values)
        lengths = cable_lengths(self.robot, pose)
        table = {"length [m]": [fixed(length, 3) for length in lengths]}
        if lengths.all():
            table |= dict.fromkeys(("", "W"), [""] * len(lengths))
            table |= {ROW_NAMES[name]: [fixed(entry, 2) for entry in row]
                      for name,
                      row in zip(self.robot.pattern.rows, wrench_matrix(self.robot, pose))}
            note = "Column i of W: force [N/N] and moment about P [N m/N = m]\nof cable i at a tension of 1 N."
        else:
            note = f"W: none here. {no_length(lengths)}, hence no direction."
        return f"{cable_table(table, gap=1)}\n\n{note}"

    def describe(self, values: Values) -> str:
        """Where the platform is."""
        return (f"{self.title}: frame, platform and {self.robot.n_cables} numbered cables at "
                f"{self.told(values, 'azimuth')}")


pose_explorer = PoseExplorer


# --- ranges -------------------------------------------------------------------------------------------------
def _middle(robot: Robot) -> Pose:
    low, high = robot.exit_points.min(axis=0), robot.exit_points.max(axis=0)
    middle: Array = (low + high) / 2
    if high[-1] - low[-1] < 1e-9:  # all exits at one height: hang below them
        middle[-1] = high[-1] - 0.5 * (high - low).max()
    return Pose(middle)


def _position_sliders(robot: Robot, floor: float, start: Pose) -> list[Slider]:
    """Within the exit points' box, a tenth clear of it: on its faces cables have no length or lie in one plane."""
    low, high = robot.exit_points.min(axis=0), robot.exit_points.max(axis=0)
    low[-1] = min(low[-1], floor)
    # Where all exits are on one height or line, as far as it takes.
    half = np.where(high > low, 0.4 * (high - low), max(0.5, 2 * robot.platform.size.max()))
    middle, axes = (low + high) / 2, [row for row in robot.pattern.rows if row in "xyz"]
    return [_slider(axis, "m", bottom, top, place, 0.01)
            for axis, bottom, top,
            place in zip(axes, middle - half, middle + half, start.position.tolist())]


def _slider(name: str, unit: str, low: float, high: float, start: float, step: float) -> Slider:
    """Ends on whole steps, further out where the start lies beyond them."""
    low, high = np.floor(min(low, start) / step), np.ceil(max(high, start) / step)
    return Slider(name, name, unit, round(step * low, 9), round(step * high, 9), start, step)
