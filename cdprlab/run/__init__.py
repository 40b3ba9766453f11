"""The closed loop: reference, controller, tension distribution, engine; and the log of what happened."""

from .distributor import INFEASIBLE
from .loop import Progress
from .record import Run, write_csv
from .start import WOUND, Cuts, run

__all__ = ["INFEASIBLE", "WOUND", "Cuts", "Progress", "Run", "run", "write_csv"]
