"""Figures that one lesson shows."""
