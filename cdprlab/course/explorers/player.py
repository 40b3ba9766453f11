"""Play a run: the robot, its tensions against their limits, and the error, at any time."""

from __future__ import annotations

from typing import Any

import ipywidgets
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from ...arrays import Array
from ...errors import InvalidInput
from ...robot.pose import Pose
from ...run import Run
from ...view.drawing import RobotDrawing
from ...view.style import GREY, INK, tension_colors
from ..text_table import fixed, tension_text, text_table
from .cable_bars import CableBars
from .explorer import Explorer, Slider, Values, movable

_FRAME = 0.1
"""Seconds between two pictures of the playing run: a slow notebook connection keeps up."""

VIEWS = ("picture", "scene")


class RunPlayer(Explorer):
    """A time slider and a play button on a run: robot, tensions against their limits, position error.

    run : Run
    view : "picture" (every run, everywhere) or "scene" (spatial runs, 3-D to be turned with the mouse; needs WebGL)
    Raises InvalidInput for anything else.

    >>> run_player(42)
    Traceback (most recent call last):
    ...
    cdprlab.errors.InvalidInput: run_player takes a Run, as cdprlab.run returns, got int
    """

    def __init__(self, run: Run, view: str = "picture") -> None:
        # The picture is the default: WebGL is missing in headless browsers, remote desktops and on some students'
        # machines, and where it is missing k3d shows an empty rectangle without a word.
        self.view = _checked_view(run, view)
        self.run, self.world = run, run.world
        self.spatial = run.world.robot.dimension == 3
        self.end = float(run.time[-1])
        self.limits = _shown_range(run)
        self.scene: Any = None
        controls = [Slider("t", "time", "s", 0.0, max(self.end, 1e-3), 0.0, _tick(self.end))]
        if self.spatial and view == "picture":
            controls.append(Slider("azimuth", "seen from", "deg", -180.0, 180.0, 25.0, 5.0))
        super().__init__(controls, run.world.title, size=(6.0, 6.2) if view == "picture" else (6.0, 2.4))
        self._add_play_button()

    def index(self, t: float) -> int:
        """Which row of the run's log is shown at time ``t`` [s]: the last that has begun."""
        return int(np.clip(np.searchsorted(self.run.time, t + 1e-9, side="right") - 1, 0, len(self.run.time) - 1))

    def build(self, figure: Figure) -> None:
        """The robot above, a bar for each cable below."""
        if self.view == "picture":
            above, below = figure.subplots(2, 1, height_ratios=[2.4, 1])
            self.drawing = RobotDrawing(above, self.world.robot, self.world.scene, _poses_to_hold(self.run))
            self.drawing.limits = self.limits
        else:
            from .scene import RobotScene

            below = figure.subplots()
            self.scene = RobotScene(self.world, self.run.poses[0], self.run.measured_tensions[0], self.limits)
        self.bars = _TensionBars(below, self.run, self.limits)

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
        self.bars.show(tau, self.run.commanded_tensions[k])

    def numbers(self, values: Values) -> str:
        """Time, error, and every cable's tension between its limits."""
        k, run, robot = self.index(values["t"]), self.run, self.world.robot
        position = ", ".join(fixed(x, 3) for x in run.poses.position[k])
        lines = [f"t               {run.time[k]:.3f} s",
                 f"position of P   ({position}) m",
                 f"position error  {1e3 * run.position_errors[k]:.3f} mm",
                 "tensions balance the wanted wrench" if run.feasible[k] else "NO feasible tensions at this time"]
        rows = [[str(c + 1), tension_text(measured), fixed(commanded, 1), f"{low:g} to {high:g}"]
                for c, (measured, commanded, low, high) in enumerate(zip(
                    run.measured_tensions[k], run.commanded_tensions[k], robot.tension_min, robot.tension_max))]
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
        self.play.observe(lambda change: self._show_frame(change["new"], frames), names="value")
        self.panel.children = (self.play, *self.panel.children)
        if self.scene is not None:
            self.stage.children = (self.scene.plot, *self.stage.children)
        self.on_move(lambda values: self._follow(round(values["t"] / max(self.end, 1e-9) * frames)))

    def _show_frame(self, frame: int, frames: int) -> None:
        # The button also follows the slider (``_follow``); then there is nothing to show.
        if round(self.values["t"] / max(self.end, 1e-9) * frames) != frame:
            self.set(t=self.end * frame / frames)

    def _follow(self, frame: int) -> None:
        """Playing goes on from where the slider is."""
        if self.play.value != frame:
            self.play.value = frame


run_player = RunPlayer


class _TensionBars(CableBars):
    """A bar for each cable from 0 to its tension, in the cable's color of the robot's picture, with both limits."""

    def __init__(self, axes: Axes, run: Run, limits: tuple[float, float]) -> None:
        robot, top = run.world.robot, limits[1]
        self.limits = limits
        super().__init__(axes, robot.n_cables, 1.18 * top, 0.02 * top)
        axes.grid(visible=False, axis="y")
        axes.tick_params(axis="y", labelsize=9)
        self.wanted = movable(axes, "|", color=INK, markersize=11, markeredgewidth=2, zorder=4)
        _draw_limits(axes, robot.tension_min, robot.tension_max, 1.18 * top)

    def show(self, measured: Array, commanded: Array) -> None:
        shown = np.nan_to_num(np.maximum(measured, 0.0))
        self.move(shown, [tension_text(tau) for tau in measured], np.maximum(shown, commanded))
        for bar, color in zip(self.bars, tension_colors(measured, self.limits) / 255):
            bar.set_facecolor(tuple(color))
        self.wanted.set_data(commanded, np.arange(1, len(commanded) + 1))


def _checked_view(run: Any, view: str) -> str:
    if not hasattr(run, "measured_tensions"):
        raise InvalidInput(f"run_player takes a Run, as cdprlab.run returns, got {type(run).__name__}")
    if view not in VIEWS:
        raise InvalidInput(f"view must be one of {', '.join(VIEWS)}, got {view!r}")
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


def _draw_limits(axes: Axes, low: Array, high: Array, end: float) -> None:
    """Each cable's limits as small brackets; in words where they are off the scale."""
    shown = [(k, limit) for k, limits in enumerate(zip(low, high)) for limit in limits if limit <= end]
    brackets = [[(limit, k + 0.6), (limit, k + 1.4)] for k, limit in shown]
    axes.add_collection(LineCollection(brackets, colors=INK, linewidths=1.6, linestyles=[(0, (1, 1))], zorder=3,
                                       animated=True), autolim=False)  # animated: over the bars, which are too
    names = ((r"$\tau_\mathrm{min}$", low), (r"$\tau_\mathrm{max}$", high))
    far = [f"{name} {_spread(limit)} N" for name, limit in names if (limit > end).any()]
    note = "dots: limits" + (f", off scale {', '.join(far)}" if far else "")
    axes.set_title(f"bar: measured · line: commanded · {note}", fontsize=9, fontweight="normal", color=GREY, loc="left")


def _spread(limits: Array) -> str:
    low, high = float(limits.min()), float(limits.max())
    return f"{low:g}" if low == high else f"{low:g} to {high:g}"
