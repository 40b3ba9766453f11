"""Pictures of a mission's drives: what the scanners saw on the way, and what wheels, masts and cables had to bear."""

from typing import Any

import numpy as np

from ...arrays import Array
from ...run.log import Log
from ...view.plots import Figure, draw_lines, mark_level
from ...view.style import BLUE, GREEN, GREY, house_style
from ..job.job_record import least_edge_loads
from ..mission.guards import LEANS
from ..mission.mission_record import Mission
from ..navigation.journey import Journey
from .hall_figure import draw_scan
from .job_figure import BASE_STYLES, TIPS


def plot_scans(journey: Journey, moments: int = 6) -> Figure:
    """What the scanners saw at some moments of the way, on the map and where the pair believed to be.

    journey : of `navigate`; moments : evenly spread over it
    """
    with house_style():
        columns = 3
        rows = -(-moments // columns)
        figure = Figure(figsize=(11.0, 3.2 * rows + 0.4), layout="constrained")
        panels = np.ravel(figure.subplots(rows, columns, squeeze=False))
        for panel, k in zip(panels,
                            np.linspace(0, len(journey.time) - 1, moments).round().astype(int)):
            draw_scan(panel, journey, k)
            for x, y in journey.people[k, :, :2].tolist():
                panel.plot(x, y, "o", color=GREEN, markersize=8, zorder=4, label="person")
            panel.set(title=f"{journey.time[k]:.0f} s", xlabel="", ylabel="")
        for panel in panels[moments:]:
            panel.set_axis_off()
        figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center",
                      ncols=3, fontsize=9)
        figure.alt_text = (f"{moments} plans of the hall, {journey.time[0]:.0f} to {journey.time[-1]:.0f} s: the pair "
                           "where it believes to be, and the scanned points, which lie on the map's edges and on "
                           "people.")
    return figure


def plot_drives(mission: Mission) -> Figure:
    """Room left, least loaded edge of each base, tilt, and tensions on the way there and on the way home.

    mission : Mission with one of the two at least
    """
    ways = [(name, way, drive)
            for name, way, drive in (("way there", mission.journey, mission.drive),
                                                       ("way home", mission.way_home,
                                                        mission.drive_home))
            if way is not None and drive is not None and len(drive)]
    with house_style():
        figure = Figure(figsize=(11.0, 8.0), layout="constrained")
        panels = figure.subplots(4, max(1, len(ways)), sharex="col", sharey="row",
                                 squeeze=False)
        for column, (name, way, drive) in zip(panels.T, ways):
            column[0].set_title(name)
            _draw_drive(column, mission, way, drive)
            column[-1].set_xlabel("time [s]")
        for panel, label in zip(panels[:, 0], ("room left [m]", "least edge\nload [N]",
                                               "tilt [°]", "tension [N]")):
            panel.set_ylabel(label)
        told = "; ".join(f"{name}: at least {way.clearance.min():.2f} m of room, "
                         f"{_edges(drive).min():.0f} N on each edge's wheels"
                         for name, way, drive in ways)
        figure.alt_text = f"Room, wheel loads, tilt and cable tensions over time on the drives. {told}."
    return figure


def _draw_drive(column: Any, mission: Mission, way: Journey, drive: Log) -> None:
    room, loads, tilts, tensions = column
    room.plot(way.time, way.clearance, color=BLUE)
    room.fill_between(way.time, 0, 1, where=way.waiting, transform=room.get_xaxis_transform(),
                      color=GREEN, alpha=0.2, linewidth=0, label="waits")
    room.set_ylim(bottom=0)
    if way.waiting.any():
        room.legend(loc="lower right", fontsize=9)
    times, robot, leaning = way.time[1:], mission.world.robot, float(np.degrees(LEANS))
    draw_lines(loads, times[_FOUND:], _edges(drive), [base.name for base in robot.bases],
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


def _edges(drive: Log) -> Array:
    """(N, p) loads of each base's least loaded edge, once the wheels have found the floor [N]."""
    return least_edge_loads(drive["wheels"][_FOUND:])
