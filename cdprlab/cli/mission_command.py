"""``python -m cdprlab run WORLD --task mission``: a hall around the shelf, there, work, back, pictures, a film."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from .. import view
from ..fastkit import DONE, Job, Mission, Walker, in_hall, run_mission
from ..world import World
from .output import Bar, print_table, say, write

BOUNDS = ((-5.0, -6.0), (7.0, 2.0))
PALLETS = ((2.6, -3.0, 0.8, 1.2, 0.3), (-1.5, -2.2, 1.2, 0.8, 0.0))
START = (5.0, -3.5, 1.8)
PEOPLE = (Walker([[2.5, -1.0], [6.0, -1.0]]),)  # type: ignore[arg-type]
"""The hall of the command line; `run_mission` takes any other."""


def fly_mission(world: World, folder: Path, pictures: bool, work: Any = None) -> Mission:
    """Run the mission in the hall above, print what happened, write it to a folder."""
    with Bar("mission", "s simulated") as bar:
        mission = run_mission(in_hall(world, BOUNDS, PALLETS), BOUNDS, START, walkers=PEOPLE,
                              work=work,
                              progress=lambda state, time: bar(time, name=state))
    job = mission.job if isinstance(mission.job, Job) else None

    def tell() -> None:
        print_table(mission.table(), width=42)
        if mission.state != DONE:
            say(f"  stopped safely: {mission.reason}")

    write(folder, job.save if job else lambda _: None, tell, _pictures(mission) if pictures else {})
    return mission


def _pictures(mission: Mission) -> dict[str, Callable[[Path], Any]]:
    from ..fastkit import mission_scene, plot_job, plot_journey
    from ..fastkit.pictures.mission_figure import plot_drives
    from ..fastkit.pictures.mission_film import save_mission_film

    def film(path: Path) -> None:
        with Bar("drawing", "pictures") as bar:
            save_mission_film(mission, path, progress=bar)

    there, back, job = mission.journey, mission.way_home, mission.job
    found: dict[str, Callable[[Path], Any]] = {}
    if there is not None:
        found |= {"journey.png": lambda path: view.save_figure(plot_journey(there), path),
                  "drives.png": lambda path: view.save_figure(plot_drives(mission), path),
                  "mission.gif": film}
    if back is not None:
        found["way_home.png"] = lambda path: view.save_figure(plot_journey(back), path)
    if job is not None:
        found["job.png"] = lambda path: view.save_figure(plot_job(job), path)
        found["scene.html"] = lambda path: view.save_scene(mission_scene(mission), path,
                                                           f"{mission.world.title}: the mission")
    return found
