"""The command line: ``python -m cdprlab worlds | run WORLD | workspace WORLD``."""

from __future__ import annotations

import argparse
import csv
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ..errors import CdprError, InvalidInput
from ..run import INFEASIBLE, WOUND, Run, run
from ..run.compare import TensionComparison, compare_tensions
from ..run.controllers import ComputedTorque
from ..simulate import CABLE_MODELS
from ..tensions import tension_methods
from ..world import World, load_world, world_names
from ..world.model import PickAndPlace
from .workspace_command import add_workspace_command


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; returns 0, or 2 after one line on stderr saying what was wrong."""
    options = _parser().parse_args(arguments)
    try:
        code = int(options.command(options))
        sys.stdout.flush()
        return code
    except CdprError as error:
        print(f"cdprlab: {error}", file=sys.stderr)
        return 2
    except BrokenPipeError:  # the reader of our lines has seen enough, as `head` does
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # nothing more is to be written at exit
        return 141
    except OSError as error:
        print(f"cdprlab: cannot write {error.filename}: {error.strerror}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("cdprlab: stopped", file=sys.stderr)
        return 130


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(prog="cdprlab", description="Cable-driven parallel robots, simulated and drawn.")
    commands = parser.add_subparsers(title="commands", required=True, parser_class=_Parser)
    worlds = commands.add_parser("worlds", help="list the robots that come with cdprlab")
    worlds.set_defaults(command=_worlds)
    flight = commands.add_parser("run", help="move a robot along a task, headless, and write plots, film and log")
    flight.set_defaults(command=_run, parser=flight)
    flight.add_argument("world", metavar="WORLD", help="a world's name (see `worlds`) or the path of a .yaml file")
    flight.add_argument("--task", default="default", help="one of the world's tasks (default: %(default)s)")
    flight.add_argument("--method", default="quadratic_program", choices=[*tension_methods(), "all"],
                        metavar="METHOD", help=f"tension distribution: {', '.join(tension_methods())} (default: "
                        "%(default)s); or all: each along the task's reference, without an engine, side by side")
    flight.add_argument("--cables", default="tension", choices=list(CABLE_MODELS), help="cable model "
                        "(default: %(default)s)")
    flight.add_argument("--kp", type=float, default=100.0, help="position gain [1/s²] (default: %(default)g)")
    flight.add_argument("--kd", type=float, default=100.0, help="velocity gain [1/s] (default: %(default)g)")
    flight.add_argument("--dt", type=float, default=1e-3, help="engine step [s] (default: %(default)g)")
    flight.add_argument("--control-period", type=float, help="control step [s], a multiple of dt (default: dt)")
    flight.add_argument("--duration", type=float, help="length of the run [s] (default: the task's)")
    flight.add_argument("--infeasible", default="relax", choices=INFEASIBLE,
                        help="what to do where no tensions balance the wrench (default: %(default)s)")
    flight.add_argument("--control", default="torque", choices=["torque", "velocity"],
                        help="of the winches, for tasks of kind pick_and_place (default: %(default)s)")
    flight.add_argument("--out", type=Path, help="folder to write to (default: out/WORLD)")
    flight.add_argument("--no-pictures", action="store_true", help="write the log only")
    add_workspace_command(commands, _Bar)
    return parser


class _Parser(argparse.ArgumentParser):
    """One line for a wrong command line instead of the whole usage."""

    def error(self, message: str) -> None:  # type: ignore[override]
        self.exit(2, f"{self.prog}: {message}; see {self.prog} --help\n")


class _Bar:
    """A progress bar that appears with the first step: an error before it keeps the terminal clean."""

    def __init__(self, name: str, unit: str = "steps") -> None:
        self.name, self.unit = name, unit
        self.bar: Any = None

    def __call__(self, done: int, total: int) -> None:
        if self.bar is None:
            from tqdm import tqdm

            self.bar = tqdm(total=total, desc=self.name, unit=f" {self.unit}", leave=False)
        self.bar.update(done - self.bar.n)

    def close(self) -> None:
        if self.bar is not None:
            self.bar.close()


def _worlds(_: argparse.Namespace) -> int:
    width = max(map(len, world_names()))
    for name in world_names():
        world = load_world(name)
        print(f"{name:{width}}  {world.title}; tasks: {', '.join(world.tasks)}")
    return 0


def _run(options: argparse.Namespace) -> int:
    if options.method == "all":
        return _compare(options)
    world = load_world(options.world)
    if options.task == "mission" and "mission" not in world.tasks:
        return _mission(options, world)
    if isinstance(world.task(options.task), PickAndPlace):
        return _pick_and_place(options, world)
    _say_no(options, ("control",), "belongs to tasks of kind pick_and_place")
    how = "inverse kinematics" if options.cables in WOUND else options.method
    print(f"{world.title or world.name}: task {options.task}, {how}, cables={options.cables}")
    bar = _Bar("flying")
    law = None if options.cables in WOUND else ComputedTorque(options.kp, options.kd)
    flown = run(world, options.task, options.method, options.cables, law,
                options.dt, options.control_period, options.infeasible, duration=options.duration, progress=bar)
    bar.close()
    for quantity, value in flown.table().items():
        print(f"  {quantity:36} {value}")
    folder = options.out or Path("out") / world.name
    flown.save(folder)
    if not options.no_pictures:
        _pictures(flown, folder)
    print(f"written to {folder}: {', '.join(sorted(path.name for path in folder.iterdir()))}")
    return 0


def _mission(options: argparse.Namespace, world: World) -> int:
    from .mission_command import fly_mission

    _say_no(options, (*_NO_SAY, "method", "control"), "has no say in a mission")
    print(f"{world.title or world.name}: mission: to the shelf, pick and place, home again")
    folder = options.out or Path("out") / world.name
    fly_mission(world, folder, not options.no_pictures)
    print(f"written to {folder}: {', '.join(sorted(path.name for path in folder.iterdir()))}")
    return 0


def _pick_and_place(options: argparse.Namespace, world: World) -> int:
    from ..fastkit import pick_and_place, plot_job, save_job_film

    _say_no(options, (*_NO_SAY, "method"), "has no say in a pick_and_place task, which flies under --control")
    print(f"{world.title or world.name}: task {options.task}, {options.control} control")
    bar = _Bar("working", "ms")
    job = pick_and_place(world, options.task, options.control, progress=bar)
    bar.close()
    for event in job.events:
        print(f"  {event.time:6.2f} s  {event.state:10} {event.why or job.words.get(event.state, '')}")
    for quantity, value in job.table().items():
        print(f"  {quantity:36} {value}")
    folder = options.out or Path("out") / world.name
    job.save(folder)
    if not options.no_pictures:
        from ..view import save_figure

        save_figure(plot_job(job), folder / "job.png")
        save_job_film(job, folder / "film.gif")
    print(f"written to {folder}: {', '.join(sorted(path.name for path in folder.iterdir()))}")
    return 0


def _say_no(options: argparse.Namespace, names: Sequence[str], why: str) -> None:
    given = [name for name in names if getattr(options, name) != options.parser.get_default(name)]
    if given:
        raise InvalidInput(f"--{given[0].replace('_', '-')} {why}")


_NO_SAY = ("cables", "kp", "kd", "dt", "control_period", "duration", "infeasible")
"""What belongs to an engine, and a comparison without one does not ask."""


def _compare(options: argparse.Namespace) -> int:
    given = [name for name in _NO_SAY if getattr(options, name) != options.parser.get_default(name)]
    if given:
        raise InvalidInput(f"--method all compares without an engine: --{given[0].replace('_', '-')} has no say; "
                           "give one method to fly it")
    world = load_world(options.world)
    print(f"{world.title or world.name}: task {options.task}, every tension distribution along the reference")
    bar = _Bar("comparing", "methods")
    table = compare_tensions(world, options.task, progress=bar)
    bar.close()
    print(table)
    folder = options.out or Path("out") / world.name
    written = _write_comparison(table, folder, picture=not options.no_pictures)
    print(f"written to {folder}: {', '.join(written)}")
    return 0


def _write_comparison(table: TensionComparison, folder: Path, picture: bool) -> list[str]:
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / "methods.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(f"{name} [{unit}]" if unit else name for name, unit in table.COLUMNS.items())
        writer.writerows([f"{value:.9g}" if isinstance(value, float) else str(value) for value in row.values()]
                         for row in table.rows())
    if not picture:
        return ["methods.csv"]
    from ..view import plot, save_figure

    save_figure(plot(table), folder / "methods.png")
    return ["methods.csv", "methods.png"]


def _pictures(flown: Run, folder: Path) -> None:
    from tqdm import tqdm

    from ..view import plot_tensions, plot_tracking, save_figure, save_film

    steps = (("tracking plot", lambda: save_figure(plot_tracking(flown), folder / "tracking.png")),
             ("tension plot", lambda: save_figure(plot_tensions(flown), folder / "tensions.png")),
             ("film", lambda: save_film(flown, folder / "film.gif")))
    for name, draw in (bar := tqdm(steps, leave=False)):
        bar.set_description(f"drawing {name}")
        draw()
