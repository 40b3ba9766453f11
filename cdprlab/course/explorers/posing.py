"""Move the platform; see its cables, their lengths and the wrench matrix."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from ...arrays import Array
from ...errors import InvalidInput
from ...mechanics.cables import cable_lengths
from ...mechanics.statics import wrench_matrix
from ...robot import Robot
from ...robot.pose import Pose
from ...view.drawing import RobotDrawing
from ...view.outlines import EMPTY, floor_height
from ...view.text_table import fixed, text_table
from ...world import World
from .explorer import Explorer, Slider, Values

_TURNS = {"roll": 60.0, "pitch": 60.0, "yaw": 90.0, "angle": 90.0}
"""How far sliders turn the platform either way [deg]; pitch stays clear of ±90, where rpy is not unique."""

ROW_NAMES = {"x": "f_x", "y": "f_y", "z": "f_z", "rx": "m_x [m]", "ry": "m_y [m]", "rz": "m_z [m]",
             "ry′": "m_y′ [m]", "rz′": "m_z′ [m]"}
"""Motion pattern's row → what the row of W gives for a tension of 1 N: N/N for forces, N m/N = m for moments."""


class PoseExplorer(Explorer):
    """Sliders of the motions the cables control; in space one more walks around the robot.

    subject : World or Robot
    start : Pose, single; default the world's, for a robot the middle of its exit points

    >>> import cdprlab as cl
    >>> explorer = PoseExplorer(cl.load_world("caroca"))
    >>> explorer.set(x=0.5, yaw=30.0)
    >>> explorer.pose
    Pose([0.5, 0.9, 0.5], rpy=[0, 0, 0.523599])
    """

    def __init__(self, subject: World | Robot, start: Pose | None = None) -> None:
        if not isinstance(subject, World | Robot):
            raise InvalidInput(f"a pose explorer takes a World or a Robot, got {type(subject).__name__}")
        self.robot = subject.robot if isinstance(subject, World) else subject
        self.scene = subject.scene if isinstance(subject, World) else EMPTY
        if start is None and isinstance(subject, World):
            start = subject.pose
        self.start = _checked_start(self.robot, start)
        title = subject.title if isinstance(subject, World) else f"{self.robot.motion_pattern} robot"
        sliders = position_sliders(self.robot, floor_height(self.robot, self.scene), self.start)
        sliders += turn_sliders(self.robot, self.start)
        self._corners = _corner_poses(self.robot, sliders, self.start)
        if self.robot.dimension == 3:
            sliders.append(Slider("azimuth", "seen from", "deg", -180.0, 180.0, 25.0, 5.0))
        super().__init__(sliders, title, size=(5.2, 4.4))

    @property
    def pose(self) -> Pose:
        """Where the sliders put the platform."""
        return self.pose_at(self.values)

    def pose_at(self, values: Values) -> Pose:
        """Pose of some slider values [m, deg]; what has no slider stays as at the start."""
        return slider_pose(self.start, values)

    def build(self, figure: Figure) -> None:
        """The robot at its start."""
        self.drawing = RobotDrawing(figure.subplots(), self.robot, self.scene, self._corners)

    def draw(self, values: Values) -> None:
        """Move platform, cables and eye."""
        if "azimuth" in values:
            self.drawing.turn(values["azimuth"])
        self.drawing.move(self.pose_at(values))

    def numbers(self, values: Values) -> str:
        """Cable lengths, and W below them column by column."""
        pose = self.pose_at(values)
        lengths = cable_lengths(self.robot, pose)
        rows = [["length [m]", *(fixed(length, 3) for length in lengths)]]
        limp = [str(k + 1) for k in np.flatnonzero(lengths == 0)]
        if limp:
            note = f"W: none here. Cable {', '.join(limp)} has no length, hence no direction."
        else:
            rows += [["", *[""] * len(lengths)], ["W", *[""] * len(lengths)],
                     *([name, *(fixed(entry, 2) for entry in row)]
                       for name, row in zip(row_names(self.robot), wrench_matrix(self.robot, pose)))]
            note = "Column i of W: force [N/N] and moment about P [N m/N = m]\nof cable i at a tension of 1 N."
        header = ["cable", *(str(k + 1) for k in range(len(lengths)))]
        return f"{text_table(header, rows, gap=1)}\n\n{note}"

    def describe(self, values: Values) -> str:
        """Where the platform is."""
        motions = ", ".join(f"{name} {values[name]:.4g} {control.unit}" for name, control in self.controls.items()
                            if name != "azimuth" and isinstance(control, Slider))
        return f"{self.title}: frame, platform and {self.robot.n_cables} numbered cables at {motions}"


def pose_explorer(world_or_robot: World | Robot, start: Pose | None = None) -> PoseExplorer:
    """Sliders for the pose; the picture, the cable lengths and W answer.

    world_or_robot : World or Robot of any motion pattern
    start : Pose, single; default the world's, for a robot the middle of its exit points
    Raises InvalidInput for anything else, or a start that does not fit.

    >>> import cdprlab as cl
    >>> print(pose_explorer(cl.load_world("point_mass")).text.splitlines()[1])
    length [m] 3.202 3.202 3.202 3.202
    """
    return PoseExplorer(world_or_robot, start)


def slider_pose(start: Pose, values: Values) -> Pose:
    """Pose of the sliders x, y, z [m] and angle or roll, pitch, yaw [deg]; what has no slider stays as at the start."""
    position = [values.get(axis, place) for axis, place in zip("xyz", start.position)]
    if start.dimension == 2:
        return Pose(position, angle=np.deg2rad(values["angle"])) if "angle" in values \
            else Pose(position, matrix=start.rotation)
    if "yaw" not in values:
        return Pose(position, matrix=start.rotation)
    roll = values.get("roll", np.rad2deg(start.rpy[0]))
    return Pose(position, rpy=np.deg2rad([roll, values["pitch"], values["yaw"]]))


def row_names(robot: Robot) -> list[str]:
    """Names of the rows of W, with units."""
    return [ROW_NAMES[row] for row in robot.pattern.rows]


# --- ranges -------------------------------------------------------------------------------------------------
def _checked_start(robot: Robot, start: Pose | None) -> Pose:
    if start is None:
        low, high = robot.exit_points.min(axis=0), robot.exit_points.max(axis=0)
        middle = (low + high) / 2
        if high[-1] - low[-1] < 1e-9:  # all exits at one height: hang below them
            middle[-1] = high[-1] - 0.5 * float((high - low).max())
        return Pose(middle)
    if not isinstance(start, Pose) or start.batch_shape or start.dimension != robot.dimension:
        raise InvalidInput(f"start must be a single {'planar' if robot.dimension == 2 else 'spatial'} Pose, got "
                           f"{start!r}")
    return start


def position_sliders(robot: Robot, floor: float, start: Pose) -> list[Slider]:
    """Within the exit points' box, a tenth clear of it: on its faces cables have no length or lie in one plane."""
    low, high = robot.exit_points.min(axis=0), robot.exit_points.max(axis=0)
    low[-1] = min(low[-1], floor)
    sliders = []
    axes = [row for row in robot.pattern.rows if row in "xyz"]
    for axis, bottom, top, place in zip(axes, low, high, start.position):
        middle, half = (bottom + top) / 2, 0.4 * (top - bottom)
        half = half or max(0.5, 2 * float(robot.platform.size.max()))  # all exits on one height or line
        sliders.append(_slider(axis, "m", middle - half, middle + half, float(place), 0.01))
    return sliders


def turn_sliders(robot: Robot, start: Pose) -> list[Slider]:
    """Of the turns the cables control [deg]."""
    if not robot.pattern.turns:
        return []
    if robot.dimension == 2:
        turns = {"angle": float(start.angle)}
    else:
        turns = dict(zip(("roll", "pitch", "yaw"), map(float, start.rpy)))
        # In 2R3T the turn about x′ is not the cables' to control; it stays.
        turns = {name: turns[name] for name, axis in zip(turns, (0, 1, 2)) if axis in robot.pattern.turn_axes}
    return [_slider(name, "deg", -_TURNS[name], _TURNS[name], float(np.rad2deg(turn)), 1.0)
            for name, turn in turns.items()]


def _slider(name: str, unit: str, low: float, high: float, start: float, step: float) -> Slider:
    """Ends on whole steps, further out where the start lies beyond them."""
    low, high = min(low, start), max(high, start)
    first, last = (round(float(step * place), 9) for place in (np.floor(low / step), np.ceil(high / step)))
    return Slider(name, name, unit, first, last, start, step)


def _corner_poses(robot: Robot, sliders: list[Slider], start: Pose) -> Pose:
    """The start and the extreme positions, for a picture that holds them all."""
    low, high = np.array(start.position), np.array(start.position)
    for k, slider in enumerate(slider for slider in sliders if slider.unit == "m"):
        low[k], high[k] = slider.low, slider.high
    ends: Array = np.stack([start.position, low, high])
    rotation: Any = np.broadcast_to(start.rotation, (3, *start.rotation.shape))
    return Pose(ends, matrix=rotation)
