"""How this room is compiled: by numba at first use, kept on disk; without numba its functions run as they stand."""

import sys
from collections.abc import Callable
from contextlib import suppress
from functools import wraps
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
# rounding pass. Inlined, as arrays passed on are counted: that took half of a short loop's time.
OPTIONS: dict[str, Any] = {"error_model": "numpy", "fastmath": {"contract"}, "forceinline": True}

HERE = Path(__file__).parent
SOURCES = sorted([*HERE.glob("*.py"), HERE.parent / "robot" / "pose.py"])
# What numba keeps of a function holds what it calls too, but follows changes of its own file
# only.
EDITION = sha256(b"".join(path.read_bytes() for path in SOURCES)).hexdigest()[:8]
# As many poses are asked as they stand, in half a millisecond each, before seconds go into compiling.
few = 100


def compiled(function: Callable[..., Any]) -> Any:
    """The part of others that it is: machine code for those that are compiled, plain Python for those that are not."""
    plain = quiet(function)
    if COMPILES:
        plain.machine = machine_code(function)
        plain._numba_type_ = plain.machine._numba_type_   # by this name numba takes it for its own
    return plain


def compiled_for_batches(function: Callable[..., Any]) -> Any:
    """A function of many poses, its first argument a row a pose: compiled where it was before, else for the first many.

    So nobody waits for the compiler to answer a few.
    """
    plain = quiet(function)
    if not COMPILES:
        return plain
    machine: Any = None
    asked = 0

    @wraps(function)
    def answer(*arguments: Any) -> Any:
        nonlocal machine, asked
        if machine is None:
            asked += len(arguments[0])
            code = machine_code(function)
            kept = Path(code.stats.cache_path or ".").glob(f"*{code.__qualname__}*.nbi")
            if asked <= few and not any(kept):
                return plain(*arguments)
            machine = code
        return machine(*arguments)

    return answer


def quiet(function: Callable[..., Any]) -> Any:
    """As it stands, divisions by zero as quiet as when compiled."""
    return np.errstate(divide="ignore", invalid="ignore")(function)


def machine_code(function: Callable[..., Any], signature: Any = None) -> Any:
    """The function as machine code, made at its first call and kept in the first folder that can be written.

    NUMBA_CACHE_DIR, else __pycache__ beside the file, else the user's own cache folder. Where
    none can, each process compiles anew, and says so.
    """
    name = function.__qualname__
    function.__qualname__ += f"-{EDITION}"   # part of the name of the kept file
    try:
        return numba.njit(signature, cache=True, **OPTIONS)(function)
    except RuntimeError:   # numba found no folder
        announcement.often = "at each start, as it finds no folder to keep it in: set NUMBA_CACHE_DIR to one"
        return numba.njit(signature, **OPTIONS)(function)
    finally:
        function.__qualname__ = name


def compiled_for(*axes: int | tuple[int], writes: tuple[int, ...] = ()) -> Callable[[Callable[..., Any]], Any]:
    """Compiled as it is made, once, for arrays of so many axes each whatever their layout; 0 is a number, (k,) are k.

    What many call from many places is compiled so: it takes slices and read-only arrays as they
    are.

    writes : as axes, of the arrays that follow those, which it writes into: new ones, row by
        row
    """
    if not COMPILES:
        return quiet
    types: Any = numba.types
    number = numba.float64
    kinds = [types.UniTuple(number, *n) if isinstance(n, tuple) else
             types.Array(number, n, "A", readonly=True) if n else number for n in axes]
    kinds += [types.Array(number, n, "C") for n in writes]
    return lambda function: machine_code(function, tuple(kinds))


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
                stream = sys.stdout if "ipykernel" in sys.modules else sys.stderr
                # A stream that is closed is no reason to end the work: it is None, or refuses.
                with suppress(AttributeError, OSError, ValueError):
                    stream.write(f"cdprlab compiles its numerical core, {self.often} …\n")
                    stream.flush()

        def on_end(self, event: Any) -> None:
            pass

    announcement: Any = Announcement()
    event.register("numba:compile", announcement)   # type: ignore[no-untyped-call]
