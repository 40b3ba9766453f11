"""Drag a wanted twist, turn the speed limits: is it in the available twist set, and how much of it can be had?"""

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure

from ...arrays import Array, Flags, checked
from ...errors import InvalidInput, quoted
from ...mechanics.kinematics import jacobian
from ...mechanics.redundancy import TwistResolution, resolve_twist
from ...robot import Robot
from ...robot.pose import Pose
from ...sets import Polytope, available_twist_set
from ...view.style import GREEN, INK, VERMILION
from ...world import World
from ..pictures.set_charts import axis_names
from ..props.changed_cables import every_cable
from ..text_table import cable_table, fixed, in_brackets
from .bases import DIRECTIONS
from .explorer import Slider, Values, once_a_move
from .plane_sets import PlaneSetExplorer, check_set_world
from .posing import draw_arrow, velocity

_SECONDS = 0.15
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
class TwistSetExplorer(PlaneSetExplorer):
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
        check_set_world(world, "twist", "speed")
        robot = self._robot = world.robot
        names = axis_names(robot.motion_pattern, "twist")
        chosen = _components(names, components)
        # Beyond the set at the world's pose with the world's limits, to a half.
        whole = available_twist_set(robot, world.pose).project(chosen).component_range()
        reach = np.ceil(2.6 * np.abs(whole).max(axis=1)) / 2
        self._ends = np.outer(reach, [-1, 1])
        wanted = [Slider(names[k], names[k], "m/s" if names[k][0] == "v" else "rad/s", -end,
                         end, 0.0, 0.025)
                  for k, end in zip(chosen, reach.tolist())]
        super().__init__(world, "twist", chosen, [*wanted, *_limit_sliders(robot)])

    @once_a_move
    def reach(self, values: Values) -> Reach:
        """Everything at the controls' values."""
        robot, pose = _limited(self._robot, values), self._posing.pose(values)
        twist = np.zeros(robot.n_dof)
        twist[self._chosen] = [values[name] for name in self._names]
        fixed, moving = available_twist_set(robot, pose, "none"), available_twist_set(robot,
                                                                                      pose)
        scales = np.array([fixed.scale(twist), moving.scale(twist)])
        return Reach(robot, pose, twist, fixed, moving, scales, jacobian(robot, pose) @ twist,
                     resolve_twist(robot, pose, min(1.0, scales[1]) * twist))

    def build(self, figure: Figure) -> None:
        labels = ["bases fixed", "bases driving"] if self._robot.n_dof == 2 else \
            ["bases fixed, all else 0", "driving, all else 0", "driving, all else free"]
        fastest = np.zeros(self._robot.n_dof)
        fastest[self._chosen] = self._ends[:, 1]
        self.frame(figure, labels, self._ends, _SECONDS * velocity(self._robot, fastest))
        self.drawing.axes.set_title(f"arrow: {_SECONDS:g} s of the twist", fontsize=10)
        for shadow in self.patches[2:]:
            shadow.set_facecolor("none")
        figure.legend(loc="outside lower center", ncols=3, fontsize=9)

    def draw(self, values: Values) -> None:
        found = self.reach(values)
        self.drawing.move(found.pose)
        draw_arrow(self.drawing, found.pose.position,
                   _SECONDS * velocity(found.robot, found.twist), width=0.014)
        sets = [found.fixed, found.moving]
        if found.moving.n > 2:
            sets = [*(whole.slice(self._chosen) for whole in sets),
                    found.moving.project(self._chosen)]
        for patch, polytope in zip(self.patches, sets):
            patch.set_xy(polytope.vertices)
        self._draw_twist(found)

    def numbers(self, values: Values) -> str:
        """Inside or outside, largest scales, and one way to share the twist."""
        found = self.reach(values)
        area = [f"area of the set [m²/s²]  {found.fixed.volume:.2f} fixed, {found.moving.volume:.2f} driving"] \
            if found.moving.n == 2 else []
        return "\n".join([f"t = {self._wanted(found)}  [{', '.join(self._names)}]",
                          f"bases fixed    {found.verdict(False)}",
                          f"bases driving  {found.verdict(True)}",
                          *area, "", _cable_speeds(found), "", *_base_lines(found)])

    def describe(self, values: Values) -> str:
        found = self.reach(values)
        return (f"{self.title}. The twist {self._wanted(found)} is {found.verdict(False)} with the bases fixed, "
                f"{found.verdict(True)} with the bases driving.")

    def _wanted(self, found: Reach) -> str:
        return in_brackets(found.twist[self._chosen], 3)

    def _draw_twist(self, found: Reach) -> None:
        """The mark's shape says what its color says: dot within both, triangle within one, cross within none."""
        fixed, moving = found.inside
        word, marker, color = (("inside both sets", "o", GREEN) if fixed else
                               ("available only if bases drive", "^", INK) if moving else
                               ("outside both sets", "X", VERMILION))
        panel, wanted = self.panel, found.twist[self._chosen]
        panel.set_title(f"t is {word}", fontsize=10, color=color)
        scales = np.where(np.isfinite(found.scales), found.scales, 0.0)
        panel.plot(*np.outer(wanted, [0.0, max(1.0, *scales)]), color=INK, linewidth=1.2)
        panel.plot(*wanted, marker, markersize=10, color=color, markeredgecolor="white")
        for patch, scale in zip(self.patches, scales):
            if scale:
                panel.plot(*(scale * wanted), "D", markersize=7, markerfacecolor="white",
                           markeredgewidth=1.6,
                           markeredgecolor=patch.get_edgecolor(), zorder=5)


twist_set_explorer = TwistSetExplorer


# --- parts of the text ------------------------------------------------------------------------------------
def _cable_speeds(found: Reach) -> str:
    limits = found.robot.speed_max
    over = np.where(np.abs(found.rates) > limits * (1 + 1e-9), "!", " ")
    return cable_table({"bases fixed [m/s]": [fixed(rate, 2) + mark for rate,
                                              mark in zip(found.rates, over)],
                        "driving [m/s]": [f"{fixed(rate, 2)} "
                                          for rate in found.shares.cable_speeds],
                        "limit [m/s]": [f"{limit:g} " for limit in limits]})


def _base_lines(found: Reach) -> list[str]:
    share = min(1.0, found.scales[1])
    lines = [f"driving{f', for {share:.3f} t' if share < 1 else ''}: one way to share it"]
    for base, speeds in zip(found.robot.bases, found.shares.base_speeds.reshape(-1, 3)):
        moves = [f"{symbol} {fixed(speed, 2)} of {limit:.2f} {unit}"
                 for (_, symbol, *_, unit), speed,
                 limit in zip(DIRECTIONS, speeds, base.speed_max) if limit > 0]
        lines.append(f"  base {base.name}: {', '.join(moves) or 'stands'}")
    return lines if found.robot.bases else []


# --- controls ---------------------------------------------------------------------------------------------
def _components(names: Sequence[str], chosen: Sequence[int]) -> list[int]:
    picked = [k for k in dict.fromkeys(chosen) if 0 <= k < len(names)]
    if len(picked) != 2 or len(picked) != len(chosen) or names[picked[0]][0] != names[picked[1]][0]:
        raise InvalidInput(f"components must be two different numbers from 0 to {len(names) - 1} of one unit "
                           f"({', '.join(names)}), got {quoted(chosen)}")
    return picked


def _limit_sliders(robot: Robot) -> list[Slider]:
    """From 0 to twice what the world says; a direction the world holds has none."""
    sliders = [Slider(f"{base.name}_{name}", f"{base.name.replace('_', ' ')} {symbol} up to",
                      unit, 0.0, 2 * limit,
                      limit, limit / 20)
               for base in robot.bases
               for (name, symbol, *_, unit), limit in zip(DIRECTIONS, base.speed_max.tolist())
               if limit > 0]
    top = robot.speed_max[0]
    if np.allclose(robot.speed_max, top):
        sliders.append(Slider("cable_speed", "cables up to", "m/s", 0.25 * top, 1.5 * top, top,
                              top / 40))
    return sliders


def _limited(robot: Robot, values: Values) -> Robot:
    bases = tuple(replace(base, speed_max=np.array([values.get(f"{base.name}_{name}", limit)
                                                    for (name, *_),
                                                    limit in zip(DIRECTIONS, base.speed_max)]))
                  for base in robot.bases)
    driven = replace(robot, bases=bases)
    return every_cable(driven,
                       speed_max=values["cable_speed"]) if "cable_speed" in values else driven
