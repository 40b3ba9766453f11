"""Explorers: sliders, a picture that answers at once, and the numbers as text. ipywidgets loads when first used."""

from __future__ import annotations

from importlib import import_module
from typing import Any

_HOMES = {
    "Choice": "explorer",
    "Explorer": "explorer",
    "Slider": "explorer",
    "pose_explorer": "pose",
    "run_player": "player",
    "hanging_explorer": "hanging",
    "equilibrium_explorer": "equilibrium",
    "forward_kinematics_explorer": "forward_kinematics",
    "two_circles_explorer": "two_circles",
    "tension_explorer": "tension",
    "base_explorer": "bases",
    "twist_set_explorer": "twist_set",
    "wrench_set_explorer": "wrench_set",
    "configuration_explorer": "configurations",
    "gain_explorer": "gains",
    "robot_designer": ".designer.panel",
    "planning_explorer": "planning",
    "workspace_explorer": "workspaces",
}
"""Public name → the file of this folder it lives in; one line each. No file is named as what it exports: once
imported, the file itself would answer to that name."""

__all__ = sorted(_HOMES)


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"there is no widget {name!r}; there are {', '.join(sorted(_HOMES))}")
    return getattr(import_module(f".{_HOMES[name]}", __name__), name)


def __dir__() -> list[str]:
    return __all__
