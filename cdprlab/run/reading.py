"""What a real robot, or a run, wrote down: a CSV file becomes a Run again."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from csv import Error, reader
from pathlib import Path
from typing import Any

import numpy as np

from ..arrays import LARGEST, Array, checked, frozen
from ..errors import InvalidInput, quoted, shortened
from ..mechanics.trajectory import Reference
from ..robot.pose import Pose
from ..world import World, load_world
from ..world.files import as_path
from .record import QUANTITIES, Run, errors_of

_SIZES = {"m": {"m": 1.0, "cm": 1e-2, "mm": 1e-3}, "rad": {"rad": 1.0, "mrad": 1e-3, "deg": np.pi / 180},
          "s": {"s": 1.0, "ms": 1e-3}, "N": {"N": 1.0, "kN": 1e3}}
"""Unit of the library → units that a file may have, and their size."""


@checked
def read_log(csv: str | Path, columns: Mapping[str, str | Sequence[str]] | None = None,
             world: World | None = None) -> Run:
    """A Run from a CSV file: a real robot's, or the log.csv that `Run.save` wrote.

    It goes into `plot`, and its ``poses``, ``lengths`` and ``measured_tensions`` into `calibrate`.
    What the file does not tell is NaN; without time, rows are a second apart.

    csv : the file
    columns : "quantity [unit]" → its headings in the file: {"time [ms]": "t", "position [mm]":
        ["X", "Y", "Z"], "rotation [deg]": ["roll", "pitch", "yaw"], "length [mm]": [...],
        "measured_tension [kN]": [...]}; quantities as in `Run.columns`. Default: the headings
        that `Run.save` writes
    world : whose robot it is; default the world.yaml beside the file
    Raises InvalidInput naming quantity, heading or line.

    >>> read_log("no.csv")
    Traceback (most recent call last):
    ...
    cdprlab.errors.InvalidInput: there is no file no.csv
    """
    file = as_path(csv)
    beside = file.parent / "world.yaml"
    if not file.is_file():
        raise InvalidInput(f"there is no file {file}")
    if world is None and not beside.is_file():
        raise InvalidInput(f"say whose robot it is, world=...: there is no {beside}")
    world = world or load_world(beside)
    robot, d, m = world.robot, world.robot.dimension, world.robot.n_cables
    turn, full = (1, 3) if d == 2 else (3, 6)
    widths = {"time": 1, "feasible": 1, "position": d, "rotation": turn, "twist": full, "pose": 3 * len(robot.bases),
              **dict.fromkeys(("tension", "length", "torque", "speed"), m)}
    known = {name: (widths[name.rpartition("_")[2]], unit) for name, (_, unit) in QUANTITIES.items() if name != "error"}
    table = _table(file)
    given: Any = columns
    if columns is None:   # "position_1 [m]", "position_2 [m]", … are "position [m]"
        given = {}
        for heading in table:
            given.setdefault(re.sub(r"_\d+(?= \[|$)", "", heading), []).append(heading)
    count = len(next(iter(table.values())))
    told = {name: np.full((count, width), np.nan) for name, (width, _) in known.items()}
    for key, heading in given.items():
        name, _, unit = key.removesuffix("]").partition(" [")
        headings = [heading] if isinstance(heading, str) else list(heading)
        if name not in known:
            if columns is None:
                continue   # what a run has besides
            raise InvalidInput(f"columns: no quantity {quoted(name)}; there are {', '.join(known)}")
        width, own = known[name]
        sizes = _SIZES.get(own, {own: 1.0})
        if unit not in sizes or len(headings) != width or not {*headings} <= {*table}:
            raise InvalidInput(f"{name} of this robot must be {width} of the columns {shortened(', '.join(table))} "
                               f"in {' or '.join(sizes)}, got {quoted(headings)} in {quoted(unit)}")
        told[name] = sizes[unit] * np.column_stack([table[one] for one in headings])
    if all(np.isnan(values).all() for values in told.values()):
        raise InvalidInput(f"{file} tells nothing of a run: say which of its columns are what, columns={{...}}")
    time = told["time"][:, 0] if np.isfinite(told["time"]).any() else np.arange(count, dtype=float)
    poses, reference, estimates = (_poses(told[f"{whose}position"], told[f"{whose}rotation"], robot.pattern.turns)
                                   for whose in ("", "reference_", "estimated_"))
    fields: dict[str, Any] = {field: frozen(told[name]) for name, (field, _) in QUANTITIES.items()
                              if "." not in field and name in known   # what has a default, a run need not have
                              and not (hasattr(Run, field) and np.isnan(told[name]).all())}
    if "estimated_twists" in fields:
        fields["estimates"] = estimates
    if "base_poses" in fields:
        fields["base_poses"] = frozen(told["base_pose"].reshape(count, -1, 3))
    if not np.isfinite(told["commanded_tension"]).any():
        fields.setdefault("commanded_lengths", frozen(told["commanded_length"]))
    settings: dict[str, Any] = {"log": str(file)}
    if columns is None:
        import json

        kept, real = file.with_name("settings.json"), file.with_name("real.yaml")
        try:
            settings |= json.loads(kept.read_text(encoding="utf-8")) if kept.is_file() else {}
        except (ValueError, TypeError) as wrong:
            raise InvalidInput(f"cannot read {kept}: {shortened(str(wrong))}") from None
        if real.is_file():
            fields["real"] = load_world(real)
    about = {name: settings.pop(name, "as logged") for name in ("task", "method", "cables")}
    period = float(np.median(np.diff(time))) if count > 1 else 1.0
    fields |= {"time": frozen(time), "feasible": frozen(told["feasible"][:, 0] != 0), "poses": poses,
               "reference": Reference(reference, told["reference_twist"], np.full((count, full), np.nan)),
               "errors": errors_of(robot, poses, reference)}
    return Run(world=world, **about, **fields, real_time_factor=1.0, dt=period, control_period=period,
               settings=settings)


def _table(file: Path) -> dict[str, Array]:
    """Heading → (N,) numbers, NaN where a cell is empty."""
    try:
        with file.open(encoding="utf-8-sig", newline="") as text:
            headings, *rows = [row for row in reader(text) if row] or [[]]
    except (OSError, UnicodeDecodeError, Error) as error:
        raise InvalidInput(f"cannot read {shortened(str(file))}: {shortened(str(error))}") from None
    if not rows:
        raise InvalidInput(f"{file} must hold a row of headings and rows of numbers")
    numbers = np.empty((len(rows), len(headings)))
    for line, row in enumerate(rows):
        try:
            numbers[line] = np.reshape([float(cell or "nan") for cell in row], len(headings))
        except ValueError:
            raise InvalidInput(f"row {line + 1} of {file} must be {len(headings)} numbers, "
                               f"got {quoted(row)}") from None
    table = dict(zip(headings, numbers.T))
    if len(table) < len(headings) or (np.abs(np.nan_to_num(numbers)) > LARGEST).any():
        raise InvalidInput(f"{file} must have each heading once, and numbers of at most {LARGEST:g}")
    return table


def _poses(position: Array, rotation: Array, turns: bool) -> Pose:
    """Poses some of which are not known: their numbers are NaN."""
    angles, nowhere = np.nan_to_num(rotation), np.zeros_like(position)
    turned = Pose(nowhere, angles) if position.shape[1] == 3 else Pose(nowhere, angle=angles[:, 0])
    matrices = turned.rotation.copy()
    if turns:
        matrices[np.isnan(rotation).any(axis=1)] = np.nan
    return Pose.of(position, matrices)
