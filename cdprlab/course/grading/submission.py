"""What students handed in: files in a folder or in a learning platform's zip, read as they are, never unpacked."""

from __future__ import annotations

import codecs
import json
import re
import unicodedata
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass, replace
from datetime import datetime
from pathlib import Path, PurePosixPath

from ...errors import InvalidInput
from .cells import Cell, code_cells

LARGEST = 64 * 2**20
"""Of one file [bytes]."""
MOST = 20_000
"""Files in one zip."""

# lovelaceada_LATE_1234_56789_00_first_flight-1.ipynb; Ada Lovelace_1234_assignsubmission_file_/00_first_flight.ipynb
_CANVAS = re.compile(r"(?P<student>[^_]+)_(?P<late>LATE_)?(?P<id>\d+)_\d+_(?P<name>.+)")
_MOODLE = re.compile(r"(?P<student>.+?)_(?P<id>\d+)_assignsubmission_file_?/?(?P<name>.+)")
_AGAIN = re.compile(r"(-\d+| ?\(\d+\))$")


@dataclass(frozen=True)
class Submission:
    """One file.

    student, name : who, and the lesson as the file's name says, else empty
    when : when it was handed in
    late : whether the platform marked it so
    data : its bytes; one more than LARGEST where there are more
    number : the platform's of the student, else empty
    """

    student: str
    name: str
    when: datetime
    data: bytes
    late: bool = False
    number: str = ""

    def cells(self) -> tuple[list[Cell], str]:
        """Its code cells, and what had to be mended to read them; raises ValueError where that is impossible."""
        text, mended = _text(self.data)
        try:
            notebook = json.loads(text, strict=False)
        except RecursionError:
            raise ValueError("nested too deeply") from None
        except ValueError as error:
            raise ValueError(f"no notebook: {error}") from None
        if not isinstance(notebook, dict) or not isinstance(notebook.get("cells"), list):
            raise ValueError("no notebook: it has no list of cells")
        found = code_cells(notebook)
        if any("\0" in cell.source for cell in found):
            mended = "NUL characters"
        return found, mended


def read_submissions(folder: Path) -> list[Submission]:
    """Every notebook in a folder and in zips in it, or in one zip; the latest of each student and name.

    Raises InvalidInput if there is none.
    """
    if not folder.exists():
        raise InvalidInput(f"there is no {folder}")
    newest: dict[tuple[str, str, str], Submission] = {}
    for found in sorted(_all(folder), key=lambda one: one.when):
        newest[found.student, found.number, found.name] = found
    if not newest:
        raise InvalidInput(f"no notebooks in {folder}: it must hold STUDENT.ipynb, STUDENT/LESSON.ipynb, or the "
                           "zip that Canvas or Moodle gives")
    numbers: dict[str, set[str]] = {}
    for found in newest.values():
        numbers.setdefault(found.student, set()).add(found.number)
    return [replace(found, student=f"{found.student} {found.number}") if len(numbers[found.student]) > 1 else found
            for found in newest.values()]


def _all(folder: Path) -> Iterator[Submission]:
    if folder.is_file():
        yield from _zipped(folder)
        return
    for path in sorted(folder.rglob("*")):
        place = path.relative_to(folder)
        if path.is_symlink() or not path.is_file() or _hidden(place.parts) or len(place.parts) > 3:
            continue
        if path.suffix == ".zip":
            yield from _zipped(path)
        elif path.suffix == ".ipynb":
            with path.open("rb") as file:
                yield _submission(place.parts, datetime.fromtimestamp(path.stat().st_mtime), file.read(LARGEST + 1))


def _zipped(path: Path) -> Iterator[Submission]:
    try:
        with zipfile.ZipFile(path) as archive:
            for entry in archive.infolist()[:MOST]:
                parts = PurePosixPath(entry.filename).parts
                if entry.filename.endswith(".ipynb") and not _hidden(parts):
                    with archive.open(entry) as file:
                        yield _submission(parts, datetime(*entry.date_time), file.read(LARGEST + 1))
    except (zipfile.BadZipFile, NotImplementedError, RuntimeError, OSError, ValueError) as error:
        raise InvalidInput(f"cannot read {path}: {error}") from None


def _hidden(parts: tuple[str, ...]) -> bool:
    return any(part.startswith((".", "__MACOSX")) for part in parts)


def _submission(parts: tuple[str, ...], when: datetime, data: bytes) -> Submission:
    """Who and what, from the names of a file and the folders it is in."""
    whole = "/".join(parts[-2:]).removesuffix(".ipynb")
    found = _MOODLE.fullmatch(whole) or _CANVAS.fullmatch(parts[-1].removesuffix(".ipynb"))
    if found is not None:
        groups = found.groupdict()
        name = _AGAIN.sub("", groups["name"])
        return Submission(tidy(groups["student"]), name, when, data, bool(groups.get("late")), groups["id"])
    if len(parts) == 1:
        return Submission(tidy(whole), "", when, data)
    return Submission(tidy(parts[-2]), _AGAIN.sub("", parts[-1].removesuffix(".ipynb")), when, data)


def tidy(name: str) -> str:
    """A student's name that is a safe name of a file, and no formula in a spreadsheet.

    >>> tidy("../=ada")
    'ada'
    """
    kept = re.sub(r"[^\w .@+-]", "_", unicodedata.normalize("NFC", name))[:100]
    return kept.strip(" ._-+@") or "nameless"


def _text(data: bytes) -> tuple[str, str]:
    """A file as text, and what was wrong with it; byte order marks are nothing wrong."""
    if len(data) > LARGEST:
        raise ValueError(f"larger than {LARGEST // 2**20} MB")
    codec = "utf-16" if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)) else "utf-8-sig"
    bare = data.rstrip(b"\0") if codec == "utf-8-sig" else data
    try:
        return bare.decode(codec), "" if bare == data else "NUL characters"
    except UnicodeDecodeError:
        return bare.decode("latin-1"), "not in UTF-8, read as Latin-1"
