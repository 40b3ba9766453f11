"""The picture of lesson 10: the way through the hall to the shelf, and the box being drawn from its board.

python docs/lesson_pictures/10_fastkit_at_work.py
"""

from __future__ import annotations

from io import BytesIO
from typing import Any

import matplotlib
from attachment import attach
from matplotlib.figure import Figure
from PIL import Image

import cdprlab as cl
from cdprlab.fastkit import Mission, carried, draw_hall, draw_way, frame_at, in_hall, run_mission
from cdprlab.fastkit.mission.around_the_shelf import BOUNDS, PALLETS, START
from cdprlab.view.style import VERMILION, house_style


def picture() -> bytes:
    """The picture as PNG."""
    matplotlib.use("agg")
    world = cl.load_world("fastkit_suspended")
    mission = run_mission(in_hall(world, BOUNDS, PALLETS), BOUNDS, START)
    with house_style():
        figure = Figure(figsize=(9.4, 3.5), layout="constrained")
        left, right = figure.subplots(1, 2, width_ratios=(1, 1.1))
        _hall(left, mission)
        _work(right, mission, world)
        file = BytesIO()
        figure.savefig(file, dpi=100)
    # A palette: a third of the bytes, and no color that matters is lost.
    small = BytesIO()
    Image.open(file).convert("RGB").quantize(256).save(small, "png", optimize=True)
    return small.getvalue()


def _hall(axes: Any, mission: Mission) -> None:
    journey = mission.journey
    assert journey is not None
    draw_hall(axes, journey.hall, journey.vehicle)
    draw_way(axes, journey)
    axes.plot(*carried(journey.estimates[-1], journey.scans[-1]).T, ".", color=VERMILION, markersize=3, zorder=6)
    axes.set(title="It finds its way,")


def _work(axes: Any, mission: Mission, world: cl.World) -> None:
    job = mission.job
    assert job is not None
    begins = next(event.time for event in job.events if event.state == "draw in")
    frame = frame_at(job, begins + 1.5, 900, world.scene)
    height = len(frame)
    axes.imshow(frame[round(0.13 * height):round(0.87 * height)])
    axes.set_axis_off()
    axes.set_title("unfolds, and moves a box.")


if __name__ == "__main__":
    attach("10_fastkit_at_work", "fastkit_at_work.png", picture())
