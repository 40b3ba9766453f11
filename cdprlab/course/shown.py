"""What explorers and the designer share in a notebook: a widget that shows itself, and pictures with words."""

import re
import unicodedata
from base64 import b64encode
from collections.abc import Sequence
from functools import cache
from io import BytesIO
from pathlib import Path
from typing import Any


@cache
def style() -> str:
    """The one look of all widgets of the course, as HTML."""
    css = Path(__file__).with_name("widgets.css").read_text(encoding="utf-8")
    return f"<style>{css}</style>"


class Shown:
    """A widget with pictures in it; printed and headless notebooks show its text instead.

    widget : ipywidgets' box of all there is
    text : the numbers
    alt_text : a sentence for those who do not see the picture
    """

    widget: Any
    text: str = ""
    alt_text: str = ""

    def close(self) -> None:
        """Let go of everything; safe to call twice."""
        dismiss(self.widget)

    def _repr_mimebundle_(self, **options: Any) -> Any:
        words = {"text/plain": f"{self.alt_text}\n{self.text}".strip()}
        if self.widget.comm is None:  # closed
            return words
        return {**self.widget._repr_mimebundle_(**options), **words}


def figure_bundle(figure: Any, **_: Any) -> dict[str, str]:
    """A matplotlib figure as PNG, and as HTML with alternative text: its own, or what stands on it."""
    from ..view.notebook import picture_tag

    buffer = BytesIO()
    figure.savefig(buffer, format="png", dpi="figure", bbox_inches="tight")
    png = buffer.getvalue()
    return {"image/png": b64encode(png).decode("ascii"),
            "text/html": picture_tag(png, getattr(figure, "alt_text", "") or describe(figure))}


def describe(figure: Any) -> str:
    """A matplotlib figure in words: its panels' titles, axes and legends."""
    panels = [axes for axes in figure.axes if axes.get_label() != "<colorbar>"]
    scales = [axes.get_xlabel() or axes.get_ylabel() for axes in figure.axes if axes.get_label() == "<colorbar>"]
    said = [figure.get_suptitle(), *map(_panel, panels), *(f"colors: {scale}" for scale in scales if scale)]
    return _without_marks("; ".join(filter(None, said))) or "Drawing without axes"


def _panel(axes: Any) -> str:
    words = ", ".join(filter(None, (axes.get_title(side) for side in ("left", "center", "right"))))
    labels = " against ".join(filter(None, (axes.get_ylabel(), axes.get_xlabel()))) if axes.axison else ""
    legend = axes.get_legend()
    named = ", ".join(text.get_text() for text in legend.get_texts()) if legend else ""
    return f"{': '.join(filter(None, (words, labels)))}{f' (shown: {named})' if named else ''}"


def _without_marks(words: str) -> str:
    """Without the mathematics' marks: $\\tau_\\mathrm{min}$ is τ_min."""
    words = re.sub(r"\\(?:mathrm|mathbf|mathit|text|dot|hat|vec)\b", "", words.replace("\n", " "))
    return re.sub(r"[${}\\]", "", re.sub(r"\\([A-Za-z]+)", _letter, words))


def _letter(found: re.Match[str]) -> str:
    case = "SMALL" if found[1].islower() else "CAPITAL"
    try:
        return unicodedata.lookup(f"GREEK {case} LETTER {found[1].upper()}")
    except KeyError:
        return found[1]


def dismiss(widget: Any) -> None:
    """Close a widget, all it holds, and their styles and layouts."""
    for child in getattr(widget, "children", ()):
        dismiss(child)
    widget.unobserve_all()
    for model in (getattr(widget, "style", None), widget.layout, widget):
        if model is not None:
            model.close()


def boxed(parts: Sequence[Any], name: str = "") -> Any:
    """A box of widgets as widgets.css lays it out: "head", "columns", "picture", "beside", "controls", or the whole."""
    import ipywidgets

    box = ipywidgets.VBox(list(parts))
    box.add_class(f"cdprlab-{name}" if name else "cdprlab")
    return box
