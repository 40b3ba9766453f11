"""FASTKIT's wing: a job of many phases, the mission around it, driving in a hall, and their pictures.

The library knows nothing of it. This is its one door; the folders behind it have none of their
own. Drawing libraries load when a picture is first asked for.
"""

from ..arrays import checked
from ..errors import door
from .events import DONE, STOPPED, Event
from .job.job import pick_and_place
from .job.job_record import Job
from .job.machine import Machine, Phase, Readings, least_edge_loads
from .mission.engine_pair import EnginePair, pair_pose
from .mission.mission_record import Mission
from .mission.states import Stage, mission_states, run_mission, walk_through
from .mission.trip import Trip
from .navigation.driving import KinematicPair, Walker
from .navigation.follower import Follower
from .navigation.hall import Hall, in_hall
from .navigation.journey import ARRIVED, Journey, navigate
from .navigation.laser import Scanner, cast
from .navigation.localization import Localization, Odometry
from .navigation.occupancy import OccupancyGrid
from .navigation.planner import Plan, inflated_width, plan_path
from .navigation.vehicle import Vehicle
from .plane import carried as _carried, difference as _difference

carried = checked(_carried)   # here, for inside all goes through them
difference = checked(_difference)

_PICTURES = {"draw_hall": ".pictures.hall_figure", "draw_way": ".pictures.hall_figure",
             "plot_journey": ".pictures.hall_figure", "frame_at": ".pictures.job_figure",
             "plot_job": ".pictures.job_figure", "save_job_film": ".pictures.job_figure",
             "mission_scene": ".pictures.mission_scene"}
"""Name → its file."""

__getattr__ = door(__name__, _PICTURES)

__all__ = [
    "ARRIVED",
    "DONE",
    "STOPPED",
    "EnginePair",
    "Event",
    "Follower",
    "Hall",
    "Job",
    "Journey",
    "KinematicPair",
    "Localization",
    "Machine",
    "Mission",
    "OccupancyGrid",
    "Odometry",
    "Phase",
    "Plan",
    "Scanner",
    "Readings",
    "Stage",
    "Trip",
    "Vehicle",
    "Walker",
    "carried",
    "cast",
    "difference",
    "in_hall",
    "inflated_width",
    "least_edge_loads",
    "mission_states",
    "navigate",
    "pair_pose",
    "pick_and_place",
    "plan_path",
    "run_mission",
    "walk_through",
    *_PICTURES,
]
