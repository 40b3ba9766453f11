"""Grading for credit: checks run where no student's code can reach, student code where it can reach nothing.

`submission` reads what was handed in, `cells` that and what it is judged by, `slices` how a notebook hangs together;
`judge` runs the checks and asks, across the wall of `wire` and `split`, a `worker` in its `jail`; `batch` does so for a
folder, and `feedback` tells everybody.
"""

from .batch import Grader, Result, late
from .feedback import write_reports
from .submission import Submission, read_roster, read_submissions, tidy

__all__ = ["Grader", "Result", "Submission", "late", "read_roster", "read_submissions", "tidy", "write_reports"]
