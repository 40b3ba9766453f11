"""A notebook's code cells, and what nbgrader's metadata says about them."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

_HIDDEN = re.compile(r"^[^\n]*BEGIN\sHIDDEN\sTESTS.*?END\sHIDDEN\sTESTS[^\n]*\n?", re.MULTILINE | re.DOTALL)


@dataclass(frozen=True)
class Cell:
    """A code cell.

    grade_id : nbgrader's name of an answer or a check, else empty
    kind : "answer" for the student to write, "check" graded automatically, else empty
    tags : of the notebook; an answer's `without NAME` forbids a library function, a check's `unsplit`
        says that it must run beside the student's code
    checksum : that nbgrader wrote when the cell was handed out
    """

    source: str
    grade_id: str = ""
    kind: str = ""
    points: float = 0.0
    tags: Sequence[str] = ()
    checksum: str = ""

    @property
    def visible(self) -> str:
        """Its text without hidden tests."""
        return _HIDDEN.sub("", self.source)

    @property
    def forbidden(self) -> set[str]:
        """Library functions that the answer may not call."""
        return {tag.removeprefix("without ") for tag in self.tags if tag.startswith("without ")}

    @property
    def split(self) -> bool:
        """Whether the check runs where the student's code does not."""
        return "unsplit" not in self.tags

    @property
    def hidden(self) -> str:
        """The text of the tests that students do not get."""
        return "".join(_HIDDEN.findall(self.source))

    @property
    def hidden_lines(self) -> range:
        """Lines of a check, counted from 1, that students do not get."""
        found = _HIDDEN.search(self.source)
        if found is None:
            return range(0)
        first, behind = (self.source.count("\n", 0, place) + 1 for place in found.span())
        return range(first, behind)

    @property
    def version(self) -> str:
        """The checksum nbgrader gives the student's version of a check."""
        parts = [self.visible, "code", "True", "False", "True", self.grade_id, str(self.points)]
        return hashlib.md5("".join(parts).encode()).hexdigest()


def code_cells(notebook: Any) -> list[Cell]:
    """The code cells of a notebook's JSON, as far as it makes sense."""
    return [_cell(raw) for raw in notebook["cells"] if _mapping(raw).get("cell_type") == "code"]


def _cell(raw: dict[str, Any]) -> Cell:
    source, metadata = raw.get("source", ""), _mapping(raw.get("metadata"))
    grader, tags = _mapping(metadata.get("nbgrader")), metadata.get("tags")
    kinds = [kind for kind, key in (("answer", "solution"), ("check", "grade")) if grader.get(key)]
    points = grader.get("points")
    return Cell(source="".join(map(str, source)) if isinstance(source, str | list) else "",
                grade_id=str(grader.get("grade_id") or "") if kinds else "",
                kind=kinds[0] if len(kinds) == 1 else "",   # both: graded by hand
                points=float(min(points, 1e6)) if isinstance(points, int | float) else 0.0,
                tags=[str(tag) for tag in tags] if isinstance(tags, list) else (),
                checksum=str(grader.get("checksum") or ""))


def _mapping(thing: Any) -> dict[str, Any]:
    return thing if isinstance(thing, dict) else {}
