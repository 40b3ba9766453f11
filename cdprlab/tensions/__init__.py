"""Tension distributions: one method a file, one signature, one self-checking result."""

from .distribution import TensionDistribution, distribute_tensions, solver_for, tension_methods

__all__ = ["TensionDistribution", "distribute_tensions", "solver_for", "tension_methods"]
