"""Figures and tables of docs/fastkit.md: what the FASTKIT of this project can do, beside what its papers say.

Run: python docs/fastkit.py
"""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import NamedTuple

import numpy as np
from generated import write_tables
from matplotlib.colors import BoundaryNorm, ListedColormap

import cdprlab as cl
from cdprlab.course.pictures.set_charts import axis_label, axis_names, draw_capability, draw_polygon
from cdprlab.view import save_figure
from cdprlab.view.plots import Figure
from cdprlab.view.style import BLUE, INK, WARNING, house_style

DOCS = Path(__file__).parent
TITLES = {"fastkit_suspended": "suspended", "fastkit_constrained": "fully constrained"}
SHELF = cl.Pose([0.8, 0.0, 0.9])
PAYLOAD = 7.0       # kg, published
LENGTH, HEIGHT, STEP = 5.0, 2.0, 0.1    # m, published workspace; grid
UP = np.eye(6)[2]


def with_tensions(robot, low, high):
    """All cables between these tensions [N]."""
    return dataclasses.replace(robot, cables=tuple(dataclasses.replace(c, tension_min=low, tension_max=high)
                                                   for c in robot.cables))


def both_drive(robot):
    """The passive base as fast as the active one, as in Rasheed et al. 2018."""
    speed = robot.base("active").speed_max
    return dataclasses.replace(robot, bases=tuple(dataclasses.replace(b, speed_max=speed) for b in robot.bases))


def largest_payload(robot, pose, tipping):
    """The heaviest point mass at P that is held [kg]."""
    weight = -cl.gravity_wrench(robot, pose)
    return float(cl.available_wrench_set(robot, pose, tipping).scale(weight + robot.gravity * UP, weight))


class PayloadMap(NamedTuple):
    """Over the published workspace, level platform, y = 0; x and z in m, fields (z, x).

    masses : largest payload [kg], nan where not even the empty platform is held
    room : where the platform is clear of posts and floor
    empty, loaded : where the empty platform is held, and the platform with 7 kg
    """

    x: np.ndarray
    z: np.ndarray
    masses: np.ndarray
    room: np.ndarray
    empty: np.ndarray
    loaded: np.ndarray


def payload_map(robot, tipping):
    """What is held where."""
    x = np.arange(-LENGTH / 2, LENGTH / 2 + 1e-9, STEP)
    z = np.arange(0.0, HEIGHT + 1e-9, STEP)
    half, posts = robot.platform.size / 2, np.abs(robot.exit_points[:, 0]).min()
    room = (z > half[2])[:, None] & (np.abs(x) + half[0] < posts)
    masses, empty, loaded = np.full(room.shape, np.nan), np.zeros(room.shape, bool), np.zeros(room.shape, bool)
    for i, j in np.argwhere(room):
        pose = cl.Pose([x[j], 0.0, z[i]])
        weight = -cl.gravity_wrench(robot, pose)
        aws = cl.available_wrench_set(robot, pose, tipping)
        empty[i, j], loaded[i, j] = aws.contains([weight, weight + PAYLOAD * robot.gravity * UP])
        if empty[i, j]:
            masses[i, j] = aws.scale(weight + robot.gravity * UP, weight)
    return PayloadMap(x, z, masses, room, empty, loaded)


def twist_chart(robot):
    """Rows: range and pure; bars: bases fixed, active moving, both moving."""
    sets = {"bases fixed": cl.available_twist_set(robot, SHELF, "none"),
            "active base moves": cl.available_twist_set(robot, SHELF, "active"),
            "both move": cl.available_twist_set(both_drive(robot), SHELF)}
    rows = {"largest component": {label: np.abs(s.component_range()).max(axis=1) for label, s in sets.items()},
            "largest pure twist": {label: np.abs(s.axis_section()).max(axis=1) for label, s in sets.items()}}
    return chart(rows, axis_names("3R3T", "twist"), "FASTKIT's twist at the shelf, cables up to 2 m/s"), rows


def wrench_chart(robot):
    """Rows: 20 N, 45 N, what can be added while 7 kg are held; bars: bases held to the floor, bases that may tip."""
    rows, ways = {}, (("bases held", False), ("no base tips", True))
    for high in (20.0, 45.0):
        limited = with_tensions(robot, 0.0, high)
        rows[f"tensions 0 to {high:g} N"] = {
            label: np.abs(cl.available_wrench_set(limited, SHELF, tipping).component_range()).max(axis=1)
            for label, tipping in ways}
    weight = -cl.gravity_wrench(robot.with_payload(PAYLOAD, [0, 0, 0]), SHELF)
    rows["pure, added to 7 kg, 1 to 45 N"] = {
        label: np.abs(cl.available_wrench_set(robot, SHELF, tipping).axis_section(weight)).max(axis=1)
        for label, tipping in ways}
    return chart(rows, axis_names("3R3T", "wrench"), "FASTKIT's wrench at the shelf, largest per axis"), rows


def chart(rows, names, title):
    """One row of panels an entry, linear axes left, angular right."""
    with house_style():
        figure = Figure(figsize=(9.6, 3.1 * len(rows) + 0.6), layout="constrained")
        for axes, (label, bars) in zip(figure.subplots(len(rows), 2, squeeze=False), rows.items()):
            for panel, group in zip(axes, (range(3), range(3, 6))):
                draw_capability(panel, bars, names, group)
            axes[0].set_title(label)
        figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower left", ncols=3)
        figure.suptitle(title, x=0.01, ha="left", fontsize=12, fontweight="bold")
        figure.alt_text = title + ". " + " ".join(
            f"{row}, {label}: {', '.join(f'{n} {v:.3g}' for n, v in zip(names, values))}."
            for row, bars in rows.items() for label, values in bars.items())
    return figure


def map_figure(maps):
    """Largest payload over the workspace, one panel a world; 7 kg outlined."""
    levels = [0, 1, 2, 3, 5, 7, 9, 11, 13, 15, 17]
    with house_style():
        figure = Figure(figsize=(9.6, 7.4), layout="constrained")
        for axes, (name, found) in zip(figure.subplots(2, 1), maps.items()):
            colors = ListedColormap([f"{g:.3f}" for g in np.linspace(0.45, 0.98, len(levels) - 1)])
            norm = BoundaryNorm(levels, colors.N)
            axes.pcolormesh(found.x, found.z, np.ma.masked_where(~found.room | found.empty, found.room),
                            cmap=ListedColormap([WARNING]), shading="nearest")
            drawn = axes.pcolormesh(found.x, found.z, np.ma.masked_invalid(found.masses), cmap=colors, norm=norm,
                                    shading="nearest")
            axes.contour(found.x, found.z, found.loaded.astype(float), [0.5], colors=BLUE, linewidths=2.5)
            axes.plot(*SHELF.position[[0, 2]], "o", color=INK)
            axes.annotate("shelf", SHELF.position[[0, 2]], (8, 4), textcoords="offset points", color=INK)
            axes.set(title=TITLES[name], xlabel="x [m]", ylabel="z [m]", aspect="equal",
                     xlim=(-LENGTH / 2, LENGTH / 2), ylim=(0, HEIGHT))
            axes.grid(False)
            figure.colorbar(drawn, ax=axes, ticks=levels, label="largest payload [kg]")
        figure.suptitle("Payload within 1 to 45 N, no base tips. Blue outline: 7 kg and more. "
                        "Red: not even the platform", x=0.01, ha="left", fontsize=12, fontweight="bold")
        figure.alt_text = "Maps of the largest payload over 5 m by 2 m. " + " ".join(
            f"{TITLES[name]}: {share(found.empty, found):.0f} % hold the empty platform, "
            f"{share(found.loaded, found):.0f} % hold 7 kg more." for name, found in maps.items())
    return figure


def share(where, found):
    """Of the grid with room for the platform [%]."""
    return 100 * float(where[found.room].mean())


def payload_table(maps, free_maps):
    """Markdown: what is held, and where."""
    rows = ["| | suspended | fully constrained |", "|---|---|---|"]
    worlds = {name: cl.load_world(name).robot for name in TITLES}
    for label, tipping in (("largest payload at the shelf, bases held", False), ("the same, no base tips", True)):
        masses = [f"{largest_payload(robot, SHELF, tipping):.2f} kg" for robot in worlds.values()]
        rows.append(f"| {label} | " + " | ".join(masses) + " |")
    for label, chosen, what in (("workspace that holds the empty platform, bases held", free_maps, "empty"),
                                ("workspace that holds 7 kg, bases held", free_maps, "loaded"),
                                ("workspace that holds 7 kg, no base tips", maps, "loaded")):
        shares = [f"{share(getattr(found, what), found):.0f} %" for found in chosen.values()]
        rows.append(f"| {label} | " + " | ".join(shares) + " |")
    heights = []
    for found in maps.values():
        good = found.z[found.loaded[:, np.abs(found.x).argmin()]]
        heights.append(f"{good.max():.1f} m" if good.size else "nowhere")
    rows.append("| highest P in the middle (x = 0) with 7 kg | " + " | ".join(heights) + " |")
    return "\n".join(rows)


def bars_table(rows, names):
    """Markdown: one line a bar."""
    units = {"v": "m/s", "ω": "rad/s", "f": "N", "m": "N m"}
    lines = ["| | | " + " | ".join(f"{n} [{units[n[0]]}]" for n in names) + " |", "|---|---|" + "---|" * len(names)]
    lines += [f"| {row} | {label} | " + " | ".join(f"{v:.2f}" for v in values) + " |"
              for row, bars in rows.items() for label, values in bars.items()]
    return "\n".join(lines)


def winch_table(winch):
    """Markdown: Table 1 of the paper, worked through."""
    speed = 1600 * 2 * np.pi / 60 / winch.gear_ratio * winch.drum_radius
    torque = 45.0 * winch.drum_radius / winch.gear_ratio / winch.efficiency
    needed = 2.0 / winch.drum_radius * winch.gear_ratio * 60 / (2 * np.pi)
    return "\n".join(["| Table 1 says | it gives | needed |", "|---|---|---|",
                      f"| 0.6 N m, 5:1, 70 %, drum 0.08 m | {winch.torque:g} N m | {torque:.2f} N m for 45 N |",
                      f"| 1600 rpm | {speed:.2f} m/s | {needed:.0f} rpm for 2 m/s |"])


def carry_table(world):
    """Markdown: 7 kg carried over 1.6 m at up to 1 m/s at some heights, flown with the winches in force."""
    lines = ["| height of P | fastest | tensions | motor torque, most | motor speed, most | error, most | "
             "infeasible steps |", "|---|---|---|---|---|---|---|"]
    loaded = world.robot.with_payload(PAYLOAD, [0, 0, 0])
    for height in (0.5, 0.9, 1.2):
        ends = [cl.Pose([x, 0, height]) for x in (-0.8, 0.8)]
        task = cl.Task("quintic", *ends, 1.875 * 1.6, 0.5)     # rest to rest: 1.875 times the mean speed
        run = cl.run(dataclasses.replace(world, robot=loaded, tasks={"default": task}), dt=2e-3,
                     controller=cl.ComputedTorque(900, 60))
        rpm = np.abs(run.motor_speeds).max() * 60 / (2 * np.pi)
        fastest = np.linalg.norm(run.twists[:, :3], axis=1).max()
        lines.append(f"| {height} m | {fastest:.2f} m/s | {run.measured_tensions.min():.1f} to "
                     f"{run.measured_tensions.max():.1f} N | {run.motor_torques.max():.2f} N m | {rpm:.0f} rpm | "
                     f"{run.position_errors.max() * 1e3:.2f} mm | {int((~run.feasible).sum())} |")
    return "\n".join(lines)


def force_figure(robot):
    """Forces at the shelf, with and without tipping, beside the weight of the platform with 7 kg."""
    weight, mark = -cl.gravity_wrench(robot.with_payload(PAYLOAD, [0, 0, 0]), SHELF)[[0, 2]], "platform and 7 kg"
    with house_style():
        figure = Figure(figsize=(6.4, 5.4), layout="constrained")
        axes = figure.add_subplot(title="Forces at the shelf, 1 to 45 N", xlabel=axis_label("f_x"),
                                  ylabel=axis_label("f_z"))
        said = ["Convex sets over f_x, f_z."]
        for style, (label, tipping) in enumerate((("bases held", False), ("no base tips", True))):
            forces = cl.available_wrench_set(robot, SHELF, tipping).project([0, 2])
            draw_polygon(axes, forces.vertices, style, label)
            (left, right), (low, high) = forces.component_range()
            where = "inside" if forces.contains(weight) else "outside"
            said.append(f"{label}: f_x from {left:.3g} to {right:.3g}, f_z from {low:.3g} to {high:.3g}, "
                        f"{mark} {where}.")
        axes.margins(0.08)
        axes.autoscale_view()
        axes.plot(*weight, "o", color=INK, label=mark, scalex=False, scaley=False)  # must not squeeze the sets
        axes.legend(loc="upper right")
        figure.alt_text = " ".join(said)
    return figure


def main():
    """Everything anew."""
    robots = {name: cl.load_world(name).robot for name in TITLES}
    suspended = robots["fastkit_suspended"]
    maps = {name: payload_map(robot, True) for name, robot in robots.items()}
    free_maps = {name: payload_map(robot, False) for name, robot in robots.items()}
    twist_figure, twists = twist_chart(suspended)
    wrench_figure, wrenches = wrench_chart(suspended)
    for name, figure in (("twist", twist_figure), ("wrench", wrench_figure), ("payload", map_figure(maps)),
                         ("forces", force_figure(suspended))):
        save_figure(figure, DOCS / f"fastkit_{name}.png")
        print(figure.alt_text)
    write_tables(DOCS / "fastkit.md", {
        "payload": payload_table(maps, free_maps), "twist": bars_table(twists, axis_names("3R3T", "twist")),
        "wrench": bars_table(wrenches, axis_names("3R3T", "wrench")), "winch": winch_table(suspended.winch),
        "carry": carry_table(cl.load_world("fastkit_suspended"))})


if __name__ == "__main__":
    main()
