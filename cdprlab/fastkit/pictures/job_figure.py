"""Pictures of a job: what platform, cables, bases and wheels did in which phase, and a film with captions."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from ...arrays import Array, checked
from ...view.film import Frame, RunScreen, picture_count, save_gif
from ...view.plots import Figure, draw_lines, fitted_title, label_ends, mark_level, spread_apart
from ...view.style import AXIS_STYLES, BLUE, GREY, INK, VERMILION, LineStyle, cable_style, house_style
from ...world.model import Scene
from ..events import STOPPED, spans
from ..job.job_record import Job
from ..job.machine import least_edge_loads

BASE_STYLES = LineStyle(BLUE, "-"), LineStyle(VERMILION, "-")
TIPS = "0: a base begins to tip"

_STILL = 0.02    # m: a base that moves less across the floor stands as far as a picture can tell


@checked
def plot_job(job: Job) -> Figure:
    """Platform, tracking error, tensions, bases and wheel loads over time, phases named above [m, mm, N].

    job : Job
    """
    with house_style():
        robot = job.world.robot
        figure = Figure(figsize=(12.0, 11.0), layout="constrained")
        panels = figure.subplots(5, 1, sharex=True, height_ratios=[1.2, 0.8, 1.5, 0.8, 1.0])
        platform, error, tension, bases, wheels = panels
        _show_phases(panels, job)
        _draw(platform, job.time, job.poses.position, "platform [m]", "xyz", AXIS_STYLES)
        error.plot(job.time, 1e3 * job.position_errors, color=INK)
        error.set(ylabel="error [mm]", ylim=(0, None))
        for limit in (robot.tension_min.min(), robot.tension_max.max()):
            mark_level(tension, limit)
        cables = range(robot.n_cables)
        _draw(tension, job.time[1:], job.measured_tensions[1:], "tension [N]",
              [f"{i + 1}" for i in cables], [cable_style(i) for i in cables], linewidth=1.2)
        _draw_bases(bases, job)
        mark_level(wheels, 0.0, TIPS)
        _draw(wheels, job.time[1:], least_edge_loads(job.wheels[1:]), "least edge load [N]",
              [base.name for base in robot.bases], BASE_STYLES)
        wheels.set(xlabel="time [s]", xlim=(0, job.time[-1]))
        fitted_title(figure, f"{job.world.title} · {job.task.replace('_', ' ')} · {job.method} control · {job.state}")
        figure.alt_text = _caption(job) + " " + "; ".join(f"{name}: {value}" for name, value in job.table().items())
        return figure


@checked
def save_job_film(job: Job, path: str | Path, seconds: float = 16.0, fps: int = 8,
                  width: int = 640) -> Path:
    """An animated GIF of a job, below 3 MB, each picture with what is being done in words.

    Phases are shown as long as they take, short ones more slowly, or their captions could not
    be read.

    path : ends in .gif
    seconds : length of the film [s]; fps : pictures per second; width : [pixels]
    """
    moments = film_moments(job, picture_count(seconds, fps))
    return save_gif(map(JobScreen(job, width, captioned=True).at, moments), path, 1 / fps,
                    _caption(job))


def film_moments(job: Job, frames: int) -> list[float]:
    """Times of a film's pictures: each phase takes what it takes, but at least 6 % of the job's time [s]."""
    bounds = np.array([event.time for event in job.events] + [job.time[-1]])
    shown = np.maximum(np.diff(bounds), 0.06 * bounds[-1])
    return np.interp(np.linspace(0.0, shown.sum(), frames), [0.0, *np.cumsum(shown)], bounds).tolist()


class JobScreen(RunScreen):
    """The pictures of a job's film: a run's, with the box and in words what is done."""

    def words(self, index: int) -> str:
        state = self.run.state_at(index)
        if state == STOPPED:
            return f"STOPPED {self.run.reason}"
        what = self.run.words.get(state)
        return f"{state}: {what}" if what else state


@checked
def frame_at(job: Job, t: float, width: int = 640, scene: Scene | None = None) -> Frame:
    """(height, width, 3) one picture of the film.

    t : [s]; width : [pixels]; scene : instead of the job's own
    """
    return JobScreen(job, width, scene, captioned=True).at(t)


# --- panels -----------------------------------------------------------------------------------------------
def _show_phases(panels: Sequence[Axes], job: Job) -> None:
    """Every other one shaded, all named above."""
    lasting = job.time[-1]
    phases = spans(job.events, lasting)
    for start, end, _ in phases[1::2]:
        for panel in panels:
            panel.axvspan(start, end, color="#F1F3F5", zorder=0, linewidth=0)
    middles = np.array([start + end for start, end, _ in phases]) / 2
    for (_, _, name), middle in zip(phases,
                                    lasting * spread_apart(middles / lasting, gap=0.017)):
        panels[0].annotate(name, (middle, 1.0), xycoords=("data", "axes fraction"),
                           xytext=(0, 4), rotation=60, textcoords="offset points", ha="left",
                           va="bottom", fontsize=9, color=GREY, annotation_clip=False)


def _draw_bases(panel: Axes, job: Job) -> None:
    """Along the floor, x solid and y dashed; a base whose y stays 0 shows x alone."""
    rows = []
    for base, style, poses in zip(job.world.robot.bases, BASE_STYLES, job.base_poses.swapaxes(0, 1)):
        for name, dashes, line in zip("xy", ("-", "--"), poses.T):
            if name == "x" or np.ptp(line) > _STILL:
                rows.append((line, f"{base.name} {name}", LineStyle(style.color, dashes)))
    lines, names, styles = zip(*rows)
    _draw(panel, job.time, np.transpose(lines), "bases [m]", names, styles)


def _draw(panel: Axes, time: Array, lines: Array, label: str, names: Sequence[str],
          styles: Sequence[LineStyle], **options: Any) -> None:
    """Columns (N, k) over time, named at their ends."""
    draw_lines(panel, time, lines, names, styles, **options)
    panel.set_ylabel(label)
    label_ends(panel, lines, names, styles)


def _caption(job: Job) -> str:
    return (f"{job.world.title}, {job.task.replace('_', ' ')} under {job.method} control: two mobile bases, the "
            f"platform between them on {job.world.robot.n_cables} cables, a shelf and a box, seen from "
            "the front and above.")
