"""What students look at: figures of runs, stills and films. Drawing libraries load when first used."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..errors import InvalidInput, door, needed_by, quoted
from ..run.compare import TensionComparison
from . import notebook as notebook  # from here on the library's objects show themselves

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_HOMES = {"draw": ".film", "plot_tensions": ".plots", "plot_tracking": ".plots",
          "save_figure": ".plots",
          "save_film": ".film", "save_scene": ".scene", "still": ".film"}
"""Name → its file."""

__all__ = ["plot", *_HOMES]


def plot(run_or_table: Any, beside: Any = None) -> Figure:
    """One figure of a whole run: motion, errors, tensions. Or a comparison's tensions; anything
    with a ``plot()`` of its own draws itself.

    run_or_table : Run or TensionComparison
    beside : another Run whose positions and tensions a run is drawn with, such as `read_log` gives
    Raises InvalidInput for anything else.

    >>> import cdprlab as cl
    >>> plot(42)
    Traceback (most recent call last):
    ...
    cdprlab.errors.InvalidInput: plot takes a Run, a TensionComparison or what has a plot method, got int
    """
    if beside is not None and not hasattr(beside, "commanded_tensions"):
        raise InvalidInput(f"beside must be a Run, got {quoted(beside)}")
    with needed_by("plot"):
        if isinstance(run_or_table, TensionComparison):
            from .tension_comparison import plot_tension_comparison

            return plot_tension_comparison(run_or_table)
        if hasattr(run_or_table, "commanded_tensions"):
            from .plots import plot_run

            return plot_run(run_or_table, beside)
        if callable(getattr(run_or_table, "plot", None)):
            return run_or_table.plot()
    raise InvalidInput("plot takes a Run, a TensionComparison or what has a plot method, "
                       f"got {type(run_or_table).__name__}")


__getattr__ = door(__name__, _HOMES)
