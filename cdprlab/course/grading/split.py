"""The judge's side of the wall: a worker that can be replaced, and proxies for what it defines."""

from __future__ import annotations

import io
import json
import subprocess
from collections.abc import Callable, Collection, Sequence
from typing import Any, BinaryIO, cast

import numpy as np

from ...errors import CdprError
from . import wire

_NONSENSE = (wire.Garbled, ValueError, KeyError, TypeError, IndexError, AttributeError, RecursionError)
"""What a message that no worker of ours would write may raise here."""


class Lost(BaseException):
    """The worker is gone; no check can catch it by `except Exception`.

    status : why
    """

    def __init__(self, status: str, message: str) -> None:
        super().__init__(message)
        self.status = status


class Answer:
    """A function of the student's: a call goes through the wall and comes back as plain values."""

    def __init__(self, worker: WorkerProcess, key: str | int, without: Collection[str] = ()) -> None:
        self.worker, self.key, self.without = worker, key, without
        self.__name__ = str(key)

    def __call__(self, *arguments: Any, **options: Any) -> Any:
        return self.worker.call(self, arguments, options)


class WorkerProcess:
    """A process that runs the student's cells; started when first needed, and anew after it was lost.

    command : starts it
    """

    def __init__(self, command: Sequence[str]) -> None:
        self.command = command
        self.process: subprocess.Popen[bytes] | None = None
        self.history: list[str] = []    # cells it ran, for its successor
        self.callbacks: list[Callable[..., Any]] = []
        self.given_up = set[str | int]()   # functions during which it was lost: never called again

    def run(self, source: str) -> str:
        """Run a cell; returns what went wrong, else ''."""
        if self.process is None:
            self.start()
        self.history.append(source)
        try:
            self.ask("run", source)
        except Exception as error:   # whatever a student's cell raises
            notes = getattr(error, "__notes__", [])
            return " ".join([f"your cell did not run: {type(error).__name__}: {error}", *notes])
        return ""

    def look_up(self, names: Sequence[str], without: Collection[str]) -> dict[str, Any]:
        """Values of names, and proxies for functions; what is not defined is left out.

        without : library functions that these may not call
        """
        found: dict[str, Any] = {}
        for name in names:
            try:
                found |= self.ask("look_up", [name], without=without)
            except Exception:   # what no answer can be: its check will miss it
                continue
        return found

    def call(self, answer: Answer, arguments: tuple[Any, ...], options: dict[str, Any]) -> Any:
        """Call a function there; arrays it wrote into change here, too."""
        if answer.key in self.given_up:
            raise Lost("stopped", f"{answer.key} is not called again")
        if self.process is None:
            self.start()
        first = len(self.callbacks)
        try:
            return self.ask("call", answer.key, sorted(answer.without), arguments, options,
                            given=[*arguments, *options.values()], written=[arguments, options])
        except Exception:
            raise
        except BaseException:
            self.given_up.add(answer.key)
            self.stop()
            raise
        finally:
            del self.callbacks[first:]

    def leave_out(self, source: str) -> None:
        """Stop, and never run this cell again."""
        self.stop()
        self.history = [cell for cell in self.history if cell != source]

    def start(self) -> None:
        """Start a worker and run there what its predecessor had run."""
        self.process = subprocess.Popen(self.command, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                        stderr=subprocess.DEVNULL)
        before, self.history = self.history, []
        for source in before:
            self.run(source)

    def stop(self) -> None:
        """End the worker and all it started."""
        if self.process is not None:
            process, self.process = self.process, None
            process.kill()
            process.communicate()

    def ask(self, *request: Any, given: Sequence[Any] = (), written: Any = (),
            without: Collection[str] = ()) -> Any:
        """Send a request and take the answer, serving callbacks meanwhile."""
        def function(key: Any) -> Answer:
            return Answer(self, key, without)

        try:
            self.send(request)
            while "call" in (reply := self.receive()):
                self.send(self.call_back(reply, function))
            error = wire.decode_error(reply["error"]) if "error" in reply else None
            for index, array in reply.get("changed", ()):
                np.copyto(list(wire.arrays(written))[index], wire.decode(array))
            value = None if error else wire.decode(reply["value"], given, function)
        except (EOFError, BrokenPipeError):
            raise Lost("stopped", "your code ended the program that runs it") from None
        except CdprError:   # a world that is none
            raise
        except _NONSENSE:
            raise Lost("stopped", "your code spoke out of turn") from None
        if error:
            raise error
        return value

    def receive(self) -> dict[str, Any]:
        """The worker's next message."""
        assert self.process is not None and self.process.stdout
        return dict(json.loads(wire.receive(cast(BinaryIO, self.process.stdout))))

    def call_back(self, reply: dict[str, Any], function: Callable[[Any], Answer]) -> tuple[Any, ...]:
        """Call a function of the judge's for the worker."""
        try:
            called = self.callbacks[int(reply["call"])]
            arguments = wire.decode(reply["arguments"], (), function)
            return "value", called(*arguments, **wire.decode(reply["options"], (), function))
        except Exception as error:   # goes back to who called
            return "error", wire.encode_error(error)

    def send(self, message: tuple[Any, ...]) -> None:
        """Pickle a message into the worker."""
        assert self.process is not None and self.process.stdin
        file = io.BytesIO()
        wire.InwardPickler(file, self.key_of).dump(message)
        wire.send(cast(BinaryIO, self.process.stdin), file.getvalue())

    def key_of(self, thing: Any) -> str | int | wire.Callback | None:
        """What stands for a function that cannot go to the worker."""
        if isinstance(thing, Answer):
            return thing.key
        if not wire.stays(thing):
            return None
        self.callbacks.append(thing)
        return wire.Callback(len(self.callbacks) - 1)
