"""Answers as plain data: JSON, and arrays in it as `.npy`; who reads makes every object anew, by a table of kinds."""

import base64
import io
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ...robot.pose import Pose
from ...world import World

_COLLECTIONS: dict[str, Any] = {kind.__name__: kind for kind in (dict, tuple, set, frozenset, list)}
_NUMBERS = "biufcU"
"""Kinds of arrays that are data, text among them."""


def encode(value: Any, key_of: Callable[[Any], int] | None = None, given: Sequence[Any] = ()) -> Any:
    """A value as JSON; raises TypeError for what has no place in the table.

    key_of : gives functions a key
    given : arguments; where one of them is handed back, its number goes instead
    """
    def inner(part: Any) -> Any:
        return encode(part, key_of, given)

    for number, argument in enumerate(given):
        if value is argument:
            return {"given": number}
    if value is None:
        return None
    if isinstance(value, np.generic | complex):   # before Python's own, which some of numpy's also are
        return {"scalar": _npy(value)}
    for plain in (bool, int, float, str):
        if isinstance(value, plain):
            return plain(value)
    for name, collection in _COLLECTIONS.items():
        if isinstance(value, collection):
            return {name: [*map(inner, value.items() if collection is dict else value)]}
    if isinstance(value, Pose):
        return {"Pose": [_npy(value.position), _npy(value.rotation)]}
    if isinstance(value, World):
        return {"World": inner(value.to_dict())}
    if is_interval(value):
        return inner((value.lb(), value.ub()))
    if hasattr(value, "__array__"):
        return {"array": _npy(value)}
    if hasattr(value, "__iter__"):   # range, map, zip, generators
        return inner(list(value))
    if key_of and callable(value):
        return {"function": key_of(value)}
    raise TypeError(f"an answer is numbers, arrays, text, lists, poses or worlds, not {type(value).__name__}")


def decode(message: Any, function: Any = None, given: Sequence[Any] = ()) -> Any:
    """The value that `encode` wrote, every part of it made here; raises whatever anything else makes it raise.

    function : makes the callable that a key stands for
    given : the same arguments
    """
    if not isinstance(message, dict):
        return message
    ((kind, body),) = message.items()
    match kind:
        case "given":
            return given[body]
        case "array":
            return _array(body)
        case "scalar":
            return _array(body)[()]
        case "Pose":
            position, rotation = map(_array, body)
            Pose(position, matrix=rotation)   # raises unless it is one; below nothing is rounded again
            return Pose.of(position, rotation)
        case "World":
            return World.from_dict(decode(body, function))
        case "function":
            return function(body)
    return _COLLECTIONS[kind](decode(part, function, given) for part in body)


def _npy(value: Any) -> str:
    array, file = np.asarray(value), io.BytesIO()
    if array.dtype.kind not in _NUMBERS:
        raise TypeError(f"an array of {array.dtype} has no numbers in it")
    np.save(file, array, allow_pickle=False)
    return base64.b64encode(file.getvalue()).decode()


def _array(body: str) -> np.ndarray:
    found = np.lib.format.read_array(io.BytesIO(base64.b64decode(body, validate=True)), allow_pickle=False)
    if found.dtype.kind not in _NUMBERS:
        raise ValueError(f"an array of {found.dtype}")
    return found


def is_interval(thing: Any) -> bool:
    """Whether it is one of codac's."""
    return type(thing).__name__ == "Interval" and type(thing).__module__.startswith("codac")
