"""The trusted run of one notebook: the instructor's cells and checks here, the student's functions in a worker.

``python -m cdprlab.course.grading.judge`` reads a pickled case and writes one line of JSON a check. No line of the
student's runs in this process: it sees what `wire` makes anew, and it alone says what a check earned.
"""

import ast
import json
import os
import pickle
import resource
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from .cells import Cell
from .slices import Statement, needed, statements
from .split import Lost, WorkerProcess, at_most
from .wire import lines_of, silence, words_of

MEMORY = 4 * 2**30
"""Of this process [bytes]."""
_CHECK = "<the lesson>"
"""Stands for a file in what its errors came through."""


@dataclass(frozen=True)
class Outcome:
    """What one check came to.

    status : graded, timed out, out of memory, stopped
    hidden : the part that students do not see, if it failed there
    message, hint : why it failed; the same without anything that was computed
    split : False if the check had to run where the student's code does
    """

    check: str
    points: float
    max_points: float
    status: str = "graded"
    message: str = ""
    hint: str = ""
    hidden: str = ""
    seconds: float = 0.0
    split: bool = True

    @property
    def passed(self) -> bool:
        """Whether it was run to its end."""
        return self.points == self.max_points


class Judge:
    """Walks through the instructor's notebook.

    lesson, student : cells of both
    command : starts a worker
    seconds : a cell, or a check with all its calls, may run; a cell of the student's own half that
    """

    def __init__(self, lesson: Sequence[Cell], student: Sequence[Cell], command: Sequence[str],
                 seconds: float) -> None:
        self.lesson, self.seconds = lesson, seconds
        unchanged = {cell.visible.rstrip() for cell in lesson}
        self.student = [cell for cell in student if cell.grade_id or cell.source.rstrip() not in unchanged]
        self.worker = WorkerProcess(command)
        self.namespace: dict[str, Any] = {"__name__": "__main__", "display": lambda *_: None}
        self.wanted = set[Statement]()   # statements without which some later check could not run
        before = list[Statement]()
        for cell in lesson:
            parsed = statements(cell.source)
            if cell.kind == "check":
                self.wanted |= set(needed(before, ends=parsed))
            before += parsed
        self.at, self.own = 0, list[str]()   # how far in the student's notebook; cells of their own up to there
        self.trouble: BaseException | None = None   # why the last answer cell did not run
        self.told = False    # whether the worker was asked something hidden

    def outcomes(self) -> Iterator[Outcome]:
        """One after the other, each as soon as it is known."""
        for index, cell in enumerate(self.lesson):
            if cell.kind == "check":
                yield self.check(index)
            elif cell.kind == "answer":
                self.answer(index)
            else:
                self.go_on(index)
        self.worker.stop()

    def go_on(self, index: int, after: int = 0) -> None:
        """Run what later checks need of a cell; an error shows when they look for it.

        after : a line, to begin below it
        """
        for statement in statements(self.lesson[index].source):
            if statement in self.wanted and statement.line > after:
                try:
                    self.execute("\n" * (statement.line - 1) + statement.source)
                except (Exception, Lost) as error:
                    self.trouble = self.trouble or error

    def answer(self, index: int) -> None:
        """Have a student's answer run in the worker, and put proxies where the solution defines names."""
        cell = self.lesson[index]
        names = set[str]().union(*(part.binds for part in statements(cell.source)))
        for name in names:
            self.namespace.pop(name, None)
        # Of copies the last that somebody wrote into.
        copies = [("raise NotImplementedError" not in own.source, i) for i, own in enumerate(self.student)
                  if own.grade_id == cell.grade_id]
        if not copies:
            self.trouble = LookupError("the answer's cell is missing")
            return
        _, place = max(copies)
        answer = self.student[place].source
        try:
            with at_most(self.seconds):
                self.worker.start()   # which is not the student's time
            self.run_own(index, place)
            self.run(self.help(index, answer))
            self.trouble = self.run(answer)
            graded = (i for i, own in enumerate(self.student) if i > place and own.grade_id)
            self.run_own(index, next(graded, len(self.student)))
            with at_most(self.seconds):
                self.namespace |= self.worker.look_up(sorted(names), sorted(cell.forbidden))
        except Lost as error:
            self.trouble = error

    def run_own(self, index: int, end: int) -> None:
        """Run what is the student's own up to a place in their notebook; what goes wrong costs nothing but its time."""
        for cell in self.student[self.at:end]:
            if not cell.grade_id:
                self.own.append(cell.source)
                with suppress(Lost):
                    self.run(self.help(index, cell.source) + cell.source, self.seconds / 2)
        self.at = max(self.at, end)

    def help(self, index: int, source: str) -> str:
        """What a cell, and the student's own before it, need of the lesson as students see it."""
        program = [statement for cell in self.lesson[:index] if cell.kind != "answer"
                   for statement in statements(cell.visible)]
        names = set[str]().union(*(own.binds | own.reads | own.later
                                   for text in [source, *self.own] for own in statements(text)))
        return "".join(f"{statement.source.rstrip()}\n" for statement in needed(program, names))

    def run(self, source: str, seconds: float | None = None) -> Exception | None:
        """Run some lines in the worker; what went wrong."""
        with at_most(seconds or self.seconds):
            return self.worker.run(source)

    def check(self, index: int) -> Outcome:
        """Run a check to its end, or to where it fails."""
        cell, begun, told = self.lesson[index], time.monotonic(), self.told
        error = self.failure(index)
        if error and told and not isinstance(error, Lost) and _line(error) not in cell.hidden_lines:
            self.worker.stop()   # what the message says must not come from what hidden checks asked
            error = self.failure(index) or AssertionError("your answer is not the same each time")
        outcome = Outcome(cell.grade_id, cell.points, cell.points, seconds=round(time.monotonic() - begun, 3),
                          split=cell.split)
        if error is None:
            return outcome
        line, message = _line(error), words_of(error)
        hidden = line in cell.hidden_lines
        hint = _literal_text(cell.source, line) if hidden else message
        if isinstance(error, NameError) and self.trouble:
            error, message = self.trouble, words_of(self.trouble)
            hint = type(error).__name__ if told and isinstance(error, Exception) else message
        self.go_on(index, line)
        status = getattr(error, "status", "out of memory" if isinstance(error, MemoryError) else "graded")
        return replace(outcome, points=0.0, status=status, message=message, hint=hint,
                       hidden=cell.hidden if hidden else "")

    def failure(self, index: int) -> BaseException | None:
        """Why a check fails, if it does."""
        cell = self.lesson[index]
        error: BaseException | None = None
        try:
            if cell.split:
                self.execute(cell.source)
            else:   # beside the student's code: only for checks that say so
                error = self.run(self.help(index, cell.source) + cell.source)
        except (Exception, Lost) as raised:
            error = raised
        if cell.hidden and (error is None or _line(error) in cell.hidden_lines):
            self.told = True
        return error

    def execute(self, source: str) -> None:
        """Run the instructor's lines in the instructor's names."""
        with at_most(self.seconds):
            exec(compile(source, _CHECK, "exec", dont_inherit=True, optimize=0), self.namespace)


def _line(error: BaseException) -> int:
    """The line of a check's cell in which an error came up."""
    return next(iter(lines_of(error, _CHECK)), 0)


def _literal_text(source: str, line: int) -> str:
    """What a failing statement says in its own words; computed numbers, which could tell hidden ones, as dots."""
    inside = [node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.Assert | ast.Expr | ast.Raise)
              and node.lineno <= line <= (node.end_lineno or line)]
    said = ["…" if isinstance(node, ast.FormattedValue) else node.value
            for found in inside[-1:] for node in ast.walk(found)
            if isinstance(node, ast.FormattedValue | ast.Constant)]
    return "".join(part for part in said if isinstance(part, str)).strip() or "A check that you do not see has failed."


def _only_read(*roots: str) -> None:
    """From now on this process opens nothing but what lies in these folders: an answer may be a path."""
    allowed = tuple(os.path.realpath(root) + os.sep for root in roots)

    def watch(event: str, arguments: tuple[Any, ...]) -> None:
        if event == "open" and isinstance(arguments[0], str) \
                and not os.path.realpath(arguments[0]).startswith(allowed):
            raise PermissionError(f"not while grading: {arguments[0]}")

    sys.addaudithook(watch)


def main() -> None:
    """One case in, outcomes out."""
    case = pickle.load(sys.stdin.buffer)
    record = os.fdopen(os.dup(1), "w", encoding="utf-8")
    silence()   # what checks print is for students
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    judge = Judge(*case)
    package = str(Path(__file__).parents[2])
    _only_read(sys.prefix, sys.base_prefix, package, f"{package}/../worlds", "/usr", "/dev", os.getcwd(),
               os.environ.get("NUMBA_CACHE_DIR", package))
    for outcome in judge.outcomes():
        print(json.dumps(asdict(outcome)), file=record, flush=True)


if __name__ == "__main__":
    main()
