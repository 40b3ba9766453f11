"""Workspaces: which poses a robot can serve, by criteria that combine, over grids, swept and certified."""

from .criterion import Criterion, Judgement
from .grids import PoseGrid, low_discrepancy_poses, position_grid, random_poses
from .orientations import AllOrientations, AnyOrientation
from .refinement import RefinedWorkspace, refine
from .sweep import workspace
from .tensions import (
    DynamicEquilibrium,
    StaticEquilibrium,
    TippingSafe,
    WrenchClosure,
    WrenchFeasible,
)

__all__ = [
    "AllOrientations", "AnyOrientation", "Criterion", "DynamicEquilibrium", "Judgement", "PoseGrid",
    "RefinedWorkspace", "StaticEquilibrium", "TippingSafe", "WrenchClosure", "WrenchFeasible",
    "low_discrepancy_poses", "position_grid", "random_poses", "refine", "workspace",
]
