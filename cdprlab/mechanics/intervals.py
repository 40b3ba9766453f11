"""Interval arithmetic on whole arrays, rounded outward: after every operation both ends move one number out.

Whichever way the processor rounds, the true result of one operation lies between the neighbors
of the computed one. Only cosine and sine are not that exact: they are off by less than
``_TURN`` in every library of today.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import reduce
from operator import add
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array

_TURN = 1e-15
"""More than four units in the last place of cosines and sines near 1."""


@dataclass(frozen=True, eq=False)
class Intervals:
    """An array of intervals [lower, upper]; a plain number or array is exact.

    >>> third = Intervals(1.0, 1.0) * 0.1
    >>> bool(third.lower < 0.1 < third.upper)
    True
    """

    lower: Any
    upper: Any
    __array_ufunc__ = None   # numpy arrays on the left leave the operation to this class

    def __add__(self, other: Intervals | ArrayLike) -> Intervals:
        b = exact(other)
        return _outward(self.lower + b.lower, self.upper + b.upper)

    def __sub__(self, other: Intervals | ArrayLike) -> Intervals:
        b = exact(other)
        return _outward(self.lower - b.upper, self.upper - b.lower)

    def __mul__(self, other: Intervals | ArrayLike) -> Intervals:
        b = exact(other)
        products = [x * y for x in (self.lower, self.upper) for y in (b.lower, b.upper)]
        return _outward(np.minimum.reduce(products), np.maximum.reduce(products))

    def __truediv__(self, other: Intervals) -> Intervals:
        """Anything where the divisor holds zero."""
        zero = (other.lower <= 0) & (other.upper >= 0)
        with np.errstate(divide="ignore", invalid="ignore"):
            quotients = [x / y for x in (self.lower, self.upper) for y in (other.lower, other.upper)]
        return _outward(np.where(zero, -np.inf, np.minimum.reduce(quotients)),
                        np.where(zero, np.inf, np.maximum.reduce(quotients)))

    def __and__(self, other: Intervals) -> Intervals:
        """What is in both; its ends are crossed where nothing is."""
        return Intervals(np.maximum(self.lower, other.lower),
                         np.minimum(self.upper, other.upper))

    __radd__, __rmul__ = __add__, __mul__

    def __rsub__(self, other: ArrayLike) -> Intervals:
        return exact(other) - self

    def __getitem__(self, index: Any) -> Intervals:
        return Intervals(self.lower[index], self.upper[index])

    def square(self) -> Intervals:
        """x², which is never negative."""
        a, b = self.lower * self.lower, self.upper * self.upper
        least = np.where((self.lower <= 0) & (self.upper >= 0), 0.0, np.minimum(a, b))
        return _outward(least, np.maximum(a, b)) & _NOT_NEGATIVE

    def sqrt(self) -> Intervals:
        """Of what is not negative but by rounding."""
        return _outward(np.sqrt(np.maximum(self.lower, 0.0)), np.sqrt(self.upper)) & _NOT_NEGATIVE

    def cos(self) -> Intervals:
        """Peaks at even multiples of π, troughs at odd ones; one that is only nearly inside counts."""
        ends = np.cos(np.stack([self.lower, self.upper]))
        first, last = self.lower / (2 * np.pi), self.upper / (2 * np.pi)
        near = 1e-9 * (1 + np.abs(first) + np.abs(last))

        def holds(turns: float) -> Any:
            return np.floor(last - turns + near) >= np.ceil(first - turns - near)

        return Intervals(np.where(holds(0.5), -1.0, ends.min(axis=0) - _TURN),
                         np.where(holds(0.0), 1.0, ends.max(axis=0) + _TURN)) & Intervals(-1.0, 1.0)

    def sin(self) -> Intervals:
        """cos(x − π/2)."""
        return (self - Intervals(np.pi / 2, np.nextafter(np.pi / 2, 2))).cos()

    def total(self) -> Intervals:
        """Sum over the last axis, one by one."""
        return reduce(add, (self[..., i] for i in range(self.lower.shape[-1])))

    def times(self, matrix: Intervals | Array) -> Intervals:
        """(…, a) times (…, a, b): Σ x_i M_ij, (…, b)."""
        M = exact(matrix)
        return reduce(add, (self[..., i, None] * M[..., i, :] for i in range(self.lower.shape[-1])))

    @property
    def width(self) -> Array:
        """From end to end, negative where an interval is empty."""
        return np.asarray(self.upper - self.lower)

    @property
    def magnitude(self) -> Array:
        """Largest |x|."""
        return np.maximum(np.abs(self.lower), np.abs(self.upper))


_NOT_NEGATIVE = Intervals(0.0, np.inf)


def exact(value: Intervals | ArrayLike) -> Intervals:
    """Intervals without width."""
    if isinstance(value, Intervals):
        return value
    number = np.asarray(value, dtype=float)
    return Intervals(number, number)


def stack(parts: list[Intervals]) -> Intervals:
    """Side by side along a new last axis."""
    return Intervals(*(np.stack(np.broadcast_arrays(*ends), axis=-1)
                       for ends in zip(*((part.lower, part.upper) for part in parts))))


def _outward(lower: Any, upper: Any) -> Intervals:
    return Intervals(np.nextafter(lower, -np.inf), np.nextafter(upper, np.inf))
