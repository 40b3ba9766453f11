"""The house rules of docs/house.md: every file in a room, imports down the rooms only, no name twice or borrowed.

And that who reads from a public call to where the work is done has few calls to follow.
"""

import ast
import json
import re
import sys
from collections.abc import Callable, Iterator
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path
from types import FrameType
from typing import Any

import pytest

import cdprlab
import cdprlab as cl

PACKAGE = Path(cdprlab.__file__).parent
ROOMS = (
    "errors", "arrays", "robot", "compiled", "mechanics", "world", "tensions", "sets",
    "configurations", "workspace", "simulate", "run", "view", "fastkit", "course", "cli",
    "__main__",
)
"""From the ground up: a room imports from those before it."""

FILES = sorted(path for path in PACKAGE.rglob("*.py") if path != PACKAGE / "__init__.py")
MODULES = {path: path.relative_to(PACKAGE).with_suffix("").parts for path in FILES}
"""File → its place in the house: ("sets", "polytope"), ("sets", "__init__")."""


def test_every_file_has_its_room():
    assert {place[0] for place in MODULES.values()} == set(ROOMS)


def test_the_page_about_the_house_names_every_room_in_order():
    text = (PACKAGE.parent / "docs" / "house.md").read_text(encoding="utf-8")
    rows = [line.split("|")[1].strip(" `") for line in text.splitlines() if line.startswith("| `")]
    assert rows == list(ROOMS)


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.relative_to(PACKAGE).as_posix())
def test_imports_go_down_the_rooms_only(path: Path):
    """Also those inside functions and those for the type checker."""
    here = ROOMS.index(MODULES[path][0])
    for there in imported_files(path):
        assert ROOMS.index(MODULES[there][0]) <= here, f"{path.name} imports {there.relative_to(PACKAGE)}"


def test_no_circle_inside_a_room():
    """A package's own ``__init__`` hands on what its files export; no file of the package may ask it."""
    graph = TopologicalSorter({path: set(imported_files(path)) - {path} for path in FILES})
    graph.prepare()   # raises CycleError naming the files


def test_no_two_modules_of_one_name():
    names = [place[-1] for place in MODULES.values() if place[-1] not in ("__init__", "__main__")]
    assert sorted(names) == sorted(set(names))


def test_no_two_public_classes_of_one_name():
    names = [node.name for path in FILES for node in tree(path).body
             if isinstance(node, ast.ClassDef) and not node.name.startswith("_")]
    assert sorted(names) == sorted(set(names))


@pytest.mark.parametrize("folder", [PACKAGE, PACKAGE.parent / "tests", PACKAGE.parent / "docs"],
                         ids=lambda folder: folder.name)
def test_no_private_name_crosses_a_file(folder: Path):
    taken = [f"{path.relative_to(folder)}: {alias.name}" for path in folder.rglob("*.py")
             for node, module in cdprlab_imports(path) if module is not None
             for alias in node.names if alias.name.startswith("_") and not alias.name.startswith("__")]
    assert taken == []


@pytest.mark.parametrize(("package", "allowed"), [
    ("pybullet", {"simulate/bullet.py"}),
    ("pybullet_data", set()),
    ("pymunk", {"simulate/planar.py"}),
    ("numba", {"compiled/jit.py"}),
    ("codac", set()),
])
def test_what_is_imported_in_its_own_file_only(package: str, allowed: set[str]):
    importing = {path.relative_to(PACKAGE).as_posix() for path in FILES for node in ast.walk(tree(path))
                 if package in {name.split(".")[0] for name in foreign(node)}}
    assert importing <= allowed


def test_no_private_part_of_an_engine_is_used():
    private = re.compile(r"_chipmunk_cffi|pymunk\._|pybullet\._")
    assert [path.name for path in FILES if private.search(path.read_text(encoding="utf-8"))] == []


def test_what_is_public_is_documented():
    undocumented = [name for name in cdprlab.__all__ if not (getattr(cdprlab, name).__doc__ or "").strip()]
    assert undocumented == []


def test_public_names_are_unique():
    assert len(set(cdprlab.__all__)) == len(cdprlab.__all__)


# --- lessons come in by the doors ---------------------------------------------------------------
NOTEBOOKS = sorted((PACKAGE.parent / "lessons").rglob("*.ipynb"))
DOORS = {"cdprlab", "cdprlab.course", "cdprlab.fastkit"}
"""What a lesson may import of this package; what is behind them is nobody's business."""


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.relative_to(PACKAGE.parent).as_posix())
def test_lessons_use_the_doors(path: Path):
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    code = "\n".join("".join(cell["source"]) for cell in cells if cell["cell_type"] == "code")
    taken = re.findall(r"^\s*(?:from|import) (cdprlab[\w.]*)", code, re.MULTILINE)
    assert taken and set(taken) <= DOORS


# --- hops ---------------------------------------------------------------------------------------
def way_to(end: str, start: Callable[[], Any]) -> list[str]:
    """Files of the package that stand between a call and a function of that name, a call each."""
    ways: list[list[str]] = []

    def look(frame: FrameType, event: str, _: Any) -> None:
        if event != "call" or frame.f_code.co_name != end or ways:
            return
        way, caller = [], frame.f_back
        while caller is not None:
            if Path(caller.f_code.co_filename).is_relative_to(PACKAGE):
                way.append(caller.f_code.co_filename)
            caller = caller.f_back
        ways.append(way)

    start()   # what is imported or compiled at first use is no part of the way
    sys.setprofile(look)
    try:
        start()
    finally:
        sys.setprofile(None)
    return ways[0]


def test_from_run_to_the_engine_s_step():
    world = cl.load_world("caroca")
    with cl.open_simulator(world) as simulator:
        way = way_to("step", lambda: cl.run(world, duration=0.01, simulator=simulator))
        assert len(way) + 1 <= 4 and len(set(way)) <= 3   # the command's step, and then the engine's


def test_from_distribute_tensions_to_the_program(monkeypatch: pytest.MonkeyPatch):
    import quadprog

    solve = quadprog.solve_qp

    def solve_qp(*arguments: Any) -> Any:
        return solve(*arguments)

    monkeypatch.setattr(quadprog, "solve_qp", solve_qp)
    world = cl.load_world("caroca")
    W, w_e = cl.wrench_matrix(world.robot, world.pose), cl.gravity_wrench(world.robot, world.pose)
    assert len(way_to("solve_qp", lambda: cl.distribute_tensions(W, w_e, 300.0, 1e4))) <= 3


def test_from_an_available_wrench_set_to_its_facets():
    world = cl.load_world("caroca")
    assert len(way_to("hyperplane_shifting",
                      lambda: cl.available_wrench_set(world.robot, world.pose).normals)) <= 4


# --- reading the package --------------------------------------------------------------------------
@cache
def tree(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


def foreign(node: ast.AST) -> list[str]:
    """Modules of other packages that a node imports."""
    if isinstance(node, ast.Import):
        return [alias.name for alias in node.names]
    if isinstance(node, ast.ImportFrom) and node.module and not node.level:
        return [node.module]
    return []


def cdprlab_imports(path: Path) -> Iterator[tuple[ast.ImportFrom, tuple[str, ...] | None]]:
    """Every ``from … import`` of this package, with the place it names in the house; None for other packages."""
    for node in ast.walk(tree(path)):
        if not isinstance(node, ast.ImportFrom):
            continue
        module = tuple((node.module or "").split(".")) if node.module else ()
        if node.level and PACKAGE in path.parents:
            folder = path.relative_to(PACKAGE).parent.parts
            yield node, folder[:len(folder) - node.level + 1] + module
        elif not node.level and module[:1] == ("cdprlab",):
            yield node, module[1:]
        else:
            yield node, None


def imported_files(path: Path) -> list[Path]:
    """Files of the house that a file imports, wherever the import stands."""
    at = {place: file for file, place in MODULES.items()}
    found = []
    for node, module in cdprlab_imports(path):
        if module is None:
            continue
        for alias in node.names:
            for place in ((*module, alias.name), (*module, alias.name, "__init__"), module, (*module, "__init__")):
                if place in at:
                    found.append(at[place])
                    break
    return found
