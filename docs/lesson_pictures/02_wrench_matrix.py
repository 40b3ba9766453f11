"""The picture of lesson 2: three cables that all pull, and three of which one would have to push.

python docs/lesson_pictures/02_wrench_matrix.py
"""

from __future__ import annotations

from io import BytesIO

import matplotlib
from attachment import attach
from matplotlib.figure import Figure

from cdprlab.course.pictures.equilibrium import draw_panels
from cdprlab.course.props.point_load import equilibrium, point_load
from cdprlab.view.style import house_style

SCENES = {"Inside: every cable pulls": ([0.5, 2.1], 130.0), "Outside: cable 1 would push": ([1.3, 0.5], 85.0)}
"""Title → position of the load [m] and internal tension [N]."""


def picture() -> bytes:
    """The picture as PNG."""
    matplotlib.use("agg")
    robot = point_load(3)
    with house_style():
        figure = Figure(figsize=(8.4, 6.4), layout="constrained")
        spare = Figure().subplots()  # for the bars, left out here
        axes = figure.subplots(2, 2)
        for (title, (position, internal)), left, right in zip(SCENES.items(), axes[:, 0], axes[:, 1]):
            state = equilibrium(robot, position, internal=internal)
            draw_panels([left, right, spare], robot, position, [0, 0], state)
            left.set_title(title, y=1.02)
            right.set_title("its forces", y=1.02)
        file = BytesIO()
        figure.savefig(file, dpi=88)
    return file.getvalue()


if __name__ == "__main__":
    attach("02_wrench_matrix", "wrench_matrix.png", picture())
