"""Student copies of the lessons: solutions and hidden checks cut out by nbgrader's own preprocessors.

``make lessons`` writes ``lessons/NN_topic.ipynb`` from every ``lessons/source/NN_topic/NN_topic.ipynb``.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import nbformat
from nbgrader import preprocessors
from traitlets.config import Config
from traitlets.config.loader import PyFileConfigLoader

SOURCE = Path(__file__).parent
LESSONS = SOURCE.parent

# What `nbgrader generate_assignment` runs, without the steps that need its database.
STEPS = (
    "LockCells", "ClearSolutions", "ClearOutput", "CheckCellMetadata", "ComputeChecksums", "ClearHiddenTests",
    "ClearMarkScheme", "ComputeChecksums", "CheckCellMetadata",
)


def sources() -> list[Path]:
    """The lessons with solutions, in the order of their numbers."""
    return sorted(path for path in SOURCE.glob("[0-9][0-9]_*/*.ipynb") if path.stem == path.parent.name)


def student_copy(source: Path) -> str:
    """What a student gets, as the text of a notebook file; the same text on every call.

    source : path of a lesson with solutions
    """
    notebook = nbformat.read(source, as_version=4)
    config, resources = settings(), {"nbgrader": {"notebook": source.stem}}
    for step in STEPS:
        notebook, resources = getattr(preprocessors, step)(config=config).preprocess(notebook, resources)
    return as_text(notebook)


def as_text(notebook: Any) -> str:
    """A notebook as it is kept here: one cell's line a line, characters as they are, a newline at the end."""
    return nbformat.writes(notebook, version=nbformat.NO_CONVERT).rstrip("\n") + "\n"


def settings() -> Config:
    """The course's nbgrader settings."""
    return PyFileConfigLoader("nbgrader_config.py", path=str(LESSONS)).load_config()


def main() -> int:
    """Write every student copy that changed."""
    copies = {LESSONS / path.name: student_copy(path) for path in sources()}
    for path, text in copies.items():
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8", newline="\n")
            print(f"{path.name} written")
    print(f"{len(copies)} lessons are current.")
    return 0


if __name__ == "__main__":
    sys.exit(main())
