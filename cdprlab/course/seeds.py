"""Random numbers of checks: the same at home for everybody, each student's own when graded."""

import hashlib
import os

from ..arrays import checked


@checked
def seed(n: int) -> int:
    """A seed for a check's random numbers: n at home; under `python -m cdprlab grade` the student's own, by n.

    Graded, it follows from n, the student and a secret of the course: nobody can answer by heart, and
    grading again gives the same points.

    >>> seed(7)
    7
    """
    key = os.environ.get("CDPRLAB_SEED")
    if key is None:
        return n
    return int.from_bytes(hashlib.sha256(f"{key} {n}".encode()).digest()[:8], "big")
