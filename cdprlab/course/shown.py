"""What explorers and the designer share in a notebook: a widget that shows itself, and pictures with words."""

import html
from base64 import b64encode
from typing import Any


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


def dismiss(widget: Any) -> None:
    """Close a widget, all it holds, and their styles and layouts."""
    for child in getattr(widget, "children", ()):
        dismiss(child)
    widget.unobserve_all()
    for model in (getattr(widget, "style", None), widget.layout, widget):
        if model is not None:
            model.close()


def picture_tag(png: bytes, size: tuple[float, float], alt_text: str) -> str:
    """HTML of a picture: ipywidgets' Image knows no alternative text.

    size : [inch at 100 pixels]
    """
    width, height = (round(100 * side) for side in size)
    # Decoded before the page is painted again, and its place kept: no flicker while a slider
    # moves.
    return (f'<img decoding="sync" width="{width}" height="{height}" style="max-width: 100%; height: auto" '
            f'alt="{html.escape(alt_text)}" src="data:image/png;base64,{b64encode(png).decode("ascii")}">')
