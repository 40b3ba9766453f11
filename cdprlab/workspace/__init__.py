"""Workspaces: which poses a robot can serve, by criteria that combine, over grids, swept and certified."""

from .certified import CertifiedWorkspace, certify
from .criterion import Criterion, Judgement
from .grids import PoseGrid, low_discrepancy_poses, position_grid
from .interference import InterferenceFree
from .orientations import AllOrientations, AnyOrientation
from .refinement import RefinedWorkspace, refine
from .stability import StaticallyStable
from .sweep import workspace
from .tensions import DynamicEquilibrium, StaticEquilibrium, TippingSafe, WrenchClosure, WrenchFeasible
from .twists import TwistFeasible

__all__ = [
    "AllOrientations", "AnyOrientation", "CertifiedWorkspace", "Criterion",
    "DynamicEquilibrium", "InterferenceFree",
    "Judgement", "PoseGrid", "RefinedWorkspace", "StaticEquilibrium", "StaticallyStable",
    "TippingSafe",
    "TwistFeasible", "WrenchClosure", "WrenchFeasible", "certify", "low_discrepancy_poses",
    "position_grid",
    "refine", "workspace",
]
