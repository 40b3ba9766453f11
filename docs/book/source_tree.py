"""The folder that Sphinx reads: this checkout's pages where they are in it, so that their links hold as they stand."""

from __future__ import annotations

import re
import shutil
import tomllib
from pathlib import Path
from string import Template

import api_pages
import jupyter_server_mathjax
import lesson_page
import nbformat

HERE = Path(__file__).resolve().parent
CHECKOUT = HERE.parents[1]
FILES = ("README.md", "NOTICE.md", "LICENSE", "CITATION.cff", "Dockerfile", "requirements.txt", ".binder/*",
         "cdprlab/**/*.py", "docs/*.md", "docs/**/*.png", "worlds/*.yaml")
NOT_NEEDED = ("a11y", "localization", "SVG", "MathML", "*.py", "__pycache__")
"""Of MathJax: other outputs than the one used, other languages, speech rules."""


def assemble(tree: Path, executed: Path, run: str) -> Path:
    """Lay everything out anew; returns the folder.

    executed : folder that keeps executed lessons
    run : the lessons that are executed: "all", "none", or the name of one
    """
    homeless = api_pages.homeless()
    if homeless:
        raise SystemExit(f"public, but in no room that the book knows: {', '.join(homeless)}; "
                         "add the room to GROUPS in docs/book/api_pages.py")
    shutil.rmtree(tree, ignore_errors=True)
    for path in (path for pattern in FILES for path in sorted(CHECKOUT.glob(pattern)) if path.is_file()):
        _copy(path, tree / path.relative_to(CHECKOUT))
    _front_page(tree / "README.md")
    _lessons(tree / "lessons", executed, run)
    api_pages.write(tree / "api")
    _written_pages(tree)
    return tree


def math(site: Path) -> None:
    """MathJax into the site, from a package: pages must show formulas without a network."""
    shutil.copytree(Path(jupyter_server_mathjax.__file__).parent / "static", site / "_static" / "mathjax",
                    ignore=shutil.ignore_patterns(*NOT_NEEDED), dirs_exist_ok=True)


def _front_page(readme: Path) -> None:
    """Its links lead to the repository, for who reads it elsewhere; here to this site's pages, without badges."""
    home = tomllib.loads((CHECKOUT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["urls"]["Homepage"]
    lines = [line for line in readme.read_text(encoding="utf-8").splitlines() if not line.startswith("[![")]
    text = re.sub(rf"{re.escape(home)}/(blob|raw)/main/", "", "\n".join(lines))
    readme.write_text(f"{text}\n", encoding="utf-8")


def _lessons(folder: Path, executed: Path, run: str) -> None:
    for name in lesson_page.names():
        _copy(CHECKOUT / "lessons" / f"{name}.ipynb", folder / "student" / f"{name}.ipynb")
        solved = lesson_page.executed(name, executed) if run in ("all", name) else None
        nbformat.write(lesson_page.page(name, solved, folder / "pictures"), folder / f"{name}.ipynb")


def _written_pages(tree: Path) -> None:
    """Those of docs/book/pages/; they name what there is."""
    made = {path.stem for path in (CHECKOUT / "docs").glob("*.py")}  # with a script beside it
    docs = sorted(path.stem for path in (CHECKOUT / "docs").glob("*.md"))
    worlds = sorted(path.stem for path in (CHECKOUT / "worlds").glob("*.yaml"))
    lists = {
        "lessons": "\n".join(f"lessons/{name}" for name in lesson_page.names()),
        "reports": "\n".join(f"docs/{name}" for name in docs if name in made),
        "reference": "\n".join(f"docs/{name}" for name in docs if name not in made),
        "world_files": "\n".join(f"## {name}\n\n```{{literalinclude}} worlds/{name}.yaml\n:language: yaml\n```\n"
                                 for name in worlds),
    }
    for page in sorted((HERE / "pages").glob("*.md")):
        text = Template(page.read_text(encoding="utf-8")).substitute(lists)
        (tree / page.name).write_text(text, encoding="utf-8")


def _copy(path: Path, target: Path) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(path, target)
