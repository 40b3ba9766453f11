"""Comparisons along a path: the numbers are those of the tensions, jumps are told from slopes."""

from dataclasses import replace

import numpy as np
import pytest

import cdprlab as cl
from cdprlab.errors import InvalidInput
from cdprlab.run.compare import compare_tensions, step_shrinks


@pytest.fixture(scope="module")
def table():
    return compare_tensions(cl.load_world("caroca_light"))


def test_columns_are_those_of_the_tensions(table):
    robot, job = table.world.robot, table.world.task()
    assert table.time[-1] == job.duration and table.tensions.shape == (len(table.method), table.time.size, 8)
    assert set(table.method) == set(cl.tension_methods()) - {"kernel"}
    dt = table.time[1]
    for k, row in enumerate(table.rows()):
        good, tau = table.feasible[k], table.tensions[k]
        assert row["feasible_share"] == good.mean() and row["solve_time"] > 0
        if good.all():
            assert row["energy"] == pytest.approx((tau[1:] ** 2 + tau[:-1] ** 2).sum() * dt / 2, rel=1e-9)
            assert row["largest_step"] == pytest.approx(np.abs(np.diff(tau, axis=0)).max())
            assert row["margin"] == pytest.approx(min((tau - robot.tension_min).min(), (robot.tension_max - tau).min()))
        elif not good.any():
            assert np.isnan([row[name] for name in ("smallest", "largest", "energy", "largest_step", "margin")]).all()


def test_the_wrench_is_that_of_the_motion(table):
    """Newton and Euler on finite differences of the path: force and moment about the center of mass, which is P."""
    robot, path, h = table.world.robot, table.world.task().trajectory(), 1e-4
    for k in (100, 150, 300):
        before, now, after = (path(table.time[k] + s * h) for s in (-1, 0, 1))
        force = robot.mass * ((after.twist - before.twist)[:3] / (2 * h) + [0, 0, robot.gravity])
        inertia = [pose.pose.rotation @ robot.platform.inertia @ pose.pose.rotation.T @ pose.twist[3:]
                   for pose in (before, after)]
        wanted = np.concatenate([force, (inertia[1] - inertia[0]) / (2 * h)])
        W = cl.wrench_matrix(robot, now.pose)
        for name in ("quadratic_program", "barycenter", "linear_program"):
            tau = table.tensions[table.method.index(name), k]
            np.testing.assert_allclose(W @ tau, wanted, atol=1e-6)


def test_energy_and_smoothness_order_the_methods(table):
    rows = {row["method"]: row for row in table.rows()}
    least = rows["quadratic_program"]
    whole = [row for row in rows.values() if row["feasible_share"] == 1]
    assert all(row["energy"] >= least["energy"] * (1 - 1e-9) for row in whole)
    assert least["continuous"] and rows["barycenter"]["continuous"]


def test_a_jump_is_told_from_a_slope(table):
    """A made-up method that switches in the middle of a sample, and one as steep as that but smooth."""
    robot, path, span = table.world.robot, table.world.task().trajectory(), table.time[200:202]
    ends = [cl.wrench_matrix(robot, path(t).pose)[0, 0] for t in span]

    def share(W):
        return (W[0, 0] - ends[0]) / (ends[1] - ends[0])

    def jump(W, w_e):
        return np.full(8, 100.0 + 50 * (share(W) > 0.4)), ""

    def slope(W, w_e):
        return np.full(8, 100.0 + 50 * share(W)), ""

    assert not step_shrinks(robot, path, span, jump, 50.0) and step_shrinks(robot, path, span, slope, 50.0)


def test_a_slope_stays_a_slope_when_sampled_coarsely():
    coarse = compare_tensions(cl.load_world("caroca_light"), methods="quadratic_program", time_step=0.4)
    assert coarse.time.size == 11 and coarse.continuous.all() and coarse.method == ("quadratic_program",)


def test_it_prints_as_a_table(table):
    lines = str(table).splitlines()
    assert len(lines) == 1 + len(table.method) and lines[0].split()[:2] == ["method", "feasible"]
    assert any(line.startswith("closed_form") and "0 %" in line and "–" in line for line in lines)


def test_the_figure_shows_every_method_and_says_so(table, tmp_path):
    table = replace(table, continuous=np.array([name != "puncture" for name in table.method]))
    figure = cl.plot(table)
    titles = [panel.get_title(loc="left") for panel in figure.axes]
    assert [name.replace("_", " ") for name in table.method] == [title for title in titles if title]
    labels = " ".join(panel.get_xlabel() + panel.get_ylabel() for panel in figure.axes)
    assert all(unit in labels for unit in ("[N]", "[s]", "[µs]", "[N² s]"))
    for name in table.method:
        assert name.replace("_", " ") in figure.alt_text
    assert "closed form never feasible" in figure.alt_text and "jumps" in figure.alt_text
    figure.savefig(tmp_path / "comparison.png")
    assert (tmp_path / "comparison.png").stat().st_size > 20_000


@pytest.mark.parametrize("change, says", [
    ({"methods": ["guess"]}, "unknown tension method"), ({"methods": []}, "at least one"),
    ({"time_step": 0}, "time_step"), ({"task": "none"}, "has no task")])
def test_what_cannot_be_compared(change, says):
    with pytest.raises(InvalidInput, match=says):
        compare_tensions(cl.load_world("caroca_light"), **change)
