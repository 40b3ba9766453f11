"""The robot designer: fields, picture, slice, warnings and numbers on one page, in a notebook or by itself."""

from __future__ import annotations

import html
from base64 import b64encode
from collections.abc import Callable
from typing import Any

import ipywidgets

from ...tensions import tension_methods
from ...world import World, load_world, world_names
from ..brief import Brief
from .assessment import PLANES
from .design_picture import SIZE, DesignPicture
from .fields import GROUPS, rows
from .forms import Form, let_go
from .report import as_html, report, warnings_html
from .session import DesignSession, Flight
from .slice_drawing import in_words, slice_svg

_START = "caroca"
FILE, FLIGHT = "world file", "simulate"


class RobotDesigner:
    """Edit a robot and see at once what it is worth; see `robot_designer`.

    session : DesignSession, all that is not widgets
    text : warnings and numbers, as text
    picture : of the robot, PNG
    """

    def __init__(self, world: World, brief: Brief | None = None) -> None:
        self.session = DesignSession(world, brief)
        self.text, self.picture = "", b""
        self.player: Any = None
        self._azimuth = 25.0
        self._drawn: tuple[World, DesignPicture] | None = None
        self._make_widgets()
        self.refresh()

    @property
    def world(self) -> World:
        """The last good world, to be saved, run or drawn."""
        return self.session.world

    def edit(self, path: tuple[str | int, ...], value: Any) -> bool:
        """As typing it: another value at a place of the world file; says whether that is a robot.

        >>> import cdprlab as cl
        >>> designer = robot_designer(cl.load_world("caroca"))
        >>> designer.edit(("platform", "mass"), -1.0), designer.world.robot.mass
        (False, 150.0)
        """
        return self._after(self.session.edit(path, value))

    def undo(self) -> bool:
        """Before the last edit."""
        return self._after(self.session.undo())

    def redo(self) -> bool:
        """The edit undone last, again."""
        return self._after(self.session.redo())

    def load(self, name_or_path: str) -> bool:
        """Another world in place of this one; it can be undone."""
        return self._after(self.session.load(name_or_path))

    def save(self, path: str) -> bool:
        """Write the world file."""
        worked = self.session.save(path)
        self._after(worked, f"Saved as {path}." if worked else "")
        return worked

    def simulate(self, **flight: Any) -> Any:
        """The default task in the engine, played below; returns the Run, or None with the reason on the page.

        method, kp, kd : see `Flight`
        """
        self._say("Simulating …")
        run = self.session.simulate(Flight(**flight))
        if self.player is not None:
            self.player.close()
            self.player, self._below.children = None, ()
        if run is not None:
            from ..explorers.player import run_player

            self.player = run_player(run)
            table = "\n".join(f"{name:<32} {value}" for name, value in run.table().items())
            self._below.children = (ipywidgets.HTML(as_html(table)), self.player.widget)
        self._after(run is not None, "Simulated; played at the end of the page." if run is not None else "")
        return run

    def close(self) -> None:
        """Let go of everything; safe to call twice."""
        if self.player is not None:
            self.player.close()
        let_go(self.widget)

    # --- showing ----------------------------------------------------------------------------------------------
    def refresh(self) -> None:
        """Show the last good robot everywhere."""
        session, world = self.session, self.world
        self._show_group()
        self._draw()
        self._slice.value = slice_svg(world, session.assessment.slice)
        numbers, verdict = report(world, session.assessment), session.verdict
        judged = [] if verdict is None else [f"The brief is {'' if verdict.met else 'not '}met:", str(verdict), ""]
        self.text = "\n".join([*judged, *session.assessment.warnings, numbers])
        self._brief.value = as_html("\n".join(judged))
        self._warnings.value, self._numbers.value = warnings_html(session.assessment), as_html(numbers)
        for button, word, label in ((self._undo, "Undo", session.history.undo_label),
                                    (self._redo, "Redo", session.history.redo_label)):
            button.description, button.disabled = f"{word}: {label}" if label else word, not label
        self._planes.layout.display = "none" if world.robot.dimension == 2 else None
        self._eye.layout.display = self._planes.layout.display

    def _after(self, worked: bool, said: str = "") -> bool:
        self._say(said)
        if worked:
            self.refresh()
        else:
            self._message.value = (
                '<div role="alert" style="color: #A32A00; white-space: pre-wrap; line-height: 1.35">'
                f"<b>{html.escape(self.session.mistake)}</b>\nThe robot is the one before this edit.</div>")
        return worked

    def _say(self, words: str) -> None:
        self._message.value = f'<div role="status">{html.escape(words)}</div>' if words else ""

    def _draw(self) -> None:
        world, cable = self.world, self.session.place.cable
        if self._drawn is None or self._drawn[0] is not world:
            self._drawn = world, DesignPicture(world, cable, self._azimuth)
        self.picture = self._drawn[1].png(self._azimuth, cable)
        width, height = (round(100 * side) for side in SIZE)
        alt = html.escape(f"{world.title or world.name}: the robot at its start, cable {cable + 1} marked. "
                          + in_words(self.session.assessment.slice))
        self._image.value = (f'<img decoding="sync" width="{width}" height="{height}" style="max-width: 100%; '
                             f'height: auto" alt="{alt}" '
                             f'src="data:image/png;base64,{b64encode(self.picture).decode("ascii")}">')

    def _show_group(self) -> None:
        group, world, place = self._groups.value, self.world, self.session.place
        for name, box in self._parts.items():
            box.layout.display = None if name == group or (name == "form" and group in GROUPS) else "none"
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
        task = self.world.document.get("tasks", {}).get("default", {})
        for box, wanted in ((self._cable_tools, group == "cables"), (self._base_tools, group == "bases"),
                            (self._frame, group == "start"),
                            (self._motion, group == "task" and task.get("kind", "hold") == "hold")):
            box.layout.display = None if wanted else "none"

    # --- widgets ----------------------------------------------------------------------------------------------
    def _make_widgets(self) -> None:
        self._quiet = False
        self._image, self._slice, self._warnings, self._numbers, self._message, self._download, self._brief = (
            ipywidgets.HTML() for _ in range(7))
        self._groups = ipywidgets.ToggleButtons(options=[*GROUPS, FILE, FLIGHT], style={"button_width": "6.3em"},
                                                layout={"width": "21em"})
        self._groups.observe(lambda _: self._show_group(), names="value")
        self._form = Form(lambda field, entry: self._after(self.session.type(field, entry)))
        self._make_choices()
        self._make_views()
        self._parts = {"form": ipywidgets.VBox([self._cable_tools, self._base_tools, self._form.box, self._frame,
                                                self._motion]),
                       FILE: self._file_part(), FLIGHT: self._flight_part()}
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

    def _doing(self, work: Callable[[], bool]) -> Callable[[], bool]:
        return lambda: self._after(work())

    def _toolbar(self) -> Any:
        self._undo, self._redo = (_button(word, work, "auto") for word, work in (("Undo", self.undo),
                                                                                ("Redo", self.redo)))
        names = ipywidgets.Dropdown(options=world_names(), value=_START, description="World", layout={"width": "17em"},
                                    style={"description_width": "3.5em"})
        opens = _button("Open", lambda: self.load(names.value), "5em")
        return ipywidgets.HBox([names, opens, self._undo, self._redo], layout={"flex_flow": "row wrap"})

    def _make_choices(self) -> None:
        session = self.session
        self._cables, self._bases = (ipywidgets.Dropdown(description=word, layout={"width": "9.6em"},
                                                         style={"description_width": "2em"})
                                     for word in ("edit", "edit"))
        self._cables.observe(lambda change: self._turn(cable=change["new"]), names="value")
        self._bases.observe(lambda change: self._turn(base=change["new"]), names="value")
        self._cable_tools, self._base_tools = (
            ipywidgets.HBox([choice, *(_button(word, self._doing(work), "5.3em")
                                       for word, work in tools)], layout={"width": "21em"})
            for choice, tools in ((self._cables, (("Copy", session.add_cable), ("Remove", session.remove_cable))),
                                  (self._bases, (("Add", session.add_base), ("Remove", session.remove_base)))))
        self._frame = _button("Frame around the exit points", lambda: self._after(session.frame_exits()), "21em")
        self._motion = _button("Make it a motion", lambda: self._after(session.make_motion()), "21em")

    def _make_views(self) -> None:
        self._planes = ipywidgets.Dropdown(options=PLANES, description="Slice", layout={"width": "12em"},
                                           style={"description_width": "3.5em"})
        self._planes.observe(self._look, names="value")
        self._eye = ipywidgets.FloatSlider(
            value=self._azimuth, min=-180, max=180, step=5, description="seen from [deg]", readout_format=".0f",
            style={"description_width": "9.5em"}, layout={"width": "32em", "max_width": "100%"})
        self._eye.add_class("view-only")  # it changes the picture, no number
        self._eye.observe(self._walk, names="value")

    def _file_part(self) -> Any:
        self._text = ipywidgets.Textarea(layout={"width": "21em", "height": "24em"})
        path = ipywidgets.Text(value="my_robot.yaml", description="path", layout={"width": "21em"},
                               style={"description_width": "3em"})
        upload = ipywidgets.FileUpload(accept=".yaml,.yml", multiple=False, description="Upload",
                                       layout={"width": "7.5em"})
        upload.observe(lambda _: self._uploaded(upload), names="value")
        apply = _button("Apply this text", lambda: self._after(self.session.read(self._text.value)), "21em")
        buttons = [_button("Save", lambda: self.save(path.value), "6em"),
                   _button("Load", lambda: self.load(path.value.strip()), "6em"), upload]
        return ipywidgets.VBox([self._text, apply, path, ipywidgets.HBox(buttons), self._download])

    def _flight_part(self) -> Any:
        wide = {"layout": {"width": "21em"}, "style": {"description_width": "9.5em"}}
        method = ipywidgets.Dropdown(options=[(name.replace("_", " "), name) for name in tension_methods()],
                                     value="quadratic_program", description="tensions by", **wide)
        kp, kd = (ipywidgets.BoundedFloatText(value=100.0, min=0.0, max=1e6, step=10.0, description=name, **wide)
                  for name in ("K_p [1/s²]", "K_d [1/s]"))
        words = ipywidgets.HTML("Computed torque flies the default task of the group “task”.")
        go = _button("Simulate", lambda: self.simulate(method=method.value, kp=kp.value, kd=kd.value), "21em")
        return ipywidgets.VBox([words, method, kp, kd, go])

    # --- moves ------------------------------------------------------------------------------------------------
    def _turn(self, **where: int | None) -> None:
        """Another cable or base in the fields; nothing is edited."""
        if self._quiet or None in where.values():
            return
        self.session.turn_to(self.session.place._replace(**where))  # type: ignore[arg-type]
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
            text = bytes(file["content"]).decode("utf-8", "replace")
            self._after(self.session.read(text, file["name"]))
            upload.value = ()  # the same file may be uploaded again

    def _repr_mimebundle_(self, **options: Any) -> Any:
        words = {"text/plain": self.text}
        if self.widget.comm is None:  # closed
            return words
        bundle = self.widget._repr_mimebundle_(**options)
        data, *more = bundle if isinstance(bundle, tuple) else (bundle,)
        return ({**(data or {}), **words}, *more) if more else {**(data or {}), **words}


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


def _button(word: str, work: Callable[[], Any], width: str) -> Any:
    button = ipywidgets.Button(description=word, layout={"width": width})
    button.on_click(lambda _: work())
    return button
