"""What crosses the wall between the judge and the student's worker.

Inward go pickles: the worker has nothing to lose. Outward go JSON and, within it, arrays as
`.npy`, and the judge makes every object anew from a table of kinds: no class, no method and no
pickle of the student's ever comes out.
"""

from __future__ import annotations

import base64
import builtins
import io
import json
import pickle
import struct
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from types import FunctionType
from typing import Any, BinaryIO, NamedTuple

import numpy as np

from ... import errors
from ...robot.pose import Pose
from ...world import World

LARGEST = 64 * 2**20
"""Of one message [bytes]."""

_LENGTH = struct.Struct(">Q")


class Garbled(Exception):
    """What came out of the worker is no message."""


class Callback(NamedTuple):
    """Stands in a message for a function on the other side."""

    key: str | int


# --- messages ---------------------------------------------------------------------------------
def send(stream: BinaryIO, message: bytes) -> None:
    """Write a message, its length first."""
    stream.write(_LENGTH.pack(len(message)) + message)
    stream.flush()


def receive(stream: BinaryIO) -> bytes:
    """Read a message; raises EOFError where the other side is gone, Garbled if it is too long."""
    head = stream.read(_LENGTH.size)
    if len(head) < _LENGTH.size:
        raise EOFError
    (length,) = _LENGTH.unpack(head)
    if length > LARGEST:
        raise Garbled(f"an answer of {length} bytes; {LARGEST} are allowed")
    message = stream.read(length)
    if len(message) < length:
        raise EOFError
    return message


def arrays(value: Any) -> Iterator[np.ndarray]:
    """Every array in arguments that a function may write into, in a fixed order."""
    if isinstance(value, np.ndarray):
        if value.flags.writeable:
            yield value
    elif isinstance(value, Mapping):
        for part in value.values():
            yield from arrays(part)
    elif isinstance(value, list | tuple):
        for part in value:
            yield from arrays(part)


# --- inward -----------------------------------------------------------------------------------
class InwardPickler(pickle.Pickler):
    """Pickles what goes to the worker; functions that only the judge has go by a key.

    key_of : gives that key, and None for anything else
    """

    def __init__(self, file: BinaryIO, key_of: Callable[[Any], Any]) -> None:
        super().__init__(file, protocol=5)
        self.persistent_id = key_of   # type: ignore[method-assign]

    def reducer_override(self, thing: Any) -> Any:
        """Arrays that must not be written into stay so; intervals go by their bounds."""
        if type(thing) is np.ndarray and not thing.flags.writeable:
            return read_only, (thing.copy(),)
        if _is_interval(thing):
            return type(thing), (thing.lb(), thing.ub())
        return NotImplemented


def read_only(array: np.ndarray) -> np.ndarray:
    """The array itself, locked."""
    array.setflags(write=False)
    return array


def stays(function: Any) -> bool:
    """Whether a function can be imported by nobody else: a check's own, or a local one."""
    home = sys.modules.get(getattr(function, "__module__", ""))
    return isinstance(function, FunctionType) and (
        function.__module__ == "__main__" or getattr(home, function.__qualname__, None) is not function)


# --- outward ----------------------------------------------------------------------------------
def encode(value: Any, given: Sequence[Any] = (),
           key_of: Callable[[Any], str | int] | None = None) -> Any:
    """A value as JSON; raises TypeError for what has no place in the table.

    given : arguments; where one of them is handed back, its number goes instead
    key_of : gives functions a key; without it they are refused
    """
    def inner(part: Any) -> Any:
        return encode(part, given, key_of)

    if value is None or type(value) in (bool, int, float, str):
        return value
    for number, argument in enumerate(given):
        if value is argument:
            return {"given": number}
    if isinstance(value, np.generic):
        return {"scalar": _npy(np.asarray(value))}
    if isinstance(value, np.ndarray):
        return {"array": _npy(np.asarray(value))}
    for kind in (bool, int, float, str):
        if isinstance(value, kind):
            return kind(value)
    if isinstance(value, complex):
        return {"complex": [value.real, value.imag]}
    if isinstance(value, Pose):
        return {"Pose": [_npy(value.position), _npy(value.rotation)]}
    if isinstance(value, World):
        return {"World": json.loads(json.dumps(value.to_dict()))}
    if _is_interval(value):
        return {"tuple": [value.lb(), value.ub()]}
    if isinstance(value, Mapping):
        return {"dict": [[inner(key), inner(part)] for key, part in value.items()]}
    if isinstance(value, list):
        return [inner(part) for part in value]
    for collection in (tuple, set, frozenset, range, map, zip, filter):
        if isinstance(value, collection):
            name = collection.__name__ if collection in (tuple, set, frozenset) else "list"
            return {name: [inner(part) for part in value]}
    if hasattr(value, "__array__"):
        return {"array": _npy(np.asarray(value))}
    if callable(value) and key_of is not None:
        return {"function": key_of(value)}
    raise TypeError(f"an answer is numbers, arrays, text, lists, poses or worlds, not {type(value).__name__}")


def decode(message: Any, given: Sequence[Any] = (),
           function: Callable[[Any], Any] | None = None) -> Any:
    """The value that `encode` wrote, every part of it made here; raises Garbled for anything else.

    given : the same arguments
    function : makes the callable that a key stands for
    """
    def inner(part: Any) -> Any:
        return decode(part, given, function)

    if message is None or isinstance(message, bool | int | float | str):
        return message
    if isinstance(message, list):
        return [inner(part) for part in message]
    try:
        ((kind, body),) = message.items()
        if kind == "World":
            return World.from_dict(body)
        if kind == "function" and function is not None:
            return function(body if isinstance(body, str) else int(body))
        return _TABLE[kind](body, inner, given)
    except errors.CdprError:
        raise
    except Exception as error:
        raise Garbled(f"no answer: {type(error).__name__}") from None


_TABLE: dict[str, Callable[[Any, Callable[[Any], Any], Sequence[Any]], Any]] = {
    "given": lambda body, inner, given: given[int(body)],
    "array": lambda body, inner, given: _array(body),
    "scalar": lambda body, inner, given: _array(body)[()],
    "complex": lambda body, inner, given: complex(*map(float, body)),
    "Pose": lambda body, inner, given: _pose(*map(_array, body)),
    "dict": lambda body, inner, given: {inner(key): inner(part) for key, part in body},
    "list": lambda body, inner, given: [inner(part) for part in body],
    "tuple": lambda body, inner, given: tuple(inner(part) for part in body),
    "set": lambda body, inner, given: {inner(part) for part in body},
    "frozenset": lambda body, inner, given: frozenset(inner(part) for part in body),
}


def encode_error(error: BaseException, where: str = "") -> dict[str, Any]:
    """An exception: the names of its classes, its message.

    where : of the student's code, as the message says it
    """
    names = [kind.__name__ for kind in type(error).__mro__]
    return {"names": names, "message": str(error)[:2000], "where": where}


def decode_error(message: Mapping[str, Any]) -> Exception:
    """A fresh exception of the first class that Python or cdprlab knows by that name."""
    text, where = str(message["message"]), str(message["where"])
    for name in message["names"]:
        kind = getattr(errors, str(name), None) or getattr(builtins, str(name), None)
        if isinstance(kind, type) and issubclass(kind, Exception):
            break
    else:
        kind, text = RuntimeError, f"{message['names'][0]}: {text}"
    found = kind.__new__(kind, text)
    found.args = (text,)
    if where:
        found.add_note(where)
    return found


def _npy(array: np.ndarray) -> str:
    if array.dtype.kind not in "biufcU":
        raise TypeError(f"an array of {array.dtype} has no numbers in it")
    file = io.BytesIO()
    np.save(file, array, allow_pickle=False)
    return base64.b64encode(file.getvalue()).decode()


def _array(body: str) -> np.ndarray:
    found = np.lib.format.read_array(io.BytesIO(base64.b64decode(body, validate=True)), allow_pickle=False)
    if found.dtype.kind not in "biufcU":
        raise ValueError(found.dtype)
    return found


def _pose(position: np.ndarray, rotation: np.ndarray) -> Pose:
    Pose(position, matrix=rotation)   # raises unless it is one; below nothing is rounded again
    return Pose.of(position, rotation)


def _is_interval(thing: Any) -> bool:
    return type(thing).__name__ == "Interval" and type(thing).__module__.startswith("codac")
