"""What crosses the wall between the judge and the student's worker.

Inward go pickles: the worker has nothing to lose. Outward go JSON and, within it, arrays as
`.npy`, and the judge makes every object anew from a table of kinds: no class, no method and no
pickle of the student's ever comes out.
"""

from __future__ import annotations

import base64
import builtins
import io
import pickle
import sys
import traceback
from collections.abc import Callable, Sequence
from multiprocessing.connection import Connection
from types import FunctionType
from typing import Any, NamedTuple

import numpy as np

from ... import errors
from ...robot.pose import Pose
from ...world import World

LARGEST = 64 * 2**20
"""Of one message [bytes]."""

_COLLECTIONS: tuple[Any, ...] = (dict, tuple, set, frozenset, list)
_NUMBERS = "biufcU"
"""Kinds of arrays that cross, text among them."""


class Callback(NamedTuple):
    """Stands in a message for a function on the other side."""

    key: str | int


class Peer:
    """One side of the wall: calls functions of the other side, and serves its calls meanwhile.

    functions : that the other side may call by their numbers
    caught : what the other side is told when they raise it
    """

    given: Sequence[Any] = ()   # arguments of the call that is going to be answered
    inward: Connection
    outward: Connection
    functions: list[Callable[..., Any]]
    caught: type[BaseException] = Exception

    def ask(self, *request: Any) -> Any:
        """Call a function of the other side, by key, arguments and options; raises what it raises."""
        self.send("call", request)
        while True:
            verb, body = self.receive()
            if verb == "value":
                return body
            if verb == "error":
                raise decode_error(body)
            self.serve(*body)

    def serve(self, key: Any, arguments: Any, options: Any = None) -> None:
        """Answer a call."""
        try:
            reply = "value", self.function(key)(*arguments, **options or {})
        except self.caught as error:
            reply = "error", encode_error(error)
        self.send(*reply)

    def function(self, key: Any) -> Callable[..., Any]:
        """What a key stands for on this side."""
        return self.functions[key]

    def send(self, verb: str, body: Any) -> None:
        """Write a message."""
        raise NotImplementedError

    def receive(self) -> tuple[str, Any]:
        """Read a message."""
        raise NotImplementedError


# --- inward -----------------------------------------------------------------------------------
class InwardPickler(pickle.Pickler):
    """Pickles what goes to the worker; functions that only the judge has go by a key.

    key_of : gives that key, and None for anything else
    """

    def __init__(self, file: io.BytesIO, key_of: Callable[[Any], Any]) -> None:
        super().__init__(file, protocol=5)
        self.persistent_id = key_of   # type: ignore[method-assign]

    def reducer_override(self, thing: Any) -> Any:
        """Intervals go by their bounds."""
        return (type(thing), (thing.lb(), thing.ub())) if _is_interval(thing) else NotImplemented


def stays(function: Any) -> bool:
    """Whether a function can be imported by nobody else: a check's own, or a local one."""
    home = sys.modules.get(getattr(function, "__module__", ""))
    return isinstance(function, FunctionType) and (
        function.__module__ == "__main__" or getattr(home, function.__qualname__, None) is not function)


# --- outward ----------------------------------------------------------------------------------
def encode(value: Any, key_of: Callable[[Any], int], given: Sequence[Any] = ()) -> Any:
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
    for plain in (bool, int, float, str):
        if isinstance(value, plain) and not isinstance(value, np.generic):
            return plain(value)
    if isinstance(value, dict):
        return {"dict": [inner(pair) for pair in value.items()]}
    for collection in _COLLECTIONS:
        if isinstance(value, collection):
            return {collection.__name__: [inner(part) for part in value]}
    if isinstance(value, Pose):
        return {"Pose": [_npy(value.position), _npy(value.rotation)]}
    if isinstance(value, World):
        return {"World": inner(value.to_dict())}
    if _is_interval(value):
        return inner((value.lb(), value.ub()))
    if isinstance(value, np.generic | complex):
        return {"scalar": _npy(value)}
    if hasattr(value, "__array__"):
        return {"array": _npy(value)}
    if hasattr(value, "__iter__"):   # range, map, zip, generators
        return inner(list(value))
    if callable(value):
        return {"function": key_of(value)}
    raise TypeError(f"an answer is numbers, arrays, text, lists, poses or worlds, not {type(value).__name__}")


def decode(message: Any, function: Callable[[Any], Any], given: Sequence[Any] = ()) -> Any:
    """The value that `encode` wrote, every part of it made here; raises whatever anything else makes it raise.

    function : makes the callable that a key stands for
    given : the same arguments
    """
    if not isinstance(message, dict):
        return message
    ((kind, body),) = message.items()
    if kind == "given":
        return given[body]
    if kind == "array":
        return _array(body)
    if kind == "scalar":
        return _array(body)[()]
    if kind == "Pose":
        position, rotation = map(_array, body)
        Pose(position, matrix=rotation)   # raises unless it is one; below nothing is rounded again
        return Pose.of(position, rotation)
    if kind == "World":
        return World.from_dict(decode(body, function))
    if kind == "function":
        return function(body)
    for collection in _COLLECTIONS:
        if kind == collection.__name__:
            return collection(decode(part, function, given) for part in body)
    raise ValueError(f"no {kind!r:.50} is known")


def encode_error(error: BaseException) -> list[Any]:
    """An exception: the names of its classes, its message, the line of the student's cell it came through."""
    lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__)
             if frame.filename.startswith("<ipython-input")]
    return [[kind.__name__ for kind in type(error).__mro__], str(error)[:2000], lines[-1:]]


def decode_error(message: Any) -> Exception:
    """A fresh exception of the first class that Python or cdprlab knows by that name."""
    names, text, lines = message
    for name in map(str, names):
        kind = getattr(errors, name, None) or getattr(builtins, name, None)
        # One that says "that was all" would end a loop over answers early, and in peace.
        if isinstance(kind, type) and issubclass(kind, Exception) and not issubclass(kind, StopIteration):
            break
    else:
        kind, text = RuntimeError, f"{names[0]}: {text}"
    found = kind.__new__(kind, str(text))
    found.args = (str(text),)
    found.__notes__ = [f"(line {int(line)} of your cell)" for line in lines]
    return found


def words_of(error: BaseException) -> str:
    """What an error says, and where it came up."""
    kind = "" if isinstance(error, AssertionError) or not isinstance(error, Exception) else f"{type(error).__name__}: "
    return " ".join([kind + str(error).strip(), *getattr(error, "__notes__", [])])[:4000]


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


def _is_interval(thing: Any) -> bool:
    return type(thing).__name__ == "Interval" and type(thing).__module__.startswith("codac")
