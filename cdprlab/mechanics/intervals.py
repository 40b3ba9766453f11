"""codac's interval arithmetic, without what it does to everybody else's numbers.

Importing codac leaves the processor rounding upwards, and its operations count on finding it so. Left alone, all of
numpy would then round up as well: 2.4 − 0 becomes 2.4000000000000004, files are no longer saved as they were read.
Inside ``with outward() as codac:`` the processor rounds as codac wants it, outside to nearest as everywhere.
"""

from __future__ import annotations

import ctypes
import ctypes.util
import platform
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any

_NEAREST = 0  # the same number in every C library; upwards is not


@contextmanager
def outward() -> Iterator[Any]:
    """The codac module, with the rounding that makes its answers certain.

    >>> with outward() as codac:
    ...     third = codac.Interval(1) / codac.Interval(3)
    >>> third.lb() < third.ub(), 0.1 + 0.7 == 0.7999999999999999
    (True, True)
    """
    control = _control()
    before = control.fegetround()
    try:
        codac = _codac()
        control.fesetround(_upward())
        yield codac
    finally:
        control.fesetround(before)


def rounds_to_nearest() -> bool:
    """Whether numbers round as everybody expects."""
    return bool(_control().fegetround() == _NEAREST)


@cache
def _codac() -> Any:
    import codac

    return codac


@cache
def _control() -> Any:
    if sys.platform == "win32":
        return ctypes.CDLL("ucrtbase")
    return ctypes.CDLL(ctypes.util.find_library("m") or None)


@cache
def _upward() -> int:
    """FE_UPWARD of this C library."""
    if sys.platform == "win32":
        return 0x200
    return 0x400000 if platform.machine().lower() in ("arm64", "aarch64") else 0x800
