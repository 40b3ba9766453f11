"""The judge's side of the wall: a worker that can be replaced, and proxies for what it defines."""

from __future__ import annotations

import io
import json
import pickle
import signal
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from multiprocessing import Pipe
from types import FunctionType
from typing import Any

from ...errors import CdprError
from ..answers.plain import decode, is_interval
from .wire import LARGEST, Callback, Peer

RUN, LOOK_UP, CALL = range(3)
"""Numbers of a worker's first functions."""


class Lost(BaseException):
    """The student's code ran too long, or is gone; no check can catch it by `except Exception`.

    status : timed out, stopped
    """

    def __init__(self, status: str, message: str) -> None:
        super().__init__(message)
        self.status = status


@contextmanager
def at_most(seconds: float) -> Iterator[None]:
    """Raises Lost in what lasts longer."""
    def ring(*_: object) -> None:
        raise Lost("timed out", f"stopped after {seconds:.0f} s")

    signal.signal(signal.SIGALRM, ring)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)


@dataclass(eq=False)
class Answer:
    """A function of the student's: a call goes through the wall and comes back as plain values."""

    worker: WorkerProcess
    key: str | int
    without: Sequence[str] = ()

    @property
    def __name__(self) -> str:
        return str(self.key)

    def __call__(self, *arguments: Any, **options: Any) -> Any:
        return self.worker.call(self, arguments, options)


class WorkerProcess(Peer):
    """A process that runs the student's cells; started when first needed, and anew after it was lost.

    command : starts it
    """

    def __init__(self, command: Sequence[str]) -> None:
        self.command = command
        self.process: subprocess.Popen[bytes] | None = None
        self.history: list[str] = []    # cells it ran, for its successor
        self.functions = []             # for callbacks
        self.given_up = set[str | int]()   # functions during which it was lost: never called again

    def run(self, source: str) -> Exception | None:
        """Run a cell; returns what went wrong. A cell during which the worker is lost never runs again."""
        self.start()
        trouble = None
        try:
            self.ask(RUN, [source])
        except Exception as error:   # whatever a student's cell raises
            trouble = error
        except Lost:
            self.stop()
            raise
        self.history.append(source)
        return trouble

    def look_up(self, names: Sequence[str], without: Sequence[str]) -> dict[str, Any]:
        """Values of names, and proxies for functions; what is not defined, or no answer can be, is left out.

        without : library functions that these may not call
        """
        self.start()
        found: dict[str, Any] = {}
        for name in names:
            with suppress(Exception):
                value = self.ask(LOOK_UP, [name])
                found[name] = Answer(self, name, without) if isinstance(value, Answer) else value
        return found

    def call(self, answer: Answer, arguments: tuple[Any, ...], options: dict[str, Any]) -> Any:
        """Call a function there; what it does to its arguments stays there."""
        if answer.key in self.given_up:
            raise Lost("stopped", f"{answer.key} is not called again")
        self.start()
        first, given = len(self.functions), self.given
        self.given = [*arguments, *options.values()]
        try:
            return self.ask(CALL, [answer.key, answer.without, arguments, options])
        except Lost:
            self.given_up.add(answer.key)
            self.stop()
            raise
        finally:
            del self.functions[first:]
            self.given = given

    def start(self) -> None:
        """Start a worker if there is none, and run there what its predecessor had run."""
        if self.process is None:
            inside, self.outward = Pipe(duplex=False)
            self.inward, outside = Pipe(duplex=False)
            with inside, outside:
                self.process = subprocess.Popen(self.command, stdin=inside.fileno(), stdout=outside.fileno(),
                                                stderr=subprocess.DEVNULL)
            before, self.history = self.history, []
            for source in before:
                self.run(source)

    def stop(self) -> None:
        """End the worker and all it started."""
        if self.process is not None:
            self.process.kill()
            self.process.wait()
            self.inward.close()
            self.outward.close()
            self.process = None

    def send(self, verb: str, body: Any) -> None:
        """Pickle a message into the worker; if nobody is there, no answer will come."""
        file = io.BytesIO()
        pickler = _InwardPickler(file, protocol=5)
        pickler.persistent_id = self.key_of   # type: ignore[method-assign]
        pickler.dump((verb, body))
        with suppress(OSError):
            self.outward.send_bytes(file.getvalue())

    def receive(self) -> tuple[str, Any]:
        """A message of plain values; raises Lost for anything else."""
        try:
            verb, body = json.loads(self.inward.recv_bytes(LARGEST))
            return verb, body if verb == "error" else decode(body, lambda key: Answer(self, key), self.given)
        except (EOFError, OSError):
            raise Lost("stopped", "your code ended the program that runs it") from None
        except (CdprError, MemoryError):   # a world that is none; an answer that fills the memory
            raise
        except Exception:
            raise Lost("stopped", "your code spoke out of turn") from None

    def key_of(self, thing: Any) -> str | int | Callback | None:
        """What stands for a function that cannot go to the worker: nobody else can import it."""
        if isinstance(thing, Answer):
            return thing.key
        if not isinstance(thing, FunctionType):
            return None
        home = thing.__module__
        if home != "__main__" and getattr(sys.modules.get(home), thing.__qualname__, None) is thing:
            return None
        self.functions.append(thing)
        return Callback(len(self.functions) - 1)


class _InwardPickler(pickle.Pickler):
    def reducer_override(self, thing: Any) -> Any:
        """Intervals go by their bounds."""
        return (type(thing), (thing.lb(), thing.ub())) if is_interval(thing) else NotImplemented
