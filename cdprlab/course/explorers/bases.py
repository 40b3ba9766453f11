"""Drive mobile bases and the platform: how long are the cables, how fast must the winches run? l̇ = J t − B_b q̇_b."""

from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ...arrays import Array, checked
from ...errors import InvalidInput
from ...mechanics.cables import cable_lengths
from ...mechanics.kinematics import base_jacobian, jacobian
from ...robot import Base, Robot
from ...robot.pose import Pose
from ...view.drawing import RobotDrawing
from ...view.style import INK, cable_style
from ...world import World
from ..text_table import cable_names, cable_table, fixed
from .explorer import Choice, Explorer, Slider, Values, once_a_move, sliders
from .posing import EYE, Posing, draw_arrow, no_length, velocity

DIRECTIONS = (("turn", "θ̇", 30.0, "deg", "rad/s"), ("along", "ρ̇₁", 0.6, "m", "m/s"),
              ("across", "ρ̇₂", 0.6, "m", "m/s"))
"""Of a base: slider's name, symbol of its speed, how far it goes either way, unit of that, unit of the speed."""

_DOT = "\u0307"
"""Over the letter of a speed."""

_MOST_DISPLACEMENTS = 4
"""Sliders for where bases are, unless asked for more: one for everything would fill a page."""

_SECONDS = 0.3
"""Arrows show where things will be after so long."""


class BaseMotion(NamedTuple):
    """What the controls say: where everything is, how fast it goes, and what that asks of the winches.

    robot, pose : bases and platform where they are
    base_speeds, twist : (3p,) q̇_b and (n,) t [m/s, rad/s]
    lengths : (m,) [m]
    from_platform, from_bases : (m,) J t and −B_b q̇_b, whose sum is l̇ [m/s]; nan where a cable
        has no length
    """

    robot: Robot
    pose: Pose
    base_speeds: Array
    twist: Array
    lengths: Array
    from_platform: Array
    from_bases: Array

    @property
    def rates(self) -> Array:
        """(m,) l̇ [m/s]."""
        return self.from_platform + self.from_bases

    def words(self) -> str:
        """What the winches do, in a sentence."""
        if not self.lengths.all():
            return f"{no_length(self.lengths)} here, hence no direction and no rate."
        groups = {"reeled in": self.rates < -5e-4, "paid out": self.rates > 5e-4,
                  "too fast for the winch": np.abs(self.rates) > self.robot.speed_max * (1 + 1e-9)}
        said = [f"{cable_names(which)} {name}" for name, which in groups.items() if which.any()]
        return ("; ".join(said) + ".").capitalize() if said else "All winches stand still."


@checked
class BaseExplorer(Explorer):
    """Sliders for bases and platform; the picture, the cable lengths and l̇ = J t − B_b q̇_b answer.

    Bases are displaced from where the world has them: ρ₁, ρ₂ along their own axes, θ about
    their own centers, each only where its speed limit lets it drive. Arrows show velocities; a
    base drives at most at its limits.

    world : with mobile bases that can drive
    bases : names of those with sliders; default all that drive, the first alone if that is too
        many
    Raises InvalidInput for a world without bases that can drive, or a base that cannot.

    >>> import cdprlab as cl
    >>> explorer = base_explorer(cl.load_world("planar_mcdpr"))
    >>> explorer.set(speed_along=0.4)
    >>> print(explorer.text.splitlines()[-1])
    Cables 1, 2 reeled in.
    """

    def __init__(self, world: World, bases: tuple[str, ...] | None = None) -> None:
        robot = self._start = world.robot
        if not any(base.speed_max.any() for base in robot.bases):
            raise InvalidInput(f"world {world.name!r} has no base that can drive; planar_mcdpr, fastkit_planar and "
                               "mobile_four_bases have")
        self._posing, self._shown = Posing(world), _shown(robot, bases)
        controls: list[Slider | Choice] = [slider for base in self._shown
                                           for slider in _displacements(base)]
        controls += [*self._posing.places, *self._posing.turns]
        if len(self._shown) > 1:
            controls.append(Choice("drives", "base that drives",
                                   tuple(base.name for base in self._shown)))
        controls += _speeds(self._shown)
        controls += sliders("bases")[:robot.n_dof] if robot.dimension == 2 else [EYE]
        super().__init__(controls, f"Mobile bases: {world.title}")

    @once_a_move
    def motion(self, values: Values) -> BaseMotion:
        """Everything at the controls' values."""
        robot, pose, speeds = self._robot_at(values), self._posing.pose(values), self._base_speeds(values)
        twist = np.array([values.get(f"v_{row}", 0.0) for row in robot.pattern.rows])
        lengths = cable_lengths(robot, pose)
        from_platform = from_bases = np.full(robot.n_cables, np.nan)
        if lengths.all():
            from_platform, from_bases = jacobian(robot, pose) @ twist, -base_jacobian(robot,
                                                                                      pose) @ speeds
        return BaseMotion(robot, pose, speeds, twist, lengths, from_platform, from_bases)

    def build(self, figure: Figure) -> None:
        above, self._rates = figure.subplots(2, 1, height_ratios=(3, 1.1))
        reach = _SECONDS * max((slider.high for slider in self.controls.values()
                                if isinstance(slider, Slider) and slider.name.startswith("v_")), default=0.0)
        self._drawing = RobotDrawing(above, self._driven_outward(), self._posing.scene,
                                     self._posing.ends(reach))
        _frame_rates(self._rates, self._start)

    def draw(self, values: Values) -> None:
        motion, drawing = self.motion(values), self._drawing
        drawing.turn(values.get("azimuth", EYE.start))
        drawing.drive(motion.robot)
        drawing.move(motion.pose)
        for base, speeds in zip(motion.robot.bases, motion.base_speeds.reshape(-1, 3)):
            draw_arrow(drawing, base.origin, _SECONDS * base.rotation[:, :2] @ speeds[1:])
        draw_arrow(drawing, motion.pose.position,
                   _SECONDS * velocity(motion.robot, motion.twist))
        cables = np.arange(motion.robot.n_cables)
        self._rates.bar(cables + 1, np.nan_to_num(motion.rates), width=0.6,
                        color=[cable_style(k).color for k in cables.tolist()])

    def numbers(self, values: Values) -> str:
        """Lengths and rates, cable by cable."""
        motion = self.motion(values)
        rows = {"length [m]": [fixed(length, 3) for length in motion.lengths]}
        if np.isfinite(motion.rates).all():
            # No dotted letters here: a combining dot counts as a letter and would push the
            # columns out of line.
            parts = {"platform [m/s]": motion.from_platform, "bases [m/s]": motion.from_bases,
                     "rate [m/s]": motion.rates}
            rows |= {name: [fixed(rate, 3) for rate in rates] for name, rates in parts.items()}
        rows["limit [m/s]"] = [f"{limit:g}" for limit in motion.robot.speed_max]
        return f"{cable_table(rows)}\n\nrate l̇ = J t (platform) − B_b q̇_b (bases)\n{motion.words()}"

    def idle(self, values: Values) -> dict[str, str]:
        moves = any(value for name, value in values.items() if name.startswith("speed_"))
        return {} if moves or "drives" not in values else {"drives": "the base speed is 0"}

    def describe(self, values: Values) -> str:
        motion = self.motion(values)
        places = ", ".join(f"base {base.name} at ({base.position[0]:.3g}, {base.position[1]:.3g}) m"
                           for base in motion.robot.bases)
        return (f"{self.title}: {places}, platform at ({', '.join(f'{x:.3g}' for x in motion.pose.position)}) m. "
                f"{motion.words()}")

    # --- what the values mean -------------------------------------------------------------------------
    def _robot_at(self, values: Values) -> Robot:
        places = {}
        for base in self._shown:
            turn, *way = (values.get(f"{base.name}_{name}", 0.0) for name, *_ in DIRECTIONS)
            places[base.name] = (*(base.position + base.rotation[:2, :2] @ way), base.heading
                                 + np.deg2rad(turn))
        return self._start.with_bases(places)

    def _base_speeds(self, values: Values) -> Array:
        """(3p,) as wanted of the base that drives, within its limits."""
        name = values.get("drives", self._shown[0].name)
        wanted = [values.get(f"speed_{direction}", 0.0) for direction, *_ in DIRECTIONS]
        return np.concatenate([np.clip(wanted, -base.speed_max,
                                       base.speed_max) * (base.name == name)
                               for base in self._start.bases])

    def _driven_outward(self) -> Robot:
        """With the bases as far apart as their sliders reach."""
        outward, middle = {}, np.mean([base.position for base in self._start.bases], axis=0)
        for base in self._shown:
            turned, reach = base.rotation[:2, :2], 0.6 * (base.speed_max[1:] > 0)
            away = np.sign((base.position - middle) @ turned) * reach
            outward[base.name] = (*(base.position + turned @ away), base.heading)
        return self._start.with_bases(outward)


base_explorer = BaseExplorer


# --- sliders --------------------------------------------------------------------------------------------------
def _shown(robot: Robot, names: tuple[str, ...] | None) -> list[Base]:
    if names is None:
        able = [base for base in robot.bases if base.speed_max.any()]
        many = np.count_nonzero([base.speed_max for base in able]) > _MOST_DISPLACEMENTS
        return able[:1] if many else able
    for name in names:
        if not robot.base(name).speed_max.any():
            raise InvalidInput(f"base {name!r} cannot drive: all its speed limits are 0")
    if not len(names):
        raise InvalidInput("bases must name at least one base, or be left out")
    return [robot.base(name) for name in names]


def _displacements(base: Base) -> list[Slider]:
    return [Slider(f"{base.name}_{name}",
                   f"{base.name.replace('_', ' ')} {symbol.replace(_DOT, '')}", unit,
                   -reach, reach, 0.0, reach / 30)
            for (name, symbol, reach, unit, _), limit in zip(DIRECTIONS, base.speed_max)
            if limit]


def _speeds(bases: list[Base]) -> list[Slider]:
    limits = np.max([base.speed_max for base in bases], axis=0).tolist()
    return [Slider(f"speed_{name}", f"base speed {symbol}", unit, -limit, limit, 0.0,
                   limit / 20)
            for (name, symbol, *_, unit), limit in zip(DIRECTIONS, limits) if limit]


# --- picture --------------------------------------------------------------------------------------------------
def _frame_rates(axes: Axes, robot: Robot) -> None:
    """Room for a bar a cable, to its l̇; the limits as dashes."""
    limits = np.where(np.isfinite(robot.speed_max), robot.speed_max, 2.0)
    cables = np.arange(1, robot.n_cables + 1)
    axes.axhline(0, color=INK, linewidth=1)
    for ends in (limits, -limits):
        axes.hlines(ends, cables - 0.4, cables + 0.4, color=INK, linestyles="dashed",
                    linewidth=1.2)
    axes.set(xlabel="cable (dashes: limit of its winch)", ylabel="l̇ [m/s]", xticks=cables,
             ylim=1.3 * limits.max() * np.array([-1, 1]))
