"""What students look at: figures of runs, stills and films. Drawing libraries load when first used."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["plot", "plot_job", "plot_tensions", "plot_tracking", "save_figure", "save_film", "save_job_film", "still"]


def plot(run_or_table: Any) -> Figure:
    """One figure of a whole run: motion, errors, tensions. A table that can draw itself (``.plot()``) does so.

    run_or_table : Run, or a table
    Raises InvalidInput for anything else.

    >>> import cdprlab as cl
    >>> plot(42)
    Traceback (most recent call last):
    ...
    cdprlab.errors.InvalidInput: plot takes a Run (or a table with its own plot method), got int
    """
    from .plots import plot

    return plot(run_or_table)


def plot_tracking(run: Any) -> Figure:
    """Reference and actual position over time, and what lies between them [m, mm, mrad]."""
    from .plots import plot_tracking

    return plot_tracking(run)


def plot_tensions(run: Any) -> Figure:
    """Commanded and measured tension of every cable over time, and their difference [N]."""
    from .plots import plot_tensions

    return plot_tensions(run)


def plot_job(job: Any) -> Figure:
    """A pick-and-place job over time: platform, error, tensions, bases, wheel loads, phases by name."""
    from .job import plot_job

    return plot_job(job)


def save_job_film(job: Any, path: str | Path, seconds: float = 16.0, fps: int = 8, width: int = 640) -> Path:
    """An animated GIF of a pick-and-place job, below 3 MB, with what is being done in words.

    path : ends in .gif
    seconds : length of the film [s]; fps : pictures per second; width : [pixels]
    """
    from .job import save_job_film

    return save_job_film(job, path, seconds, fps, width)


def save_figure(figure: Figure, path: str | Path) -> Path:
    """Save a figure with its text description inside the file.

    path : .png, .svg or .pdf
    """
    from .plots import save_figure

    return save_figure(figure, path)


def save_film(run: Any, path: str | Path, seconds: float | None = None, fps: int = 12, width: int = 640) -> Path:
    """An animated GIF of a run, below 3 MB.

    path : ends in .gif
    seconds : length of the film [s]; default that of the run, at most 12
    fps : pictures per second
    width : [pixels]
    """
    from .film import save_film

    return save_film(run, path, seconds, fps, width)


def still(run: Any, path: str | Path, t: float = 0.0, width: int = 960) -> Path:
    """A PNG of a run at one time, with the tension scale.

    path : ends in .png
    t : [s]
    width : [pixels]
    """
    from .film import still

    return still(run, path, t, width)
