"""Tables and the figure of docs/model_errors.md: robots that are not their model, under velocity and tension control.

Run: python docs/model_errors.py
"""

from __future__ import annotations

import dataclasses
import tempfile
import warnings
from pathlib import Path

import numpy as np
from generated import save_small, write_tables

import cdprlab as cl
from cdprlab.errors import CdprWarning
from cdprlab.view.plots import Figure
from cdprlab.view.style import INK, cable_style, house_style

PAGE = Path(__file__).with_suffix(".md")
DRAWS = 8
STEPS = {"dt": 2e-3, "control_period": 4e-3}     # s, as in FASTKIT's job
CONTROLS = {"velocity": "elastic", "tension": "tension"}
ERRORS = {"none": {}, "exits ±2 mm": {"exit_points": 0.002}, "exits ±5 mm": {"exit_points": 0.005},
          "exits ±10 mm": {"exit_points": 0.01}, "mass ±10 %": {"mass": 0.1}}
NAMES = {"fastkit_suspended": "FASTKIT, suspended", "fastkit_constrained": "FASTKIT, constrained",
         "caroca": "CAROCA", "marionet": "Marionet"}


def world_of(name):
    """The world; CAROCA with ropes of 100 kN, chosen, for it states none."""
    world = cl.load_world(name)
    if world.robot.elasticity is None:
        ropes = cl.load_world("marionet").robot.elasticity
        ropes = dataclasses.replace(ropes, axial_stiffness=1e5)
        world = dataclasses.replace(world, robot=dataclasses.replace(world.robot, elasticity=ropes))
    return world


def flown(folder):
    """(robot, errors, control) → Repetition."""
    return {(name, words, control): cl.repeat(world_of(name), DRAWS if ERRORS[words] else 1, errors=ERRORS[words],
                                              checkpoint=folder, cables=cables, **STEPS)
            for name in NAMES for words in ERRORS for control, cables in CONTROLS.items()}


def flights_table(runs, names):
    """A line for each robot and size of errors."""
    columns = " | ".join(f"{control}: slack | overstretched | tensions | off at the end" for control in CONTROLS)
    lines = [f"| robot | errors | {columns} |", "|---|---|---|---|---|---|---|---|---|---|"]
    for name in names:
        for words in ERRORS:
            cells = []
            for control in CONTROLS:
                found = runs[name, words, control]
                off = 1e3 * np.linalg.norm(found.final_errors[:, :3], axis=1).mean()
                count = len(found.slack)
                cells += [f"{found.slack.sum()} of {count}", f"{found.overstretched.sum()} of {count}",
                          f"{found.smallest_tension:.1f} to {found.largest_tension:.1f} N", f"{off:.2f} mm"]
            lines.append("| " + " | ".join([NAMES[name], words, *cells]) + " |")
    return "\n".join(lines)


def predicted(world, size):
    """(m,) wanted tensions at the start, and the standard deviation that exits off by ± size bring [N].

    The pose gives way to n of the m lengths; what is left of δl stretches the ropes:
    δτ = N (Nᵀ C N)⁻¹ Nᵀ δl with W N = 0 and C = diag(l / EA).
    """
    robot, pose = world.robot, world.tasks["default"].start
    W, w_g = cl.wrench_matrix(robot, pose), cl.gravity_wrench(robot, pose)
    wanted = cl.distribute_tensions(W, w_g, robot.tension_min, robot.tension_max).tensions
    kernel = np.linalg.svd(W)[2][robot.n_dof:].T
    compliance = np.diag(cl.cable_lengths(robot, pose) / robot.elasticity.axial_stiffness)
    stiff = kernel @ np.linalg.solve(kernel.T @ compliance @ kernel, kernel.T)
    return wanted, np.linalg.norm(stiff, axis=1) * size / np.sqrt(3)


def reason_table():
    """What 5 mm are predicted to do at the start of each task."""
    lines = ["| robot | EA | wanted tensions | from ±5 mm, standard deviation |", "|---|---|---|---|"]
    for name, title in NAMES.items():
        world = world_of(name)
        wanted, deviation = predicted(world, 0.005)
        lines.append(f"| {title} | {world.robot.elasticity.axial_stiffness / 1e3:g} kN | {wanted.min():.1f} to "
                     f"{wanted.max():.1f} N | {deviation.min():.0f} to {deviation.max():.0f} N |")
    return "\n".join(lines)


def accuracy_table(folder):
    """CAROCA in tension control: robots that differ, one with noise, and what an observer makes of a wrong mass."""
    world, noise = cl.load_world("caroca"), cl.Sensors(position_noise=1e-3, rotation_noise=1e-3)
    errors = {"exit_points": 0.005, "anchor_points": 0.005, "mass": 0.1}
    heavy = cl.perturbed(world, mass=0.05, seed=0)
    cases = {"four robots, true pose": {"errors": errors},
             "four robots, noise of 1 mm": {"errors": errors, "sensors": noise},
             "one of them, noise of 1 mm": {"real": cl.perturbed(world, **errors, seed=1), "sensors": noise},
             f"mass off by {100 * heavy.errors['mass']:+.1f} %, true pose": {"real": heavy},
             "the same, observer at 3 Hz": {"real": heavy, "sensors": cl.Sensors()},
             "the same, at 30 Hz": {"real": heavy, "sensors": cl.Sensors(observer_frequency=30.0)},
             "the same, at 3 Hz, K_i = 50/s³": {"real": heavy, "sensors": cl.Sensors(),
                                               "controller": cl.ComputedTorque(100, 100, 50)}}
    lines = ["| CAROCA | mean of the final error (x, y, z) | spread |", "|---|---|---|"]
    for words, case in cases.items():
        runs = 1 if "mass" in words or "same" in words else 4
        found = cl.repeat(world, runs, **case, checkpoint=folder, **STEPS)
        mean, spread = (", ".join(f"{1e3 * value:.2f}" for value in values[:3])
                        for values in (found.mean, found.spread))
        lines.append(f"| {words} | {mean} mm | {spread if runs > 1 else '–'} mm |")
    return "\n".join(lines)


def figure_of_one():
    """Tensions of one FASTKIT with exits off by up to 5 mm, under both controls."""
    world = cl.load_world("fastkit_suspended")
    real = cl.perturbed(world, exit_points=0.005, seed=1)
    with house_style():
        figure = Figure(figsize=(9.6, 3.6), layout="constrained")
        words = []
        for panel, (control, cables) in zip(figure.subplots(1, 2, sharey=True), CONTROLS.items()):
            run = cl.run(world, cables=cables, real=real, dt=2e-3, control_period=4e-3)
            for cable, tensions in enumerate(run.measured_tensions.T):
                color, dashes = cable_style(cable)
                panel.plot(run.time, tensions, color=color, linestyle=dashes, label=f"{cable + 1}")
            panel.axhline(0, color=INK, linewidth=1)
            panel.set(xlabel="time [s]", title=f"{control} control")
            words.append(f"{control} control {run.measured_tensions.min():.1f} to {run.measured_tensions.max():.1f} N")
        figure.axes[0].set_ylabel("tension [N]")
        figure.axes[1].legend(title="cable", ncols=2, fontsize=8)
        figure.alt_text = f"Tensions over the default task of one robot: {'; '.join(words)}."
    return figure


def main():
    """Everything anew; finished flights are kept in a folder until the machine is restarted."""
    warnings.simplefilter("ignore", CdprWarning)
    folder = Path(tempfile.gettempdir()) / "cdprlab_model_errors"
    print("flying", flush=True)
    runs = flown(folder)
    write_tables(PAGE, {"fastkit": flights_table(runs, list(NAMES)[:2]), "others": flights_table(runs, list(NAMES)[2:]),
                        "reason": reason_table(), "accuracy": accuracy_table(folder)})
    save_small(figure_of_one(), PAGE.with_suffix("") / "tensions.png")


if __name__ == "__main__":
    main()
