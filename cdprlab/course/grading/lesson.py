"""Lessons with solutions and hidden checks, as an instructor keeps them: `DIR/NAME/NAME.ipynb`, and older ones."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
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
    cells: tuple[Cell, ...]
    edition: str
    text: bytes

    @property
    def checks(self) -> list[Cell]:
        """In order."""
        return [cell for cell in self.cells if cell.is_check]

    @property
    def grade_ids(self) -> set[str]:
        """Of answers and checks."""
        return {cell.grade_id for cell in self.cells if cell.grade_id}

    def agreement(self, student: Sequence[Cell]) -> int:
        """How many of a student's checks came from this version."""
        versions = {cell.version for cell in self.checks}
        return sum(bool(versions & {cell.checksum, cell.version}) for cell in student if cell.is_check)


def load_lessons(source: Path) -> dict[str, list[Lesson]]:
    """Every lesson of a folder, its present version first.

    source : its folders NAME hold NAME.ipynb, and earlier versions under any other name
    Raises InvalidInput where there is none, and naming a file that is no notebook.
    """
    found = {}
    for folder in sorted(path for path in source.glob("*") if path.is_dir()):
        present = folder / f"{folder.name}.ipynb"
        if present.is_file():
            earlier = sorted(set(folder.glob("*.ipynb")) - {present}, reverse=True)
            found[folder.name] = [_lesson(folder.name, path) for path in [present, *earlier]]
    if not found:
        raise InvalidInput(f"no lessons in {source}: it must hold NAME/NAME.ipynb with solutions; see --source")
    return found


def version_of(lessons: Sequence[Lesson], student: Sequence[Cell]) -> tuple[Lesson, bool]:
    """The version a student's copy came from, the newest where several agree; False where none does."""
    best = max(lessons, key=lambda lesson: lesson.agreement(student))
    handed_out = any(cell.is_check and cell.checksum for cell in student)
    return best, best.agreement(student) > 0 or not handed_out


def recognize(lessons: Mapping[str, Sequence[Lesson]], student: Sequence[Cell]) -> str | None:
    """The lesson most of whose graded cells a notebook has, if it has any."""
    ids = {cell.grade_id for cell in student if cell.grade_id}
    shared = {name: max(len(ids & version.grade_ids) for version in versions) for name, versions in lessons.items()}
    best = max(shared, key=lambda name: shared[name])
    return best if shared[best] else None


def _lesson(name: str, path: Path) -> Lesson:
    text = path.read_bytes()
    try:
        cells = code_cells(json.loads(text))
    except (ValueError, AttributeError):
        raise InvalidInput(f"{path} is no notebook") from None
    return Lesson(name, tuple(cells), hashlib.sha256(text).hexdigest()[:16], text)
