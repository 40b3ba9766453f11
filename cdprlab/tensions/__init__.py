"""Tension distributions: one method a file, one signature, one self-checking result."""

from .distribution import distribute_tensions, solver_for, tension_methods
from .judgement import TensionDistribution

__all__ = ["TensionDistribution", "distribute_tensions", "solver_for", "tension_methods"]
