"""``python -m cdprlab run WORLD --task mission``: a hall around the shelf, the way there, the work, pictures."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from .mission import DONE, Mission, run_mission
from .mission_drive import in_hall
from .navigation import Walker
from .world import World

BOUNDS = ((-5.0, -6.0), (7.0, 2.0))
PALLETS = ((2.6, -3.0, 0.8, 1.2, 0.3), (-1.5, -2.2, 1.2, 0.8, 0.0))
START = (5.0, -3.5, 1.8)
PEOPLE = (Walker([[2.5, -1.0], [6.0, -1.0]]),)  # type: ignore[arg-type]
"""The hall of the command line; `run_mission` takes any other."""


def fly_mission(world: World, folder: Path, pictures: bool, work: Any = None) -> Mission:
    """Run the mission in the hall above, print what happened, write it to a folder."""
    chosen = {} if work is None else {"work": work}
    mission = run_mission(in_hall(world, BOUNDS, PALLETS), BOUNDS, START, walkers=PEOPLE, **chosen)
    for quantity, value in mission.table().items():
        print(f"  {quantity:36} {value}")
    folder.mkdir(parents=True, exist_ok=True)
    if mission.job is not None:
        mission.job.save(folder)
    if pictures:
        from .view import plot_job, save_figure
        from .view.navigation import plot_journey

        if mission.journey is not None:
            save_figure(plot_journey(mission.journey), folder / "journey.png")
        if mission.job is not None:
            save_figure(plot_job(mission.job), folder / "job.png")
    if mission.state != DONE:
        print(f"  stopped safely: {mission.reason}")
    return mission
