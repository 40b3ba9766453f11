"""Where student code runs: no network, nobody else's processes, nothing to read but Python and the package."""

import os
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path

import matplotlib
from matplotlib import font_manager  # noqa: F401 (writes the list of fonts, which takes seconds, if there is none)

from ... import __version__
from ...errors import InvalidInput

PACKAGE = Path(__file__).parents[2]
IMAGE = os.environ.get("CDPRLAB_GRADING_IMAGE", "cdprlab-grading")
"""Of the container engine: `docker build --target grading -t cdprlab-grading .`"""
SIZE = 256 * 2**20
"""Of all files that student code may write [bytes]; they are gone with it."""

_ENVIRONMENT = """env -i PATH=/usr/bin:/bin HOME=/tmp TMPDIR=/tmp LANG=C.UTF-8 MPLBACKEND=Agg
    MPLCONFIGDIR=/tmp/matplotlib OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 PYTHONDONTWRITEBYTECODE=1 PYTHONHASHSEED=0"""
_OWN_FOLDER = f"--perms 1777 --size {SIZE} --tmpfs"
BUBBLEWRAP = f"""bwrap --unshare-pid --unshare-net --unshare-ipc --unshare-uts --unshare-cgroup-try --die-with-parent
    --new-session --cap-drop ALL --proc /proc --dev /dev --remount-ro /dev {_OWN_FOLDER} /tmp --perms 1777
    --dir /tmp/matplotlib --ro-bind-try /usr /usr --ro-bind-try /lib /lib --ro-bind-try /lib64 /lib64
    --ro-bind-try /bin /bin --ro-bind-try /etc/ld.so.cache /etc/ld.so.cache
    --ro-bind-try /etc/alternatives /etc/alternatives"""
# The worker itself becomes nobody, whom the limit of processes binds.
_AS_ROOT = "--cap-add CAP_SETUID --cap-add CAP_SETGID --setenv CDPRLAB_JAIL 1"
_AS_ANYBODY = "--unshare-user --uid 65534 --gid 65534"
# The image brings Python and the package, and ends by itself.
_CONTAINER = f"""run --rm --interactive --network none --read-only --cap-drop ALL --security-opt no-new-privileges
    --user 65534:65534 --memory 2g --pids-limit 64 --tmpfs /tmp:size={SIZE} {IMAGE}"""


def environment() -> list[str]:
    """A command's beginning: all that student code knows of its surroundings."""
    numba = [f"{name}={value}" for name, value in os.environ.items() if name.startswith("NUMBA_C")]
    return [*_ENVIRONMENT.split(), f"PYTHONPATH={PACKAGE.parent}", *numba]


def find_jail(trust: bool = False, secrets: Iterable[Path] = ()) -> tuple[str, list[str]]:
    """Name of the jail there is, and the command of a Python in it.

    trust : run without one if there is none
    secrets : folders that are empty in there, wherever they are
    Raises InvalidInput where there is none.
    """
    for name, command in {"bubblewrap": _bubblewrap(secrets), "docker": ["docker", *_CONTAINER.split()],
                          "podman": ["podman", *_CONTAINER.split()]}.items():
        if _works(command):
            return name, command
    if trust:
        return "none", [*environment(), sys.executable]
    raise InvalidInput("no jail for student code: install bubblewrap (apt install bubblewrap; unprivileged user "
                       "namespaces must be allowed), or docker or podman with this version's grading image; or say "
                       "--trust to run it as yourself, which can read and change all that you can")


def _bubblewrap(secrets: Iterable[Path]) -> list[str]:
    """Python in a namespace of its own."""
    words = [*environment(), *BUBBLEWRAP.split(), *(_AS_ANYBODY if os.getuid() else _AS_ROOT).split()]
    # Python, its packages, this package, the worlds: each where it is, as compiled code knows it by that.
    places = [Path(sys.base_prefix), Path(sys.prefix), PACKAGE, PACKAGE.parent / "worlds"]
    for place in dict.fromkeys(places):
        if place.is_dir() and not place.is_relative_to("/usr"):
            for parent in reversed(place.parents[:-1]):
                words += ["--perms", "0755", "--dir", str(parent)]
            words += ["--ro-bind", str(place), str(place)]
    compiled = [path for root in {PACKAGE, Path(os.environ.get("NUMBA_CACHE_DIR") or PACKAGE)}
                for path in root.rglob("*.nb[ic]")]
    for folder in {path.parent for path in compiled}:   # numba wants to write there, and gets one of its own
        words += [*_OWN_FOLDER.split(), str(folder)]
    for path in compiled:
        words += ["--ro-bind", str(path), str(path)]
    for fonts in Path(matplotlib.get_cachedir()).glob("fontlist-*.json"):
        words += ["--ro-bind", str(fonts), f"/tmp/matplotlib/{fonts.name}"]
    for secret in [PACKAGE / "course/answers/recorded", *map(Path.resolve, secrets)]:
        if secret.is_dir() and any(secret.is_relative_to(place) for place in [*places, Path("/usr")]):
            words += ["--tmpfs", str(secret)]
    return [*words, "--remount-ro", "/", "--chdir", "/tmp", sys.executable]


def _works(command: list[str]) -> bool:
    """Whether this version of the package can be imported in there."""
    try:
        said = subprocess.run([*command, "-c", "import cdprlab; print(cdprlab.__version__)"], capture_output=True,
                              timeout=60, text=True, stdin=subprocess.DEVNULL).stdout
    except (OSError, subprocess.TimeoutExpired):
        return False
    return said.strip() == __version__
