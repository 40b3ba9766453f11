"""Grading a folder: every file becomes a result, each result a file, and what was graded stays graded."""

from __future__ import annotations

import hashlib
import json
import os
import secrets
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, field, replace
from datetime import datetime
from pathlib import Path

from ...errors import InvalidInput
from ...world.files import write_text
from . import jail
from .cells import Cell
from .judge import Outcome
from .lesson import Lesson, load_lessons, recognize, version_of
from .submission import Submission

CELL, NOTEBOOK = 60, 300
"""The longest that a cell, a check, and a whole notebook may take [s]."""


@dataclass(frozen=True)
class Result:
    """What one file came to.

    status : graded, late, missing, broken file, no such lesson, timed out, out of memory, stopped, another version
    points : what its checks earned, less the penalty
    note : what else there is to say
    edition, key : of the lesson's version; of all that the outcomes depend on
    """

    student: str
    lesson: str
    status: str
    points: float = 0.0
    max_points: float = 0.0
    note: str = ""
    handed_in: str = ""
    edition: str = ""
    jail: str = ""
    key: str = ""
    outcomes: Sequence[Outcome] = field(default=())


@dataclass(frozen=True)
class Rules:
    """How a course grades.

    due : lesson → when; "" for all others
    penalty : share of the points lost with each day begun after it
    """

    due: Mapping[str, datetime] = field(default_factory=dict)
    penalty: float = 0.0

    def apply(self, result: Result, handed_in: Submission) -> Result:
        """The result of a file that may be late."""
        due = self.due.get(result.lesson, self.due.get(""))
        over = (handed_in.when - due).total_seconds() if due else 0.0
        if over <= 0 and not handed_in.late:
            return result
        days = max(1, -int(-over // 86400))
        left = max(0.0, 1 - self.penalty * days)
        return replace(result, points=result.points * left,
                       status="late" if result.status == "graded" else result.status,
                       note="; ".join(filter(None, [result.note, f"late: {1 - left:.0%} off"])))


class Grader:
    """A course's lessons, jail and folder of results.

    source : lessons with solutions
    out : where results go, and the course's secret
    trust : run student code without a jail if there is none
    seconds : the longest a cell or a check may take; a notebook five times that
    """

    def __init__(self, source: Path, out: Path, trust: bool = False, seconds: float = CELL) -> None:
        self.lessons, self.out, self.seconds = load_lessons(source), out, seconds
        self.jail, self.command = jail.command(trust)
        out.mkdir(parents=True, exist_ok=True)
        secret = out / "secret.txt"
        if not secret.exists():
            write_whole(secret, secrets.token_hex(16))
            secret.chmod(0o600)
        self.secret = secret.read_text(encoding="utf-8")

    def grade(self, submissions: Sequence[Submission], lesson: str | None = None, jobs: int = -1,
              rules: Rules | None = None, progress: Callable[[int, int], None] | None = None) -> list[Result]:
        """The result of every file, graded now or before.

        lesson : the one to grade; files that are named after another are left out
        jobs : processes at once, -1 for all cores
        """
        from joblib import Parallel, delayed

        if lesson is not None and lesson not in self.lessons:
            raise InvalidInput(f"there is no lesson {lesson!r}; there are {', '.join(self.lessons)}")
        chosen = [one for one in submissions if lesson in (None, one.name) or one.name not in self.lessons]
        rules, results = rules or Rules(), []
        work = Parallel(n_jobs=jobs, prefer="threads", return_as="generator")
        for submission, result in zip(chosen, work(delayed(self.one)(each, lesson) for each in chosen)):
            results.append(rules.apply(result, submission))
            if progress is not None:
                progress(len(results), len(chosen))
        return results

    def one(self, submission: Submission, asked: str | None = None) -> Result:
        """The result of one file."""
        blank = Result(submission.student, asked or submission.name, "broken file",
                       handed_in=submission.when.isoformat(" ", "seconds"))
        try:
            cells, mended = submission.cells()
        except ValueError as error:
            versions = self.lessons.get(blank.lesson)
            most = sum(check.points for check in versions[0].checks) if versions else 0.0
            return self.keep(replace(blank, note=str(error), max_points=most))
        name = asked or (submission.name if submission.name in self.lessons else recognize(self.lessons, cells))
        if name is None:
            return self.keep(replace(blank, status="no such lesson"))
        lesson, known = version_of(self.lessons[name], cells)
        self.prove(lesson)
        key = hashlib.sha256("\0".join([submission.student, lesson.edition, self.secret, _EDITION,
                                        hashlib.sha256(submission.data).hexdigest()]).encode()).hexdigest()
        blank = replace(blank, lesson=name, edition=lesson.edition, jail=self.jail, key=key)
        return self.kept(blank) or self.keep(self.judge(blank, lesson, cells, mended, known))

    def judge(self, blank: Result, lesson: Lesson, cells: Sequence[Cell], mended: str = "",
              known: bool = True) -> Result:
        """Run the checks of a lesson on a student's cells."""
        outcomes, ended = self.run(lesson, cells, blank.student)
        troubles = [outcome.status for outcome in outcomes if outcome.status != "graded"]
        status, note = "graded", mended
        if mended:
            status = "broken file"
        elif troubles:
            status, note = troubles[0], ended
        elif not known:
            status, note = "another version", "its checks are those of no version in --source"
        return replace(blank, status=status, note=note, outcomes=tuple(outcomes),
                       points=sum(outcome.points for outcome in outcomes),
                       max_points=sum(outcome.max_points for outcome in outcomes))

    def run(self, lesson: Lesson, cells: Sequence[Cell], student: str) -> tuple[list[Outcome], str]:
        """The outcomes of a judge of its own, one a check, and why it ended early if it did."""
        case = json.dumps({"lesson": [asdict(cell) for cell in lesson.cells],
                           "student": [asdict(cell) for cell in cells],
                           "command": self.command, "seconds": self.seconds})
        with tempfile.TemporaryDirectory() as folder:
            process = subprocess.Popen([sys.executable, "-m", f"{__package__}.judge"], text=True, encoding="utf-8",
                                       stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                                       cwd=folder, start_new_session=True, env={
                **os.environ, "PYTHONPATH": str(jail.PACKAGE.parent), "MPLBACKEND": "Agg", "OMP_NUM_THREADS": "1",
                "CDPRLAB_SEED": f"{self.secret} {student}"})
            ended, text = "stopped", ""
            try:
                text, _ = process.communicate(case, timeout=self.seconds * NOTEBOOK / CELL)
            except subprocess.TimeoutExpired as late:
                ended = "timed out"
                text = (late.stdout or b"").decode(errors="replace") if isinstance(late.stdout, bytes) else ""
            finally:
                with suppress(ProcessLookupError):
                    os.killpg(process.pid, signal.SIGKILL)
                process.communicate()
        told = [Outcome(**json.loads(line)) for line in text.splitlines() if line.endswith("}")]
        rest = [Outcome(check.grade_id, 0.0, check.points, ended, f"not judged: the notebook {ended}")
                for check in lesson.checks[len(told):]]
        return [*told, *rest], f"{len(rest)} checks not judged" if rest else ""

    def prove(self, lesson: Lesson) -> None:
        """Raise InvalidInput unless the lesson's own solutions earn full marks here: then its checks can be split."""
        blank = Result(".solution", lesson.name, "graded", edition=lesson.edition, key=lesson.edition + _EDITION)
        result = self.kept(blank) or self.keep(self.judge(blank, lesson, lesson.cells))
        for outcome in result.outcomes:
            if not outcome.passed:
                raise InvalidInput(f"{lesson.name}: its own solution fails {outcome.check}, so nobody is graded: "
                                   f"{outcome.message[:200]}")

    def place(self, result: Result) -> Path:
        """The file of a result."""
        return self.out / "results" / result.student / f"{result.lesson or 'unknown'}.json"

    def kept(self, blank: Result) -> Result | None:
        """The result of before, if all it depends on is as it was."""
        try:
            found = json.loads(self.place(blank).read_text(encoding="utf-8"))
            outcomes = tuple(Outcome(**outcome) for outcome in found.pop("outcomes"))
            result = Result(**found, outcomes=outcomes)
        except (OSError, ValueError, TypeError, KeyError, AttributeError):
            return None
        return result if result.key == blank.key else None

    def keep(self, result: Result) -> Result:
        """Write a result, whole or not at all."""
        write_whole(self.place(result), json.dumps(asdict(result), indent=1) + "\n")
        return result


def missing(results: Iterable[Result], roster: Iterable[str]) -> list[Result]:
    """A result for each lesson that somebody of a roster did not hand in."""
    known = list(results)
    most = {result.lesson: result.max_points for result in known if result.outcomes}
    there = {(result.student, result.lesson) for result in known}
    return [Result(student, lesson, "missing", max_points=points) for lesson, points in sorted(most.items())
            for student in roster if (student, lesson) not in there]


def write_whole(path: Path, text: str) -> None:
    """Write a file so that whoever looks sees all of it or what was there before; its folder is made if missing."""
    path.parent.mkdir(parents=True, exist_ok=True)
    write_text(path, text)


_EDITION = hashlib.sha256(b"".join(path.read_bytes() for path in sorted(Path(__file__).parent.glob("*.py")))
                          ).hexdigest()[:8]
"""Of the grader: what another one judged is judged again."""
