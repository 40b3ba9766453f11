"""What an instructor hands out: lessons, package, worlds, nothing that answers an exercise. `make student-zip`."""

from __future__ import annotations

import re
import sys
import zipfile
from collections.abc import Iterator
from pathlib import Path

CHECKOUT = Path(__file__).parents[2]
FOLDER = "cdprlab"
"""Everything unpacks into this one."""

PATTERNS = (
    "README.md", "LICENSE", "NOTICE.md", "CITATION.cff", "Makefile", "pyproject.toml", "requirements.txt",
    "cdprlab/**/*", "worlds/*.yaml", "lessons/[0-9][0-9]_*.ipynb", "docs/world_file.md", "docs/install.md",
    "docs/caroca.png", "environment.yml",
)
KEPT = ("help", "run", "lab", "designer", "clean", "$(VENV)/.students")
"""Of the Makefile's targets: the others need what is not handed out."""

_LONG_AGO = (2020, 1, 1, 0, 0, 0)  # the same files make the same bytes


def members(checkout: Path = CHECKOUT) -> Iterator[Path]:
    """The files handed out, in order."""
    for pattern in PATTERNS:
        for path in sorted(checkout.glob(pattern)):
            if path.is_file() and "__pycache__" not in path.parts:
                yield path


def write(target: Path, checkout: Path = CHECKOUT) -> int:
    """Write the zip; returns how many files it holds.

    target : made with its folder, replaced if there
    """
    target.parent.mkdir(parents=True, exist_ok=True)
    files = list(members(checkout))
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for path in files:
            entry = zipfile.ZipInfo(f"{FOLDER}/{path.relative_to(checkout).as_posix()}", _LONG_AGO)
            entry.compress_type, entry.external_attr = zipfile.ZIP_DEFLATED, 0o644 << 16
            archive.writestr(entry, students_makefile(path.read_text(encoding="utf-8")) if path.name == "Makefile"
                             else path.read_bytes())
    return len(files)


def students_makefile(text: str) -> str:
    """The Makefile without targets that need what students do not get.

    text : the repository's; a rule ends at an empty line
    """
    rules, kept = text.split("\n\n"), []
    for rule in rules:
        target = re.match(r"(\$\(VENV\)/\.\w+|[a-z-]+): ", rule)
        if target is None or target.group(1) in KEPT:
            kept.append(re.sub(r"^\.PHONY:.*", ".PHONY: " + " ".join(KEPT[:-1]), rule, flags=re.MULTILINE))
    return "\n\n".join(kept).rstrip("\n") + "\n"


if __name__ == "__main__":
    place = Path(sys.argv[1]) if len(sys.argv) > 1 else CHECKOUT / "dist" / "cdprlab-students.zip"
    print(f"{place}: {write(place)} files, {place.stat().st_size / 1e6:.1f} MB")
