"""What comes back: a table of grades, a page for each student, a page about the class."""

import csv
import io
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from statistics import median

from ...errors import needed_by
from .batch import Result, write_whole


def write_reports(out: Path, results: Sequence[Result], reveal: bool = False) -> None:
    """`grades.csv`, `feedback/STUDENT/LESSON.html` and `class.html`.

    reveal : show students the hidden part of a check that they failed in it
    Raises MissingDependency without jinja2.
    """
    with needed_by("feedback"):
        from jinja2 import Environment
    page = Environment(autoescape=True).from_string(Path(__file__).with_name("page.html").read_text(encoding="utf-8"))
    write_whole(out / "grades.csv", grades(results))
    write_whole(out / "class.html", page.render(title="The class", results=results, Counter=Counter, median=median))
    for result in results:
        if result.status != "missing":
            write_whole(out / "feedback" / result.student / f"{result.lesson or 'unknown'}.html",
                        page.render(title=result.lesson or "unknown lesson", result=result, reveal=reveal))


def grades(results: Sequence[Result]) -> str:
    """The table as CSV: a row a file, a column a check."""
    checks = dict.fromkeys(outcome.check for result in results for outcome in result.outcomes)
    file = io.StringIO()
    table = csv.DictWriter(file, ["student", "lesson", "status", "points", "max_points", *checks],
                           extrasaction="ignore", lineterminator="\n")
    table.writeheader()
    table.writerows(vars(result) | {outcome.check: outcome.points for outcome in result.outcomes}
                    for result in sorted(results, key=lambda one: (one.lesson, one.student)))
    return file.getvalue()
