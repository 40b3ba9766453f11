"""The picture of lesson 4: the polygon of feasible tensions of CAROCA, and which point each method picks.

python docs/lesson_pictures/04_tension_distribution.py
"""

from __future__ import annotations

from io import BytesIO

import matplotlib
from attachment import attach

import cdprlab as cl
from cdprlab.course.pictures.tension_panels import plot_tension_set
from cdprlab.view.style import house_style

METHODS = ("linear_program", "quadratic_program", "pseudo_inverse", "closed_form", "improved_closed_form", "puncture",
           "barycenter")


def picture() -> bytes:
    """The picture as PNG."""
    matplotlib.use("agg")
    robot, pose = cl.load_world("caroca").robot, cl.Pose([-1.5, -0.6, 1.6], rpy=[0.02, 0.15, -0.15])
    figure = plot_tension_set(cl.wrench_matrix(robot, pose), cl.gravity_wrench(robot, pose), 250, 1500, METHODS)
    file = BytesIO()
    with house_style():
        figure.axes[0].set_title("Tensions that hold CAROCA, and who picks which")
        figure.savefig(file, dpi=80)
    return file.getvalue()


if __name__ == "__main__":
    attach("04_tension_distribution", "tension_distribution.png", picture())
