"""FASTKIT's wing: a job of many phases, the mission around it, and driving in a hall.

The library knows nothing of it. Pictures load when first used.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

from .job import Job, Machine, Phase, Sensors, pick_and_place
from .mission import Mission, Trip, in_hall, mission_states, pair_pose, run_mission, walk_through
from .navigation import (
    Hall,
    Journey,
    KinematicPair,
    Localization,
    OccupancyGrid,
    Plan,
    Scanner,
    Vehicle,
    Walker,
    navigate,
    plan_path,
    practice_hall,
)
from .navigation.plan_view import carried
from .navigation.vehicle import difference

_PICTURES = {
    "Camera": "..view.camera",
    "draw_hall": ".pictures.hall_figure",
    "draw_way": ".pictures.hall_figure",
    "plot_journey": ".pictures.hall_figure",
    "frame_at": ".pictures.job_figure",
    "least_edge_loads": ".pictures.job_figure",
    "plot_job": ".pictures.job_figure",
    "save_job_film": ".pictures.job_figure",
}
"""Name → its file; they load matplotlib."""

__all__ = [
    "Hall", "Job", "Journey", "KinematicPair", "Localization", "Machine", "Mission", "OccupancyGrid", "Phase", "Plan",
    "Scanner", "Sensors", "Trip", "Vehicle", "Walker", "carried", "difference", "in_hall", "mission_states", "navigate",
    "pair_pose", "pick_and_place", "plan_path", "practice_hall", "run_mission", "walk_through", *_PICTURES,
]


def __getattr__(name: str) -> Any:
    if name not in _PICTURES:
        raise AttributeError(f"cdprlab.fastkit has no {name!r}; it has {', '.join(sorted(__all__))}")
    return getattr(import_module(_PICTURES[name], __name__), name)
