"""Run in a lesson's kernel: figures say in words what they show, explorers become still pictures."""

import re
import unicodedata
from base64 import b64encode

from matplotlib.figure import Figure

from cdprlab.course import Explorer
from cdprlab.course import Figure as ToldFigure
from cdprlab.course.designer.panel import RobotDesigner
from cdprlab.course.explorers.player import MotionPlayer


def install(shell):
    """Change what a kernel's outputs are made of."""
    for kind in (Explorer, RobotDesigner, MotionPlayer):
        shell.display_formatter.mimebundle_formatter.for_type(kind, still)
    # As a method: what is said to IPython about figures, matplotlib's inline backend makes it forget.
    for kind in (Figure, ToldFigure):
        kind._repr_pretty_ = lambda figure, printer, _: printer.text(describe(figure))
        kind._repr_mimebundle_ = None


def still(shown, **_):
    """An explorer as it stands: picture and numbers; beside them, for the page, what it is called and set to."""
    set_to = [f"{control.caption} {shown.values[name]:.4g}" if isinstance(shown.values[name], float)
              else f"{control.caption} {shown.values[name]}".replace("_", " ")
              for name, control in getattr(shown, "controls", {}).items()]
    data = {"image/png": b64encode(shown.picture).decode("ascii"), "text/plain": shown.text}
    return data, {"explorer": {"alt": shown.alt_text, "title": getattr(shown, "title", ""), "set_to": set_to}}


def describe(figure):
    """A figure in words: its panels' titles, axes and legends."""
    panels = [axes for axes in figure.axes if axes.get_label() != "<colorbar>"]
    scales = [axes.get_xlabel() or axes.get_ylabel() for axes in figure.axes if axes.get_label() == "<colorbar>"]
    said = [figure.get_suptitle(), *map(_panel, panels), *(f"colors: {scale}" for scale in scales if scale)]
    return plain("; ".join(filter(None, said))) or "Drawing without axes"


def _panel(axes):
    words = ", ".join(filter(None, (axes.get_title(side) for side in ("left", "center", "right"))))
    labels = " against ".join(filter(None, (axes.get_ylabel(), axes.get_xlabel()))) if axes.axison else ""
    legend = axes.get_legend()
    named = ", ".join(text.get_text() for text in legend.get_texts()) if legend else ""
    return ": ".join(filter(None, (words, labels))) + (f" (shown: {named})" if named else "")


def plain(words):
    """Without the mathematics' marks: $\\tau_\\mathrm{min}$ is τ_min."""
    words = re.sub(r"\\(?:mathrm|mathbf|mathit|text|dot|hat|vec)\b", "", words.replace("\n", " "))
    return re.sub(r"[${}\\]", "", re.sub(r"\\([A-Za-z]+)", _letter, words))


def _letter(found):
    case = "SMALL" if found[1].islower() else "CAPITAL"
    try:
        return unicodedata.lookup(f"GREEK {case} LETTER {found[1].upper()}")
    except KeyError:
        return found[1]
