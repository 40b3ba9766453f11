"""The public face as pages: one for each room of the house, everything else taken from the docstrings."""

from __future__ import annotations

import importlib
import inspect
import os
import re
import subprocess
import sys
from pathlib import Path
from textwrap import indent
from typing import Any

import docstrings

import cdprlab
from cdprlab import course, fastkit

GROUPS = {
    "Worlds and robots": ("world", "robot", "errors"),
    "Mechanics": ("mechanics",),
    "Tensions": ("tensions",),
    "Sets": ("sets",),
    "Workspaces": ("workspace",),
    "Configurations": ("configurations",),
    "Simulation and runs": ("simulate", "run"),
    "View": ("view",),
    "FASTKIT": ("fastkit",),
    "Course": ("course",),
}
"""A world becomes a robot, a robot mechanics, mechanics tensions, …; then the wings: page → rooms."""

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
        return [f"cdprlab.errors.{name}" for name, thing in vars(cdprlab.errors).items()
                if inspect.isclass(thing) and thing.__module__ == "cdprlab.errors"]
    if room in ("fastkit", "course"):
        door = {"fastkit": fastkit, "course": course}[room]
        return [f"cdprlab.{room}.{name}" for name in door.__all__
                if getattr(getattr(door, name), "__module__", "").startswith(f"cdprlab.{room}.")]
    return [f"cdprlab.{name}" for name in cdprlab.__all__ if _room(name) == room]


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
    for candidate in (f"cdprlab{door}.{word}" for door in ("", ".errors", ".fastkit", ".course")):
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


def _order(name: str) -> bool:
    """Things before functions; the rest in their own order."""
    return not _is_class(name)


def _is_class(name: str) -> bool:
    """Whether it is one by name too: an explorer is found under the name of a function that makes it."""
    thing = _thing(name)
    return inspect.isclass(thing) and thing.__name__ == name.split(".")[-1]


def _entry(name: str) -> str:
    thing = _thing(name)
    if inspect.ismodule(thing):
        return ""
    if _is_class(name):
        return f".. auto{'exception' if issubclass(thing, Exception) else 'class'}:: {name}\n\n"
    if not inspect.isclass(thing):
        return f".. autofunction:: {name}\n\n"
    arguments = [str(argument.replace(annotation=argument.empty)) for argument in
                 inspect.signature(thing).parameters.values()]
    said = docstrings.as_rst(inspect.getdoc(thing) or "", lambda word: full_name(word, name))
    short = name.removeprefix("cdprlab.")  # the page's module
    return f".. py:function:: {short}({', '.join(arguments)})\n\n" + indent("\n".join(said), "   ") + "\n\n"


def _index() -> str:
    """Every public name with its first line, by room."""
    text = _title("API: the public names") + "``import cdprlab as cl``, and ``cl.`` reaches all of this.\n\n"
    text += ".. toctree::\n   :hidden:\n\n" + "".join(f"   {_file(group)}\n" for group in GROUPS) \
        + "   command_line\n\n"
    for group, rooms in GROUPS.items():
        text += _title(group, "-") + ".. list-table::\n   :widths: auto\n\n"
        for name in (name for room in rooms for name in sorted(members(room), key=_order)):
            if not inspect.ismodule(_thing(name)):
                short = name.removeprefix("cdprlab.")
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
