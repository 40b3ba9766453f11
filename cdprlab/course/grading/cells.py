"""A notebook's code cells, and what nbgrader's metadata says about them."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

_HIDDEN = re.compile(r"^[^\n]*BEGIN\sHIDDEN\sTESTS.*?END\sHIDDEN\sTESTS[^\n]*\n?", re.MULTILINE | re.DOTALL)


@dataclass(frozen=True)
class Cell:
    """A code cell.

    grade_id : nbgrader's name of it, else empty
    is_check, is_answer : graded automatically; to be written by the student
    tags : of the notebook; an answer's `without NAME` forbids a library function, a check's `unsplit` says that it must
        run beside the student's code
    checksum : that nbgrader wrote when the cell was handed out
    """

    name: str
    source: str
    grade_id: str = ""
    is_check: bool = False
    is_answer: bool = False
    points: float = 0.0
    tags: Sequence[str] = ()
    checksum: str = ""
    locked: bool = field(default=False)

    @property
    def visible(self) -> str:
        """Its text as students get it; an answer's without the solution is not asked for here."""
        return _HIDDEN.sub("", self.source)

    @property
    def forbidden(self) -> frozenset[str]:
        """Library functions that the answer may not call."""
        return frozenset(tag.removeprefix("without ") for tag in self.tags if tag.startswith("without "))

    @property
    def split(self) -> bool:
        """Whether the check runs where the student's code does not."""
        return "unsplit" not in self.tags

    @property
    def version(self) -> str:
        """The checksum nbgrader gives the student's version of a check."""
        parts = [self.visible, "code", str(self.is_check), str(self.is_answer), str(self.locked), self.grade_id]
        parts += [str(self.points)] if self.is_check else []
        return hashlib.md5("".join(parts).encode("utf-8", "replace")).hexdigest()


def code_cells(notebook: Mapping[str, Any]) -> list[Cell]:
    """The code cells of a notebook's JSON, as far as it makes sense."""
    found = []
    for index, raw in enumerate(notebook.get("cells") or ()):
        if isinstance(raw, Mapping) and raw.get("cell_type") == "code":
            found.append(_cell(index, raw))
    return found


def hidden_lines(source: str) -> range:
    """Lines of a check, counted from 1, that students do not get."""
    found = _HIDDEN.search(source)
    if found is None:
        return range(0)
    return range(source.count("\n", 0, found.start()) + 1, source.count("\n", 0, found.end()) + 1)


def _cell(index: int, raw: Mapping[str, Any]) -> Cell:
    source = raw.get("source", "")
    metadata = raw.get("metadata")
    metadata = metadata if isinstance(metadata, Mapping) else {}
    grader = metadata.get("nbgrader")
    grader = grader if isinstance(grader, Mapping) else {}
    grade, solution = bool(grader.get("grade")), bool(grader.get("solution"))
    points, tags = grader.get("points"), metadata.get("tags")
    return Cell(name=f"cell {index}",
                source=source if isinstance(source, str) else "".join(map(str, source)),
                grade_id=str(grader.get("grade_id") or "") if grade or solution else "",
                is_check=grade and not solution, is_answer=solution and not grade,
                points=float(points) if isinstance(points, int | float) else 0.0,
                tags=tuple(map(str, tags)) if isinstance(tags, list) else (),
                checksum=str(grader.get("checksum") or ""), locked=bool(grader.get("locked")))
