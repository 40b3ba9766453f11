"""What happens, one row a control step: a table of named columns, each with its shape and its unit."""

import csv
import json
from collections.abc import Iterable, Mapping, Sequence
from io import TextIOWrapper
from itertools import chain
from pathlib import Path
from struct import Struct, error as StructError
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_count, frozen
from ..errors import InvalidInput
from ..world import World
from ..world.files import made_folder, replaced, write_text

Columns = Mapping[str, tuple[tuple[int, ...], str]]
"""Name → shape of what one row has of it, and its unit."""


class Log:
    """Rows as they come, columns by name.

    columns : name → (shape of what one row has of it, unit)

    >>> log = Log({"time": ((), "s"), "position": ((2,), "m")})
    >>> log.keep(0.0, [1.0, 2.0])
    >>> log.keep(0.5, [1.5, 2.0])
    >>> log["position"].shape, log.units["time"]
    ((2, 2), 's')
    """

    def __init__(self, columns: Columns) -> None:
        self.units = {name: unit for name, (_, unit) in columns.items()}
        self._shapes = {name: shape for name, (shape, _) in columns.items()}
        ends = np.cumsum([int(np.prod(shape)) for shape in self._shapes.values()]).tolist()
        self._slices = dict(zip(self._shapes, map(slice, [0, *ends], ends)))
        self.width = ends[-1]
        # One block of memory: kept as separate objects, the log would push a loop out of the
        # processor's cache.
        self._pack, self._rows = Struct(f"{self.width}d").pack, bytearray()

    def keep(self, *values: ArrayLike) -> None:
        """Write down one row: a value a column, in their order."""
        self.keep_numbers(np.concatenate(values, axis=None).tolist())

    def keep_numbers(self, row: Sequence[float]) -> None:
        """The same from all the numbers of a row, which is quicker."""
        try:
            self._rows += self._pack(*row)
        except StructError:
            raise InvalidInput(f"row {len(self)} of the log must be {self.width} numbers, got {len(row)}: "
                               f"its columns are {', '.join(self.units)}") from None

    def __len__(self) -> int:
        return len(self._rows) // (8 * self.width)

    def __contains__(self, name: str) -> bool:
        return name in self._slices

    def __getitem__(self, name: str) -> Array:
        """(N, …) one column, read-only."""
        table = np.frombuffer(self._rows).reshape(-1, self.width)
        return frozen(table[:, self._slices[name]].reshape(len(table), *self._shapes[name]).copy())


def save_record(folder: str | Path, columns: Mapping[str, tuple[Any, str]], world: World,
                settings: Mapping[str, Any], every: int = 1) -> Path:
    """Write log.npz (named arrays and their units), log.csv, the world used and the settings.

    folder : made if missing; columns : name → (N, …) array and its unit
    every : of how many rows log.csv keeps one; log.npz has them all
    """
    as_count(every, "every")
    target = made_folder(folder)
    units = json.dumps({name: unit for name, (_, unit) in columns.items()})
    arrays: dict[str, Any] = {name: values for name, (values, _) in columns.items()}
    with replaced(target / "log.npz") as file:
        np.savez_compressed(file, units=np.array(units), **arrays)
    write_csv(target / "log.csv",
              {name: (values[::every], unit) for name, (values, unit) in columns.items()})
    world.save(target / "world.yaml")
    write_text(target / "settings.json", json.dumps(settings, indent=1) + "\n")
    return target


def flat_columns(columns: Mapping[str, tuple[Any, str]]) -> dict[str, Array]:
    """One array (N,) a number: columns of several values get numbers, counted from 1, and their unit.

    columns : name → (N, …) array and its unit

    >>> list(flat_columns({"time": ([0.0], "s"), "position": ([[1.0, 2.0]], "m")}))
    ['time [s]', 'position_1 [m]', 'position_2 [m]']
    """
    flat = {}
    for name, (values, unit) in columns.items():
        block = np.asarray(values, dtype=float)
        block = block.reshape(len(block), int(np.prod(block.shape[1:])))   # -1 fails where there are no rows
        numbers = [""] if block.shape[1] == 1 else [f"_{i + 1}" for i in range(block.shape[1])]
        for number, column in zip(numbers, block.T):
            flat[f"{name}{number} [{unit}]" if unit else name + number] = column
    return flat


def write_csv(path: Path, columns: Mapping[str, tuple[Any, str]]) -> None:
    """One row a step, columns as `flat_columns` has them."""
    flat = flat_columns(columns)
    write_rows(path, chain([list(flat)], ([f"{value:.9g}" for value in row]
                                          for row in np.column_stack(list(flat.values())).tolist())))


def write_rows(path: Path, rows: Iterable[Sequence[str]]) -> None:
    """A CSV file of these rows, the first of them its header."""
    with replaced(path) as file, TextIOWrapper(file, encoding="utf-8", newline="") as text:
        csv.writer(text).writerows(rows)


def text_table(header: Sequence[str], rows: Sequence[Sequence[str]], gap: int = 2) -> str:
    """Columns aligned, ``gap`` spaces apart: the first to the left, all others to the right.

    >>> print(text_table(["cable", "1", "2"], [["length [m]", "4.36", "12.10"]]))
    cable          1      2
    length [m]  4.36  12.10
    """
    lines = [list(header), *map(list, rows)]
    widths = [max(map(len, column)) for column in zip(*lines)]
    return "\n".join((gap * " ").join(cell.ljust(width) if k == 0 else cell.rjust(width)
                                     for k, (cell, width) in enumerate(zip(line, widths))).rstrip() for line in lines)
