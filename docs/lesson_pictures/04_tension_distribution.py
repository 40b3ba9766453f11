"""The picture of lesson 4: the polygon of feasible tensions of CAROCA, and which point each method picks.

python docs/lesson_pictures/04_tension_distribution.py
"""

from __future__ import annotations

import base64
from io import BytesIO
from pathlib import Path

import matplotlib
import nbformat

import cdprlab as cl
from cdprlab.view.style import house_style
from cdprlab.view.tension_panels import plot_tension_set

LESSON = Path(__file__).parents[2] / "lessons/source/04_tension_distribution/04_tension_distribution.ipynb"
NAME = "tension_distribution.png"

METHODS = ("linear_program", "quadratic_program", "pseudo_inverse", "closed_form", "improved_closed_form", "puncture",
           "barycenter")


def main() -> None:
    """Draw the picture and put it into the lesson's source."""
    lesson = nbformat.read(LESSON, as_version=nbformat.NO_CONVERT)
    lesson.cells[0]["attachments"] = {NAME: {"image/png": base64.b64encode(picture()).decode()}}
    text = nbformat.writes(lesson, version=nbformat.NO_CONVERT).rstrip("\n") + "\n"
    LESSON.write_text(text, encoding="utf-8", newline="\n")


def picture() -> bytes:
    """The picture as PNG."""
    matplotlib.use("agg")
    robot, pose = cl.load_world("caroca").robot, cl.Pose([-1.5, -0.6, 1.6], rpy=[0.02, 0.15, -0.15])
    figure = plot_tension_set(cl.wrench_matrix(robot, pose), cl.gravity_wrench(robot, pose), 250, 1500, METHODS,
                              title="Tensions that hold CAROCA, and who picks which")
    file = BytesIO()
    with house_style():
        figure.savefig(file, dpi=80)
    return file.getvalue()


if __name__ == "__main__":
    main()
