"""Drag a wanted twist, turn the speed limits: is it in the available twist set, and how much of it can be had?"""

import dataclasses
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure

from ...arrays import Array, Flags, checked
from ...errors import InvalidInput, quoted
from ...mechanics.kinematics import jacobian
from ...mechanics.redundancy import TwistResolution, resolve_twist
from ...robot import Robot
from ...robot.pose import Pose
from ...run.log import text_table
from ...sets import Polytope, available_twist_set
from ...view.style import GREEN, INK, VERMILION
from ...world import World
from ..pictures.set_charts import axis_names
from ..props.changed_cables import every_cable
from ..text_table import fixed, in_brackets
from .explorer import Explorer, Slider, Values, once_a_move
from .plane_sets import check_set_world, set_patches
from .posing import Posing, draw_arrow, velocity

_DIRECTIONS = (("turn", "θ̇", "rad/s"), ("along", "ρ̇₁", "m/s"), ("across", "ρ̇₂", "m/s"))

_SECONDS = 0.25
"""The robot's arrow shows where the platform would be after this time."""


class Reach(NamedTuple):
    """What the robot makes of a wanted twist.

    robot, pose : with the controls' speed limits
    twist : (n,) wanted, zero in the components that have no control [m/s, rad/s]
    fixed, moving : available twist sets, bases standing and driving
    scales : (2,) largest s for which s t is available, bases standing and driving; inf for the
        zero twist
    rates : (m,) J t, the cable speeds with standing bases [m/s]
    shares : speeds of bases and cables for the twist, or for the largest share of it
    """

    robot: Robot
    pose: Pose
    twist: Array
    fixed: Polytope
    moving: Polytope
    scales: Array
    rates: Array
    shares: TwistResolution

    @property
    def inside(self) -> Flags:
        """(2,) whether the twist is available, to rounding."""
        return np.asarray(self.scales >= 1 - 1e-9)

    def verdict(self, moving: bool) -> str:
        """Inside or outside, and how much of the twist can be had."""
        scale, inside = self.scales[int(moving)], self.inside[int(moving)]
        where = "inside" if inside else "OUTSIDE"
        return f"{where}, scale at most {scale:.3f}" if np.isfinite(scale) else f"{where}, any scale"


@checked
class TwistSetExplorer(Explorer):
    """Sliders for a twist and the speed limits; {t : |J t − B_b q̇_b| ≤ l̇_max}, bases fixed and driving, answers.

    The text says inside or outside, the largest scale, and one way to share the twist among
    bases and cables. With more than two degrees of freedom the other components are zero; the
    shadow shows what they allow when free.

    world : motion pattern with at least two components
    components : which two are dragged
    Raises InvalidInput for a world or components that do not fit.

    >>> import cdprlab as cl
    >>> explorer = twist_set_explorer(cl.load_world("planar_mcdpr"))
    >>> explorer.set(v_x=1.15, v_y=1.675)
    >>> print("\\n".join(explorer.text.splitlines()[1:3]))
    bases fixed    OUTSIDE, scale at most 0.985
    bases driving  inside, scale at most 1.220
    """

    def __init__(self, world: World, components: Sequence[int] = (0, 1)) -> None:
        self._robot = world.robot
        check_set_world(world, "twist", "twists", "speed")
        self._chosen, self._posing = _components(self._robot, components), Posing(world)
        self._names = [axis_names(self._robot.motion_pattern, "twist")[k] for k in self._chosen]
        # Beyond the set at the world's pose with the world's limits, to a half.
        whole = available_twist_set(self._robot, world.pose).project(self._chosen).component_range()
        self._reach = np.ceil(2.6 * np.abs(whole).max(axis=1)) / 2
        sliders = [Slider(name, name, "m/s" if name[0] == "v" else "rad/s", -reach, reach,
                          0.0, 0.025)
                   for name, reach in zip(self._names, self._reach.tolist())]
        super().__init__([*sliders, *_limit_sliders(self._robot), *self._posing.places],
                         f"Available twist set: {world.title}", size=(6.2, 4.6))

    @once_a_move
    def reach(self, values: Values) -> Reach:
        """Everything at the controls' values."""
        robot, pose = _limited(self._robot, values), self._posing.pose(values)
        twist = np.zeros(robot.n_dof)
        twist[self._chosen] = [values[name] for name in self._names]
        fixed, moving = available_twist_set(robot, pose, "none"), available_twist_set(robot, pose)
        scales = np.array([fixed.scale(twist), moving.scale(twist)])
        return Reach(robot, pose, twist, fixed, moving, scales, jacobian(robot, pose) @ twist,
                     resolve_twist(robot, pose, min(1.0, scales[1]) * twist))

    def build(self, figure: Figure) -> None:
        left, panel = figure.subplots(1, 2, width_ratios=(1, 1.35))
        self._drawing = self._posing.drawing(left)
        left.set_title(f"arrow: {_SECONDS:g} s of the twist", fontsize=10)
        self._panel = panel
        flat = self._robot.n_dof == 2
        labels = ["bases fixed", "bases driving"] if flat else ["bases fixed, all else 0",
                                                                "driving, all else 0",
                                                                "driving, all else free"]
        self._patches = set_patches(panel, labels, self._names, np.outer(self._reach, [-1, 1]))
        for shadow in self._patches[2:]:
            shadow.set_facecolor("none")
        figure.legend(handles=self._patches, loc="outside lower center", ncols=3, fontsize=9)

    def draw(self, values: Values) -> None:
        found, wanted = self.reach(values), np.array([values[name] for name in self._names])
        self._drawing.move(found.pose)
        draw_arrow(self._drawing, found.pose.position,
                   _SECONDS * velocity(found.robot, found.twist), width=0.014)
        for patch, polytope in zip(self._patches, self._outlines(found)):
            patch.set_xy(polytope.vertices)
        self._draw_twist(found, wanted)

    def numbers(self, values: Values) -> str:
        """Inside or outside, largest scales, and one way to share the twist."""
        found = self.reach(values)
        heads = [f"t = {self._wanted(values)}  [{', '.join(self._names)}]",
                 f"bases fixed    {found.verdict(False)}",
                 f"bases driving  {found.verdict(True)}"]
        if found.moving.n == 2:
            heads.append(f"area of the set [m²/s²]  {found.fixed.volume:.2f} fixed, {found.moving.volume:.2f} driving")
        return "\n".join([*heads, "", self._cable_table(found), "", *self._base_lines(found)])

    def describe(self, values: Values) -> str:
        found = self.reach(values)
        return (f"{self.title}. The twist {self._wanted(values)} is {found.verdict(False)} with the bases fixed, "
                f"{found.verdict(True)} with the bases driving.")

    def _wanted(self, values: Values) -> str:
        return in_brackets([values[name] for name in self._names], 3)

    # --- parts of the picture -------------------------------------------------------------------------
    def _outlines(self, found: Reach) -> list[Polytope]:
        if found.moving.n == 2:
            return [found.fixed, found.moving]
        return [found.fixed.slice(self._chosen), found.moving.slice(self._chosen),
                found.moving.project(self._chosen)]

    def _draw_twist(self, found: Reach, wanted: Array) -> None:
        """The mark's shape says what its color says: dot within both, triangle within one, cross within none."""
        inside = found.inside
        word, marker, color = (("inside both sets", "o", GREEN) if inside[0] else
                               ("available only if bases drive", "^", INK) if inside[1] else
                               ("outside both sets", "X", VERMILION))
        panel = self._panel
        panel.text(0.02, 0.98, f"t is {word}", fontsize=10, ha="left", va="top",
                   fontweight="bold", color=color,
                   transform=panel.transAxes)
        scales = [scale if np.isfinite(scale) else 0.0 for scale in found.scales]
        panel.plot(*np.outer(wanted, [0.0, max(1.0, *scales)]), color=INK, linewidth=1.2)
        panel.plot(*wanted, marker=marker, markersize=10, color=color, markeredgecolor="white")
        for patch, scale in zip(self._patches, scales):
            if scale > 0:
                panel.plot(*(scale * wanted), marker="D", markersize=7, markerfacecolor="white",
                           markeredgewidth=1.6,
                           markeredgecolor=patch.get_edgecolor(), zorder=5)

    # --- parts of the text ----------------------------------------------------------------------------
    def _cable_table(self, found: Reach) -> str:
        top = found.robot.speed_max
        rows = [["bases fixed", *(fixed(rate, 2) + _over(rate, limit)
                                  for rate, limit in zip(found.rates, top))],
                ["bases driving", *(fixed(rate, 2) + " "
                                    for rate in found.shares.cable_speeds)],
                ["limit", *(f"{limit:g} " for limit in top)]]
        return text_table(["cable speed [m/s]", *(f"{i + 1} " for i in range(found.robot.n_cables))], rows)

    def _base_lines(self, found: Reach) -> list[str]:
        share = min(1.0, found.scales[1])
        lines = [f"driving, for {share:.3f} t: one way to share it"
                 if share < 1 else "driving: one way to share it"]
        for base, speeds in zip(found.robot.bases, found.shares.base_speeds.reshape(-1, 3)):
            moves = [f"{symbol} {fixed(speed, 2)} of {limit:.2f} {unit}"
                     for (_, symbol, unit), speed, limit in zip(_DIRECTIONS, speeds, base.speed_max) if limit > 0]
            lines.append(f"  base {base.name}: {', '.join(moves) or 'stands'}")
        return lines if found.robot.bases else []


twist_set_explorer = TwistSetExplorer


# --- controls ---------------------------------------------------------------------------------------------
def _components(robot: Robot, chosen: Sequence[int]) -> list[int]:
    names, picked = axis_names(robot.motion_pattern, "twist"), list(chosen)
    if len(picked) != 2 or len(set(picked)) != 2 or not set(picked) <= set(range(robot.n_dof)) \
            or names[picked[0]][0] != names[picked[1]][0]:
        raise InvalidInput(f"components must be two different numbers from 0 to {robot.n_dof - 1} of one unit "
                           f"({', '.join(names)}), got {quoted(chosen)}")
    return picked


def _limit_sliders(robot: Robot) -> list[Slider]:
    """From 0 to twice what the world says; a direction the world holds has none."""
    sliders = [Slider(f"{base.name}_{name}", f"{base.name.replace('_', ' ')} {symbol} up to",
                      unit, 0.0, 2 * limit,
                      limit, limit / 20)
               for base in robot.bases
               for (name, symbol, unit), limit in zip(_DIRECTIONS, base.speed_max.tolist())
               if limit > 0]
    top = float(robot.speed_max[0])
    if np.allclose(robot.speed_max, top):
        sliders.append(Slider("cable_speed", "cables up to", "m/s", 0.25 * top, 1.5 * top,
                              top, top / 40))
    return sliders


def _limited(robot: Robot, values: Values) -> Robot:
    bases = tuple(dataclasses.replace(base, speed_max=np.array([
        values.get(f"{base.name}_{name}", limit)
        for (name, *_), limit in zip(_DIRECTIONS, base.speed_max)]))
        for base in robot.bases)
    driven = dataclasses.replace(robot, bases=bases)
    return every_cable(driven, speed_max=values["cable_speed"]) if "cable_speed" in values else driven

def _over(rate: float, limit: float) -> str:
    return "!" if abs(rate) > limit * (1 + 1e-9) else " "
