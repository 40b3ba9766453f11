"""What a cell needs of the cells before it: statements, found by the names they bind and read.

Figures, explorers and printed lines bind nothing that a check reads, so they are never run here. A name that is changed
in place counts where the statement assigns to a part of it or calls a method of it.
"""

import ast
import re
import symtable
from collections.abc import Collection, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cache

LONGEST = 200_000
"""Characters of a cell that are looked into."""

_IMPORTS = (ast.Import, ast.ImportFrom)
_SURE = (*_IMPORTS, ast.Assign, ast.FunctionDef, ast.ClassDef)
"""What surely gives its names a new meaning: earlier ones no longer count."""
_AT_ONCE = ("top", "listcomp", "setcomp", "dictcomp", "genexpr")


@dataclass(frozen=True, eq=False)
class Statement:
    """One statement at the top of a cell.

    source, line : its text; its first line, counted from 1
    binds, changes : names it gives a meaning; names whose things it may change in place
    reads, later : names it looks up now; those its functions look up when they are called
    kind : the class of its syntax tree
    """

    source: str
    line: int
    binds: set[str]
    changes: set[str]
    reads: set[str]
    later: set[str]
    kind: type[ast.stmt]


@cache
def statements(source: str) -> list[Statement]:
    """A cell's statements, without magics; none where it is no Python, or too long.

    >>> [sorted(found.binds) for found in statements("a = 1\\ndef f(x): return a + x")]
    [['a'], ['f']]
    """
    with suppress(SyntaxError, ValueError, RecursionError, MemoryError):
        plain = re.sub(r"^[%!].*", "", source[:LONGEST + 1], flags=re.MULTILINE)
        if len(plain) <= LONGEST:
            return [_statement(plain.splitlines(keepends=True), node) for node in ast.parse(plain).body]
    return []


def needed(program: Sequence[Statement], names: Collection[str] = (),
           ends: Sequence[Statement] = ()) -> list[Statement]:
    """The statements that the meanings of names, and those that some last ones read, depend on, in order.

    >>> program = statements("a = 1\\nb = 2\\na = 3\\ndef f(): return b\\nprint(f())")
    >>> [found.line for found in needed(program, {"a", "f"})]
    [2, 3, 4]
    """
    modules = {name for found in program if found.kind in _IMPORTS for name in found.binds}
    later, known = set[str](), -1
    kept: list[Statement] = []
    while len(later) > known:
        wanted, known, kept = set(names), len(later), []
        for index, found in enumerate([*reversed(ends), *reversed(program)]):
            if index < len(ends) or (found.binds | found.changes - modules) & (wanted | later):
                kept.append(found)
                if found.kind in _SURE:
                    wanted -= found.binds
                wanted |= found.reads
                later |= found.later
    return kept[len(ends):][::-1]


def _statement(lines: Sequence[str], node: ast.stmt) -> Statement:
    first = min([node.lineno, *(part.lineno for part in getattr(node, "decorator_list", []))])
    source = "".join(lines[first - 1:node.end_lineno])
    table = symtable.symtable(source, "cell", "exec")
    binds, reads, later = set[str](), set[str](), set[str]()
    for scope, symbol in _symbols(table):
        if scope is table or symbol.is_global():
            if symbol.is_referenced():
                (reads if scope.get_name() in _AT_ONCE else later).add(symbol.get_name())
            if symbol.is_assigned() or symbol.is_imported():
                binds.add(symbol.get_name())
    return Statement(source, first, binds, set(_changed(node)), reads, later, type(node))


def _symbols(table: symtable.SymbolTable) -> Iterator[tuple[symtable.SymbolTable, symtable.Symbol]]:
    for symbol in table.get_symbols():
        yield table, symbol
    for child in table.get_children():
        yield from _symbols(child)


def _changed(node: ast.stmt) -> Iterator[str]:
    """Names of what a statement calls a method of, or assigns to a part of."""
    for part in ast.walk(node):
        match part:
            case (ast.Expr(value=ast.Call(func=ast.Attribute(value=place)))
                  | ast.Attribute(value=place, ctx=ast.Store()) | ast.Subscript(value=place, ctx=ast.Store())):
                while isinstance(place, ast.Attribute | ast.Subscript):
                    place = place.value
                if isinstance(place, ast.Name):
                    yield place.id
