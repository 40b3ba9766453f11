"""The closed loop: reference, controller, tension distribution, engine; and the log of what happened."""

from ..simulate import WOUND
from .distributor import INFEASIBLE
from .log import Log
from .record import Run
from .start import Cuts, run

__all__ = ["INFEASIBLE", "WOUND", "Cuts", "Log", "Run", "run"]
