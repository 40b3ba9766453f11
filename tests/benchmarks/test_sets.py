"""What sets cost: a slider's redraw, a chart of the FASTKIT, and hyperplane shifting beside Qhull."""

import dataclasses
import itertools
import statistics
import time

import numpy as np
import pytest
from matplotlib.figure import Figure
from scipy.spatial import ConvexHull

import cdprlab as cl
from cdprlab.course.pictures.set_charts import draw_polygon
from cdprlab.view.picture import Picture

ROUNDS = 25


def seconds(function):
    """Median processor time of some rounds, the first not counted: others on the machine do not count either."""
    function()
    times = []
    for _ in range(ROUNDS):
        began = time.process_time()
        function()
        times.append(time.process_time() - began)
    return statistics.median(times)


@pytest.fixture
def planar():
    """A point on four cables between two bases, as in Rasheed et al. 2018, sec. 4.1, and its picture."""
    bases = [cl.Base(name, [x, 0.0], 0.0, 40.0, [0.0, 0.5], [[-0.4, 0], [0.4, 0]], [0.0, 0.8, 0.0])
             for name, x in (("left", 0.0), ("right", 2.0))]
    cables = [cl.Cable([0.0, height], [0.0, 0.0], 0.0, 100.0, 2.0, base=base.name)
              for base in bases for height in (0.25, 2.0)]
    platform = cl.Platform(1.0, 0.01, [0, 0], [0.1, 0.1], [0, 0])
    return cl.Robot(cl.robot.MOTION_PATTERNS["2T"], platform, tuple(cables), tuple(bases))


def test_planar_twist_set_at_a_slider(benchmark, report, planar):
    """The bases' speed limit changes: robot and set anew, the polygon moved over the fixed one, the picture as PNG."""
    figure = Figure((5, 4), dpi=100)
    axes = figure.add_subplot()
    axes.set(xlim=(-4, 4), ylim=(-4, 4))
    pose, speeds = cl.Pose([1.0, 1.6]), itertools.cycle(np.linspace(0.1, 0.8, 8))
    draw_polygon(axes, cl.available_twist_set(planar, pose, "none").vertices, 1)
    patch = draw_polygon(axes, np.eye(2))
    patch.set_animated(True)
    picture = Picture(figure)

    def redraw():
        speed = next(speeds)
        bases = tuple(dataclasses.replace(b, speed_max=[0.0, speed, 0.0]) for b in planar.bases)
        patch.set_xy(cl.available_twist_set(dataclasses.replace(planar, bases=bases), pose).vertices)
        picture.png()

    report("planar twist set redrawn at a slider / 10 ms", seconds(redraw) / 0.010, 1)
    benchmark(redraw)


def test_fastkit_chart_with_tipping(benchmark, report):
    """24 supports: twist with the active base moving and wrench with tipping, six axes both ways."""
    robot, pose = cl.load_world("fastkit_suspended").robot, cl.Pose([0.8, 0.0, 0.9], rpy=[0.05, -0.03, 0.1])

    def chart():
        return (cl.available_twist_set(robot, pose).component_range(),
                cl.available_wrench_set(robot, pose, tipping=True).component_range())

    report("FASTKIT chart, 24 supports with tipping / 50 ms", seconds(chart) / 0.050, 1)
    benchmark(chart)


def test_wrench_facets_by_hyperplane_shifting(benchmark, report):
    """All facets of one 6 × 8 set, from robot and pose to rows, beside the hull of its 2⁸ vertices."""
    robot, pose = cl.load_world("caroca").robot, cl.Pose([0.3, 0.2, 1.0], rpy=[0.1, 0.0, -0.2])
    tensions = np.array(list(itertools.product(*zip(robot.tension_min, robot.tension_max))))
    corners = tensions @ cl.wrench_matrix(robot, pose).T

    def shifting():
        return cl.available_wrench_set(robot, pose).normals

    ratio = seconds(shifting) / seconds(lambda: ConvexHull(corners))
    report("50 hyperplane shiftings / Qhull on 2⁸ vertices", 50 * ratio, 1)
    benchmark(shifting)
