"""Where in a document a mistake stands, and what to say about it."""

from __future__ import annotations

import difflib
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from ..errors import Location


def existing_parts(document: Any, location: Location) -> Iterator[str | int]:
    """The parts of a pydantic location that are keys or indices of the document, and a missing last key."""
    node = document
    for place, part in enumerate(location):
        is_index = isinstance(node, list | tuple) and isinstance(part, int) and part < len(node)
        if is_index or (isinstance(node, Mapping) and part in node):
            node = node[part]
            yield part
        elif place == len(location) - 1 and isinstance(node, Mapping) and isinstance(part, str):
            yield part


def line_number(document: Any, location: Location) -> int | None:
    """Line (from 1) of the deepest part of ``location`` the document has; None where it has no lines."""
    node, line = document, None
    if hasattr(document, "lc"):
        line = document.lc.line + 1
    for part in location:
        if not hasattr(node, "lc") or node.lc.data is None or part not in node.lc.data:
            break
        line = node.lc.data[part][0] + 1
        node = node[part]
    return line


def place_text(location: Location) -> str:
    """("cables", 2, "tension") as "cable 3: tension"."""
    if location[:1] == ("cables",) and len(location) > 1 and isinstance(location[1], int):
        rest = place_text(location[2:])
        return f"cable {location[1] + 1}" + (f": {rest}" if rest else "")
    text = ""
    for part in location:
        text += f"[{part + 1}]" if isinstance(part, int) else f".{part}" if text else part
    return text


def explanation(error: Any, location: Location) -> str:
    kind, given, context = error["type"], error.get("input"), error.get("ctx", {})
    if kind == "extra_forbidden":
        return _unknown_key(location)
    if kind == "missing":
        return "missing; a world needs it"
    if kind == "finite_number":
        return f"must be a finite number, got {given}"
    if kind in _WANTED:
        return f"must be {_WANTED[kind]}, got {'nothing' if given is None else repr(given)}"
    if kind in ("too_short", "too_long"):
        count = context.get("min_length", context.get("max_length"))
        bound = "at least" if kind == "too_short" else "at most"
        return f"must have {bound} {count} {'entry' if count == 1 else 'entries'}, got {context['actual_length']}"
    if kind.startswith("union_tag"):
        return f"kind must be quintic or hold, got {context.get('tag', 'none')}"
    message = error["msg"].replace("Input should be", "must be").replace("greater than or equal to", "at least")
    return f"{message}, got {given!r}" if isinstance(given, int | float | str) else message


_WANTED = {"float_type": "a number", "list_type": "a list", "string_type": "text", "dict_type": "a block of keys",
           "model_type": "a block of keys", "model_attributes_type": "a block of keys",
           "string_pattern_mismatch": "one word of letters, digits, _ and -"}


def _unknown_key(location: Location) -> str:
    hint = "".join(f"did you mean {guess!r}? " for guess in key_guesses(location))
    return f"unknown key; {hint}allowed here: {', '.join(_allowed_keys(location[:-1]))}"


def key_guesses(location: Location) -> list[str]:
    """The allowed key that looks most like the unknown one at ``location``, if any does."""
    return difflib.get_close_matches(str(location[-1]), _allowed_keys(location[:-1]), n=1)


def kind_of(document: Any) -> str:
    if document is None:
        return "an empty file"
    return "a list" if isinstance(document, list | tuple) else repr(document)


def _allowed_keys(location: Location) -> list[str]:
    """Keys of the schema block at ``location``."""
    from typing import get_args

    from pydantic import BaseModel

    from .schema import WorldFile

    def models(annotation: Any) -> Iterator[Any]:
        if isinstance(annotation, type) and issubclass(annotation, BaseModel):
            yield annotation
        for argument in get_args(annotation):
            yield from models(argument)

    blocks: list[Any] = [WorldFile]
    for part in location:
        if isinstance(part, int):
            continue
        fields = [f for block in blocks for key, f in block.model_fields.items() if part in (key, f.alias)]
        if fields:
            blocks = [found for f in fields for found in models(f.annotation)]
    return sorted({f.alias or key for block in blocks for key, f in block.model_fields.items()})


def plain(value: Any) -> Any:
    """ruamel's commented containers and numbers as plain Python."""
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    for kind in (bool, int, float, str):
        if isinstance(value, kind):
            return kind(value)
    return value.item() if isinstance(value, np.generic) else value
