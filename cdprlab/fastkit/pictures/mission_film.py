"""The film of a mission: from above while the pair drives, from the front while it works, one clock for all."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from PIL import Image, ImageDraw

from ...arrays import Array
from ...view.camera import INK as INK_RGB
from ...view.camera import PLATFORM, Camera
from ...view.film import _ECONOMIES, LARGEST_FILE, _checked_path, _font, _write_gif
from ...view.style import BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION
from ...world import World
from ..job.job_record import Job
from ..mission.mission_record import Mission
from ..mission.scenery import without_hall
from ..navigation.hall import Hall
from ..navigation.journey import Journey
from ..plane import carried, rectangle
from .job_figure import frame_at

_HEAD, _FOOT = 56, 30            # pixels of a picture 640 wide, above and below the plan
_WORDS = {"navigation": "the coupled pair drives to the shelf", "home": "coupled again, the pair drives home",
          "done": "where it began", "return": "the platform returns, the bases fold"}


def save_mission_film(mission: Mission, path: str | Path, seconds: float = 24.0, fps: int = 8, width: int = 640,
                      progress: Any = None) -> Path:
    """An animated GIF of a mission, below ``LARGEST_FILE``, each picture with its state and the mission's clock.

    path : ends in .gif
    seconds : length of the film [s]; fps : pictures per second; width : [pixels]
    progress : called as (pictures drawn, in all)
    """
    target, film = _checked_path(path, ".gif"), MissionFilm(mission, width)
    times, frames = np.linspace(0.0, mission.now, round(seconds * fps)), []
    for t in times.tolist():
        frames.append(film.frame_at(t))
        if progress is not None:
            progress(len(frames), len(times))
    for every, colors in _ECONOMIES:
        _write_gif(frames[::every], target, colors, 1000 / fps * every, _caption(mission))
        if target.stat().st_size < LARGEST_FILE:
            break
    return target


class MissionFilm:
    """Pictures of a mission, at whatever time.

    mission : Mission, with a journey at least; width : [pixels]
    """

    def __init__(self, mission: Mission, width: int = 640) -> None:
        self.mission, self.width, self.scale = mission, width, width / 640
        ends = np.cumsum([part.time[-1] for part in mission.parts.values()])
        self.parts = list(zip(mission.parts.values(), [0.0, *ends[:-1].tolist()], ends.tolist()))
        job = mission.job
        self.job = None if job is None else replace(job, world=without_hall(job.world))
        self.camera = None if self.job is None else Camera(self.job.world)

    def frame_at(self, t: float) -> Image.Image:
        """The picture at a time of the mission [s]."""
        part, begins = next((part, begins) for part, begins, ends in self.parts
                            if t <= ends + 1e-9 or ends == self.parts[-1][2])
        if isinstance(part, Journey):
            frame = self._plan(part, t - begins)
            words = _driving_words(part, _index(part.time, t - begins))
        else:
            assert self.job is not None
            frame = frame_at(self.job, t - begins, self.width, self.camera)
            words = _working_words(self.job, _index(part.time, t - begins))
        self._write_head(frame, t, words)
        return frame

    def _write_head(self, frame: Image.Image, t: float, words: str) -> None:
        drawing, scale = ImageDraw.Draw(frame), self.scale
        drawing.rectangle([0, 0, self.width, _HEAD * scale - 1], fill="white")
        state = [event for event in self.mission.events if event.time <= t + 1e-9][-1]
        title, words = f"mission: {state.state}", words or _WORDS.get(state.state, "")
        if state.why:
            where, _, words = state.why.partition(": ")
            title = f"mission: STOPPED {where}"
        drawing.text((12 * scale, 7 * scale), title, fill=VERMILION, font=_font(19 * scale))
        drawing.text((self.width - 12 * scale, 9 * scale), f"t = {t:5.1f} s", fill=INK_RGB, anchor="ra",
                     font=_font(15 * scale))
        size = next((size for size in (15, 14, 13, 12, 11) if
                     drawing.textlength(words, font=_font(size * scale)) < self.width - 24 * scale), 10)
        drawing.text((12 * scale, 32 * scale), words, fill=INK_RGB, font=_font(size * scale))

    # --- from above -------------------------------------------------------------------------------
    def _plan(self, way: Journey, t: float) -> Image.Image:
        scale, k = self.scale, _index(way.time, t)
        height = 2 * round(185 * scale) + round(112 * scale)              # as the pictures of the work
        frame = Image.new("RGB", (self.width, height), "white")
        pen = _Pen(ImageDraw.Draw(frame), way.hall, self.width, height, scale)
        for outline in way.hall.outlines:
            pen.area(outline, GREY)
        pen.names(self.mission.world)
        plan = next((plan for time, plan in reversed(way.plans) if time <= t + 1e-9 and plan.found), None)
        if plan is not None:
            pen.line(plan.poses[:, :2], ORANGE, 3, dash=0.15)
        pen.line(way.poses[:k + 1, :2], BLUE, 3)
        for base, filled in zip(way.vehicle.base_outlines(way.poses[k]), (True, False)):
            pen.area(base, SKY if filled else "white")
        pen.area(rectangle(way.poses[k], self.mission.world.robot.platform.size[:2]), PLATFORM)
        for x, y, radius in way.people[k].tolist():
            pen.disc((x, y), radius, GREEN)
        for point in carried(way.estimates[k], way.scans[k]):
            pen.dot(point, PURPLE)
        pen.cross(way.goal[:2], VERMILION)
        pen.key((("planned", ORANGE), ("driven", BLUE), ("active base", SKY), ("person", GREEN),
                 ("scanned", PURPLE)))
        return frame


class _Pen:
    """Draws in meters on a picture of the hall."""

    def __init__(self, drawing: Any, hall: Hall, width: int, height: int, scale: float) -> None:
        self.drawing, self.scale, self.width, self.height = drawing, scale, width, height
        low, high = hall.bounds
        room = np.array([width - 24 * scale, height - (_HEAD + _FOOT + 8) * scale])
        self.zoom = float((room / (high - low + 0.3)).min())
        self.corner = np.array([low[0] - 0.15, high[1] + 0.15])
        self.left = (width - self.zoom * (high[0] - low[0] + 0.3)) / 2

    def at(self, points: ArrayLike) -> list[tuple[float, float]]:
        off = (np.asarray(points, dtype=float).reshape(-1, 2) - self.corner) * [1, -1] * self.zoom
        return [(x, y) for x, y in (off + [self.left, _HEAD * self.scale]).tolist()]

    def area(self, outline: Array, color: str | tuple[int, int, int]) -> None:
        self.drawing.polygon(self.at(outline), fill=color, outline=INK_RGB)

    def line(self, points: Array, color: str, thick: float, dash: float = 0.0) -> None:
        if dash and len(points) > 1:
            far = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
            for begin in np.arange(0, far[-1], 2 * dash):
                ends = [[np.interp(s, far, points[:, i]) for i in (0, 1)] for s in (begin, begin + dash)]
                self.line(np.array(ends), color, thick)
        elif len(points) > 1:
            self.drawing.line(self.at(points), fill=color, width=round(thick * self.scale))

    def disc(self, place: tuple[float, float], radius: float, color: str) -> None:
        (x, y), r = self.at([place])[0], radius * self.zoom
        self.drawing.ellipse([x - r, y - r, x + r, y + r], fill=color, outline=INK_RGB)

    def dot(self, place: Array, color: str) -> None:
        (x, y), r = self.at([place])[0], 1.2 * self.scale
        self.drawing.ellipse([x - r, y - r, x + r, y + r], fill=color)

    def cross(self, place: Array, color: str) -> None:
        (x, y), r = self.at([place])[0], 7 * self.scale
        for sign in (1, -1):
            self.drawing.line([(x - r, y - sign * r), (x + r, y + sign * r)], fill=color, width=round(3 * self.scale))

    def names(self, world: World) -> None:
        """Of what stands there, walls left out: what they are is plain."""
        places: dict[str, list[Array]] = {}
        for box in world.scene.boxes:
            if not box.name.endswith("wall"):
                places.setdefault(box.name, []).append(box.position[:2])
        for name, spots in places.items():
            (x, y), = self.at([np.mean(spots, axis=0)])
            self.drawing.text((x, y), name.rstrip(" 0123456789"), fill="white", anchor="mm",
                              font=_font(12 * self.scale))

    def key(self, entries: tuple[tuple[str, str], ...]) -> None:
        font, y, x = _font(14 * self.scale), self.height - 0.5 * _FOOT * self.scale, 14 * self.scale
        for word, color in entries:
            size = 6 * self.scale
            self.drawing.rectangle([x, y - size, x + 2 * size, y + size], fill=color, outline=INK_RGB)
            self.drawing.text((x + 18 * self.scale, y), word, fill=INK_RGB, font=font, anchor="lm")
            x += 42 * self.scale + self.drawing.textlength(word, font=font)


def _index(times: Array, t: float) -> int:
    return min(int(np.searchsorted(times, t - 1e-9)), len(times) - 1)


def _driving_words(way: Journey, k: int) -> str:
    if way.backing[k]:
        return "it backs off, so that the person can walk on"
    standing = k > 0 and np.abs(way.poses[k] - way.poses[k - 1]).max() < 1e-4
    return "it waits for somebody to walk on" if way.waiting[k] and standing else ""


def _working_words(job: Job, k: int) -> str:
    state = job.state_at(k)
    return f"{state}: {job.words[state]}" if job.words.get(state) else ""


def _caption(mission: Mission) -> str:
    return (f"{mission.world.title}: the mission, {mission.state} after {mission.now:.0f} s. From above two coupled "
            "bases drive past pallets and a person to a shelf; from the front they deploy, move a box and fold; then "
            "they drive home.")
