"""Engines behind one interface: `open_simulator` gives the one a world asks for."""

from .simulator import CABLE_MODELS, Simulator, open_simulator

__all__ = ["CABLE_MODELS", "Simulator", "open_simulator"]
