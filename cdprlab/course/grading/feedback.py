"""What comes back: a table of grades, a page for each student, a page about the class."""

from __future__ import annotations

import csv
import io
import os
import sys
import warnings
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from pathlib import Path
from statistics import median

from .batch import Result, write_whole
from .cells import Cell, hidden_lines
from .judge import Outcome
from .lesson import Lesson

# No script runs in these pages, whatever found its way into them.
_PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'">
<title>{title}</title>
<style>body {{font: 16px sans-serif; max-width: 55em; margin: 2em auto; padding: 0 1em}}
pre {{white-space: pre-wrap; background: #f2f2f2; padding: 0.6em}}
td, th {{text-align: left; padding: 0.2em 0.8em; vertical-align: top}}</style>
</head><body><h1>{title}</h1>
{body}
</body></html>
"""


def write_reports(out: Path, results: Sequence[Result], lessons: Mapping[str, Sequence[Lesson]],
                  reveal: bool = False) -> None:
    """`grades.csv`, `feedback/STUDENT/LESSON.html` and `class.html`.

    reveal : show students the hidden part of a check that they failed in it
    """
    write_whole(out / "grades.csv", grades(results))
    write_whole(out / "class.html", class_page(results))
    editions = {lesson.edition: lesson for versions in lessons.values() for lesson in versions}
    for result in results:
        if result.status != "missing":
            place = out / "feedback" / result.student / f"{result.lesson or 'unknown'}.html"
            write_whole(place, student_page(result, editions.get(result.edition), reveal))


def grades(results: Sequence[Result]) -> str:
    """The table as CSV: a row a file, a column a check."""
    checks = list(dict.fromkeys(outcome.check for result in results for outcome in result.outcomes))
    file = io.StringIO()
    table = csv.writer(file, lineterminator="\n")
    table.writerow(["student", "lesson", "status", "points", "max_points", *checks])
    for result in sorted(results, key=lambda one: (one.lesson, one.student)):
        earned = {outcome.check: f"{outcome.points:g}" for outcome in result.outcomes}
        table.writerow([result.student, result.lesson, result.status, f"{result.points:g}", f"{result.max_points:g}",
                        *(earned.get(check, "") for check in checks)])
    return file.getvalue()


def student_page(result: Result, lesson: Lesson | None, reveal: bool) -> str:
    """A student's feedback on one lesson."""
    parts = [f"<p>{escape(result.student)}: <strong>{result.points:g} of {result.max_points:g} points</strong>, "
             f"{escape(result.status)}{escape(f' ({result.note})' if result.note else '')}.</p>"]
    checks = {cell.grade_id: cell for cell in lesson.checks} if lesson else {}
    for outcome in result.outcomes:
        parts.append(f"<h2>{escape(outcome.check)}: {outcome.points:g} of {outcome.max_points:g}</h2>")
        if not outcome.split:
            parts.append("<p>This check ran beside the answer, unprotected.</p>")
        if not outcome.passed:
            parts.append(f"<pre>{escape(outcome.message if reveal else outcome.hint)}</pre>")
            if outcome.hidden and reveal and outcome.check in checks:
                parts.append(f"<p>The hidden part of the check:</p><pre>{escape(_hidden(checks[outcome.check]))}</pre>")
            elif outcome.hidden:
                parts.append("<p>This came up in the part of the check that you do not see.</p>")
    return _PAGE.format(title=escape(result.lesson or "unknown lesson"), body="\n".join(parts))


def class_page(results: Sequence[Result]) -> str:
    """How the class did: a row an exercise, and who handed in nothing."""
    parts = []
    for lesson in sorted({result.lesson for result in results}):
        handed_in = [result for result in results if result.lesson == lesson and result.status != "missing"]
        statuses = Counter(result.status for result in results if result.lesson == lesson)
        parts.append(f"<h2>{escape(lesson or 'unknown lesson')}</h2><p>" + ", ".join(
            f"{count} {escape(status)}" for status, count in statuses.most_common()) + "</p>")
        rows = [_row(check, [outcome for result in handed_in for outcome in result.outcomes if outcome.check == check])
                for check in dict.fromkeys(outcome.check for result in handed_in for outcome in result.outcomes)]
        parts.append("<table><tr><th>exercise</th><th>passed</th><th>time</th><th>commonest messages</th></tr>"
                     + "".join(rows) + "</table>")
        absent = sorted(result.student for result in results if result.lesson == lesson and result.status == "missing")
        if absent:
            parts.append(f"<p>Handed in nothing: {escape(', '.join(absent))}.</p>")
    return _PAGE.format(title="The class", body="\n".join(parts))


def _row(check: str, outcomes: Sequence[Outcome]) -> str:
    passed = sum(outcome.passed for outcome in outcomes)
    said = Counter(outcome.hint.strip()[:200] for outcome in outcomes if not outcome.passed)
    messages = "".join(f"<li>{count} × {escape(message)}</li>" for message, count in said.most_common(3))
    return (f"<tr><td>{escape(check)}</td><td>{passed} of {len(outcomes)} ({passed / len(outcomes):.0%})</td>"
            f"<td>{median(outcome.seconds for outcome in outcomes):.1f} s</td><td><ul>{messages}</ul></td></tr>")


def _hidden(check: Cell) -> str:
    lines = check.source.splitlines()
    return "\n".join(lines[line - 1] for line in hidden_lines(check.source) if line <= len(lines))


def fill_gradebook(database: Path, results: Iterable[Result]) -> int:
    """Write points into nbgrader's gradebook, for courses that keep one; returns how many results went in.

    database : gradebook.db, made if missing
    Raises MissingDependency without nbgrader.
    """
    from ...errors import MissingDependency

    try:
        from nbgrader.api import Gradebook  # type: ignore[import-untyped]
    except ImportError:
        raise MissingDependency("filling a gradebook takes nbgrader: pip install 'cdprlab[grading]'") from None

    # It calls alembic by its name, which is beside Python.
    os.environ["PATH"] = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])
    count = 0
    with warnings.catch_warnings(action="ignore"), Gradebook(f"sqlite:///{database}") as book:
        for result in results:
            if result.outcomes:
                book.update_or_create_assignment(result.lesson)
                book.update_or_create_notebook(result.lesson, result.lesson)
                book.update_or_create_student(result.student)
                for outcome in result.outcomes:
                    book.update_or_create_grade_cell(outcome.check, result.lesson, result.lesson,
                                                     max_score=outcome.max_points, cell_type="code")
                book.update_or_create_submission(result.lesson, result.student)
                for outcome in result.outcomes:
                    grade = book.find_grade(outcome.check, result.lesson, result.lesson, result.student)
                    grade.auto_score, grade.needs_manual_grade = outcome.points, False
                book.db.commit()
                count += 1
    return count
