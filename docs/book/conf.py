"""Sphinx's settings for the book; `docs/book/build.py` lays the pages out and calls Sphinx."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parent))

import api_pages
import docstrings

import cdprlab

project, author = "cdprlab", "The cdprlab authors"
copyright = "the cdprlab authors, MIT license"
release = cdprlab.__version__

extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.mathjax"]
exclude_patterns = ["README.md", "lessons/student/*"]

# --- Markdown and notebooks: executed before (lesson_page.py), so that solutions can be left out
nb_execution_mode = "off"
nb_code_prompt_show, nb_code_prompt_hide = "Show the check", "Hide the check"
nb_merge_streams = True
myst_enable_extensions = ["dollarmath", "colon_fence"]
myst_heading_anchors = 3
myst_update_mathjax = False  # it would write settings of MathJax 3

# --- docstrings: shapes and units are in their text, types would say less
autodoc_typehints = "none"
autodoc_member_order = "bysource"
autodoc_default_options = {"members": True}

# --- pages that load nothing from elsewhere
html_theme = "furo"
html_title, html_favicon = "cdprlab", "static/icon.svg"
html_static_path = ["static"]
html_css_files = ["book.css"]
html_copy_source = False
html_show_sphinx = False
pygments_style, pygments_dark_style = "friendly", "monokai"
mathjax_path = "mathjax/MathJax.js"
mathjax2_config = {
    "config": ["TeX-AMS-MML_HTMLorMML-full.js"],
    "messageStyle": "none",
    "tex2jax": {"inlineMath": [["\\(", "\\)"]], "displayMath": [["\\[", "\\]"]], "processClass": "math|output_area",
                "ignoreClass": "document"},
    "HTML-CSS": {"availableFonts": [], "webFont": "STIX-Web", "imageFont": None},
}


def setup(app: Any) -> None:
    """Docstrings in the house form; fields without words of their own are described by their class."""
    app.connect("autodoc-process-docstring", _in_house_form)
    app.connect("autodoc-skip-member", _without_words)


def _in_house_form(app: Any, what: str, name: str, thing: Any, options: Any, lines: list[str]) -> None:
    lines[:] = docstrings.as_rst("\n".join(lines), lambda word: api_pages.full_name(word, name))


def _without_words(app: Any, what: str, name: str, thing: Any, skip: bool, options: Any) -> bool | None:
    return True if (getattr(thing, "__doc__", None) or "").startswith("Alias for field number") else None
