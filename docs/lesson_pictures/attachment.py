"""A lesson's title picture: kept inside its source notebook, so that it is seen wherever the notebook is."""

from __future__ import annotations

import base64
from pathlib import Path

import nbformat

SOURCES = Path(__file__).parents[2] / "lessons" / "source"
LARGEST = 60_000  # bytes: notebooks stay quick to open and to compare


def attach(lesson: str, name: str, png: bytes, cell: int = 0) -> None:
    """Put a picture into a cell of a lesson's source, the first if not told, as the attachment of that name.

    lesson : such as "07_mobile_bases"; name : as in ``![…](attachment:name)``
    """
    if len(png) > LARGEST:
        raise SystemExit(f"{name} has {len(png)} bytes, more than {LARGEST}")
    path = SOURCES / lesson / f"{lesson}.ipynb"
    notebook = nbformat.read(path, as_version=nbformat.NO_CONVERT)
    notebook.cells[cell]["attachments"] = {name: {"image/png": base64.b64encode(png).decode()}}
    text = nbformat.writes(notebook, version=nbformat.NO_CONVERT).rstrip("\n") + "\n"
    path.write_text(text, encoding="utf-8", newline="\n")
