"""What docstrings, lessons, worlds and pages cite stands in docs/references.md; and nothing stands there uncited."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import notebooks

CHECKOUT = Path(__file__).parents[1]
LIST = (CHECKOUT / "docs" / "references.md").read_text(encoding="utf-8")
NAME = r"(?:Canudas de )?[A-ZÀ-ŽÅ][A-Za-zÀ-ž’-]+"
CITED = re.compile(rf"(?<![\w.])(?!Hall\b)({NAME}(?:(?:, {NAME})*,? and (?:{NAME}|others)| et al\.)?)"
                   r",? \(?((?:19|20)\d\d)\b")
ENTRY = re.compile(r"^- \*\*(.*?)[ :](\d{4})(?: \(\w+\))?\.\*\* .*?\*([^*]{8,})\*.*\2", re.MULTILINE)
PLACES = {"Springer", "Press", "SIAM", "Prentice", "ICRA", "CableCon", "Delft", "Duisburg-Essen", "Automation",
          "Systems", "ROS", "Gazebo", "Kinematics"}
"""Words before a year in full references, which are looked for by their titles."""

FURTHER = "**Further reading"


def texts() -> Iterator[tuple[str, str]]:
    """File → its text in one line, marks of comments and emphasis taken out."""
    pages = [page for page in (CHECKOUT / "docs").glob("*.md") if page.name != "references.md"]
    for path in [*(CHECKOUT / "cdprlab").rglob("*.py"), *(CHECKOUT / "worlds").glob("*.yaml"), *pages]:
        yield path.name, " ".join(re.sub(r"[#*`]", " ", path.read_text(encoding="utf-8")).split())
    for name in notebooks.names():
        for cell in notebooks.read_source(name).cells:
            for words in cell.source.partition(FURTHER)[::2]:
                yield name, " ".join(re.sub(r"[#*`]", " ", words).split())


def authors(words: str) -> list[str]:
    return [name for name in re.split(r", and |, | and ", re.sub(r" et al\.$| and others$", "", words)) if name]


def titles() -> set[str]:
    """In italics, under the lessons' further reading."""
    found: set[str] = set()
    for name in notebooks.names():
        for cell in notebooks.read_source(name).cells:
            reading = cell.source.partition(FURTHER)[2].lstrip("*: \n").split("\n\n")[0]
            found |= set(re.findall(r"(?<!\*)\*([A-Z][^*]{8,})\*(?!\*)", " ".join(reading.split())))
    return found


ENTRIES = [(authors(key), year, title) for key, year, title in ENTRY.findall(LIST)]


def test_every_entry_has_names_a_title_and_the_year_it_is_cited_by():
    assert len(ENTRIES) == LIST.count("\n- ") and len({title for _, _, title in ENTRIES}) == len(ENTRIES)


def test_every_citation_is_in_the_list_and_every_entry_is_cited():
    lost, cited = set(), titles()
    for where, text in texts():
        for words, year in CITED.findall(text):
            names = authors(words)
            if names[-1] in PLACES:
                continue
            found = {title for of, when, title in ENTRIES if when == year and of[:len(names)] == names}
            cited |= found
            if not found:
                lost.add(f"{where}: {words} {year}")
    assert sorted(lost) == []
    assert [title for _, _, title in ENTRIES if title not in cited] == []


def test_every_title_of_further_reading_is_in_the_list():
    assert titles() - {title for _, _, title in ENTRIES} == set()
