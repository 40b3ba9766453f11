"""The command line: what it writes, and one line with exit code 2 for what it cannot do."""

import pytest

from cdprlab.__main__ import main
from cdprlab.errors import MissingDependency

try:
    from cdprlab.simulate.spatial import import_pybullet

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


@pytest.mark.parametrize("arguments, message", [
    (["run", "carroca"], "did you mean 'caroca'"),
    (["run", "caroca", "--task", "none"], "there are default"),
    (["run", "caroca", "--dt", "0"], "dt must be positive"),
    (["run", "caroca", "--duration", "-1"], "duration must be positive"),
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
