"""Workspaces: which poses a robot can serve, by criteria that combine, over grids, swept and certified."""

from .certified import certify
from .criterion import AllOrientations, AnyOrientation, Criterion, Judgement
from .grids import PoseGrid, low_discrepancy_poses, position_grid
from .interference import InterferenceFree
from .refinement import refine
from .stability import StaticallyStable
from .sweep import workspace
from .tensions import DynamicEquilibrium, StaticEquilibrium, TippingSafe, WrenchClosure, WrenchFeasible
from .twists import TwistFeasible
from .workspace_cells import WorkspaceCells

__all__ = [
    "AllOrientations", "AnyOrientation", "Criterion",
    "DynamicEquilibrium", "InterferenceFree",
    "Judgement", "PoseGrid", "StaticEquilibrium", "StaticallyStable",
    "TippingSafe",
    "TwistFeasible", "WorkspaceCells", "WrenchClosure", "WrenchFeasible", "certify", "low_discrepancy_poses",
    "position_grid",
    "refine", "workspace",
]
