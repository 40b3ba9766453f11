"""A design in numbers and warnings, as text and as HTML."""

import html

import numpy as np

from ...mechanics.cables import cable_lengths
from ...mechanics.statics import wrench_matrix
from ...run.log import text_table
from ...view.style import WARNING
from ...world import World
from ..text_table import fixed
from .assessment import Assessment, Slice, stretch


def report(world: World, found: Assessment) -> str:
    """Cables with lengths and tensions at the start, stiffness, the slice in words.

    >>> import cdprlab as cl
    >>> from cdprlab.course.designer.assessment import assess
    >>> world = cl.load_world("planar_rigid")
    >>> print(report(world, assess(world)).splitlines()[0])
    m = 4, n = 3, r = m − n = 1; rank of W: 3
    """
    robot, held = world.robot, found.tensions
    m, n = robot.n_cables, robot.n_dof
    rank = "" if held is None else f"; rank of W: {np.linalg.matrix_rank(wrench_matrix(robot, world.pose))}"
    tensions = held.tensions if held is not None and held.feasible else np.full(m, np.nan)
    table = [[f"{i + 1}", f"{length:.2f}", "–" if np.isnan(tau) else fixed(tau, 1),
              f"{robot.tension_min[i]:g} to {robot.tension_max[i]:g}"]
             for i, (length, tau) in enumerate(zip(cable_lengths(robot, world.pose), tensions))]
    lines = [f"m = {m}, n = {n}, r = m − n = {m - n}{rank}", "At the start, least-squares tensions:",
             text_table(["cable", "l [m]", "τ [N]", "limits [N]"], table, gap=1),
             *_stiffness(world, found), in_words(found.slice),
             f"Held and clear: {found.slice.clear.sum() * found.slice.grid.cell:.3g} m²."]
    if found.stiffness is not None and not found.slice.held.any():
        step = 1e3 * found.slice.grid.step.max()
        lines += ["The start is held, yet no middle of a cell: what is held around it is",
                  f"smaller than a cell, {step:.0f} mm."]
    return "\n".join(lines)


def _stiffness(world: World, found: Assessment) -> list[str]:
    robot = world.robot
    if found.stiffness is None:
        return ["Stiffness: none, nothing holds the start."]
    return [f"Stiffness, EA = {stretch(robot):g} N{'' if robot.elasticity else ' assumed'}:",
            *(f"  {row.replace('r', 'about '):<9} {value:10.3g} {'N m/rad' if row.startswith('r') else 'N/m'}"
              for row, value in zip(robot.pattern.rows, np.diag(found.stiffness))),
            f"  smallest eigenvalue, arm 1 m: {found.least_stiffness:.3g} N/m"]


def in_words(found: Slice) -> str:
    """How much of the plane is held, in a sentence.

    >>> import cdprlab as cl
    >>> from cdprlab.course.designer.assessment import workspace_slice
    >>> in_words(workspace_slice(cl.load_world("planar_rigid")))
    'Of the plane x–y 75 % are held within the limits.'
    """
    held, clear = 100 * found.held.mean(), 100 * found.clear.mean()
    tangled = f", {clear:.0f} % without interference" if clear < held else ""
    return f"Of the plane {'–'.join(found.grid.axes)} {held:.0f} % are held within the limits{tangled}."


def as_html(text: str) -> str:
    """Text as it stands, in small fixed letters, as widgets.css has it."""
    return f"<pre>{html.escape(text)}</pre>"


def warnings_html(found: Assessment) -> str:
    """A list of warnings, or that there are none; a screen reader says it after each edit."""
    if not found.warnings:
        return '<div role="status">✓ No warnings: the start is feasible, cables keep clear, W has full rank.</div>'
    items = "".join(f"<li>{html.escape(warning)}</li>" for warning in found.warnings)
    return (f'<div role="status" style="background: {WARNING}; padding: 0.3em 0.6em; line-height: 1.35; '
            f'white-space: normal"><b>⚠ Warnings</b><ul style="margin: 0.2em 0 0.2em 1.2em; padding: 0">{items}</ul>'
            "</div>")
