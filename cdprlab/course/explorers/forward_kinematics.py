"""Forward kinematics at one's fingertips: lengths from a true pose, one of them wrong, and a guess to start from.

Beside it: where would a platform hang on ropes of exactly these lengths?
"""

from typing import Any

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ...arrays import Array, checked
from ...errors import InvalidInput, NoConvergence
from ...mechanics.cables import anchor_offsets, cable_lengths
from ...mechanics.kinematics import forward_kinematics
from ...robot.pose import Pose, rotation_vector
from ...view.drawing import Haloed
from ...view.outlines import hanging
from ...view.style import BLUE, GREY, INK, SKY, VERMILION, cable_style
from ..pictures.panels import draw_exit_points
from ..pictures.pose_estimates import outline
from ..props.changed_cables import without_cable
from ..props.experiments import hang
from ..props.pose_search import gauss_newton_path, six_cables
from ..text_table import cable_table, fixed
from .explorer import Choice, Explorer, Slider, Values

_SHOWN = 6
"""Iterates drawn."""

_CIRCLE = np.stack([trig(np.linspace(0, 2 * np.pi, 181)) for trig in (np.cos, np.sin)], axis=1)
"""(181, 2) points of a circle of radius 1."""


@checked
class ForwardKinematicsExplorer(Explorer):
    """Where Gauss–Newton ends for lengths of a true pose, one of them in error, from a guess.

    cables : how many of the six are measured, 3 to 6
    error : added to the length of cable ``cable`` [mm]
    cable : 1 to 6

    >>> explorer = forward_kinematics_explorer()
    >>> explorer.set(cables=4, error=0, x=0.4, y=1.3, angle=9, guess_angle=0)
    >>> print(explorer.text.splitlines()[1])
    pose found        x 0.400 m, y 1.300 m, φ 9.0°
    """

    def __init__(self, cables: int = 4, cable: int = 2, error: float = 0.0) -> None:
        controls: list[Slider | Choice] = [
            Choice("cables", "cables measured", (3, 4, 5, 6), cables),
            Slider("x", "true x", "m", -0.8, 0.8, 0.4, 0.02),
            Slider("y", "true y", "m", 0.8, 2.2, 1.3, 0.02),
            Slider("angle", "true φ", "°", -30.0, 30.0, 9.0, 1.0),
            Choice("cable", "cable in error", (1, 2, 3, 4, 5, 6), cable),
            Slider("error", "its length error", "mm", -200.0, 200.0, error, 5.0),
            Slider("guess_x", "guess x", "m", -1.4, 1.4, -0.4, 0.02),
            Slider("guess_y", "guess y", "m", 0.6, 2.4, 1.8, 0.02),
            Slider("guess_angle", "guess φ", "°", -180.0, 180.0, -30.0, 1.0),
            Choice("hang", "hang it on these ropes", ("no", "yes"), "no")]
        super().__init__(controls, title="Forward kinematics of a planar robot",
                         size=(6.2, 5.2))

    def build(self, figure: Figure) -> None:
        """Frame and exit points stand still, all else moves."""
        self._panel = figure.subplots()
        draw_exit_points(self._panel, six_cables().exit_points)
        self._panel.set(xlim=(-2.5, 2.5), ylim=(-0.6, 3.6), aspect="equal", xlabel="x [m]",
                        ylabel="y [m]")
        figure.legend(loc="outside lower center", ncols=2, fontsize=9, handles=[
            Line2D([], [], color=GREY, alpha=0.5, linewidth=7, label="true pose"),
            Line2D([], [], color=SKY, linewidth=7, alpha=0.7, label="at rest on ropes"),
            Line2D([], [], color=INK, linewidth=1, linestyle=(0, (2, 2)),
                   label="guess 0, steps 1, 2, …"),
            Line2D([], [], color=VERMILION, linewidth=2.4, marker="^",
                   label="pose found, its top edge"),
            Line2D([], [], color=cable_style(0).color, linewidth=1.2,
                   label="where cable 1, 2, … puts P, φ being right")])

    def numbers(self, values: Values) -> dict[str, Any]:
        """The pose found, its error, the residuals, and what remains without each cable."""
        self._solve(values)
        end, path = self._path.poses[-1], self._path
        text = {"Gauss–Newton": f"{'settled' if path.converged else 'NOT settled'} after {len(path.poses) - 1} steps",
                "pose found": _pose_text(end),
                "off the truth by": _apart_text(end, self._truth),
                "largest residual": f"{1e3 * np.abs(path.residuals).max():.1f} mm",
                "verdict": self._verdict(),
                "residuals, measured − fitted [mm]": self._residuals()}
        if self._asked:
            text["at rest on ropes of these lengths"] = self._hung_text()
        if values["cable"] > values["cables"] and values["error"]:
            text["note"] = f"cable {values['cable']} is not measured: its error does nothing"
        return text

    def idle(self, values: Values) -> dict[str, str]:
        if not values["error"]:
            return {"cable": "its length error is 0"}
        return {"error": "that cable is not measured"} if values["cable"] > values["cables"] else {}

    def draw(self, values: Values) -> None:
        """Circles at the angle found: where they miss each other, no pose has these lengths."""
        panel, poses = self._panel, self._path.poses
        panel.fill(*outline(self._robot, self._truth).T, color=GREY, alpha=0.35, linewidth=0)
        self._draw_cables(poses[-1])
        self.hung: list[Any] = []
        if self._settled is not None:
            self._draw_hung(self._settled.pose)
        self._draw_iterates()
        panel.plot(*np.array([pose.position for pose in poses]).T, color=INK, marker="o",
                   markersize=3, linewidth=0.8)
        corners = outline(self._robot, poses[-1])
        panel.plot(*corners.T, color=VERMILION, linewidth=2.4)
        panel.plot(*corners[2:4].mean(axis=0), color=VERMILION, marker="^", markersize=9)
        panel.plot(*poses[-1].position, color=VERMILION, marker="o", markersize=7)

    def describe(self, values: Values) -> str:
        """One sentence for those who do not see the picture."""
        hung = "; hung on ropes: " + self._hung_text().replace("\n", "; ") if self._asked else ""
        return (f"Planar robot, {values['cables']} cables measured: {_pose_text(self._path.poses[-1])} found, "
                f"{_pose_text(self._truth)} true; {self._verdict()}{hung}")

    # --- inside ---------------------------------------------------------------------------------------
    def _solve(self, values: Values) -> None:
        self._robot = six_cables(values["cables"])
        self._truth = Pose([values["x"], values["y"]], angle=np.deg2rad(values["angle"]))
        self._lengths = cable_lengths(self._robot, self._truth).copy()
        if values["cable"] <= values["cables"]:
            self._lengths[values["cable"] - 1] += 1e-3 * values["error"]
        guess = Pose([values["guess_x"], values["guess_y"]],
                     angle=np.deg2rad(values["guess_angle"]))
        self._path = gauss_newton_path(self._robot, self._lengths, guess)
        self._asked = values["hang"] == "yes"
        self._settled = hang(self._robot, self._lengths, self._truth) if self._asked else None

    def _draw_hung(self, pose: Pose) -> None:
        """The platform at rest on its ropes; what is slack hangs through."""
        self.hung = self._panel.fill(*outline(self._robot, pose).T, facecolor=to_rgba(SKY, 0.5),
                                     edgecolor=BLUE,
                                     linewidth=1.2)
        anchors = pose.position + anchor_offsets(self._robot, pose)
        ropes = [hanging(*rope) for rope in zip(anchors, self._robot.exit_points, self._lengths)]
        self._panel.add_collection(LineCollection(ropes, colors=SKY, linewidths=2.2), autolim=False)

    def _hung_text(self) -> str:
        settled = self._settled
        if settled is None:
            return "nowhere: no pose is within reach of all ropes.\nSomething would tear."
        loose = ", ".join(f"cable {i + 1} by {1e3 * settled.spare[i]:.0f} mm"
                          for i in np.flatnonzero(settled.slack))
        return (f"at {_pose_text(settled.pose)}\nslack: {loose or 'none'}\n"
                f"off the pose found by {_apart_text(settled.pose, self._path.poses[-1])}")

    def _draw_cables(self, end: Pose) -> None:
        exits, offsets = self._robot.exit_points, anchor_offsets(self._robot, end)
        centers, anchors = exits - offsets, end.position + offsets
        # The number sits on the circle, this far along it from P [m].
        along = 0.75 / self._lengths
        bearings = np.arctan2(*(end.position - centers).T[::-1]) + along
        marks = centers + self._lengths[:, None] * np.column_stack([np.cos(bearings),
                                                                    np.sin(bearings)])
        looks = [cable_style(i) for i in range(len(exits))]
        circles = centers[:, None] + self._lengths[:, None, None] * _CIRCLE
        for lines in (LineCollection(list(circles), colors=[look.color for look in looks], linewidths=1.2,
                                     linestyles=[look.linestyle for look in looks], alpha=0.75),
                      LineCollection(list(np.stack([exits, anchors], axis=1)), colors=GREY, linewidths=0.9)):
            self._panel.add_collection(lines, autolim=False)
        for i, (place, look) in enumerate(zip(marks, looks), start=1):
            self._panel.add_artist(Haloed(place[0], place[1], str(i), color=look.color, fontsize=10, zorder=3,
                                          fontweight="bold", transform=self._panel.transData))

    def _draw_iterates(self) -> None:
        named = np.full(2, np.inf)
        for k, pose in enumerate(self._path.poses[:_SHOWN]):
            corners = outline(self._robot, pose)
            self._panel.plot(*corners.T, color=INK, linewidth=1.0, linestyle=(0, (2, 2)))
            # Where steps have become small their numbers would cover each other.
            if np.linalg.norm(corners[2] - named) > 0.12:
                named = corners[2]
                self._panel.text(named[0], named[1], str(k), color=INK, fontsize=9,
                                 clip_on=True)

    def _verdict(self) -> str:
        if not self._path.converged:
            return "no answer from this guess"
        if np.abs(self._path.residuals).max() > 1e-6:
            return "no pose has these lengths: the nearest one is shown"
        return "this pose has exactly these lengths"

    def _residuals(self) -> str:
        """Cable by cable; with cables to spare also the largest one without each."""
        rows = {"of the fit": 1e3 * self._path.residuals}
        if self._robot.n_cables > 4:
            rows["largest without it"] = 1e3 * self._left_out()
        return cable_table({name: [fixed(value, 1) for value in row] for name, row in rows.items()})

    def _left_out(self) -> Array:
        """(m,) largest residual of the fit without each cable, nan where there is none [m]."""
        left = np.full(self._robot.n_cables, np.nan)
        for i in range(self._robot.n_cables):
            robot, lengths = without_cable(self._robot, i), np.delete(self._lengths, i)
            try:
                found = forward_kinematics(robot, lengths, self._path.poses[-1],
                                           tolerance=np.inf)
            except (NoConvergence, InvalidInput):
                continue
            left[i] = np.abs(lengths - cable_lengths(robot, found)).max()
        return left


forward_kinematics_explorer = ForwardKinematicsExplorer


def _pose_text(pose: Pose) -> str:
    x, y = pose.position
    return f"x {fixed(x, 3)} m, y {fixed(y, 3)} m, φ {fixed(np.rad2deg(pose.angle), 1)}°"


def _apart_text(pose: Pose, other: Pose) -> str:
    turn = np.rad2deg(rotation_vector(other.rotation.T @ pose.rotation)[0])
    return f"{1e3 * np.linalg.norm(pose.position - other.position):.1f} mm, {fixed(turn, 1)}°"

