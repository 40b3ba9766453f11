"""What all commands share: streams that may be closed, a progress bar, a table, a folder for results."""

from __future__ import annotations

import argparse
import io
import os
import signal
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from .. import view
from ..errors import CannotWrite, InvalidInput, MissingDependency, stop_at_once
from ..world import World
from ..world.files import made_folder

Pictures = dict[str, Callable[[Path], Any]]
"""File name → called with its path."""


def open_streams() -> None:
    """Make stdout and stderr take whatever is printed: a closed one nowhere, an odd letter as a question mark."""
    # Else the next file opened would get a closed stream's number, and lines meant for it.
    while (number := os.open(os.devnull, os.O_RDWR)) <= 2:
        pass
    os.close(number)
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:
            setattr(sys, name, open(os.devnull, "w"))  # noqa: SIM115  (as long as the process lives)
        elif isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")


def silence() -> None:
    """Nobody takes our lines any more: write them nowhere, those at exit too."""
    with suppress(OSError, ValueError):     # in a notebook stdout is no file
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def say(line: str) -> None:
    """A line on the screen, if anybody still reads: results are worth more than what is said of them."""
    try:
        print(line, flush=True)
    except OSError:
        silence()


def hear_interrupts() -> None:
    """From now on Ctrl-C is an error: there is something to save, or to tidy up."""
    if signal.getsignal(signal.SIGINT) is stop_at_once:
        signal.signal(signal.SIGINT, signal.default_int_handler)


@contextmanager
def progress_bar(name: str, unit: str = "steps") -> Iterator[Callable[..., None]]:
    """A progress bar that appears with the first step: an error before it keeps the terminal clean.

    name, unit : what is done, and in what steps; who calls may rename it with every step
    """
    bar: Any = None

    def show(done: float, total: int | None = None, name: str = name) -> None:
        nonlocal bar
        with suppress(OSError):     # nobody watches
            if bar is None:
                hear_interrupts()
                from tqdm import tqdm

                bar = tqdm(total=total, desc=name, unit=f" {unit}", leave=False)
            if name != bar.desc:
                bar.set_description_str(name)
            bar.update(round(done) - bar.n)

    try:
        yield show
    finally:
        with suppress(OSError):
            if bar is not None:
                bar.close()


def refuse(options: argparse.Namespace, names: Sequence[str], why: str) -> None:
    """Raise InvalidInput if one of these options was given; ``why`` has a place for its name."""
    for name in names:
        if getattr(options, name) != options.parser.get_default(name):
            raise InvalidInput(why.format(name.replace("_", "-")))


def print_table(table: Mapping[str, Any], width: int = 36) -> None:
    """A line a quantity."""
    for quantity, value in table.items():
        say(f"  {quantity:{width}} {value}")


@contextmanager
def results(options: argparse.Namespace, world: World, what: str,
            below: str = "") -> Iterator[Callable[..., None]]:
    """The folder of ``--out``, made and tried before anything is computed; a run cut short is saved there, too.

    what : is going to be computed, in words
    below : folder in the default one, out/WORLD
    Returns what writes there, called as ``write(save, tell, pictures)``.
    """
    folder = made_folder(Path("out", world.name, below) if options.out is None else options.out)
    say(f"{world.title or world.name}: {what}")

    def write(save: Callable[[Path], Any], tell: Callable[[Path], Any], pictures: Pictures) -> None:
        """Data into the folder, then words on the screen, then pictures; at last what is there.

        save : called with the folder, or with another one if that has become full
        tell : prints what was found, and may add to the folder
        """
        try:
            _keep(save, folder)
            tell(folder)
            with progress_bar("drawing", "pictures") as bar:
                for number, (name, draw) in enumerate(() if options.no_pictures else pictures.items()):
                    bar(number, len(pictures), f"drawing {name}")
                    try:
                        draw(folder / name)
                    except MissingDependency as missing:
                        say(f"no {name}: {missing}")
        except KeyboardInterrupt:   # perhaps while saving what took minutes
            _keep(save, folder)
            say(f"stopped; the data are written to {folder}")
            raise
        say(f"written to {folder}: {', '.join(sorted(path.name for path in folder.iterdir() if path.is_file()))}")

    try:
        yield write
    except BaseException as error:
        flown = getattr(error, "run", None)
        if flown is not None:
            _keep(flown.save, folder)
            say(f"cut short; what was flown until then is written to {folder}")
        raise


def figure(plot: Callable[[Any], Any], what: Any) -> Callable[[Path], Any]:
    """What draws a figure into a file."""
    return lambda path: view.save_figure(plot(what), path)


def _keep(save: Callable[[Path], Any], folder: Path) -> None:
    try:
        save(folder)
    except CannotWrite as error:
        other = Path(tempfile.mkdtemp(prefix="cdprlab-"))
        save(other)
        raise CannotWrite(f"{error}; the results are in {other}") from error
