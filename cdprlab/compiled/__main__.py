"""`python -m cdprlab.compiled`: compiles this room, once, into the folder that keeps it; nobody waits for it later."""

from importlib import import_module
from pkgutil import iter_modules

import numpy as np

from ..arrays import plain
from . import CENTROID, __path__, jit
from .closest import closest
from .polygon import polygons


def compile_all() -> None:
    """Imports what is compiled as it is made, and calls the rest with the kinds of arrays that it is called with.

    The problem: 2 N on three cables along a line, one of which pulls the other way.
    """
    for module in iter_modules(__path__):
        if module.name != "__main__":
            import_module(f".{module.name}", __package__)
    jit.few = 0
    problem = [plain(np.array(part)) for part in ([[[1.0, 0.5, -1.0]]], [[-2.0]], [[0.0] * 3], [[1.0] * 3])]
    polygons(*problem, CENTROID)
    closest(*problem, 0.5, 1)


if __name__ == "__main__":
    compile_all()
    if not jit.COMPILES:
        print("numba is not installed: cdprlab's numerical core runs as plain Python")
