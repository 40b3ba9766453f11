"""The trusted run of one notebook: the instructor's cells and checks here, the student's functions in a worker.

``python -m cdprlab.course.grading.judge`` reads a `Case` as JSON and writes one line of JSON a check. No line of the
student's runs in this process: it sees what `wire` makes anew, and it alone says what a check earned.
"""

from __future__ import annotations

import ast
import json
import os
import resource
import signal
import sys
import time
import traceback
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from .cells import Cell, hidden_lines
from .slices import Statement, mentioned, needed, statements, unknown, words
from .split import Lost, WorkerProcess

MEMORY = 4 * 2**30
"""Of this process [bytes]."""


@dataclass(frozen=True)
class Outcome:
    """What one check came to.

    status : graded, timed out, out of memory, stopped
    hidden : whether it failed in what students do not see
    message, hint : why it failed; the same without anything that was computed
    split : False if the check had to run where the student's code does
    """

    check: str
    points: float
    max_points: float
    status: str = "graded"
    message: str = ""
    hint: str = ""
    hidden: bool = False
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
    seconds : a cell, or a check with all its calls, may run; cells of the student's own twice that, all together
    """

    def __init__(self, lesson: Sequence[Cell], student: Sequence[Cell], command: Sequence[str],
                 seconds: float) -> None:
        self.lesson, self.student, self.seconds = lesson, student, seconds
        self.worker = WorkerProcess(command)
        self.namespace: dict[str, Any] = {"__name__": "__main__"}
        self.parsed = [statements(cell.source) for cell in lesson]
        self.wanted = self.needed_by_checks()
        self.at, self.left = 0, 2 * seconds   # how far in the student's notebook; time for own cells
        self.own = list[Cell]()
        self.trouble = ""   # why the last answer cell did not run

    def needed_by_checks(self) -> set[Statement]:
        """Statements of the whole notebook without which some later check could not run."""
        before, found = list[Statement](), set[Statement]()
        for cell, parsed in zip(self.lesson, self.parsed):
            if cell.is_check:
                found |= set(needed(before, unknown(parsed)))
            before += parsed
        return found

    def outcomes(self) -> Iterator[Outcome]:
        """One after the other, each as soon as it is known."""
        for index, cell in enumerate(self.lesson):
            if cell.is_check:
                yield self.check(index)
            elif cell.is_answer:
                self.answer(index)
            else:
                self.go_on(index)
        self.worker.stop()

    def go_on(self, index: int, after: int = 0) -> None:
        """Run what later checks need of a cell; an error shows when they look for it.

        after : a line, to begin below it
        """
        for statement in self.parsed[index]:
            if statement in self.wanted and statement.lines[0] > after:
                try:
                    with at_most(self.seconds):
                        self.execute(statement.source, self.lesson[index].name)
                except (Exception, Lost, TimeUp) as error:
                    self.trouble = self.trouble or _words_of(error)

    def answer(self, index: int) -> None:
        """Have a student's answer run in the worker, and put proxies where the solution defines names."""
        cell = self.lesson[index]
        self.trouble, names = "", sorted(set().union(*(part.binds for part in self.parsed[index])))
        for name in names:
            self.namespace.pop(name, None)
        answers = [i for i, own in enumerate(self.student) if own.grade_id == cell.grade_id]
        if not answers:
            self.trouble = "the answer's cell is missing"
            return
        place = _the_one_worked_on(self.student, answers)
        try:
            before = self.own_cells(place)
            self.own += before
            self.help(index, [*self.own, self.student[place]])
            for own in before:
                self.run_own(own)
            if before:   # the instructor's names mean again what the instructor says
                self.help(index, [*self.own, self.student[place]])
            with at_most(self.seconds):
                self.trouble = self.worker.run(self.student[place].source)
            for own in self.own_cells(self.end_of_exercise(index, place)):
                self.run_own(own)
            with at_most(self.seconds):
                self.namespace |= self.worker.look_up(names, cell.forbidden)
        except (Lost, TimeUp) as error:
            self.worker.leave_out(self.student[place].source)
            self.trouble = _words_of(error)
        used = cell.forbidden & words(self.student[place].source)
        if used:
            self.trouble = f"write it yourself: {', '.join(sorted(used))} may not be called here"
            for name in names:
                self.namespace.pop(name, None)

    def own_cells(self, end: int) -> list[Cell]:
        """Cells that are the student's own, from where we are to a place in their notebook."""
        lessons = {cell.visible.rstrip() for cell in self.lesson}
        found = [cell for cell in self.student[self.at:end]
                 if not cell.grade_id and cell.source.rstrip() not in lessons]
        self.at = max(self.at, end)
        return found

    def end_of_exercise(self, index: int, place: int) -> int:
        """Where, in the student's notebook, the next check or answer stands."""
        graded = {cell.grade_id for cell in self.lesson if cell.grade_id}
        after = range(place + 1, len(self.student))
        return next((i for i in after if self.student[i].grade_id in graded), len(self.student))

    def run_own(self, cell: Cell) -> None:
        """Run a cell that earns nothing; what goes wrong in it costs nothing but its time."""
        begun = time.monotonic()
        if self.left > 0:
            try:
                with at_most(min(self.seconds / 2, self.left)):
                    self.worker.run(cell.source)
            except (Lost, TimeUp):
                self.worker.leave_out(cell.source)
            self.left -= time.monotonic() - begun

    def help(self, index: int, cells: Sequence[Cell]) -> None:
        """Run in the worker what these cells need of the lesson as students see it."""
        program = [statement for cell in self.lesson[:index] if not cell.is_answer
                   for statement in statements(cell.visible)]
        names = set().union(*(mentioned(cell.source) for cell in cells))
        source = "\n".join(statement.source.strip("\n") for statement in needed(program, names))
        if source:
            with at_most(self.seconds):
                self.worker.run(source)

    def check(self, index: int) -> Outcome:
        """Run a check to its end, or to where it fails."""
        cell, begun = self.lesson[index], time.monotonic()
        status, message, hint, hidden, line = "graded", "", "", False, 0
        try:
            with at_most(self.seconds):
                if cell.split:
                    self.execute(cell.source, cell.name)
                else:
                    self.in_the_jail(index)
            earned = cell.points
        except (Exception, Lost, TimeUp) as error:
            earned, message = 0.0, _words_of(error)
            if isinstance(error, NameError) and self.trouble:
                message = self.trouble
            status = getattr(error, "status", "out of memory" if isinstance(error, MemoryError) else "graded")
            line = _line(error, cell.name)
            hidden = line in hidden_lines(cell.source)
            hint = _literal_text(cell.source, line) if hidden else message
            self.go_on(index, line)
        return Outcome(cell.grade_id, earned, cell.points, status, message, hint, hidden,
                       round(time.monotonic() - begun, 3), cell.split)

    def in_the_jail(self, index: int) -> None:
        """The whole check beside the student's code: only for checks that say so."""
        self.help(index, [self.lesson[index]])
        trouble = self.worker.run(self.lesson[index].source)
        if trouble:
            raise AssertionError(trouble)

    def execute(self, source: str, name: str) -> None:
        """Run the instructor's lines in the instructor's names."""
        exec(compile(source, name, "exec", dont_inherit=True, optimize=0), self.namespace)


class TimeUp(BaseException):
    """A cell ran too long; no check can catch it by `except Exception`."""

    status = "timed out"


@contextmanager
def at_most(seconds: float) -> Iterator[None]:
    """Raises TimeUp in what lasts longer."""
    def ring(*_: object) -> None:
        raise TimeUp(f"stopped after {seconds:.0f} s")

    before = signal.signal(signal.SIGALRM, ring)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def _the_one_worked_on(student: Sequence[Cell], places: Sequence[int]) -> int:
    """Of copies of an answer's cell the last that somebody wrote into."""
    written = [i for i in places if "raise NotImplementedError" not in student[i].source]
    return (written or places)[-1]


def _words_of(error: BaseException) -> str:
    text = str(error).strip()
    if not isinstance(error, AssertionError | Lost | TimeUp):
        text = f"{type(error).__name__}: {text}"
    return " ".join([text, *(f"({note})" for note in getattr(error, "__notes__", []))])[:4000]


def _line(error: BaseException, name: str) -> int:
    """The line of a cell in which an error came up."""
    lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename == name]
    return (lines[0] or 0) if lines else 0


def _literal_text(source: str, line: int) -> str:
    """What a failing statement says in its own words; computed numbers, which could tell hidden ones, as dots."""
    inside = [node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.Assert | ast.Expr | ast.Raise)
              and node.lineno <= line <= (node.end_lineno or line)]
    if not inside:
        return "A check that you do not see has failed."
    said = [part for node in ast.walk(inside[-1]) for part in
            ([node.value] if isinstance(node, ast.Constant) else ["…"] if isinstance(node, ast.FormattedValue) else [])
            if isinstance(part, str)]
    return "".join(said).strip() or "A check that you do not see has failed."


def _only_read(*roots: str) -> None:
    """From now on this process opens nothing but what lies in these folders: an answer may be a path."""
    allowed = tuple(os.path.realpath(root) for root in roots)

    def watch(event: str, arguments: tuple[Any, ...]) -> None:
        if event == "open" and isinstance(arguments[0], str) \
                and not os.path.realpath(arguments[0]).startswith(allowed):
            raise PermissionError(f"not while grading: {arguments[0][:100]}")

    sys.addaudithook(watch)


def main() -> None:
    """One case in, outcomes out."""
    case = json.load(sys.stdin)
    record = os.fdopen(os.dup(1), "w", encoding="utf-8")
    nowhere = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1, 2):   # what checks print is for students
        os.dup2(nowhere, stream)
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    judge = Judge([Cell(**cell) for cell in case["lesson"]], [Cell(**cell) for cell in case["student"]],
                  case["command"], case["seconds"])
    _only_read(sys.prefix, sys.base_prefix, str(Path(__file__).parents[3]), "/usr", "/dev", "/etc", "/proc",
               os.getcwd(), os.environ.get("NUMBA_CACHE_DIR", sys.prefix))
    for outcome in judge.outcomes():
        print(json.dumps(asdict(outcome)), file=record, flush=True)


if __name__ == "__main__":
    main()
