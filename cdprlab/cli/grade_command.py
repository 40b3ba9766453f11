"""``python -m cdprlab grade FOLDER``: grades what students handed in."""

import argparse
from collections import Counter
from datetime import datetime

from ..errors import InvalidInput
from .output import progress_bar


def grade(options: argparse.Namespace) -> None:
    """Grade a folder, write grades and feedback, tell how many are what."""
    from ..course.grading import Grader, late, read_roster, read_submissions, write_reports

    due = dict(map(_due, options.due))
    submissions = read_submissions(options.folder)
    roster = read_roster(options.roster) if options.roster else []
    grader = Grader(options.source, options.out, options.trust)
    with progress_bar("grading", "notebooks") as bar:
        results = [late(result, due, options.late / 100)
                   for result in grader.grade(submissions, options.lesson, options.jobs, bar)]
    results += grader.missing(results, roster)
    write_reports(options.out, results, options.reveal)
    for status, count in Counter(result.status for result in results).most_common():
        print(f"  {status:16} {count}")
    for note in sorted({result.note for result in results if result.status == "no such lesson"}):
        print(f"  {note}")
    print(f"written to {options.out}: grades.csv, class.html, results/, feedback/; jail: {grader.jail}")


def _due(text: str) -> tuple[str, datetime]:
    """A bare date is due when that day ends."""
    lesson, _, date = text.rpartition("=")
    try:
        when = datetime.fromisoformat(date)
    except ValueError:
        raise InvalidInput(f"--due takes a date such as 2026-11-30 or 2026-11-30T18:00, got {date[:200]!r}") from None
    return lesson, when.replace(hour=23, minute=59, second=59) if len(date) == 10 else when
