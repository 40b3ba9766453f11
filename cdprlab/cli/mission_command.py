"""``python -m cdprlab run WORLD --task mission``: a hall around the shelf, there, work, back, pictures, a film."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from ..fastkit import DONE, Job, Mission, Walker, in_hall, plot_job, plot_journey, run_mission
from ..world import World

BOUNDS = ((-5.0, -6.0), (7.0, 2.0))
PALLETS = ((2.6, -3.0, 0.8, 1.2, 0.3), (-1.5, -2.2, 1.2, 0.8, 0.0))
START = (5.0, -3.5, 1.8)
PEOPLE = (Walker([[2.5, -1.0], [6.0, -1.0]]),)  # type: ignore[arg-type]
"""The hall of the command line; `run_mission` takes any other."""


def fly_mission(world: World, folder: Path, pictures: bool, work: Any = None) -> Mission:
    """Run the mission in the hall above, print what happened, write it to a folder."""
    bar = _Clock()
    mission = run_mission(in_hall(world, BOUNDS, PALLETS), BOUNDS, START, walkers=PEOPLE, work=work, progress=bar)
    bar.close()
    for quantity, value in mission.table().items():
        print(f"  {quantity:42} {value}")
    folder.mkdir(parents=True, exist_ok=True)
    if isinstance(mission.job, Job):
        mission.job.save(folder)
    if pictures:
        _pictures(mission, folder)
    if mission.state != DONE:
        print(f"  stopped safely: {mission.reason}")
    return mission


def _pictures(mission: Mission, folder: Path) -> None:
    from ..fastkit.pictures.mission_figure import plot_drives, plot_scans
    from ..fastkit.pictures.mission_film import save_mission_film
    from ..view import save_figure

    for name, way in (("journey", mission.journey), ("way_home", mission.way_home)):
        if way is not None:
            save_figure(plot_journey(way), folder / f"{name}.png")
    if mission.journey is not None:
        save_figure(plot_scans(mission.journey), folder / "scans.png")
        save_figure(plot_drives(mission), folder / "drives.png")
        bar = _Clock("drawing", " pictures")
        save_mission_film(mission, folder / "mission.gif", progress=bar.of)
        bar.close()
    if mission.job is not None:
        save_figure(plot_job(mission.job), folder / "job.png")


class _Clock:
    """A progress bar that appears with the first report: of simulated seconds, the state beside them."""

    def __init__(self, name: str = "", unit: str = " s simulated") -> None:
        self.name, self.unit = name, unit
        self.bar: Any = None

    def __call__(self, name: str, time: float, total: int | None = None) -> None:
        if self.bar is None:
            from tqdm import tqdm

            self.bar = tqdm(total=total, unit=self.unit, leave=False)
        if name != self.bar.desc:
            self.bar.set_description_str(name)
        self.bar.update(round(time) - self.bar.n)

    def of(self, done: int, total: int) -> None:
        """The same where it is known how much there is to do."""
        self(self.name, done, total)

    def close(self) -> None:
        if self.bar is not None:
            self.bar.close()
