"""Fields as widgets, row by row; what is typed is told, what the robot says is shown."""

from collections.abc import Callable
from typing import Any

import ipywidgets

from ...world import World
from ..shown import dismiss
from .fields import LEFT_OUT, Field, Row, shown

REFUSED = "cdprlab-refused"
"""Class of an entry whose value was not taken."""

_HELP = {"text": "; may be left empty", "points": "; x, y; x, y; …"}


class Form:
    """The widgets of some rows; `show` fills them, and makes new ones only where other kinds of fields come.

    typed : called with a field, what was typed or chosen, and the field's name on the screen;
        says whether it was taken
    entries : (row's label, field's label) → widget
    """

    def __init__(self, typed: Callable[[Field, Any, str], bool]) -> None:
        self._typed = typed
        self.box = ipywidgets.VBox([])
        self.entries: dict[tuple[str, str], Any] = {}
        self._fields: dict[tuple[str, str], Field] = {}
        self._kinds: list[Any] = []
        self._quiet = False

    def show(self, rows: list[Row], world: World) -> None:
        """Fill the form with the fields' values."""
        fields = {(row.label, field.label): field for row in rows for field in row.fields}
        kinds = [(key, field[2:]) for key, field in fields.items()]
        self._fields = fields
        self._quiet = True
        try:
            if kinds != self._kinds:
                self._kinds = kinds
                for part in self.box.children:
                    dismiss(part)
                self.entries = {}
                self.box.children = [self._row(row, world) for row in rows]
            for key, field in fields.items():
                self.entries[key].value = shown(field, world)
                self.entries[key].remove_class(REFUSED)
        finally:
            self._quiet = False

    def _row(self, row: Row, world: World) -> Any:
        beside = len(row.fields) == 1
        label = ipywidgets.Label(row.label + _in(row.fields[0]),
                                 layout={"width": "45%" if beside else "100%"})
        width = {1: "55%", 2: "50%", 3: "33.3%"}[len(row.fields)]
        entries = [self._entry(row, field, world, width) for field in row.fields]
        return ipywidgets.HBox([label, *entries]) if beside else ipywidgets.VBox([label, ipywidgets.HBox(entries)])

    def _entry(self, row: Row, field: Field, world: World, width: str) -> Any:
        # Where there is no description the tooltip is the entry's name for a screen reader.
        look: dict[str, Any] = {"description": field.label,
                                "layout": {"width": width, "min_width": "0"},
                                "style": {"description_width": "2.8em"
                                          if len(field.label) > 2 else "1.2em"},
                                "tooltip": f"{row.label} {field.label}".strip() + _in(field)
                                + _HELP.get(field.kind, "")}
        nothing = LEFT_OUT.get(str(field.path[-1]), "none")
        if field.kind == "choice":
            options = [(option or nothing, option) for option in field.options]
            entry: Any = ipywidgets.Dropdown(options=options, value=shown(field, world), **look)
        else:
            nothing = "" if field.kind == "number" else nothing
            entry = ipywidgets.Text(continuous_update=False, placeholder=nothing, **look)
        key = row.label, field.label
        self.entries[key] = entry
        entry.observe(lambda change, key=key: self._changed(key, change["new"]), names="value")
        return entry

    def _changed(self, key: tuple[str, str], value: Any) -> None:
        if self._quiet:
            return
        field, entry = self._fields[key], self.entries[key]
        kind = str(field.path[0])
        whose = f"{kind[:-1]} {int(field.path[1]) + 1}: " if kind in ("cables", "bases") else ""
        if not self._typed(field, value, whose + " ".join(key).strip()):
            entry.add_class(REFUSED)


def _in(field: Field) -> str:
    return f" [{field.unit}]" if field.unit else ""
