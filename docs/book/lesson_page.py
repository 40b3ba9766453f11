"""A lesson as a page: executed with its solutions, shown without them and without the hidden checks."""

from __future__ import annotations

import hashlib
import importlib.util
import os
import tempfile
from base64 import b64decode
from pathlib import Path
from types import ModuleType
from typing import Any

import nbformat
from nbclient import NotebookClient

HERE = Path(__file__).resolve().parent
CHECKOUT = HERE.parents[1]
TIMEOUT = 600  # [s] a cell
_PROLOGUE = f"""__import__("runpy").run_path({str(HERE / "still_pictures.py")!r})["install"](get_ipython())"""
"""Leaves no name in the lesson's namespace."""

NOTE = """\
:::{{admonition}} This page and your lesson
:class: note
{{download}}`{name}.ipynb <student/{name}.ipynb>` is the lesson to work on; `make lab` brings all of them.
Its exercises are blank, as they are below. {shown}
:::"""
SHOWN = """The numbers and pictures below were made with the exercises solved, so that you see what to expect. What has
sliders in JupyterLab stands still here."""
NOT_RUN = "It was not executed for this page: there are no numbers and pictures."


def names() -> list[str]:
    """Every lesson that has a source, in order."""
    return [path.stem for path in _release().sources()]


def source(name: str) -> Path:
    """The lesson with solutions."""
    return CHECKOUT / "lessons" / "source" / name / f"{name}.ipynb"


def executed(name: str, kept: Path) -> Any:
    """The lesson with solutions and outputs; from the folder ``kept`` if nothing it depends on has changed."""
    place = kept / f"{name}-{_fingerprint(name)}.ipynb"
    if not place.exists():
        print(f"{name}: running", flush=True)
        kept.mkdir(parents=True, exist_ok=True)
        for older in kept.glob(f"{name}-*.ipynb"):
            older.unlink()
        nbformat.write(_run(name), place)
    return nbformat.read(place, as_version=4)


def page(name: str, run: Any | None, pictures: Path) -> Any:
    """The notebook that is published: a student's cells with the outputs of the solved ones.

    run : the lesson executed, None for a page without outputs
    pictures : folder for the outputs' pictures, beside the page
    """
    notebook = nbformat.reads(_release().student_copy(source(name)), as_version=4)
    cells = run.cells if run is not None else notebook.cells
    if [cell.id for cell in cells] != [cell.id for cell in notebook.cells]:
        raise ValueError(f"{name}: the student's copy has other cells than the source; the book cannot match them")
    pictures.mkdir(parents=True, exist_ok=True)
    for cell, solved in zip(notebook.cells, cells):
        if cell.cell_type == "code":
            cell.outputs = [_output(name, output, pictures / f"{name}-{solved.id}-{k}.png")
                            for k, output in enumerate(solved.outputs)]
            cell.metadata = {"tags": _tags(cell)}
        else:
            _lay_out_attachments(cell, pictures)
    note = NOTE.format(name=name, shown=SHOWN if run is not None else NOT_RUN)
    notebook.cells.insert(1, nbformat.v4.new_markdown_cell(note, id="about-this-page"))
    notebook.metadata.pop("widgets", None)
    return notebook


def _release() -> ModuleType:
    """lessons/source/release.py, which cuts out what students must not read."""
    spec = importlib.util.spec_from_file_location("release", CHECKOUT / "lessons" / "source" / "release.py")
    assert spec is not None and spec.loader is not None
    tool = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(tool)
    return tool


def _fingerprint(name: str) -> str:
    """Of all that an output depends on: lesson, package, worlds, pinned packages, and how pictures are taken."""
    parts = [source(name), HERE / "still_pictures.py", CHECKOUT / "requirements.txt",
             *sorted((CHECKOUT / "cdprlab").rglob("*.py")), *sorted((CHECKOUT / "cdprlab").rglob("*.mplstyle")),
             *sorted((CHECKOUT / "worlds").glob("*.yaml"))]
    whole = hashlib.sha256()
    for path in parts:
        whole.update(path.read_bytes())
    return whole.hexdigest()[:16]


def _run(name: str) -> Any:
    """Every cell in a fresh kernel; an error in one of them is raised."""
    notebook = nbformat.read(source(name), as_version=4)
    notebook.cells.insert(0, nbformat.v4.new_code_cell(_PROLOGUE))
    # pytest's variable would keep what libraries write to stderr out of the outputs.
    kept = {key: value for key, value in os.environ.items() if key not in ("PYTEST_CURRENT_TEST", "MPLBACKEND")}
    with tempfile.TemporaryDirectory() as folder:
        client = NotebookClient(notebook, timeout=TIMEOUT, kernel_name="python3", store_widget_state=False,
                                extra_arguments=["--log-level=ERROR"],  # each would warn that it speaks TCP
                                resources={"metadata": {"path": folder}})
        client.execute(env={**kept, "OMP_NUM_THREADS": "1", "PYTHONPATH": str(CHECKOUT), "IPYTHONDIR": folder})
    del notebook.cells[0]
    return notebook


def _tags(cell: Any) -> list[str]:
    """For the page's style: checks are folded, exercises marked."""
    grader = cell.metadata.get("nbgrader", {})
    return ["hide-input"] if grader.get("grade") else ["exercise"] if grader.get("solution") else []


def _lay_out_attachments(cell: Any, pictures: Path) -> None:
    """Sphinx wants a cell's own pictures as files."""
    for file, content in cell.pop("attachments", {}).items():
        (pictures / file).write_bytes(b64decode(content["image/png"]))
        cell.source = cell.source.replace(f"(attachment:{file})", f"({pictures.name}/{file})")


def _output(name: str, output: Any, place: Path) -> Any:
    """An output as a page can show it: text as it is, a picture as a file with its alternative text.

    place : file for the picture
    """
    data = output.get("data", {})
    if (output.output_type == "stream" and output.name == "stdout") or set(data) == {"text/plain"}:
        return output
    if set(data) != {"image/png", "text/plain"}:
        raise ValueError(f"{name} puts out {output.get('name') or ', '.join(data)}; a page shows text and pictures: "
                         "teach docs/book/still_pictures.py the new kind")
    place.write_bytes(b64decode(data["image/png"]))
    about = output.metadata.get("explorer")
    words = about["alt"] if about else data["text/plain"]
    if words.startswith("<"):
        raise ValueError(f"{name} shows a picture that says no more of itself than {words}")
    shown = f"![{_safe(words)}]({place.parent.name}/{place.name})"
    if about:
        set_to = f"\n\n*Set to* {_safe(', '.join(about['set_to']))}" if about["set_to"] else ""
        title = f"**{_safe(about['title'])}**\n\n" if about["title"] else ""
        shown = f"{title}{shown}{set_to}\n\n```text\n{data['text/plain']}\n```"
    return nbformat.v4.new_output("display_data", data={"text/markdown": shown})


def _safe(words: str) -> str:
    """Text that means itself in Markdown."""
    return "".join(f"\\{letter}" if letter in "\\`*_[]<>$|{}" else letter for letter in " ".join(words.split()))
