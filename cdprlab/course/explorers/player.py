"""Play a run: the robot, its tensions against their limits, and the error, at any time."""

from typing import Any

import ipywidgets
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ...arrays import Array
from ...errors import InvalidInput, quoted
from ...robot import Robot
from ...robot.pose import Pose
from ...run import Run
from ...view.drawing import RobotDrawing
from ...view.style import GREY, INK, tension_colors
from ..text_table import fixed, tension_text, text_table
from .cable_bars import CableBars
from .explorer import Explorer, Slider, Values

_FRAME = 0.1
"""Seconds between two pictures of the playing run: a slow notebook connection keeps up."""

VIEWS = ("picture", "scene")


class RunPlayer(Explorer):
    """A time slider and a play button on a run: robot, tensions against their limits, position error.

    run : Run
    view : "picture" (every run, everywhere) or "scene" (spatial runs, 3-D to be turned with the
        mouse; needs WebGL)
    Raises InvalidInput for anything else.

    >>> run_player(42)
    Traceback (most recent call last):
    ...
    cdprlab.errors.InvalidInput: run_player takes a Run, as cdprlab.run returns, got int
    """

    def __init__(self, run: Run, view: str = "picture") -> None:
        # The picture is the default: WebGL is missing in headless browsers, remote desktops and
        # on some students' machines, and where it is missing k3d shows an empty rectangle
        # without a word.
        self.view = _checked_view(run, view)
        self.run, self.world = run, run.world
        self.spatial = run.world.robot.dimension == 3
        self.end = float(run.time[-1])
        self.limits = _shown_range(run)
        self.scene: Any = None
        controls = [Slider("t", "time", "s", 0.0, max(self.end, 1e-3), 0.0, _tick(self.end))]
        if self.spatial and view == "picture":
            controls.append(Slider("azimuth", "seen from", "deg", -180.0, 180.0, 25.0, 5.0))
        super().__init__(controls, run.world.title,
                         size=(6.0, 6.2) if view == "picture" else (6.0, 2.4))
        self._add_play_button()

    def index(self, t: float) -> int:
        """Which row of the run's log is shown at time ``t`` [s]: the last that has begun."""
        return int(np.clip(np.searchsorted(self.run.time, t + 1e-9, side="right") - 1, 0,
                           len(self.run.time) - 1))

    def build(self, figure: Figure) -> None:
        """The robot above, a bar for each cable below."""
        if self.view == "picture":
            above, below = figure.subplots(2, 1, height_ratios=[2.4, 1])
            self.drawing = RobotDrawing(above, self.world.robot, self.world.scene,
                                        _poses_to_hold(self.run))
            self.drawing.limits = self.limits
        else:
            from .scene import RobotScene

            below = figure.subplots()
            self.scene = RobotScene(self.world, self.run.poses[0],
                                    self.run.measured_tensions[0], self.limits)
        self.bars = _framed_bars(below, self.world.robot, self.limits[1])

    def draw(self, values: Values) -> None:
        """Robot and bars at that time."""
        k = self.index(values["t"])
        pose, tau = self.run.poses[k], self.run.measured_tensions[k]
        if self.scene is not None:
            self.scene.move(pose, tau)
        else:
            if "azimuth" in values:
                self.drawing.turn(values["azimuth"])
            self.drawing.move(pose, tau)
        shown, commanded = np.nan_to_num(np.maximum(tau, 0.0)), self.run.commanded_tensions[k]
        self.bars.draw(shown, [tension_text(pull) for pull in tau],
                       np.maximum(shown, commanded),
                       color=tension_colors(tau, self.limits) / 255)
        self.bars.axes.plot(commanded, range(1, len(commanded) + 1), "|", color=INK,
                            markersize=11,
                            markeredgewidth=2, zorder=4)

    def numbers(self, values: Values) -> str:
        """Time, error, and every cable's tension between its limits."""
        k, run, robot = self.index(values["t"]), self.run, self.world.robot
        position = ", ".join(fixed(x, 3) for x in run.poses.position[k])
        lines = [f"t               {run.time[k]:.3f} s",
                 f"position of P   ({position}) m",
                 f"position error  {1e3 * run.position_errors[k]:.3f} mm",
                 "tensions balance the wanted wrench"
                 if run.feasible[k] else "NO feasible tensions at this time"]
        rows = [[str(c + 1), tension_text(measured), fixed(commanded, 1),
                 f"{low:g} to {high:g}"]
                for c, (measured, commanded, low, high) in enumerate(zip(
                    run.measured_tensions[k], run.commanded_tensions[k], robot.tension_min,
                    robot.tension_max))]
        return "\n".join(lines) + "\n\n" + text_table(["cable", "measured [N]", "commanded [N]", "limits [N]"], rows)

    def describe(self, values: Values) -> str:
        """What is seen at that time."""
        tau = np.nan_to_num(self.run.measured_tensions[self.index(values["t"])])  # a cut cable is NaN
        return (f"{self.title}, task {self.run.task}, at {values['t']:.2f} s: robot with cables colored by tension, "
                f"{tension_text(tau.min())} to {tension_text(tau.max())} N, and a bar for each cable")

    def close(self) -> None:
        """Let go of everything, the 3-D scene too."""
        super().close()
        if self.scene is not None:
            self.scene.close()

    def _add_play_button(self) -> None:
        frames = max(1, round(self.end / _FRAME))
        self.play = ipywidgets.Play(value=0, min=0, max=frames, interval=round(1000 * _FRAME))
        self.play.observe(lambda change: self._show_frame(change["new"]), names="value")
        self.panel.children = (self.play, *self.panel.children)
        if self.scene is not None:
            self.stage.children = (self.scene.plot, *self.stage.children)
        self.on_move(self._follow)

    def _frame(self, values: Values) -> int:
        return round(values["t"] / max(self.end, 1e-9) * self.play.max)

    def _show_frame(self, frame: int) -> None:
        # The button also follows the slider (``_follow``); then there is nothing to show.
        if self._frame(self.values) != frame:
            self.set(t=self.end * frame / self.play.max)

    def _follow(self, values: Values) -> None:
        """Playing goes on from where the slider is."""
        self.play.value = self._frame(values)


run_player = RunPlayer


def _checked_view(run: Any, view: str) -> str:
    if not hasattr(run, "measured_tensions"):
        raise InvalidInput(f"run_player takes a Run, as cdprlab.run returns, got {type(run).__name__}")
    if view not in VIEWS:
        raise InvalidInput(f"view must be one of {', '.join(VIEWS)}, got {quoted(view)}")
    if view == "scene" and run.world.robot.dimension == 2:
        raise InvalidInput(f"world {run.world.name!r} is planar, view=\"scene\" shows spatial robots; "
                           "use view=\"picture\"")
    return view


def _shown_range(run: Run) -> tuple[float, float]:
    """0 to the largest tension of the run: one scale for colors and bars, so that times can be compared [N]."""
    tau = np.concatenate([run.measured_tensions, run.commanded_tensions])
    return 0.0, max(float(np.nan_to_num(tau).max()), 1.0)


def _tick(duration: float) -> float:
    """One arrow key's time: 0.01 s, more in long runs so that the end is within 1000 of them [s]."""
    return 0.01 * max(1, int(np.ceil(duration / 10.0))) if duration >= 0.1 else max(duration, 1e-3) / 100


def _poses_to_hold(run: Run) -> Pose:
    """Some twenty poses that span the motion."""
    return run.poses[np.unique(np.linspace(0, len(run.time) - 1, 20).astype(int))]


def _framed_bars(axes: Axes, robot: Robot, top: float) -> CableBars:
    """Each cable's limits as small brackets around a bar to come; in words where they are off the scale.

    top : the largest tension [N]
    """
    low, high, end = robot.tension_min, robot.tension_max, 1.18 * top
    bars = CableBars(axes, robot.n_cables, end, 0.02 * top)
    axes.grid(visible=False, axis="y")
    axes.tick_params(axis="y", labelsize=9)
    for limits in (low, high):
        k = np.flatnonzero(limits <= end) + 1
        axes.vlines(limits[k - 1], k - 0.4, k + 0.4, color=INK, linewidth=1.6,
                    linestyle=(0, (1, 1)), zorder=3,
                    animated=True)  # as the bars, or it would be below them
    names = ((r"$\tau_\mathrm{min}$", low), (r"$\tau_\mathrm{max}$", high))
    far = [f"{name} {_spread(limit)} N" for name, limit in names if (limit > end).any()]
    note = "dots: limits" + (f", off scale {', '.join(far)}" if far else "")
    axes.set_title(f"bar: measured · line: commanded · {note}", fontsize=9, fontweight="normal",
                   color=GREY, loc="left")
    return bars


def _spread(limits: Array) -> str:
    low, high = limits.min(), limits.max()
    return f"{low:g}" if low == high else f"{low:g} to {high:g}"
