"""Pictures of a job: what platform, cables, bases and wheels did in which phase, and a film with captions."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from ...view.film import save_gif
from ...view.plots import Figure, label_cables, label_ends, spread_apart
from ...view.screen import RobotScreen
from ...view.style import AXIS_COLORS, AXIS_DASHES, BLUE, GREY, INK, VERMILION, cable_style, house_style
from ...world.model import Scene
from ..job.job_record import Job, least_edge_loads

_STILL = 0.02    # m: a base that moves less across the floor stands as far as a picture can tell


def plot_job(job: Job) -> Figure:
    """Platform, tracking error, tensions, bases and wheel loads over time, phases named above [m, mm, N].

    job : Job
    """
    with house_style():
        figure = Figure(figsize=(12.0, 11.0), layout="constrained")
        axes = list(figure.subplots(5, 1, sharex=True, height_ratios=[1.2, 0.8, 1.5, 0.8, 1.0]))
        for panel in axes:
            _shade_phases(panel, job)
        _name_phases(axes[0], job)
        _platform_panel(axes[0], job)
        _error_panel(axes[1], job)
        _tension_panel(axes[2], job)
        _base_panel(axes[3], job)
        _wheel_panel(axes[4], job)
        axes[-1].set_xlabel("time [s]")
        axes[-1].set_xlim(0, float(job.time[-1]))
        figure.suptitle(f"{job.world.title} · {job.task.replace('_', ' ')} · {job.method} control · {job.state}",
                        x=0.01, ha="left", fontsize=13, color=INK)
        figure.alt_text = _caption(job) + " " + "; ".join(f"{name}: {value}" for name, value in job.table().items())
        return figure


def save_job_film(job: Job, path: str | Path, seconds: float = 16.0, fps: int = 8, width: int = 640) -> Path:
    """An animated GIF of a job, below 3 MB, each picture with what is being done in words.

    Phases are shown as long as they take, short ones more slowly, or their captions could not be read.

    path : ends in .gif
    seconds : length of the film [s]; fps : pictures per second; width : [pixels]
    """
    screen = JobScreen(job, job.world.scene, width)
    return save_gif(map(screen.at, film_moments(job, round(seconds * fps))), path, 1 / fps, _caption(job))


def film_moments(job: Job, frames: int, share: float = 0.06) -> list[float]:
    """Times of a film's pictures: each phase takes what it takes, but at least this share of the job's time [s]."""
    bounds = np.array([start for start, _, _ in _spans(job)] + [float(job.time[-1])])
    shown = np.maximum(np.diff(bounds), share * bounds[-1])
    moments: list[float] = np.interp(np.linspace(0.0, shown.sum(), frames), [0.0, *np.cumsum(shown)], bounds).tolist()
    return moments


class JobScreen(RobotScreen):
    """The pictures of a job's film, at whatever time.

    scene : what stands around it, that of the job's world or less; width : [pixels]
    """

    def __init__(self, job: Job, scene: Scene, width: int = 640) -> None:
        self.job = job
        some = job.poses[np.linspace(0, len(job.time) - 1, 20).astype(int)]
        super().__init__(job.world.robot, scene, some, job.measured_tensions, job.world.title, width, captioned=True)

    def at(self, t: float) -> NDArray[np.uint8]:
        """(height, width, 3) the picture at a time of the job [s]."""
        return self.show(t, self.move(t))

    def move(self, t: float) -> str:
        """The robot at a time of the job [s]; returns what it does."""
        job, k = self.job, min(int(np.searchsorted(self.job.time, t - 1e-9)), len(self.job.time) - 1)
        self.drawing.drive(job.robot_at(k))
        self.drawing.move(job.poses[k], job.measured_tensions[k], loads=[(job.box_poses[k], job.work.box_size)],
                          trail=job.poses.position[np.unique(np.linspace(0, k, 60).astype(int))])
        return _words(job, k)


def frame_at(job: Job, t: float, width: int = 640, scene: Scene | None = None) -> NDArray[np.uint8]:
    """(height, width, 3) one picture of the film.

    t : [s]; width : [pixels]; scene : instead of the job's own
    """
    return JobScreen(job, job.world.scene if scene is None else scene, width).at(t)


# --- panels -----------------------------------------------------------------------------------------------
def _spans(job: Job) -> list[tuple[float, float, str]]:
    starts = [event.time for event in job.events]
    return [(start, end, event.state) for start, end, event in zip(starts, [*starts[1:], float(job.time[-1])],
                                                                   job.events)]


def _shade_phases(panel: Axes, job: Job) -> None:
    for k, (start, end, _) in enumerate(_spans(job)):
        if k % 2:
            panel.axvspan(start, end, color="#F1F3F5", zorder=0, linewidth=0)


def _name_phases(panel: Axes, job: Job) -> None:
    spans, lasting = _spans(job), float(job.time[-1])
    middles = np.array([(start + end) / 2 for start, end, _ in spans])
    for (_, _, name), middle in zip(spans, lasting * spread_apart(middles / lasting, gap=0.017)):
        panel.annotate(name, (middle, 1.0), xycoords=("data", "axes fraction"), xytext=(0, 4), rotation=60,
                       textcoords="offset points", ha="left", va="bottom", fontsize=9, color=GREY,
                       annotation_clip=False)


def _platform_panel(panel: Axes, job: Job) -> None:
    lines = list(job.poses.position.T)
    for line, color, dashes in zip(lines, AXIS_COLORS, AXIS_DASHES):
        panel.plot(job.time, line, color=color, linestyle=dashes)
    panel.set_ylabel("platform [m]")
    label_ends(panel, lines, "xyz", AXIS_COLORS)


def _error_panel(panel: Axes, job: Job) -> None:
    panel.plot(job.time, 1e3 * job.position_errors, color=INK)
    panel.set_ylabel("error [mm]")
    panel.set_ylim(bottom=0)


def _tension_panel(panel: Axes, job: Job) -> None:
    robot, lines = job.world.robot, list(job.measured_tensions[1:].T)
    for cable, line in enumerate(lines):
        color, dashes = cable_style(cable)
        panel.plot(job.time[1:], line, color=color, linestyle=dashes, linewidth=1.2)
    for limit in (robot.tension_min.min(), robot.tension_max.max()):
        panel.axhline(limit, color=INK, linewidth=1.2, linestyle=(0, (1, 2)))
    panel.set_ylabel("tension [N]")
    label_cables(panel, job.measured_tensions[1:])


def _base_panel(panel: Axes, job: Job) -> None:
    """Along the floor, x solid and y dashed; a base whose y stays 0 shows x alone."""
    lines, names, colors = [], [], []
    for k, (base, color) in enumerate(zip(job.world.robot.bases, (BLUE, VERMILION))):
        for axis, name, dashes in ((0, "x", "-"), (1, "y", "--")):
            line = job.base_poses[:, k, axis]
            if axis == 0 or np.ptp(line) > _STILL:
                panel.plot(job.time, line, color=color, linestyle=dashes)
                lines.append(line)
                names.append(f"{base.name} {name}")
                colors.append(color)
    panel.set_ylabel("bases [m]")
    label_ends(panel, lines, names, colors)


def _wheel_panel(panel: Axes, job: Job) -> None:
    """The least loaded edge of each base: at zero the base begins to tip."""
    lines = list(least_edge_loads(job.wheels[1:]).T)
    for line, color in zip(lines, (BLUE, VERMILION)):
        panel.plot(job.time[1:], line, color=color)
    panel.axhline(0, color=INK, linewidth=1.2, linestyle=(0, (1, 2)))
    panel.set_ylabel("least edge load [N]")
    panel.annotate("0: a base begins to tip", (0.005, 0), xycoords=("axes fraction", "data"), xytext=(0, 3),
                   textcoords="offset points", fontsize=9, color=INK)
    label_ends(panel, lines, [base.name for base in job.world.robot.bases], (BLUE, VERMILION))


# --- words ------------------------------------------------------------------------------------------------
def _words(job: Job, index: int) -> str:
    state = job.state_at(index)
    if state == "stopped":
        return f"STOPPED {job.reason}"
    return {"done": "done"}.get(state, f"{state}: {job.words.get(state, '')}".rstrip(": "))


def _caption(job: Job) -> str:
    return (f"{job.world.title}, {job.task.replace('_', ' ')} under {job.method} control: two mobile bases, the "
            f"platform between them on {job.world.robot.n_cables} cables, a shelf and a box, seen from "
            "the front and above.")
