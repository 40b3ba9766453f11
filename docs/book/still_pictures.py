"""Run in a lesson's kernel: figures say in words what they show, explorers become still pictures."""

from base64 import b64encode

from matplotlib.figure import Figure

from cdprlab.course import Explorer, Figure as ToldFigure
from cdprlab.course.designer.panel import RobotDesigner
from cdprlab.course.explorers.player import MotionPlayer
from cdprlab.course.shown import describe


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
