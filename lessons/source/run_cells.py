"""A lesson's code cells in this process, one after another: for recording results and for trying answers quickly."""

from __future__ import annotations

import ast
import linecache
from collections.abc import Iterable
from typing import Any

HIDDEN = ("### BEGIN HIDDEN TESTS", "### END HIDDEN TESTS")


def run_cell(source: str, name: str, namespace: dict[str, Any]) -> None:
    """Execute one cell; its lines show in tracebacks under ``name``."""
    linecache.cache[name] = (len(source), None, source.splitlines(keepends=True), name)
    exec(compile(source, name, "exec"), namespace)


def visible(source: str) -> str:
    """A check as a student's copy has it, without its hidden part."""
    if HIDDEN[0] not in source:
        return source
    before, rest = source.split(HIDDEN[0], 1)
    return before + rest.split(HIDDEN[1], 1)[1]


def needed_cells(notebook: Any, index: int) -> list[int]:
    """The code cells before ``index`` that bind, directly or not, a name which cell ``index`` reads."""
    wanted = names(notebook.cells[index].source)[1]
    needed = []
    for earlier in range(index - 1, -1, -1):
        cell = notebook.cells[earlier]
        if cell.cell_type != "code":
            continue
        bound, read = names(cell.source)
        if bound & wanted:
            needed.append(earlier)
            wanted |= read
    return needed[::-1]


def names(source: str) -> tuple[set[str], set[str]]:
    """The names a cell binds at its top level, and all names it reads."""
    tree = ast.parse(source)
    read = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load)}
    return set(_bound(tree.body)), read


def _bound(body: Iterable[ast.stmt]) -> Iterable[str]:
    for statement in body:
        if isinstance(statement, ast.FunctionDef | ast.ClassDef):
            yield statement.name
            continue
        for node in ast.walk(statement):
            if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
                yield node.id
            if isinstance(node, ast.alias):
                yield (node.asname or node.name).split(".")[0]
            if isinstance(node, ast.FunctionDef):
                yield node.name
