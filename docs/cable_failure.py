"""Figures and tables of docs/cable_failure.md: CAROCA loses cables in flight, and what saves it.

Run: python docs/cable_failure.py
"""

from __future__ import annotations

import dataclasses
import itertools
from pathlib import Path
from typing import NamedTuple

import numpy as np
from generated import save_small, write_tables
from joblib import Parallel, delayed
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.patches import Patch

import cdprlab as cl
from cdprlab.errors import SimulationDiverged
from cdprlab.view.plots import Figure
from cdprlab.view.style import GREY, INK, VERMILION, WARNING, cable_style, house_style

PAGE = Path(__file__).with_suffix(".md")
PICTURES = PAGE.with_suffix("")
CUT, DT = 2.0, 2e-3                         # s
LOST = np.deg2rad(30.0), 0.10               # rad, m: past one of these nobody would call it flying
METHODS = ("linear_program", "quadratic_program", "improved_closed_form", "barycenter", "pseudo_inverse")
GRADES = ("kept", "shaken", "lost")
GRADE_COLORS = ("#EAF3F8", WARNING, VERMILION)


class Flight(NamedTuple):
    """What a run after a cut came to; arrays over the control steps, the rest single numbers."""

    time: np.ndarray
    off: np.ndarray           # position error [m]
    turn: np.ndarray          # rotation error [rad]
    feasible: np.ndarray
    smallest: float           # commanded after the cut, of the whole cables [N]
    largest: float
    jump: float               # largest change of one whole cable's tension at the cut [N]

    @property
    def grade(self) -> str:
        """Kept: never past 10 mm or 5°. Lost: past 0.1 m or 30°, or never back."""
        off, turn = self.off.max(), self.turn.max()
        if turn > LOST[0] or off > LOST[1] or self.off[-1] > 0.01:
            return "lost"
        return "kept" if off < 0.01 and turn < np.deg2rad(5) else "shaken"


def ropes(W, w_e, low, high):
    """The pseudo-inverse on ropes: what it commands below zero is nothing."""
    return np.maximum(cl.distribute_tensions(W, w_e, low, high, "pseudo_inverse").tensions, 0.0)


def lower_limits(world, smallest):
    """The same world with this smallest tension [N]."""
    cables = tuple(dataclasses.replace(cable, tension_min=smallest) for cable in world.robot.cables)
    return dataclasses.replace(world, robot=dataclasses.replace(world.robot, cables=cables))


def fly(cables, method="quadratic_program", smallest=50.0):
    """CAROCA on its default task, these cables (from 0) cut at 2 s."""
    world = lower_limits(cl.load_world("caroca"), smallest)
    duration = 5.0
    while True:
        try:
            blind = method == "pseudo_inverse"   # to the limits: it is sent all the same
            run = cl.run(world, method=ropes if blind else method, dt=DT, duration=duration,
                         infeasible="send" if blind else "relax", cut={CUT: list(cables)} if cables else None)
            break
        except SimulationDiverged as lost:  # what was flown before is what there is to see
            duration = lost.time - 2 * DT
    whole = [i for i in range(8) if i not in cables]
    tau, after = run.commanded_tensions[:, whole], run.time >= CUT
    k = int(after.argmax())
    turn = np.linalg.norm(run.errors[:, 3:], axis=1)
    if duration < 5.0:
        turn[-1] = np.pi
    return Flight(run.time, run.position_errors, turn, run.feasible, float(tau[after].min()),
                  float(tau[after].max()), float(np.abs(tau[k] - tau[k - 1]).max()))


def study():
    """Every flight of the page: (cables, method, τ_min) → Flight."""
    singles = [(i,) for i in range(8)]
    jobs = [(one, "quadratic_program", low) for one in singles for low in (50.0, 0.0)]
    jobs += [(one, "pseudo_inverse", 50.0) for one in singles]
    jobs += [((5,), method, low) for method in METHODS for low in (50.0, 0.0)]
    jobs += [(pair, "quadratic_program", 0.0) for pair in itertools.combinations(range(8), 2)]
    jobs = list(dict.fromkeys(jobs))
    return dict(zip(jobs, Parallel(n_jobs=2)(delayed(fly)(*job) for job in jobs)))


# --- figures ----------------------------------------------------------------------------------------------
def singles_figure(flights):
    """Errors after each single cut: left with the 50 N minimum kept up, right without."""
    with house_style():
        figure = Figure(figsize=(9.6, 5.6), layout="constrained")
        axes = figure.subplots(2, 2, sharex=True, sharey="row")
        for column, (low, title) in enumerate(((50.0, "every cable at least 50 N"), (0.0, "any tension from 0 N"))):
            for i in range(8):
                flight, (color, dashes) = flights[(i,), "quadratic_program", low], cable_style(i)
                seen = flight.time >= CUT - 0.2
                for panel, values in zip(axes[:, column], (1e3 * flight.off, np.rad2deg(flight.turn))):
                    panel.plot(flight.time[seen], np.maximum(values[seen], 1e-2), color=color, linestyle=dashes,
                               label=f"{i + 1}")
            for panel, limit in zip(axes[:, column], (1e3 * LOST[1], np.rad2deg(LOST[0]))):
                panel.axhline(limit, color=INK, linewidth=1, linestyle=(0, (1, 2)))
                panel.set(yscale="log", ylim=(1e-2, 1e3 if panel in axes[0] else 300))
            axes[0, column].set_title(title)
            axes[1, column].set_xlabel("time [s]")
        axes[0, 0].set_ylabel("position error [mm]")
        axes[1, 0].set_ylabel("turned off by [°]")
        axes[0, 0].annotate("lost above", (3.9, 1e3 * LOST[1]), xytext=(0, 3), textcoords="offset points", fontsize=9)
        figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=8,
                      title="cable cut at 2 s", fontsize=9)
        return figure


def pairs_figure(flights):
    """A matrix of all pairs, and the single cuts on its diagonal."""
    grade = np.array([[GRADES.index(flights[tuple(sorted({i, j})), "quadratic_program", 0.0].grade) for j in range(8)]
                      for i in range(8)])
    with house_style():
        figure = Figure(figsize=(5.6, 5.4), layout="constrained")
        panel = figure.subplots()
        panel.imshow(grade, cmap=ListedColormap(GRADE_COLORS), norm=BoundaryNorm(np.arange(4) - 0.5, 3))
        for i, j in np.ndindex(grade.shape):
            panel.text(j, i, "✓~×"[grade[i, j]], ha="center", va="center", fontsize=13,
                       color="white" if grade[i, j] == 2 else INK)
        names = [str(i + 1) for i in range(8)]
        panel.set(xticks=range(8), yticks=range(8), xticklabels=names, yticklabels=names, xlabel="cable cut",
                  ylabel="and cable cut", title="Two cables cut at once, τ from 0 N")
        panel.grid(False)
        panel.legend(handles=[Patch(facecolor=color, edgecolor=GREY, label=f"{mark} {name}")
                              for color, mark, name in zip(GRADE_COLORS, "✓~×", GRADES)],
                     loc="upper center", bbox_to_anchor=(0.5, -0.12), ncols=3)
        return figure


# --- tables -----------------------------------------------------------------------------------------------
def singles_table(flights):
    """One row a cable."""
    rows = ["| cable cut | exit at (x, y) | at least 50 N | from 0 N | pseudo-inverse on ropes |",
            "|---|---|---|---|---|"]
    exits = cl.load_world("caroca").robot.exit_points
    for i in range(8):
        cells = [_words(flights[(i,), method, low]) for method, low in
                 (("quadratic_program", 50.0), ("quadratic_program", 0.0), ("pseudo_inverse", 50.0))]
        rows.append(f"| {i + 1} | ({exits[i, 0]:+.1f}, {exits[i, 1]:+.1f}) m | " + " | ".join(cells) + " |")
    return "\n".join(rows)


def _words(flight):
    after = flight.time >= CUT
    bad = flight.time[after & ~flight.feasible]
    when = "always feasible" if not bad.size else f"infeasible {bad[0]:.2f} to {bad[-1] + DT:.2f} s"
    if bad.size and bad.size * DT < 0.98 * (bad[-1] + DT - bad[0]):
        when += f" with breaks ({bad.size * DT:.2f} s in all)"
    if flight.time[-1] < 4.9:
        return f"**lost**: {when}; thrown out of the scene at {flight.time[-1]:.2f} s"
    return (f"**{flight.grade}**{_when_lost(flight)}: {when}; up to {np.rad2deg(flight.turn.max()):.1f}°, "
            f"{1e3 * flight.off.max():.1f} mm")


def _when_lost(flight):
    past = (flight.turn > LOST[0]) | (flight.off > LOST[1])
    if flight.grade != "lost":
        return ""
    return f" at {flight.time[past.argmax()]:.2f} s" if past.any() else ", never back"


def methods_table(flights):
    """One row a method: cable 6 cut."""
    rows = ["| method | τ_min | infeasible after the cut | tensions after it | jump at the cut | largest turn |",
            "|---|---|---|---|---|---|"]
    for low, method in itertools.product((50.0, 0.0), METHODS):
        flight = flights[(5,), method, low]
        after = flight.time >= CUT
        name = method.replace("_", " ") + (" on ropes" if method == "pseudo_inverse" else "")
        rows.append(f"| {name} | {low:g} N | {100 * np.mean(~flight.feasible[after]):.0f} % | {flight.smallest:.0f} to "
                    f"{flight.largest:.0f} N | {flight.jump:.0f} N | {np.rad2deg(flight.turn.max()):.2f}° |")
    return "\n".join(rows)


def pairs_table(flights):
    """How many pairs end how."""
    pairs = {pair: flights[pair, "quadratic_program", 0.0].grade for pair in itertools.combinations(range(8), 2)}
    rows = ["| outcome | pairs | which |", "|---|---|---|"]
    for grade in GRADES:
        which = [f"{i + 1}+{j + 1}" for (i, j), found in pairs.items() if found == grade]
        rows.append(f"| {grade} | {len(which)} | {', '.join(which) or '–'} |")
    return "\n".join(rows)


def main():
    """Fly, draw, write."""
    flights = study()
    save_small(singles_figure(flights), PICTURES / "singles.png")
    save_small(pairs_figure(flights), PICTURES / "pairs.png")
    for name, table in (("singles", singles_table), ("methods", methods_table), ("pairs", pairs_table)):
        write_tables(PAGE, {name: table(flights)})


if __name__ == "__main__":
    main()
