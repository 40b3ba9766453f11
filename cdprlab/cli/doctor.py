"""``python -m cdprlab doctor``: what works here, in which versions, and the one command that mends what does not."""

import argparse
import platform
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from importlib import import_module
from importlib.metadata import PackageNotFoundError, packages_distributions, version
from importlib.util import find_spec
from typing import NamedTuple

import numpy as np
from packaging.specifiers import SpecifierSet

from .. import __version__
from ..course.handing_out import lesson_files
from ..errors import CdprError, install_command, requirements
from ..run import run
from ..world import load_world, world_names

FLIGHTS = {"caroca": (4.676498e-6, 140.441366, 479.762462),
           "planar_rigid": (5.139618e-6, 5.0, 43.5905946)}
"""World → what its first tenth of a second comes to: largest tracking error [m], smallest and largest last tension [N].

In seven digits, of which six must agree: what another compiler rounds shows in the twelfth, a
gram more on the 150 kg of CAROCA, or cables as forces instead of constraints, in the sixth.
"""
AGREE = 1e-6


class Part(NamedTuple):
    """What can fail by itself: the modules it takes, and what tries it and says how it went."""

    name: str
    modules: tuple[str, ...]
    check: Callable[[], str] = str


class Finding(NamedTuple):
    """How a part was found: the versions of what it takes, what it says or what is wrong, and what mends that."""

    name: str
    versions: str
    said: str
    works: bool
    missing: tuple[str, ...] = ()
    remedy: str = ""


def diagnose(_: argparse.Namespace) -> int:
    """Exit 0 if all works, else 1."""
    print(f"cdprlab {__version__}, Python {platform.python_version()}, {platform.system()} "
          f"{platform.machine()}\n{sys.executable}")
    findings = []
    for found in map(examine, PARTS):
        findings.append(found)
        print(f"  {'works' if found.works else 'FAILS'}  {found.name:22} {found.versions}")
        if found.said:
            print(f"         {'':22} {found.said}")
    remedies = [found.remedy for found in findings if found.remedy]
    missing = [module for found in findings for module in found.missing]
    if missing:
        # The engine last: where this Python can have none, it takes an environment of its own.
        remedies.append(install_command(*sorted(missing, key="pybullet".__eq__)))
    for remedy in remedies:
        print(f"To mend it: {remedy}")
    broken = [found.name for found in findings if not found.works]
    print(f"Does not work: {', '.join(broken)}." if broken else "All works.")
    return int(bool(broken))


def examine(part: Part) -> Finding:
    """Whether a part is installed, in versions this release takes, and does what it should."""
    owners = {module: _owners(module) for module in part.modules}
    shown = ", ".join(" ".join(owner) for held in owners.values() for owner in held.items())
    finding = partial(Finding, part.name, shown)
    missing = tuple(module for module, held in owners.items() if not held)
    if missing:
        return finding(f"not installed: {', '.join(missing)}", False, missing)
    for module, held in owners.items():
        if len(held) > 1:   # their wheels own the same files
            return finding(f"{module} comes from two packages at once", False,
                           remedy=f"python -m pip uninstall --yes {' '.join(held)}, then cdprlab doctor again")
        for name, installed in held.items():
            asked = requirements().get(name.replace(".", "-"), ("", ""))[0]
            if installed and not SpecifierSet(asked).contains(installed, prereleases=True):
                return finding(f"{name} {installed} is not a version that this release knows", False,
                               remedy=f'python -m pip install "{name}{asked}"')
    try:
        said = part.check()   # first: an engine is imported so that it keeps quiet
        for module in part.modules:
            import_module(module)
        return finding(said, True)
    except (CdprError, ImportError, OSError) as error:
        return finding(str(error), False)


def _owners(module: str) -> dict[str, str]:
    """Packages that a module comes from → their versions; empty where there is none."""
    found: dict[str, str] = {}
    with suppress(ValueError, ModuleNotFoundError):   # blocked on purpose, or not even its parent is there
        if find_spec(module):
            found = dict.fromkeys(packages_distributions().get(module, [module]), "")
    for name in found:
        with suppress(PackageNotFoundError):
            found[name] = version(name)
    return found


# --- what is tried ------------------------------------------------------------------------------------
def _flight(name: str) -> str:
    """Fly a world for a tenth of a second, to the numbers above."""
    world = load_world(name)
    flown = run(world, duration=0.1)
    last = flown.measured_tensions[-1]
    found = (flown.position_errors.max(), last.min(), last.max())
    said = ", ".join(f"{value:.7g}" for value in found)
    if not np.allclose(found, FLIGHTS[name], rtol=AGREE, atol=0):
        raise CdprError(f"{name} comes to {said}, not {', '.join(f'{value:.7g}' for value in FLIGHTS[name])} "
                        "(largest error [m], last tensions [N]): an engine that computes something else")
    return f"{name} flown for 0.1 s, to the numbers on record ({found[1]:.1f} to {found[2]:.1f} N)"


def _compiled() -> str:
    """Compile what is not yet, so that nobody waits for it later."""
    from ..compiled import jit
    from ..compiled.__main__ import compile_all

    begin = time.perf_counter()
    compile_all()
    return f"ready in {time.perf_counter() - begin:.1f} s; compiled {jit.announcement.often}"


def _files() -> str:
    return f"{len(world_names())} worlds, {len(lesson_files())} lessons"


PARTS = (
    Part("numbers", ("numpy", "scipy", "quadprog", "joblib")),
    Part("worlds and lessons", ("pydantic", "ruamel.yaml"), _files),
    Part("compiled core", ("numba",), _compiled),
    Part("planar engine", ("pymunk",), partial(_flight, "planar_rigid")),
    Part("spatial engine", ("pybullet",), partial(_flight, "caroca")),
    Part("pictures and films", ("matplotlib", "PIL", "tqdm")),
    Part("notebooks", ("jupyterlab", "ipykernel")),
    Part("explorers", ("ipywidgets", "k3d")),
    Part("intervals (lesson 12)", ("codac",)),
)
