"""What the scripts beside the pages share: tables go between markers, so that text and numbers cannot drift apart."""

from __future__ import annotations

import re
from collections.abc import Mapping
from io import BytesIO
from pathlib import Path
from typing import Any

from PIL import Image


def write_tables(page: Path, tables: Mapping[str, str]) -> None:
    """Put each table between a page's ``<!-- table name -->`` and ``<!-- end -->``; without the two it is an error."""
    text = page.read_text(encoding="utf-8")
    for name, table in tables.items():
        marked = f"<!-- table {name} -->\n\n{table.strip()}\n\n<!-- end -->"
        text, found = re.subn(f"<!-- table {re.escape(name)} -->.*?<!-- end -->", lambda _, m=marked: m, text,
                              flags=re.DOTALL)
        if found != 1:
            raise SystemExit(f"{page.name} needs one '<!-- table {name} -->' … '<!-- end -->', it has {found}")
    page.write_text(text, encoding="utf-8", newline="\n")


def save_small(figure: Any, path: Path) -> None:
    """A palette PNG, a third of the size."""
    path.parent.mkdir(exist_ok=True)
    drawn = BytesIO()
    figure.savefig(drawn, dpi=100, format="png")
    Image.open(drawn).convert("RGB").quantize(64).save(path, "png", optimize=True)
