"""What happens, one row a control step: a table of named columns, each with its shape and its unit."""

import csv
import math
from collections.abc import Iterable, Mapping, Sequence
from io import TextIOWrapper
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, frozen
from ..errors import InvalidInput
from ..world.files import replaced

Columns = Mapping[str, tuple[tuple[int, ...], str]]
"""Name → shape of what one row has of it, and its unit."""


class Log:
    """Rows as they come, columns by name.

    columns : name → (shape of what one row has of it, unit)
    append : keeps an array of all the numbers of a row, unchecked, which is quicker than `keep`

    >>> log = Log({"time": ((), "s"), "position": ((2,), "m")})
    >>> log.keep(0.0, [1.0, 2.0])
    >>> log.keep(0.5, [1.5, 2.0])
    >>> log["position"].shape, log.units["time"]
    ((2, 2), 's')
    """

    def __init__(self, columns: Columns) -> None:
        self.units = {name: unit for name, (_, unit) in columns.items()}
        self._row = np.dtype([(name, float, shape) for name, (shape, _) in columns.items()])
        # One block of memory: kept as separate objects, the log would push a loop out of the
        # processor's cache.
        self._rows = bytearray()
        self.append = self._rows.extend

    def keep(self, *values: ArrayLike) -> None:
        """Write down one row: a value a column, in their order."""
        row = np.concatenate(values, axis=None, dtype=float)
        if row.nbytes != self._row.itemsize:
            raise InvalidInput(f"row {len(self)} of the log must be {self._row.itemsize // 8} numbers, got {row.size}: "
                               f"its columns are {', '.join(self.units)}")
        self.append(row)

    def __len__(self) -> int:
        return len(self._rows) // self._row.itemsize

    def __contains__(self, name: str) -> bool:
        return name in self.units

    def __getitem__(self, name: str) -> Array:
        """(N, …) one column, read-only."""
        return frozen(np.frombuffer(self._rows, self._row)[name].copy())


def flat_columns(columns: Mapping[str, tuple[Any, str]]) -> dict[str, Array]:
    """One array (N,) a number: columns of several values get numbers, counted from 1, and their unit.

    columns : name → (N, …) array and its unit

    >>> list(flat_columns({"time": ([0.0], "s"), "position": ([[1.0, 2.0]], "m")}))
    ['time [s]', 'position_1 [m]', 'position_2 [m]']
    """
    flat = {}
    for name, (values, unit) in columns.items():
        block = np.asarray(values, dtype=float)
        block = block.reshape(len(block), math.prod(block.shape[1:]))   # -1 fails where there are no rows
        for i, column in enumerate(block.T, 1):
            number = f"_{i}" if len(block.T) > 1 else ""
            flat[name + number + (f" [{unit}]" if unit else "")] = column
    return flat


def write_csv(path: Path, columns: Mapping[str, tuple[Any, str]]) -> None:
    """One row a step, columns as `flat_columns` has them."""
    flat = flat_columns(columns)
    table = np.column_stack(list(flat.values())).tolist()
    write_rows(path, chain([flat], ([f"{value:.9g}" for value in row] for row in table)))


def write_rows(path: Path, rows: Iterable[Iterable[str]]) -> None:
    """A CSV file of these rows, the first of them its header."""
    with replaced(path) as file, TextIOWrapper(file, encoding="utf-8", newline="") as text:
        csv.writer(text).writerows(rows)


def text_table(header: Sequence[str], rows: Sequence[Sequence[str]], gap: int = 2) -> str:
    """Columns aligned, ``gap`` spaces apart: the first to the left, all others to the right.

    >>> print(text_table(["cable", "1", "2"], [["length [m]", "4.36", "12.10"]]))
    cable          1      2
    length [m]  4.36  12.10
    """
    lines = [header, *rows]
    widths = [max(map(len, column)) for column in zip(*lines)]
    form = (gap * " ").join(f"{{:{'>' if k else '<'}{width}}}" for k, width in enumerate(widths))
    return "\n".join(form.format(*line).rstrip() for line in lines)
