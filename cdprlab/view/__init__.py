"""What students look at: figures of runs, stills and films. Drawing libraries load when first used."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InvalidInput
from ..run.compare import TensionComparison

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["plot", "plot_tensions", "plot_tracking", "save_figure", "save_film", "still"]


def plot(run_or_table: Any) -> Figure:
    """One figure of a whole run: motion, errors, tensions. Or a comparison's tensions; anything
    with a ``plot()`` of its own draws itself.

    run_or_table : Run or TensionComparison
    Raises InvalidInput for anything else.

    >>> import cdprlab as cl
    >>> plot(42)
    Traceback (most recent call last):
    ...
    cdprlab.errors.InvalidInput: plot takes a Run, a TensionComparison or what has a plot method, got int
    """
    if isinstance(run_or_table, TensionComparison):
        from .tension_comparison import plot_tension_comparison

        return plot_tension_comparison(run_or_table)
    if hasattr(run_or_table, "commanded_tensions"):
        from .plots import plot_run

        return plot_run(run_or_table)
    if callable(getattr(run_or_table, "plot", None)):
        return run_or_table.plot()
    raise InvalidInput("plot takes a Run, a TensionComparison or what has a plot method, "
                       f"got {type(run_or_table).__name__}")


def plot_tracking(run: Any) -> Figure:
    """Reference and actual position over time, and what lies between them [m, mm, mrad]."""
    from .plots import plot_tracking

    return plot_tracking(run)


def plot_tensions(run: Any) -> Figure:
    """Commanded and measured tension of every cable over time, and their difference [N]."""
    from .plots import plot_tensions

    return plot_tensions(run)


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
