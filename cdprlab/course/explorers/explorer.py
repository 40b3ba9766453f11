"""The base of every explorer: a picture, sliders and numbers beside it, mistakes in plain sight.

A subclass says three things: ``build`` makes what stands still, ``draw`` adds or moves the
rest, ``numbers`` tells in text what the picture shows. Needs no kernel and no browser: `set`
moves the sliders, `text` and `picture` answer.
"""

import csv
import html
from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial, wraps
from itertools import chain
from pathlib import Path
from typing import Annotated, Any, NoReturn, TypeVar

import ipywidgets
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ...arrays import as_number, checked
from ...errors import CdprError, InvalidInput, quoted
from ...view.notebook import picture_tag
from ...view.picture import Picture
from ...view.style import house_style
from ..shown import Shown, boxed, style
from .since_start import with_changes

_DOTS_PER_INCH = 126
"""A picture 6.2 inch wide fills its column of 488 pixels at the least, and stays sharp in one of 780."""

Values = dict[str, Any]
"""Control name → its value, in the control's unit."""

Look = dict[str, Any]
"""Of a line or marks, as matplotlib's ``plot`` takes it."""

Answer = TypeVar("Answer")


def once_a_move(work_out: Callable[[Any, Values], Answer]) -> Callable[[Any, Values], Answer]:
    """A method of the values that `numbers`, `draw` and `describe` all ask: worked out for the first of them only."""
    key = f"_last_{work_out.__name__}"

    @wraps(work_out)
    def remembered(explorer: Any, values: Values) -> Answer:
        asked, answer = vars(explorer).get(key, (None, None))
        if asked != values:
            answer = work_out(explorer, values)
            vars(explorer)[key] = dict(values), answer
        return answer

    return remembered


@checked
@dataclass(frozen=True)
class Slider:
    """A number to be moved.

    name : its key in ``values``
    label, unit : what stands beside it, "label [unit]"
    low, high, start : range and first value, in that unit
    step : of one arrow key; default a hundredth of the range
    Raises InvalidInput unless low ≤ start ≤ high and low < high, all finite.

    >>> Slider("x", "x", "m", -1.0, 1.0, 0.25).caption
    'x [m]'
    """

    name: str
    label: str
    unit: str
    low: float
    high: float
    start: float
    step: Annotated[float, "> 0"] | None = None

    def __post_init__(self) -> None:
        if not (self.low < self.high and self.low <= self.start <= self.high):
            raise InvalidInput(f"slider {self.name!r} needs low < high and a start between, "
                               f"got {self.low:g} to {self.high:g}, start {self.start:g}")

    @property
    def caption(self) -> str:
        """Label with unit."""
        return f"{self.label} [{self.unit}]" if self.unit else self.label

    def check(self, value: Any) -> float:
        """The value as a number; raises InvalidInput outside the range."""
        number = as_number(value, self.name, self.unit)
        inside = min(max(number, self.low), self.high)
        # Rounding in a range's end must not refuse the end itself.
        if abs(number - inside) > 1e-9 * (self.high - self.low):
            raise InvalidInput(f"{self.name} must be between {self.low:g} and {self.high:g} {self.unit}".rstrip()
                               + f", got {quoted(value)}")
        return inside

    @property
    def stride(self) -> float:
        """Of an arrow key, and of the slider's marks."""
        return (self.high - self.low) / 100 if self.step is None else self.step

    def widgets(self) -> list[Any]:
        """A slider, which keys move too, and its number, to be typed over: taken as typed, between the marks too."""
        # On a mark: the browser would move it there, and that would count as a move.
        slider = ipywidgets.FloatSlider(value=self.nearest(self.start), min=self.low,
                                        max=self.high,
                                        step=self.stride, description=self.caption,
                                        readout=False)
        return [slider,
                ipywidgets.FloatText(value=float(f"{self.start:.12g}"), step=self.stride,
                                             tooltip=self.caption)]

    def nearest(self, value: float) -> float:
        """The slider's mark next to a value: where it stands without moving the value."""
        return min(self.low + round((value - self.low) / self.stride) * self.stride, self.high)


def sliders(explorer: str, **starts: float) -> list[Slider]:
    """Those that sliders.csv has for an explorer.

    starts : slider's name → its first value, where that is another
    """
    with Path(__file__).with_name("sliders.csv").open(encoding="utf-8", newline="") as file:
        rows: Any = csv.reader(file, quoting=csv.QUOTE_NONNUMERIC)
        return [Slider(name, label, unit, low, high, starts.get(name, start), step)
                for whose, name, label, unit, low, high, start, step in rows
                if whose == explorer]


@checked
@dataclass(frozen=True)
class Choice:
    """One of several options, such as a method or a cable.

    name : its key in ``values``
    label : what stands beside it
    options : the values, shown as text; the first is the start unless ``start`` says otherwise
    """

    name: str
    label: str
    options: Sequence[Hashable]
    start: Any = None

    @property
    def caption(self) -> str:
        """What stands beside it."""
        return self.label

    def check(self, value: Any) -> Any:
        """The value; raises InvalidInput naming the options if it is none of them."""
        if not isinstance(value, Hashable) or value not in self.options:
            raise InvalidInput(f"{self.name} must be one of {', '.join(map(str, self.options))}, got {quoted(value)}")
        return value

    def widgets(self) -> list[Any]:
        """A menu."""
        start = self.options[0] if self.start is None else self.check(self.start)
        options = [(str(option).replace("_", " "), option) for option in self.options]
        return [ipywidgets.Dropdown(options=options, value=start, description=self.label)]


def movable(axes: Axes, *fmt: str, **look: Any) -> Line2D:
    """A line or marks for `draw` to move by ``set_data``, without points as yet.

    fmt, look : as of matplotlib's ``plot``
    """
    line, = axes.plot([], [], *fmt, animated=True, **look)
    return line


@checked
class Explorer(Shown):
    """Sliders, a picture and numbers; in a notebook it shows itself.

    controls : Slider and Choice, in the order shown
    title : above the picture
    size : of the picture [inch]; 6.2 fill the width
    ``picture`` is the present one as PNG, ``values`` and ``text`` are what the controls and the numbers say.
    ``below`` says how many of the last blocks of numbers (blank lines part them) stand below
    the picture; all others stand below the controls. Further widgets go below the controls
    (``panel.children += (…,)``) or below the picture (``stage``).

    A move calls ``numbers`` and then ``draw``. A mistake in either is shown in red where the
    numbers are and raised again; the next move works as if nothing had happened. The start,
    to which ``reset`` goes back and from which changes are told, is what is first shown.

    >>> class Spring(Explorer):
    ...     def build(self, figure):
    ...         axes = figure.subplots()
    ...         axes.set(xlim=(0, 1), ylim=(0, 100), xlabel="extension [m]", ylabel="force [N]")
    ...         self.dot, = axes.plot([0], [0], "o", animated=True)
    ...     def numbers(self, values):
    ...         return {"force [N]": f"{100 * values['x']:.1f}"}
    ...     def draw(self, values):
    ...         self.dot.set_data([values["x"]], [100 * values["x"]])
    >>> spring = Spring([Slider("x", "extension", "m", 0.0, 1.0, 0.5)], title="A spring of 100 N/m")
    >>> spring.set(x=0.25)
    >>> spring.text
    'force [N]  25.0'
    """

    below = 0

    def __init__(self, controls: Sequence[Slider | Choice], title: str = "",
                 size: tuple[float, float] = (6.2, 5.2)) -> None:
        self.controls = {control.name: control for control in controls}
        if len(self.controls) < len(controls):
            raise InvalidInput("two controls have the same name: "
                               + ", ".join(control.name for control in controls))
        self.title = title
        self._callbacks: list[Callable[[Values], Any]] = []
        self._quiet = False
        self._make_widgets()
        figure = Figure(figsize=size, dpi=_DOTS_PER_INCH, layout="constrained")
        with house_style():
            self.build(figure)
        self._figure = Picture(figure)
        self._start_values, self._start_text, self._seen = self.values, "", False
        self.anew = True
        self._answer()
        self.anew = False

    # --- what a subclass says -------------------------------------------------------------------------
    def build(self, figure: Figure) -> None:
        """Make axes and artists, once. Artists made ``animated=True`` are redrawn alone, which is fastest."""
        raise NotImplementedError(f"{type(self).__name__} must say what its picture is made of: build(figure)")

    def numbers(self, values: Values) -> Mapping[str, Any] | str:
        """What the picture shows, in text: label with unit → number, or a table of several lines."""
        raise NotImplementedError(f"{type(self).__name__} must tell its numbers: numbers(values)")

    def draw(self, values: Values) -> None:
        """Move the artists that ``build`` made, or add others: they are gone before the next move."""
        raise NotImplementedError(f"{type(self).__name__} must move its picture: draw(values)")

    def idle(self, values: Values) -> Mapping[str, str]:
        """Controls that change nothing now, and why: they are grey, and the reason stands below them."""
        return {}

    def describe(self, values: Values) -> str:
        """One sentence for those who do not see the picture."""
        shown = ", ".join(f"{self.controls[name].caption} {_word(value)}" for name,
                          value in values.items())
        return f"{self.title or type(self).__name__} at {shown}; numbers beside it"

    # --- what everyone may use ------------------------------------------------------------------------
    @property
    def values(self) -> Values:
        """Control name → value now."""
        return {name: parts[-1].value for name, parts in self._parts.items()}

    def told(self, values: Values, *left_out: str) -> str:
        """The sliders' values as text, but for some: "x 0.5 m, yaw 30 deg"."""
        return ", ".join(f"{name} {values[name]:.4g} {control.unit}" for name,
                         control in self.controls.items()
                         if isinstance(control, Slider) and name not in left_out)

    def set(self, **values: Any) -> None:
        """Move some controls; one answer for all of them.

        Raises InvalidInput for an unknown name or a value out of range, and whatever the answer
        raises.
        """
        for name in values:
            if name not in self.controls:
                raise InvalidInput(f"there is no control {quoted(name)}; there are {', '.join(self.controls)}")
        self._put({name: self.controls[name].check(value) for name, value in values.items()})
        self._answer()

    def reset(self, **values: Any) -> None:
        """Back to the start, or to some values and else the start."""
        self.anew = True
        self.set(**self._start_values | values)
        self.anew = False

    @contextmanager
    def steady(self, *panels: Axes) -> Iterator[None]:
        """While they are drawn: panels keep their limits, and so their ticks, where these hold the new ones amply."""
        before = [(panel.get_xlim(), panel.get_ylim()) for panel in panels]
        yield
        for panel, kept in zip(panels, before):
            new = np.sort([panel.get_xlim(), panel.get_ylim()])
            low, high = np.sort(kept).T
            holds = (new.T.clip(low, high) == new.T).all() and (high - low <= 2.1 * np.ptp(new,
                                                                                           axis=1)).all()
            if holds and not self.anew:
                panel.set(xlim=kept[0], ylim=kept[1])

    def on_move(self, callback: Callable[[Values], Any]) -> Callable[[], None]:
        """Call ``callback(values)`` after every answer; returns what ends that."""
        self._callbacks.append(callback)

        def end() -> None:
            if callback in self._callbacks:
                self._callbacks.remove(callback)

        return end

    # --- inside ---------------------------------------------------------------------------------------
    def _make_widgets(self) -> None:
        self._parts = {name: control.widgets() for name, control in self.controls.items()}
        self.sliders = {name: parts[0] for name, parts in self._parts.items()}
        self.entries = {name: parts[1] for name, parts in self._parts.items() if len(parts) > 1}
        self.image, self._numbers, self._under, self._why, self.mistake = (ipywidgets.HTML()
                                                                           for _ in range(5))
        title = ipywidgets.HTML(f"{style()}<b>{html.escape(self.title)}</b>")
        back = ipywidgets.Button(description="Reset",
                                 tooltip="all controls as they were at the start")
        back.on_click(lambda _: self.reset())
        self.panel = boxed([*chain(*self._parts.values())], "controls")
        self.stage = boxed([self.image, self._under], "picture")
        beside = boxed([self.panel, self._why, self.mistake, self._numbers], "beside")
        self.widget = boxed([boxed([title, back], "head"),
                             boxed([self.stage, beside], "columns")])
        longest = max((len(control.caption) for control in self.controls.values()), default=0)
        for name, slider in self.sliders.items():
            slider.style.description_width = f"{0.5 * longest + 1:g}em"
            slider.observe(partial(self._moved, name), "value")
        for name, entry in self.entries.items():
            entry.observe(partial(self._typed, name), "value")

    def _put(self, values: Values) -> None:
        """Controls to checked values; nothing is answered."""
        self._quiet = True
        for name, value in values.items():
            control = self.controls[name]
            if isinstance(control, Slider):
                self.entries[name].value = value
                value = control.nearest(value)
            self.sliders[name].value = value
        self._quiet = False

    def _moved(self, name: str, change: Any) -> None:
        if self._quiet:
            return
        if name in self.entries:
            self._quiet = True
            self.entries[name].value = float(f"{change['new']:.10g}")   # 0.3, not 0.30000000000000004
            self._quiet = False
        self._answer()

    def _typed(self, name: str, change: Any) -> None:
        if self._quiet:
            return
        try:
            self._put({name: self.controls[name].check(change["new"])})
        except InvalidInput as error:
            self._put({name: change["old"]})
            self._tell(str(error))
        else:
            self._answer()

    def _repr_mimebundle_(self, **options: Any) -> Any:
        if not self._seen:
            self._seen, self._start_values = True, self.values
            if not self.mistake.value:
                self.reset()   # the picture that later resets lead back to
            self._start_text = self.text
            self._show_numbers()
        return super()._repr_mimebundle_(**options)

    def _show_numbers(self) -> None:
        """Text in two places, with changes since the start."""
        told = with_changes(self.text, self._start_text or self.text).split("\n\n")
        cut = len(told) - self.below
        for place, blocks in ((self._numbers, told[:cut]), (self._under, told[cut:])):
            place.value = "<pre>" + "\n\n".join(blocks) + "</pre>" if blocks else ""

    def _show_idle(self, values: Values) -> None:
        reasons = self.idle(values)
        for name, parts in self._parts.items():
            for part in parts:
                part.disabled = name in reasons
        told = "<br>".join(f"{html.escape(self.controls[name].label)}: {html.escape(why)}"
                           for name, why in reasons.items())
        self._why.value = f'<div class="cdprlab-why">Grey: {told}</div>' if told else ""

    def _answer(self) -> None:
        values = self.values
        try:
            text = as_text(self.numbers(values))
            with house_style():
                self._figure.redraw(lambda: self.draw(values))
                picture = self._figure.png()
            alt_text = str(self.describe(values))
        except Exception as error:
            self.show_mistake(error)
        self.text = text
        self._show_numbers()
        self._show_idle(values)
        self.picture, self.alt_text = picture, alt_text
        self.image.value = picture_tag(picture, alt_text)
        self.mistake.value = ""
        for callback in tuple(self._callbacks):
            try:
                callback(values)
            except Exception as error:
                self.show_mistake(error)

    def show_mistake(self, error: Exception) -> NoReturn:
        """Readable in the widget, where a notebook would hide it in its log, and raised again for whoever called."""
        kind = "" if isinstance(error, CdprError) else f"{type(error).__name__}: "
        self.text = f"{kind}{error}"
        self._tell(f"{self.text}\nThe picture is the one before this move; mend the function it calls, or move on.")
        raise error

    def _tell(self, mistake: str) -> None:
        self.mistake.value = f'<div role="alert">{html.escape(mistake)}</div>'


def legend_below(figure: Figure, looks: Mapping[str, Look]) -> None:
    """What lines and marks mean, two a row below the picture."""
    handles = [Line2D([], [], label=meaning, **look) for meaning, look in looks.items()]
    figure.legend(handles=handles, loc="outside lower center", ncols=2, fontsize=9)


def rounded_up(value: float, digits: int) -> float:
    """The next number of so many digits.

    >>> rounded_up(123.0, 2)
    130.0
    """
    unit = 10.0 ** np.floor(np.log10(value) - digits + 1)
    return float(np.ceil(value / unit - 1e-9) * unit)


def as_text(numbers: Mapping[str, Any] | str) -> str:
    """Numbers as aligned text: short values beside their labels, tables below theirs.

    >>> print(as_text({"mass [kg]": 12.0, "point": "A"}))
    mass [kg]  12
    point      A
    """
    if isinstance(numbers, str):
        return numbers
    shown = {label: _word(value) for label, value in numbers.items()}
    width = max((len(label) for label, value in shown.items() if "\n" not in value), default=0)
    return "\n".join(f"\n{label}\n{value}" if "\n" in value else f"{label:<{width}}  {value}"
                     for label, value in shown.items()).strip("\n")


def _word(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)
