"""Tension distributions: one method a file, one signature, one self-checking result."""

from .distribution import distribute_tensions
from .judgement import TensionDistribution, checked_distribution
from .methods import solver_for, tension_methods

__all__ = ["TensionDistribution", "checked_distribution", "distribute_tensions", "solver_for",
           "tension_methods"]
