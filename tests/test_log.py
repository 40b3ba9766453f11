"""The log: columns by name, of any shape, as many rows as come; and what is saved of it."""

import csv
import json

import numpy as np
import pytest

import cdprlab as cl
from cdprlab.errors import InvalidInput
from cdprlab.run import Log


def filled(rows):
    log = Log({"time": ((), "s"), "rotation": ((2, 2), ""), "bases": ((2, 3), "m, m, rad"), "feasible": ((), "")})
    for k in range(rows):
        log.keep(0.1 * k, k * np.eye(2), np.full((2, 3), k), k % 2 == 0)
    return log


@pytest.mark.parametrize("rows", [0, 1, 1024, 3000])
def test_columns_come_back_in_their_shapes(rows):
    log = filled(rows)
    assert len(log) == rows and "time" in log and "length" not in log
    assert log["rotation"].shape == (rows, 2, 2) and log["bases"].shape == (rows, 2, 3)
    np.testing.assert_array_equal(log["time"], 0.1 * np.arange(rows))
    np.testing.assert_array_equal(log["rotation"], np.arange(rows)[:, None, None] * np.eye(2))
    np.testing.assert_array_equal(log["feasible"], np.arange(rows) % 2 == 0)


def test_a_column_read_is_not_written_to():
    log = filled(2)
    read = log["time"]
    log.keep(5.0, np.eye(2), np.zeros((2, 3)), True)
    assert not read.flags.writeable and read.size == 2 and log["time"][-1] == 5.0


def test_a_row_of_another_width_is_refused():
    with pytest.raises(InvalidInput, match="row 1 of the log must be 12 numbers, got 6"):
        filled(1).keep(0.0, np.eye(2), True)


def test_what_is_saved(tmp_path, monkeypatch):
    run = cl.run(cl.load_world("planar_rigid"), duration=0.007)
    monkeypatch.setattr(type(run), "csv_rows", 3)
    run.save(tmp_path / "out")
    saved, columns = np.load(tmp_path / "out" / "log.npz"), run.columns()
    assert json.loads(str(saved["units"])) == {name: unit for name, (_, unit) in columns.items()}
    for name, (values, _) in columns.items():
        np.testing.assert_array_equal(saved[name], values)
    with (tmp_path / "out" / "log.csv").open(encoding="utf-8") as file:
        header, *rows = csv.reader(file)
    assert header[:4] == ["time [s]", "position_1 [m]", "position_2 [m]", "rotation [rad]"]
    assert header[-1] == "feasible" and [row[0] for row in rows] == ["0", "0.003", "0.006"]
    settings = json.loads((tmp_path / "out" / "settings.json").read_text())
    assert settings == json.loads(json.dumps({"task": "default", "method": run.method, "cables": run.cables,
                                              **run.settings}))


def test_a_column_may_be_of_nothing():
    """As many people as walk about: none."""
    log = Log({"time": ((), "s"), "people": ((0, 3), "m")})
    log.keep(0.0, np.zeros((0, 3)))
    assert log["people"].shape == (1, 0, 3) and log["time"].tolist() == [0.0]
