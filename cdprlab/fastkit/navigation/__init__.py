"""Navigation of the coupled pair of bases: scanners, localization on a known map, planning, following. No engine."""

from .driving import KinematicPair, Pair, Walker
from .follower import Follower
from .grid import OccupancyGrid
from .halls import Practice, practice_hall
from .journey import ARRIVED, STOPPED, Journey, navigate
from .laser import Scanner, cast
from .localization import Localization, Odometry
from .plan_view import Hall
from .planner import Plan, inflated_width, plan_path
from .vehicle import Vehicle

__all__ = [
    "ARRIVED", "STOPPED", "Follower", "Hall", "Journey", "KinematicPair", "Localization", "OccupancyGrid", "Odometry",
    "Pair", "Plan", "Practice", "Scanner", "Vehicle", "Walker", "cast", "inflated_width", "navigate", "plan_path",
    "practice_hall",
]
