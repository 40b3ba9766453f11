"""The film of a mission: from above while the pair drives, from the front while it works, one clock for all."""

from pathlib import Path
from typing import Any

import numpy as np

from ...arrays import Array, checked
from ...run.loop import counted
from ...view.drawing import HALO
from ...view.film import Frame, index_at, picture_count, save_gif
from ...view.screen import Screen
from ...view.style import INK, PURPLE, house_style
from ...world import World
from ..mission.mission_record import Mission
from ..mission.scenery import without_hall
from ..navigation.journey import Journey
from ..plane import carried
from .hall_figure import draw_hall, draw_way
from .job_figure import JobScreen

_WORDS = {"navigation": "the coupled pair drives to the shelf",
          "home": "coupled again, the pair drives home", "done": "where it began",
          "return": "the platform returns, the bases fold"}


@checked
def save_mission_film(mission: Mission, path: str | Path, seconds: float = 24.0, fps: int = 8,
                      width: int = 640, progress: Any = None) -> Path:
    """An animated GIF of a mission, below 3 MB, each picture with its state and the mission's clock.

    path : ends in .gif
    seconds : length of the film [s]; fps : pictures per second; width : [pixels]
    progress : called as (pictures drawn, in all)
    """
    times = np.linspace(0.0, mission.now, picture_count(seconds, fps) + 1)
    shown = counted(times.tolist(), len(times), progress)
    return save_gif(map(MissionFilm(mission, width).frame_at, shown), path, 1 / fps, (
        f"{mission.world.title}: the mission, {mission.state} after {mission.now:.0f} s. From above two coupled bases "
        "drive past pallets and a person to a shelf; from the front they deploy, move a box and fold; then they drive "
        "home."))


class MissionFilm:
    """Pictures of a mission, at whatever time.

    mission : Mission, with a journey at least; width : [pixels]
    """

    def __init__(self, mission: Mission, width: int = 640) -> None:
        self.mission = mission
        self.screens: list[PlanScreen | JobScreen] = []
        for part in mission.parts.values():
            self.screens.append(PlanScreen(part, mission.world, width)
                                if isinstance(part, Journey) else
                                JobScreen(part, width, without_hall(part.world).scene,
                                          captioned=True))
        self.begins = np.cumsum([0.0, *(part.time[-1] for part in mission.parts.values())])[:-1]

    def frame_at(self, t: float) -> Frame:
        """(height, width, 3) the picture at a time of the mission [s]."""
        which = max(0, int(np.searchsorted(self.begins, t - 1e-9)) - 1)
        screen, event = self.screens[which], [event for event in self.mission.events if event.time <= t + 1e-9][-1]
        words = screen.move(t - self.begins[which]) or _WORDS.get(event.state, "")
        return screen.show(t, f"STOPPED {event.why}"
                           if event.why else f"{event.state}: {words}")


class PlanScreen(Screen):
    """A hall from above with the pair on its way.

    way : the journey; world : its title and the names of what stands there; width : [pixels]
    """

    def __init__(self, way: Journey, world: World, width: int) -> None:
        super().__init__(world.title, width, captioned=True)
        self.way, self.world = way, world
        self.axes = self.figure.add_axes((0.1, 0.17, 0.88, self.top - 0.18))

    def move(self, t: float) -> str:
        """The pair at a time of the journey [s]; returns what it does where that is not just driving."""
        way, axes, k = self.way, self.axes, index_at(self.way.time, t)
        with house_style():
            axes.clear()
            draw_hall(axes, way.hall)
            self._name_things()
            draw_way(axes, way, way.time[k])
            axes.plot(*carried(way.estimates[k], way.scans[k]).T, ".", color=PURPLE,
                      markersize=2.5, zorder=6, label="scanned points")
            self.figure.legends.clear()
            self.figure.legend(loc="lower center", ncols=5, borderaxespad=0.3, fontsize=9,
                               handlelength=1.4, columnspacing=1.0)
        standing = k > 0 and np.abs(way.poses[k] - way.poses[k - 1]).max() < 1e-4
        return "it waits for somebody to walk on" if way.waiting[k] and standing else ""

    def _name_things(self) -> None:
        """What stands there, walls left out: what they are is plain."""
        places: dict[str, list[Array]] = {}
        for box in self.world.scene.boxes:
            if not box.name.endswith("wall"):
                places.setdefault(box.name, []).append(box.position[:2])
        for name, spots in places.items():
            x, y = np.mean(spots, axis=0)
            self.axes.text(x, y, name.rstrip(" 0123456789"), color=INK, ha="center",
                           va="center", fontsize=9, zorder=3, path_effects=HALO)
