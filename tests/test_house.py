"""The house rules of docs and design: who may import whom, and that what is public is documented."""

import ast
import json
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

import cdprlab

PACKAGE = Path(cdprlab.__file__).parent
ROOMS = (
    "errors", "arrays", "robot", "compiled", "mechanics", "world", "tensions", "sets", "configurations", "workspace",
    "simulate", "run", "view", "fastkit", "course", "cli", "__main__",
)
"""From the ground up: a room imports from those before it."""
UPWARDS = {
    ("mechanics", "simulate"): "until one computed torque is left",
}
"""Imports against the order that are still there; they must be inside a function, where they close no circle."""

FILES = sorted(path for path in PACKAGE.rglob("*.py") if path != PACKAGE / "__init__.py")


def test_every_file_has_its_room():
    assert {_room(path) for path in FILES} <= set(ROOMS)


def test_the_page_about_the_house_names_every_room_in_order():
    text = (PACKAGE.parent / "docs" / "house.md").read_text(encoding="utf-8")
    named = [line.split("|")[1].strip(" `") for line in text.splitlines() if line.startswith("| `")]
    assert named == [room for room in ROOMS if room in named]
    assert set(named) == {path.relative_to(PACKAGE).parts[0].removesuffix(".py") for path in FILES}


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.relative_to(PACKAGE).as_posix())
def test_imports_go_down_the_list_only(path: Path):
    here = _room(path)
    for node, _ in _imports(path):
        for there in _rooms_of(path, node):
            if there == here or ROOMS.index(there) < ROOMS.index(here):
                continue
            assert (here, there) in UPWARDS, f"{path.name}:{node.lineno}: {here} imports {there}, which comes later"
            pass


@pytest.mark.parametrize(("package", "allowed"), [
    ("pybullet", {"simulate/bullet.py"}),
    ("pybullet_data", set()),
    ("pymunk", {"simulate/planar.py"}),
])
def test_engines_are_imported_in_their_own_files_only(package: str, allowed: set[str]):
    importing = {path.relative_to(PACKAGE).as_posix() for path in FILES for node, _ in _imports(path)
                 if package in {name.split(".")[0] for name in _absolute(node)}}
    assert importing <= allowed


def test_what_is_public_is_documented():
    undocumented = [name for name in cdprlab.__all__ if not (getattr(cdprlab, name).__doc__ or "").strip()]
    assert undocumented == []


def test_public_names_are_unique():
    assert len(set(cdprlab.__all__)) == len(cdprlab.__all__)


def _floor(room: str) -> int:
    return ROOMS.index(room)


def _room(path: Path) -> str:
    name = path.relative_to(PACKAGE).parts[0].removesuffix(".py")
    return name


def _imports(path: Path) -> Iterator[tuple[ast.Import | ast.ImportFrom, bool]]:
    """Every import that runs, and whether it waits inside a function or for the type checker."""
    def walk(node: ast.AST, inside: bool) -> Iterator[tuple[ast.Import | ast.ImportFrom, bool]]:
        if isinstance(node, ast.Import | ast.ImportFrom):
            yield node, inside
        lazy = isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) or (
            isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING")
        for child in ast.iter_child_nodes(node):
            yield from walk(child, inside or lazy)
    yield from walk(ast.parse(path.read_text(encoding="utf-8")), False)


def _absolute(node: ast.Import | ast.ImportFrom) -> list[str]:
    """Modules of other packages that an import names."""
    if isinstance(node, ast.Import):
        return [alias.name for alias in node.names]
    return [node.module] if node.module and not node.level else []


def _rooms_of(path: Path, node: ast.Import | ast.ImportFrom) -> list[str]:
    """Rooms of this house that an import enters."""
    if isinstance(node, ast.ImportFrom) and node.level:
        parts = path.relative_to(PACKAGE).parent.parts
        base = parts[:len(parts) - node.level + 1] + tuple((node.module or "").split(".") if node.module else ())
        names = [base[0]] if base else [alias.name for alias in node.names if alias.name != "__version__"]
    else:
        names = [name.split(".")[1] for name in _absolute(node) if name.startswith("cdprlab.")]
    return names


NOTEBOOKS = sorted((PACKAGE.parent / "lessons").rglob("*.ipynb"))
DOORS = {"cdprlab", "cdprlab.course", "cdprlab.fastkit"}
"""What a lesson may import of this package; what is behind them is nobody's business."""


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.relative_to(PACKAGE.parent).as_posix())
def test_lessons_use_the_doors(path: Path):
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    code = "\n".join("".join(cell["source"]) for cell in cells if cell["cell_type"] == "code")
    taken = re.findall(r"^\s*(?:from|import) (cdprlab[\w.]*)", code, re.MULTILINE)
    assert taken and set(taken) <= DOORS
