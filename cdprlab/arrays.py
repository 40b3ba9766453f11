"""The one gate for what comes from outside: arguments of the right kind; numbers float64, finite, shaped, read-only."""

import re
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache, wraps
from inspect import isfunction, signature
from itertools import chain, cycle, repeat
from math import hypot
from types import UnionType
from typing import Annotated, Any, Literal, TypeVar, Union, dataclass_transform, get_args, get_origin

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import InvalidInput, Location, needed_by, quoted

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Indices = NDArray[np.intp]
Progress = Callable[[int, int], Any]
"""Called now and then as (done, in all)."""

LARGEST = 1e30
"""No length, mass or force of a robot is beyond it, and products of several such numbers are still float64."""

Public = TypeVar("Public", bound=Callable[..., Any])
Kind = TypeVar("Kind", bound=type)

_FLOAT64 = np.dtype(np.float64)


def as_array(value: ArrayLike, name: str, shape: tuple[int | str, ...], unit: str = "",
             batch: bool = False, limit: float = LARGEST, *, minimum: float = -np.inf,
             positive: bool = False, location: Location = ()) -> Array:
    """A read-only float64 copy of ``value``, checked.

    shape : the trailing shape; an int must match, a letter stands for any length, an empty list for no rows
    batch : whether further axes may stand in front
    limit : of each number's size; inf where infinity is one
    minimum, positive : of each number
    Raises InvalidInput for anything that is no number, not finite or of another shape.

    >>> as_array([1, 2], "position", (2,), "m")
    array([1., 2.])
    """
    unit = f" [{unit}]" if unit else ""
    try:
        given = np.asarray(value.filled(np.nan) if isinstance(value, np.ma.MaskedArray) else value)
        if given.size and given.dtype.kind not in "iuf" and not (
                given.dtype.kind == "O" and all(isinstance(item, int | float) for item in given.flat)):
            raise TypeError   # text that reads as a number is still text, and True no length
        array = np.array(given, dtype=np.float64)
        if array.shape == (0,) and len(shape) > 1:
            array = array.reshape(0, *shape[1:])
    except (TypeError, ValueError, OverflowError):
        raise InvalidInput(f"{name} must be {_wanted(shape, unit)}, got {quoted(value)}", location) from None
    further = array.ndim - len(shape)
    if not 0 <= further <= 20 * batch or any(   # numpy broadcasts 32 axes
            isinstance(want, int) and have != want for have, want in zip(array.shape[further:], shape)):
        raise InvalidInput(f"{name} must be {_wanted(shape, unit)}, got {_shape_text(array)}", location)
    if not (np.abs(array) <= limit).all():   # nor is NaN
        raise InvalidInput(f"{name} must be {'no NaN' if limit == np.inf else f'finite and at most {limit:g}'}, "
                           f"got {quoted(value)}", location)
    least = 1 / LARGEST if positive else minimum
    if least > -np.inf and (smallest := array.min(initial=np.inf)) < least:
        words = "positive" if positive and smallest <= 0 else f"at least {least:g}"
        raise InvalidInput(f"{name} must be {words}{unit}, got {quoted(value)}", location)
    return frozen(array)


def as_answer(value: ArrayLike, name: str, size: int, unit: str, time: float) -> Array:
    """(size,) numbers that a callable of the caller's gave at a time [s]: `as_array`, at next to no cost if they are.

    >>> as_answer([1, 2], "push", 2, "N", 0.0)
    array([1., 2.])
    """
    if (type(value) is np.ndarray and value.dtype == _FLOAT64 and value.shape == (size,)
            and hypot(*value.tolist()) <= LARGEST):   # of a few numbers Python's is the quicker
        return value
    return as_array(value, f"{name} at t = {time:.4g} s", (size,), unit)


def as_batch(value: ArrayLike, name: str, shape: tuple[int | str, ...], unit: str = "") -> Array:
    """(…, *shape) as it stands where there is nothing to change, else `as_array`: a batch is much to copy.

    >>> W = np.eye(2)
    >>> as_batch(W, "wrench matrix W", ("n", "m")) is W
    True
    """
    if type(value) is np.ndarray and value.dtype == _FLOAT64 and 20 > value.ndim >= max(1, len(shape)):
        fits = not shape or isinstance(shape[-1], str) or value.shape[-1] == shape[-1]
        # A sum of squares that says nothing of its overflow; else something is not finite, or enormous.
        if fits and np.vdot(value, value) <= LARGEST:
            return value
    return as_array(value, name, shape, unit, batch=True)


def frozen(array: Array) -> Array:
    """The array itself, made read-only: what is stored or shared cannot be changed by accident."""
    try:
        array.setflags(write=False)
    except AttributeError:
        raise InvalidInput(f"an array is wanted here, got {quoted(array)}") from None
    return array


def lasting(kind: Kind) -> Kind:
    """A class whose arrays are read-only also after pickle, copy and joblib, and whose == of tuples is one bool.

    >>> from typing import NamedTuple
    >>> class Pair(NamedTuple):
    ...     a: Array
    >>> lasting(Pair)(np.zeros(2)) == Pair(np.zeros(2))
    True
    """
    methods: dict[str, Any] = {"__setstate__": _restore}
    if issubclass(kind, tuple):
        methods = {"__reduce__": _taken_apart, "__eq__": _equal, "__ne__": _unequal, "__hash__": None}
    for name, method in methods.items():
        setattr(kind, name, method)
    return kind


def _restore(self: Any, state: dict[str, Any]) -> None:
    vars(self).update(_all_frozen(state))


def _taken_apart(self: Any) -> tuple[Any, ...]:
    return _together, (type(self), tuple(self))


def _together(kind: Any, values: tuple[Any, ...]) -> Any:
    return kind(*_all_frozen(values))


def _all_frozen(value: Any) -> Any:
    """The value itself, each array in it made read-only."""
    if isinstance(value, np.ndarray):
        frozen(value)
    elif isinstance(value, Mapping | tuple | list):
        for item in value.values() if isinstance(value, Mapping) else value:
            _all_frozen(item)
    return value


def _equal(self: Any, other: Any) -> bool:
    return type(self) is type(other) and all(map(_same, self, other))


def _same(a: Any, b: Any) -> bool:
    if isinstance(a, Mapping) and isinstance(b, Mapping):
        return a.keys() == b.keys() and all(_same(a[key], b[key]) for key in a)
    return np.array_equal(a, b) if isinstance(a, np.ndarray) else bool(a == b)


def _unequal(self: Any, other: Any) -> bool:
    return not _equal(self, other)


@dataclass_transform(eq_default=False, frozen_default=True, field_specifiers=(field,))
def frozen_dataclass(kind: Kind) -> Kind:
    """A dataclass that cannot be changed: its arguments are `checked`, its arrays are `lasting`.

    >>> @frozen_dataclass
    ... class Load:
    ...     mass: Annotated[float, "[kg] > 0"]
    >>> Load(2).mass
    2.0
    """
    made: Any = dataclass(frozen=True, eq=False)(kind)
    return lasting(checked(made))


def plain(array: Any) -> Any:
    """Contiguous and read-only, a copy only where it must be: what is compiled is compiled for this kind of array."""
    return frozen(np.ascontiguousarray(array).view())


def common_batch(**shapes: tuple[int, ...]) -> tuple[int, ...]:
    """The batch shape that all broadcast to; raises InvalidInput naming them where there is none.

    >>> common_batch(positions=(4, 1), rotations=(3,))
    (4, 3)
    """
    try:
        return np.broadcast_shapes(*shapes.values())
    except ValueError:
        told = ", ".join(f"{name} {shape}" for name, shape in shapes.items())
        raise InvalidInput(f"batch shapes do not fit together: {told}") from None


def as_number(value: Any, name: str, unit: str = "", **bounds: Any) -> float:
    """A finite float; bounds and location as `as_array` takes them.

    >>> as_number(2, "mass", "kg", positive=True)
    2.0
    """
    return float(as_array(value, name, (), unit, **bounds))


def as_count(value: Any, name: str, minimum: int = 1, maximum: int = 1_000_000) -> int:
    """A whole number between two others.

    >>> as_count(3, "levels")
    3
    """
    if not _is(value, int) or not minimum <= value <= maximum:
        raise InvalidInput(f"{name} must be a whole number from {minimum} to {maximum}, got {quoted(value)}")
    return int(value)


def as_seed(value: Any) -> int:
    """What random numbers start from: a whole number that is not negative.

    >>> as_seed(0)
    0
    """
    return as_count(value, "seed", 0, 2**64)


def seeds(seed: int, count: int) -> list[int]:
    """Seeds of so many draws that have nothing to do with each other, from one."""
    return np.random.SeedSequence(as_seed(seed)).generate_state(count).tolist()


def data_frame(columns: Mapping[str, Any]) -> Any:
    """A pandas DataFrame of (N,) columns; raises MissingDependency where pandas is not installed."""
    with needed_by("to_frame"):
        import pandas
    return pandas.DataFrame(dict(columns))


def checked(public: Public) -> Public:
    """A public function, or all of a class, that refuses arguments of another kind than its annotations say.

    A number is neither text nor a truth value nor NaN. What is annotated with a shape, a unit or a bound as
    docstrings tell them, ``Annotated[ArrayLike, "(…, k, 2) [m] or inf"]`` or ``Annotated[float, "[kg] > 0"]``,
    becomes what `as_array` makes of it; other arrays are left to that, which the function asks itself.
    Raises InvalidInput.

    >>> @checked
    ... def half(x: float) -> float:
    ...     return x / 2
    >>> half(4)
    2.0
    """
    if isinstance(public, type):
        for name, method in list(vars(public).items()):
            bare = getattr(method, "__func__", method)   # of a class or static method
            if isfunction(bare) and (name == "__init__" or not name.startswith("_")):
                setattr(public, name, checked(bare) if bare is method else type(method)(checked(bare)))
        return public

    @cache
    def asked() -> tuple[dict[str, Any], dict[str, Any]]:
        """Kinds, told at the first call as they may stand further down, and what gates make of defaults."""
        said, names = public.__annotations__, public.__globals__
        parameters = signature(public).parameters
        kinds = {name: _evaluated(said.get(name, Any), names) for name in parameters}
        return kinds, {name: kinds[name](one.default, name) for name, one in parameters.items()
                       if isfunction(kinds[name]) and one.default is not one.empty}

    @wraps(public)
    def checking(*arguments: Any, **options: Any) -> Any:
        kinds, usual = asked()
        given = dict(zip(kinds, arguments)) | options
        gated = bool(usual)
        for name, value in given.items():
            kind = kinds.get(name, Any)
            if isfunction(kind):
                given[name], gated = kind(value, name), True
            elif not _is(value, kind):
                raise InvalidInput(f"{name} must be {_words(kind)}, got {quoted(value)}")
        if gated and len(given) == len(arguments) + len(options):   # else Python says what is one too many
            return public(**usual | given)
        return public(*arguments, **options)

    # For who asks what a function takes: kinds that a program can name. The gates stand in `inspect.signature`.
    checking.__annotations__ = {name: _GATES.sub(lambda told: told[1] or "str", said) if isinstance(said, str) else said
                                for name, said in public.__annotations__.items()}
    return checking  # type: ignore[return-value]


_GATES = re.compile(r"Annotated\[(.+?), '.*?'\]|Literal\[.*?\]")


def _evaluated(annotation: Any, names: dict[str, Any]) -> Any:
    """What an annotation stands for, its gate if it has one."""
    kind = eval(annotation, names) if isinstance(annotation, str) else annotation
    options = get_args(kind) if get_origin(kind) in (Union, UnionType) else (kind,)
    for one in options:
        if get_origin(one) is Annotated:
            return _gate(one, type(None) in options)
    return kind


def _gate(told: Any, optional: bool) -> Callable[[Any, str], Any]:
    """``(value, name) → value`` if it is of the shape, unit and bound that a text tells; its name is also its place."""
    kind, text = get_args(told)
    axes, unit, bound, unlimited = _TOLD.fullmatch(text).groups("")   # type: ignore[union-attr]
    shape = tuple(int(axis) if axis.isdigit() else axis for axis in re.findall(r"\w+", axes))

    def gate(value: Any, name: str) -> Any:
        if value is None and optional:
            return None
        array = as_array(value, name, shape, unit, "…" in axes, np.inf if unlimited else LARGEST, location=(name,),
                         positive=bound == ">", minimum=0.0 if bound else -np.inf)
        return float(array) if kind is float else array

    return gate


_TOLD = re.compile(r"(?:\(([^)]*)\))? ?(?:\[([^]]*)\])? ?(?:([>≥]) 0)?(?: ?(or inf))?")


def _is(value: Any, kind: Any) -> bool:
    """Whether a value is of the kind that an annotation says, as far as that can be told."""
    if type(value) is kind and kind is not float:
        return True
    if kind in (bool, int, float):
        return _is_number(value, kind)
    origin, inside = get_origin(kind), get_args(kind)
    if origin is None:
        return kind is Any or not isinstance(kind, type) or isinstance(value, kind)
    if origin in (Union, UnionType):
        if complex in inside:   # ArrayLike; whether they are numbers, and how many, `as_array` says
            return _is_regular(value)
        return any(_is(value, one) for one in inside)
    if origin is Literal:
        return isinstance(value, str) and value in inside
    if origin is np.ndarray or not isinstance(origin, type):   # since numpy 2.5 an array's kind is an alias
        return True
    if issubclass(origin, Mapping):
        return isinstance(value, Mapping) and all(map(_is, chain(*value.items()), cycle(inside)))
    if issubclass(origin, Iterable):
        return _are(value, origin, inside)
    return isinstance(value, origin)


def _are(values: Any, origin: type, inside: tuple[Any, ...]) -> bool:
    """Whether values are as many, and each of the kind, as the annotation of a tuple, list or the like says."""
    if isinstance(values, np.ndarray):
        values = values.tolist()
    if isinstance(values, str | bytes | Mapping):
        return False
    if not isinstance(values, Collection):   # what comes one by one can be looked at once only
        return isinstance(values, origin)
    exactly = origin is tuple and inside[-1] is not Ellipsis
    if exactly and len(values) != len(inside):
        return False
    return all(map(_is, values, inside if exactly else repeat(inside[0])))


def _is_regular(value: Any) -> bool:
    try:
        return np.ndim(value) >= 0
    except ValueError:   # rows of different lengths
        return False


def _is_number(value: Any, kind: type) -> bool:
    if isinstance(value, np.ndarray) and not value.ndim:
        value = value[()]
    if isinstance(value, bool | np.bool_):
        return kind is bool
    is_kind = isinstance(value, int | np.integer) or (kind is float and isinstance(value, float | np.floating))
    return kind is not bool and is_kind and -LARGEST <= value <= LARGEST


_WORDS: dict[Any, str] = {bool: "True or False", int: "a whole number", float: "a number (at most 1e30)",
                          str: "text", type(None): "None", Callable: "a function", tuple: "a tuple",
                          Sequence: "a list", Mapping: "a mapping"}


def _words(kind: Any) -> str:
    """An annotation as messages say it."""
    origin, inside = get_origin(kind), get_args(kind)
    if complex in inside:
        return "an array"
    if origin in (Union, UnionType):
        return " or ".join(map(_words, inside))
    if origin is Literal:
        return " or ".join(map(repr, inside))
    kind = origin or kind
    return _WORDS.get(kind) or f"a {getattr(kind, '__name__', kind)}"


def _wanted(shape: tuple[int | str, ...], unit: str) -> str:
    match shape:
        case ():
            words = "a number"
        case (str(),):
            words = "a list of numbers"
        case (count,):
            words = f"{count} numbers"
        case _:
            words = f"an array of shape ({', '.join(map(str, shape))})"
    return words + unit


def _shape_text(array: Array) -> str:
    if array.ndim == 0:
        return f"the single number {array:g}"
    return f"{array.shape[0]} numbers" if array.ndim == 1 else f"shape {array.shape}"
