"""What a cell needs of the cells before it: statements, found by the names they bind and read.

Figures, explorers and printed lines bind nothing that a check reads, so they are never run here. A name that is changed
in place counts where the statement assigns to a part of it or calls a method of it.
"""

from __future__ import annotations

import ast
import re
import symtable
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass

NOT_PYTHON = (SyntaxError, ValueError, RecursionError, MemoryError)
"""What parsing a student's text may raise."""


@dataclass(frozen=True)
class Statement:
    """One statement at the top of a cell.

    source : its text behind as many empty lines as stand before it, so that errors name the cell's lines
    lines : first and last, counted from 1
    binds, changes : names it gives a meaning; names whose things it may change in place
    reads, later : names it looks up now; those its functions look up when they are called
    kind : the class of its syntax tree
    """

    source: str
    lines: tuple[int, int]
    binds: frozenset[str]
    changes: frozenset[str]
    reads: frozenset[str]
    later: frozenset[str]
    kind: type[ast.stmt]


def statements(source: str) -> list[Statement]:
    """A cell's statements; none where it is no Python.

    >>> [sorted(found.binds) for found in statements("a = 1\\ndef f(x): return a + x")]
    [['a'], ['f']]
    """
    try:
        return [_statement(source.splitlines(keepends=True), node)
                for node in ast.parse(source).body]
    except NOT_PYTHON:
        return []


def needed(program: Sequence[Statement], names: Iterable[str]) -> list[Statement]:
    """The statements that these names' meanings depend on, in order.

    >>> program = statements("a = 1\\nb = 2\\na = 3\\ndef f(): return b\\nprint(f())")
    >>> [found.lines[0] for found in needed(program, {"a", "f"})]
    [2, 3, 4]
    """
    modules = {name for found in program if found.kind in _IMPORTS for name in found.binds}
    later, known = set[str](), -1
    kept: list[Statement] = []
    while len(later) > known:
        wanted, known, kept = set(names), len(later), []
        for found in reversed(program):
            if (found.binds | found.changes - modules) & (wanted | later):
                kept.append(found)
                if found.kind in _SURE:
                    wanted -= found.binds
                wanted |= found.reads
                later |= found.later
    return kept[::-1]


_IMPORTS = (ast.Import, ast.ImportFrom)
_SURE = (*_IMPORTS, ast.Assign, ast.FunctionDef, ast.ClassDef)
"""What surely gives its names a new meaning: earlier ones no longer count."""


def unknown(cell: Sequence[Statement]) -> set[str]:
    """Names a cell looks up before it has bound them itself.

    >>> sorted(unknown(statements("a = b\\nc = a")))
    ['b']
    """
    names, bound = set[str](), set[str]()
    for found in cell:
        names |= (found.reads | found.later) - bound
        bound |= found.binds
    return names


def mentioned(source: str) -> set[str]:
    """Names a cell binds or looks up; every word of it where it is no Python (a magic, an unfinished line)."""
    parsed = statements(source)
    return set().union(*(found.binds | found.reads | found.later for found in parsed)) or words(source)


def _statement(lines: Sequence[str], node: ast.stmt) -> Statement:
    decorators = [part.lineno for part in getattr(node, "decorator_list", [])]
    first, last = min([node.lineno, *decorators]), node.end_lineno or node.lineno
    source = "".join(lines[first - 1:last])
    table = symtable.symtable(source, "cell", "exec")
    binds, reads, later = set[str](), set[str](), set[str]()
    for scope, symbol in _symbols(table):
        if scope is table or symbol.is_global():
            name = symbol.get_name()
            if symbol.is_referenced():
                (reads if scope is table or scope.get_name() in _COMPREHENSIONS else later).add(name)
            if symbol.is_assigned() or symbol.is_imported():
                binds.add(name)
    return Statement("\n" * (first - 1) + source, (first, last), frozenset(binds),
                     frozenset(_changed(node)), frozenset(reads), frozenset(later), type(node))


_COMPREHENSIONS = ("listcomp", "setcomp", "dictcomp", "genexpr")


def _symbols(table: symtable.SymbolTable) -> Iterator[tuple[symtable.SymbolTable, symtable.Symbol]]:
    for symbol in table.get_symbols():
        yield table, symbol
    for child in table.get_children():
        yield from _symbols(child)


def _changed(node: ast.stmt) -> Iterator[str]:
    for part in ast.walk(node):
        if isinstance(part, ast.Expr) and isinstance(part.value, ast.Call):
            place: ast.AST = part.value.func
        elif isinstance(part, ast.Attribute | ast.Subscript) and isinstance(part.ctx, ast.Store):
            place = part
        else:
            continue
        if isinstance(place, ast.Attribute | ast.Subscript):
            while isinstance(place, ast.Attribute | ast.Subscript):
                place = place.value
            if isinstance(place, ast.Name):
                yield place.id


def words(source: str) -> set[str]:
    """Every word of a text that could be a name, comments left out where it is Python."""
    with suppress(*NOT_PYTHON):
        source = ast.unparse(ast.parse(source))
    return set(re.findall(r"[^\W\d]\w*", source))
