"""How long a student waits for a lesson's first picture, beside a bare kernel with the same imports."""

import ast
import statistics
import time

import nbformat
import notebooks
import pytest


def _first_picture(notebook) -> int:
    """Index of the first code cell that draws: its outputs hold a picture or a widget."""
    for index, cell in enumerate(notebook.cells):
        for output in cell.get("outputs", []):
            if {"image/png", "application/vnd.jupyter.widget-view+json"} & set(output.get("data", {})):
                return index
    raise AssertionError("the lesson draws nothing")


def _imports(notebook) -> str:
    """The import statements of the setup cell."""
    setup = ast.parse(next(cell.source for cell in notebook.cells if cell.cell_type == "code"))
    return "\n".join(ast.unparse(node) for node in setup.body if isinstance(node, ast.Import | ast.ImportFrom))


def _seconds(notebook, cells, folder) -> float:
    """From the kernel's start until these cells have run."""
    began = time.perf_counter()
    with notebooks.kernel(notebook, folder) as client:
        for index, cell in enumerate(cells):
            client.execute_cell(cell, index)
        return time.perf_counter() - began


@pytest.mark.parametrize("name", notebooks.names())
def test_first_picture(benchmark, report, name, tmp_path):
    """Cells up to the first picture, as fast as Shift+Enter can be pressed."""
    notebook = notebooks.read_source(name)
    with notebooks.kernel(notebook, tmp_path) as client:
        notebooks.execute(client)
    cells = [cell for cell in notebook.cells[:_first_picture(notebook) + 1] if cell.cell_type == "code"]
    bare = [nbformat.v4.new_code_cell(_imports(notebook))]
    ratios = []
    for _ in range(3):
        reference = _seconds(notebook, bare, tmp_path)
        ratios.append(_seconds(notebook, cells, tmp_path) / reference)
    report(f"{name}: first picture / bare kernel", statistics.median(ratios), 3)
    benchmark.pedantic(lambda: _seconds(notebook, cells, tmp_path), rounds=1)
