"""The picture of lesson 11: a load on three taut ropes and a slack one, and a change of configuration from above.

python docs/lesson_pictures/11_cables_that_go_slack.py
"""

from __future__ import annotations

from io import BytesIO

import matplotlib
import numpy as np
from attachment import attach
from matplotlib.figure import Figure

import cdprlab as cl
from cdprlab.course.pictures.configuration_plan import draw_room, fill_sequence
from cdprlab.view.drawing import RobotDrawing
from cdprlab.view.style import cable_style, house_style

GOAL = [1.9, 1.1, 0.5]


def picture() -> bytes:
    """The picture as PNG."""
    matplotlib.use("agg")
    world = cl.load_world("marionet")
    best = cl.plan_configurations(world.robot, world.pose, GOAL)[0]
    with house_style():
        figure = Figure(figsize=(9.6, 4.4), layout="constrained")
        left, right = figure.subplots(1, 2)
        room = RobotDrawing(left, world.robot, world.scene, world.pose, azimuth=-20.0)
        slack = np.array([k + 1 not in best.steps[0][1] for k in range(4)])
        colors = np.array([matplotlib.colors.to_rgb(cable_style(k).color) for k in range(4)]) * 255
        room.move(world.pose, colors, slack)
        left.set_title("At S: ropes 1, 2 and 4 carry, 3 is slack")
        left.set_axis_off()
        draw_room(right, world.robot)
        fill_sequence(right, world.robot, best)
        right.set_title("From above: A124 until M1, then A123")
        for artist in [*left.get_children(), *right.get_children()]:
            artist.set_animated(False)
        file = BytesIO()
        figure.savefig(file, dpi=66)
    return file.getvalue()


if __name__ == "__main__":
    attach("11_cables_that_go_slack", "slack_cables.png", picture())
