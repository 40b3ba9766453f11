"""The picture of lesson 2: three cables that all pull, and three of which one would have to push.

python docs/lesson_pictures/02_wrench_matrix.py
"""

from __future__ import annotations

import base64
from io import BytesIO
from pathlib import Path

import matplotlib
import nbformat
from matplotlib.figure import Figure

from cdprlab.view.equilibrium import draw_panels, equilibrium, point_load
from cdprlab.view.style import house_style

LESSON = Path(__file__).parents[2] / "lessons/source/02_wrench_matrix/02_wrench_matrix.ipynb"
NAME = "wrench_matrix.png"

SCENES = {"Inside: every cable pulls": ([0.5, 2.1], 130.0), "Outside: cable 1 would push": ([1.3, 0.5], 85.0)}
"""Title → position of the load [m] and internal tension [N]."""


def main() -> None:
    """Draw the picture and put it into the lesson's source."""
    lesson = nbformat.read(LESSON, as_version=nbformat.NO_CONVERT)
    lesson.cells[0]["attachments"] = {NAME: {"image/png": base64.b64encode(picture()).decode()}}
    text = nbformat.writes(lesson, version=nbformat.NO_CONVERT).rstrip("\n") + "\n"
    LESSON.write_text(text, encoding="utf-8", newline="\n")


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
    main()
