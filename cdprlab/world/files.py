"""World files on disk: those that come with cdprlab, and any other by its path."""

from __future__ import annotations

import difflib
from pathlib import Path
from typing import Any

from ..errors import Location, WorldError
from .mistakes import place_text
from .model import World


def world_names() -> list[str]:
    """Names of the worlds that come with cdprlab.

    >>> "caroca" in world_names()
    True
    """
    return sorted(path.stem for path in _worlds_folder().glob("*.yaml"))


def load_world(name_or_path: str | Path) -> World:
    """A shipped world by name, or any world file by path (ending in .yaml or .yml).

    Raises WorldError for an unknown name or a file with mistakes in it.

    >>> load_world("caroca").robot.n_cables
    8
    """
    path = _world_path(name_or_path)
    try:
        text = path.read_text(encoding="utf-8")
    except OSError as error:
        raise WorldError([f"cannot read {path}: {error.strerror}"]) from None
    except UnicodeDecodeError:
        raise WorldError([f"{path}: not a text file in UTF-8"]) from None
    return World.from_yaml(text, path=str(path))


def world_schema() -> dict[str, Any]:
    """JSON Schema of the world file.

    >>> world_schema()["title"]
    'WorldFile'
    """
    from .schema import WorldFile

    return WorldFile.model_json_schema()


def yaml_format() -> Any:
    from ruamel.yaml import YAML

    yaml = YAML(typ="rt")
    yaml.width = 120
    yaml.indent(mapping=2, sequence=4, offset=2)
    return yaml


def parsed(text: str, path: str) -> Any:
    """The document of a text in YAML; raises WorldError naming ``path`` and line."""
    from ruamel.yaml.constructor import DuplicateKeyError
    from ruamel.yaml.error import MarkedYAMLError, YAMLError

    try:
        return yaml_format().load(text)
    except DuplicateKeyError as error:
        key = str(error.problem).split('"')[1]
        where = place_text((*_cable_at(text, error.problem_mark.index), key))
        raise WorldError([f"{path}:{error.problem_mark.line + 1}: {where}: this key stands here twice; "
                          "keep one"]) from None
    except MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line = f":{mark.line + 1}" if mark else ""
        raise WorldError([f"{path}{line}: not valid YAML: {error.problem or error.context}"]) from None
    except YAMLError as error:
        raise WorldError([f"{path}: not valid YAML: {str(error).splitlines()[0]}"]) from None


def _cable_at(text: str, index: int) -> Location:
    """("cables", i) of the cable in whose block a character stands; () outside of them."""
    for key, value in yaml_format().compose(text).value:
        if key.value == "cables" and isinstance(value.value, list):
            for i, block in enumerate(value.value):
                if block.start_mark.index <= index < block.end_mark.index:
                    return ("cables", i)
    return ()


def _worlds_folder() -> Path:
    """Beside the code in an installed wheel, beside the package in a checkout."""
    package = Path(__file__).parents[1]
    inside = package / "worlds"
    return inside if inside.is_dir() else package.parent / "worlds"


def _world_path(name_or_path: str | Path) -> Path:
    given = Path(name_or_path)
    if given.suffix in (".yaml", ".yml"):
        if not given.is_file():
            raise WorldError([f"there is no world file {given}"])
        return given
    path = _worlds_folder() / f"{name_or_path}.yaml"
    if len(given.parts) != 1 or not path.is_file():
        close = difflib.get_close_matches(str(name_or_path), world_names(), n=1)
        hint = f"did you mean {close[0]!r}? " if close else ""
        raise WorldError([f"unknown world {str(name_or_path)!r}; {hint}there are {', '.join(world_names())}; "
                          "or give the path of a .yaml file"])
    return path
