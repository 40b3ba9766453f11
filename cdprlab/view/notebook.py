"""How the library's objects show themselves in a notebook: a small picture and their numbers, as HTML.

The rooms below know nothing of pictures: their classes get `_repr_html_`, which notebooks ask
for, at the end of this file. Words take the notebook's own colors, light or dark; a picture
brings its own ground.
"""

from base64 import b64encode
from collections.abc import Callable, Iterable, Mapping, Sequence
from struct import unpack

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
    numbers = {"source": world.source, "tasks": ", ".join(world.tasks),
               "start": repr(world.pose),
               **_numbers(world.robot)}
    return _card(_name(world), numbers, lambda: _drawn(world.robot, world.pose, world.scene))


def robot_html(robot: Robot) -> str:
    """The robot with its platform in the middle between floor and exit points, and its numbers."""
    exits = robot.exit_points
    low = exits.min(axis=0)
    low[-1] = min(low[-1], 0.0)
    middle = Pose((low + exits.max(axis=0)) / 2)
    return _card(repr(robot), _numbers(robot), lambda: _drawn(robot, middle, None))


def run_html(run: Run) -> str:
    """The run's table, its position errors and its tensions."""
    def picture() -> str:
        from .plots import plot_glance

        figure = plot_glance(run)
        return picture_tag(figure._repr_png_(), figure.alt_text)

    return _card(f"{_name(run.world)}: task {run.task}, {run.method.replace('_', ' ')}",
                 run.table() if len(run.time) else {"steps": "none"}, picture)


def distribution_html(distribution: TensionDistribution) -> str:
    """A row a wrench: tensions, margin, and whether they may be used."""
    rows = np.reshape(distribution.tensions, (-1, distribution.tensions.shape[-1]))
    no = distribution.reason if np.ndim(distribution.feasible) == 0 else "no"   # of many it would take long to say why
    shown = zip(rows[:_ROWS], np.ravel(distribution.margin), np.ravel(distribution.feasible))
    cells = [[str(k), *(f"{tension:.1f}" for tension in row), f"{margin:.4g}",
              "yes" if feasible else no]
             for k, (row, margin, feasible) in enumerate(shown, 1)]
    head = ["wrench", *(f"cable {i + 1} [N]" for i in range(rows.shape[1])), "margin [N]",
            "may be used?"]
    more = f", the first {_ROWS} of {len(rows)} wrenches" if len(rows) > _ROWS else ""
    return _titled(f"Tensions by {distribution.method.replace('_', ' ')}{more}") + _table([head, *cells])


def comparison_html(table: TensionComparison) -> str:
    """The table."""
    return _titled(f"{_name(table.world)}: task {table.task}") + _table(table.lines())


def polytope_html(polytope: Polytope) -> str:
    """What kind of set it is, how large, and how far it reaches along each axis."""
    try:
        size = f"{len(polytope.offsets)} facets, dimension {polytope.dimension}"
    except NotListable as error:
        size = str(error)
    ranges = [[f"x{i}", *(f"{end:.4g}" for end in ends)]
              for i, ends in enumerate(polytope.component_range(), 1)]
    return (_titled(repr(polytope)) + _table([["size", size]], head=False)
            + _table([["component", "smallest", "largest"], *ranges]))


def picture_tag(png: bytes, alt_text: str) -> str:
    """HTML of a picture: ipywidgets' Image knows no alternative text."""
    width, height = unpack(">2I", png[16:24])
    # Decoded before the page is painted again, and its place kept: no flicker while a slider
    # moves.
    return (f'<img decoding="sync" width="{width}" height="{height}" style="max-width: 100%; height: auto" '
            f'alt="{_escaped(alt_text)}" src="data:image/png;base64,{b64encode(png).decode("ascii")}">')


# --- parts --------------------------------------------------------------------------------------------
def _drawn(robot: Robot, pose: Pose, scene: Scene | None) -> str:
    """A picture of the robot at rest."""
    from .film import as_png, draw

    held = distribute_tensions(wrench_matrix(robot, pose), gravity_wrench(robot, pose),
                               robot.tension_min,
                               robot.tension_max)
    tensions = held.tensions if held.feasible else np.zeros(robot.n_cables)
    state = State(0.0, robot, pose.position, pose.rotation, np.zeros(3 * robot.dimension - 3),
                  tensions, scene)
    colors = f"colored by tensions of {tensions.min():.3g} to {tensions.max():.3g} N" if held.feasible else "grey"
    words = f"{robot!r} with its platform at {pose!r}, cables {colors}."
    return picture_tag(as_png(draw(state, 480, 360), words), words)


def _name(world: World) -> str:
    return world.title or world.name


def _numbers(robot: Robot) -> dict[str, str]:
    """Of a robot, for its table."""
    return {
        "motion pattern": f"{robot.motion_pattern}, {robot.n_dof} degrees of freedom, {robot.n_cables} cables",
        "mass": f"{robot.mass:g} kg",
        "tension limits": f"{robot.tension_min.min():g} to {robot.tension_max.max():g} N",
        "mobile bases": ", ".join(base.name for base in robot.bases) or "none",
    }


def _card(title: str, numbers: Mapping[str, str], picture: Callable[[], str]) -> str:
    """Title, picture, or what it takes to have one, and numbers."""
    try:
        with needed_by("the picture"):
            shown = picture()
    except MissingDependency as missing:
        shown = f"<p>{_escaped(str(missing))}</p>"
    return _titled(title) + shown + _table(numbers.items(), head=False)


def _escaped(words: str) -> str:
    import html  # a table of all entities, for who only imports cdprlab

    return html.escape(words)


def _titled(title: str) -> str:
    return f"<p><strong>{_escaped(title)}</strong></p>"


def _table(rows: Iterable[Sequence[str]], head: bool = True) -> str:
    """Rows of words, the first of them a head; what stands in a row's first column names it."""
    lines = []
    for at, row in enumerate(rows):
        kinds = ["th"] * (len(row) if head and not at else 1) + ["td"] * len(row)
        cells = (f'<{kind} style="text-align: left">{_escaped(cell)}</{kind}>'
                 for kind, cell in zip(kinds, row))
        lines.append(f"<tr>{''.join(cells)}</tr>")
    return f"<table>{''.join(lines)}</table>"


for _kind, _html in ((World, world_html), (Robot, robot_html), (Run, run_html),
                     (Polytope, polytope_html),
                     (TensionDistribution, distribution_html),
                     (TensionComparison, comparison_html)):
    _kind._repr_html_ = _html   # type: ignore[union-attr]
