"""Figures and tables of docs/marionet.md: Marionet-Assist as computed here, beside what its paper prints.

Run: python docs/marionet.py (about two minutes, most of it flights in the engine)
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from generated import write_tables
from joblib import Parallel, delayed

import cdprlab as cl
from cdprlab.configurations import Configuration, plan_configurations
from cdprlab.configurations.accuracy import position_sensitivity
from cdprlab.configurations.region import region
from cdprlab.configurations.sequence import location_score
from cdprlab.configurations.sides import FORMS
from cdprlab.course.pictures.configuration_plan import plot_sequences
from cdprlab.course.props.slack import slack_length
from cdprlab.errors import InvalidInput
from cdprlab.run.switching import try_errors
from cdprlab.view import save_figure
from cdprlab.view.plots import Figure
from cdprlab.view.style import GREY, INK, cable_style, house_style

DOCS = Path(__file__).parent
PICTURES = DOCS / "marionet"
POSITION, EXITS = 0.05, 0.02                            # m, uncertainties of section V
S, G = [0.60, 0.80, 0.80], [1.90, 1.10, 0.50]           # V.A
S_A, G_A = [0.86, 0.66, 1.80], [1.64, 0.84, 1.80]       # VI.A
S_B, G_B = [1.85, 1.40, 1.60], [1.85, 0.70, 1.30]       # VI.B

PRINTED = {
    1: [("S", S, (1, 3, 4), (0.87, 2.65, 1.54), 3), ("M1", [1.14, 0.92, 0.80], (1, 3, 4), (1.32, 2.14, 1.75), 1),
        ("M1", [1.14, 0.92, 0.80], (1, 2, 3), (1.32, 1.83, 2.14), 1), ("G", G, (1, 2, 3), (2.05, 1.32, 1.49), 1)],
    2: [("S", S, (1, 2, 4), None, None), ("M2", [1.51, 1.01, 0.80], (1, 2, 4), None, None),
        ("M2", [1.51, 1.01, 0.80], (2, 3, 4), None, None), ("G", G, (2, 3, 4), None, None)],
    3: [("S", S, (1, 2, 4), (0.87, 2.29, 1.54), 3), ("M3", [1.40, 0.98, 0.80], (1, 2, 4), (1.56, 1.63, 1.91), 0),
        ("M3", [1.40, 0.98, 0.80], (1, 2, 3), (1.56, 1.63, 1.91), 0), ("G", G, (1, 2, 3), (2.05, 1.32, 1.49), 1)],
}
"""Sequence → its steps as printed: name, point [m], cables, plan distances [m] and score of Tables I and II."""

MEASURED = {
    "III": {"S": (0.86, 0.66, 1.80), "M": (1.39, 0.76, 1.75), "G": (1.65, 0.88, 1.76)},
    "IV, with": {"S": (1.85, 1.40, 1.60), "M": (1.87, 0.91, 1.36), "G": (1.88, 0.73, 1.30)},
    "IV, without": {"S": (1.85, 1.40, 1.60), "M": (1.90, 0.93, 1.38), "G": (1.89, 0.78, 1.30)},
}
DIFFERENCES = {
    "III": {"SM": (0.53, 0.10, -0.05), "MG": (0.26, 0.12, 1), "SG": (0.79, 0.22, -0.04)},
    "IV, with": {"SM": (0.02, -0.49, -0.24), "MG": (0.01, -0.18, -0.08), "SG": (0.03, -0.67, -0.32)},
    "IV, without": {"SM": (0.05, -0.47, -0.22), "MG": (-0.01, -0.15, -0.08), "SG": (0.04, -0.62, -0.30)},
}
"""Tables III and IV: measured points, and the differences printed below them [m]."""


def distances(robot, position, cables):
    """Plan distances to the exit points of some cables [m]."""
    return np.linalg.norm(robot.exit_points[np.array(cables) - 1][:, :2] - np.asarray(position)[:2], axis=1)


def scores_table(robot, number, own):
    """Tables I and II, and the second sequence, which has none: printed, at the printed point, at the planner's."""
    rows = ["| point | cables | printed (d_i, d_j, d_k) | printed score | ours, at the printed point | score | "
            "ours, at the planner's point | score |", "|---|---|---|---|---|---|---|---|"]
    totals = {"printed": 0, "there": sum(own.transition_scores), "own": own.score}
    for (name, place, cables, printed, score), (mine, _) in zip(PRINTED[number], own.steps):
        exits = robot.exit_points[np.array(cables) - 1]
        here, there = location_score(exits, np.array(place)), location_score(exits, mine)
        totals["there"] += here
        rows.append(f"| {name} | {Configuration(cables)} | {_triple(printed)} | {'' if score is None else score} | "
                    f"{_triple(distances(robot, place, cables))} | {here} | "
                    f"{_triple(distances(robot, mine, cables))} at ({mine[0]:.3f}, {mine[1]:.3f}, {mine[2]:.3f}) | "
                    f"{there} |")
    change = own.transition_scores[0]
    printed_total = {1: 10, 2: 10, 3: 4}[number]
    rows += [f"| change | | | {'' if number == 2 else change} | | {change} | | {change} |",
             f"| **total** | | | **{printed_total}** | | **{totals['there']}** | | **{totals['own']}** |"]
    return "\n".join(rows)


def forms_table(robot):
    """Where on SG both A124 and A123 are certain, by interval form."""
    shares = np.linspace(0.55, 0.65, 401)
    rows = ["| form of the side | A124 certain up to x | A123 certain from x | both |", "|---|---|---|---|"]
    for form in FORMS:
        grid = shares if form != "contractor" else shares[::8]
        x = S[0] + grid * (G[0] - S[0])
        found = [cl.classify_configurations(robot, np.array(S) + s * np.subtract(G, S), form=form) for s in grid]
        old, new = (x[[c[chosen] == "inside" for c in found]] for chosen in ((1, 2, 4), (1, 2, 3)))
        end, begin = (old.max() if len(old) else np.nan), (new.min() if len(new) else np.nan)
        both = f"{begin:.3f} to {end:.3f} m" if begin <= end else "**nowhere**"
        rows.append(f"| {form} | {_length(end)} | {_length(begin)} | {both} |")
    return "\n".join(rows)


def measured_table():
    """Tables III and IV: differences of the measured points, printed and as they follow from the points."""
    rows = ["| table | way | printed | from the printed points | |", "|---|---|---|---|---|"]
    for table, points in MEASURED.items():
        for way, printed in DIFFERENCES[table].items():
            true = np.subtract(points[way[1]], points[way[0]])
            same = np.abs(true - printed).max() < 0.0051
            rows.append(f"| {table} | {way[0]} → {way[1]} | {_triple(printed)} | {_triple(true)} | "
                        f"{'' if same else '**differs**'} |")
    return "\n".join(rows)


def candidates_table(robot):
    """VI.A: which sequences remain if both uncertainties, one, or none is counted."""
    rows = ["| uncertainties | sequences | M |", "|---|---|---|"]
    cases = {"position ± 5 cm, exits ± 2 cm": (POSITION, EXITS), "position alone": (POSITION, 0.0),
             "exits alone": (0.0, EXITS), "none": (0.0, 0.0)}
    for label, (position, exits) in cases.items():
        for sequence in plan_configurations(robot, S_A, G_A, position_uncertainty=position, exit_uncertainty=exits):
            changes = [_triple(place) for (place, old), (_, new) in zip(sequence.steps, sequence.steps[1:])
                       if new != old]
            rows.append(f"| {label} | {sequence} | {', '.join(changes)} |")
    return "\n".join(rows)


def slack_table(robot):
    """The least slack that leaves one configuration, beside the paper's 0.20 m."""
    places = {"VI.A, S": (S_A, (1, 2, 4)), "VI.A, M": ([1.40, 0.78, 1.80], (1, 2, 4)),
              "VI.A, M ": ([1.40, 0.78, 1.80], (1, 2, 3)), "VI.A, G": (G_A, (1, 2, 3)),
              "VI.B, S": (S_B, (2, 3, 4)), "VI.B, G": (G_B, (1, 2, 3))}
    rows = ["| place | cables | lengths ± 5 mm | lengths ± 10 mm |", "|---|---|---|---|"]
    for name, (place, chosen) in places.items():
        least = []
        for error in (0.005, 0.01):
            try:
                least.append(f"{slack_length(robot, place, chosen, error):.3f} m")
            except InvalidInput:
                least.append("no slack makes it certain")
        rows.append(f"| {name.strip()} | {Configuration(chosen)} | {least[0]} | {least[1]} |")
    return "\n".join(rows)


def _triple(values):
    return "" if values is None else "(" + ", ".join(f"{float(v) + 0.0:.2f}" for v in values) + ")"


def _length(value):
    return "none" if np.isnan(value) else f"{value:.3f} m"


def along(y):
    """Positions on the way of VI.B, x = 1.85 m."""
    y = np.atleast_1d(y)
    return np.column_stack([np.full(len(y), S_B[0]), y, G_B[2] + (S_B[2] - G_B[2]) * (y - G_B[1]) / (S_B[1] - G_B[1])])


def method_two_figure(robot):
    """Scores of A123 and A234 along x = 1.85 m, and their difference, with the certain windows."""
    y = np.linspace(G_B[1], S_B[1], 141)
    lines = {"exactly known": (0.0, 0.0), "position ± 5 cm": (POSITION, 0.0),
             "position ± 5 cm, exits ± 2 cm": (POSITION, EXITS)}
    first, last = both_certain(robot)
    with house_style():
        figure = Figure(figsize=(9.6, 3.9), layout="constrained")
        left, right = figure.subplots(1, 2)
        for k, (label, boxes) in enumerate(lines.items()):
            old, new = (position_sensitivity(robot.exit_points[chosen], along(y), *boxes)
                        for chosen in ([1, 2, 3], [0, 1, 2]))
            left.plot(y, new, color=cable_style(k).color, label=label)
            left.plot(y, old, color=cable_style(k).color, linestyle="--")
            right.plot(y, 100 * (old / new - 1), color=cable_style(k).color, linestyle=("-", "--", ":")[k])
        right.axhline(0, color=INK, linewidth=1)
        for panel in (left, right):
            panel.axvspan(first, last, color=GREY, alpha=0.15)
            panel.axvline(0.88, color=INK, linestyle=":")
            panel.set_xlabel("y [m]")
        right.annotate("printed: 0.88", (0.88, -1.6), (4, 0), textcoords="offset points")
        left.set(ylabel="score [m/m]", title="A123 solid, A234 dashed")
        right.set(ylabel="A234 over A123 [%]", title="Their difference")
        figure.legend(*left.get_legend_handles_labels(), loc="outside lower center", ncols=3)
        figure.alt_text = ("Scores of A123 and A234 along x = 1.85 m for three sizes of boxes: they differ by less "
                           "than two percent and cross at different places or never. Both are certainly inside for y "
                           f"from {first:.3f} to {last:.3f} m; the printed change at 0.88 m is outside that.")
    return figure


def both_certain(robot):
    """Ends of the part of x = 1.85 m where A123 and A234 are both certainly inside [m]."""
    windows = [region(robot.exit_points[chosen], EXITS, POSITION).window(np.array(S_B), np.array(G_B))
               for chosen in ([0, 1, 2], [1, 2, 3])]
    first, last = max(w[0] for w in windows), min(w[1] for w in windows)
    y = S_B[1] + np.array([first, last]) * (G_B[1] - S_B[1])
    return sorted(float(v) for v in y)


def flights(world, jobs=2, each=20):
    """Way and slack → trials of robots with ropes off by ± 1 cm and exit points by ± 2 cm."""
    ways = {name: plan_configurations(world.robot, *ends)[0] for name, ends in (("VI.A", (S_A, G_A)),
                                                                                ("VI.B", (S_B, G_B)))}
    tasks = [(way, slack, seed) for way in ways for slack in (0.2, 0.0) for seed in range(each // 5)]
    fly = delayed(try_errors)
    found = Parallel(n_jobs=jobs)(fly(world, ways[way], 5, slack=slack, speed=0.4, reeling=0.1, seed=seed)
                                  for way, slack, seed in tasks)
    trials = {}
    for (way, slack, _), some in zip(tasks, found):
        trials.setdefault((way, slack), []).extend(some)
    return trials


TRIAL = {"off_path": "largest distance from the plan [m]", "under_constrained": "longest with fewer than 3 taut [s]",
         "unplanned": "longest with others taut [s]"}


def flights_figure(trials):
    """A dot a robot."""
    rng = np.random.default_rng(0)
    with house_style():
        figure = Figure(figsize=(9.6, 3.4), layout="constrained")
        for panel, (field, label) in zip(figure.subplots(1, 3), TRIAL.items()):
            for k, ((_, slack), some) in enumerate(trials.items()):
                values = np.array([getattr(trial, field) for trial in some])
                panel.plot(k + rng.uniform(-0.2, 0.2, len(values)), values, linestyle="none",
                           marker="o" if slack else "x", color=cable_style(0 if slack else 1).color, alpha=0.7)
                panel.hlines(np.median(values), k - 0.35, k + 0.35, color=INK)
            panel.set(ylabel=label, xticks=range(len(trials)), ylim=(0, None),
                      xticklabels=[f"{way}\n{'0.2 m slack' if slack else 'naive'}" for way, slack in trials])
            panel.tick_params(axis="x", labelsize=8)
            panel.grid(visible=False, axis="x")
        figure.alt_text = "Dots, one a robot with errors, bars at the medians; numbers in the table of the page."
    return figure


def flights_table(trials):
    """Median and largest."""
    rows = ["| way | winches | off the plan | fewer than 3 taut | other cables than planned |", "|---|---|---|---|---|"]
    for (way, slack), some in trials.items():
        cells = [f"{100 * np.median(v):.1f} cm, up to {100 * v.max():.1f} cm" if field == "off_path" else
                 f"{np.median(v):.2f} s, up to {v.max():.2f} s" for field in TRIAL
                 for v in [np.array([getattr(trial, field) for trial in some])]]
        rows.append(f"| {way} | {'0.2 m of slack' if slack else 'naive'} | " + " | ".join(cells) + " |")
    return "\n".join(rows)


def main():
    """Everything anew."""
    world = cl.load_world("marionet")
    robot = world.robot
    PICTURES.mkdir(exist_ok=True)
    third, first, second = plan_configurations(robot, S, G)
    own = {1: first, 2: second, 3: third}
    trials = flights(world)
    titles = [f"{n}: {' → '.join(map(str, own[n].configurations))}, total {own[n].score}" for n in own]
    two = [plan_configurations(robot, S_A, G_A)[0], plan_configurations(robot, S_B, G_B, "accuracy")[0]]
    for name, figure in (("sequences", plot_sequences(robot, list(own.values()), titles)),
                         ("experiments", plot_sequences(robot, two, ["VI.A, method 1", "VI.B, method 2"])),
                         ("method_two", method_two_figure(robot)), ("flights", flights_figure(trials))):
        save_figure(figure, PICTURES / f"{name}.png")
        print(figure.alt_text)
    write_tables(DOCS / "marionet.md", {f"sequence {n}": scores_table(robot, n, own[n]) for n in own}
                 | {"forms": forms_table(robot), "measured": measured_table(), "candidates": candidates_table(robot),
                    "slack": slack_table(robot), "flights": flights_table(trials)})


if __name__ == "__main__":
    main()
