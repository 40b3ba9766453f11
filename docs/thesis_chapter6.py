"""Figures and tables of docs/thesis_chapter6.md: chapter 6 of Okoli's thesis, flown again.

Run: python docs/thesis_chapter6.py
"""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import NamedTuple

import numpy as np
from generated import save_small, write_tables
from joblib import Parallel, delayed
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from scipy.optimize import linprog

import cdprlab as cl
from cdprlab.errors import SimulationDiverged
from cdprlab.tensions import solver_for
from cdprlab.view.plots import Figure
from cdprlab.view.style import BLUE, GREEN, INK, PURPLE, VERMILION, WARNING, cable_style, house_style

PAGE = Path(__file__).with_suffix(".md")
PICTURES = PAGE.with_suffix("")

# Largest commanded tensions as the thesis' text gives them [N], for K_p = K_d = 100, 800, 1200.
REPORTED = {"linear_program": (54, 456, 1224), "quadratic_program": (32, 110, 342),
            "pseudo_inverse": (117, 117, 117), "closed_form": (267, 385, 517)}
KEEPS_LIMITS = ("linear_program", "quadratic_program")
METHODS = (*REPORTED, "improved_closed_form")
GAINS = (100, 800, 1200)
PERIOD = {100: 1e-2, 800: 2e-3, 1200: 1e-3, 1500: 1e-3}      # s; K_d Δt is 1, 1.6, 1.2 and 1.5
LOOKS = {100: (BLUE, "solid"), 800: (VERMILION, (0, (5, 2))), 1200: (GREEN, (0, (1.5, 1.5))),
         1500: (PURPLE, (0, (6, 2, 1.5, 2)))}
KERNEL_LIMITS = 25.0, 110.0                                  # N, chosen so that both of them bite
SHOWN = 1200                                                 # points a curve


class Flight(NamedTuple):
    """One run: what the tables need, and its course thinned out."""

    time: np.ndarray          # [s]
    off: np.ndarray           # largest position error of each stretch [m]
    low: np.ndarray           # smallest and largest commanded tension of each stretch [N]
    high: np.ndarray
    smallest: float           # [N]
    largest: float
    farthest: float           # [m]
    turned: float             # [rad]
    final: float              # [m]
    feasible: float           # share of the control steps


def as_it_comes(name, ropes=False):
    """The method's own answer, whatever limits it breaks; on ropes, nothing below zero."""
    solvers = {}

    def method(W, w_e, low, high):
        if not solvers:
            solvers[name] = solver_for(name, W.shape[0], low, high)
        tau = solvers[name](W, w_e)[0]
        return np.maximum(tau, 0.0) if ropes else tau

    return method


def fly(task, name, gain, period=None, ropes=False):
    """One run of caroca_light; None where the platform left the scene."""
    period = period or PERIOD[gain]
    method = name if name in KEEPS_LIMITS else as_it_comes(name, ropes)
    try:
        run = cl.run(cl.load_world("caroca_light"), task, method, dt=period, controller=cl.ComputedTorque(gain, gain),
                     infeasible="relax" if name in KEEPS_LIMITS else "send")
    except SimulationDiverged:
        return None
    starts = np.unique(np.linspace(0, run.time.size - 1, SHOWN).astype(int))
    tau, off = run.commanded_tensions, run.position_errors
    return Flight(run.time[starts], np.maximum.reduceat(off, starts), np.minimum.reduceat(tau.min(axis=1), starts),
                  np.maximum.reduceat(tau.max(axis=1), starts), float(tau.min()), float(tau.max()), float(off.max()),
                  float(np.linalg.norm(run.errors[:, 3:], axis=1).max()), float(off[-1]), float(run.feasible.mean()))


def study():
    """Every flight of the page: (task, method, gain, period, ropes) → Flight."""
    chapter = [(name, gain) for gain in (1500, 1200, 800, 100) for name in METHODS
               if gain in GAINS or name == "quadratic_program"]
    jobs = [("thesis", name, gain, None, False) for name, gain in chapter]
    jobs += [("thesis", name, 100, None, True) for name in METHODS if name not in KEEPS_LIMITS]
    jobs += [("default", name, gain, None, False) for name, gain in chapter]
    jobs += [("default", "quadratic_program", gain, 1 / 240, False) for gain in GAINS]
    return dict(zip(jobs, Parallel(n_jobs=2)(delayed(fly)(*job) for job in jobs)))


# --- what limits it: the start of the path ----------------------------------------------------------------
def edge(samples=101):
    """t, y, the largest minimum tension that is feasible anywhere, and the bound by moments about the edge y = −2."""
    world = cl.load_world("caroca_light")
    robot, t = world.robot, np.linspace(0, 100, samples)
    pose = world.task("thesis").trajectory()(t).pose
    W, weight, u = cl.wrench_matrix(robot, pose), -cl.gravity_wrench(robot, pose), cl.cable_directions(robot, pose)
    best = [-linprog(-np.eye(9)[8], A_eq=np.column_stack([w, np.zeros(6)]), b_eq=f, A_ub=np.column_stack(
        [-np.eye(8), np.ones(8)]), b_ub=np.zeros(8), bounds=[(0, 6500)] * 9).fun for w, f in zip(W, weight)]
    far = robot.exit_points[:, 1] > 0
    y = pose.position[:, 1]
    return t, y, np.array(best), robot.mass * robot.gravity * (y + 2) / 4 / u[:, far, 2].sum(axis=1)


def first_feasible(smallest=1.0):
    """When tensions of at least this exist, to 10 ms [s]."""
    world = cl.load_world("caroca_light")
    t = np.arange(0, 100, 0.01)
    pose = world.task("thesis").trajectory()(t).pose
    found = cl.distribute_tensions(cl.wrench_matrix(world.robot, pose), cl.gravity_wrench(world.robot, pose), smallest,
                                   6500, "linear_program").feasible
    return float(t[found][0])


def edge_figure(found, begin):
    """How much minimum tension the path allows."""
    t, _, best, bound = found
    with house_style():
        figure = Figure(figsize=(8.4, 3.4), layout="constrained")
        panel = figure.subplots()
        panel.axvspan(0, begin, color=WARNING, linewidth=0)
        panel.plot(t, bound, color=VERMILION, linewidth=6, alpha=0.4, label="bound by moments about the edge y = −2")
        panel.plot(t, best, color=BLUE, label="largest minimum tension, by LP")
        panel.axhline(1, color=INK, linewidth=1.2, linestyle=(0, (1, 2)))
        panel.annotate("the thesis' minimum, 1 N", (59.5, 1), xytext=(0, 3), textcoords="offset points", ha="right",
                       fontsize=9)
        panel.annotate("infeasible", (1, 2.4), fontsize=10, color=INK)
        panel.set(xlabel="time [s]", ylabel="tension [N]", xlim=(0, 60), ylim=(0, 4.2),
                  title="What the path allows every cable to carry at least")
        panel.legend(loc="upper left")
        return figure


# --- the chapter's plots ----------------------------------------------------------------------------------
def chapter_figure(flights, task, begin):
    """Columns: methods; above the position error, below the range of commanded tensions; one look a gain."""
    with house_style():
        figure = Figure(figsize=(12.6, 5.4), layout="constrained")
        axes = figure.subplots(2, len(METHODS), sharex=True)
        for column, name in enumerate(METHODS):
            error, tension = axes[:, column]
            for gain in (*GAINS, 1500):
                flight = flights.get((task, name, gain, None, False))
                if flight is None:
                    continue
                color, dashes = LOOKS[gain]
                error.plot(flight.time, np.maximum(1e3 * flight.off, 1e-4), color=color, linestyle=dashes)
                for values in (flight.high, flight.low):
                    tension.plot(flight.time, values, color=color, linestyle=dashes, linewidth=1.3)
            error.set(yscale="log", ylim=(1e-3, 3e3))
            error.set_title(name.replace("_", " ").replace("improved ", "improved\n"), fontsize=11)
            tension.set_yscale("symlog", linthresh=1)
            tension.set(ylim=(-2e3, 2e3), xlabel="time [s]")
            tension.axhline(0, color=INK, linewidth=0.8)
            for panel in (error, tension):
                if task == "thesis":
                    panel.axvspan(0, begin, color=WARNING, linewidth=0, zorder=0)
                if column:
                    panel.tick_params(labelleft=False)
        axes[0, 0].set_ylabel("position error [mm]")
        axes[1, 0].set_ylabel("smallest and largest\ncommanded tension [N]")
        handles = [Line2D([], [], color=LOOKS[g][0], linestyle=LOOKS[g][1], label=f"K_p = K_d = {g}") for g in LOOKS]
        if task == "thesis":
            handles.append(Patch(color=WARNING, label="no tensions within 1 to 6500 N exist"))
        figure.legend(handles=handles, loc="outside lower center", ncols=5)
        return figure


# --- the kernel method, where it applies ------------------------------------------------------------------
def printed_kernel(W, w_e, low, high):
    """Equations (6.33) to (6.35) as printed: shifted along the kernel by twice the worst negative ratio."""
    tau = -np.linalg.pinv(W) @ w_e
    h = np.linalg.svd(W)[2][-1]
    h = h * np.sign(h.sum())
    bad = (tau < 0) & (np.abs(h) > 1e-9)
    return tau + (2 * np.max(np.abs(tau[bad]) / h[bad]) * h if bad.any() else 0 * h)


def kernel_flights():
    """Name → Run on planar_rigid (r = 1)."""
    world = cl.load_world("planar_rigid")
    cables = tuple(dataclasses.replace(cable, tension_min=KERNEL_LIMITS[0], tension_max=KERNEL_LIMITS[1])
                   for cable in world.robot.cables)
    world = dataclasses.replace(world, robot=dataclasses.replace(world.robot, cables=cables))

    def chosen(choice):
        return lambda W, w_e, low, high: cl.distribute_tensions(W, w_e, low, high, "kernel", choice=choice)

    methods = {"as printed": printed_kernel, **{choice: chosen(choice) for choice in ("lowest", "middle", "highest")}}
    return {name: cl.run(world, method=method, dt=2e-3, infeasible="send" if name == "as printed" else "relax")
            for name, method in methods.items()}


def kernel_figure(runs):
    """Tensions of every choice."""
    with house_style():
        figure = Figure(figsize=(11.0, 3.0), layout="constrained")
        for panel, (name, run) in zip(figure.subplots(1, len(runs), sharey=True), runs.items()):
            for i in range(4):
                color, dashes = cable_style(i)
                panel.plot(run.time, run.commanded_tensions[:, i], color=color, linestyle=dashes, label=f"{i + 1}")
            for limit in KERNEL_LIMITS:
                panel.axhline(limit, color=INK, linewidth=1.2, linestyle=(0, (1, 2)))
            panel.set(title=name, xlabel="time [s]", ylim=(0, 125))
        figure.axes[0].set_ylabel("commanded tension [N]")
        figure.legend(*figure.axes[0].get_legend_handles_labels(), title="cable", loc="outside right upper", fontsize=9)
        return figure


# --- tables -----------------------------------------------------------------------------------------------
def maxima_table(flights):
    """Largest commanded tensions beside the reported ones."""
    rows = ["| method | K_p = K_d | thesis, reported | its path, re-flown | feasible path, flown |",
            "|---|---|---|---|---|"]
    for name in METHODS:
        for gain in (*GAINS, 1500) if name == "quadratic_program" else GAINS:
            told = REPORTED.get(name, ())
            told = f"{told[GAINS.index(gain)]} N" if told and gain in GAINS else "–"
            cells = [_range(flights[task, name, gain, None, False]) for task in ("thesis", "default")]
            rows.append(f"| {name.replace('_', ' ')} | {gain} | {told} | " + " | ".join(cells) + " |")
    return "\n".join(rows)


def _range(flight):
    return "left the scene" if flight is None else f"**{flight.largest:.1f} N** (least {flight.smallest:.1f} N)"


def errors_table(flights):
    """Tracking, and where limits and wrench are kept."""
    rows = ["| method | K_p = K_d | Δt | its path: largest error | turned off by | feasible steps | "
            "feasible path: largest error | feasible steps |", "|---|---|---|---|---|---|---|---|"]
    for name in METHODS:
        for gain in (*GAINS, 1500) if name == "quadratic_program" else GAINS:
            bad, good = (flights[task, name, gain, None, False] for task in ("thesis", "default"))
            told = "left the scene | – | –" if bad is None else (
                f"{_millimeters(bad.farthest)} | {np.rad2deg(bad.turned):.0f}° | {100 * bad.feasible:.0f} %")
            rows.append(f"| {name.replace('_', ' ')} | {gain} | {1e3 * PERIOD[gain]:g} ms | {told} | "
                        f"{_millimeters(good.farthest)} | {100 * good.feasible:.0f} % |")
    return "\n".join(rows)


def _millimeters(length):
    """Two digits behind the point, four where that would be little."""
    return f"{1e3 * length:.0f} mm" if length > 0.1 else f"{1e3 * length:.{2 if length > 1e-4 else 4}f} mm"


def ropes_table(flights):
    """The methods that command negative tensions, on cables that cannot push."""
    rows = ["| method, K_p = K_d = 100 | joints that push | ropes, which do not |", "|---|---|---|"]
    for name in METHODS:
        if name not in KEEPS_LIMITS:
            cells = ["the platform leaves the scene" if flight is None else
                     f"error at most {1e3 * flight.farthest:.2f} mm, {np.rad2deg(flight.turned):.1f}°"
                     for flight in (flights["thesis", name, 100, None, ropes] for ropes in (False, True))]
            rows.append(f"| {name.replace('_', ' ')} | " + " | ".join(cells) + " |")
    return "\n".join(rows)


def clock_table(flights):
    """The thesis' gains under two clocks."""
    rows = ["| K_p = K_d | Δt | K_d Δt | largest error | largest tension | feasible steps |",
            "|---|---|---|---|---|---|"]
    for gain in GAINS:
        for period in (None, 1 / 240):
            flight, step = flights["default", "quadratic_program", gain, period, False], period or PERIOD[gain]
            told = "left the scene | – | –" if flight is None else (
                f"{1e3 * flight.farthest:.2f} mm | {flight.largest:.1f} N | {100 * flight.feasible:.0f} %")
            rows.append(f"| {gain} | {1e3 * step:.3g} ms | {gain * step:.2f} | {told} |")
    return "\n".join(rows)


def kernel_table(runs):
    """Every choice of λ, and the printed one."""
    rows = ["| λ | tensions | feasible steps | largest error |", "|---|---|---|---|"]
    for name, run in runs.items():
        tau = run.commanded_tensions
        rows.append(f"| {name} | {tau.min():.1f} to {tau.max():.1f} N | {100 * run.feasible.mean():.0f} % | "
                    f"{1e3 * run.position_errors.max():.2f} mm |")
    return "\n".join(rows)


def start_table(found, begin):
    """What the start of the path allows."""
    t, y, best, bound = found
    rows = ["| t | y of P | largest minimum tension | bound by moments |", "|---|---|---|---|"]
    rows += [f"| {t[k]:.0f} s | {y[k]:.3f} m | {abs(best[k]):.3f} N | {bound[k]:.3f} N |"
             for k in (0, 10, 20, 28, 40)]
    return "\n".join(rows) + f"\n\nTensions of at least 1 N exist from t = **{begin:.2f} s** on."


def publish(flights):
    """Draw and write all that the flights came to."""
    found, runs, begin = edge(), kernel_flights(), first_feasible()
    for name, figure in (("start", edge_figure(found, begin)),
                         ("thesis", chapter_figure(flights, "thesis", begin)),
                         ("default", chapter_figure(flights, "default", begin)), ("kernel", kernel_figure(runs))):
        save_small(figure, PICTURES / f"{name}.png")
    write_tables(PAGE, {"maxima": maxima_table(flights), "errors": errors_table(flights), "ropes": ropes_table(flights),
                        "clock": clock_table(flights), "kernel": kernel_table(runs),
                        "start": start_table(found, begin)})


if __name__ == "__main__":
    publish(study())
