"""Workspaces: which poses a robot can serve, by criteria that combine, over grids, swept and certified."""

from .criterion import Criterion, Judgement
from .sweep import workspace
from .tensions import (
    DynamicEquilibrium,
    StaticEquilibrium,
    TippingSafe,
    WrenchClosure,
    WrenchFeasible,
)

__all__ = ["Criterion", "DynamicEquilibrium", "Judgement", "StaticEquilibrium", "TippingSafe", "WrenchClosure",
           "WrenchFeasible", "workspace"]
