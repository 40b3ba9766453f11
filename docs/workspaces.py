"""Figures and tables of docs/workspaces.md: workspaces of the robots that come along, as maps, measures and proofs.

Run: python docs/workspaces.py
"""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
from generated import write_tables
from matplotlib.collections import PatchCollection
from matplotlib.patches import Patch, Rectangle
from workspace_pictures import workspace_still

import cdprlab as cl
from cdprlab.view import save_figure
from cdprlab.view.plots import Figure, fitted_title
from cdprlab.view.style import BLUE, GREY, INK, VERMILION, WARNING, house_style
from cdprlab.view.workspace import plot_workspaces
from cdprlab.workspace import AllOrientations, certify, position_grid, refine

DOCS = Path(__file__).parent
FEASIBLE, STATIC = cl.WrenchFeasible(), cl.StaticEquilibrium()
CLEARANCE = 0.02   # m


def with_tension_min(robot, low):
    """All cables with this least tension [N]."""
    return dataclasses.replace(robot, cables=tuple(dataclasses.replace(c, tension_min=low) for c in robot.cables))


def size(robot, grid, criterion, levels):
    """Measure with its error, as text."""
    found = refine(robot, grid, criterion, levels)
    unit = ("m", "m²", "m³")[len(grid.axes) - 1]
    if found.measure == found.error == 0:
        return "none"
    digits = max(0, 1 - int(np.floor(np.log10(max(found.error, 1e-3)))))
    return f"{found.measure:.{digits}f} ± {found.error:.{digits}f} {unit}"


def caroca():
    """Wrench-feasible and static workspace over the middle plane, a tilt, a box of forces; and its volume."""
    world = cl.load_world("caroca")
    robot, grid = world.robot, position_grid([-3.5, 0, 0], [3.5, 0, 3.5], 0.05)
    tilts = [[a, b, 0] for a in (-0.2, 0, 0.2) for b in (-0.2, 0, 0.2)]
    push = cl.WrenchFeasible(half_widths=[300, 300, 300, 0, 0, 0], by="tensions")
    criteria = {"static equilibrium, level": STATIC, "wrench-feasible, level": FEASIBLE,
                "wrench-feasible, tilted by 0.2 rad": AllOrientations(FEASIBLE, tilts),
                "wrench-feasible, pushed by 300 N": push}
    maps = {name: cl.workspace(robot, grid, criterion) for name, criterion in criteria.items()}
    figure = plot_workspaces(robot, grid, maps, title="CAROCA, 150 kg, 50 N to 10 kN, y = 0", unit="N")
    coarse = position_grid([-3.5, 0, 0], [3.5, 0, 3.5], 0.25)
    volume = position_grid([-3.5, -2, 0], [3.5, 2, 3.5], 0.25)
    rows = [f"| {name} | {size(robot, coarse, criterion, 4)} |" for name, criterion in criteria.items()]
    rows += [f"| {name}, volume below the exits | {size(robot, volume, criterion, 1)} |" for name, criterion in
             (("static equilibrium, level", STATIC), ("wrench-feasible, level", FEASIBLE))]
    workspace_still(world, volume, cl.workspace(robot, volume, FEASIBLE), DOCS / "workspaces_caroca_volume.png")
    return figure, "\n".join(["| | size |", "|---|---|", *rows])


def least_tension():
    """Static workspace bought with every newton of τ_min."""
    world = cl.load_world("caroca")
    grid = position_grid([-3.5, 0, 0], [3.5, 0, 3.5], 0.05)
    coarse = position_grid([-3.5, 0, 0], [3.5, 0, 3.5], 0.25)
    maps, rows = {}, ["| τ_min | 150 kg | 75 kg | 15 kg |", "|---|---|---|---|"]
    for low in (0.0, 50.0, 200.0, 400.0):
        cells = []
        for mass in (150.0, 75.0, 15.0):
            body = dataclasses.replace(world.robot.platform, mass=mass)
            robot = with_tension_min(dataclasses.replace(world.robot, platform=body), low)
            cells.append(size(robot, coarse, FEASIBLE, 3))
            if mass == 150.0:
                maps[f"τ_min = {low:g} N"] = cl.workspace(robot, grid, FEASIBLE)
        rows.append(f"| {low:g} N | " + " | ".join(cells) + " |")
    figure = plot_workspaces(world.robot, grid, maps, title="CAROCA: the price of τ_min, y = 0", unit="N")
    return figure, "\n".join(rows)


def interference():
    """IFCOW of a planar robot at three angles."""
    world = cl.load_world("kntu_planar")
    robot = world.robot
    low, high = robot.exit_points.min(axis=0), robot.exit_points.max(axis=0)
    free, maps = cl.InterferenceFree(CLEARANCE), {}
    rows = ["| angle | interference-free | wrench closure | both |", "|---|---|---|---|"]
    for angle in (0.0, 0.5, 0.8, 1.1):
        grid, coarse = (position_grid(low, high, step, angle=angle) for step in (0.02, 0.1))
        maps[f"φ = {angle:g} rad"] = cl.workspace(robot, grid, free)
        rows.append(f"| {angle:g} rad | " + " | ".join(size(robot, coarse, c, 3) for c in (
            free, cl.WrenchClosure(), free & cl.WrenchClosure())) + " |")
    return plot_workspaces(robot, grid, maps, title="KNTU planar robot: interference-free, 20 mm clear", unit="m",
                           quantity="distance less clearance"), "\n".join(rows)


def large_robots():
    """CoGiRo and IPAnema 3, level."""
    figures, rows = {}, ["| robot | criterion | plane | size |", "|---|---|---|---|"]
    for name, plane, criteria in (
            ("cogiro", ([-7.5, 0, 0], [7.5, 0, 5.4]), {"wrench-feasible": FEASIBLE, "static equilibrium": STATIC}),
            ("ipanema3", ([-8.5, 0, -0.5], [8.2, 0, 3.2]),
             {"wrench-feasible": FEASIBLE, "interference-free, 20 mm": cl.InterferenceFree(CLEARANCE)})):
        world = cl.load_world(name)
        grid, coarse = (position_grid(*plane, step) for step in (0.1, 0.4))
        for label, criterion in criteria.items():
            rows.append(f"| {world.title} | {label} | y = 0 | {size(world.robot, coarse, criterion, 3)} |")
        maps = {label: cl.workspace(world.robot, grid, criterion) for label, criterion in criteria.items()}
        for label, found in maps.items():
            figures[name, label] = (world, grid, found, criteria[label].unit)
    return figures, "\n".join(rows)


def stiffness():
    """Smallest eigenvalue with the least tensions and with tensions in the middle of what is feasible."""
    world = cl.load_world("kntu_planar")
    grid = position_grid([-1.1, -1.0], [1.1, 1.0], 0.05)
    maps, rows = {}, ["| EA | tensions | smallest eigenvalue, median | largest |", "|---|---|---|---|"]
    for ea in (1e3, 1e4, 1e6):
        for label, method in (("least", "quadratic_program"), ("barycenter", "barycenter")):
            found = cl.workspace(world.robot, grid, cl.StaticallyStable(method, axial_stiffness=ea))
            known = found.margin[found.inside]
            rows.append(f"| {ea / 1e3:g} kN | {label} | {np.median(known):.4g} N/m | {known.max():.4g} N/m |")
            if ea == 1e3:
                maps[f"{label} tensions"] = found
    return plot_workspaces(world.robot, grid, maps, title="KNTU planar robot: stiffness, EA = 1 kN",
                           unit="N/m", quantity="smallest eigenvalue"), "\n".join(rows)


def plot_proofs(robot, found):
    """Boxes of a plane certainly inside (blue), certainly outside (vermilion, hatched) and undecided (grey)."""
    looks = {"certainly inside": (found.inside, {"facecolor": "#A9CBE3", "edgecolor": BLUE}),
             "certainly outside": (found.outside, {"facecolor": WARNING, "edgecolor": VERMILION, "hatch": "///"}),
             "undecided": (found.undecided, {"facecolor": GREY, "edgecolor": GREY})}
    title, (least, most) = "Proven wrench-feasible, proven not to be, undecided", found.bounds
    with house_style():
        figure = Figure(figsize=(7.6, 7.9), layout="constrained")
        axes = figure.add_subplot(xlabel="x [m]", ylabel="y [m]", aspect="equal")
        for boxes, look in looks.values():
            patches = [Rectangle(low[:2], *(high - low)[:2]) for low, high in boxes]
            axes.add_collection(PatchCollection(patches, linewidth=0.3, **look))
        axes.plot(*robot.exit_points.T, "s", color=INK, markersize=5, clip_on=False)
        axes.margins(0.03)
        axes.grid(False)
        figure.legend(handles=[Patch(label=name, **look) for name, (_, look) in looks.items()],
                      loc="outside lower left", ncols=3)
        fitted_title(figure, title)
        counts = ", ".join(f"{len(boxes)} boxes {name}" for name, (boxes, _) in looks.items())
        figure.alt_text = f"{title}. {counts}; inside measures {least:.4g} to {most:.4g}."
    return figure


def proofs():
    """Certified areas and volumes beside refined ones."""
    rows = ["| robot | boxes inside, outside, undecided | size proven between | refined |", "|---|---|---|---|"]
    cases = {"planar_rigid": ([-2, -2], [2, 2.9], 0.02), "planar_point": ([0.02, 0.3], [1.98, 1.98], 0.01),
             "point_mass": ([-1.9, -1.9, 0.1], [1.9, 1.9, 2.9], 0.15), "caroca": ([-3.5, 0, 0], [3.5, 0, 3.45], 0.02)}
    figure = None
    for name, (low, high, resolution) in cases.items():
        world = cl.load_world(name)
        found = certify(world.robot, low, high, resolution=resolution)
        least, most = found.bounds
        grid = position_grid(low, high, float(np.ptp([low, high], axis=0).max()) / 20)
        unit = ("m²", "m³")[len(grid.axes) - 2]
        counts = ", ".join(str(len(boxes)) for boxes in (found.inside, found.outside, found.undecided))
        rows.append(f"| {world.title} | {counts} | {least:.4g} and {most:.4g} {unit} | "
                    f"{size(world.robot, grid, FEASIBLE, 4 if len(grid.axes) == 2 else 1)} |")
        if name == "planar_rigid":
            figure = plot_proofs(world.robot, certify(world.robot, low, high, resolution=0.05))
    return figure, "\n".join(rows)


def main():
    """Everything anew."""
    tables = {}
    for name, make in (("caroca", caroca), ("least_tension", least_tension), ("interference", interference),
                       ("stiffness", stiffness), ("proofs", proofs)):
        figure, tables[name] = make()
        save_figure(figure, DOCS / f"workspaces_{name}.png")
        print(figure.alt_text)
    figures, tables["large"] = large_robots()
    for (name, label), (world, grid, found, unit) in figures.items():
        if label == "wrench-feasible":
            title = f"{world.title.split(',')[0]}: {label}, y = 0"
            figure = plot_workspaces(world.robot, grid, {"": found}, title=title, unit=unit)
            save_figure(figure, DOCS / f"workspaces_{name}.png")
            print(figure.alt_text)
    write_tables(DOCS / "workspaces.md", tables)
    for table in tables.values():
        print(table)


if __name__ == "__main__":
    main()
