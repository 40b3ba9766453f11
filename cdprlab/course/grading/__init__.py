"""Grading for credit: checks run where no student's code can reach, student code where it can reach nothing.

`submission` reads what was handed in, `lesson` what it is judged by, `cells` and `slices` how notebooks hang together;
`judge` runs the checks and asks, across the wall of `wire` and `split`, a `worker` in its `jail`; `batch` does so for a
folder, and `feedback` tells everybody.
"""

from .batch import Grader, Result, late
from .feedback import write_reports
from .submission import Submission, read_submissions, tidy

__all__ = ["Grader", "Result", "Submission", "late", "read_submissions", "tidy", "write_reports"]
