"""Choose a criterion, move its limits: the workspace of a planar robot answers, cell by cell, with its margins."""

import textwrap
from itertools import product
from typing import Any, NamedTuple

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap, Normalize
from matplotlib.figure import Figure

from ...arrays import Array, Flags, checked
from ...errors import InvalidInput
from ...mechanics.statics import gravity_wrench, wrench_matrix
from ...robot import Robot
from ...robot.pose import Pose
from ...view.drawing import RobotDrawing
from ...view.outlines import floor_height
from ...view.style import GREY, INK
from ...workspace.capacity import best_tensions
from ...workspace.criterion import Criterion
from ...workspace.grids import PoseGrid, position_grid
from ...workspace.tensions import DynamicEquilibrium, StaticEquilibrium, WrenchClosure, WrenchFeasible
from ...world import World
from ..props.changed_cables import every_cable
from ..text_table import cable_table, fixed
from .explorer import Choice, Explorer, Slider, Values, once_a_move, rounded_up
from .posing import Posing

CRITERIA = ("wrench_feasible", "wrench_closure", "static_equilibrium", "dynamic_equilibrium")

_CELLS = 30
"""Along the longer side of the map: fine enough to see the border, and judged within a few milliseconds."""

_FOUND = {True: "inside", False: "OUTSIDE"}


class WorkspaceState(NamedTuple):
    """What the controls ask, and the answers.

    robot : with the limits of the sliders
    criterion, words : which is asked, and in a sentence
    inside, margin : (columns, rows) of the cells' centers
    here : (inside, margin) where the platform is
    """

    robot: Robot
    criterion: Criterion
    words: str
    inside: Flags
    margin: Array
    here: tuple[bool, float]

    @property
    def largest(self) -> float:
        """Largest margin of all cells, 0 where none is inside."""
        return float(self.margin[self.inside].max(initial=0.0))


@checked
class WorkspaceExplorer(Explorer):
    """A menu of criteria, sliders for limits, push, acceleration and pose; the map of the workspace answers.

    Every cell of the robot's frame is judged at its center, at the orientation of the angle's
    slider.

    world : planar, with at least two translations
    Raises InvalidInput for any other.

    >>> import cdprlab as cl
    >>> explorer = workspace_explorer(cl.load_world("planar_rigid"))
    >>> explorer.set(tension_min=40)
    >>> bool(explorer.state(explorer.values).inside.any())
    True
    """

    def __init__(self, world: World) -> None:
        robot = world.robot
        if not {"x", "y"} <= set(robot.pattern.rows) or robot.dimension != 2:
            raise InvalidInput(f"a workspace explorer draws robots that move in a plane, such as planar_rigid; world "
                               f"{world.name!r} is {robot.motion_pattern}")
        self.grid = _grid(world)
        half = self.grid.step / 2
        self._corners = self.grid.poses.position[[0, -1]] + np.stack([-half, half])
        self._posing = Posing(world, floor=self._corners[0, 1])
        super().__init__([Choice("criterion", "criterion", CRITERIA), *_limit_sliders(robot),
                          *self._posing.turns,
                          *self._posing.places], f"Workspaces of {world.title}",
                         size=(6.2, 5.2))

    @once_a_move
    def state(self, values: Values) -> WorkspaceState:
        """Every cell judged at some values of the controls."""
        robot = every_cable(self._posing.robot, tension_min=values["tension_min"],
                            tension_max=values["tension_max"])
        (criterion, words), here = _asked(robot, values), self._posing.pose(values)
        places = np.vstack([self.grid.poses.position, here.position])
        inside, margin = criterion.judge(robot, Pose(places, matrix=here.rotation))
        return WorkspaceState(robot, criterion, words, self.grid.field(inside[:-1]), self.grid.field(margin[:-1]),
                              (bool(inside[-1]), float(margin[-1])))

    def tensions(self, values: Values) -> Array | None:
        """(m,) tensions with the largest margin where the platform is, without a push; None where there are none."""
        if values["criterion"] == "static_equilibrium":
            return None
        robot, pose = self.state(values).robot, self._posing.pose(values)
        W, w_e, m = wrench_matrix(robot, pose)[None], gravity_wrench(robot, pose)[None], robot.n_cables
        if values["criterion"] == "wrench_closure":
            s, tau = best_tensions(W, 0 * w_e, np.zeros(m), np.ones(m), at_high=False)
            return np.asarray(tau[0]) if s[0] > 0 else None
        s, tau = best_tensions(W, w_e, robot.tension_min, robot.tension_max)
        return np.asarray(tau[0]) if np.isfinite(s[0]) else None

    # --- picture --------------------------------------------------------------------------------------
    def build(self, figure: Figure) -> None:
        axes = figure.subplots()
        self._drawing = RobotDrawing(axes, self._posing.robot, self._posing.scene, Pose(self._corners))
        self._map = _map(axes, self._corners, 3 * self.grid.step)   # room for the labels of cables
        axes.grid(visible=False)
        bar = figure.colorbar(self._map, ax=axes, shrink=0.75, pad=0.02)
        bar.set_label("margin, as a share of the largest [–]")
        axes.set_title("blue: inside     ×: outside", fontsize=10)

    def draw(self, values: Values) -> None:
        state, grid = self.state(values), self.grid
        share = state.margin / state.largest if state.largest > 0 else np.where(state.inside, 1.0, 0.0)
        self._map.set_data(np.ma.masked_where(~state.inside, share).T)
        axes = self._drawing.axes
        axes.plot(*grid.poses.position[~state.inside.ravel()].T, "x", color=GREY, markersize=3.5,
                  markeredgewidth=0.7,
                  zorder=0.6)
        if state.inside.any() and not state.inside.all():
            self.border = axes.contour(*grid.axes.values(), state.inside.T, [0.5], colors=INK, linewidths=1.8,
                                       zorder=0.7)
        self._drawing.move(self._posing.pose(values))

    # --- text -----------------------------------------------------------------------------------------
    def numbers(self, values: Values) -> str:
        state, tau = self.state(values), self.tensions(values)
        unit = state.criterion.unit
        inside, margin = state.here
        said = [f"inside          {100 * state.inside.mean():.1f} % of {state.inside.size} cells, "
                f"{state.inside.sum() * self.grid.cell:.2f} m²",
                f"largest margin  {_with_unit(state.largest, unit)}",
                f"platform        {_FOUND[inside]}, margin {_with_unit(margin, unit)}"]
        if tau is not None:
            name = "h" if values["criterion"] == "wrench_closure" else "best τ [N]"
            digits = 2 if name == "h" else 1
            said += ["", cable_table({name: [fixed(t, digits) for t in tau]})]
        return "\n".join([*said, "", *textwrap.wrap(self.state(values).words, 56)])

    def idle(self, values: Values) -> dict[str, str]:
        name = values["criterion"]
        asked = {"push": "wrench_feasible", "acceleration": "dynamic_equilibrium"}
        idle = {slider: f"{criterion.replace('_', ' ')} alone asks for it"
                for slider, criterion in asked.items() if name != criterion}
        if name in ("wrench_closure", "static_equilibrium"):
            idle |= dict.fromkeys(("tension_min", "tension_max"), "this criterion has no tension limits")
        return idle

    def describe(self, values: Values) -> str:
        state = self.state(values)
        turned = f", turned by {values['angle']:g}°" if "angle" in values else ""
        return (f"{self.title}: map of {values['criterion'].replace('_', ' ')}{turned}, "
                f"{100 * state.inside.mean():.0f} % of the frame inside. {self.state(values).words} "
                f"The platform at ({values['x']:g}, {values['y']:g}) m is {_FOUND[state.here[0]].lower()}.")


workspace_explorer = WorkspaceExplorer


# --- what is asked ------------------------------------------------------------------------------------------
def _limit_sliders(robot: Robot) -> list[Slider]:
    """The same limits for all cables, in ranges that touch but never cross; a push and an acceleration of both axes."""
    weight = robot.mass * max(robot.gravity, 1.0)
    least, most = robot.tension_min.max(), float(min(robot.tension_max.min(), 30 * weight))
    border = max(rounded_up(0.3 * most, 1), least)
    return [Slider("tension_min", "τ_min", "N", 0.0, border, least, border / 60),
            Slider("tension_max", "τ_max", "N", border, max(5 * border, most), most,
                   border / 30),
            Slider("push", "push up to", "N", 0.0, border, 0.0, border / 60),
            Slider("acceleration", "acceleration up to", "m/s²", 0.0, 10.0, 1.0, 0.1)]


def _asked(robot: Robot, values: Values) -> tuple[Criterion, str]:
    """The criterion, and what it asks in a sentence."""
    name, push, acceleration = values["criterion"], values["push"], values["acceleration"]
    if name == "wrench_closure":
        return WrenchClosure(), ("Pulling cables could hold every push and every turn, if they may pull as hard as "
                                 "needed.")
    if name == "static_equilibrium":
        return StaticEquilibrium(), "Pulling cables hold the weight, however hard they must pull for it."
    limits = f"Tensions from {values['tension_min']:g} to {values['tension_max']:g} N"
    still = [0.0] * (robot.n_dof - 2)
    if name == "dynamic_equilibrium":
        return (DynamicEquilibrium([acceleration, acceleration, *still]),
                f"{limits} give P every acceleration up to {acceleration:g} m/s² in x and in y.")
    if not push:
        return WrenchFeasible(), f"{limits} hold the weight."
    return (WrenchFeasible([[x, y, *still] for x, y in product((push, -push), repeat=2)]),
            f"{limits} hold the weight and every push up to {push:g} N in x and in y.")


# --- the map ------------------------------------------------------------------------------------------------
def _grid(world: World) -> PoseGrid:
    """Over the frame; without one over the exit points and down to the floor."""
    robot, frame = world.robot, world.scene.frame
    low, high = (robot.exit_points.min(axis=0), robot.exit_points.max(axis=0)) if frame is None else frame
    if frame is None:
        low = np.minimum(low, [np.inf, floor_height(robot, world.scene)])
    half = (high - low).max() / _CELLS / 2
    return position_grid(low + half, high - half, 2 * half)


def _map(axes: Axes, corners: Array, room: Array) -> Any:
    # Neither so light that it looks like outside nor so dark that cables vanish on it.
    blues = ListedColormap(matplotlib.colormaps["Blues"](np.linspace(0.18, 0.72, 128))).with_extremes(
        bad=(1.0, 1.0, 1.0, 0.0))
    (left, bottom), (right, top) = corners.tolist()
    image = axes.imshow(np.zeros((1, 1)), origin="lower", extent=(left, right, bottom, top), cmap=blues,
                        norm=Normalize(0, 1), interpolation="nearest", zorder=0.5,
                        animated=True)
    # A floor far below is not shown.
    xlim, ylim = (corners + np.stack([-room, room])).T
    axes.set(xlim=xlim, ylim=ylim)
    return image


def _with_unit(number: float, unit: str) -> str:
    if not np.isfinite(number):
        return "none: nothing balances it"
    return f"{number:.1f} {unit}".replace("-", "−") if unit else f"{number:.2f}"
