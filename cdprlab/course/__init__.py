"""The course's wing: explorers, the robot designer, the capstone's brief, and what lessons draw and try.

Lessons import ``cdprlab`` and from here, and nothing deeper. Everything loads when first used.

>>> from cdprlab import course
>>> course.Slider("mass", "mass", "kg", 1.0, 9.0, 5.0).caption
'mass [kg]'
"""

import sys
from typing import Any

from ..errors import door
from .shown import figure_bundle

_EXPORTS = {
    "answers.check": "answer check refuses",
    "answers.fallback": "fallback",
    "explorers.explorer": "Choice Explorer Slider",
    "explorers.posing": "pose_explorer",
    "explorers.player": "play run_player",
    "explorers.hanging": "hanging_explorer",
    "explorers.balance": "equilibrium_explorer",
    "explorers.forward_kinematics": "forward_kinematics_explorer",
    "explorers.two_circles": "two_circles_explorer",
    "explorers.tension": "tension_explorer",
    "explorers.bases": "base_explorer",
    "explorers.twist_set": "twist_set_explorer",
    "explorers.wrench_set": "wrench_set_explorer",
    "explorers.configurations": "configuration_explorer",
    "explorers.gains": "error_decay gain_explorer",
    "explorers.planning": "planning_explorer",
    "explorers.workspaces": "workspace_explorer",
    "explorers.real_cable": "real_cable_explorer",
    "explorers.model_errors": "model_error_explorer",
    "designer.panel": "robot_designer",
    "brief": "workshop_brief",
    "predictions": "Question predict",
    "seeds": "seed",
    "pictures.brief_map": "plot_design",
    "pictures.configuration_plan": "plot_sequences plot_triplets",
    "pictures.equilibrium": "draw_equilibrium",
    "pictures.flights": "plot_comparison plot_flight plot_tension_runs",
    "pictures.pose_estimates": "pose_estimates",   # the file itself: lesson 03 names it with its figures
    "pictures.set_charts": "axis_names draw_capability draw_polygon",
    "pictures.tension_panels": "plot_tension_set",
    "props.point_load": "point_load",
    "props.changed_cables": "without_cable",
    "props.pose_search": "six_cables",
    "props.slack": "slack_length",
    "props.submatrices": "submatrix_twist_set",
    "..view.plots": "Figure plot_tensions",
    "..view.style": "BLUE GREEN GREY INK ORANGE PURPLE SKY VERMILION cable_style house_style",
    "..robot.pose": "rotation_from_vector rotation_vector",
    "..world.model": "Task",
    "..sets": "twist_set",
    "..configurations": "hanging_position plan_detour",
    "..configurations.accuracy": "position_sensitivity",
    "..configurations.region": "region",
    "..configurations.sides": "side_range",
    "..configurations.winding": "winding_plan",
    "..run.switching": "follow_sequence taut_cables try_errors",
    "..workspace": "AllOrientations AnyOrientation position_grid refine",
}
"""File, seen from here → the names that lessons take from it."""

_HOMES = {name: file if file.startswith("..") else f".{file}"
          for file, names in _EXPORTS.items() for name in names.split()}

__all__ = sorted(_HOMES)


_look_up = door(__name__, _HOMES)


def __getattr__(name: str) -> Any:
    found = _look_up(name)
    if "matplotlib.figure" in sys.modules:  # in a lesson: what plt.show() shows, screen readers can tell
        figure = sys.modules["matplotlib.figure"].Figure
        if not hasattr(figure, "_repr_mimebundle_"):  # the book has set it to None
            figure._repr_mimebundle_ = figure_bundle
    return found


def __dir__() -> list[str]:
    return __all__
