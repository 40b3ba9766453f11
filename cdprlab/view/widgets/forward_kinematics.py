"""Forward kinematics at one's fingertips: lengths from a true pose, one of them wrong, and a guess to start from."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle

from ...arrays import Array, as_array
from ...errors import InvalidInput, NoConvergence
from ...geometry import anchor_offsets, cable_lengths
from ...kinematics import forward_kinematics, jacobian
from ...pose import Pose
from ...robot import MOTION_PATTERNS, Cable, Platform, Robot
from ..pose_estimates import draw_exit_points, outline
from ..style import GREY, INK, VERMILION, cable_style
from .explorer import Choice, Explorer, Slider, Values

EXIT_POINTS = ((-2.0, 3.0), (2.0, 3.0), (2.0, 0.0), (-2.0, 0.0), (-2.0, 1.5), (2.0, 1.5))
"""Of the planar robot, cables 1 to 6 [m]."""

ANCHOR_POINTS = ((-0.4, -0.25), (0.4, -0.25), (0.4, 0.25), (-0.4, 0.25), (0.4, 0.25), (-0.4, -0.25))
"""Cables from above hold the lower corners and those from below the upper ones, which fixes the angle well [m]."""

_STEPS = 60
"""Where the residuals do not vanish the steps shrink only by a factor each; this many reach 1e-9 m."""

_DONE, _LOST = 1e-10, 20.0
"""A step this small ends the iteration; a position this far out is lost [m]."""

_SHOWN = 6
"""Iterates drawn."""


class Path(NamedTuple):
    """What Gauss–Newton did.

    poses : guess first
    residuals : (m,) measured − fitted length at the last pose [m]
    converged : whether the last step was small
    """

    poses: list[Pose]
    residuals: Array
    converged: bool


def six_cables(count: int = 6) -> Robot:
    """A planar platform of 0.8 m × 0.5 m in a frame of 4 m × 3 m, held by the first ``count`` of six cables.

    count : 3 (as many as unknowns) to 6
    Raises InvalidInput for another number.

    >>> six_cables(4)
    Robot(1R2T, 4 cables, 10 kg)
    """
    if count not in (3, 4, 5, 6):
        raise InvalidInput(f"this robot has 3, 4, 5 or 6 cables, got {count!r}")
    cables = tuple(Cable(np.array(a), np.array(b), 10.0, 1000.0) for a, b in zip(EXIT_POINTS, ANCHOR_POINTS))
    platform = Platform(10.0, np.array(0.75), np.zeros(2), np.array([0.8, 0.5]), np.zeros(2))
    return Robot(MOTION_PATTERNS["1R2T"], platform, cables[:count])


def gauss_newton_path(robot: Robot, lengths: Any, guess: Pose) -> Path:
    """Pure Gauss–Newton, x ← x + J⁺ (l − l(x)), with nothing that keeps it from running away.

    robot : planar, pattern 1R2T
    lengths : (m,) measured [m]
    guess : where to start

    >>> robot = six_cables()
    >>> path = gauss_newton_path(robot, cable_lengths(robot, Pose([0.4, 1.3], angle=0.2)), Pose([0, 1.5], angle=0))
    >>> path.converged, path.poses[-1]
    (True, Pose([0.4, 1.3], angle=0.2))
    """
    measured = as_array(lengths, "lengths", (robot.n_cables,), "m")
    x, poses, converged = np.append(guess.position, guess.angle), [guess], False
    for _ in range(_STEPS):
        pose = poses[-1]
        step = np.linalg.pinv(jacobian(robot, pose)) @ (measured - cable_lengths(robot, pose))
        x = x + step
        poses.append(Pose(x[:2], angle=x[2]))
        converged = bool(np.linalg.norm(step) < _DONE)
        if converged or np.abs(x[:2]).max() > _LOST:
            break
    return Path(poses, measured - cable_lengths(robot, poses[-1]), converged)


def without_cable(robot: Robot, index: int) -> Robot:
    """The same robot with one cable less.

    index : from 0

    >>> without_cable(six_cables(), 0).n_cables
    5
    """
    return replace(robot, cables=robot.cables[:index] + robot.cables[index + 1:])


def forward_kinematics_explorer(cables: int = 4, cable: int = 2, error: float = 0.0) -> ForwardKinematicsExplorer:
    """Where Gauss–Newton ends for lengths of a true pose, one of them in error, from a guess.

    cables : how many of the six are measured, 3 to 6
    error : added to the length of cable ``cable`` [mm]
    cable : 1 to 6

    >>> explorer = forward_kinematics_explorer()
    >>> explorer.set(cables=4, error=0, x=0.4, y=1.3, angle=9, guess_angle=0)
    >>> print(explorer.text.splitlines()[1])
    pose found        x 0.400 m, y 1.300 m, φ 9.0°
    """
    return ForwardKinematicsExplorer(cables, cable, error)


class ForwardKinematicsExplorer(Explorer):
    """What `forward_kinematics_explorer` makes."""

    def __init__(self, cables: int, cable: int, error: float) -> None:
        controls: list[Slider | Choice] = [
            Choice("cables", "cables measured", (3, 4, 5, 6), cables),
            Slider("x", "true x", "m", -0.8, 0.8, 0.4, 0.02), Slider("y", "true y", "m", 0.8, 2.2, 1.3, 0.02),
            Slider("angle", "true φ", "°", -30.0, 30.0, 9.0, 1.0),
            Choice("cable", "cable in error", (1, 2, 3, 4, 5, 6), cable),
            Slider("error", "its length error", "mm", -200.0, 200.0, error, 5.0),
            Slider("guess_x", "guess x", "m", -1.4, 1.4, -0.4, 0.02),
            Slider("guess_y", "guess y", "m", 0.6, 2.4, 1.8, 0.02),
            Slider("guess_angle", "guess φ", "°", -180.0, 180.0, -30.0, 1.0)]
        super().__init__(controls, title="Forward kinematics of a planar robot", size=(7.2, 5.6))

    def build(self, figure: Figure) -> None:
        """Frame and exit points stand still, all else moves."""
        panel = figure.subplots()
        robot = six_cables()
        draw_exit_points(panel, robot.exit_points)
        panel.set(xlim=(-2.5, 2.5), ylim=(-0.6, 3.6), aspect="equal", xlabel="x [m]", ylabel="y [m]")
        moving: dict[str, Any] = {"animated": True}
        self._circles = [panel.add_patch(Circle((0, 0), 1, fill=False, linewidth=1.2, alpha=0.75, edgecolor=look.color,
                                                linestyle=look.linestyle, **moving))
                         for look in map(cable_style, range(robot.n_cables))]
        self._numbers_on_circles = [panel.text(0, 0, str(i + 1), color=cable_style(i).color, fontsize=10, ha="center",
                                               va="center", fontweight="bold", clip_on=True, **moving,
                                               bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.5})
                                    for i in range(robot.n_cables)]
        self._cables = [panel.plot([], [], color=GREY, linewidth=0.9, **moving)[0] for _ in range(robot.n_cables)]
        self._true, = panel.fill([0], [0], color=GREY, alpha=0.35, linewidth=0, **moving)
        self._iterates = [panel.plot([], [], color=INK, linewidth=1.0, linestyle=(0, (2, 2)), **moving)[0]
                          for _ in range(_SHOWN)]
        self._trail, = panel.plot([], [], color=INK, marker="o", markersize=3, linewidth=0.8, **moving)
        self._names = [panel.text(0, 0, str(k), color=INK, fontsize=9, clip_on=True, **moving) for k in range(_SHOWN)]
        self._found, = panel.plot([], [], color=VERMILION, linewidth=2.4, **moving)
        self._top, = panel.plot([], [], color=VERMILION, marker="^", markersize=9, linestyle="none", **moving)
        self._point, = panel.plot([], [], color=VERMILION, marker="o", markersize=7, linestyle="none", **moving)
        figure.legend(loc="outside lower center", ncols=2, fontsize=9, handles=[
            Line2D([], [], color=GREY, alpha=0.5, linewidth=7, label="true pose"),
            Line2D([], [], color=INK, linewidth=1, linestyle=(0, (2, 2)), label="guess 0, steps 1, 2, …"),
            Line2D([], [], color=VERMILION, linewidth=2.4, marker="^", label="pose found, its top edge"),
            Line2D([], [], color=cable_style(0).color, linewidth=1.2,
                   label="where cable 1, 2, … puts P, φ being right")])

    def numbers(self, values: Values) -> dict[str, Any]:
        """The pose found, its error, the residuals, and what remains without each cable."""
        self._solve(values)
        end, truth, path = self._path.poses[-1], self._truth, self._path
        turn = float(np.rad2deg((Pose([0, 0], matrix=truth.rotation.T @ end.rotation)).angle))
        text = {"Gauss–Newton": f"{'settled' if path.converged else 'NOT settled'} after {len(path.poses) - 1} steps",
                "pose found": _pose_text(end),
                "off the truth by": f"{1e3 * np.linalg.norm(end.position - truth.position):.1f} mm, {turn:.1f}°",
                "largest residual": f"{1e3 * np.abs(path.residuals).max():.1f} mm",
                "verdict": self._verdict(),
                "residuals, measured − fitted [mm]": _per_cable(1e3 * path.residuals)}
        if self._robot.n_cables > 4:
            text["largest residual without cable … [mm]"] = _per_cable(1e3 * self._left_out())
        if values["cable"] > values["cables"] and values["error"]:
            text["note"] = f"cable {values['cable']} is not measured: its error does nothing"
        return text

    def draw(self, values: Values) -> None:
        """Circles at the angle found: where they miss each other, no pose has these lengths."""
        path, robot = self._path, self._robot
        end = path.poses[-1]
        self._true.set_xy(outline(robot, self._truth))
        self._draw_cables(robot, end)
        self._draw_iterates()
        self._trail.set_data(*np.array([pose.position for pose in path.poses]).T)
        corners = outline(robot, end)
        self._found.set_data(*corners.T)
        self._top.set_data(*corners[2:4].mean(axis=0)[:, None])
        self._point.set_data(*end.position[:, None])

    def describe(self, values: Values) -> str:
        """One sentence for those who do not see the picture."""
        return (f"Planar robot, {values['cables']} cables measured: {_pose_text(self._path.poses[-1])} found, "
                f"{_pose_text(self._truth)} true; {self._verdict()}")

    # --- inside ---------------------------------------------------------------------------------------
    def _solve(self, values: Values) -> None:
        self._robot = six_cables(values["cables"])
        self._truth = Pose([values["x"], values["y"]], angle=np.deg2rad(values["angle"]))
        self._lengths = cable_lengths(self._robot, self._truth).copy()
        if values["cable"] <= values["cables"]:
            self._lengths[values["cable"] - 1] += 1e-3 * values["error"]
        guess = Pose([values["guess_x"], values["guess_y"]], angle=np.deg2rad(values["guess_angle"]))
        self._path = gauss_newton_path(self._robot, self._lengths, guess)

    def _draw_cables(self, robot: Robot, end: Pose) -> None:
        offsets = anchor_offsets(robot, end)
        centers = robot.exit_points - offsets
        # The number sits on the circle, this far along it from P [m].
        along = 0.75 / self._lengths
        bearings = np.arctan2(*(end.position - centers).T[::-1]) + along
        marks = centers + self._lengths[:, None] * np.column_stack([np.cos(bearings), np.sin(bearings)])
        for i, (circle, number, line) in enumerate(zip(self._circles, self._numbers_on_circles, self._cables)):
            for artist in (circle, number, line):
                artist.set_visible(i < robot.n_cables)
            if i < robot.n_cables:
                circle.set(center=centers[i], radius=self._lengths[i])
                number.set_position(marks[i])
                line.set_data(*np.transpose([robot.exit_points[i], end.position + offsets[i]]))

    def _draw_iterates(self) -> None:
        poses, named = self._path.poses, np.full(2, np.inf)
        for k, (line, name) in enumerate(zip(self._iterates, self._names)):
            corners = outline(self._robot, poses[k]) if k < len(poses) else np.full((5, 2), np.nan)
            line.set_data(*corners.T)
            # Where steps have become small their numbers would cover each other.
            apart = k == 0 or bool(np.linalg.norm(corners[2] - named) > 0.12)
            name.set_visible(apart)
            if apart:
                name.set_position(corners[2])
                named = corners[2]

    def _verdict(self) -> str:
        if not self._path.converged:
            return "no answer from this guess"
        if np.abs(self._path.residuals).max() > 1e-6:
            return "no pose has these lengths: the nearest one is shown"
        return "this pose has exactly these lengths"

    def _left_out(self) -> Array:
        """(m,) largest residual of the fit without each cable, nan where there is none [m]."""
        left = np.full(self._robot.n_cables, np.nan)
        for i in range(self._robot.n_cables):
            robot, lengths = without_cable(self._robot, i), np.delete(self._lengths, i)
            try:
                found = forward_kinematics(robot, lengths, self._path.poses[-1], tolerance=np.inf)
            except (NoConvergence, InvalidInput):
                continue
            left[i] = np.abs(lengths - cable_lengths(robot, found)).max()
        return left


def _pose_text(pose: Pose) -> str:
    x, y = pose.position + 0.0
    return f"x {x:.3f} m, y {y:.3f} m, φ {np.rad2deg(pose.angle) + 0.0:.1f}°"


def _per_cable(values: Array) -> str:
    # + 0.0 after rounding turns −0.0 into 0.0
    return "\n".join(f"  {i + 1}: {round(float(value), 1) + 0.0:7.1f}" for i, value in enumerate(values))
