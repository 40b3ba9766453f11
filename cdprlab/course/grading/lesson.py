"""Lessons with solutions and hidden checks, as an instructor keeps them: `DIR/NAME/NAME.ipynb`, and older ones."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from ...errors import InvalidInput
from .cells import Cell, code_cells


@dataclass(frozen=True)
class Lesson:
    """One version of a lesson.

    edition : hash of its file; hidden checks and solutions included
    """

    name: str
    cells: Sequence[Cell]
    edition: str

    @property
    def checks(self) -> list[Cell]:
        """In order."""
        return [cell for cell in self.cells if cell.kind == "check"]

    @property
    def points(self) -> float:
        """Of all checks."""
        return sum(check.points for check in self.checks)

    def likeness(self, student: Iterable[Cell]) -> tuple[int, int]:
        """How many of a student's checks came from this version; how many graded cells it shares with them."""
        versions, known = {check.version for check in self.checks}, {cell.grade_id for cell in self.cells}
        graded = [cell for cell in student if cell.grade_id in known - {""}]
        return sum(cell.checksum in versions for cell in graded), len(graded)


def load_lessons(source: Path) -> dict[str, list[Lesson]]:
    """Every lesson of a folder, its present version first.

    source : its folders NAME hold NAME.ipynb, and earlier versions under any other name
    Raises InvalidInput where there is none, and naming a file that is no notebook.
    """
    found = {}
    for present in sorted(source.glob("*/*.ipynb")):
        name = present.stem
        if name == present.parent.name:
            earlier = sorted(set(present.parent.glob("*.ipynb")) - {present}, reverse=True)
            found[name] = [_lesson(name, path) for path in [present, *earlier]]
    if not found:
        raise InvalidInput(f"no lessons in {source}: it must hold NAME/NAME.ipynb with solutions; see --source")
    return found


def most_like(lessons: Iterable[Lesson], student: Sequence[Cell]) -> Lesson:
    """The lesson and version that a student's copy came from, the first where several are as like."""
    return max(lessons, key=lambda lesson: lesson.likeness(student))


def _lesson(name: str, path: Path) -> Lesson:
    text = path.read_bytes()
    try:
        cells = code_cells(json.loads(text))
    except (ValueError, TypeError, KeyError):
        raise InvalidInput(f"{path} is no notebook") from None
    return Lesson(name, cells, hashlib.sha256(text).hexdigest()[:16])
