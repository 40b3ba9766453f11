"""The command line: what it writes, and one line with exit code 2 for what it cannot do."""

import csv
import os
import subprocess
import sys

import numpy as np
import pytest

import cdprlab as cl
from cdprlab.__main__ import main
from cdprlab.errors import MissingDependency

try:
    from cdprlab.simulate.bullet import import_pybullet

    import_pybullet()
    ENGINE = True
except MissingDependency:
    ENGINE = False


def test_worlds_lists_them(capsys):
    assert main(["worlds"]) == 0
    assert "caroca " in capsys.readouterr().out


@pytest.mark.skipif(not ENGINE, reason="PyBullet is not installed")
def test_run_writes_everything(tmp_path, capsys):
    out = tmp_path / "flight"
    assert main(["run", "caroca", "--duration", "0.4", "--out", str(out)]) == 0
    assert {p.name for p in out.iterdir()} == {"film.gif", "log.csv", "log.npz", "settings.json", "tensions.png",
                                               "tracking.png", "world.yaml"}
    assert (out / "film.gif").stat().st_size < 3e6
    printed = capsys.readouterr().out
    for quantity in ("tracking error, largest", "real-time factor", "infeasible steps"):
        assert quantity in printed


@pytest.mark.parametrize("pictures", [True, False])
def test_all_methods_side_by_side_need_no_engine(pictures, tmp_path, capsys):
    out = tmp_path / "compared"
    arguments = ["run", "planar_rigid", "--method", "all", "--out", str(out)]
    assert main(arguments + ([] if pictures else ["--no-pictures"])) == 0
    assert {path.name for path in out.iterdir()} == {"methods.csv", *(["methods.png"] if pictures else [])}
    with (out / "methods.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    printed = capsys.readouterr().out
    # One redundant cable: all of them apply, the kernel too.
    assert [row["method"] for row in rows] == list(cl.tension_methods())
    for row in rows:
        assert row["method"] in printed and float(row["solve_time [s]"]) > 0
        if float(row["feasible_share"]):
            assert float(row["smallest [N]"]) >= 5 and float(row["margin [N]"]) >= 0


@pytest.mark.parametrize("arguments, criterion", [
    (["planar_suspended", "--criterion", "static_equilibrium", "--step", "0.2"], cl.StaticEquilibrium()),
    (["caroca", "--criterion", "wrench_feasible,interference_free", "--step", "0.4", "--at", "0.5"],
     cl.WrenchFeasible() & cl.InterferenceFree()),
    (["caroca", "--volume", "--step", "0.7", "--push", "100"], cl.WrenchFeasible(half_widths=[100] * 3 + [0] * 3)),
])
def test_workspace_writes_map_table_and_data(arguments, criterion, tmp_path, capsys):
    out, kept = tmp_path / "workspace", tmp_path / "kept"
    assert main(["workspace", *arguments, "--out", str(out), "--checkpoint", str(kept)]) == 0
    assert {path.name for path in out.iterdir()} == {"table.csv", "workspace.csv", "workspace.npz", "workspace.png"}
    printed = capsys.readouterr().out
    with np.load(out / "workspace.npz") as data, (out / "workspace.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
        assert [int(row["inside"]) for row in rows] == data["inside"].astype(int).tolist()
        assert f"{data['inside'].sum()} of {len(rows)}" in printed and len(list(kept.iterdir())) == 1
        expected = cl.workspace(cl.load_world(arguments[0]).robot, cl.Pose(data["position"]), criterion)
        assert (data["inside"] == expected.inside).all() and data["inside"].any()


@pytest.mark.parametrize("arguments, message", [
    (["workspace", "caroca", "--plane", "xq"], "plane must be"),
    (["workspace", "caroca", "--criterion", "magic"], "unknown criterion 'magic'"),
    (["workspace", "caroca", "--criterion", "tipping_safe"], "this robot has none"),
    (["workspace", "planar_rigid", "--plane", "xy"], "choose a plane in space"),
    (["workspace", "planar_rigid", "--rpy", "0", "0", "1"], "takes angle="),
    (["workspace", "caroca", "--push", "-3"], "must not be negative"),
    (["run", "carroca"], "did you mean 'caroca'"),
    (["run", "caroca", "--task", "none"], "there are default"),
    (["run", "caroca", "--dt", "0"], "dt must be positive"),
    (["run", "caroca", "--duration", "-1"], "duration must be positive"),
    (["run", "caroca", "--method", "all", "--kp", "50"], "--kp has no say"),
    (["run", "caroca", "--method", "all", "--task", "none"], "there are default"),
    (["run", "caroca", "--control", "velocity"], "--control belongs to tasks of kind pick_and_place"),
    (["run", "fastkit_suspended", "--task", "pick_and_place", "--kp", "5"], "--kp has no say"),
])
def test_wrong_input_is_one_line_and_exit_2(arguments, message, capsys):
    assert main(arguments) == 2
    error = capsys.readouterr().err
    assert message in error and len(error.strip().splitlines()) == 1


@pytest.mark.parametrize("arguments", [["fly"], ["run"], ["run", "caroca", "--method", "magic"]])
def test_wrong_command_line_is_one_line_and_exit_2(arguments, capsys):
    with pytest.raises(SystemExit) as stop:
        main(arguments)
    assert stop.value.code == 2
    assert len(capsys.readouterr().err.strip().splitlines()) == 1


def test_a_reader_who_leaves_early_makes_no_noise():
    reading, writing = os.pipe()
    os.close(reading)                                       # as `head` does, once it has its lines
    command = [sys.executable, "-m", "cdprlab", "worlds"]
    left = subprocess.run(command, stdout=writing, stderr=subprocess.PIPE, timeout=60)
    os.close(writing)
    assert (left.returncode, left.stderr) == (141, b"")     # what a shell says of a broken pipe
