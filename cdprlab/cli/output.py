"""What all commands share: a progress bar, a table on the screen, a folder with pictures."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from ..errors import MissingDependency


class Bar:
    """A progress bar that appears with the first step: an error before it keeps the terminal clean.

    name, unit : what is done, and in what steps; a caller may rename it with every step
    """

    def __init__(self, name: str, unit: str = "steps") -> None:
        self.name, self.unit = name, unit
        self.bar: Any = None

    def __enter__(self) -> Bar:
        return self

    def __call__(self, done: float, total: int | None = None, name: str = "") -> None:
        if self.bar is None:
            from tqdm import tqdm

            self.bar = tqdm(total=total, desc=name or self.name, unit=f" {self.unit}",
                            leave=False)
        if name and name != self.bar.desc:
            self.bar.set_description_str(name)
        self.bar.update(round(done) - self.bar.n)

    def __exit__(self, *_: object) -> None:
        if self.bar is not None:
            self.bar.close()


def add_output_options(parser: argparse.ArgumentParser, default: str, kept: str) -> None:
    """``--out`` and ``--no-pictures``.

    default : folder, as help names it
    kept : what is written without pictures
    """
    parser.add_argument("--out", type=Path, help=f"folder to write to (default: {default})")
    parser.add_argument("--no-pictures", action="store_true", help=f"write {kept} only")


def print_table(table: Mapping[str, Any], width: int = 36) -> None:
    """A line a quantity."""
    for quantity, value in table.items():
        print(f"  {quantity:{width}} {value}")


def write(folder: Path, save: Callable[[Path], Any], pictures: Mapping[str, Callable[[Path], Any]]) -> None:
    """Data and pictures into a folder, which is made if need be; then say what is there.

    save : called with the folder
    pictures : file name → called with its path
    """
    from tqdm import tqdm

    folder.mkdir(parents=True, exist_ok=True)
    save(folder)
    for name, draw in (bar := tqdm(pictures.items(), leave=False)):
        bar.set_description(f"drawing {name}")
        try:
            draw(folder / name)
        except MissingDependency as missing:
            print(f"no {name}: {missing}")
    print(f"written to {folder}: {', '.join(sorted(path.name for path in folder.iterdir() if path.is_file()))}")
