"""The robot designer: fields, picture, slice, warnings and numbers on one page, in a notebook or by itself."""

import html
from base64 import b64encode
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path as FilePath
from typing import Any

import ipywidgets
import numpy as np

from ...arrays import checked
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

_START = "caroca"
_WIDE = {"width": "auto"}
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
        self.picture = b""
        self.player: Any = None
        self._drawn = lru_cache(DesignPicture)
        self._slices = SlicePicture()
        self._make_widgets()
        self.refresh()

    @property
    def world(self) -> World:
        """The last good world, to be saved, run or drawn."""
        return self.session.world

    def do(self, verb: Callable[..., bool], *entries: Any, said: str = "", **named: Any) -> bool:
        """A verb of the session, and all that follows from it on the page; or the mistake, beside the fields.

        said : when it worked

        >>> import cdprlab as cl
        >>> designer = robot_designer(cl.load_world("caroca"))
        >>> designer.do(designer.session.add_cable), designer.do(designer.session.undo)
        (True, True)
        """
        worked = verb(*entries, **named)
        if worked:
            self._say(said)
            self.refresh()
        else:
            self._say(f"{self.session.mistake}\nThe robot is the one before this edit.", "alert")
        _show_only([] if worked else [self.take_back], [self.take_back])
        return worked

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
            table = "\n".join(f"{name:<32} {value}" for name, value in run.table().items())
            self.below.children = (ipywidgets.HTML(as_html(table)), self.player.widget)
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
        numbers, verdict = report(world, found), session.verdict
        judged = [] if verdict is None else [f"The brief is {'' if verdict.met else 'not '}met:", str(verdict), ""]
        self.text = "\n".join([*judged, *found.warnings, numbers])
        self.brief.value = as_html("\n".join(judged)) if judged else ""
        if world.name in self.names.options:
            self.names.value = world.name
        mark = " · <i>● not saved</i>" if session.unsaved else ""
        self.head.value = (f"{style()}<b>{html.escape(world.title or world.name)}</b> "
                           f"({html.escape(world.name)}){mark}")
        self.warnings.value, self.numbers.value = warnings_html(found), as_html(numbers)
        for button, word, label in ((self.undo_button, "Undo", session.history.undo_label),
                                    (self.redo_button, "Redo", session.history.redo_label)):
            button.description, button.disabled = f"{word}: {label}" if label else word, not label
        _show_only([self.planes, self.eye] if world.robot.dimension == 3 else [],
                   [self.planes, self.eye])

    def _say(self, words: str, role: str = "status") -> None:
        self.message.value = f'<div role="{role}">{html.escape(words)}</div>' if words else ""

    def _draw(self) -> None:
        world, cable = self.world, self.session.place.cable
        self.picture = self._drawn(world.robot.dimension).png(world, self.eye.value, cable)
        self.alt_text = f"{world.title or world.name}: the robot at its start, cable {cable + 1} marked."
        self.image.value = picture_tag(self.picture, self.alt_text)

    def _show_group(self) -> None:
        group, world, place = self.groups.value, self.world, self.session.place
        _show_only([self._parts.get(group, self._parts["form"])], self._parts.values())
        if group in GROUPS:
            self.form.show(rows(world, group, place), world)
            self._show_tools(group)
        elif group == FILE:
            text = world.to_yaml()
            self.file_text.value = text
            data = b64encode(text.encode()).decode("ascii")
            self.download.value = (f'<a download="{world.name}.yaml" href="data:text/yaml;base64,{data}">'
                                   f"Download {world.name}.yaml</a>")

    def _show_tools(self, group: str) -> None:
        robot, place = self.world.robot, self.session.place
        self._quiet = True
        try:
            self.cables.options = [(f"cable {i + 1}", i) for i in range(robot.n_cables)]
            self.bases.options = [(base.name, k) for k, base in enumerate(robot.bases)] or [("none yet", 0)]
            self.cables.value, self.bases.value = place
        finally:
            self._quiet = False
        moves = group == "task" and self.world.tasks["default"].kind != "hold"
        _show_only([] if moves else [self._tools.get(group)], self._tools.values())
        _show_only([self.mirror] if group == "cables" and not robot.bases else [], [self.mirror])

    # --- widgets ----------------------------------------------------------------------------------------------
    def _make_widgets(self) -> None:
        self._quiet = False
        (self.head, self.image, self.slice, self.warnings, self.numbers, self.message, self.download,
         self.brief) = (ipywidgets.HTML() for _ in range(8))
        self.groups = ipywidgets.ToggleButtons(options=[*GROUPS, FILE, FLIGHT],
                                               style={"button_width": "92px"}, layout=_WIDE)
        self.groups.observe(lambda _: self._show_group(), names="value")
        self.form = Form(lambda *what: self.do(self.session.type, *what))
        self.mirror = ipywidgets.Dropdown(
            options=[("nothing", ""), *((f"mirror images at {' and '.join(axes)}", axes)
                                        for axes in ("x", "y", "xy"))],
            description="edits also", layout=_WIDE, style={"description_width": "5em"})
        self.mirror.observe(lambda change: setattr(self.session, "mirrored", change["new"]),
                            names="value")
        self.take_back = self._button("Take the entry back", "auto", self.do, lambda: True)
        self.take_back.layout.display = "none"
        self._tools = self._make_tools()
        self.planes = ipywidgets.Dropdown(options=PLANES, description="Slice",
                                          layout={"width": "12em"},
                                          style={"description_width": "3.5em"})
        self.planes.observe(self._look, names="value")
        self.eye = ipywidgets.FloatSlider(
            value=25.0, min=-180, max=180, step=5, description="seen from [deg]",
            readout_format=".0f", style={"description_width": "9.5em"}, layout=_WIDE)
        self.eye.add_class("view-only")  # it changes the picture, no number
        self.eye.observe(lambda _: self._draw(), names="value")
        cables, bases, start, task = self._tools.values()
        form = ipywidgets.VBox([cables, bases, self.mirror, self.form.box, start, task])
        self._parts = {"form": form, FILE: self._file_part(), FLIGHT: self._flight_part()}
        # Words and wishes first, then what they make: the order of the Tab key.
        fields = boxed([self.groups, self.message, self.take_back, *self._parts.values(),
                        self.warnings, self.brief], "fields")
        worth = boxed([boxed([self.planes, self.slice], "slice"), boxed([self.numbers], "worth")],
                      "columns")
        picture = boxed([self.image, self.eye, worth], "design")
        self.below = boxed([])
        self.page = boxed([self.head, self._toolbar(), boxed([fields, picture], "columns")])
        self.widget = ipywidgets.VBox([self.page, self.below])

    def _button(self, word: str, width: str, work: Callable[..., Any], *entries: Any) -> Any:
        """A button that does something."""
        button = ipywidgets.Button(description=word, layout={"width": width})
        button.on_click(lambda _: work(*entries))
        return button

    def _toolbar(self) -> Any:
        session = self.session
        self.undo_button = self._button("Undo", "auto", self.do, session.undo)
        self.redo_button = self._button("Redo", "auto", self.do, session.redo)
        names = self.names = ipywidgets.Dropdown(
            options=[HALL, *world_names()], description="World", layout={"width": "210px"},
            style={"description_width": "3.5em"})
        opens = self._button("Open", "56px", lambda: self.do(session.load, names.value))
        new = self._button("New", "52px", lambda: self.do(session.new,
                                                          names.value.replace(HALL, "")))
        new.tooltip = "a robot of your own: an empty hall, or a copy of this world"
        names.observe(lambda change: setattr(opens, "disabled", change["new"] == HALL), names="value")
        return ipywidgets.HBox([names, opens, new, self.undo_button, self.redo_button],
                               layout={"flex_flow": "row wrap"})

    def _make_tools(self) -> dict[str, Any]:
        """Group → what stands beside its fields."""
        session = self.session
        self.cables, self.bases = (ipywidgets.Dropdown(description="edit",
                                                       layout={"width": "auto", "flex": "1 1 auto"},
                                                       style={"description_width": "2em"})
                                   for _ in range(2))
        self.cables.observe(lambda change: self._turn(cable=change["new"]), names="value")
        self.bases.observe(lambda change: self._turn(base=change["new"]), names="value")

        def beside(choice: Any, word: str, add: Any, remove: Any) -> Any:
            buttons = [self._button(word, "60px", self.do, add),
                       self._button("Remove", "76px", self.do, remove)]
            return ipywidgets.HBox([choice, *buttons], layout=_WIDE)

        return {"cables": beside(self.cables, "Copy", session.add_cable, session.remove_cable),
                "bases": beside(self.bases, "Add", session.add_base, session.remove_base),
                "start": self._button("Frame around the exit points", "auto", self.do,
                                      session.frame_exits),
                "task": self._button("Make it a motion", "auto", self.do, session.make_motion)}

    def _file_part(self) -> Any:
        session = self.session
        self.file_text = ipywidgets.Textarea(layout=_WIDE | {"height": "250px"})
        path = ipywidgets.Text(value="my_robot.yaml", description="file", layout=_WIDE,
                               style={"description_width": "3em"},
                               tooltip="in the folder of the notebook, or a whole path")
        upload = ipywidgets.FileUpload(accept=".yaml,.yml", multiple=False,
                                       description="Upload",
                                       layout={"width": "120px"})
        upload.observe(lambda _: self._uploaded(upload), names="value")
        self.apply = self._button("Apply this text", "auto",
                                  lambda: self.do(session.read, self.file_text.value))
        save = self._button("Save as", "84px", lambda: self.do(
            session.save, path.value, said=f"Saved as {FilePath(path.value).expanduser().absolute()}."))
        load = self._button("Open", "60px", lambda: self.do(session.load, path.value.strip()))
        return ipywidgets.VBox([self.file_text, self.apply, path,
                                ipywidgets.HBox([save, load, upload]), self.download])

    def _flight_part(self) -> Any:
        wide = {"layout": _WIDE, "style": {"description_width": "9.5em"}}
        method = ipywidgets.Dropdown(options=[(name.replace("_", " "), name)
                                              for name in tension_methods()],
                                     value="quadratic_program",
                                     description="tensions by", **wide)
        gains = {name: ipywidgets.BoundedFloatText(value=value, min=0.0, max=1e6, step=10.0, description=label, **wide)
                 for name, value, label in (("kp", 100.0, "K_p [1/s²]"), ("kd", 100.0, "K_d [1/s]"),
                                            ("ki", 0.0, "K_i [1/s³]"))}
        words = ipywidgets.HTML("Computed torque flies the default task of the group “task”.")
        go = self._button("Simulate", "auto",
                          lambda: self.simulate(method=method.value,
                                                **{name: gain.value for name, gain in gains.items()}))
        return ipywidgets.VBox([words, method, *gains.values(), go])

    # --- moves ------------------------------------------------------------------------------------------------
    def _turn(self, **where: Any) -> None:
        """Another cable or base in the fields; nothing is edited."""
        if self._quiet or None in where.values():
            return
        self.session.turn_to(self.session.place._replace(**where))
        self._show_group()
        self._draw()

    def _look(self, change: Any) -> None:
        self.session.look_at(change["new"])
        self.refresh()

    def _uploaded(self, upload: Any) -> None:
        if upload.value:
            file = upload.value[0]
            self.do(self.session.read, bytes(file["content"]).decode("utf-8", "replace"),
                    file["name"])
            upload.value = ()  # the same file may be uploaded again


@checked
def robot_designer(world: World | str = _START, brief: Brief | None = None) -> RobotDesigner:
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
    >>> designer.session.history.redo_label
    'cable 1: exit_point[2]'
    """
    return RobotDesigner(load_world(world) if isinstance(world, str) else world, brief)


def _show_only(shown: list[Any], among: Any) -> None:
    for part in among:
        part.layout.display = None if part in shown else "none"
