"""Turn tension limits and base masses: what can the cables exert, and what of it would tip a base over?"""

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure

from ...arrays import Array, checked
from ...mechanics.statics import gravity_wrench, tipping_rows, wrench_matrix
from ...robot import Base, Robot
from ...robot.pose import Pose
from ...run.log import text_table
from ...sets import Polytope, available_wrench_set
from ...view.style import GREEN, INK, VERMILION
from ...world import World
from ..props.changed_cables import every_cable
from ..text_table import fixed
from .explorer import Slider, Values, movable, once_a_move
from .plane_sets import PlaneSetExplorer, check_set_world

_LABELS = ("limits only", "no base tips")

_CUT = 1e-6
"""A facet lies inside the zonotope by more than this share of its size: tipping made it."""


class Edge(NamedTuple):
    """A footprint edge, in the plane a wheel.

    name : of its base and its number there
    place : (d,) a wheel, in space the middle between two [m]
    moment : largest about it that the limits allow; above 0 the cables could tip the base over
        it [N m]
    share : of the zonotope's area that keeping this edge down takes away, all others let alone
    """

    name: str
    place: Array
    moment: float
    share: float


class Capability(NamedTuple):
    """What the cables can exert at the controls' values, in the two shown components.

    robot, pose : with the controls' limits and masses
    hold : (2,) −w_g, what the cables exert to hold the platform [N]
    limits, standing : Polytopes of forces, within the tension limits and with no base tipping
        besides
    added : (2, 2, 2) of either, the ends of what can be added to ``hold`` along an axis; nan
        where it cannot be held [N]
    edges : of all footprints
    facets : (k, 2, 2) ends of the standing set's facets that tipping made [N]
    """

    robot: Robot
    pose: Pose
    hold: Array
    limits: Polytope
    standing: Polytope
    added: Array
    edges: tuple[Edge, ...]
    facets: Array

    @property
    def payloads(self) -> Array:
        """(2,) the most that can hang at P besides the platform [kg]; nan where the platform itself cannot be held."""
        return np.asarray(self.added[:, 1, 1] / self.robot.gravity)

    def words(self) -> str:
        """The verdict in a sentence."""
        within, stands = np.isfinite(self.payloads)
        if not within:
            return "The limits do not let the cables hold the platform here."
        if not stands:
            return "No tensions within the limits hold the platform without tipping a base."
        count = len(self.facets)
        if not count:
            return "No facet comes from tipping: the limits alone decide."
        taken = 1 - self.standing.volume / self.limits.volume
        return f"Tipping makes {count} facet{'s' if count > 1 else ''} and takes {100 * taken:.0f} % of the set."


@checked
class WrenchSetExplorer(PlaneSetExplorer):
    """Sliders for τ_max, τ_min, the bases' mass and the platform; {W τ : limits}, and the part where no base tips.

    Forces are shown in the x direction and upwards; with more degrees of freedom all other
    components are what the weight wants. One limit holds for all cables, one mass for all bases
    with wheels. Facets that tipping makes are thick, wheels (in space: edges) over which the
    cables could tip a base are crossed; all of it stands in the text.

    world : motion pattern with at least two components, and cables with finite tension limits
    Raises InvalidInput for anything else.

    >>> import cdprlab as cl
    >>> explorer = wrench_set_explorer(cl.load_world("planar_mcdpr"))
    >>> explorer.set(base_mass=30)
    >>> print(explorer.text.splitlines()[-1])
    Tipping makes 6 facets and takes 53 % of the set.
    """

    def __init__(self, world: World) -> None:
        check_set_world(world, "wrench", "tension")
        robot = world.robot
        high, low = robot.tension_max.max(), robot.tension_min.min()
        sliders = [Slider("tension_max", "τ_max", "N", 0.3 * high, 1.5 * high, high,
                          high / 100),
                   Slider("tension_min", "τ_min", "N", 0.0, max(0.25 * high, low), low,
                          high / 100)]
        if masses := [base.mass for base in robot.bases if len(base.footprint)]:
            mass = max(masses)
            sliders.append(Slider("base_mass", "mass of each base", "kg", mass / 12, 2 * mass,
                                  mass, mass / 60))
        super().__init__(world, "wrench", [0, robot.dimension - 1], sliders)

    @once_a_move
    def capability(self, values: Values) -> Capability:
        """Everything at the controls' values."""
        robot, pose = _changed(self._posing.robot, values), self._posing.pose(values)
        weight = gravity_wrench(robot, pose)
        limits, standing = (self._shown(available_wrench_set(robot, pose, tipping), -weight)
                            for tipping in (False, True))
        hold = -weight[self._chosen]
        added = np.stack([polytope.axis_section(hold) for polytope in (limits, standing)])
        return Capability(robot, pose, hold, limits, standing, added,
                          tuple(self._edges(robot, pose, limits, -weight)),
                          _tipping_facets(limits, standing))

    def build(self, figure: Figure) -> None:
        self.frame(figure, _LABELS, self._reach())
        panel, bases = self.panel, "base_mass" in self.controls
        # By whether an edge could tip.
        self._edge_marks = {could: movable(self.drawing.axes, marker, linestyle="none",
                                           color=color, markersize=size,
                                           zorder=9, markeredgecolor="white", label=words
                                           if bases else "")
                            for could, marker, color, size, words in (
                                (False, "o", GREEN, 9, "stands for certain"),
                                (True, "X", VERMILION, 11, "could tip over this"))}
        panel.plot([], [], color=INK, linewidth=4, label="facets made by tipping")
        self._mark = movable(panel, "*", linestyle="none", markersize=13,
                             markeredgecolor="white", color=GREEN,
                             zorder=6, label="holds the weight, −w_g")
        figure.legend(loc="outside lower center", ncols=3, fontsize=9)

    def draw(self, values: Values) -> None:
        found = self.capability(values)
        self.drawing.move(found.pose)
        for could, marks in self._edge_marks.items():
            places = np.array([edge.place for edge in found.edges
                               if (edge.moment > 0) is could])
            marks.set_data(*self.drawing.view.flat(places).T if len(places) else ([], []))
        for patch, polytope in zip(self.patches, (found.limits, found.standing)):
            corners = polytope.vertices
            patch.set_visible(len(corners) > 2)
            patch.set_xy(corners if len(corners) > 2 else np.zeros((3, 2)))
        self.panel.plot(*found.facets.transpose(2, 1, 0), color=INK, linewidth=4, zorder=2)
        self._draw_hold(found)

    def numbers(self, values: Values) -> str:
        """Corners, area, what can be added along the axes, payload; largest moment and toll of each edge."""
        found = self.capability(values)
        sets = (found.limits, found.standing)
        rows = [["corners", *(str(len(polytope.vertices)) for polytope in sets)],
                ["area [kN²]", *(f"{polytope.volume / 1e6:.4f}" for polytope in sets)],
                *([f"add {name} [N]", *(_range(section[k]) for section in found.added)]
                  for k, name in enumerate(self._names)),
                ["payload [kg]",
                 *("none" if np.isnan(payload) else fixed(payload, 2)
                   for payload in found.payloads)]]
        told = text_table(["", *_LABELS], rows)
        if found.robot.n_dof > 2:
            told += "\n(all other components as the weight wants them)"
        if found.edges:
            edges = [[edge.name, fixed(edge.moment, 1), f"{100 * edge.share:.0f} %"]
                     for edge in found.edges]
            told += "\n\n" + text_table(["edge", "largest moment [N m]", "area it takes"],
                                        edges)
        return f"{told}\n\n{found.words()}"

    def describe(self, values: Values) -> str:
        found = self.capability(values)
        loose = [edge.name for edge in found.edges if edge.moment > 0]
        return (f"{self.title}, platform at ({', '.join(f'{x:.3g}' for x in found.pose.position)}) m. "
                f"{found.words()} Edges a base could tip over: {', '.join(loose) or 'none'}.")

    # --- what the values mean -------------------------------------------------------------------------
    def _shown(self, polytope: Polytope, hold: Array) -> Polytope:
        return polytope if polytope.n == 2 else polytope.slice(self._chosen, hold)

    def _edges(self, robot: Robot, pose: Pose, limits: Polytope, hold: Array) -> Iterator[Edge]:
        W, eye = wrench_matrix(robot, pose), np.eye(robot.n_cables)
        low, high = robot.tension_min, robot.tension_max
        for name, rows in tipping_rows(robot, pose).items():
            for k, (row, offset) in enumerate(zip(rows.matrix, rows.offset)):
                moment, share = np.maximum(row * low, row * high).sum() + offset, 0.0
                if moment > 0 and limits.volume > 0:
                    alone = Polytope.from_image(W, [*eye, *-eye, row], [*high, *-low, -offset])
                    share = 1 - self._shown(alone, hold).volume / limits.volume
                yield Edge(f"{name.replace('_', ' ')} {k + 1}",
                           _edge_place(robot.base(name), k), float(moment), share)

    # --- parts of the picture -------------------------------------------------------------------------
    def _reach(self) -> Array:
        """(2, 2) ends of the picture's axes: what the largest limits allow wherever the sliders end."""
        robot = every_cable(self._posing.robot, tension_min=0.0,
                            tension_max=1.5 * self._posing.robot.tension_max.max())
        ranges = [np.zeros((2, 2))]
        for pose in self._posing.ends():
            whole = self._shown(available_wrench_set(robot, pose), -gravity_wrench(robot, pose))
            ranges.append(np.nan_to_num(whole.component_range()))
        low, high = np.min(ranges, axis=0)[:, 0], np.max(ranges, axis=0)[:, 1]
        return np.stack([low, high], axis=1) + 0.06 * np.outer(high - low + 1.0, [-1, 1])

    def _draw_hold(self, found: Capability) -> None:
        """A cross from −w_g to the border of the standing set; the star's shape says whether it is inside."""
        held = np.isfinite(found.payloads[1])
        self._mark.set(marker="*" if held else "X", color=GREEN if held else VERMILION,
                       data=found.hold[:, None])
        if held:
            for way, marker, ends in zip(np.eye(2), "|_", found.added[1]):
                self.panel.plot(*(found.hold[:, None] + np.outer(way, ends)), color=INK,
                                linewidth=1.2, marker=marker)


wrench_set_explorer = WrenchSetExplorer


def _changed(robot: Robot, values: Values) -> Robot:
    bases = tuple(replace(base, mass=values["base_mass"]) if len(base.footprint) else base
                  for base in robot.bases)
    return every_cable(replace(robot, bases=bases), tension_min=values["tension_min"],
                       tension_max=values["tension_max"])


# --- tipping ----------------------------------------------------------------------------------------------
def _edge_place(base: Base, k: int) -> Array:
    """(d,) the wheel itself, or the middle of an edge; edges run counter-clockwise as their rows do."""
    if base.center_of_mass.size == 2:
        return base.to_world(base.footprint[k])
    contacts = np.pad(base.footprint, ((0, 0), (0, 1)))
    return base.to_world((contacts[k] + contacts[(k + 1) % len(contacts)]) / 2)


def _tipping_facets(limits: Polytope, standing: Polytope) -> Array:
    """(k, 2, 2) ends of the facets whose line the zonotope crosses."""
    corners = standing.vertices
    if len(corners) < 3 or limits.volume <= 0:
        return np.zeros((0, 2, 2))
    after = np.roll(corners, -1, axis=0)
    outward = (after - corners) @ [[0.0, -1.0], [1.0, 0.0]]   # as long as the facet
    beyond = limits.support(outward) - (outward * corners).sum(axis=1)
    cut = beyond > _CUT * np.ptp(corners, axis=0).max() * np.linalg.norm(outward, axis=1)
    return np.stack([corners, after], axis=1)[cut]


def _range(ends: Array) -> str:
    return "none" if np.isnan(ends).any() else f"{fixed(ends[0], 1)} … {fixed(ends[1], 1)}"
