"""The student's side of the wall: runs their cells, answers calls, knows no check.

``python -m cdprlab.course.grading.worker`` talks over its standard streams, in a jail.
"""

import importlib
import inspect
import io
import json
import os
import pickle
import resource
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from multiprocessing.connection import Connection
from types import FrameType
from typing import Any

import numpy as np

from ... import course
from ..answers import fallback
from ..answers.plain import encode
from .wire import LARGEST, Callback, Peer, encode_error, silence

NOBODY = 65534
LIMITS = {
    resource.RLIMIT_AS: 2 * 2**30,        # memory [bytes]
    resource.RLIMIT_NPROC: 64,            # processes and threads
    resource.RLIMIT_NOFILE: 256,          # open files
    resource.RLIMIT_FSIZE: 64 * 2**20,    # of one file [bytes]
    resource.RLIMIT_CORE: 0,
}
PUBLIC = ("cdprlab", "cdprlab.course", "cdprlab.fastkit")


class Worker(Peer):
    """One student's notebook, as far as it has been run."""

    caught = BaseException   # also SystemExit: the student's own affair

    def __init__(self, inward: int, outward: int) -> None:
        from IPython.core.interactiveshell import InteractiveShell
        from traitlets.config import Config

        self.shell = InteractiveShell.instance(config=Config({"HistoryManager": {"enabled": False}}))
        setattr(self.shell, "enable_gui", lambda gui=None: None)   # noqa: B010 (`%matplotlib inline` asks for it)
        self.inward, self.outward = Connection(inward, writable=False), Connection(outward, readable=False)
        self.functions = [self.run, self.look_up, self.call]   # and what answers returned

    def run(self, source: str) -> None:
        """Run a cell as a notebook does."""
        self.shell.run_cell(source).raise_error()   # type: ignore[no-untyped-call]

    def look_up(self, name: str) -> Any:
        """What a name means now."""
        return self.shell.user_ns[name]

    def call(self, key: str | int, without: Sequence[str], arguments: Sequence[Any], options: dict[str, Any]) -> Any:
        """Call a function of the student's; raises AssertionError if it changes an array that it was given.

        without : library functions that it may not call
        """
        given = [*arguments, *options.values()]
        before = [array.tobytes() for array in _arrays(given)]
        with _refusing(without):
            value = self.function(key)(*arguments, **options)
        # Nothing of it would reach the judge; but a check that goes on with what it gave would fail at home.
        assert [array.tobytes() for array in _arrays(given)] == before, \
            f"{key} changes what it was given: work on a copy"
        self.given = given
        return value

    def function(self, key: Any) -> Callable[..., Any]:
        """The student's function of that name or number, or the judge's behind a callback."""
        if isinstance(key, Callback):
            return lambda *arguments, **options: self.ask(key.key, arguments, options)
        return self.shell.user_ns[key] if isinstance(key, str) else self.functions[key]

    def send(self, verb: str, body: Any) -> None:
        """Write plain values; what has none, or is too long, becomes an error."""
        given, self.given = self.given, ()
        try:
            text = json.dumps([verb, body if verb == "error" else encode(body, self.keep, given)]).encode()
            if len(text) > LARGEST:
                raise ValueError(f"an answer of {len(text) / 2**20:.0f} MB is too large")
        except Exception as error:
            if verb == "call":   # the caller's mistake, and nobody has been asked
                raise
            text = json.dumps(["error", encode_error(error)]).encode()
        self.outward.send_bytes(text)

    def keep(self, function: Any) -> int:
        """A number for a function that goes to the judge."""
        self.functions.append(function)
        return len(self.functions) - 1

    def receive(self) -> tuple[str, Any]:
        """Read what the judge pickled."""
        unpickler = pickle.Unpickler(io.BytesIO(self.inward.recv_bytes()))
        unpickler.persistent_load = self.function   # type: ignore[method-assign]
        return unpickler.load()


def _arrays(value: Any) -> list[np.ndarray]:
    """Every array in arguments, in a fixed order."""
    if isinstance(value, np.ndarray):
        return [value]
    parts = value.values() if isinstance(value, dict) else value if isinstance(value, list | tuple) else ()
    return [array for part in parts for array in _arrays(part)]


@contextmanager
def _refusing(names: Sequence[str]) -> Iterator[None]:
    """While it lasts some library functions raise, by whatever name they go, unless the library itself calls them."""
    found = [(name, getattr(module, name)) for module in map(importlib.import_module, PUBLIC)
             for name in names if hasattr(module, name)]
    bodies = {getattr(inspect.unwrap(thing.__init__ if inspect.isclass(thing) else thing), "__code__", None): name
              for name, thing in found}

    def watch(frame: FrameType, event: str, _: Any) -> None:
        caller = frame.f_back
        if event == "call" and frame.f_code in bodies:
            while caller is not None and caller.f_globals["__name__"] == "cdprlab.arrays":   # the gate for arguments
                caller = caller.f_back
            if caller is None or not caller.f_globals["__name__"].startswith("cdprlab."):
                raise RuntimeError(f"this exercise is about writing {bodies[frame.f_code]} yourself: the library's may "
                                   "not be called here")

    if bodies:
        sys.setprofile(watch)
    try:
        yield
    finally:
        sys.setprofile(None)


def _no_fallback(exercise: str) -> Any:
    raise RuntimeError("course.fallback is for going on at home: it answers no exercise")


def main() -> None:
    """Shut the doors behind oneself, then serve."""
    inward, outward = os.dup(0), os.dup(1)
    silence()
    if os.environ.get("CDPRLAB_JAIL") and os.getuid() == 0:
        os.setgroups([])
        os.setgid(NOBODY)
        os.setuid(NOBODY)
    for limit, most in LIMITS.items():
        with suppress(ValueError):   # less was allowed already
            resource.setrlimit(limit, (most, most))
    fallback.LIBRARY.clear()
    fallback.fallback = course.fallback = _no_fallback
    worker = Worker(inward, outward)
    with suppress(EOFError):   # until the judge hangs up
        while True:
            worker.serve(*worker.receive()[1])


if __name__ == "__main__":
    main()
