"""``python -m cdprlab run WORLD --task mission``: a hall around the shelf, there, work, back, a scene."""

import argparse
from pathlib import Path

from .. import view
from ..fastkit import DONE, Job, in_hall, mission_scene, plot_job, plot_journey, run_mission
from ..fastkit.mission.around_the_shelf import BOUNDS, PALLETS, PEOPLE, START
from ..world import World
from .output import Pictures, figure, print_table, progress_bar, results, say


def fly_mission(options: argparse.Namespace, world: World) -> None:
    """Run the mission in the hall around the shelf, print what happened, write it to a folder."""
    with results(options, world, "mission: to the shelf, pick and place, home again") as write:
        with progress_bar("mission", "s simulated") as bar:
            mission = run_mission(in_hall(world, BOUNDS, PALLETS), BOUNDS, START, walkers=PEOPLE,
                                  progress=lambda state, time: bar(time, name=state))

        def tell(_: Path) -> None:
            print_table(mission.table(), width=42)
            if mission.state != DONE:
                say(f"  stopped safely: {mission.reason}")

        pictures: Pictures = {name: figure(plot_journey, way) for name, way in
                              {"journey.png": mission.journey, "way_home.png": mission.way_home}.items() if way}
        if isinstance(mission.job, Job):
            pictures |= {"job.png": figure(plot_job, mission.job),
                         "scene.html": lambda path: view.save_scene(mission_scene(mission), path,
                                                                    f"{mission.world.title}: the mission")}
        write(mission.save, tell, pictures)
