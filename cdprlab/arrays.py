"""The one gate for numbers from outside: float64, finite, of the right shape, read-only."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import InvalidInput, Location

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Indices = NDArray[np.intp]


def as_array(value: ArrayLike, name: str, shape: tuple[int | str, ...], unit: str = "", *,
             batch: bool = False, location: Location = ()) -> Array:
    """A read-only float64 copy of ``value``, checked.

    shape : the trailing shape; an int must match, a letter stands for any length
    batch : whether further axes may stand in front
    Raises InvalidInput for anything that is no number, not finite or of another shape.

    >>> as_array([1, 2], "position", (2,), "m")
    array([1., 2.])
    """
    try:
        given = np.asarray(value)
        if given.dtype.kind not in "iuf":   # text that reads as a number is still text, and True no length
            given = _numbers_only(given)
        array = np.array(given, dtype=np.float64)
    except (TypeError, ValueError):
        raise InvalidInput(f"{name} must be {_wanted(shape, unit)}, got {value!r}", location) from None
    if not _fits(array.shape, shape, batch):
        raise InvalidInput(f"{name} must be {_wanted(shape, unit)}, got {_shape_text(array)}", location)
    if not np.isfinite(array).all():
        raise InvalidInput(f"{name} must be finite, got {value!r}", location)
    return frozen(array)


def frozen(array: Array) -> Array:
    """The array itself, made read-only: what is stored or shared cannot be changed by accident."""
    array.setflags(write=False)
    return array


def plain(array: Any) -> Any:
    """Contiguous and read-only, a copy only where it must be: what is compiled is compiled for this kind of array."""
    return frozen(np.ascontiguousarray(array).view())


def common_batch(name: str, batch: tuple[int, ...], other: str, other_batch: tuple[int, ...]) -> tuple[int, ...]:
    """The shape both broadcast to; raises InvalidInput naming both where there is none.

    >>> common_batch("positions", (4, 1), "rotations", (3,))
    (4, 3)
    """
    try:
        return np.broadcast_shapes(batch, other_batch)
    except ValueError:
        raise InvalidInput(f"{name} of batch shape {batch} and {other} of batch shape {other_batch} "
                           "do not fit together") from None


def as_number(value: Any, name: str, unit: str = "", *, minimum: float | None = None,
              positive: bool = False, location: Location = ()) -> float:
    """A finite float, optionally positive or at least ``minimum``.

    >>> as_number(2, "mass", "kg", positive=True)
    2.0
    """
    number = float(as_array(value, name, (), unit, location=location))
    if positive and number <= 0:
        raise InvalidInput(f"{name} must be positive{_in(unit)}, got {number:g}", location)
    if minimum is not None and number < minimum:
        raise InvalidInput(f"{name} must be at least {minimum:g}{_in(unit)}, got {number:g}", location)
    return number


def _numbers_only(given: Array) -> Array:
    """Raises TypeError unless it is empty or holds Python numbers (object arrays of a mixture do)."""
    if given.size and not (given.dtype.kind == "O"
                           and all(isinstance(item, int | float) for item in given.flat)):
        raise TypeError
    return given


def _fits(given: tuple[int, ...], wanted: tuple[int | str, ...], batch: bool) -> bool:
    if len(given) < len(wanted) or (len(given) > len(wanted) and not batch):
        return False
    tail = given[len(given) - len(wanted):]
    return all(isinstance(want, str) or have == want for have, want in zip(tail, wanted))


def _in(unit: str) -> str:
    return f" [{unit}]" if unit else ""


def _wanted(shape: tuple[int | str, ...], unit: str) -> str:
    if not shape:
        return f"a number{_in(unit)}"
    if len(shape) == 1 and isinstance(shape[0], str):
        return f"a list of numbers{_in(unit)}"
    if len(shape) == 1:
        return f"{shape[0]} numbers{_in(unit)}"
    return f"an array of shape ({', '.join(map(str, shape))}){_in(unit)}"


def _shape_text(array: Array) -> str:
    if array.ndim == 0:
        return f"the single number {array:g}"
    return f"{array.shape[0]} numbers" if array.ndim == 1 else f"shape {array.shape}"
