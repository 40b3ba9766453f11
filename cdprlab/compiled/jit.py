"""Compiling: the one module that imports numba."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba

Function = TypeVar("Function", bound=Callable[..., Any])

# Fused multiply-adds, and divisions by zero that give inf: nothing that would let NaN or rounding pass.
_OPTIONS: dict[str, Any] = {"error_model": "numpy", "fastmath": {"contract"}}


def compiled(function: Function) -> Function:
    """Compiled on first use; kept on disk where a folder can be written, else compiled anew in each process."""
    try:
        return cast(Function, numba.njit(cache=True, **_OPTIONS)(function))
    except RuntimeError:   # numba found no folder for its cache
        return cast(Function, numba.njit(**_OPTIONS)(function))
