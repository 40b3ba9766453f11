"""The pictures of docs/mission.md: a mission at whatever time, and what its drives asked of wheels and cables."""

from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.patheffects import withStroke

from cdprlab.arrays import Array
from cdprlab.fastkit import Journey, Mission, carried, draw_hall, draw_way, least_edge_loads
from cdprlab.fastkit.mission.states import LEANS
from cdprlab.fastkit.pictures.job_figure import BASE_STYLES, TIPS, JobScreen
from cdprlab.view.film import Frame, index_at
from cdprlab.view.plots import Figure, draw_lines, mark_level
from cdprlab.view.screen import Screen
from cdprlab.view.style import BLUE, GREEN, GREY, INK, PURPLE, house_style
from cdprlab.world import World
from cdprlab.world.model import Scene

_WORDS = {"navigation": "the coupled pair drives to the shelf",
          "home": "coupled again, the pair drives home", "done": "where it began",
          "return": "the platform returns, the bases fold"}


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
                                JobScreen(part, width, without_hall(part.world.scene),
                                          captioned=True))
        self.begins = np.cumsum([0.0, *(part.time[-1] for part in mission.parts.values())])[:-1]

    def frame_at(self, t: float) -> Frame:
        """(height, width, 3) the picture at a time of the mission [s]."""
        which = max(0, int(np.searchsorted(self.begins, t - 1e-9)) - 1)
        screen, event = self.screens[which], [event for event in self.mission.events if event.time <= t + 1e-9][-1]
        words = screen.move(t - self.begins[which]) or _WORDS.get(event.state, "")
        return screen.show(t, f"STOPPED {event.why}"
                           if event.why else f"{event.state}: {words}")


def without_hall(scene: Scene) -> Scene:
    """The scene without walls and pallets: in pictures they would stand between the eye and the work."""
    boxes = tuple(box for box in scene.boxes if not box.name.endswith(" wall") and not box.name.startswith("pallet "))
    return replace(scene, boxes=boxes)


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
                           va="center", fontsize=9, zorder=3,
                           path_effects=[withStroke(linewidth=3, foreground="white")])


def plot_drives(mission: Mission) -> Figure:
    """Room left, least loaded edge of each base, tilt, and tensions on the way there and on the way home.

    mission : Mission with one of the two at least
    """
    ways = {name: part for name, part in mission.parts.items()
            if isinstance(part, Journey) and part.measured}
    with house_style():
        figure = Figure(figsize=(11.0, 8.0), layout="constrained")
        panels = figure.subplots(4, max(1, len(ways)), sharex="col", sharey="row",
                                 squeeze=False)
        for column, (name, way) in zip(panels.T, ways.items()):
            column[0].set_title(name)
            _draw_drive(column, mission, way)
            column[-1].set_xlabel("time [s]")
        for panel, label in zip(panels[:, 0], ("room left [m]", "least edge\nload [N]",
                                               "tilt [°]", "tension [N]")):
            panel.set_ylabel(label)
        told = "; ".join(f"{name}: at least {way.clearance.min():.2f} m of room, "
                         f"{_edges(way).min():.0f} N on each edge's wheels"
                         for name, way in ways.items())
        figure.alt_text = f"Room, wheel loads, tilt and cable tensions over time on the drives. {told}."
    return figure


def _draw_drive(column: Any, mission: Mission, way: Journey) -> None:
    room, loads, tilts, tensions = column
    drive: Any = way.measured
    room.plot(way.time, way.clearance, color=BLUE)
    room.fill_between(way.time, 0, 1, where=way.waiting, transform=room.get_xaxis_transform(),
                      color=GREEN, alpha=0.2, linewidth=0, label="waits")
    room.set_ylim(bottom=0)
    if way.waiting.any():
        room.legend(loc="lower right", fontsize=9)
    times, robot, leaning = way.time[1:], mission.world.robot, float(np.degrees(LEANS))
    draw_lines(loads, times[_FOUND:], _edges(way), [base.name for base in robot.bases],
               BASE_STYLES)
    mark_level(loads, 0.0, TIPS)
    loads.legend(loc="center right", fontsize=9)
    tilts.plot(times[_FOUND:], np.degrees(drive["tilts"][_FOUND:]), color=BLUE)
    mark_level(tilts, leaning, "more: a base leans")
    tilts.set_ylim(0, 1.3 * leaning)
    tensions.plot(times, drive["tensions"], color=GREY, linewidth=1)
    mark_level(tensions, robot.tension_min.min(), "no cable moves: all at their least")
    tensions.set_ylim(0, 3 * float(robot.tension_min.max()))


_FOUND = 3      # rows in which the wheels find the floor


def _edges(way: Any) -> Array:
    """(N, p) loads of each base's least loaded edge, once the wheels have found the floor [N]."""
    return least_edge_loads(way.measured["wheels"][_FOUND:])
