"""Grading a folder: every file becomes a result, each result a file, and what was graded stays graded."""

import hashlib
import json
import os
import pickle
import secrets
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from datetime import datetime, timedelta
from itertools import chain
from pathlib import Path
from threading import Lock

from joblib import Parallel, delayed
from pydantic import TypeAdapter

from ...errors import InvalidInput, quoted
from ...world.files import write_text
from .cells import Cell, Lesson, load_lessons
from .jail import PACKAGE, find_jail
from .judge import Outcome
from .submission import Submission, read_cells


@dataclass(frozen=True)
class Result:
    """What one file came to.

    status : graded, late, missing, broken file, no such lesson, timed out, out of memory, stopped, another version
    points : what its checks earned, less the penalty
    note : what else there is to say
    late : whether the platform says so
    key : of all that the outcomes depend on, the lesson's version among it
    """

    student: str
    lesson: str
    status: str
    points: float = 0.0
    max_points: float = 0.0
    note: str = ""
    handed_in: str = ""
    late: bool = False
    key: str = ""
    outcomes: Sequence[Outcome] = ()


class Grader:
    """A course's lessons, jail and folder of results.

    source : lessons with solutions
    out : where results go, and the course's secret
    trust : run student code without a jail if there is none
    seconds : the longest a cell or a check may take; a notebook five times that
    """

    def __init__(self, source: Path, out: Path, trust: bool = False, seconds: float = 60.0) -> None:
        self.lessons, self.out, self.seconds = load_lessons(source), out, seconds
        self.jail, python = find_jail(trust, [source, out])
        self.command = [*python, "-m", f"{__package__}.worker"]
        self.proving = Lock()
        secret = out / "secret.txt"
        if not secret.exists():
            write_whole(secret, secrets.token_hex(16))
            secret.chmod(0o600)
        self.secret = secret.read_text(encoding="utf-8")

    def grade(self, submissions: Sequence[Submission], lesson: str | None = None, jobs: int = -1,
              progress: Callable[[int, int], None] | None = None) -> list[Result]:
        """The result of every file, graded now or before; of two for one lesson the later's.

        lesson : the one to grade; files that are named after another are left out
        jobs : processes at once, -1 for all cores
        """
        if lesson is not None and lesson not in self.lessons:
            raise InvalidInput(f"there is no lesson {quoted(lesson)}; there are {', '.join(self.lessons)}")
        chosen = [one for one in sorted(submissions, key=lambda one: one.when)
                  if lesson in (None, one.name) or one.name not in self.lessons]
        work = Parallel(n_jobs=jobs, prefer="threads", return_as="generator")
        latest = dict[tuple[str, str], Result]()
        for done, result in enumerate(work(delayed(self.one)(one, lesson or one.name) for one in chosen), start=1):
            latest[result.student, result.lesson] = result
            if progress is not None:
                progress(done, len(chosen))
        return [self.keep(result) for result in latest.values()]

    def one(self, submission: Submission, name: str) -> Result:
        """The result of one file.

        name : of the lesson it should be; under any other name it is the one whose cells it has
        """
        versions = self.lessons.get(name, [])
        blank = Result(submission.student, name, "no such lesson", late=submission.late,
                       max_points=versions[0].points if versions else 0.0,
                       handed_in=submission.when.isoformat(" ", "seconds"))
        try:
            data = submission.read()
            cells, mended = read_cells(data)
        except Exception as error:   # whatever a parser makes of what is no notebook
            return replace(blank, status="broken file",
                           note=f"no notebook: {type(error).__name__}: {error}"[:200])
        lesson = max(versions or chain(*self.lessons.values()), key=lambda lesson: lesson.likeness(cells))
        same, shared = lesson.likeness(cells)
        if not versions and not shared:
            return blank
        status, note = "graded", ""
        if mended:
            status, note = "broken file", mended
        elif not same and any(cell.kind == "check" and cell.checksum for cell in cells):
            status, note = "another version", "its checks are those of no version in --source"
        for outcome in self.prove(lesson).outcomes:
            if not outcome.passed:
                note = f"{lesson.name}: its own solution fails {outcome.check}: {outcome.message[:200]}"
                return replace(blank, note=note)
        head = f"{submission.student}\0{lesson.edition}\0{self.secret}\0{_EDITION}\0"
        key = hashlib.sha256(head.encode() + data).hexdigest()
        return self.judged(replace(blank, lesson=lesson.name, status=status, note=note, key=key), lesson, cells)

    def judged(self, blank: Result, lesson: Lesson, cells: Sequence[Cell]) -> Result:
        """A result with the outcomes of a lesson's checks on a student's cells, found now or before."""
        with suppress(OSError, ValueError):
            kept = TypeAdapter(Result).validate_json(self.place(blank).read_bytes())
            if kept.key == blank.key:
                return kept
        outcomes = self.run(lesson, cells, blank.student)
        status = blank.status
        if status == "graded":
            status = min({outcome.status for outcome in outcomes} - {"graded"}, default=status)
        return self.keep(replace(blank, status=status, outcomes=outcomes, max_points=lesson.points,
                                 points=sum(outcome.points for outcome in outcomes)))

    def run(self, lesson: Lesson, cells: Sequence[Cell], student: str) -> list[Outcome]:
        """The outcomes of a judge of its own, one a check."""
        case = pickle.dumps([lesson.cells, cells, self.command, self.seconds])
        environment = {**os.environ, "PYTHONPATH": str(PACKAGE.parent), "MPLBACKEND": "Agg", "OMP_NUM_THREADS": "1",
                       "CDPRLAB_SEED": f"{self.secret} {student}"}
        ended = "stopped"
        with tempfile.TemporaryDirectory() as folder:
            process = subprocess.Popen([sys.executable, "-m", f"{__package__}.judge"], stdin=subprocess.PIPE,
                                       stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, cwd=folder,
                                       env=environment, start_new_session=True)
            try:
                process.communicate(case, 5 * self.seconds)
            except subprocess.TimeoutExpired:
                ended = "timed out"
            finally:
                with suppress(ProcessLookupError):
                    os.killpg(process.pid, signal.SIGKILL)
                told, _ = process.communicate()
        outcomes = [Outcome(**json.loads(line)) for line in told.splitlines() if line.endswith(b"}")]
        return outcomes + [Outcome(check.grade_id, 0.0, check.points, ended, f"not judged: the notebook {ended}")
                           for check in lesson.checks[len(outcomes):]]

    def prove(self, lesson: Lesson) -> Result:
        """The result of the lesson's own solutions: unless they earn full marks here, nobody can be graded."""
        blank = Result(".solution", lesson.name, "graded", key=lesson.edition + _EDITION)
        with self.proving:
            return self.judged(blank, lesson, lesson.cells)

    def missing(self, results: Iterable[Result], roster: Iterable[str]) -> list[Result]:
        """A result for each lesson that somebody handed in and somebody of a roster did not."""
        there = {(result.student, result.lesson) for result in results}
        return [Result(student, name, "missing", max_points=self.lessons[name][0].points)
                for name in sorted({name for _, name in there} & set(self.lessons))
                for student in roster if (student, name) not in there]

    def place(self, result: Result) -> Path:
        """The file of a result."""
        return self.out / "results" / result.student / f"{result.lesson or 'unknown'}.json"

    def keep(self, result: Result) -> Result:
        """Write a result, whole or not at all."""
        write_whole(self.place(result), json.dumps(asdict(result), indent=1) + "\n")
        return result


def late(result: Result, due: Mapping[str, datetime], penalty: float) -> Result:
    """A result less what it loses for being late.

    due : lesson → when; "" for all others
    penalty : share of the points lost with each day begun after it
    """
    when = due.get(result.lesson, due.get(""))
    handed_in = datetime.fromisoformat(result.handed_in)
    early = (when - handed_in) // timedelta(days=1) if when else 0   # whole days
    if early >= 0 and not result.late:
        return result
    left = max(0.0, 1 - penalty * max(1, -early))
    return replace(result, points=result.points * left,
                   status="late" if result.status == "graded" else result.status,
                   note="; ".join(filter(None, [result.note, f"late: {1 - left:.0%} off"])))


def write_whole(path: Path, text: str) -> None:
    """Write a file so that whoever looks sees all of it or what was there before; its folder is made if missing."""
    path.parent.mkdir(parents=True, exist_ok=True)
    write_text(path, text)


_EDITION = hashlib.sha256(b"".join(path.read_bytes() for path in sorted(Path(__file__).parent.glob("*.py")))
                          ).hexdigest()[:8]
"""Of the grader: what another one judged is judged again."""
