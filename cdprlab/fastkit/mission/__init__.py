"""FASTKIT's mission: coupled to the shelf, deployed, a box picked and placed, folded, coupled home."""

from .engine_pair import Drive, EnginePair, in_hall, moved_pair, pair_pose, without_hall
from .guards import LEANS, at_home, at_the_shelf, base_in_place, box_in_place, coupled_again, stands_still
from .mission_record import DONE, STOPPED, Event, Mission
from .states import State, mission_states, run_mission, walk_through
from .trip import Trip

__all__ = [
    "DONE", "LEANS", "STOPPED", "Drive", "EnginePair", "Event", "Mission", "State", "Trip", "at_home", "at_the_shelf",
    "base_in_place", "box_in_place", "coupled_again", "in_hall", "mission_states", "moved_pair", "pair_pose",
    "run_mission", "stands_still", "walk_through", "without_hall",
]
