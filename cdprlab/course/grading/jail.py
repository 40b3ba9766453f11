"""Where student code runs: no network, nobody else's processes, nothing to read but Python and the package."""

from __future__ import annotations

import importlib.util
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

from ...errors import InvalidInput

PACKAGE = Path(__file__).parents[2]
WORKER = ["-m", f"{__package__}.worker"]
IMAGE = os.environ.get("CDPRLAB_GRADING_IMAGE", "cdprlab-grading")
"""Of the container engine: `docker build --target grading -t cdprlab-grading .`"""

SIZE = str(256 * 2**20)
"""Of all files that student code may write [bytes]; they are gone with it."""


def command(trust: bool = False) -> tuple[str, list[str]]:
    """Name of the jail there is, and the command of a worker in it.

    trust : run without one if there is none
    Raises InvalidInput where there is none.
    """
    for name, found in (("bubblewrap", _bubblewrap()), ("docker", _container("docker")),
                        ("podman", _container("podman"))):
        if shutil.which(found[0]) and _works(found):
            return name, [*found, *WORKER]
    if trust:
        return "none", [sys.executable, *WORKER]
    raise InvalidInput("no jail for student code: install bubblewrap (apt install bubblewrap; unprivileged user "
                       "namespaces must be allowed), or docker or podman with the grading image; or say --trust "
                       "to run it as yourself, which can read and change all that you can")


def environment() -> dict[str, str]:
    """All that student code knows of its surroundings."""
    return {"PATH": "/usr/bin:/bin", "HOME": "/tmp", "TMPDIR": "/tmp", "MPLBACKEND": "Agg", "LANG": "C.UTF-8",
            "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MPLCONFIGDIR": "/tmp/matplotlib",
            "PYTHONPATH": str(PACKAGE.parent), "PYTHONDONTWRITEBYTECODE": "1",
            "PYTHONHASHSEED": "0", "CDPRLAB_JAIL": "1",
            **{name: os.environ[name] for name in ("NUMBA_CACHE_DIR", "NUMBA_CPU_NAME") if name in os.environ}}


def _bubblewrap() -> list[str]:
    """Python in a namespace of its own."""
    words = ["bwrap", "--unshare-pid", "--unshare-net", "--unshare-ipc", "--unshare-uts", "--unshare-cgroup-try",
             "--die-with-parent", "--new-session", "--clearenv", "--cap-drop", "ALL"]
    if os.getuid() == 0:   # the worker itself becomes nobody, whom the limit of processes binds
        words += ["--cap-add", "CAP_SETUID", "--cap-add", "CAP_SETGID"]
    else:
        words += ["--unshare-user", "--uid", "65534", "--gid", "65534"]
    for name, value in environment().items():
        words += ["--setenv", name, value]
    words += ["--proc", "/proc", "--dev", "/dev", "--remount-ro", "/dev", "--perms", "1777", "--size", SIZE,
              "--tmpfs", "/tmp"]
    for system in ("/usr", "/lib", "/lib64", "/bin", "/etc/ld.so.cache", "/etc/alternatives"):
        words += ["--ro-bind-try", system, system]
    for place in _places():
        for parent in reversed(place.parents[:-1]):
            words += ["--perms", "0755", "--dir", str(parent)]
        words += ["--ro-bind", str(place), str(place)]
    for folder, files in _compiled().items():   # numba wants a folder it can write into, and gets one of its own
        words += ["--perms", "1777", "--size", SIZE, "--tmpfs", folder]
        for file in files:
            words += ["--ro-bind", file, file]
    words += ["--tmpfs", str(PACKAGE / "course" / "answers" / "recorded")]   # results of exercises
    fonts = _fonts()
    if fonts:
        words += ["--ro-bind", str(fonts), f"/tmp/matplotlib/{fonts.name}"]
    return [*words, "--remount-ro", "/", "--chdir", "/tmp", sys.executable]


def _container(engine: str) -> list[str]:
    """A container of the grading image, which brings Python and package itself."""
    words = [engine, "run", "--rm", "--interactive", "--network", "none", "--read-only", "--cap-drop", "ALL",
             "--security-opt", "no-new-privileges", "--user", "65534:65534", "--memory", "2g", "--pids-limit", "64",
             "--tmpfs", f"/tmp:size={SIZE}", "--workdir", "/tmp"]
    return [*words, "--entrypoint", "python", IMAGE]


def _places() -> Iterator[Path]:
    """Python, its packages, this package, the worlds: each where it is, as compiled code knows it by that."""
    worlds = PACKAGE.parent / "worlds"
    found = [Path(sys.base_prefix), Path(sys.prefix), PACKAGE, *([worlds] if worlds.is_dir() else [])]
    system = Path("/usr")
    for place in dict.fromkeys(found):
        if not place.is_relative_to(system):
            yield place


def _compiled() -> dict[str, list[str]]:
    kept: dict[str, list[str]] = {}
    for root in {PACKAGE, Path(os.environ.get("NUMBA_CACHE_DIR") or PACKAGE)}:
        for file in root.rglob("*.nb[ic]"):
            kept.setdefault(str(file.parent), []).append(str(file))
    return kept


def _fonts() -> Path | None:
    """matplotlib's list of fonts, which takes seconds to make."""
    if importlib.util.find_spec("matplotlib") is None:
        return None
    import matplotlib
    from matplotlib import font_manager  # noqa: F401 (writes the list if there is none)

    return next(iter(sorted(Path(matplotlib.get_cachedir()).glob("fontlist-*.json"))), None)


def _works(jail: list[str]) -> bool:
    try:
        tried = subprocess.run([*jail, "-c", "import numpy"], capture_output=True, timeout=60)
    except (OSError, subprocess.TimeoutExpired):
        return False
    return tried.returncode == 0
