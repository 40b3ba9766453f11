"""The picture of lesson 15: two robots that meet the same brief, with eight cables and with six.

python docs/lesson_pictures/15_capstone.py
"""

from __future__ import annotations

import base64
from io import BytesIO
from pathlib import Path

import matplotlib
import nbformat
from matplotlib.figure import Figure

import cdprlab as cl
from cdprlab.course.brief import workshop_brief
from cdprlab.course.pictures.brief_map import draw_design
from cdprlab.view.style import house_style

LESSON = Path(__file__).parents[2] / "lessons/source/15_capstone/15_capstone.ipynb"
NAME = "capstone.png"
HALL = {"lower": [-3.0, -2.2, 0.0], "upper": [3.0, 2.2, 3.6]}
X, Y, Z = 0.4, 0.3, 0.2
CROSSED = [[X, -Y, -Z], [-X, Y, Z], [-X, -Y, Z], [X, Y, -Z], [-X, -Y, -Z], [X, Y, Z], [X, -Y, Z], [-X, Y, -Z]]
EIGHT = [[3.0 * sx, 2.2 * sy] for sy in (-1, 1) for sx in (-1, -1, 1, 1)]
THREE = [([2.0, 2.2, 3.6], [X, 0.0, -Z]), ([1.0, 2.2, 3.6], [X, -Y, Z]), ([-3.0, -2.2, 3.6], [0.0, 0.0, Z])]


def main() -> None:
    """Draw the picture and put it into the lesson's source."""
    lesson = nbformat.read(LESSON, as_version=nbformat.NO_CONVERT)
    lesson.cells[0]["attachments"] = {NAME: {"image/png": base64.b64encode(picture()).decode()}}
    text = nbformat.writes(lesson, version=nbformat.NO_CONVERT).rstrip("\n") + "\n"
    LESSON.write_text(text, encoding="utf-8", newline="\n")


def picture() -> bytes:
    """The picture as PNG."""
    matplotlib.use("agg")
    brief, designs = workshop_brief(), (eight(), six())
    with house_style():
        figure = Figure(figsize=(9.6, 3.6), dpi=75)
        for k, design in enumerate(designs):
            axes = figure.add_axes((0.5 * k, 0.0, 0.5, 0.9))
            draw_design(axes, brief, design)
            margin = brief.judge(design).margin
            axes.set_title(f"{design.robot.n_cables} cables, {margin:.0f} N to spare")
        file = BytesIO()
        figure.savefig(file, dpi=75)
    return file.getvalue()


def eight() -> cl.World:
    """Crossed as CAROCA's; cables to the load's lower corners start lower."""
    return world([([*at, 3.2 if anchor[2] < 0 else 3.6], anchor) for at, anchor in zip(EIGHT, CROSSED)])


def six() -> cl.World:
    """Three cables and their mirror images."""
    return world([*THREE, *([(-x, *rest) for x, *rest in pair] for pair in THREE)])


def world(cables: list) -> cl.World:
    """The brief's load on some cables."""
    return cl.World.from_dict({
        "name": "design", "motion_pattern": "3R3T", "scene": {"frame": HALL}, "cable_limits": {"tension": [15, 700]},
        "platform": {"mass": 80.0, "size": [2 * X, 2 * Y, 2 * Z], "pose": {"position": [0.0, 0.0, 1.0]}},
        "cables": [{"exit_point": list(exit_point), "anchor_point": list(anchor)} for exit_point, anchor in cables]})


if __name__ == "__main__":
    main()
