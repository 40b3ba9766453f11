"""Play a motion: a robot to be turned with the mouse, its cables' tensions beside it. The kernel only hands it over."""

import html
from collections.abc import Mapping, Sequence
from typing import Any

import ipywidgets

from ...errors import InvalidInput
from ...run import Run
from ...simulate.state import State
from ...view.notebook import picture_tag
from ...view.scene import MotionScene, states_of
from ..shown import Shown, boxed, style


class MotionPlayer(Shown):
    """A scene that plays, with speed, time and tensions; a still in its place where there is no WebGL.

    motion : Run, or states that an engine told, ``[engine.state(), …]``, or several such lists, shown one after the
        other: what is said meanwhile → states
    title : above the picture; default that of the run's world
    ``picture`` is the still [PNG]. Raises InvalidInput for anything else.

    >>> play(42)
    Traceback (most recent call last):
    ...
    cdprlab.errors.InvalidInput: play takes a Run or a list of engine states, got int
    """

    def __init__(self, motion: Run | Sequence[State] | Mapping[str, Sequence[State]], title: str = "") -> None:
        self.run = motion if isinstance(motion, Run) else None
        states: Any = motion
        parts = [*motion.values()] if isinstance(motion, Mapping) else [motion]
        if isinstance(motion, Run):
            states, title = states_of(motion), title or motion.world.title
            self.text = "\n".join(f"{name:<32} {value}" for name, value in motion.table().items())
        elif not all(isinstance(part, Sequence) and all(isinstance(state, State) for state in part) for part in parts):
            raise InvalidInput(f"play takes a Run or a list of engine states, got {type(motion).__name__}")
        self.scene = scene = MotionScene(states, title)
        said = "".join(f" {note}." for note in dict.fromkeys(scene.notes) if note)
        self.alt_text = (f"{title}: {scene.states[0].robot.n_cables} cables colored by tension, "
                         f"0 to {scene.largest:.0f} N, over {scene.times[-1]:.2f} s.{said}")
        head = ipywidgets.HTML(f"{style()}<b>{html.escape(title)}</b>")
        self.picture = self.scene.still()
        still = ipywidgets.HTML(picture_tag(self.picture, self.alt_text))
        still.add_class("cdprlab-still")
        self.scene.plot.add_class("cdprlab-scene")
        numbers = ipywidgets.HTML(f"<pre>{html.escape(self.text)}</pre>")
        self.widget = boxed([boxed([head], "head"), self.scene.plot, still, numbers])

    def close(self) -> None:
        """Let go of everything, the 3-D scene too."""
        for thing in (*self.scene.plot.objects, self.scene.plot):
            thing.layout.close()
            ipywidgets.Widget.close(thing)  # k3d's own close of a plot only takes it off the page
        super().close()


run_player = play = MotionPlayer
