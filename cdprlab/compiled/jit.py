"""Compiling: the one module that imports numba."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba

Function = TypeVar("Function", bound=Callable[..., Any])

# Fused multiply-adds, and divisions by zero that give inf: nothing that would let NaN or rounding pass.
_OPTIONS: dict[str, Any] = {"error_model": "numpy", "fastmath": {"contract"}}


def compiled(function: Function, signature: Any = None) -> Function:
    """Compiled on first use; kept on disk where a folder can be written, else compiled anew in each process."""
    try:
        return cast(Function, numba.njit(signature, cache=True, **_OPTIONS)(function))
    except RuntimeError:   # numba found no folder for its cache
        return cast(Function, numba.njit(signature, **_OPTIONS)(function))


def compiled_for(*axes: int) -> Callable[[Function], Function]:
    """Compiled as it is made, once, for arrays of so many axes each whatever their layout; 0 is a number.

    What many call from many places is compiled so: it takes slices and read-only arrays as they are.
    """
    kinds = [numba.types.Array(numba.float64, n, "A", readonly=True) if n else numba.float64 for n in axes]
    return lambda function: compiled(function, tuple(kinds))
