"""The student's side of the wall: runs their cells, answers calls, knows no check.

``python -m cdprlab.course.grading.worker`` talks over its standard streams, in a jail.
"""

from __future__ import annotations

import importlib
import io
import json
import os
import pickle
import resource
import traceback
from collections.abc import Callable, Sequence
from typing import Any, BinaryIO

import numpy as np

from ... import course
from . import wire

NOBODY = 65534
LIMITS = {
    resource.RLIMIT_AS: 2 * 2**30,        # memory [bytes]
    resource.RLIMIT_NPROC: 64,            # processes and threads
    resource.RLIMIT_NOFILE: 256,          # open files
    resource.RLIMIT_FSIZE: 64 * 2**20,    # of one file [bytes]
    resource.RLIMIT_CORE: 0,
}
PUBLIC = ("cdprlab", "cdprlab.course", "cdprlab.fastkit")


class Worker:
    """One student's notebook, as far as it has been run.

    inward, outward : messages from and to the judge
    """

    def __init__(self, inward: BinaryIO, outward: BinaryIO) -> None:
        from IPython.core.interactiveshell import InteractiveShell
        from traitlets.config import Config

        quiet = Config({"HistoryManager": {"enabled": False}})
        self.shell = InteractiveShell.instance(config=quiet)
        setattr(self.shell, "enable_gui", lambda gui=None: None)   # noqa: B010 (`%matplotlib inline` asks for it)
        self.inward, self.outward = inward, outward
        self.functions: list[Any] = []   # that answers returned
        if hasattr(course, "fallback"):   # results for who goes on without having solved an exercise
            course.fallback = _refuse("fallback")

    def serve(self) -> None:
        """Answer until the judge hangs up."""
        try:
            while True:
                self.outward_json(self.answer(self.next_request()))
        except EOFError:
            pass

    def next_request(self) -> tuple[Any, ...]:
        """What the judge wants: a verb and its arguments."""
        unpickler = pickle.Unpickler(io.BytesIO(wire.receive(self.inward)))
        unpickler.persistent_load = self.function   # type: ignore[method-assign]
        return unpickler.load()

    def answer(self, request: tuple[Any, ...]) -> dict[str, Any]:
        """Do what is wanted; whatever it raises is an answer, too."""
        verb, *arguments = request
        try:
            return getattr(self, verb)(*arguments)
        except BaseException as error:   # also SystemExit: the student's own affair
            return {"error": wire.encode_error(error, _place(error))}

    def run(self, source: str) -> dict[str, Any]:
        """Run a cell as a notebook does."""
        result = self.shell.run_cell(source)   # type: ignore[no-untyped-call]
        error = result.error_before_exec or result.error_in_exec
        if error is not None:
            raise error
        return {"value": None}

    def look_up(self, names: Sequence[str]) -> dict[str, Any]:
        """What these names mean now; names of functions stand for themselves."""
        found = {name: self.shell.user_ns[name] for name in names if name in self.shell.user_ns}
        return {"value": {"dict": [[name, {"function": name} if callable(value) else wire.encode(value)]
                                   for name, value in found.items()]}}

    def call(self, key: str | int, without: Sequence[str], arguments: tuple[Any, ...],
             options: dict[str, Any]) -> dict[str, Any]:
        """Call a function of the student's; its answer, and which of the given arrays it changed.

        without : library functions that it may not call
        """
        given = list(wire.arrays([arguments, options]))
        before = [array.copy() for array in given]
        with _Without(without):
            value = self.function(key)(*arguments, **options)
        changed = [[i, wire.encode(array)] for i, array in enumerate(given)
                   if not np.array_equal(array, before[i], equal_nan=array.dtype.kind in "fc")]
        return {"value": wire.encode(value, [*arguments, *options.values()], self.keep), "changed": changed}

    def function(self, key: Any) -> Callable[..., Any]:
        """The student's function of that name or number, or the judge's behind a callback."""
        if isinstance(key, wire.Callback):
            return lambda *arguments, **options: self.call_back(key.key, arguments, options)
        return self.shell.user_ns[key] if isinstance(key, str) else self.functions[key]

    def keep(self, function: Any) -> int:
        """A number for a function that an answer returned."""
        self.functions.append(function)
        return len(self.functions) - 1

    def call_back(self, key: str | int, arguments: tuple[Any, ...], options: dict[str, Any]) -> Any:
        """Call a function of the judge's, answering whatever it asks meanwhile."""
        self.outward_json({"call": key, "arguments": wire.encode(list(arguments), (), self.keep),
                           "options": wire.encode(options, (), self.keep)})
        while True:
            verb, *rest = self.next_request()
            if verb == "value":
                return rest[0]
            if verb == "error":
                raise wire.decode_error(rest[0])
            self.outward_json(self.answer((verb, *rest)))

    def outward_json(self, message: dict[str, Any]) -> None:
        """Send a message; one that is too long becomes an error."""
        text = json.dumps(message).encode()
        if len(text) > wire.LARGEST:
            error = ValueError(f"an answer of {len(text) / 2**20:.0f} MB is too large")
            text = json.dumps({"error": wire.encode_error(error)}).encode()
        wire.send(self.outward, text)


class _Without:
    """While it lasts, some library functions raise."""

    def __init__(self, names: Sequence[str]) -> None:
        self.places = [(module, name) for module in map(importlib.import_module, PUBLIC)
                       for name in names if hasattr(module, name)]

    def __enter__(self) -> None:
        self.kept = [getattr(module, name) for module, name in self.places]
        for module, name in self.places:
            setattr(module, name, _refuse(name))

    def __exit__(self, *_: object) -> None:
        for (module, name), function in zip(self.places, self.kept):
            setattr(module, name, function)


def _refuse(name: str) -> Callable[..., Any]:
    def refused(*_: Any, **__: Any) -> Any:
        raise RuntimeError(f"this exercise is about writing {name} yourself: the library's may not be called here")
    return refused


def _place(error: BaseException) -> str:
    """The last line of the student's own that an error came through."""
    lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__)
             if frame.filename.startswith("<ipython-input")]
    return f"line {lines[-1]} of your cell" if lines else ""


def main() -> None:
    """Shut the doors behind oneself, then serve."""
    inward, outward = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    nowhere = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1, 2):   # what student code prints goes nowhere
        os.dup2(nowhere, stream)
    if os.environ.get("CDPRLAB_JAIL") and os.getuid() == 0:
        os.setgroups([])
        os.setgid(NOBODY)
        os.setuid(NOBODY)
    for limit, most in LIMITS.items():
        hard = resource.getrlimit(limit)[1]
        most = most if hard == resource.RLIM_INFINITY else min(most, hard)
        resource.setrlimit(limit, (most, most))
    Worker(inward, outward).serve()


if __name__ == "__main__":
    main()
