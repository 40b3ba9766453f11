"""The picture of lesson 05: ``python docs/lesson_pictures/05_dynamics_and_control.py`` writes it into the lesson."""

from io import BytesIO

import numpy as np
from attachment import attach
from matplotlib.figure import Figure
from PIL import Image

from cdprlab.course.explorers.gains import error_decay, sampled_error
from cdprlab.view.style import BLUE, GREEN, GREY, INK, VERMILION, house_style


def damping(panel):
    """Three gains: the error swings, dies out, creeps."""
    t = np.linspace(0, 1, 300)
    for kd, color, dashes, words, place in ((4, VERMILION, (0, (5, 2)), "swings", (0.47, -4.8)),
                                            (20, BLUE, "solid", "just right", (0.27, 2.9)),
                                            (80, GREEN, (0, (1.5, 1.5)), "creeps", (0.62, 5.3))):
        panel.plot(t, 10 * error_decay(100, kd, t), color=color, linestyle=dashes, linewidth=2)
        panel.annotate(f"{words}\n$K_d$ = {kd}", place, color=color, fontsize=10, ha="left")
    panel.set(title="$K_p$ = 100: how an error of 10 mm dies", xlim=(0, 1))


def clock(panel):
    """One gain, two clocks."""
    for dt, color, marker in ((0.038, BLUE, "o"), (0.0425, VERMILION, "s")):
        error = 10 * sampled_error(400, 40, dt, 26)
        panel.plot(np.arange(error.size) * dt, error, marker + "-", color=color, markersize=3.5, linewidth=1)
    panel.annotate("$\\Delta t$ = 38 ms: dies out", (0.33, -9.5), color=BLUE, fontsize=10)
    panel.annotate("$\\Delta t$ = 42.5 ms: grows", (0.33, 11.0), color=VERMILION, fontsize=10)
    panel.set(title="$K_p$ = 400, $K_d$ = 40: two clocks", xlim=(0, 1), ylim=(-14, 14))


def png():
    """The picture as a palette PNG, below 60 kB."""
    with house_style():
        figure = Figure(figsize=(8.6, 3.1), dpi=110, layout="constrained")
        left, right = figure.subplots(1, 2)
        damping(left)
        clock(right)
        for panel in (left, right):
            panel.axhline(0, color=GREY, linewidth=0.8)
            panel.set_xlabel("time [s]", color=INK)
            panel.set_ylabel("error [mm]", color=INK)
        drawn, packed = BytesIO(), BytesIO()
        figure.savefig(drawn, dpi=110)
    Image.open(drawn).convert("RGB").quantize(64).save(packed, "png", optimize=True)
    return packed.getvalue()


if __name__ == "__main__":
    attach("05_dynamics_and_control", "dynamics_and_control.png", png())
