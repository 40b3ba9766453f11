"""What can go wrong: each error says what was given, what is allowed and what to do."""

from __future__ import annotations

import copyreg
import os
import signal
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from importlib import import_module
from pathlib import Path
from reprlib import Repr
from typing import TYPE_CHECKING, Any, ClassVar

if TYPE_CHECKING:
    from numpy.typing import NDArray


def stop_at_once(*_: Any) -> None:
    """What Ctrl-C does as long as there is nothing to save: libraries that load would swallow an error, or show it."""
    os.write(2, b"cdprlab: stopped\n")
    os._exit(130)


if sys.argv[:1] == ["-m"] and "cdprlab" in sys.orig_argv:   # the command line loads
    signal.signal(signal.SIGINT, stop_at_once)


Location = tuple[str | int, ...]
"""Where in a world file a value stands, e.g. ``("cables", 2, "anchor_point")``; list indices from 0."""


_LONGEST = 200
"""Characters that a message quotes of what was given."""

_short = Repr()
_short.maxlist = _short.maxtuple = _short.maxdict = _short.maxset = 20
_short.maxlevel = 4
_short.maxlong = _short.maxstring = _short.maxother = _LONGEST


def quoted(value: Any) -> str:
    """What was given as Python writes it, on one line and in at most 200 characters, the middle or the end left out.

    >>> quoted("caroca"), len(quoted("x" * 5000))
    ("'caroca'", 200)
    """
    try:
        return shortened(_short.repr(value))
    except Exception:   # a repr of somebody else's, or an integer of more digits than Python prints
        return f"a {type(value).__name__}"


def shortened(text: str) -> str:
    """A text on one line and in at most 200 characters.

    >>> shortened("one\\n  two")
    'one two'
    """
    words = _one_line(text)
    return words if len(words) <= _LONGEST else words[:_LONGEST - 1] + "…"


def _one_line(text: str) -> str:
    return " ".join("".join(c if c.isprintable() else " " for c in text).split())


class CdprError(Exception):
    """Root of every error that cdprlab raises on purpose, told on one line; ``run`` is what it cut short, if a run.

    carries : names of what its kind is given after the message, and keeps
    """

    run: Any = None
    carries: ClassVar[tuple[str, ...]] = ()

    def __init__(self, message: str = "", *carried: Any) -> None:
        super().__init__(_one_line(message))
        vars(self).update(zip(self.carries, carried, strict=True))

    def __reduce__(self) -> tuple[Any, ...]:
        """What an error carries travels between processes, whatever its class asks for."""
        return copyreg.__newobj__, (type(self), *self.args), self.__dict__  # type: ignore[attr-defined]


class Recording:
    """Whatever ends early what is inside, Ctrl-C and errors of the caller's included, carries its record as ``run``.

    record : makes it of the reason, and of what a part of it has recorded, None: nothing
    """   # no context manager of contextlib's, which writes into errors that refuse to be written into

    def __init__(self, record: Callable[[str, Any], Any]) -> None:
        self.record = record

    def __enter__(self) -> None:
        pass

    def __exit__(self, _: Any, error: BaseException | None, __: Any) -> None:
        if error is not None:
            reason = f"{type(error).__name__}: {error}".removesuffix(": ")
            run = self.record(reason[:_LONGEST], getattr(error, "run", None))
            with suppress(AttributeError, TypeError):   # an error may refuse to carry more
                error.run = run   # type: ignore[attr-defined]


class CdprWarning(UserWarning):
    """Something that was asked for has no effect, or a result that is not to be trusted; given by `warnings.warn`."""


class InvalidInput(CdprError, ValueError):
    """A value that cannot be used; ``location`` names its place in a world, where it has one."""

    def __init__(self, message: str, location: Location = ()) -> None:
        super().__init__(message)
        self.location = location


@contextmanager
def under(*prefix: str | int) -> Iterator[None]:
    """What is InvalidInput inside is so from further up, too: its location starts with ``prefix``."""
    try:
        yield
    except InvalidInput as error:
        raise InvalidInput(str(error), (*prefix, *error.location)) from None


class WorldError(InvalidInput):
    """A world that cannot be used; ``problems`` holds every mistake found, one line each."""

    def __init__(self, problems: list[str]) -> None:
        more = len(problems) - 1
        also = f" (and {more} more {'mistake' if more == 1 else 'mistakes'})" if more else ""
        super().__init__(problems[0] + also)
        self.problems = tuple(map(_one_line, problems))


class CannotWrite(CdprError, OSError):
    """A file or folder that cannot be written; what was there before is whole."""


class NoConvergence(CdprError):
    """No pose fits the cable lengths; ``residuals`` holds what is left of each length [m]."""

    carries = ("residuals",)
    residuals: NDArray[Any]


class InfeasibleTensions(CdprError):
    """No usable tensions; ``distribution`` holds the method's last answer."""

    carries = ("distribution",)
    distribution: Any


class NotListable(CdprError):
    """A set whose vertices and facets cannot be written down: unbounded, or too many of them."""


class InfeasibleTwist(CdprError):
    """A platform twist beyond the speed limits; ``resolution`` holds the speeds and the largest feasible scale."""

    carries = ("resolution",)
    resolution: Any


class NoPlacement(CdprError):
    """No base poses were found that serve the wanted poses; ``robot`` stands as near to it as was found."""

    carries = ("robot",)
    robot: Any


class SimulationDiverged(CdprError):
    """The engine lost the robot at ``time`` [s]; ``cable`` (from 1) pulled hardest."""

    carries = ("time", "cable")
    time: float
    cable: int


class WinchOverrun(SimulationDiverged):
    """A load ran away with a winch: it turns the motor of ``cable`` faster than it can turn, at ``time`` [s]."""


class MissingDependency(CdprError, ImportError):
    """An optional package is needed here and not installed; the message names the command that mends it."""


@contextmanager
def needed_by(feature: str, otherwise: str = "") -> Iterator[None]:
    """A package that turns out to be missing inside costs this feature, and is said in one line.

    feature : what does not work now, as "pictures"; otherwise : what still does

    >>> with needed_by("lesson 99"):
    ...     import abacus
    Traceback (most recent call last):
    ...
    cdprlab.errors.MissingDependency: lesson 99 needs abacus, which is not installed; type: python -m pip install abacus
    """
    try:
        yield
    except ModuleNotFoundError as error:
        if isinstance(error, CdprError) or not error.name or error.name.startswith("cdprlab"):
            raise
        module = error.name.split(".")[0]
        still = f" ({otherwise})" if otherwise else ""
        raise MissingDependency(f"{feature} needs {module}, which is not installed; type: "
                                f"{install_command(module)}{still}") from None


def door(package: str, homes: Mapping[str, str]) -> Callable[[str], Any]:
    """A package's ``__getattr__``: what it hands on loads when first asked for.

    homes : name → its file, as seen from the package; a file that is called so itself is what is meant
    """
    def look_up(name: str) -> Any:
        if name not in homes:
            raise AttributeError(f"{package} has no {name!r}; it has {', '.join(sys.modules[package].__all__)}")
        with needed_by(f"{package}.{name}"):
            home = import_module(homes[name], package)
        return getattr(home, name, home)

    return look_up


def requirements(**machine: str) -> dict[str, tuple[str, str]]:
    """What this release asks for: package → the versions it may have, the extra that wants it ("": all do).

    machine : another one than this, as in ``python_version="3.13"``

    >>> requirements()["numpy"]
    ('<3,>=2.2', '')
    """
    from importlib.metadata import PackageNotFoundError, metadata

    from packaging.requirements import Requirement

    try:
        about = metadata("cdprlab")
    except PackageNotFoundError:   # a checkout that nobody installed
        return {}
    asked = [Requirement(line) for line in about.get_all("Requires-Dist", [])]
    wanted: dict[str, tuple[str, str]] = {}
    for extra in ("", *about.get_all("Provides-Extra", [])):
        for package in asked:
            if package.marker is None or package.marker.evaluate({"extra": extra, **machine}):
                wanted.setdefault(package.name, (str(package.specifier), extra))
    return wanted


def install_command(*modules: str) -> str:
    """The one command that brings modules to this Python on this machine.

    Where PyPI has no PyBullet for it, one that makes an environment which has.

    >>> install_command("codac", "PIL").removeprefix("conda install -c conda-forge")[-12:]
    'codac pillow'
    """
    names = [{"PIL": "pillow", "ruamel": "ruamel.yaml"}.get(module, module) for module in modules]
    if (Path(sys.prefix) / "conda-meta").is_dir():
        return f"conda install -c conda-forge {' '.join(names)}"
    wanted = requirements()
    if not wanted:
        return "python -m pip install -r requirements.txt"
    if "pybullet" in names:
        engine = [name for name in wanted if name.startswith("pybullet")]
        if not engine:
            return _another_python()
        names = engine + [name for name in names if name != "pybullet"]
    return f"python -m pip install {' '.join(names)}"


def _another_python() -> str:
    """An environment with PyBullet in it, where this Python can have none."""
    from shutil import which

    served = any(name.startswith("pybullet") for name in requirements(python_version="3.13"))
    if served and which("uv"):
        return "uv venv --python 3.13 --seed .venv, then install cdprlab there"
    return "conda create -n cdprlab -c conda-forge python=3.14 pybullet, then install cdprlab there"
