"""A formula beside what it is compared with: the lower panel is the difference of the upper one's lines."""

import matplotlib.pyplot as plt
import numpy as np
import pytest

from cdprlab.course.pictures.flights import plot_comparison
from cdprlab.errors import InvalidInput


@pytest.fixture(autouse=True)
def _closed():
    yield
    plt.close("all")


def test_the_residual_is_second_minus_first():
    rng = np.random.default_rng(3)
    x, pairs = np.arange(20.0), {name: tuple(rng.normal(size=(2, 20))) for name in "abc"}
    above, below = plot_comparison(x, pairs, "time [s]", "force [N]").axes
    lines = {line.get_label(): line.get_ydata() for line in below.lines}
    for name, (first, second) in pairs.items():
        np.testing.assert_array_equal(lines[name], second - first)
    assert len(above.lines) == 6
    assert (below.get_xlabel(), below.get_ylabel()) == ("time [s]", "residual [N]")


def test_lines_of_one_panel_differ_by_more_than_color():
    pairs = {name: (np.zeros(3), np.zeros(3)) for name in "abc"}
    below = plot_comparison(np.arange(3), pairs, "x [m]", "y [m]").axes[1]
    named = [line for line in below.lines if line.get_label() in pairs]
    assert len({str(line._unscaled_dash_pattern) for line in named}) == 3


def test_lengths_must_agree():
    with pytest.raises(InvalidInput, match="one value for each x"):
        plot_comparison([0, 1], {"z": ([0, 1], [0, 1, 2])}, "x", "y")
