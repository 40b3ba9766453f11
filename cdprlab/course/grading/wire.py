"""What crosses the wall between the judge and the student's worker.

Inward go pickles: the worker has nothing to lose. Outward goes plain data, and the judge makes every object anew: no
class, no method and no pickle of the student's ever comes out.
"""

import builtins
import os
import traceback
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

from ... import errors

LARGEST = 64 * 2**20
"""Of one message [bytes]."""


class Callback(NamedTuple):
    """Stands in a message for a function on the other side."""

    key: str | int


class Peer:
    """One side of the wall: calls functions of the other side, and serves its calls meanwhile.

    functions : that the other side may call by their numbers
    caught : what the other side is told when they raise it
    """

    given: Sequence[Any] = ()   # arguments of the call that is going to be answered
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


def silence() -> None:
    """From now on this process reads nothing, and prints to nobody."""
    nowhere = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1, 2):
        os.dup2(nowhere, stream)


def encode_error(error: BaseException) -> list[Any]:
    """An exception: the names of its classes, its message, the line of the student's cell it came through."""
    return [[kind.__name__ for kind in type(error).__mro__], str(error)[:2000],
            lines_of(error, "<ipython-input")[-1:]]


def lines_of(error: BaseException, source: str) -> list[int]:
    """Lines an exception came through, outermost first, in files whose names begin so."""
    return [frame.lineno or 0 for frame in traceback.extract_tb(error.__traceback__)
            if frame.filename.startswith(source)]


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
    return " ".join([f"{kind}{str(error).strip()}", *getattr(error, "__notes__", [])])[:4000]
