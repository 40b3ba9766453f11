"""What students handed in: files in a folder or in a learning platform's zip, read as they are, never unpacked."""

import csv
import json
import re
import unicodedata
import zipfile
import zlib
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from datetime import datetime
from functools import partial
from pathlib import Path, PurePath, PurePosixPath
from typing import Any

from ...errors import InvalidInput
from .cells import Cell, code_cells

LARGEST = 64 * 2**20
"""Of one file [bytes]."""
MOST = 20_000
"""Files in one zip."""

# lovelaceada_LATE_1234_56789_00_first_flight-1.ipynb; Ada Lovelace_1234_assignsubmission_file_/00_first_flight.ipynb.
# Only the platform's part of a name tells who it is: what follows is the student's choice.
_CANVAS = re.compile(r"(?P<student>[^_/]+)_(?P<late>LATE_)?(?P<number>\d+)_\d+_(?P<name>[^/]+)")
_MOODLE = re.compile(r"(?P<student>[^/]+?)_(?P<number>\d+)_assignsubmission_file_?/?(?P<late>)(?:.*/)?(?P<name>.+)")
_PLAIN = re.compile(r"(?P<student>[^/]+)(?P<number>)(?P<late>)(?:/(?:.*/)?(?P<name>.+))?")
_AGAIN = re.compile(r"(-\d+| ?\(\d+\))$")


@dataclass(frozen=True)
class Submission:
    """One file.

    student, name : who, and the lesson as the file's name says, else empty
    when : when it was handed in
    open : its bytes
    late : whether the platform marked it so
    number : tells students of one name apart, else empty
    """

    student: str
    name: str
    when: datetime
    open: Callable[[], Any]
    late: bool = False
    number: str = ""

    def read(self) -> bytes:
        """Its bytes; one more than LARGEST where there are more."""
        with self.open() as file:
            return bytes(file.read(LARGEST + 1))


def read_cells(data: bytes) -> tuple[list[Cell], str]:
    """A file's code cells, and what had to be mended to read them; byte order marks are nothing.

    Raises whatever a broken file can make a parser raise.
    """
    if len(data) > LARGEST:
        raise ValueError(f"larger than {LARGEST // 2**20} MB")
    mended = ""
    try:
        notebook = json.loads(data, strict=False)
    except ValueError:
        mended = "not in UTF-8, or with NUL characters"
        notebook = json.loads(data.rstrip(b"\0").decode("latin-1"), strict=False)
    found = code_cells(notebook)
    return found, "NUL characters" if any("\0" in cell.source for cell in found) else mended


def read_submissions(folder: Path) -> list[Submission]:
    """Every notebook in a folder and in zips in it, or in one zip; the latest of each student and name.

    Raises InvalidInput if there is none.
    """
    if not folder.exists():
        raise InvalidInput(f"there is no {folder}")
    found = [_submission(place.with_suffix("").as_posix().replace("\n", " "), when, read)
             for place, when, read in sorted(_files(folder), key=lambda file: file[1])
             if place.suffix == ".ipynb"
             and not any(part.startswith((".", "/", "__MACOSX")) for part in place.parts)]
    if not found:
        raise InvalidInput(f"no notebooks in {folder}: it must hold STUDENT.ipynb, STUDENT/LESSON.ipynb, or the "
                           "zip that Canvas or Moodle gives")
    newest = {(one.student, one.number, one.name): one for one in found}
    namesakes = Counter(student for student, _ in {(one.student, one.number) for one in found})
    return [replace(one, student=f"{one.student} {one.number}".strip())
            if namesakes[one.student] > 1 else one for one in newest.values()]


def _files(folder: Path) -> Iterator[tuple[PurePath, datetime, Callable[[], Any]]]:
    """All files, those in zips too: place, time, and what opens it.

    A zip further down is a student's own, and nobody says what is in it.
    """
    for path in [folder] if folder.is_file() else sorted(folder.rglob("*")):
        if path.is_symlink() or not path.is_file():
            continue
        when = datetime.fromtimestamp(path.stat().st_mtime)
        place: PurePath = path.relative_to(folder) if path != folder else PurePath(path.name)
        if len(place.parts) == 1 and path.suffix == ".zip":
            try:
                archive = zipfile.ZipFile(path)   # open as long as somebody may read from it
            except (zipfile.BadZipFile, NotImplementedError, OSError, ValueError):
                place = place.with_suffix(".zip.ipynb")   # for its status
            else:
                for entry in archive.infolist()[:MOST]:
                    with suppress(ValueError):   # there is no month 0
                        when = datetime(*entry.date_time)
                    yield PurePosixPath(entry.filename), when, partial(archive.open, entry)
                continue
        yield place, when, partial(path.open, "rb")


def _submission(whole: str, when: datetime, read: Callable[[], Any]) -> Submission:
    """Who and what, from the names of a file and the folders it is in."""
    said = next(filter(None, (pattern.fullmatch(whole) for pattern in (_MOODLE, _CANVAS, _PLAIN)))).groupdict("")
    student, number = tidy(said["student"]), said["number"]
    if student != said["student"] and not number:   # "ada" and "=ada" are two
        number = str(zlib.crc32(whole.encode(errors="replace")))
    return Submission(student, said["name"] and tidy(_AGAIN.sub("", said["name"])), when, read,
                      bool(said["late"]), number)


def tidy(name: str) -> str:
    """A name that is a safe name of a file, and no formula in a spreadsheet.

    >>> tidy("../=ada")
    'ada'
    """
    kept = re.sub(r"[^\w .@+-]", "_", unicodedata.normalize("NFC", name))
    return kept.strip(" ._-+@")[:60].strip() or "nameless"


def read_roster(path: Path) -> list[str]:
    """Who should hand in: the first column of a CSV file, without its heading."""
    try:
        rows = list(csv.reader(path.read_text(encoding="utf-8-sig").splitlines()))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise InvalidInput(f"cannot read the roster {path}: {error}") from None
    return [tidy(row[0]) for row in rows if row and row[0].strip().lower() not in ("", "student", "name")]
