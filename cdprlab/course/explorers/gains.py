"""Gains and clock at one's fingertips: how an error dies out under K_p and K_d, sampled every Δt."""

from typing import Annotated, Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from ...arrays import Array, checked
from ...view.style import BLUE, GREY, INK, VERMILION
from .explorer import Explorer, Values, movable, once_a_move, sliders

START = 10.0
"""The error at the start, at rest [mm]."""

_GONE = 1e6
"""An error so many times the first is off every picture."""


class Stability(NamedTuple):
    """How a sampled loop behaves.

    poles : (2,) complex, eigenvalues of the step matrix
    stable : both inside the unit circle
    largest_kd : stable below it, for this K_p and Δt [1/s]
    """

    poles: Any
    stable: bool
    largest_kd: float


def step_matrix(kp: float, kd: float, dt: float) -> Array:
    """[e; ė] → the same one step of a semi-implicit engine later: ė ← ė − Δt (K_d ė + K_p e), then e ← e + Δt ė.

    kp, kd : [1/s²], [1/s]
    dt : Δt, the control and engine step [s]
    Returns (2, 2).

    >>> step_matrix(64.0, 24.0, 0.125)
    array([[ 0.  , -0.25],
           [-8.  , -2.  ]])
    """
    return np.array([[1 - kp * dt**2, dt * (1 - kd * dt)], [-kp * dt, 1 - kd * dt]])


def judge(kp: float, kd: float, dt: float) -> Stability:
    """Poles of z² − (2 − K_d Δt − K_p Δt²) z + (1 − K_d Δt), inside the circle if K_p > 0 < K_d < 2/Δt − K_p Δt/2.

    kp, kd : [1/s²], [1/s]
    dt : [s]

    >>> judge(100.0, 800.0, 1e-3).stable, judge(100.0, 800.0, 1 / 240).stable
    (True, False)
    """
    poles = np.linalg.eigvals(step_matrix(kp, kd, dt)).astype(complex)
    largest = 2 / dt - kp * dt / 2
    return Stability(poles, bool(kp > 0 and 0 < kd < largest), largest)


def sampled_error(kp: float, kd: float, dt: float, count: int) -> Array:
    """The error at 0, Δt, 2Δt, …, first 1 and at rest, as an engine in steps of Δt has it.

    count : how many; entries past a millionfold are NaN
    Returns (count,).

    >>> sampled_error(64.0, 12.0, 0.125, 4)
    array([ 1.  ,  0.  ,  0.5 , -0.25])
    """
    states, power = np.array([[1.0], [0.0]]), step_matrix(kp, kd, dt)
    with np.errstate(over="ignore", invalid="ignore"):
        while states.shape[1] < count:  # twice as many each time: A^k carries the first k states to the next k
            states, power = np.concatenate([states, power @ states], axis=1), power @ power
    error = states[0, :count]
    error[np.logical_or.accumulate(~(np.abs(error) < _GONE))] = np.nan
    return error


@checked
def error_decay(kp: Annotated[float, "[1/s²] ≥ 0"], kd: Annotated[float, "[1/s] ≥ 0"],
                times: Annotated[Array, "(…) [s]"]) -> Array:
    """e(t) of ë + K_d ė + K_p e = 0 with e(0) = 1, ė(0) = 0: what an infinitely fast clock would give.

    kp, kd : K_p ≥ 0, K_d ≥ 0 [1/s²], [1/s]
    times : (…) [s]
    Returns (…).

    >>> error_decay(100.0, 20.0, [0.0, 0.1]).round(4)
    array([1.    , 0.7358])
    """
    half, root = kd / 2, np.emath.sqrt(kd**2 / 4 - kp)
    if abs(root) < 1e-6 * (1 + half):
        return (1 + half * times) * np.exp(-half * times)
    slow, fast = -half + root, -half - root
    if slow.imag == 0 and half > 0:
        slow = kp / fast  # no cancellation
    return np.real((fast * np.exp(slow * times) - slow * np.exp(fast * times)) / (fast - slow))


def damping_ratio(kp: float, kd: float) -> float:
    """ζ = K_d / (2 √K_p); infinite where nothing pulls back.

    >>> damping_ratio(100.0, 20.0)
    1.0
    """
    return kd / (2 * kp**0.5) if kp > 0 else float("inf")


@checked
class GainExplorer(Explorer):
    """An error of 10 mm under K_p and K_d: sampled and continuous, poles in the unit circle, verdict in words.

    kp, kd : at the start, 0 to 2000 [1/s²], [1/s]
    dt : control and engine step, 0.2 to 20 [ms]
    span : time shown, 0.05 to 6 [s]
    Raises InvalidInput outside these ranges.

    >>> explorer = gain_explorer()
    >>> explorer.set(kd=800, dt=4.2)
    >>> print(explorer.text.splitlines()[1])
    verdict               UNSTABLE: K_d is too large for this clock
    """

    def __init__(self, kp: float = 100.0, kd: float = 100.0, dt: float = 1.0,
                 span: float = 3.0) -> None:
        super().__init__(sliders("gains", kp=kp, kd=kd, dt=dt, span=span),
                         "Gains and the clock", (6.2, 4.0))

    @once_a_move
    def error(self, values: Values) -> Array:
        """(k,) at 0, Δt, 2Δt, … up to the time shown [mm]."""
        kp, kd, dt = _loop(values)
        return START * sampled_error(kp, kd, dt, int(values["span"] / dt) + 1)

    def build(self, figure: Figure) -> None:
        """Left the error over time, right the unit circle."""
        self._time, circle = figure.subplots(1, 2, width_ratios=[1.3, 1])
        self._time.set(ylim=(-1.3 * START, 1.3 * START), xlabel="time [s]",
                       ylabel="error e [mm]",
                       title="A first error of 10 mm")
        for line in (self._time.axhline, circle.axhline, circle.axvline):
            line(0, color=GREY, linewidth=0.7)
        self._sampled = movable(self._time, "o-", color=BLUE, markersize=3.5, linewidth=1.0,
                                         label="sampled every Δt")
        self._smooth = movable(self._time, color=INK, linewidth=1.6, linestyle=(0, (5, 2)),
                                        label="ë + K_d ė + K_p e = 0")
        self._time.legend(loc="lower right")
        circle.add_patch(Circle((0, 0), 1, facecolor="#EAF3F8", edgecolor=INK, linewidth=1.2))
        circle.set(xlim=(-2, 2), ylim=(-2, 2), aspect="equal", xlabel="real part of z [–]",
                   ylabel="imaginary part of z [–]", title="Poles in the circle")
        self._inside = movable(circle, "x", color=BLUE, markersize=11, markeredgewidth=2.6,
                               label="inside: dies out")
        self._outside = movable(circle, "D", color=VERMILION, markersize=10,
                                label="on or outside: does not")
        self._far = circle.text(0, -1.85, "", ha="center", fontsize=9, color=VERMILION,
                                animated=True)
        figure.legend(handles=[self._inside, self._outside], loc="outside lower right", ncols=2,
                      fontsize=9)

    def numbers(self, values: Values) -> dict[str, Any]:
        """Poles, damping, the limit for K_d, and the verdict in words."""
        kp, kd, dt = _loop(values)
        verdict, zeta = judge(kp, kd, dt), damping_ratio(kp, kd)
        largest, last = verdict.largest_kd, self.error(values)[-1]
        return {
            "K_d Δt": f"{kd * dt:.3f}",
            "verdict": _words(kp, kd, verdict),
            "stable for K_d below": f"{largest:.1f} 1/s" if largest > 0
            else "none, K_p Δt² ≥ 4",
            "poles z": "  ".join(f"{z.real:.4f}" + (f"{z.imag:+.4f}i" if z.imag else "")
                                 for z in verdict.poles),
            "largest |z|": f"{np.abs(verdict.poles).max():.4f}",
            "damping ratio ζ": f"{zeta:.2f}" if np.isfinite(zeta) else "–",
            "error at the end": f"{last:.3f} mm" if abs(last) < 1e4 else "beyond 10 m",
            "same, Δt → 0": f"{START * error_decay(kp, kd, values['span']):.3f} mm",
        }

    def draw(self, values: Values) -> None:
        """Both curves and both poles."""
        (kp, kd, dt), span, error = _loop(values), values["span"], self.error(values)
        if self._time.get_xlim() != (0.0, span):  # moved axes are drawn anew, all else is not
            self._time.set_xlim(0.0, span)
        self._sampled.set_data(np.arange(error.size) * dt,
                               np.clip(error, -100 * START, 100 * START))
        self._sampled.set_marker("o" if error.size <= 120 else "")
        along = np.linspace(0, span, 400)
        self._smooth.set_data(along, START * error_decay(kp, kd, along))
        poles, shown = judge(kp, kd, dt).poles, 1.9
        size = np.abs(poles)
        out, placed = size >= 1 - 1e-9, poles * shown / np.maximum(size, shown)
        for marks, which in ((self._inside, ~out), (self._outside, out)):
            marks.set_data(placed[which].real, placed[which].imag)
        self._far.set_text(f"off the picture: |z| = {size.max():.1f}"
                           if size.max() > shown else "")

    def describe(self, values: Values) -> str:
        """One sentence for those who do not see the picture."""
        kp, kd, dt = _loop(values)
        verdict = judge(kp, kd, dt)
        return (f"Error over {values['span']:g} s and poles for K_p {kp:g} 1/s², K_d {kd:g} 1/s, "
                f"Δt {values['dt']:g} ms: {_words(kp, kd, verdict)}; largest |z| {np.abs(verdict.poles).max():.3f}")


gain_explorer = GainExplorer


def _loop(values: Values) -> tuple[float, float, float]:
    return values["kp"], values["kd"], 1e-3 * values["dt"]


def _words(kp: float, kd: float, verdict: Stability) -> str:
    if kp == 0:
        return "NOT STABLE: without K_p nothing pulls the error back"
    if kd == 0:
        return "NOT STABLE: without K_d nothing brakes"
    if not verdict.stable:
        return "UNSTABLE: K_d is too large for this clock"
    if min(verdict.poles.real) < 0:
        return "stable, but it chatters from step to step"
    zeta = damping_ratio(kp, kd)
    return "stable, " + ("swings" if zeta < 0.7 else "creeps" if zeta > 2 else "well damped")
