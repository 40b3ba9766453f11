"""A folder of one's own to work in: copies the lessons there and never overwrites work.

python lessons/my_lessons.py my_lessons
"""

from __future__ import annotations

import hashlib
import json
import sys
from pathlib import Path

LESSONS = Path(__file__).parent
RECORD = ".handed_out.json"
"""In the folder: lesson → hash of the file as it was copied, to tell work from an old lesson."""


def hand_out(folder: Path, lessons: Path = LESSONS) -> list[str]:
    """Copy what is missing, renew what nobody touched, leave all else; one line for each thing worth telling.

    folder : made if missing
    lessons : where the lessons come from
    """
    folder.mkdir(parents=True, exist_ok=True)
    handed_out, told = _read(folder / RECORD), []
    for lesson in sorted(lessons.glob("[0-9][0-9]_*.ipynb")):
        mine, newest = folder / lesson.name, _hash(lesson)
        present = _hash(mine) if mine.exists() else None
        if present is None or present == handed_out.get(lesson.name) != newest:
            mine.write_bytes(lesson.read_bytes())
            told.append(f"{mine.name}: {'new' if present is None else 'renewed; you had not changed it'}")
        elif present != newest and handed_out.get(lesson.name) != newest:
            told.append(f"{mine.name}: a newer lesson exists, yours stays; rename yours to get the newer beside it")
            continue
        handed_out[lesson.name] = newest
    (folder / RECORD).write_text(json.dumps(handed_out, indent=1, sort_keys=True) + "\n", encoding="utf-8")
    return told


def _read(record: Path) -> dict[str, str]:
    """Empty where there is none or it was spoiled: then every file that differs counts as work."""
    try:
        known = json.loads(record.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return known if isinstance(known, dict) else {}


def _hash(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


if __name__ == "__main__":
    for line in hand_out(Path(sys.argv[1] if len(sys.argv) > 1 else "my_lessons")):
        print(line)
