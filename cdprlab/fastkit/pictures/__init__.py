"""Figures and films of jobs, missions and journeys."""
