"""The public face as pages: one for each room of the house, everything else taken from the docstrings."""

from __future__ import annotations

import importlib
import inspect
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import docstrings

import cdprlab
from cdprlab import course

GROUPS = {
    "Worlds and robots": ("world", "robot", "pose", "errors"),
    "Geometry": ("geometry",),
    "Kinematics": ("kinematics", "redundancy"),
    "Statics": ("statics",),
    "Tensions": ("tensions",),
    "Sets": ("sets",),
    "Workspace": ("workspace", "base_placement"),
    "Configurations": ("configurations",),
    "Control and simulation": ("trajectory", "state", "control", "simulate", "run", "compare", "picking"),
    "View": ("view",),
}
"""A world becomes a robot, a robot geometry, geometry kinematics and statics, …: page → rooms, in the house's order."""

_WIDE = 100  # [characters] of a command's help


def write(folder: Path) -> None:
    """All pages, into a folder of their own."""
    folder.mkdir(parents=True, exist_ok=True)
    pages = {_file(group): _page(group) for group in GROUPS}
    pages |= {"index": _index(), "command_line": _command_line()}
    for name, text in pages.items():
        (folder / f"{name}.rst").write_text(text, encoding="utf-8")


def members(room: str) -> list[str]:
    """Full names of what a room shows: functions after the things they return."""
    if room == "errors":
        found = [f"cdprlab.errors.{name}" for name, thing in vars(cdprlab.errors).items()
                 if inspect.isclass(thing) and thing.__module__ == "cdprlab.errors"]
    else:
        found = [f"cdprlab.{name}" for name in cdprlab.__all__ if _room(name) == room]
    return found + [f"cdprlab.course.explorers.{name}" for name in course.__all__ if room == "view"]


def homeless() -> list[str]:
    """Public names without a page; there should be none."""
    rooms = {room for group in GROUPS.values() for room in group}
    return [name for name in cdprlab.__all__ if _room(name) not in rooms]


def full_name(word: str, inside: str = "") -> str | None:
    """What a word in a docstring's backticks means, as the pages name it.

    inside : full name of whose docstring it is, for members of the same class
    """
    shown = {name for group in GROUPS.values() for room in group for name in members(room)}
    owners = [owner for owner in shown if inside == owner or inside.startswith(f"{owner}.")]
    word = word.removeprefix("cl.").removesuffix("()")
    for candidate in (f"cdprlab.{word}", f"cdprlab.errors.{word}", f"cdprlab.course.explorers.{word}"):
        if candidate in shown:
            return candidate
    return next((f"{owner}.{word}" for owner in owners if inspect.isclass(_thing(owner))
                 and (getattr(vars(_thing(owner)).get(word), "__doc__", None) or "").strip()
                 and not word.startswith("_")), None)


def _thing(name: str) -> Any:
    parts = name.removeprefix("cdprlab.").split(".")
    thing: Any = cdprlab
    for part in parts:
        thing = getattr(thing, part)
    return thing


def _room(name: str) -> str:
    thing = getattr(cdprlab, name)
    if name == "CdprError":
        return "errors"
    return (thing.__name__ if inspect.ismodule(thing) else thing.__module__).split(".")[1]


def _file(group: str) -> str:
    return group.lower().replace(" ", "_")


def _title(words: str, line: str = "=") -> str:
    return f"{words}\n{line * len(words)}\n\n"


def _first_line(thing: Any) -> str:
    return docstrings.inline((thing.__doc__ or "").strip().split("\n\n")[0].replace("\n", " "), full_name)


def _page(group: str) -> str:
    text = _title(group) + ".. py:currentmodule:: cdprlab\n\n"
    for room in GROUPS[group]:
        if len(GROUPS[group]) > 1 and room != _file(group):
            text += _title(room.replace("_", " ").capitalize(), "-")
        text += _first_line(importlib.import_module(f"cdprlab.{room}")) + "\n\n"
        text += "".join(_entry(name) for name in sorted(members(room), key=_order))
    return text


def _order(name: str) -> tuple[bool, bool]:
    """Things before functions, the widgets at the end; the rest in their own order."""
    return name.startswith("cdprlab.course.explorers"), not inspect.isclass(_thing(name))


def _entry(name: str) -> str:
    thing = _thing(name)
    if inspect.ismodule(thing):
        return ""
    kind = "exception" if inspect.isclass(thing) and issubclass(thing, Exception) else \
        "class" if inspect.isclass(thing) else "function"
    return f".. auto{kind}:: {name}\n\n"


def _index() -> str:
    """Every public name with its first line, by room."""
    text = _title("API: the public names") + "``import cdprlab as cl``, and ``cl.`` reaches all of this.\n\n"
    text += ".. toctree::\n   :hidden:\n\n" + "".join(f"   {_file(group)}\n" for group in GROUPS) \
        + "   command_line\n\n"
    for group, rooms in GROUPS.items():
        text += _title(group, "-") + ".. list-table::\n   :widths: auto\n\n"
        for name in (name for room in rooms for name in sorted(members(room), key=_order)):
            if not inspect.ismodule(_thing(name)):
                short = name.removeprefix("cdprlab.view.").removeprefix("cdprlab.")
                text += f"   * - :py:obj:`{short} <{name}>`\n     - {_first_line(_thing(name))}\n"
        text += "\n"
    return text + _title("Command line", "-") + "``python -m cdprlab``, see :doc:`command_line`.\n"


def _command_line() -> str:
    """What ``--help`` prints, of the command and of each of its parts."""
    whole = _help()
    parts = re.search(r"\{([\w,-]+)\}", whole)
    assert parts is not None, "python -m cdprlab --help names no commands"
    blocks = {"python -m cdprlab": whole} | {f"python -m cdprlab {part}": _help(part)
                                            for part in parts[1].split(",")}
    return _title("Command line") + "".join(
        _title(f"``{command}``", "-") + ".. code-block:: text\n\n" + "".join(
            f"   {line}".rstrip() + "\n" for line in text.splitlines()) + "\n" for command, text in blocks.items())


def _help(*command: str) -> str:
    done = subprocess.run([sys.executable, "-m", "cdprlab", *command, "--help"], text=True, capture_output=True,
                          check=True, env={**os.environ, "COLUMNS": str(_WIDE), "NO_COLOR": "1",
                                           "PYTHONPATH": str(Path(cdprlab.__file__).parents[1])})
    return done.stdout
