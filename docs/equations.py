"""Tables of docs/equations.md: equation of a paper → function → lesson, from the ``Source:`` lines of docstrings.

Run: python docs/equations.py
"""

from __future__ import annotations

import ast
import json
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

from generated import write_tables

import cdprlab as cl

DOCS = Path(__file__).parent
CHECKOUT = DOCS.parent
PACKAGE = CHECKOUT / "cdprlab"

PAPERS = {
    "okoli": "Okoli 2016",
    "rasheed": "Rasheed et al. 2018",
    "pedemonte": "Pedemonte et al. 2020",
    "ramadour": "Ramadour and Merlet 2014",
}
"""Table of the page → the paper as docstrings cite it; all other papers share the table "others"."""

_CITED = re.compile(r"(?:[A-ZÀ-Ž][\w-]+(?:, | and | |-))*[A-ZÀ-Ž][\w-]+(?: et al\.| de Wit)? \d{4}")
_EQUATION = r"\(\d+(?:\.\d+)?\)"
_SECTION = r"(?:[IVX]+|\d+)(?:\.[A-Z\d]+)*"
_PLACE = re.compile(rf"{_EQUATION}(?:–{_EQUATION})?|(?:sections?|sec\.|ch\.) {_SECTION}|(?<=and ){_SECTION}|"
                    r"\(?\d+\.\d+\.\d+\)?|abstract")


class Cited(NamedTuple):
    """What a docstring says about where it comes from.

    path, name, says : file, function or class, and its first sentence
    source : after "Source:", on one line
    """

    path: str
    name: str
    says: str
    source: str


class Reference(NamedTuple):
    """One paper of one ``Source:``: the places named there, and the words where they say more than places."""

    paper: str
    places: tuple[str, ...]
    words: str


def tables() -> dict[str, str]:
    """The page's tables: a paper each, its equations in order; then all that is cited besides."""
    rows: dict[str, list[tuple[Any, str]]] = {name: [] for name in (*PAPERS, "others")}
    of_paper = {paper: name for name, paper in PAPERS.items()}
    lessons = _lesson_code()
    for here in cited():
        where = f"[`{here.name}`](../{here.path}) | {here.says}"
        taught = _taught(here.name, lessons)
        for paper, places, words in references(here.source):
            said = f"{where} *{words}*" if words else where
            if paper in of_paper:
                rows[of_paper[paper]] += [(_order(place), f"| {place} | {said} | {taught} |")
                                          for place in places or ("–",)]
            else:
                rows["others"].append((paper, f"| {paper} | {said} | {taught} |"))
    head = "| {} | function | what it is | lesson |\n|---|---|---|---|\n"
    return {name: head.format("paper" if name == "others" else "where") + "\n".join(row for _, row in sorted(found))
            for name, found in rows.items()}


def cited() -> list[Cited]:
    """Every docstring of the package with a source, file by file."""
    found = []
    for path in sorted(PACKAGE.rglob("*.py")):
        where = path.relative_to(CHECKOUT).as_posix()
        for name, text in _docstrings(ast.parse(path.read_text(encoding="utf-8"))):
            source = re.search(r"^ *Source: (.*?)(?=\n\s*\n|\Z)", text, re.MULTILINE | re.DOTALL)
            if source is not None:
                says = " ".join(text.split("\n\n")[0].split()).split(". ")[0].rstrip(".:") + "."
                found.append(Cited(where, path.stem if path.stem in cl.tension_methods() else name,
                                   says.replace("|", "\\|"), " ".join(source[1].split()).rstrip(".")))
    sources = {f"as `{here.name}`": here.source for here in found}
    return [here._replace(source=sources.get(here.source, here.source)) for here in found]


def references(source: str) -> list[Reference]:
    """The papers of a source with their places, in the order named.

    >>> [(r.paper, r.places) for r in references("Okoli 2016, eq. (2.10) and (2.15); Pott 2018, ch. 3")]
    [('Okoli 2016', ('(2.10)', '(2.15)')), ('Pott 2018', ('ch. 3',))]
    """
    found = []
    for part in source.split("; "):
        named = list(_CITED.finditer(part))
        for paper, after in zip(named, [*named[1:], None]):
            words = part[paper.end():after.start() if after else None].strip(" ,")
            rest = re.sub(rf"{_PLACE.pattern}|eq\.|and|[,. ]", "", words)
            found.append(Reference(paper[0], tuple(map(_place, _PLACE.findall(words))),
                                   words.removeprefix("'s ") if rest and after is None else ""))
    return found


def _place(text: str) -> str:
    """An equation in brackets, or a section's number with its word."""
    if text == "abstract" or re.fullmatch(rf"{_EQUATION}(?:–{_EQUATION})?", text):
        return text
    number = text.split()[-1].strip("()")
    return f"{'chapter' if text.startswith('ch.') else 'section'} {number}"


def _docstrings(tree: ast.Module) -> Iterator[tuple[str, str]]:
    """Names and docstrings of the file's functions and classes, methods under their class."""
    def walk(node: ast.AST, prefix: str) -> Iterator[tuple[str, str]]:
        for child in ast.iter_child_nodes(node):
            if isinstance(child, ast.FunctionDef | ast.ClassDef):
                yield f"{prefix}{child.name}", ast.get_docstring(child) or ""
                yield from walk(child, f"{prefix}{child.name}.")
    return walk(tree, "")


def _order(place: str) -> tuple[Any, ...]:
    """Equations by their numbers, then sections."""
    numbers = tuple(int(number) for number in re.findall(r"\d+", place.split("–")[0]))
    return not place.startswith("("), numbers, place


def _lesson_code() -> dict[str, str]:
    """Lesson → what its code cells say, solutions included."""
    found = {}
    for path in sorted((CHECKOUT / "lessons" / "source").glob("*/*.ipynb")):
        cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
        found[path.stem] = "\n".join("".join(cell["source"]) for cell in cells if cell["cell_type"] == "code")
    return found


def _taught(name: str, lessons: Mapping[str, str]) -> str:
    """The two lessons that use it most, as links."""
    used = re.compile(rf"\b{name}\(|\.{name}\b|[\"']{name}[\"']")
    counts = {lesson: len(used.findall(code)) for lesson, code in lessons.items()}
    most = sorted((lesson for lesson in counts if counts[lesson]), key=lambda lesson: -counts[lesson])[:2]
    return ", ".join(f"[{lesson[:2]}](../lessons/{lesson}.ipynb)" for lesson in sorted(most)) or "–"


if __name__ == "__main__":
    write_tables(DOCS / "equations.md", tables())
