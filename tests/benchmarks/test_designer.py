"""How long the robot designer takes to answer an edit: reading, judging, drawing and PNG together."""

import statistics
import time

import numpy as np
import pytest

from cdprlab.course import robot_designer

PROMISED = 100.0
"""Milliseconds of computation an edit."""

WORLDS = ("caroca", "mobile_four_bases", "fastkit_suspended", "planar_rigid")


def edits(designer, count):
    """Processor seconds of each of some edits of an exit point, which change all that is shown."""
    taken, start = [], designer.world.robot.cables[0].exit_point[0]
    for part in np.linspace(0.01, 0.1, count):
        began = time.process_time()
        assert designer.do(designer.session.edit, ("cables", 0, "exit_point", 0), start + float(part))
        taken.append(time.process_time() - began)
    return taken


@pytest.mark.parametrize("name", WORLDS)
def test_edit(benchmark, report, name):
    designer = robot_designer(name)
    edits(designer, 5)  # fonts and caches are warm after the first
    report(f"designer, {name}: one edit [ms] / 1 ms", 1e3 * statistics.median(edits(designer, 30)), PROMISED)
    benchmark(lambda: edits(designer, 2))
    designer.close()
