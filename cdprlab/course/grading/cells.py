"""A notebook's code cells, what nbgrader's metadata says about them, and lessons made of them.

An instructor keeps lessons with solutions and hidden checks as `DIR/NAME/NAME.ipynb`, older versions beside.
"""

import hashlib
import json
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ...errors import InvalidInput

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
    def hidden_lines(self) -> set[int]:
        """Lines of a check, counted from 1, that students do not get."""
        return {line for found in _HIDDEN.finditer(self.source)
                for line in range(*(self.source.count("\n", 0, place) + 1 for place in found.span()))}

    @property
    def version(self) -> str:
        """The checksum nbgrader gives the student's version of a check."""
        # Between text and name: type of cell; whether it is graded, a solution, locked.
        told = f"{self.visible}codeTrueFalseTrue{self.grade_id}{self.points}"
        return hashlib.md5(told.encode()).hexdigest()


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


def _lesson(name: str, path: Path) -> Lesson:
    text = path.read_bytes()
    try:
        cells = code_cells(json.loads(text))
    except (ValueError, TypeError, KeyError):
        raise InvalidInput(f"{path} is no notebook") from None
    return Lesson(name, cells, hashlib.sha256(text).hexdigest()[:16])
