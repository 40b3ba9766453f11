"""The picture of a mission's drives: what wheels, masts and cables had to bear."""

from typing import Any

import numpy as np

from ...arrays import Array
from ...view.plots import Figure, draw_lines, mark_level
from ...view.style import BLUE, GREEN, GREY, house_style
from ..job.job_record import least_edge_loads
from ..mission.guards import LEANS
from ..mission.mission_record import Mission
from ..navigation.journey import Journey
from .job_figure import BASE_STYLES, TIPS


def plot_drives(mission: Mission) -> Figure:
    """Room left, least loaded edge of each base, tilt, and tensions on the way there and on the way home.

    mission : Mission with one of the two at least
    """
    ways = {name: part for name, part in mission.parts.items()
            if isinstance(part, Journey) and part.measured}
    with house_style():
        figure = Figure(figsize=(11.0, 8.0), layout="constrained")
        panels = figure.subplots(4, max(1, len(ways)), sharex="col", sharey="row",
                                 squeeze=False)
        for column, (name, way) in zip(panels.T, ways.items()):
            column[0].set_title(name)
            _draw_drive(column, mission, way)
            column[-1].set_xlabel("time [s]")
        for panel, label in zip(panels[:, 0], ("room left [m]", "least edge\nload [N]",
                                               "tilt [°]", "tension [N]")):
            panel.set_ylabel(label)
        told = "; ".join(f"{name}: at least {way.clearance.min():.2f} m of room, "
                         f"{_edges(way).min():.0f} N on each edge's wheels"
                         for name, way in ways.items())
        figure.alt_text = f"Room, wheel loads, tilt and cable tensions over time on the drives. {told}."
    return figure


def _draw_drive(column: Any, mission: Mission, way: Journey) -> None:
    room, loads, tilts, tensions = column
    drive: Any = way.measured
    room.plot(way.time, way.clearance, color=BLUE)
    room.fill_between(way.time, 0, 1, where=way.waiting, transform=room.get_xaxis_transform(),
                      color=GREEN, alpha=0.2, linewidth=0, label="waits")
    room.set_ylim(bottom=0)
    if way.waiting.any():
        room.legend(loc="lower right", fontsize=9)
    times, robot, leaning = way.time[1:], mission.world.robot, float(np.degrees(LEANS))
    draw_lines(loads, times[_FOUND:], _edges(way), [base.name for base in robot.bases],
               BASE_STYLES)
    mark_level(loads, 0.0, TIPS)
    loads.legend(loc="center right", fontsize=9)
    tilts.plot(times[_FOUND:], np.degrees(drive["tilts"][_FOUND:]), color=BLUE)
    mark_level(tilts, leaning, "more: a base leans")
    tilts.set_ylim(0, 1.3 * leaning)
    tensions.plot(times, drive["tensions"], color=GREY, linewidth=1)
    mark_level(tensions, robot.tension_min.min(), "no cable moves: all at their least")
    tensions.set_ylim(0, 3 * float(robot.tension_min.max()))


_FOUND = 3      # rows in which the wheels find the floor


def _edges(way: Any) -> Array:
    """(N, p) loads of each base's least loaded edge, once the wheels have found the floor [N]."""
    return least_edge_loads(way.measured["wheels"][_FOUND:])
