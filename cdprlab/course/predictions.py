"""Predict, then move: questions before an explorer opens, and what was answered beside the truth."""

import html
from typing import Any, TypeVar

import ipywidgets

from ..arrays import checked
from ..errors import InvalidInput, quoted
from .explorers.since_start import NUMBER
from .shown import Shown, boxed, style

Told = TypeVar("Told", bound=Shown)


@checked
class Question:
    """What is to be predicted.

    text : asked, with the unit of a number
    truth : one of ``options``; without them a number, or the beginning of the explorer's line whose first number it is
    options : to choose from, "rise / fall"
    at : values of controls, where the truth is seen
    Raises InvalidInput for a truth that cannot be chosen.

    >>> Question("lifted, the pulls", "rise", "rise / fall", z=3.0).answer("fall")
    'fall'
    """

    def __init__(self, text: str, truth: str | float, options: str = "", **at: Any) -> None:
        self.text, self.truth, self.at = text, truth, at
        self.options = options.split(" / ") if options else []
        if options and truth not in self.options:
            raise InvalidInput(f"the truth must be one of {options}, got {quoted(truth)}")

    def entry(self) -> Any:
        """The ipywidget to answer by."""
        if self.options:   # buttons, for a menu's arrow keys are JupyterLab's
            widget = ipywidgets.ToggleButtons(options=self.options, value=None)
            widget.style.button_width = "auto"
        else:
            widget = ipywidgets.Text(placeholder="a number")
        widget.description, widget.style.description_width = self.text, "45%"
        return widget

    def answer(self, entered: str | None) -> str:
        """What was entered; "" if that is no answer."""
        if self.options or entered is None:
            return entered or ""
        try:
            return f"{float(entered.replace(',', '.')):g}"
        except ValueError:
            return ""

    def true_of(self, shown: Any) -> str:
        """The truth as text, once the controls are where it is seen."""
        if self.at:
            shown.reset(**self.at)
        if not isinstance(self.truth, str):
            return f"{self.truth:g}"
        if self.options:
            return self.truth
        line = next(line for line in shown.text.splitlines() if line.startswith(self.truth))
        return NUMBER.findall(line[len(self.truth):])[0]


def predict(shown: Told, *questions: Question) -> Told:
    """The same explorer or designer; in a notebook it opens when every question is answered.

    The button "See" moves the controls where a truth is seen, and puts it beside the answer. Programs see no change.
    """
    entries = [question.entry() for question in questions]
    opens = ipywidgets.Button(description="Open", disabled=True, tooltip="once every question is answered")
    lines = [ipywidgets.HTML() for _ in questions]
    sees = [ipywidgets.Button(description="See", tooltip=f"{question.text}: moves the controls there")
            for question in questions]
    words = ipywidgets.HTML(f"{style()}<b>Predict, then move.</b> Nothing is graded.")
    explorer, form = shown.widget, boxed([words, *entries, opens], "form")
    beside = boxed([boxed(pair, "truth") for pair in zip(lines, sees)], "truths")

    def tell(k: int, truth: str = "") -> None:
        said = questions[k].answer(entries[k].value)
        lines[k].value = f"{html.escape(questions[k].text)}: you said <b>{html.escape(said)}</b>{truth}"

    def entered(_: Any) -> None:
        opens.disabled = not all(question.answer(entry.value) for question, entry in zip(questions, entries))

    def opened(_: Any) -> None:
        form.layout.display, beside.layout.display, explorer.layout.display = "none", "", ""
        for k in range(len(questions)):
            tell(k)
        sees[0].focus()

    for k, (entry, see) in enumerate(zip(entries, sees)):
        entry.observe(entered, names="value")
        see.on_click(lambda _, k=k: tell(k, f", it is <b>{html.escape(questions[k].true_of(shown))}</b>"))
    opens.on_click(opened)
    beside.layout.display = explorer.layout.display = "none"
    shown.widget = boxed([form, beside, explorer], "predicted")
    return shown
