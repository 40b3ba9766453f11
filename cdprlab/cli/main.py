"""The command line: ``python -m cdprlab worlds | run WORLD | workspace WORLD | lessons DIR | doctor``."""

import argparse
import sys
import tomllib
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

from .. import __version__, view
from ..course.handing_out import hand_out
from ..errors import CdprError, InvalidInput, quoted, shortened
from ..run import INFEASIBLE, WOUND, run
from ..run.compare import compare_tensions
from ..run.log import write_rows
from ..simulate import CABLE_MODELS
from ..tensions import tension_methods
from ..world import World, load_world, world_names
from ..world.model import PickAndPlace
from .doctor import diagnose
from .grade_command import grade
from .output import (
    figure,
    hear_interrupts,
    open_streams,
    print_table,
    progress_bar,
    refuse,
    results,
    say,
    silence,
)
from .workspace_command import CRITERIA, judge_workspace


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command.

    Returns 0 or what the command says; after one line on stderr that says what was wrong 2, or 1
    if the robot had begun to move; 141 where nobody reads a listing to its end.
    """
    open_streams()
    try:
        options = _parser().parse_args(arguments)
        if options.command is not _run:   # that loads much, then shows a bar
            hear_interrupts()
        answer = options.command(options)
        sys.stdout.flush()
        return answer or 0
    except CdprError as error:
        print(f"cdprlab: {error}", file=sys.stderr)
        return 2 if error.run is None else 1
    except MemoryError:
        print("cdprlab: the memory does not suffice: ask for fewer steps or poses", file=sys.stderr)
        return 2
    except BrokenPipeError:  # the reader of our lines has seen enough, as `head` does
        silence()
        return 141
    except OSError as error:
        silence()
        print(f"cdprlab: cannot write {error.filename or 'what there is to say'}: {error.strerror}", file=sys.stderr)
        return 2


def _parser() -> argparse.ArgumentParser:
    """Of the commands and options that commands.toml lists."""
    parser = _Parser(prog="cdprlab",
                     description="Cable-driven parallel robots, simulated and drawn.")
    parser.add_argument("--version", action="version", version=f"cdprlab {__version__}")
    commands = parser.add_subparsers(title="commands", required=True)
    table = tomllib.loads(Path(__file__).with_name("commands.toml").read_text(encoding="utf-8"))
    for name, told in table.items():
        command = commands.add_parser(name, help=told["help"])
        command.set_defaults(command=_COMMANDS[name], parser=command)
        for option, words in told.get("options", {}).items():
            for key in words.keys() & {"choices", "type"}:
                words[key] = _NAMED.get(str(words[key]), words[key])
            words["help"] = words["help"].format(criteria=", ".join(CRITERIA))
            command.add_argument(option, **words)
    return parser


_NAMED: dict[str, Any] = {"methods": [*tension_methods(), "all"], "cables": list(CABLE_MODELS),
                          "infeasible": INFEASIBLE, "float": float, "int": int, "path": Path}
"""What the table calls by name."""


class _Parser(argparse.ArgumentParser):
    """One line for a wrong command line instead of the whole usage."""

    def error(self, message: str) -> None:  # type: ignore[override]
        words = " ".join(map(shortened, message.split()))
        self.exit(2, f"{self.prog}: {words}; see {self.prog} --help\n")


def _worlds(_: argparse.Namespace) -> None:
    width = max(map(len, world_names()))
    for name in world_names():
        world = load_world(name)
        print(f"{name:{width}}  {world.title}; tasks: {', '.join(_tasks(world))}")


def _tasks(world: World) -> list[str]:
    """Names of what a world can be flown along: its own tasks, and the mission around a job at a shelf."""
    works = any(isinstance(task, PickAndPlace) for task in world.tasks.values())
    return list(dict.fromkeys([*world.tasks, *["mission"] * works]))


def _run(options: argparse.Namespace) -> None:
    world = load_world(options.world)
    if options.task not in _tasks(world):
        raise InvalidInput(f"world {world.name!r} has no task {quoted(options.task)}; "
                           f"there are {shortened(', '.join(_tasks(world)))}")
    if options.method == "all":
        _compare(options, world)
    elif options.task == "mission" and "mission" not in world.tasks:
        from .mission_command import fly_mission

        refuse(options, (*_ENGINES, "method", "control"), "--{} has no say in a mission")
        fly_mission(options, world)
    elif isinstance(world.task(options.task), PickAndPlace):
        _pick_and_place(options, world)
    else:
        _fly(options, world)


def _lessons(options: argparse.Namespace) -> None:
    told = hand_out(options.folder)
    print("\n".join(told or ["nothing to do: every lesson is there"]))
    print(f"to open them: jupyter lab {options.folder}")


def _fly(options: argparse.Namespace, world: World) -> None:
    refuse(options, ("control",), "--{} belongs to tasks of kind pick_and_place")
    how = options.method
    if options.cables in WOUND:
        refuse(options, ("method", "infeasible"),
               f"--{{}} has no say with --cables {options.cables}, which winds by inverse kinematics")
        how = "inverse kinematics"
    with results(options, world, f"task {options.task}, {how}, cables={options.cables}") as write:
        with progress_bar("flying") as bar:
            flown = run(world, options.task, options.method, options.cables, dt=options.dt,
                        infeasible=options.infeasible, duration=options.duration, progress=bar)
        write(flown.save, lambda _: print_table(flown.table()), {
            "tracking.png": figure(view.plot_tracking, flown),
            "tensions.png": figure(view.plot_tensions, flown),
            "film.gif": partial(view.save_film, flown),
            "scene.html": partial(view.save_scene, flown)})


def _compare(options: argparse.Namespace, world: World) -> None:
    refuse(options, _ENGINES, "--method all compares without an engine: --{} has no say; give one method to fly it")
    world.task(options.task)
    with results(options, world, f"task {options.task}, every tension distribution along the reference") as write:
        with progress_bar("comparing", "methods") as bar:
            table = compare_tensions(world, options.task, progress=bar)
        header = [f"{name} [{unit}]" if unit else name for name, unit in table.COLUMNS.items()]
        rows = [[f"{value:.9g}" if isinstance(value, float) else str(value)
                 for value in row.values()] for row in table.rows()]
        write(lambda folder: write_rows(folder / "methods.csv", [header, *rows]),
              lambda _: say(str(table)), {"methods.png": figure(view.plot, table)})


def _pick_and_place(options: argparse.Namespace, world: World) -> None:
    from ..fastkit import pick_and_place, plot_job, save_job_film

    refuse(options, (*_ENGINES, "method"),
           "--{} has no say in a pick_and_place task, which flies under --control")
    with results(options, world, f"task {options.task}, {options.control} control") as write:
        with progress_bar("working", "ms") as bar:
            job = pick_and_place(world, options.task, options.control, progress=bar)

        def tell(_: Path) -> None:
            for event in job.events:
                say(f"  {event.time:6.2f} s  {event.state:10} {event.why or job.words.get(event.state, '')}")
            print_table(job.table())

        write(job.save, tell, {"job.png": figure(plot_job, job),
                               "film.gif": partial(save_job_film, job),
                               "scene.html": partial(view.save_scene, job)})


_ENGINES = ("cables", "dt", "duration", "infeasible")
"""Options that belong to the engine of `run`."""

_COMMANDS = {"worlds": _worlds, "run": _run, "workspace": judge_workspace, "lessons": _lessons,
             "doctor": diagnose, "grade": grade}
