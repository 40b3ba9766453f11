"""The robot designer: fields, picture, slice, warnings and numbers on one page, in a notebook or by itself."""

from __future__ import annotations

import html
from base64 import b64encode
from collections.abc import Callable
from typing import Any

import ipywidgets

from ...run import Run
from ...tensions import tension_methods
from ...world import World, load_world, world_names
from ..brief import Brief
from ..explorers.player import run_player
from ..shown import Shown, picture_tag
from .assessment import PLANES
from .design_picture import SIZE, DesignPicture
from .fields import GROUPS, rows
from .forms import Form
from .report import as_html, report, warnings_html
from .session import DesignSession
from .slice_picture import SlicePicture

_START = "caroca"
FILE, FLIGHT = "world file", "simulate"


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
        self._azimuth = 25.0
        self._drawn: tuple[World, DesignPicture] | None = None
        self._slices = SlicePicture()
        self._make_widgets()
        self.refresh()

    @property
    def world(self) -> World:
        """The last good world, to be saved, run or drawn."""
        return self.session.world

    def do(self, verb: Callable[..., bool], *entries: Any, said: str = "") -> bool:
        """A verb of the session, and all that follows from it on the page; or the mistake, beside the fields.

        said : when it worked

        >>> import cdprlab as cl
        >>> designer = robot_designer(cl.load_world("caroca"))
        >>> designer.do(designer.session.add_cable), designer.do(designer.session.undo)
        (True, True)
        """
        worked = verb(*entries)
        if worked:
            self._say(said)
            self.refresh()
        else:
            self._message.value = (
                '<div role="alert" style="color: #A32A00; white-space: pre-wrap; line-height: 1.35">'
                f"<b>{html.escape(self.session.mistake)}</b>\nThe robot is the one before this edit.</div>")
        return worked

    def edit(self, path: tuple[str | int, ...], value: Any) -> bool:
        """As typing it: another value at a place of the world file; says whether that is a robot.

        >>> import cdprlab as cl
        >>> designer = robot_designer(cl.load_world("caroca"))
        >>> designer.edit(("platform", "mass"), -1.0), designer.world.robot.mass
        (False, 150.0)
        """
        return self.do(self.session.edit, path, value)

    def undo(self) -> bool:
        """Before the last edit."""
        return self.do(self.session.undo)

    def redo(self) -> bool:
        """The edit undone last, again."""
        return self.do(self.session.redo)

    def load(self, name_or_path: str) -> bool:
        """Another world in place of this one; it can be undone."""
        return self.do(self.session.load, name_or_path)

    def save(self, path: str) -> bool:
        """Write the world file."""
        return self.do(self.session.save, path, said=f"Saved as {path}.")

    def simulate(self, method: str = "quadratic_program", kp: float = 100.0, kd: float = 100.0) -> Run | None:
        """The default task in the engine, played below; returns the Run, or None with the reason on the page.

        method, kp, kd : see `DesignSession.simulate`
        """
        self._say("Simulating …")
        if self.player is not None:
            self.player.close()
            self.player, self._below.children = None, ()
        self.do(self.session.simulate, method, kp, kd, said="Simulated; played at the end of the page.")
        run = self.session.flown
        if run is not None:
            self.player = run_player(run)
            table = "\n".join(f"{name:<32} {value}" for name, value in run.table().items())
            self._below.children = (ipywidgets.HTML(as_html(table)), self.player.widget)
        return run

    def close(self) -> None:
        """Let go of everything; safe to call twice."""
        if self.player is not None:
            self.player.close()
        super().close()

    # --- showing ----------------------------------------------------------------------------------------------
    def refresh(self) -> None:
        """Show the last good robot everywhere."""
        session, world = self.session, self.world
        found = session.assessment
        self._show_group()
        self._draw()
        self._slice.value = self._slices.html(world, found.slice)
        numbers, verdict = report(world, found), session.verdict
        judged = [] if verdict is None else [f"The brief is {'' if verdict.met else 'not '}met:", str(verdict), ""]
        self.text = "\n".join([*judged, *found.warnings, numbers])
        self._brief.value = as_html("\n".join(judged))
        self._warnings.value, self._numbers.value = warnings_html(found), as_html(numbers)
        for button, word, label in ((self._undo, "Undo", session.history.undo_label),
                                    (self._redo, "Redo", session.history.redo_label)):
            button.description, button.disabled = f"{word}: {label}" if label else word, not label
        _show_only([self._planes, self._eye] if world.robot.dimension == 3 else [], [self._planes, self._eye])

    def _say(self, words: str) -> None:
        self._message.value = f'<div role="status">{html.escape(words)}</div>' if words else ""

    def _draw(self) -> None:
        world, cable = self.world, self.session.place.cable
        if self._drawn is None or self._drawn[0] is not world:
            self._drawn = world, DesignPicture(world, cable, self._azimuth)
        self.picture = self._drawn[1].png(self._azimuth, cable)
        self.alt_text = f"{world.title or world.name}: the robot at its start, cable {cable + 1} marked."
        self._image.value = picture_tag(self.picture, SIZE, self.alt_text)

    def _show_group(self) -> None:
        group, world, place = self._groups.value, self.world, self.session.place
        _show_only([self._parts.get(group, self._parts["form"])], self._parts.values())
        if group in GROUPS:
            self._form.show(rows(world, group, place), world)
            self._show_choices(group)
        elif group == FILE:
            text = world.to_yaml()
            self._text.value = text
            data = b64encode(text.encode()).decode("ascii")
            self._download.value = (f'<a download="{world.name}.yaml" href="data:text/yaml;base64,{data}">'
                                    f"Download {world.name}.yaml</a>")

    def _show_choices(self, group: str) -> None:
        robot, place = self.world.robot, self.session.place
        self._quiet = True
        try:
            self._cables.options = [(f"cable {i + 1}", i) for i in range(robot.n_cables)]
            self._cables.value = place.cable
            self._bases.options = [(base.name, k) for k, base in enumerate(robot.bases)] or [("none yet", 0)]
            self._bases.value = place.base
        finally:
            self._quiet = False
        wanted = self._tools.get(group)
        if group == "task" and self.world.tasks["default"].kind != "hold":
            wanted = None
        _show_only([wanted], self._tools.values())

    # --- widgets ----------------------------------------------------------------------------------------------
    def _make_widgets(self) -> None:
        self._quiet = False
        self._image, self._slice, self._warnings, self._numbers, self._message, self._download, self._brief = (
            ipywidgets.HTML() for _ in range(7))
        self._groups = ipywidgets.ToggleButtons(options=[*GROUPS, FILE, FLIGHT], style={"button_width": "6.3em"},
                                                layout={"width": "21em"})
        self._groups.observe(lambda _: self._show_group(), names="value")
        self._form = Form(lambda field, entry: self.do(self.session.type, field, entry))
        self._tools = self._make_tools()
        self._planes = ipywidgets.Dropdown(options=PLANES, description="Slice", layout={"width": "12em"},
                                           style={"description_width": "3.5em"})
        self._planes.observe(self._look, names="value")
        self._eye = ipywidgets.FloatSlider(
            value=self._azimuth, min=-180, max=180, step=5, description="seen from [deg]", readout_format=".0f",
            style={"description_width": "9.5em"}, layout={"width": "32em", "max_width": "100%"})
        self._eye.add_class("view-only")  # it changes the picture, no number
        self._eye.observe(self._walk, names="value")
        above, below = [self._tools["cables"], self._tools["bases"]], [self._tools["start"], self._tools["task"]]
        self._parts = {"form": ipywidgets.VBox([*above, self._form.box, *below]), FILE: self._file_part(),
                       FLIGHT: self._flight_part()}
        # Words and wishes first, then what they make: the order of the Tab key.
        left = ipywidgets.VBox([self._groups, *self._parts.values(), self._message],
                               layout={"width": "21.5em", "flex": "0 0 auto"})
        middle = ipywidgets.VBox([self._image, self._eye, self._brief, self._warnings],
                                 layout={"width": f"{100 * SIZE[0] + 4:.0f}px", "max_width": "100%"})
        right = ipywidgets.VBox([self._planes, self._slice, self._numbers], layout={"width": "350px"})
        self._below = ipywidgets.VBox([])
        wrapping = {"flex_flow": "row wrap", "align_items": "flex-start"}
        self.widget = ipywidgets.VBox([self._toolbar(), ipywidgets.HBox([left, middle, right], layout=wrapping),
                                       self._below])

    def _button(self, word: str, width: str, work: Callable[..., Any], *entries: Any) -> Any:
        """A button that does something."""
        button = ipywidgets.Button(description=word, layout={"width": width})
        button.on_click(lambda _: work(*entries))
        return button

    def _toolbar(self) -> Any:
        self._undo, self._redo = self._button("Undo", "auto", self.undo), self._button("Redo", "auto", self.redo)
        names = ipywidgets.Dropdown(options=world_names(), value=_START, description="World", layout={"width": "17em"},
                                    style={"description_width": "3.5em"})
        opens = self._button("Open", "5em", lambda: self.load(names.value))
        return ipywidgets.HBox([names, opens, self._undo, self._redo], layout={"flex_flow": "row wrap"})

    def _make_tools(self) -> dict[str, Any]:
        """Group → what stands beside its fields."""
        session = self.session
        self._cables, self._bases = (ipywidgets.Dropdown(description="edit", layout={"width": "9.6em"},
                                                         style={"description_width": "2em"}) for _ in range(2))
        self._cables.observe(lambda change: self._turn(cable=change["new"]), names="value")
        self._bases.observe(lambda change: self._turn(base=change["new"]), names="value")
        return {
            "cables": ipywidgets.HBox([self._cables, self._button("Copy", "5.3em", self.do, session.add_cable),
                                       self._button("Remove", "5.3em", self.do, session.remove_cable)],
                                      layout={"width": "21em"}),
            "bases": ipywidgets.HBox([self._bases, self._button("Add", "5.3em", self.do, session.add_base),
                                      self._button("Remove", "5.3em", self.do, session.remove_base)],
                                     layout={"width": "21em"}),
            "start": self._button("Frame around the exit points", "21em", self.do, session.frame_exits),
            "task": self._button("Make it a motion", "21em", self.do, session.make_motion)}

    def _file_part(self) -> Any:
        self._text = ipywidgets.Textarea(layout={"width": "21em", "height": "24em"})
        path = ipywidgets.Text(value="my_robot.yaml", description="path", layout={"width": "21em"},
                               style={"description_width": "3em"})
        upload = ipywidgets.FileUpload(accept=".yaml,.yml", multiple=False, description="Upload",
                                       layout={"width": "7.5em"})
        upload.observe(lambda _: self._uploaded(upload), names="value")
        apply = self._button("Apply this text", "21em", lambda: self.do(self.session.read, self._text.value))
        buttons = [self._button("Save", "6em", lambda: self.save(path.value)),
                   self._button("Load", "6em", lambda: self.load(path.value.strip())), upload]
        return ipywidgets.VBox([self._text, apply, path, ipywidgets.HBox(buttons), self._download])

    def _flight_part(self) -> Any:
        wide = {"layout": {"width": "21em"}, "style": {"description_width": "9.5em"}}
        method = ipywidgets.Dropdown(options=[(name.replace("_", " "), name) for name in tension_methods()],
                                     value="quadratic_program", description="tensions by", **wide)
        kp, kd = (ipywidgets.BoundedFloatText(value=100.0, min=0.0, max=1e6, step=10.0, description=name, **wide)
                  for name in ("K_p [1/s²]", "K_d [1/s]"))
        words = ipywidgets.HTML("Computed torque flies the default task of the group “task”.")
        go = self._button("Simulate", "21em", lambda: self.simulate(method.value, kp.value, kd.value))
        return ipywidgets.VBox([words, method, kp, kd, go])

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

    def _walk(self, change: Any) -> None:
        self._azimuth = float(change["new"])
        self._draw()

    def _uploaded(self, upload: Any) -> None:
        if upload.value:
            file = upload.value[0]
            self.do(self.session.read, bytes(file["content"]).decode("utf-8", "replace"), file["name"])
            upload.value = ()  # the same file may be uploaded again


def robot_designer(world: World | str = _START, brief: Brief | None = None) -> RobotDesigner:
    """Edit a robot's world file field by field; picture, workspace slice, stiffness and warnings follow at once.

    world : World, or the name or path of one
    brief : judged with every edit too, if given
    A bad edit is named and changes nothing; everything can be undone. ``designer.world`` is the robot as it is.
    Raises WorldError for an unknown name, InvalidInput for anything else.

    >>> designer = robot_designer("planar_rigid")
    >>> designer.edit(("cables", 0, "exit_point", 1), 0.5)
    True
    >>> designer.undo(), designer.world.robot.n_cables
    (True, 4)
    """
    return RobotDesigner(load_world(world) if isinstance(world, str) else world, brief)


def _show_only(shown: list[Any], among: Any) -> None:
    for part in among:
        part.layout.display = None if part in shown else "none"
