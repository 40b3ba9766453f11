"""Numbers in the prose of lessons: which are results, computed from the lesson's own cells, and which are given.

``tests/prose/NN_lesson.py`` names them:

RESULTS : (words of the prose, results in braces; an expression in the lesson's names; tolerance), the last where the
    prose rounds more than its digits say ("about 60 N"); a percentage is compared as printed
SETUP : code before the expressions, for what takes more than one
GIVEN : words whose numbers are inputs, or others' results
OPEN : words whose numbers are results that nothing computes yet

A number that a code cell or a world file has is given, too. What is left is named by `unaccounted`.
"""

from __future__ import annotations

import ast
import functools
import math
import re
import runpy
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import matplotlib.pyplot as plt
import notebooks
import yaml

PLACE = Path(__file__).parent / "prose"
cells = notebooks.source_tool("run_cells")

UNITS = {"mm": 1e-3, "cm": 1e-2, "km": 1e3, "ms": 1e-3, "µs": 1e-6, "µm": 1e-6, "kN": 1e3, "MN": 1e6, "mN": 1e-3,
         "g": 1e-3,
         "%": 1e-2, "°": math.pi / 180, "m": 1, "N": 1, "kg": 1, "s": 1, "W": 1, "J": 1, "Hz": 1, "rad": 1, "m/s": 1,
         "times": 1}
DIGITS = r"\d+(?:,\d{3})*(?:\.\d+)?(?:e-?\d+)?"
NUMBER = re.compile(rf"(?<![\w.,-])[-−+±]?({DIGITS})(?: ?({'|'.join(map(re.escape, UNITS))})(?![\w]))?(?![\w.]*\w)")
MARKED = re.compile(r"\{([-−+±]?\d[\d.,]*(?:e-?\d+)?)\}")
UNSPOKEN = re.compile(r"\$\$.*?\$\$|\$[^$\n]+\$|`[^`\n]*`|\]\([^)]*\)|<[^>]*>|^#.*?$|\*\*Further reading.*?\n\n"
                      r"|[Ll]essons? \d\d(?: to \d\d)?|\[\d\d\]", re.DOTALL | re.MULTILINE)


class Result(NamedTuple):
    """What the prose says, where its numbers stand in it, and how they are computed."""

    words: str
    printed: list[str]
    expression: str
    tolerance: float | None


def prose(name: str) -> str:
    """All Markdown of a lesson, in lines as short as words allow."""
    return "\n\n".join(cell.source for cell in notebooks.read_source(name).cells if cell.cell_type == "markdown")


def spoken(name: str) -> str:
    """The same without formulas, code, links and lessons' numbers."""
    return " ".join(UNSPOKEN.sub(" ", prose(name) + "\n\n").split())


def account(name: str) -> dict[str, Any]:
    path = PLACE / f"{name}.py"
    return runpy.run_path(str(path)) if path.is_file() else {}


def results(name: str) -> list[Result]:
    return _results(account(name).get("RESULTS", []))


def _results(rows: list[tuple[Any, ...]]) -> list[Result]:
    return [Result(MARKED.sub(r"\1", words), MARKED.findall(words), expression, *(tolerance or [None]))
            for words, expression, *tolerance in rows]


def value(printed: str) -> float:
    return float(printed.replace("−", "-").replace("+", "").replace("±", "").replace(",", ""))


def half_a_digit(printed: str) -> float:
    decimals = len(printed.partition(".")[2])
    return 0.5 * 10.0**-decimals


def unaccounted(name: str) -> list[str]:
    """Numbers with a unit or a point that are neither results nor given, each with the words around it."""
    known = given(name)
    return _left(spoken(name), covering(name), lambda number, size, unit: _among(size, unit, known))


def _left(text: str, covering: Iterable[str], is_known: Callable[[str, float, str], bool]) -> list[str]:
    covered = [(place.start(), place.end()) for words in covering
               for place in re.finditer(re.escape(" ".join(UNSPOKEN.sub(" ", words).split())), text)]
    left = []
    for found in NUMBER.finditer(text):
        number, unit = found[1], found[2]
        year = re.fullmatch(r"(?:19|20)\d\d", number)
        if not unit and (year or ("." not in number and len(number) < 3)):
            continue
        if any(a <= found.start(1) and found.end(1) <= b for a, b in covered) or is_known(number, value(number), unit):
            continue
        left.append(f"{text[max(0, found.start() - 60):found.start()]}»{found[0]}«{text[found.end():found.end() + 40]}")
    return left


def covering(name: str) -> Iterator[str]:
    page = account(name)
    for words in (*page.get("GIVEN", []), *page.get("OPEN", []), *(result.words for result in results(name))):
        yield " ".join(UNSPOKEN.sub(" ", words).split())


def given(name: str) -> set[float]:
    """The numbers of a lesson's code, and of the worlds it names."""
    found: set[float] = set()
    for cell in notebooks.read_source(name).cells:
        if cell.cell_type == "code":
            source = cell.source
            found |= {abs(float(node.value)) for node in ast.walk(ast.parse(source)) if isinstance(node, ast.Constant)
                      and isinstance(node.value, int | float)}
            for world, numbers in worlds().items():
                if f'"{world}"' in source:
                    found |= numbers
    return found


@functools.cache
def worlds() -> dict[str, set[float]]:
    return {path.stem: set(_numbers(yaml.safe_load(path.read_text(encoding="utf-8"))))
            for path in (notebooks.CHECKOUT / "worlds").glob("*.yaml")}


def _numbers(thing: Any) -> Iterator[float]:
    if isinstance(thing, dict | list):
        for part in thing.values() if isinstance(thing, dict) else thing:
            yield from _numbers(part)
    elif isinstance(thing, int | float):
        yield abs(float(thing))


def _among(size: float, unit: str, known: set[float]) -> bool:
    scales = {1.0, UNITS.get(unit or "m", 1)}
    return any(math.isclose(size * scale, number, rel_tol=1e-9) for scale in scales for number in known)


def needed(name: str) -> list[int]:
    """The code cells that the expressions need, checks only where they name what is used later."""
    notebook, page = notebooks.read_source(name), account(name)
    text = "\n".join([page.get("SETUP", ""), *(f"({result.expression})" for result in results(name))])
    wanted, found = cells.names(text)[1], []
    code = {index: cells.names(cells.visible(cell.source)) for index, cell in enumerate(notebook.cells)
            if cell.cell_type == "code"}
    checks = set(notebooks.checks(notebook).values())
    elsewhere = set().union(*(code[index][0] for index in set(code) - checks))
    for index in sorted(code, reverse=True):
        bound, read = code[index]
        # Of a check only what no other cell has.
        if wanted & (bound - elsewhere if index in checks else bound):
            found.append(index)
            wanted |= read
    return found[::-1]


def computed(name: str) -> dict[str, Any]:
    """The names of a lesson after its cells, and SETUP, ran."""
    notebook, space = notebooks.read_source(name), {"__name__": "__main__", "display": lambda *shown: None}
    for index in needed(name):
        cells.run_cell(cells.visible(notebook.cells[index].source), f"<{name} {notebook.cells[index].id}>", space)
        plt.close("all")
    cells.run_cell(account(name).get("SETUP", ""), f"<{name} setup>", space)
    return space


def differences(name: str, space: dict[str, Any]) -> list[str]:
    """Results that the prose does not say as they are computed."""
    return _different(" ".join(prose(name).split()), results(name), space)


def _different(text: str, expected: list[Result], space: dict[str, Any]) -> list[str]:
    wrong = []
    for result in expected:
        if result.words not in text:
            wrong.append(f"not in the prose: {result.words}")
            continue
        found = eval(f"({result.expression})", space)
        values = list(found) if isinstance(found, tuple) else [found]
        if len(values) != len(result.printed):
            wrong.append(f"{len(result.printed)} numbers, {len(values)} values: {result.words}")
            continue
        for printed, computed_value in zip(result.printed, values, strict=True):
            allowed = half_a_digit(printed) if result.tolerance is None else result.tolerance
            if not abs(value(printed) - float(computed_value)) <= allowed * (1 + 1e-9):
                wrong.append(f"{printed} is {float(computed_value):.6g}: {result.words}")
    return wrong


# --- pages ------------------------------------------------------------------------------------------------
TABLE = re.compile(r"<!-- table (.*?) -->(.*?)<!-- end -->", re.DOTALL)
PAGES: dict[str, dict[str, Any]] = runpy.run_path(str(PLACE / "pages.py"))["PAGES"]


def page_text(page: str) -> str:
    return (notebooks.CHECKOUT / "docs" / f"{page}.md").read_text(encoding="utf-8")


def tables(page: str) -> dict[str, list[float]]:
    """Table → its numbers, row by row, as its script wrote them."""
    return {name: [abs(value(number)) for number in re.findall(DIGITS, rows)]
            for name, rows in TABLE.findall(page_text(page))}


def page_differences(page: str) -> list[str]:
    """Results that the page's prose does not say as they are computed; ``tables`` are the page's."""
    space: dict[str, Any] = {"tables": tables(page)}
    exec("import numpy as np\nimport cdprlab as cl\n" + PAGES[page].get("SETUP", ""), space)
    return _different(" ".join(TABLE.sub(" ", page_text(page)).split()), _results(PAGES[page].get("RESULTS", [])),
                      space)


def page_unaccounted(page: str) -> list[str]:
    """Numbers of a page's prose that none of its tables has, rounded as they are, and that are not named."""
    text = " ".join(UNSPOKEN.sub(" ", re.sub(r"```.*?```", " ", TABLE.sub(" ", page_text(page)), flags=re.DOTALL)
                                 + "\n\n").split())
    known = [number for numbers in tables(page).values() for number in numbers]
    words = [*PAGES[page].get("GIVEN", []), *PAGES[page].get("OPEN", []),
             *(result.words for result in _results(PAGES[page].get("RESULTS", [])))]
    return _left(text, words, lambda number, size, unit: any(
        abs(entry - size) <= half_a_digit(number) * (1 + 1e-9) for entry in known))
