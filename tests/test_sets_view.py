"""Pictures of sets: what is drawn is the set, said in words too."""

import numpy as np
import pytest
from matplotlib.figure import Figure

import cdprlab as cl
from cdprlab.course.pictures.set_charts import axis_label, axis_names, draw_capability, draw_polygon
from cdprlab.errors import InvalidInput
from robots import ROBOTS, random_pose


@pytest.fixture
def wrench_set():
    robot = ROBOTS["two bases"]()
    return cl.available_wrench_set(robot, random_pose(robot, 1))


def test_a_plane_set_is_drawn_as_its_vertices(wrench_set):
    shadow = wrench_set.project([0, 2])
    patch = draw_polygon(Figure().add_subplot(), shadow.vertices, label="free")
    np.testing.assert_allclose(patch.get_xy()[:-1], shadow.vertices)
    assert axis_label("f_x") == "$f_x$ [N]"


def test_a_chart_has_a_bar_an_axis_and_a_number_a_bar(wrench_set):
    reach = np.abs(wrench_set.component_range()).max(axis=1)
    panels = Figure().subplots(1, 2)
    for axes, group in zip(panels, ([0, 1, 2], [3, 4, 5])):
        draw_capability(axes, {"free": reach, "none": np.full(6, np.nan)}, axis_names("3R3T", "wrench"), group)
    heights = [bar.get_height() for axes in panels for bar in axes.containers[0]]
    np.testing.assert_allclose(heights, reach)
    assert [text.get_text() for text in panels[0].texts][-3:] == ["none"] * 3
    assert [axes.get_ylabel() for axes in panels] == ["[N]", "[N m]"]


@pytest.mark.parametrize("pattern", ["1T", "2T", "1R2T", "3T", "2R3T", "3R3T"])
def test_every_pattern_has_named_axes_with_units(pattern):
    for quantity in ("twist", "wrench"):
        assert len(axis_names(pattern, quantity)) == cl.robot.MOTION_PATTERNS[pattern].n_dof
        assert all(axis_label(name).endswith("]") for name in axis_names(pattern, quantity))


def test_unknown_quantities_have_no_axes():
    with pytest.raises(InvalidInput, match="quantity must be"):
        axis_names("3R3T", "power")
