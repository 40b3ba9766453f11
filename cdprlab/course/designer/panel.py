"""The robot designer: fields, picture, slice, warnings and numbers on one page, in a notebook or by itself."""

import html
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import Any

import ipywidgets
import numpy as np

from ...arrays import checked
from ...errors import CdprError
from ...run import Run
from ...tensions import tension_methods
from ...view.notebook import picture_tag
from ...world import World, load_world, world_names
from ..brief import Brief
from ..explorers.player import run_player
from ..shown import Shown, boxed, style
from .assessment import PLANES
from .fields import GROUPS, rows
from .forms import Form
from .pictures import DesignPicture, SlicePicture
from .report import as_html, report, warnings_html
from .session import DesignSession

FILE, FLIGHT = "world file", "simulate"
HALL = "an empty hall"


class RobotDesigner(Shown):
    """Edit a robot and see at once what it is worth; see `robot_designer`.

    session : DesignSession, all that is not widgets
    text : warnings and numbers, as text
    picture : of the robot, PNG
    """

    def __init__(self, world: World, brief: Brief | None = None) -> None:
        self.session = DesignSession(world, brief)
        self.player: Any = None
        self._drawn = lru_cache(DesignPicture)
        self._slices = SlicePicture()
        self._make_widgets()
        self.refresh()

    @property
    def world(self) -> World:
        """The last good world, to be saved, run or drawn."""
        return self.session.world

    def do(self, verb: Callable[..., object], *entries: Any, said: str = "", **named: Any) -> bool:
        """A verb of the session, and all that follows from it on the page; or the mistake, beside the fields.

        said : when it worked

        >>> import cdprlab as cl
        >>> designer = robot_designer(cl.load_world("caroca"))
        >>> designer.do(designer.session.add, "cables"), designer.do(designer.session.undo)
        (True, True)
        """
        mistake = ""
        try:
            verb(*entries, **named)
        except CdprError as error:
            mistake = f"{error}\nThe robot is the one before this edit."
        else:
            self.refresh()
        self._say(mistake or said, "alert" if mistake else "status")
        _show(self.take_back, bool(mistake))
        return not mistake

    def simulate(self, **chosen: Any) -> Run | None:
        """The default task in the engine, played below; returns the Run, or None with the reason on the page.

        chosen : see `DesignSession.simulate`
        """
        self._say("Simulating …")
        if self.player is not None:
            self.player.close()
        self.player, self.below.children = None, ()
        self.do(self.session.simulate, said="Simulated; played below.", **chosen)
        run = self.session.flown
        if run is not None:
            if not run.feasible.all():
                self._say(f"The flight failed: at {np.sum(~run.feasible)} of {len(run.time)} steps no "
                          "tensions within the limits exert what the controller asks for. "
                          "Played below.", "alert")
            self.player = run_player(run)
            self.below.children = (self.player.widget,)
        return run

    def close(self) -> None:
        """Let go of everything; safe to call twice."""
        if self.player is not None:
            self.player.close()
        super().close()

    # --- showing ----------------------------------------------------------------------------------------------
    def refresh(self) -> None:
        """Show the last good robot everywhere."""
        session, world, found = self.session, self.world, self.session.assessment
        self._show_group()
        self._draw()
        self.slice.value = self._slices.html(world, found.slice)
        numbers, judged = report(world, found), list[str]()
        if session.brief is not None:
            verdict = session.brief.judge(world)
            judged = [f"The brief is {'' if verdict.met else 'not '}met:", str(verdict), ""]
        self.text = "\n".join([*judged, *found.warnings, numbers])
        self.brief.value = as_html("\n".join(judged)) if judged else ""
        if world.name in self.names.options:
            self.names.value = world.name
        self.head.value = (f"{style()}<b>{html.escape(world.title or world.name)}</b> ({html.escape(world.name)})"
                           f"{' · <i>● not saved</i>' if session.unsaved else ''}")
        self.warnings.value, self.numbers.value = warnings_html(found), as_html(numbers)
        for button, word, label in zip((self.undo_button, self.redo_button), ("Undo", "Redo"), session.history.labels):
            button.description, button.disabled = f"{word}: {label}" if label else word, not label
        for control in (self.planes, self.eye):
            _show(control, world.robot.dimension == 3)

    def _say(self, words: str, role: str = "status") -> None:
        self.message.value = f'<div role="{role}">{html.escape(words)}</div>' if words else ""

    def _draw(self, *_: Any) -> None:
        world, cable = self.world, self.session.place.cable
        self.picture = self._drawn(world.robot.dimension).png(world, self.eye.value, cable)
        self.alt_text = f"{world.title or world.name}: the robot at its start, cable {cable + 1} marked."
        self.image.value = picture_tag(self.picture, self.alt_text)

    def _show_group(self, *_: Any) -> None:
        group, world, place = self.groups.value, self.world, self.session.place
        for name, part in self._parts.items():
            _show(part, name == group or (name == "form" and group in GROUPS))
        if group in GROUPS:
            self.form.show(rows(world, group, place), world)
            self._show_tools(group)
        elif group == FILE:
            self.file_text.value = world.to_yaml()

    def _show_tools(self, group: str) -> None:
        robot, place = self.world.robot, self.session.place
        self._quiet = True
        self.cables.options = [(f"cable {i + 1}", i) for i in range(robot.n_cables)]
        self.bases.options = [(base.name, k) for k, base in enumerate(robot.bases)] or [("none yet", 0)]
        self.cables.value, self.bases.value = place
        self._quiet = False
        moves = self.world.tasks["default"].kind != "hold"
        for name, tool in self._tools.items():
            _show(tool, name == group and not (name == "task" and moves))
        _show(self.mirror, group == "cables" and not robot.bases)

    # --- widgets ----------------------------------------------------------------------------------------------
    def _make_widgets(self) -> None:
        session, self._quiet = self.session, False
        (self.head, self.image, self.slice, self.warnings, self.numbers, self.message,
         self.brief) = (ipywidgets.HTML() for _ in range(7))
        self.groups = ipywidgets.ToggleButtons(options=[*GROUPS, FILE, FLIGHT], style={"button_width": "92px"})
        _on_value(self.groups, self._show_group)
        self.form = Form(lambda *what: self.do(session.type, *what))
        images = [(f"mirror images at {' and '.join(axes)}", axes) for axes in ("x", "y", "xy")]
        self.mirror = _menu([("nothing", ""), *images], "edits also",
                            lambda axes: setattr(session, "mirrored", axes))
        self.take_back = self._verb("Take the entry back", lambda: None)
        _show(self.take_back, False)
        self.cables = _menu([], "edit", lambda cable: self._turn(cable=cable))
        self.bases = _menu([], "edit", lambda base: self._turn(base=base))
        self._tools = {kind: boxed([menu, self._verb(word, session.add, kind),
                                    self._verb("Remove", session.remove, kind)], "tools")
                       for kind, menu, word in (("cables", self.cables, "Copy"), ("bases", self.bases, "Add"))}
        self._tools |= {"start": self._verb("Frame around the exit points", session.frame_exits),
                        "task": self._verb("Make it a motion", session.make_motion)}
        self.planes = _menu(PLANES, "Slice", self._look)
        self.eye = ipywidgets.FloatSlider(value=25.0, min=-180, max=180, step=5, description="seen from [deg]",
                                          readout_format=".0f")
        self.eye.add_class("view-only")  # it changes the picture, no number
        _on_value(self.eye, self._draw)
        form = boxed([*self._tools.values(), self.mirror, self.form.box], "rows")
        self._parts = {"form": form, FILE: self._file_part(), FLIGHT: self._flight_part()}
        # Words and wishes first, then what they make: the order of the Tab key.
        fields = boxed([self.groups, self.message, self.take_back, *self._parts.values(),
                        self.warnings, self.brief], "fields")
        worth = boxed([boxed([self.planes, self.slice], "slice"), boxed([self.numbers], "worth")], "columns")
        picture = boxed([self.image, self.eye, worth], "design")
        self.below = boxed([])
        page = boxed([self.head, self._toolbar(), boxed([fields, picture], "columns")])
        self.widget = ipywidgets.VBox([page, self.below])

    def _verb(self, word: str, verb: Callable[..., object], *entries: Any) -> Any:
        """A button that does what the session can."""
        return _button(word, lambda: self.do(verb, *entries))

    def _toolbar(self) -> Any:
        session = self.session
        self.undo_button, self.redo_button = self._verb("Undo", session.undo), self._verb("Redo", session.redo)
        opens = _button("Open", lambda: self.do(session.load, names.value))
        names = self.names = _menu([HALL, *world_names()], "World",
                                   lambda name: setattr(opens, "disabled", name == HALL))
        new = _button("New", lambda: self.do(session.new, names.value.replace(HALL, "")))
        new.tooltip = "a robot of your own: an empty hall, or a copy of this world"
        return boxed([names, opens, new, self.undo_button, self.redo_button], "tools")

    def _file_part(self) -> Any:
        session = self.session
        self.file_text = ipywidgets.Textarea()
        path = ipywidgets.Text(value="my_robot.yaml", description="file",
                               tooltip="in the folder of the notebook, or a whole path")
        self.apply = _button("Apply this text", lambda: self.do(session.read, self.file_text.value))
        save = _button("Save as", lambda: self.do(
            session.save, path.value, said=f"Saved as {Path(path.value).expanduser().absolute()}."))
        load = _button("Open", lambda: self.do(session.load, path.value.strip()))
        return boxed([self.file_text, self.apply, path, boxed([save, load], "tools")], "rows")

    def _flight_part(self) -> Any:
        method = ipywidgets.Dropdown(options=[(name.replace("_", " "), name) for name in tension_methods()],
                                     value="quadratic_program", description="tensions by")
        gains = {name: ipywidgets.BoundedFloatText(value=value, max=1e6, step=10.0, description=label)
                 for name, value, label in (("kp", 100.0, "K_p [1/s²]"), ("kd", 100.0, "K_d [1/s]"),
                                            ("ki", 0.0, "K_i [1/s³]"))}
        words = ipywidgets.HTML("Computed torque flies the default task of the group “task”.")
        go = _button("Simulate", lambda: self.simulate(
            method=method.value, **{name: gain.value for name, gain in gains.items()}))
        return boxed([words, method, *gains.values(), go], "flight")

    # --- moves ------------------------------------------------------------------------------------------------
    def _turn(self, **where: Any) -> None:
        """Another cable or base in the fields; nothing is edited."""
        if not self._quiet:
            self.session.turn_to(self.session.place._replace(**where))
            self._show_group()
            self._draw()

    def _look(self, plane: str) -> None:
        self.session.look_at(plane)
        self.refresh()


@checked
def robot_designer(world: World | str = "caroca", brief: Brief | None = None) -> RobotDesigner:
    """Edit a robot's world file field by field; picture, workspace slice, stiffness and warnings follow at once.

    world : World, or the name or path of one
    brief : judged with every edit too, if given
    A bad edit is named and changes nothing; everything can be undone. ``designer.world`` is the
    robot as it is.
    Raises WorldError for an unknown name, InvalidInput for anything else.

    >>> designer = robot_designer("planar_rigid")
    >>> designer.do(designer.session.edit, ("cables", 0, "exit_point", 1), 0.5)
    True
    >>> designer.do(designer.session.undo)
    True
    >>> designer.session.history.labels
    ('', 'cable 1: exit_point[2]')
    """
    return RobotDesigner(load_world(world) if isinstance(world, str) else world, brief)


def _menu(options: Any, name: str, chosen: Callable[[Any], object]) -> Any:
    """A menu that tells what is chosen."""
    menu = ipywidgets.Dropdown(options=options, description=name)
    _on_value(menu, chosen)
    return menu


def _button(word: str, work: Callable[[], object]) -> Any:
    """A button that does something."""
    button = ipywidgets.Button(description=word)
    button.on_click(lambda _: work())
    return button


def _on_value(widget: Any, work: Callable[[Any], object]) -> None:
    widget.observe(lambda change: work(change["new"]), names="value")


def _show(part: Any, visible: bool) -> None:
    part.layout.display = None if visible else "none"
