"""The picture of lesson 03: ``python docs/lesson_pictures/03_forward_kinematics.py`` writes it into the lesson."""

from io import BytesIO

import numpy as np
from attachment import attach
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from PIL import Image

import cdprlab as cl
from cdprlab.course.pictures.panels import draw_exit_points
from cdprlab.course.pictures.pose_estimates import draw_robot, outline
from cdprlab.course.props.pose_search import gauss_newton_path, six_cables
from cdprlab.view.style import GREY, INK, VERMILION, cable_style, house_style


def circles(panel):
    """Two circles, two crossings; the load hangs at the lower one."""
    exits, lengths = np.array([[0.0, 3.0], [5.0, 3.0]]), (3.0, 4.0)
    for i, (center, length) in enumerate(zip(exits, lengths)):
        color, dashes = cable_style(i).color, "solid" if i == 0 else (0, (5, 2))
        panel.add_patch(Circle(tuple(center), length, fill=False, color=color, linestyle=dashes, linewidth=1.3))
        panel.plot(*np.transpose([center, (1.8, 0.6)]), color=color, linestyle=dashes, linewidth=2.6)
    draw_exit_points(panel, exits, ("A₁", "A₂"))
    panel.plot(1.8, 0.6, "o", color=INK, markersize=11)
    panel.plot(1.8, 5.4, "o", color=INK, markersize=11, markerfacecolor="white")
    panel.set(xlim=(-3.3, 9.3), ylim=(-1.4, 7.3), aspect="equal", title="Two lengths, two places")


def modes(panel):
    """Two poses with the same three lengths."""
    robot, upright = six_cables(3), cl.Pose([0.4, 1.3], angle=0.15)
    turned = gauss_newton_path(robot, cl.cable_lengths(robot, upright), cl.Pose([0.6, 1.8], angle=-2.4)).poses[-1]
    panel.plot(*outline(robot, turned).T, color=VERMILION, linestyle=(0, (4, 2)), linewidth=2.0)
    panel.plot(*turned.position, "o", color=VERMILION, markersize=5)
    draw_robot(panel, robot, upright, color=INK)
    anchors = turned.position + robot.anchor_points @ turned.rotation.T
    for exit_point, anchor in zip(robot.exit_points, anchors):
        panel.plot(*np.transpose([exit_point, anchor]), color=GREY, linestyle=(0, (4, 2)), linewidth=1.2)
    panel.set(xlim=(-2.4, 2.4), ylim=(-0.3, 3.4), aspect="equal", title="Three lengths, two poses")


def png():
    """The picture as a palette PNG, below 60 kB."""
    with house_style():
        figure = Figure(figsize=(8.4, 3.2), dpi=110, layout="constrained")
        left, right = figure.subplots(1, 2)
        circles(left)
        modes(right)
        for panel in (left, right):
            panel.set(xticks=[], yticks=[])
            panel.spines[:].set_visible(False)
        drawn, packed = BytesIO(), BytesIO()
        figure.savefig(drawn, dpi=110)
    Image.open(drawn).convert("RGB").quantize(64).save(packed, "png", optimize=True)
    return packed.getvalue()


if __name__ == "__main__":
    attach("03_forward_kinematics", "forward_kinematics.png", png())
