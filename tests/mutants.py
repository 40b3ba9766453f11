"""Mistakes planted by machine in every exercise's reference solution, and what its check says to each.

A mutant is the solution with one change: in its text (a sign, a bound, a term, an order, a branch), or in what goes in
and comes out (an argument taken from the check, the plane only, a clipped or unbalanced result, what was given changed,
the wrong shape, nothing at all). One that answers differently on the exercise's draws must fail in the *visible* check,
with a sentence of the author's.

``python tests/mutants.py [LESSON …]`` (`make mutants`) tries all of them and prints a table.
"""

from __future__ import annotations

import ast
import contextlib
import copy
import functools
import io
import os
import runpy
import sys
import tempfile
import traceback
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
import notebooks

from cdprlab.course.grading.split import Lost, at_most

DRAWS = 50
NUMBERS = (np.ndarray, float, int, np.number)
PATIENCE = 10.0  # [s] of processor time; a check that takes longer has noticed something
AUTHORS = Path(__file__).parent / "exercises"

cells = notebooks.source_tool("run_cells")
Functions = dict[str, Callable[..., Any]]


@dataclass(frozen=True)
class Mutant:
    """One changed solution: its cell's text, or what is wrapped around its functions."""

    what: str
    source: str | None = None
    wrap: Callable[[Functions], Functions] | None = None


@dataclass(frozen=True)
class Verdict:
    """What became of a mutant: "visible", "hidden" (only the hidden part noticed), "alive" or "same"."""

    mutant: str
    fate: str
    complaint: str = ""  # what is wrong with the way in which it was told


@dataclass
class Exercise:
    """An exercise in the state in which its check runs: the names of the cells before, and the reference solution."""

    lesson: str
    name: str
    solution: str
    check: str
    before: dict[str, Any]
    draw: Callable[[np.random.Generator, dict[str, Any]], Sequence[tuple[str, tuple[Any, ...]]]]
    equivalent: Mapping[str, str] = field(default_factory=dict)  # mutant → why it answers the same, or as rightly
    others: Sequence[tuple[str, str]] = ()  # what is different, and the cell: right answers written otherwise

    @functools.cached_property
    def functions(self) -> list[str]:
        """The names the answer cell defines, in order."""
        return defined(self.solution)

    def namespace(self, mutant: Mutant | None = None) -> dict[str, Any]:
        """A fresh one in which the answer is right, or a mutant's."""
        space = dict(self.before)
        source = mutant.source if mutant and mutant.source else self.solution
        cells.run_cell(source, f"<answer {self.name}>", space)
        if mutant and mutant.wrap:
            space.update(mutant.wrap({name: space[name] for name in self.functions}))
        return space

    def mutants(self) -> list[Mutant]:
        """All of them, in a fixed order."""
        return [*changed_texts(self.solution), *wrapped(self.first_calls())]

    def first_calls(self) -> dict[str, tuple[Any, ...]]:
        """The arguments with which the visible check first calls each function."""
        seen: dict[str, tuple[Any, ...]] = {}

        def recorder(name: str, function: Callable[..., Any]) -> Callable[..., Any]:
            @functools.wraps(function)
            def call(*arguments: Any, **named: Any) -> Any:
                seen.setdefault(name, copy.deepcopy(arguments))
                return function(*arguments, **named)
            return call

        space = self.namespace(Mutant("", wrap=lambda known: {n: recorder(n, f) for n, f in known.items()}))
        with silence():
            cells.run_cell(cells.visible(self.check), f"<check {self.name}>", space)
        return seen

    def verdict(self, mutant: Mutant) -> Verdict:
        """Try one mutant."""
        complaint = self.noticed(mutant, cells.visible(self.check))
        if complaint is not None:
            return Verdict(mutant.what, "visible", complaint)
        if not self._differs(mutant):
            return Verdict(mutant.what, "same")
        if self.noticed(mutant, self.check) is not None:
            return Verdict(mutant.what, "hidden")
        # Another right answer, such as rows in another order: the author says so.
        return Verdict(mutant.what, "same" if mutant.what in self.equivalent else "alive")

    def noticed(self, mutant: Mutant, check: str) -> str | None:
        """None where the check passes; else what is wrong with what it says, '' where nothing is."""
        try:
            with silence(), at_most(PATIENCE):
                cells.run_cell(check, f"<check {self.name}>", self.namespace(mutant))
        except Lost:
            return ""
        except Exception as error:
            return _complaint(error, self.name)
        return None

    def _differs(self, mutant: Mutant) -> bool:
        """Whether it answers differently on one of the author's draws."""
        right, wrong = self.namespace(), self.namespace(mutant)
        for seed in range(DRAWS):
            for name, arguments in self.draw(np.random.default_rng(seed), self.before):
                try:
                    with silence(), at_most(PATIENCE):
                        if not same(outcome(right[name], arguments), outcome(wrong[name], arguments)):
                            return True
                except Lost:
                    return True
        return False


# --- changes in the text ----------------------------------------------------------------------------------
SWAPS = [("min", "max"), ("argmin", "argmax"), ("minimum", "maximum"), ("any", "all"), ("sin", "cos"),
         ("floor", "ceil"), ("vstack", "hstack"), ("nanmin", "nanmax"), ("rfind", "find"), ("cumsum", "cumprod")]
OTHER = {**dict(SWAPS), **{b: a for a, b in SWAPS}}
TURNED: dict[type[ast.cmpop], type[ast.cmpop]] = {
    ast.Lt: ast.Gt, ast.Gt: ast.Lt, ast.LtE: ast.GtE, ast.GtE: ast.LtE, ast.Eq: ast.NotEq, ast.NotEq: ast.Eq,
    ast.In: ast.NotIn, ast.NotIn: ast.In, ast.Is: ast.IsNot, ast.IsNot: ast.Is}
STACKS = {"array", "stack", "vstack", "hstack", "concatenate", "column_stack", "block", "cross", "where", "outer"}


def changed_texts(source: str) -> Iterator[Mutant]:
    """Every change of one place in the solution's text."""
    tree = ast.parse(source)
    spots = [node for function in tree.body if isinstance(function, ast.FunctionDef)
             for statement in _without_docstring(function) for node in ast.walk(statement)]
    for spot in spots:
        for new in _changes(spot):
            # The parts of a new node are the old tree's: copying both together keeps them apart from the original.
            changed = copy.deepcopy(_replaced(tree, spot, new))
            line = getattr(spot, "lineno", 0)
            text = ast.unparse(ast.fix_missing_locations(changed))
            yield Mutant(f"line {line}: {_short(spot)} → {_short(new)}", text)


def _without_docstring(function: ast.FunctionDef) -> list[ast.stmt]:
    first = function.body[0]
    documented = isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant)
    return function.body[1:] if documented else function.body


def _changes(node: ast.AST) -> Iterator[ast.AST]:
    match node:
        case ast.BinOp(left, op, right):
            yield from _changed_operation(left, op, right)
        case ast.UnaryOp(ast.USub() | ast.Not(), operand):
            yield operand
        case ast.Compare(left, [op, *more], comparators):
            yield ast.Compare(left, [TURNED[type(op)](), *more], comparators)
        case ast.BoolOp(op, values):
            yield ast.BoolOp(ast.Or() if isinstance(op, ast.And) else ast.And(), values)
            yield from values
        case ast.If(_, body, orelse):
            for truth in (True, False):
                yield ast.If(ast.Constant(truth), body, orelse)
        case ast.IfExp(_, body, orelse):
            yield from (body, orelse)
        case ast.Raise() | ast.Continue() | ast.Break():
            yield ast.Pass()
        case ast.AugAssign(target, op, value):
            yield ast.Pass()
            if isinstance(op, ast.Add | ast.Sub):
                yield ast.AugAssign(target, ast.Sub() if isinstance(op, ast.Add) else ast.Add(), value)
        case ast.Attribute(value, "T"):
            yield value
        case ast.Call():
            yield from _changed_call(node)
        case ast.keyword("axis", ast.Constant(int(axis))):
            yield ast.keyword("axis", ast.Constant(axis - 1 if axis > 0 else axis + 1))
        case ast.Subscript(value, ast.Constant(int(index)), context):
            other = index - 1 if index > 0 else index + 1
            yield ast.Subscript(value, ast.Constant(other), context)
        case ast.Return(ast.Tuple([first, second, *more], context)):
            yield ast.Return(ast.Tuple([second, first, *more], context))
        case ast.List([first, second, *more], context):
            yield ast.List([second, first, *more], context)
        case ast.Constant(value) if isinstance(value, int | float) and not isinstance(value, bool):
            yield ast.Constant(value + 1)
        case ast.Constant(bool(value)):
            yield ast.Constant(not value)


def _changed_operation(left: ast.expr, op: ast.operator, right: ast.expr) -> Iterator[ast.expr]:
    if isinstance(op, ast.Add):
        yield from (ast.BinOp(left, ast.Sub(), right), left, right)
    elif isinstance(op, ast.Sub):
        yield from (ast.BinOp(left, ast.Add(), right), ast.BinOp(right, ast.Sub(), left), left, right)
    elif isinstance(op, ast.Mult):
        yield from (left, right)
    elif isinstance(op, ast.Div | ast.Pow | ast.FloorDiv | ast.Mod):
        yield left
    elif isinstance(op, ast.MatMult):
        yield ast.BinOp(right, ast.MatMult(), left)


def _changed_call(call: ast.Call) -> Iterator[ast.expr]:
    function = call.func
    name = function.attr if isinstance(function, ast.Attribute) else getattr(function, "id", "")
    if name in OTHER:
        other = (ast.Attribute(function.value, OTHER[name], ast.Load()) if isinstance(function, ast.Attribute)
                 else ast.Name(OTHER[name], ast.Load()))
        yield ast.Call(other, call.args, call.keywords)
    plain = bool(call.args) and not isinstance(call.args[0], ast.Starred)
    if name in {"abs", "sorted", "sqrt", "maximum", "minimum", "clip", "round"} and plain:
        yield call.args[0]
    if name in STACKS and len(call.args) >= 2:
        yield ast.Call(function, [*call.args[:-2], call.args[-1], call.args[-2]], call.keywords)
    if name in STACKS and call.args and isinstance(call.args[0], ast.Tuple) and len(call.args[0].elts) >= 2:
        first, second, *more = call.args[0].elts
        yield ast.Call(function, [ast.Tuple([second, first, *more], ast.Load()), *call.args[1:]], call.keywords)


def _replaced(tree: ast.AST, spot: ast.AST, new: ast.AST) -> ast.AST:
    """The tree with one node exchanged; other nodes are shared."""
    if tree is spot:
        return new
    changed = copy.copy(tree)
    for name, value in ast.iter_fields(tree):
        if isinstance(value, ast.AST):
            setattr(changed, name, _replaced(value, spot, new))
        elif isinstance(value, list):
            parts = [_replaced(part, spot, new) if isinstance(part, ast.AST) else part for part in value]
            setattr(changed, name, parts)
    return changed


def _short(node: ast.AST) -> str:
    text = ast.unparse(node) if not isinstance(node, ast.keyword) else f"{node.arg}={ast.unparse(node.value)}"
    line = " ".join(text.split())
    return line if len(line) <= 60 else line[:57] + "..."


def defined(source: str) -> list[str]:
    """The functions a cell defines, in order."""
    return [node.name for node in ast.parse(source).body if isinstance(node, ast.FunctionDef)]


# --- changes of what goes in and comes out ----------------------------------------------------------------
def wrapped(first_calls: Mapping[str, tuple[Any, ...]]) -> Iterator[Mutant]:
    """Every change of one function's arguments or of its result."""
    for name, arguments in first_calls.items():
        for position, known in enumerate(arguments):
            yield around(name, f"argument {position + 1} always as in the check", inward=_fixed(position, known))
            if isinstance(known, np.ndarray) and known.shape[-1:] == (3,):
                yield around(name, f"argument {position + 1} in the plane only", inward=_flat(position))
        for what, outward in RESULTS.items():
            yield around(name, what, outward=outward)
        yield around(name, "changes what it was given", afterwards=_spoil)


def around(name: str, what: str, inward: Callable[..., Any] | None = None, outward: Callable[..., Any] | None = None,
            afterwards: Callable[..., None] | None = None) -> Mutant:
    def wrap(functions: Functions) -> Functions:
        right = functions[name]

        @functools.wraps(right)
        def call(*arguments: Any, **named: Any) -> Any:
            given = inward(arguments) if inward else arguments
            returned = copy.deepcopy(right(*given, **named))
            if afterwards:
                afterwards(arguments)
            return outward(returned) if outward else returned

        return {**functions, name: call}

    return Mutant(f"{name}: {what}", wrap=wrap)


def _fixed(position: int, known: Any) -> Callable[..., Any]:
    return lambda arguments: (*arguments[:position], copy.deepcopy(known), *arguments[position + 1:])


def _flat(position: int) -> Callable[..., Any]:
    def inward(arguments: tuple[Any, ...]) -> tuple[Any, ...]:
        if position >= len(arguments):
            return arguments
        flat = np.array(arguments[position], float)
        if flat.shape[-1:] == (3,):
            flat[..., 2] = 0.0
        return (*arguments[:position], flat, *arguments[position + 1:])
    return inward


def _each_array(change: Callable[[np.ndarray], Any]) -> Callable[[Any], Any]:
    """A change of every array of numbers that is returned."""
    def outward(returned: Any) -> Any:
        if isinstance(returned, tuple):
            return tuple(outward(part) for part in returned)
        if isinstance(returned, np.ndarray) and returned.dtype.kind == "f" and returned.size:
            return change(returned)
        return returned
    return outward


def _one_off(array: np.ndarray) -> np.ndarray:
    moved = np.array(array)
    moved.ravel()[-1] += 0.01 * (1 + np.abs(moved.ravel()[-1]))
    return moved


def _spoil(arguments: tuple[Any, ...]) -> None:
    for given in arguments:
        if isinstance(given, np.ndarray) and given.dtype.kind == "f" and given.flags.writeable:
            given += 1.0


RESULTS: dict[str, Callable[[Any], Any]] = {
    "negative numbers clipped to zero": _each_array(lambda array: np.maximum(array, 0)),
    "the last number off by a percent": _each_array(_one_off),
    "in a column": _each_array(lambda array: array[..., None]),
    "one axis too many": _each_array(lambda array: array[None]),
    "returns nothing": lambda returned: None,
}


def as_lists(returned: Any) -> Any:
    """A right answer, its arrays as lists."""
    if isinstance(returned, tuple):
        return tuple(as_lists(part) for part in returned)
    return returned.tolist() if isinstance(returned, np.ndarray) else returned


def as_float32(returned: Any) -> Any:
    """A right answer, its numbers in single precision."""
    if isinstance(returned, tuple):
        return tuple(as_float32(part) for part in returned)
    floats = isinstance(returned, np.ndarray) and returned.dtype.kind == "f"
    return returned.astype(np.float32) if floats else returned


# --- judging ----------------------------------------------------------------------------------------------
@contextlib.contextmanager
def silence() -> Iterator[None]:
    """Neither output nor warnings."""
    with (contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()),
          warnings.catch_warnings()):
        warnings.simplefilter("ignore")
        yield


def outcome(function: Callable[..., Any], arguments: Sequence[Any]) -> Any:
    """What a call returns, or the type of error it raises; and what it left of its arguments."""
    given = copy.deepcopy(tuple(arguments))
    try:
        returned = function(*given)
    except Exception as error:
        returned = type(error).__name__
    return returned, [part for part in given if isinstance(part, np.ndarray)]


def same(one: Any, other: Any) -> bool:
    """Whether two answers are the same but for rounding."""
    if isinstance(one, tuple | list) and isinstance(other, tuple | list):
        return len(one) == len(other) and all(same(a, b) for a, b in zip(one, other, strict=True))
    if hasattr(one, "position") and hasattr(other, "position"):
        return same([one.position, one.rotation], [other.position, other.rotation])
    if isinstance(one, NUMBERS) and isinstance(other, NUMBERS):
        a, b = np.asarray(one), np.asarray(other)
        if a.shape != b.shape or a.dtype == bool or b.dtype == bool:
            return a.shape == b.shape and bool(np.array_equal(a, b))
        return bool(np.allclose(a, b, rtol=1e-6, atol=1e-9, equal_nan=True))
    return type(one) is type(other) and bool(np.all(one == other))


def _complaint(error: Exception, name: str) -> str:
    """What a student would not understand in the way a check failed; '' where it is the author's sentence."""
    text = str(error)
    frames = [frame.filename for frame in traceback.extract_tb(error.__traceback__)]
    if isinstance(error, AssertionError):
        if "Not equal to tolerance" in text or "Arrays are not" in text:
            return "numpy's sentence, not the author's: " + text.strip().splitlines()[0]
        return "" if text.strip() else "fails without a message"
    if f"<answer {name}>" in frames:  # the student's own code raised it
        return ""
    return f"{type(error).__name__} instead of a sentence: {text[:80]}"


# --- the lessons ------------------------------------------------------------------------------------------
def exercises(lesson: str) -> Iterator[Exercise]:
    """A lesson's exercises that have draws, each with only the cells before it run that its check needs."""
    authors = runpy.run_path(str(AUTHORS / f"{lesson}.py"))
    notebook = notebooks.read_source(lesson)
    checks = notebooks.checks(notebook)
    space: dict[str, Any] = {"__name__": "__main__", "display": lambda *shown: None}
    done: set[int] = set()
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        for answer, index in notebooks.answers(notebook).items():
            name = answer.removesuffix("-answer")
            check = checks[notebooks.check_of(answer)]
            needed = {*cells.needed_cells(notebook, check), *cells.needed_cells(notebook, index)}
            for earlier in sorted(needed - done - {index}):
                with silence():
                    cells.run_cell(notebook.cells[earlier].source, f"<cell {earlier}>", space)
                done.add(earlier)
            yield Exercise(lesson, name, notebook.cells[index].source, notebook.cells[check].source, dict(space),
                           authors["DRAWS"][name], authors.get("EQUIVALENT", {}).get(name, {}),
                           authors.get("OTHERS", {}).get(name, ()))


def lessons() -> list[str]:
    """The lessons whose exercises have draws."""
    return sorted(path.stem for path in AUTHORS.glob("[0-9][0-9]_*.py"))


def main(wanted: Sequence[str]) -> int:
    """Try all mutants of these lessons, or of all, and print what became of them."""
    os.environ.setdefault("MPLBACKEND", "Agg")
    failed = 0
    print(f"{'exercise':34}{'mutants':>8}{'visible':>9}{'hidden':>8}{'alive':>7}{'same':>6}")
    for lesson in lessons():
        if wanted and not any(word in lesson for word in wanted):
            continue
        for exercise in exercises(lesson):
            verdicts = [exercise.verdict(mutant) for mutant in exercise.mutants()]
            fates = [verdict.fate for verdict in verdicts]
            print(f"{lesson[:2]} {exercise.name:31}{len(fates):8}" + "".join(
                f"{fates.count(fate):{width}}" for fate, width in
                (("visible", 9), ("hidden", 8), ("alive", 7), ("same", 6))), flush=True)
            for line in faults(exercise, verdicts):
                failed += 1
                print("     " + line)
    return min(failed, 1)


def faults(exercise: Exercise, verdicts: Sequence[Verdict]) -> list[str]:
    """What an author has to mend. A wrapping that changes nothing on any draw does not apply, and is no mutant."""
    found = []
    for verdict in verdicts:
        if verdict.fate in ("hidden", "alive"):
            found.append(f"{verdict.fate}: {verdict.mutant}")
        elif verdict.fate == "same" and " → " in verdict.mutant and verdict.mutant not in exercise.equivalent:
            found.append(f"same on all draws, and not listed as equivalent: {verdict.mutant}")
        elif verdict.complaint:
            found.append(f"{verdict.complaint}: {verdict.mutant}")
    return found


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
