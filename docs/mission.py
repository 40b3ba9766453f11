"""Figures and tables of docs/mission.md: FASTKIT's whole mission, its states, and twenty practice halls.

Run: python docs/mission.py
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from generated import save_small, write_tables
from mission_pictures import MissionFilm, plot_drives
from PIL import Image
from PIL.PngImagePlugin import PngInfo
from practice_halls import practice_hall

import cdprlab as cl
from cdprlab.fastkit import (
    KinematicPair,
    Trip,
    Vehicle,
    in_hall,
    mission_states,
    navigate,
    plot_journey,
    run_mission,
)
from cdprlab.fastkit.events import spans
from cdprlab.fastkit.mission.around_the_shelf import BOUNDS, PALLETS, PEOPLE, START

DOCS = Path(__file__).parent
HALLS = range(20)


def states(world):
    """The state machine, one line a state, in the words of the code."""
    trip = Trip(world, world.task("pick_and_place"), np.array(BOUNDS), np.array(START), np.zeros(3), PEOPLE, 271)
    machine = mission_states(trip)
    rows = []
    for state, after in zip(machine, [*(state.name for state in machine[1:]), "done"]):
        guard = getattr(state.guard, "func", state.guard)   # of a partial, which speaks of several states
        words = guard.__doc__.split(f"→ {after}: ")[1].split(" →")[0].strip()
        rows.append(f"| `{state.name}` | {state.what} | {words} |")
    return "\n".join(["| state | what is done | the next may begin |", "|---|---|---|", *rows])


def results(mission):
    """The mission's own table."""
    table = {name: value for name, value in mission.table().items() if name != "real-time factor"}
    return "\n".join(["| | |", "|---|---|", *(f"| {name} | {value} |" for name, value in table.items())])


def halls():
    """Twenty halls driven by kinematics: one line each."""
    pair = Vehicle.of(cl.load_world("fastkit_suspended").robot)
    heads = ("hall", "ends", "time", "way", "plans", "waited", "smallest clearance",
             "localization error at the end")
    lines = [f"| {' | '.join(heads)} |", "|---" * len(heads) + "|"]
    for seed in HALLS:
        place = practice_hall(pair, seed)
        told = place.start + np.random.default_rng(seed).standard_normal(3) * [0.05, 0.05, 0.03]
        bases = KinematicPair(pair, place.hall, place.start, place.walkers, seed=seed)
        way = navigate(bases, place.hall, told, place.goal)
        off, period = way.errors[-1], way.time[1]
        length = np.linalg.norm(np.diff(way.poses[:, :2], axis=0), axis=1).sum()
        cells = (seed, f"{way.state}: {way.reason}" if way.reason else way.state, f"{way.time[-1]:.0f} s",
                 f"{length:.1f} m", len(way.plans),
                 f"{way.waiting.sum() * period:.0f} s",
                 f"{way.clearance.min():.2f} m", f"{1e3 * np.hypot(*off[:2]):.0f} mm, {np.degrees(abs(off[2])):.2f}°")
        lines.append(f"| {' | '.join(map(str, cells))} |")
    return "\n".join(lines)


def strip(mission):
    """Six pictures, each in the middle of its state."""
    film = MissionFilm(mission)
    of = {state: (start, end) for start, end, state in spans(mission.events, mission.now)}
    moments = [0.3 * of["navigation"][1], of["navigation"][1] - 0.1, np.mean(of["deployed"]),
               np.mean(of["pick and place"]), 0.2 * of["return"][0] + 0.8 * of["return"][1], np.mean(of["home"])]
    frames = [np.asarray(film.frame_at(float(t))) for t in moments]
    return Image.fromarray(np.concatenate([np.concatenate(frames[i:i + 2], axis=1) for i in range(0, 6, 2)]))


def main():
    """Everything anew."""
    world = in_hall(cl.load_world("fastkit_suspended"), BOUNDS, PALLETS)
    mission = run_mission(world, BOUNDS, START, walkers=PEOPLE)
    info = PngInfo()
    info.add_itxt("Description", "Six pictures of FASTKIT's mission: driving from above, at the shelf, deploying, "
                                 "carrying the box, folding, driving home.")
    strip(mission).quantize(96).save(DOCS / "mission_frames.png", pnginfo=info, optimize=True)
    save_small(plot_journey(mission.journey), DOCS / "mission_journey.png")
    save_small(plot_drives(mission), DOCS / "mission_drives.png")
    write_tables(DOCS / "mission.md", {"states": states(world), "results": results(mission), "halls": halls()})


if __name__ == "__main__":
    main()
