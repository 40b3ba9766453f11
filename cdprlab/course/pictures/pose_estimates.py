"""Figures of pose estimates: steps towards a pose, how sure it is, errors of a flight."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from ...arrays import Array
from ...mechanics.cables import anchor_offsets
from ...mechanics.dynamics import pose_error
from ...robot import Robot
from ...robot.pose import Pose
from ...view.outlines import platform_corners
from ...view.plots import Figure, draw_cables
from ...view.style import AXIS_COLORS, BLUE, GREY, INK, ORANGE, VERMILION, cable_style
from ..props.point_load import decimal
from .panels import PLAN, draw_exit_points, drawn

ELLIPSE_95 = np.sqrt(5.991464547107979)
"""Of two normal variables 95 % lie within this many standard deviations: the root of χ²'s 95 % point, 2 freedoms."""

_POSE_ERRORS = ("δx [mm]", "δy [mm]", "δz [mm]", "about x [mrad]", "about y [mrad]",
                "about z [mrad]")


def outline(robot: Robot, pose: Pose) -> Array:
    """(5, 2) corners of a planar platform's box, the first repeated [m].

    robot : planar; pose : single

    >>> import cdprlab as cl
    >>> from cdprlab.course.props.pose_search import six_cables
    >>> outline(six_cables(), cl.Pose([0, 1])).shape
    (5, 2)
    """
    return platform_corners(robot, pose)[[0, 2, 3, 1, 0]]


def draw_robot(panel: Axes, robot: Robot, pose: Pose, color: str = INK) -> None:
    """A planar robot: exit points with their numbers, cables, the platform with its center marked."""
    anchors = pose.position + anchor_offsets(robot, pose)
    for i, ends in enumerate(np.stack([robot.exit_points, anchors], axis=-1)):
        panel.plot(*ends, linewidth=1.6, **cable_style(i)._asdict())
    panel.plot(*outline(robot, pose).T, color=color, linewidth=2.0)
    panel.plot(*pose.position, "o", markersize=5, color=color)
    draw_exit_points(panel, robot.exit_points)


def convergence(robot: Robot, poses: Sequence[Pose], truth: Pose) -> Figure:
    """Steps of an iteration: where the platform goes, and how fast the error shrinks.

    robot : planar
    poses : guess first, then each iterate
    truth : where it should end
    """
    errors = [np.linalg.norm(pose_error(pose, truth)) for pose in poses]
    with drawn(10.5, 4.3) as figure:
        left, right = figure.subplots(1, 2, width_ratios=(1.3, 1.0))
        left.fill(*outline(robot, truth).T, color=GREY, alpha=0.35, linewidth=0, label="true pose")
        draw_robot(left, robot, truth, color="none")
        for k, pose in enumerate(poses[:4]):
            corners = outline(robot, pose)
            left.plot(*corners.T, color=VERMILION, linewidth=1.2 + 0.3 * k, linestyle=(0, (4, 2)),
                      label="" if k else "guess and iterates")
            if k < 2:
                left.annotate(str(k), corners[2], (7, 6), textcoords="offset points", color=VERMILION)
        left.set(**PLAN, title="From the guess to the pose")
        left.margins(0.09)
        left.legend(loc="lower center", ncols=2)
        right.semilogy(np.maximum(errors, 1e-17), "o-", color=INK)
        right.axhspan(1e-17, 1e-15, color=GREY, alpha=0.2, linewidth=0)
        right.annotate("rounding", (0, 1.3e-16), color=GREY, va="center")
        right.set(xlabel="iteration", ylabel="error ‖(δx, δy, δφ)‖ [m, rad]", title="The error squares itself",
                  ylim=(1e-17, 3), xticks=range(len(errors)))
        figure.alt_text = ("Platform outlines from the guess to the true pose, and the error per iteration: "
                           f"{', '.join(f'{error:.1g}' for error in errors)}.")
    return figure


def assembly_modes(robot: Robot, poses: Sequence[Pose], titles: Sequence[str]) -> Figure:
    """Poses side by side, one panel each.

    robot : planar
    poses, titles : one a panel
    """
    with drawn(4.2 * len(poses), 3.9) as figure:
        (panels,) = figure.subplots(1, len(poses), sharey=True, squeeze=False)
        for panel, pose, title in zip(panels, poses, titles):
            draw_robot(panel, robot, pose)
            # A mark on the top edge tells upside down from upright.
            panel.plot(*outline(robot, pose)[2:4].mean(axis=0), "^", markersize=8, color=VERMILION)
            panel.set(**PLAN)
            panel.set_title(title, fontsize=11)
        figure.alt_text = f"Platform poses: {'; '.join(titles)}"
    return figure


def cloud(errors: ArrayLike, covariance: ArrayLike) -> Figure:
    """Pose errors of many noisy measurements, and the ellipse that was predicted to hold 95 % of them.

    errors : (count, 3) δx, δy [m], δφ [rad]
    covariance : (3, 3) predicted, in the same order
    """
    sample, C = 1e3 * np.asarray(errors), 1e6 * np.asarray(covariance)
    turn = np.linspace(0, 2 * np.pi, 200)
    root = np.linalg.cholesky(C[:2, :2])
    ellipse = ELLIPSE_95 * root @ [np.cos(turn), np.sin(turn)]
    inside = np.linalg.norm(np.linalg.solve(root, sample[:, :2].T), axis=0) <= ELLIPSE_95
    with drawn(10.0, 4.2) as figure:
        left, right = figure.subplots(1, 2)
        left.plot(*sample[:, :2].T, ".", markersize=4, color=BLUE, alpha=0.6, label="recovered")
        left.plot(*ellipse, color=VERMILION, label="predicted, 95 %")
        left.set(aspect="equal", xlabel="δx [mm]", ylabel="δy [mm]",
                 title=f"{100 * inside.mean():.0f} % inside the ellipse")
        left.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
        sigma = np.sqrt(C[2, 2])
        right.hist(sample[:, 2], bins=25, density=True, color=BLUE, alpha=0.6, label="recovered")
        x = np.linspace(-4 * sigma, 4 * sigma, 200)
        right.plot(x, np.exp(-(x / sigma)**2 / 2) / (sigma * np.sqrt(2 * np.pi)), color=VERMILION, label="predicted")
        right.set(xlabel="δφ [mrad]", ylabel="density [1/mrad]", title="Angle", xlim=(-4 * sigma, 5 * sigma))
        right.legend(loc="upper right")
        figure.alt_text = (f"Scatter of {len(sample)} position errors; {100 * inside.mean():.0f} % lie inside "
                           "the predicted ellipse; a histogram of angle errors beside it.")
    return figure


def residual_bars(all_cables: ArrayLike, left_out: ArrayLike) -> Figure:
    """Residuals of the fit to all cables, and what remains when one cable is left out.

    all_cables : (m,) residual of each cable [m]
    left_out : (m,) size of the residuals without that cable [m]
    """
    together, without = 1e3 * np.asarray(all_cables), 1e3 * np.asarray(left_out)
    cables = range(1, len(together) + 1)
    with drawn(10.0, 3.6) as figure:
        left, right = figure.subplots(1, 2)
        for panel, values in ((left, together), (right, without)):
            bars = panel.bar(cables, values, width=0.6, color=[cable_style(i - 1).color for i in cables])
            panel.bar_label(bars, [decimal(value) for value in values], padding=2)
            panel.axhline(0, color=INK, linewidth=0.8)
            panel.grid(axis="x", visible=False)
            panel.margins(y=0.2)
        left.set(xlabel="cable", ylabel="residual [mm]", title="All cables in the fit")
        right.set(xlabel="cable left out", ylabel="remaining residual ‖r‖ [mm]",
                  title="One cable left out")
        figure.alt_text = (f"Largest residual in the fit to all: cable {np.abs(together).argmax() + 1}; "
                           f"least remains without cable {without.argmin() + 1}.")
    return figure


def flight(time: ArrayLike, errors: ArrayLike, sigmas: ArrayLike, residuals: ArrayLike, sigma: float) -> Figure:
    """Errors of recovered spatial poses along a flight over the predicted ±2σ band, and the residuals.

    time : (k,) [s]
    errors : (k, 6) δx, δy, δz [m], rotation vector [rad]
    sigmas : (k, 6) predicted standard deviations, as errors
    residuals : (k, m) of the lengths [m]
    sigma : standard deviation of a length [m]
    """
    t, left_over = np.asarray(time), 1e3 * np.asarray(residuals)
    off, band = 1e3 * np.asarray(errors), 2e3 * np.asarray(sigmas)
    with drawn(10.5, 7.4) as figure:
        *panels, below = figure.subplot_mosaic([[0, 1, 2], [3, 4, 5], [6, 6, 6]]).values()
        for i, (panel, name) in enumerate(zip(panels, _POSE_ERRORS)):
            panel.fill_between(t, -band[:, i], band[:, i], color=ORANGE, alpha=0.3, linewidth=0)
            panel.plot(t, off[:, i], ".-", color=AXIS_COLORS[i % 3], linewidth=1.0, markersize=4)
            panel.set(ylabel=name, xlabel="time [s]" if i > 2 else "")
        panels[0].set_title("Error; shaded: predicted ±2σ", fontsize=11)
        draw_cables(below, t, left_over, linewidth=1.0, marker=".", markersize=3)
        below.axhspan(-2e3 * sigma, 2e3 * sigma, color=GREY, alpha=0.15, linewidth=0)
        below.set(xlabel="time [s]", ylabel="residual [mm]",
                  title="Residuals measured − fitted length; gray: ±2σ of one length")
        below.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), labelspacing=0.2)
        figure.alt_text = (f"Six pose errors over {t[-1]:.2g} s, {100 * (np.abs(off) <= band).mean():.0f} % of them "
                           "inside their ±2σ band; "
                           f"length residuals of at most {np.abs(left_over).max():.2g} mm.")
    return figure
