"""The lessons in a folder of one's own, where work is never overwritten."""

import hashlib
import json
from pathlib import Path

from ..world.files import made_folder, replaced, write_text
from ..world.world import shipped

RECORD = ".handed_out.json"
"""In the folder: lesson → hash of the file as it was copied, to tell work from an old lesson."""


def lesson_files() -> list[Path]:
    """The lessons that come with cdprlab, as students get them."""
    return sorted(shipped("lessons").glob("[0-9][0-9]_*.ipynb"))


def hand_out(folder: str | Path, lessons: list[Path] | None = None) -> list[str]:
    """Copy what is missing, renew what nobody touched, leave all else; one line for each thing worth telling.

    folder : made if missing
    lessons : files; default those that come with cdprlab
    """
    folder = made_folder(folder)
    handed_out, told = _read(folder / RECORD), []
    for lesson in lesson_files() if lessons is None else lessons:
        mine, newest = folder / lesson.name, _hash(lesson)
        present = _hash(mine) if mine.exists() else None
        known = handed_out.get(lesson.name)
        if present in (None, known) and present != newest:
            with replaced(mine) as file:
                file.write(lesson.read_bytes())
            told.append(f"{mine.name}: {'new' if present is None else 'renewed; you had not changed it'}")
        elif newest not in (present, known):
            told.append(f"{mine.name}: a newer lesson exists, yours stays; rename yours to get the newer beside it")
            continue
        handed_out[lesson.name] = newest
    write_text(folder / RECORD, json.dumps(handed_out, indent=1, sort_keys=True) + "\n")
    return told


def _read(record: Path) -> dict[str, str]:
    """Empty where there is none or it was spoiled: then every file that differs counts as work."""
    try:
        return dict(json.loads(record.read_text(encoding="utf-8")))
    except (OSError, TypeError, ValueError):
        return {}


def _hash(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()
