"""Fields as widgets, row by row; what is typed is told, what the robot says is shown."""

from collections.abc import Callable
from typing import Any

import ipywidgets

from ...world import World
from ..shown import boxed, dismiss
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
        self.box = boxed([], "rows")
        self.entries: dict[tuple[str, str], Any] = {}
        self._fields: dict[tuple[str, str], Field] = {}
        self._kinds: list[Any] = []
        self._quiet = False

    def show(self, rows: list[Row], world: World) -> None:
        """Fill the form with the fields' values."""
        self._fields = {(row.label, field.label): field for row in rows for field in row.fields}
        kinds = [(key, field[2:]) for key, field in self._fields.items()]
        self._quiet = True
        if kinds != self._kinds:
            self._kinds = kinds
            for part in self.box.children:
                dismiss(part)
            self.entries = {key: self._entry(key) for key in self._fields}
            self.box.children = [_row(row, [self.entries[row.label, field.label] for field in row.fields])
                                 for row in rows]
        for key, entry in self.entries.items():
            entry.value = shown(self._fields[key], world)
            entry.remove_class(REFUSED)
        self._quiet = False

    def _entry(self, key: tuple[str, str]) -> Any:
        field = self._fields[key]
        nothing = LEFT_OUT.get(str(field.path[-1]), "")
        # Where there is no description the tooltip is the entry's name for a screen reader.
        look = {"description": field.label,
                "tooltip": f"{' '.join(key).strip()}{_in(field)}{_HELP.get(field.kind, '')}"}
        if field.kind == "choice":
            options = [(option or nothing, option) for option in field.options]
            entry: Any = ipywidgets.Dropdown(options=options, **look)
        else:
            entry = ipywidgets.Text(continuous_update=False, placeholder=nothing, **look)
        entry.observe(lambda change: self._changed(key, change["new"]), names="value")
        return entry

    def _changed(self, key: tuple[str, str], value: Any) -> None:
        if self._quiet:
            return
        field = self._fields[key]
        kind = str(field.path[0])
        whose = f"{kind[:-1]} {int(field.path[1]) + 1}: " if kind in ("cables", "bases") else ""
        if not self._typed(field, value, f"{whose}{' '.join(key).strip()}"):
            self.entries[key].add_class(REFUSED)


def _row(row: Row, entries: list[Any]) -> Any:
    """A label beside a single entry, above several."""
    label = ipywidgets.Label(f"{row.label}{_in(row.fields[0])}")
    return boxed([label, *entries], "row") if len(entries) == 1 else boxed([label, boxed(entries, "row")], "rows")


def _in(field: Field) -> str:
    return f" [{field.unit}]" if field.unit else ""
