"""Logs read again: what a run saved comes back, and a real robot's units and headings become a run."""

from dataclasses import replace

import numpy as np
import pytest

import cdprlab as cl
from cdprlab.errors import InvalidInput

LENGTHS = [f"L{i}" for i in range(8)]
HEADINGS = ["t", "X", "Y", "Z", "roll", "pitch", "yaw", *LENGTHS, *(f"F{i}" for i in range(8))]
COLUMNS = {"time [ms]": "t", "position [mm]": HEADINGS[1:4], "rotation [deg]": HEADINGS[4:7], "length [cm]": LENGTHS,
           "measured_tension [kN]": HEADINGS[15:]}


@pytest.fixture
def world():
    return cl.load_world("caroca")


def robot_log(world, path, count=30):
    """Poses, lengths and tensions of a robot whose exit points are 20 mm off, in a robot's own units and headings."""
    rng = np.random.default_rng(0)
    poses = cl.Pose(rng.uniform(-1, 1, (count, 3)) + [0, 0, 1.5], rng.uniform(-0.3, 0.3, (count, 3)))
    real = replace(world.robot, cables=tuple(replace(cable, exit_point=cable.exit_point + rng.uniform(-0.02, 0.02, 3))
                                             for cable in world.robot.cables))
    tensions = rng.uniform(100, 900, (count, 8))
    table = np.column_stack([20.0 * np.arange(count), 1e3 * poses.position, np.degrees(poses.rpy),
                             100 * cl.cable_lengths(real, poses), 1e-3 * tensions])
    np.savetxt(path, table, delimiter=",", header=",".join(HEADINGS), comments="")
    return real, poses, tensions


def test_units_and_headings_of_a_real_robot(world, tmp_path):
    real, poses, tensions = robot_log(world, tmp_path / "robot.csv")
    log = cl.read_log(tmp_path / "robot.csv", COLUMNS, world)
    np.testing.assert_allclose(log.time, 0.02 * np.arange(30), atol=1e-12)
    np.testing.assert_allclose(log.poses.position, poses.position, atol=1e-12)
    np.testing.assert_allclose(log.poses.rotation, poses.rotation, atol=1e-12)
    np.testing.assert_allclose(log.measured_tensions, tensions, atol=1e-9)
    found = cl.calibrate(world.robot, log.poses, log.lengths)
    np.testing.assert_allclose(found.robot.exit_points, real.exit_points, atol=1e-6)


@pytest.mark.filterwarnings("error")
def test_a_log_is_plotted_and_stands_beside_a_run(world, tmp_path):
    robot_log(world, tmp_path / "robot.csv")
    log = cl.read_log(tmp_path / "robot.csv", COLUMNS, world)
    assert "no reference is known" in cl.plot(log).alt_text
    lengths = cl.read_log(tmp_path / "robot.csv", {"length [cm]": LENGTHS}, world)
    assert "No tensions are known" in cl.plot(lengths).alt_text and np.isnan(lengths.poses.position).all()
    figure = cl.plot(cl.run(world, duration=0.02), beside=log)
    crosses = [line for panel in figure.axes for line in panel.lines if line.get_marker() == "x"]
    assert len(crosses) == 3 + 8
    np.testing.assert_array_equal(crosses[2].get_ydata(), log.poses.position[:, 2])
    with pytest.raises(InvalidInput, match="beside must be a Run"):
        cl.plot(log, beside=3)


@pytest.mark.parametrize(("name", "cables"), [("planar_rigid", "tension"), ("caroca", "length"),
                                              ("marionet", "tension")])
def test_what_a_run_saved_is_read_back(name, cables, tmp_path):
    run = cl.run(cl.load_world(name), cables=cables, duration=0.05)
    log = cl.read_log(run.save(tmp_path / "run") / "log.csv")
    for column in ("time", "lengths", "measured_tensions", "commanded_tensions", "errors", "twists", "feasible"):
        expected = np.asarray(getattr(run, column), dtype=float)
        np.testing.assert_allclose(getattr(log, column), expected, rtol=1e-8, atol=1e-8, err_msg=column)
    np.testing.assert_allclose(log.reference.pose.rotation, run.reference.pose.rotation, atol=1e-8)
    assert (log.commanded_lengths is None) == (run.commanded_lengths is None)
    assert log.world.robot.n_cables == run.world.robot.n_cables and log.dt == pytest.approx(run.dt)


@pytest.mark.filterwarnings("ignore::cdprlab.errors.CdprWarning")
def test_a_log_says_all_that_a_run_did(tmp_path):
    """What was sensed and estimated, of motors and driven bases, of the real robot, and how it was flown."""
    world = cl.load_world("fastkit_suspended")
    runs = [cl.run(world, duration=0.02, cables="elastic", real=cl.perturbed(world, exit_points=0.01, seed=1),
                   sensors=cl.Sensors(position_noise=1e-3, length_noise=1e-3, tension_noise=0.5)),
            cl.run(cl.load_world("planar_mcdpr"), duration=0.02, base_speeds=[0, 0.1, 0, 0, 0, 0])]
    for number, run in enumerate(runs):
        log = cl.read_log(run.save(tmp_path / str(number)) / "log.csv")
        assert log.columns().keys() == run.columns().keys()
        for name, (values, unit) in run.columns().items():
            kept, own = log.columns()[name]
            np.testing.assert_allclose(kept, values, rtol=1e-8, atol=1e-8, err_msg=name)
            assert unit == own
        assert (log.task, log.method, log.cables) == (run.task, run.method, run.cables)
        assert (log.real is None) == (run.real is None) and log.settings["control_period"] == run.control_period
    np.testing.assert_allclose(cl.read_log(tmp_path / "0" / "log.csv").real.robot.exit_points,
                               runs[0].real.robot.exit_points)


@pytest.mark.parametrize(("columns", "message"), [
    ({"length [inch]": LENGTHS}, "in m or cm or mm, got .* in 'inch'"),
    ({"length [mm]": LENGTHS[:7]}, "length of this robot must be 8 of the columns t, X"),
    ({"length [mm]": [*LENGTHS[:7], "L9"]}, "length of this robot must be 8 of the columns t, X"),
    ({"tension [N]": LENGTHS}, "no quantity 'tension'; there are time, position"),
    ({"length": LENGTHS}, "in m or cm or mm"),
])
def test_columns_that_are_none_are_named(columns, message, world, tmp_path):
    robot_log(world, tmp_path / "robot.csv")
    with pytest.raises(InvalidInput, match=message):
        cl.read_log(tmp_path / "robot.csv", columns, world)


@pytest.mark.parametrize(("text", "message"), [
    ("", "must hold a row of headings and rows of numbers"),
    ("time [s]\n", "must hold a row of headings and rows of numbers"),
    ("a,b\n1,2\n", "tells nothing of a run"), ("time [s],time [s]\n1,2\n", "each heading once"),
    ("time [s]\ninf\n", "at most 1e"), ("time [s]\n" + "1" * 200_000, "cannot read .*limit"),
    ("time [s],x\n1,2\n3\n", r"row 2 of .* must be 2 numbers, got \['3'\]"),
    ("time [s],x\n1,2\n3,four\n", "row 2 of .* must be 2 numbers"),
])
def test_files_that_are_no_logs_say_where(text, message, world, tmp_path):
    path = tmp_path / "log.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InvalidInput, match=message):
        cl.read_log(path, world=world)
    with pytest.raises(InvalidInput, match="say whose robot it is"):
        cl.read_log(path)


def test_cells_that_are_empty_are_not_known(world, tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("time [s]," + ",".join(f"length_{i + 1} [m]" for i in range(8)) + "\n0" + ",1.5" * 8 + "\n1"
                    + ",2.5" * 7 + ",\n", encoding="utf-8")
    log = cl.read_log(path, world=world)
    assert np.isnan(log.lengths[1, 7]) and log.lengths[1, 6] == 2.5
    with pytest.raises(InvalidInput, match="poses must be"):
        cl.calibrate(world.robot, log.poses, np.ones((2, 8)))
