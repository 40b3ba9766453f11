"""What explorers and the designer share in a notebook: a widget that shows itself, and pictures with words."""

import html
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
        bundle = self.widget._repr_mimebundle_(**options)
        data, *more = bundle if isinstance(bundle, tuple) else (bundle,)
        shown = {**(data or {}), **words}
        return (shown, *more) if more else shown


def figure_bundle(figure: Any, **_: Any) -> dict[str, str]:
    """A matplotlib figure as PNG, and as HTML with alternative text: its own, or what stands on its axes."""
    buffer = BytesIO()
    figure.savefig(buffer, format="png", dpi="figure", bbox_inches="tight")
    png = b64encode(buffer.getvalue()).decode()
    said = [figure.get_suptitle(), *(text for axes in figure.axes for text in (
        axes.get_title("left"), axes.get_title(), axes.get_ylabel(), axes.get_xlabel()))]
    words = html.escape(getattr(figure, "alt_text", "") or "; ".join(filter(None, said)) or "drawing")
    return {"image/png": png,
            "text/html": f'<img style="max-width: 100%" alt="{words}" src="data:image/png;base64,{png}">'}


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
