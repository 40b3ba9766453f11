"""How long an explorer takes to answer a move: numbers, drawing and PNG together."""

import statistics
import time

import numpy as np
import pytest
from every_explorer import EVERY_EXPLORER

import cdprlab as cl
from cdprlab.course import Slider, run_player

PROMISED, WITH_ENGINE = 50.0, 100.0
"""Milliseconds of computation: what a hand on a slider does not feel as waiting; and where pymunk runs in between."""


def flight():
    return cl.run(cl.load_world("caroca"), duration=1.0)


EXPLORERS = {**EVERY_EXPLORER, "run player": lambda: run_player(flight())}


def moves(explorer, count):
    """Processor seconds of each of some moves along the diagonal of all sliders, the eye's too: the slowest way."""
    sliders = {name: control for name, control in explorer.controls.items() if isinstance(control, Slider)}
    taken = []
    for part in np.linspace(0, 1, count):
        values = {name: slider.low + float(part) * (slider.high - slider.low) for name, slider in sliders.items()}
        began = time.process_time()
        explorer.set(**values)
        taken.append(time.process_time() - began)
    return taken


@pytest.mark.parametrize("name", EXPLORERS)
def test_answer(benchmark, report, name):
    explorer = EXPLORERS[name]()
    moves(explorer, 5)  # fonts and caches are warm after the first
    report(f"{name}: one answer [ms] / 1 ms", 1e3 * statistics.median(moves(explorer, 60)),
           WITH_ENGINE if "pymunk" in name else PROMISED)
    benchmark(lambda: moves(explorer, 2))
    explorer.close()
