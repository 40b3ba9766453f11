"""Forward kinematics at one's fingertips: lengths from a true pose, one of them wrong, and a guess to start from.

Beside it: where would a platform hang on ropes of exactly these lengths?
"""

from contextlib import suppress
from typing import Any

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure

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
from .explorer import Choice, Explorer, Look, Values, legend_below, sliders

_SHOWN = 6
"""Iterates drawn."""

_STEP: Look = {"color": INK, "linewidth": 1.0, "linestyle": (0, (2, 2))}
_FOUND: Look = {"color": VERMILION, "linewidth": 2.4}


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
        moved = sliders("forward_kinematics", error=error)
        super().__init__([Choice("cables", "cables measured", (3, 4, 5, 6), cables), *moved[:3],
                          Choice("cable", "cable in error", (1, 2, 3, 4, 5, 6), cable),
                          *moved[3:],
                          Choice("hang", "hang it on these ropes", ("no", "yes"))],
                         "Forward kinematics of a planar robot")

    def build(self, figure: Figure) -> None:
        """Frame and exit points stand still, all else moves."""
        self._panel = figure.subplots()
        draw_exit_points(self._panel, six_cables().exit_points)
        self._panel.set(xlim=(-2.5, 2.5), ylim=(-0.6, 3.6), aspect="equal", xlabel="x [m]",
                        ylabel="y [m]")
        legend_below(figure, {
            "true pose": {"color": GREY, "alpha": 0.5, "linewidth": 7},
            "at rest on ropes": {"color": SKY, "alpha": 0.7, "linewidth": 7},
            "guess 0, steps 1, 2, …": _STEP,
            "pose found, its top edge": _FOUND | {"marker": "^"},
            "where cable 1, 2, … puts P, φ being right": {"color": cable_style(0).color,
                                                          "linewidth": 1.2}})

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
        panel.plot(*np.transpose([pose.position for pose in poses]), "o-", color=INK,
                   markersize=3, linewidth=0.8)
        corners = outline(self._robot, poses[-1])
        panel.plot(*corners.T, **_FOUND)
        panel.plot(*corners[2:4].mean(axis=0), "^", color=VERMILION, markersize=9)
        panel.plot(*poses[-1].position, "o", color=VERMILION, markersize=7)

    def describe(self, values: Values) -> str:
        """One sentence for those who do not see the picture."""
        told = (f"Planar robot, {values['cables']} cables measured: {_pose_text(self._path.poses[-1])} found, "
                f"{_pose_text(self._truth)} true; {self._verdict()}")
        if self._asked:
            told += "; hung on ropes: " + self._hung_text().replace("\n", "; ")
        return told

    # --- inside ---------------------------------------------------------------------------------------
    def _solve(self, values: Values) -> None:
        robot = self._robot = six_cables(values["cables"])
        self._truth = Pose([values["x"], values["y"]], angle=np.deg2rad(values["angle"]))
        wrong = np.arange(1, robot.n_cables + 1) == values["cable"]
        self._lengths = cable_lengths(robot, self._truth) + wrong * 1e-3 * values["error"]
        guess = Pose([values["guess_x"], values["guess_y"]],
                     angle=np.deg2rad(values["guess_angle"]))
        self._path = gauss_newton_path(robot, self._lengths, guess)
        self._asked = values["hang"] == "yes"
        self._settled = hang(robot, self._lengths, self._truth) if self._asked else None

    def _draw_lines(self, lines: Any, **look: Any) -> None:
        self._panel.add_collection(LineCollection(list(lines), **look), autolim=False)

    def _draw_hung(self, pose: Pose) -> None:
        """The platform at rest on its ropes; what is slack hangs through."""
        self.hung = self._panel.fill(*outline(self._robot, pose).T, facecolor=to_rgba(SKY, 0.5),
                                     edgecolor=BLUE,
                                     linewidth=1.2)
        anchors = pose.position + anchor_offsets(self._robot, pose)
        self._draw_lines(map(hanging, anchors, self._robot.exit_points, self._lengths),
                         colors=SKY, linewidths=2.2)

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
        centers, radii = exits - offsets, self._lengths[:, None, None]
        colors, dashes = zip(*map(cable_style, range(len(exits))))
        circles = centers[:, None] + radii * _unit(np.linspace(0, 2 * np.pi, 181))
        self._draw_lines(circles, colors=colors, linestyles=dashes, linewidths=1.2, alpha=0.75)
        self._draw_lines(np.stack([exits, end.position + offsets], axis=1), colors=GREY,
                         linewidths=0.9)
        # The number sits on the circle, this far along it from P [m].
        bearings = np.arctan2(*(end.position - centers).T[::-1]) + 0.75 / self._lengths
        for i, (x, y) in enumerate(centers + radii[:, 0] * _unit(bearings)):
            self._panel.add_artist(Haloed(x, y, str(i + 1), color=colors[i], fontsize=10,
                                          fontweight="bold",
                                          zorder=3, transform=self._panel.transData))

    def _draw_iterates(self) -> None:
        named = np.full(2, np.inf)
        for k, pose in enumerate(self._path.poses[:_SHOWN]):
            corners = outline(self._robot, pose)
            self._panel.plot(*corners.T, **_STEP)
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
        rows = {"of the fit": self._path.residuals}
        if self._robot.n_cables > 4:
            rows["largest without it"] = self._left_out()
        return cable_table({name: [fixed(1e3 * length, 1) for length in row] for name,
                            row in rows.items()})

    def _left_out(self) -> Array:
        """(m,) largest residual of the fit without each cable, nan where there is none [m]."""
        left = np.full(self._robot.n_cables, np.nan)
        for i in range(left.size):
            robot, lengths = without_cable(self._robot, i), np.delete(self._lengths, i)
            with suppress(NoConvergence, InvalidInput):
                found = forward_kinematics(robot, lengths, self._path.poses[-1],
                                           tolerance=np.inf)
                left[i] = np.abs(lengths - cable_lengths(robot, found)).max()
        return left


forward_kinematics_explorer = ForwardKinematicsExplorer


def _unit(angles: Array) -> Array:
    """(…, 2) in these directions [rad]."""
    return np.stack([np.cos(angles), np.sin(angles)], axis=-1)


def _pose_text(pose: Pose) -> str:
    x, y = pose.position
    return f"x {fixed(x, 3)} m, y {fixed(y, 3)} m, φ {fixed(np.rad2deg(pose.angle), 1)}°"


def _apart_text(pose: Pose, other: Pose) -> str:
    turn = np.rad2deg(rotation_vector(other.rotation.T @ pose.rotation)[0])
    return f"{1e3 * np.linalg.norm(pose.position - other.position):.1f} mm, {fixed(turn, 1)}°"
