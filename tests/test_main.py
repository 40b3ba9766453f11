"""The command line: what it writes, and one line with exit code 2 for what it cannot do."""

import csv
import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import cdprlab as cl
from cdprlab import view
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
    assert {p.name for p in out.iterdir()} == {"film.gif", "log.csv", "log.npz", "scene.html", "settings.json",
                                               "tensions.png", "tracking.png", "world.yaml"}
    assert (out / "film.gif").stat().st_size < 3e6 and (out / "scene.html").stat().st_size < 3e6
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
    (["caroca", "--plane", "yx", "--step", "0.7", "--criterion", "dynamic_equilibrium"],
     cl.DynamicEquilibrium([1, 1, 1, 0, 0, 0])),
    (["fastkit_suspended", "--criterion", "twist_feasible,statically_stable", "--step", "0.7"],
     cl.TwistFeasible(half_widths=[1, 1, 1, 0, 0, 0], moving="all") & cl.StaticallyStable()),
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
    (["run", "carroca"], "did you mean 'caroca'"),
    (["run", "caroca", "--task", "none"], "there are default"),
    (["run", "caroca", "--dt", "0"], "dt must be positive"),
    (["run", "caroca", "--duration", "-1"], "duration must be positive"),
    (["run", "caroca", "--method", "all", "--dt", "0.01"], "--dt has no say"),
    (["run", "caroca", "--method", "all", "--task", "none"], "there are default"),
    (["run", "caroca", "--control", "velocity"], "--control belongs to tasks of kind pick_and_place"),
    (["run", "fastkit_suspended", "--task", "pick_and_place", "--dt", "5"], "--dt has no say"),
    (["run", "caroca", "--cables", "length", "--infeasible", "hold"], "--infeasible has no say"),
    (["run", "planar_point", "--duration", "1e9"], "control step"),
    (["run", "planar_point", "--duration", "0.05", "--dt", "1"], "control step"),
    (["run", "planar_point", "--duration", "0.05", "--dt", "1e-300"], "dt must be at least 1e-30"),
    (["run", "planar_point", "--out", ""], "a path must be text"),
    (["run", "planar_point", "--out", __file__], "something else has that name"),
    (["run", "x" * 3000], "cannot read"),
    (["run", ""], "unknown world ''"),
    (["workspace", "planar_rigid", "--step", "0"], "step must be positive"),
    (["workspace", "planar_rigid", "--step", "1e-9"], "at most 1e+08 poses"),
    (["workspace", "planar_rigid", "--step", "1", "--jobs", "0"], "n_jobs must be"),
    (["workspace", "planar_rigid", "--at", "1"], "choose a plane in space"),
    (["workspace", "planar_rigid", "--step", "1", "--checkpoint", ""], "a path must be text"),
    (["workspace", "caroca", "--plane", ""], "plane must be"),
    (["workspace", "caroca", "--at", "inf"], "at must be finite"),
])
def test_wrong_input_is_one_line_and_exit_2(arguments, message, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(arguments) == 2
    error = capsys.readouterr().err
    assert message in error and len(error.strip().splitlines()) == 1 and len(error) < 600


@pytest.mark.parametrize("arguments", [
    [], ["fly"], ["run"], ["run", "caroca", "--method", "magic"], ["run", "caroca", "--task", "a\nb", "--dt", "1_"],
    ["run", "caroca", "--method", "x" * 3000], ["run", "caroca", "a\nb"], ["workspace", "caroca", "--jobs", "2.5"],
])
def test_wrong_command_line_is_one_line_and_exit_2(arguments, capsys):
    with pytest.raises(SystemExit) as stop:
        main(arguments)
    assert stop.value.code == 2
    error = capsys.readouterr().err
    assert len(error.strip().splitlines()) == 1 and len(error) < 1000


WORDS = {"run": {"--task": ["default", "x", "", "mission"], "--method": ["kernel", "all", "x", "1"],
                 "--cables": ["force", "tension", "x"], "--dt": ["1e-3", "0", "-1", "1e-300", "nan", "5", "1_"],
                 "--infeasible": ["stop", "x"],
                 "--control": ["velocity"], "--speed": ["1"], "--no-pictures": []},
         "workspace": {"--criterion": ["wrench_closure", "statically_stable", "x", "", ",", "twist_feasible"],
                       "--plane": ["xz", "qq"], "--at": ["1", "nan", "x"],
                       "--step": ["0", "-1", "1e-9", "x", "nan"],
                       "--jobs": ["0", "1", "x", "2.5"], "--no-pictures": []}}
WORLDS = ["planar_point", "planar_rigid", "planar_suspended", "", "x", "no/such.yaml", "caroca.yaml", "a\nb"]


@pytest.mark.parametrize("count", [60, pytest.param(2000, marks=pytest.mark.long)])
def test_whatever_is_typed_is_done_or_refused_in_one_line(count, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    rng = np.random.default_rng(count)
    refused = 0
    for _ in range(count):
        command = str(rng.choice(list(WORDS)))
        typed = [command, str(rng.choice(WORLDS[:3] if rng.random() < 0.8 else WORLDS)), "--no-pictures"]
        for option in rng.permutation(list(WORDS[command]))[:rng.integers(1, 4)].tolist():
            values = WORDS[command][option]
            typed += [option, *([str(rng.choice(values))] if values else [])]
        typed += {"run": ["--duration", "0.01"], "workspace": ["--step", "0.7"] * ("--step" not in typed)}[command]
        try:
            code = main(typed)
        except SystemExit as stop:
            code = stop.code
        error = capsys.readouterr().err
        told = [line for line in error.splitlines() if line.startswith("cdprlab")]
        cut_short = code == 1 and {"--infeasible", "stop"} <= {*typed}   # as was asked
        assert (code in (0, 2) or cut_short) and len(told) == (code != 0) and len(error) < 1000, (typed, code, error)
        refused += code == 2
    assert count / 4 < refused < count


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
@pytest.mark.parametrize("moment", [0.1, 0.3])
def test_ctrl_c_while_it_loads_is_told_without_a_traceback(moment):
    with subprocess.Popen([sys.executable, "-X", "importtime", "-m", "cdprlab", "run", "caroca", "--out", os.devnull],
                          stderr=subprocess.PIPE, text=True) as process:
        for line in process.stderr:
            if line.rstrip().endswith("cdprlab.errors"):    # from here on it is ours
                break
        with pytest.raises(subprocess.TimeoutExpired):
            process.wait(moment / 10)
        process.send_signal(signal.SIGINT)
        _, error = process.communicate(timeout=60)
    assert process.returncode == 130 and "Traceback" not in error and "cdprlab: stopped" in error


def test_a_reader_who_leaves_early_makes_no_noise():
    reading, writing = os.pipe()
    os.close(reading)                                       # as `head` does, once it has its lines
    command = [sys.executable, "-m", "cdprlab", "worlds"]
    left = subprocess.run(command, stdout=writing, stderr=subprocess.PIPE, timeout=60)
    os.close(writing)
    assert (left.returncode, left.stderr) == (141, b"")     # what a shell says of a broken pipe


# --- nothing is lost ------------------------------------------------------------------------------------
FLIGHT = ["run", "planar_point", "--no-pictures", "--duration", "0.05", "--out"]
KEPT = {"log.csv", "log.npz", "settings.json", "world.yaml"}


def told(shell, folder, **environment):
    command = shell.format(" ".join([sys.executable, "-m", "cdprlab", *FLIGHT, str(folder)]))
    return subprocess.run(["bash", "-c", command], capture_output=True, text=True, timeout=60,
                          env={**os.environ, **environment})


@pytest.mark.skipif(sys.platform == "win32", reason="bash")
@pytest.mark.parametrize("shell, environment", [
    ("{} 2>&1 | true", {"PYTHONUNBUFFERED": "1"}), pytest.param("{} | head -1", {}, marks=pytest.mark.long),
    ("{} >&- 2>&-", {}), ("{} > /dev/full", {}), ("{}", {"PYTHONIOENCODING": "ascii"}),
    pytest.param("{}", {"PYTHONIOENCODING": "cp1252"}, marks=pytest.mark.long),
], ids=["closed pipes", "head", "closed streams", "full disk for the words", "ascii", "cp1252"])
def test_whatever_becomes_of_the_words_the_data_is_there(shell, environment, tmp_path):
    done = told(shell, tmp_path / "out", **environment)
    assert {path.name for path in (tmp_path / "out").iterdir()} == KEPT
    assert "Traceback" not in done.stderr and "Exception" not in done.stderr and done.returncode == 0
    with np.load(tmp_path / "out" / "log.npz") as log:
        assert len(log["time"]) == 50


def test_a_disk_that_becomes_full_during_the_flight_costs_nothing(tmp_path, monkeypatch, capsys):
    from cdprlab.errors import CannotWrite

    save = cl.Run.save

    def full(run, folder):
        if folder == tmp_path:
            raise CannotWrite(f"cannot write {folder}: No space left on device")
        return save(run, folder)

    monkeypatch.setattr(cl.Run, "save", full)
    assert main([*FLIGHT, str(tmp_path)]) == 2
    error = capsys.readouterr().err
    assert "No space left" in error and {path.name for path in Path(error.split()[-1]).iterdir()} == KEPT


@pytest.mark.parametrize("error, code", [
    (KeyboardInterrupt(), 130), (cl.errors.SimulationDiverged("it left", 1.0, 2), 1), (MemoryError(), 2)])
def test_what_was_flown_before_something_happened_is_saved_and_said(error, code, tmp_path, monkeypatch, capsys):
    """An error of the engine at its twentieth step."""
    world = cl.load_world("planar_point")
    with cl.open_simulator(world) as engine:
        kind = type(engine)
    pull, steps = kind.pull, []

    def breaking(engine, *arguments):
        steps.append(1)
        if len(steps) > 20:
            raise error
        return pull(engine, *arguments)

    monkeypatch.setattr(kind, "pull", breaking)
    assert main([*FLIGHT, str(tmp_path)]) == code
    printed = capsys.readouterr()
    assert "written to" in printed.out and "Traceback" not in printed.err
    assert {path.name for path in tmp_path.iterdir()} == KEPT
    with np.load(tmp_path / "log.npz") as log:
        assert len(log["time"]) == 20


@pytest.mark.parametrize("what, where", [
    ("save", cl.Run), ("table", cl.Run), ("save_figure", view), ("save_film", view)])
def test_ctrl_c_while_results_are_written_loses_none(what, where, tmp_path, monkeypatch, capsys):
    """The data are saved, perhaps once more, and it is said where."""
    whole, calls = getattr(where, what), []

    def interrupted(*arguments):
        calls.append(1)
        if len(calls) == 1:
            raise KeyboardInterrupt
        return whole(*arguments)

    monkeypatch.setattr(where, what, interrupted)
    assert main([word for word in [*FLIGHT, str(tmp_path)] if word != "--no-pictures"]) == 130
    printed = capsys.readouterr()
    assert f"the data are written to {tmp_path}" in printed.out and "cdprlab: stopped" in printed.err
    assert {path.name for path in tmp_path.iterdir()} >= KEPT


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
def test_ctrl_c_is_told_once_also_with_workers(tmp_path):
    command = [sys.executable, "-m", "cdprlab", "workspace", "caroca", "--step", "0.002", "--jobs", "2",
               "--no-pictures", "--out", str(tmp_path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                          start_new_session=True) as process:
        process.stdout.readline()
        with pytest.raises(subprocess.TimeoutExpired):
            process.wait(1.0)
        os.killpg(process.pid, signal.SIGINT)    # as a terminal does: the workers too
        _, error = process.communicate(timeout=60)
    assert process.returncode == 130 and "Traceback" not in error and "cdprlab: stopped" in error
