"""How long an explorer takes to answer a move: numbers, drawing and PNG together."""

import statistics
import time

import pytest
from every_explorer import EVERY_EXPLORER

from cdprlab.course import Slider

PROMISED, WITH_ENGINE = 50.0, 100.0
"""Milliseconds of computation: what a hand on a slider does not feel as waiting; and where pymunk runs in between."""


def moves(explorer, name, count=20):
    """Processor seconds of each of some moves of one control from end to end; then it is back at its start."""
    control, taken = explorer.controls[name], []
    for k in range(count):
        value = control.low + k / (count - 1) * (control.high - control.low) if isinstance(control, Slider) \
            else control.options[k % len(control.options)]
        began = time.process_time()
        explorer.set(**{name: value})
        taken.append(time.process_time() - began)
    explorer.reset()
    return taken


@pytest.mark.parametrize("name", EVERY_EXPLORER)
def test_answer(benchmark, report, name):
    """The slowest control's median."""
    explorer = EVERY_EXPLORER[name]()
    first = next(iter(explorer.controls))
    moves(explorer, first, 5)  # fonts and caches are warm after the first
    medians = {control: 1e3 * statistics.median(moves(explorer, control)) for control in explorer.controls}
    slowest = max(medians, key=medians.get)
    report(f"{name}, {slowest}: one answer [ms] / 1 ms", medians[slowest],
           WITH_ENGINE if "pymunk" in name else PROMISED)
    benchmark(lambda: moves(explorer, first, 2))
    explorer.close()
