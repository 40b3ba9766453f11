"""How this room is compiled: by numba at first use, kept on disk; without numba its functions run as they stand."""

import sys
from collections.abc import Callable
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np

try:
    import numba
    from numba.core import event
    COMPILES = True
except ImportError:   # every function of this room then is what it reads as, some hundred times slower
    COMPILES = False

# Fused multiply-adds, and divisions by zero that give inf: nothing that would let NaN or
# rounding pass.
OPTIONS: dict[str, Any] = {"error_model": "numpy", "fastmath": {"contract"}}

HERE = Path(__file__).parent
SOURCES = sorted([*HERE.glob("*.py"), HERE.parent / "robot" / "pose.py"])
# What numba keeps of a function holds what it calls too, but follows changes of its own file
# only.
EDITION = sha256(b"".join(path.read_bytes() for path in SOURCES)).hexdigest()[:8]


def compiled(function: Callable[..., Any], signature: Any = None) -> Any:
    """The function as machine code, made at its first call and kept in the first folder that can be written.

    NUMBA_CACHE_DIR, else __pycache__ beside the file, else the user's own cache folder. Where
    none can, each process compiles anew, and says so.
    """
    if not COMPILES:   # divisions by zero as quietly as when compiled
        return np.errstate(divide="ignore", invalid="ignore")(function)
    name = function.__qualname__
    function.__qualname__ += f"-{EDITION}"   # part of the name of the kept file
    try:
        return numba.njit(signature, cache=True, **OPTIONS)(function)
    except RuntimeError:   # numba found no folder
        announcement.often = "at each start, as it finds no folder to keep it in: set NUMBA_CACHE_DIR to one"
        return numba.njit(signature, **OPTIONS)(function)
    finally:
        function.__qualname__ = name


def compiled_for(*axes: int, writes: tuple[int, ...] = ()) -> Callable[[Callable[..., Any]], Any]:
    """Compiled as it is made, once, for arrays of so many axes each whatever their layout; 0 is a number.

    What many call from many places is compiled so: it takes slices and read-only arrays as they
    are.

    writes : as axes, of the arrays that follow those, which it writes into: new ones, row by
        row
    """
    if not COMPILES:
        return compiled
    kinds = [numba.types.Array(numba.float64, n, "A", readonly=True) if n else numba.float64
             for n in axes]
    kinds += [numba.types.Array(numba.float64, n, "C") for n in writes]
    return lambda function: compiled(function, tuple(kinds))


if COMPILES:
    class Announcement(event.Listener):
        """One line before the first function of this room is compiled, for whoever waits.

        On the error stream, but in a notebook on the other: there an error stream costs a
        graded cell its points.
        """

        often, said = "once", False

        def on_start(self, event: Any) -> None:
            if not self.said and event.data["dispatcher"].py_func.__module__.startswith(f"{__package__}."):
                self.said = True
                print(f"cdprlab compiles its numerical core, {self.often} …", flush=True,
                      file=sys.stdout if "ipykernel" in sys.modules else sys.stderr)

        def on_end(self, event: Any) -> None:
            pass

    announcement: Any = Announcement()
    event.register("numba:compile", announcement)   # type: ignore[no-untyped-call]
