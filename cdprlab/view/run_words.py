"""What figures of a run show, and what they say in words: titles, differences, spans, summaries."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..arrays import Array


def run_title(run: Any) -> str:
    """Robot, task and method."""
    return f"{run.world.title} · task {run.task} · {method_name(run)}"


def run_subject(run: Any) -> str:
    """The same for a sentence, with cable model and duration [s]."""
    return f"{run.world.title}, task {run.task}, {method_name(run)}, cables as {run.cables}, {run.time[-1]:.3g} s"


def method_name(run: Any) -> str:
    """Of the tension distribution, a student's own function included."""
    name = run.method if isinstance(run.method, str) else getattr(run.method, "__name__", "own method")
    return name.replace("_", " ")


def lengths_commanded(run: Any) -> bool:
    """Whether lengths were commanded, not tensions."""
    return getattr(run, "commanded_lengths", None) is not None


def shown_tensions(run: Any) -> Array:
    """(N, m) commanded, or measured where lengths were commanded [N]."""
    return np.asarray(run.measured_tensions if lengths_commanded(run) else run.commanded_tensions)


def differences(run: Any) -> Array:
    """(N, m) measured − commanded [N]."""
    return np.asarray(run.measured_tensions - run.commanded_tensions)


def position_errors(run: Any) -> Array:
    """(N, d) [m]."""
    return np.asarray(run.errors[:, :run.world.robot.dimension])


def rotation_errors(run: Any) -> Array:
    """(N, 0 to 3) rotation vectors [rad]."""
    return np.asarray(run.errors[:, run.world.robot.dimension:])


def axis_names(run: Any) -> list[str]:
    """Of the position's axes."""
    return list("xyz")[:run.world.robot.dimension]


def turn_names(run: Any) -> list[str]:
    """Of the rotation's axes."""
    count = rotation_errors(run).shape[1]
    return {1: ["φ"], 2: ["about y′", "about z′"]}.get(count, ["about x", "about y", "about z"])


def infeasible_spans(run: Any) -> list[tuple[float, float]]:
    """Times at which no feasible tensions were found [s]; single steps stay visible."""
    bad = np.concatenate([[False], ~np.asarray(run.feasible), [False]])
    edges = np.flatnonzero(bad[1:] != bad[:-1])
    last = len(run.time) - 1
    least = 0.003 * float(run.time[-1])
    return [(float(run.time[first]), max(float(run.time[min(after, last)]), float(run.time[first]) + least))
            for first, after in zip(edges[::2], edges[1::2])]


def tracking_text(run: Any) -> str:
    """Largest errors, in a sentence or two."""
    names = ", ".join(axis_names(run))
    largest = 1e3 * np.linalg.norm(position_errors(run), axis=1)
    text = (f"Reference and actual {names} over time [m]; the position error [mm] is largest, "
            f"{np.nanmax(largest):.3g} mm, at {run.time[int(np.nanargmax(largest))]:.3g} s.")
    rotation = rotation_errors(run)
    if rotation.shape[1]:
        text += f" The largest rotation error is {1e3 * np.nanmax(np.linalg.norm(rotation, axis=1)):.3g} mrad."
    return text


def tension_text(run: Any) -> str:
    """Range, limits and largest difference of the tensions, in a sentence or two."""
    tau, wound = shown_tensions(run), lengths_commanded(run)
    kind = "Measured" if wound else "Commanded"
    text = (f"{kind} tensions of {tau.shape[1]} cables lie between {np.nanmin(tau):.4g} "
            f"and {np.nanmax(tau):.4g} N; limits {np.min(run.world.robot.tension_min):g} to "
            f"{np.max(run.world.robot.tension_max):g} N")
    share = float(np.mean(~np.asarray(run.feasible)))
    if wound:
        return text + "." + (f" A winch was too slow in {100 * share:.3g} % of the steps (shaded)." if share else "")
    text += f"; measured differ from commanded by at most {np.nanmax(np.abs(differences(run))):.3g} N."
    return text + (f" No feasible tensions in {100 * share:.3g} % of the steps (shaded)." if share else "")
