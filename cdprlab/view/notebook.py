"""How the library's objects show themselves in a notebook: a small picture and their numbers, as HTML.

The rooms below know nothing of pictures: their classes get `_repr_html_`, which notebooks ask
for, at the end of this file. Words take the notebook's own colors, light or dark; a picture
brings its own ground.
"""

import html
from base64 import b64encode
from collections.abc import Callable, Iterable, Mapping, Sequence
from io import BytesIO
from typing import Any

import numpy as np

from ..errors import MissingDependency, NotListable, needed_by
from ..mechanics.statics import gravity_wrench, wrench_matrix
from ..robot import Robot
from ..robot.pose import Pose
from ..run import Run
from ..run.compare import TensionComparison
from ..sets import Polytope
from ..simulate.state import State
from ..tensions import TensionDistribution, distribute_tensions
from ..world import Scene, World

_ROWS = 10
"""Of a batch that are shown."""


def world_html(world: World) -> str:
    """The robot where it starts, cables colored by the tensions that hold it there, and the world's numbers."""
    numbers = {"source": world.source, "tasks": ", ".join(world.tasks), "start": repr(world.pose),
               **_numbers(world.robot)}
    return _card(world.title or world.name, _drawn(world.robot, world.pose, world.scene), numbers)


def robot_html(robot: Robot) -> str:
    """The robot with its platform in the middle between floor and exit points, and its numbers."""
    exits = robot.exit_points
    floor = np.minimum(exits.min(axis=0), [*[np.inf] * (robot.dimension - 1), 0.0])
    middle = Pose((floor + exits.max(axis=0)) / 2)
    return _card(repr(robot), _drawn(robot, middle, None), _numbers(robot))


def run_html(run: Run) -> str:
    """The run's table, its position errors and its tensions."""
    def picture() -> str:
        from .plots import plot_glance

        figure = plot_glance(run)
        return picture_tag(figure._repr_png_(), figure.alt_text)

    title = f"{run.world.title or run.world.name}: task {run.task}, {run.method.replace('_', ' ')}"
    return _card(title, _if_installed(picture), run.table() if len(run.time) else {"steps": "none"})


def distribution_html(distribution: TensionDistribution) -> str:
    """A row a wrench: tensions, margin, and whether they may be used."""
    rows = np.reshape(distribution.tensions, (-1, distribution.tensions.shape[-1]))
    no = distribution.reason if np.ndim(distribution.feasible) == 0 else "no"   # of many it would take long to say why
    cells = [[str(k + 1), *(f"{tension:.1f}" for tension in row), f"{margin:.4g}", "yes" if feasible else no]
             for k, (row, margin, feasible) in enumerate(zip(
                 rows[:_ROWS], np.ravel(distribution.margin), np.ravel(distribution.feasible)))]
    head = ["wrench", *(f"cable {i + 1} [N]" for i in range(rows.shape[1])), "margin [N]", "may be used?"]
    more = f", the first {_ROWS} of {len(rows)} wrenches" if len(rows) > _ROWS else ""
    return _titled(f"Tensions by {distribution.method.replace('_', ' ')}{more}") + _table([head, *cells])


def comparison_html(table: TensionComparison) -> str:
    """The table."""
    return _titled(f"{table.world.title or table.world.name}: task {table.task}") + _table(table.lines())


def polytope_html(polytope: Polytope) -> str:
    """What kind of set it is, how large, and how far it reaches along each axis."""
    try:
        size = f"{len(polytope.offsets)} facets, dimension {polytope.dimension}"
    except NotListable as error:
        size = str(error)
    ranges = [[f"x{i + 1}", *(f"{end:.4g}" for end in ends)]
              for i, ends in enumerate(polytope.component_range())]
    return (_titled(repr(polytope)) + _table([["size", size]], head=False)
            + _table([["component", "smallest", "largest"], *ranges]))


def picture_tag(png: bytes, alt_text: str) -> str:
    """HTML of a picture: ipywidgets' Image knows no alternative text."""
    width, height = (int.from_bytes(png[at:at + 4], "big") for at in (16, 20))
    # Decoded before the page is painted again, and its place kept: no flicker while a slider
    # moves.
    return (f'<img decoding="sync" width="{width}" height="{height}" style="max-width: 100%; height: auto" '
            f'alt="{html.escape(alt_text)}" src="data:image/png;base64,{b64encode(png).decode("ascii")}">')


# --- parts --------------------------------------------------------------------------------------------
def _drawn(robot: Robot, pose: Pose, scene: Scene | None) -> str:
    """A picture of the robot at rest."""
    held = distribute_tensions(wrench_matrix(robot, pose), gravity_wrench(robot, pose), robot.tension_min,
                               robot.tension_max)
    tensions = held.tensions if held.feasible else np.zeros(robot.n_cables)
    state = State(0.0, robot, pose.position, pose.rotation, np.zeros(3 * robot.dimension - 3), tensions, scene)

    def picture() -> str:
        from PIL import Image

        from .film import draw

        buffer = BytesIO()
        Image.fromarray(draw(state, 480, 360)).save(buffer, "png")
        colors = f"colored by tensions of {tensions.min():.3g} to {tensions.max():.3g} N" if held.feasible else "grey"
        return picture_tag(buffer.getvalue(), f"{robot!r} with its platform at {pose!r}, cables {colors}.")

    return _if_installed(picture)


def _if_installed(picture: Callable[[], str]) -> str:
    """The picture, or what it takes to have one."""
    try:
        with needed_by("the picture"):
            return picture()
    except MissingDependency as missing:
        return f"<p>{html.escape(str(missing))}</p>"


def _numbers(robot: Robot) -> dict[str, str]:
    """Of a robot, for its table."""
    return {
        "motion pattern": f"{robot.motion_pattern}, {robot.n_dof} degrees of freedom, {robot.n_cables} cables",
        "mass": f"{robot.mass:g} kg",
        "tension limits": f"{robot.tension_min.min():g} to {robot.tension_max.max():g} N",
        "mobile bases": ", ".join(base.name for base in robot.bases) or "none",
    }


def _card(title: str, picture: str, numbers: Mapping[str, str]) -> str:
    return _titled(title) + picture + _table([[name, value] for name, value in numbers.items()], head=False)


def _titled(title: str) -> str:
    return f"<p><strong>{html.escape(title)}</strong></p>"


def _table(rows: Iterable[Sequence[str]], head: bool = True) -> str:
    """Rows of words, the first of them a head; what stands in a row's first column names it."""
    lines = []
    for at, row in enumerate(rows):
        kinds = ["th"] * len(row) if head and not at else ["th", *["td"] * (len(row) - 1)]
        cells = (f'<{kind} style="text-align: left">{html.escape(cell)}</{kind}>'
                 for kind, cell in zip(kinds, row))
        lines.append(f"<tr>{''.join(cells)}</tr>")
    return f"<table>{''.join(lines)}</table>"


_SHOWN: dict[type, Callable[[Any], str]] = {
    World: world_html, Robot: robot_html, Run: run_html, TensionDistribution: distribution_html,
    TensionComparison: comparison_html, Polytope: polytope_html}

for _kind, _html in _SHOWN.items():
    _kind._repr_html_ = _html   # type: ignore[attr-defined]
