"""Files written whole or not at all: beside what they replace, then moved into its place."""

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO

from ..errors import CannotWrite, InvalidInput, quoted, shortened

_ROOM = 65_536
"""Bytes that must be free where something is going to be written."""


@contextmanager
def replaced(path: str | Path) -> Iterator[IO[bytes]]:
    """An open file whose content takes the place of ``path`` once it is complete; until then the old one stays.

    Links are followed and permissions kept. What is no plain file (a pipe, /dev/null) is
    written to as it is.

    Raises CannotWrite. After any error the old file is as it was, and nothing lies beside it.

    >>> with replaced("/no/such/folder/log.csv") as file:
    ...     pass
    Traceback (most recent call last):
    ...
    cdprlab.errors.CannotWrite: cannot write /no/such/folder/log.csv: No such file or directory
    """
    target = Path(os.path.realpath(path))
    old = target.is_file()
    beside = old or not target.exists()
    # Cut, for with what is added it must be no longer than a file's name may be.
    part = target.with_name(f".{target.name[:40]}.{os.urandom(4).hex()}.part") if beside else target
    try:
        if old and not os.access(target, os.W_OK):
            raise PermissionError("it is write-protected")
        with part.open("wb") as file:
            yield file
        if old:
            part.chmod(target.stat().st_mode)
        if beside:
            part.replace(target)
    except OSError as error:
        raise CannotWrite(f"cannot write {path}: {error.strerror or error}") from error
    finally:
        if beside:
            with suppress(OSError):   # as a rule it has moved away
                part.unlink()


def write_text(path: str | Path, text: str) -> Path:
    """A text file in UTF-8, what is no letter there as its number; raises CannotWrite."""
    with replaced(path) as file:
        file.write(text.encode(errors="backslashreplace"))
    return Path(path)


def checked_path(path: str | Path, ending: str = "") -> Path:
    """The path of a file that is to be written.

    Raises InvalidInput for what is no path, another ending or a missing folder.
    """
    target = as_path(path)
    if not target.name.lower().endswith(ending):
        raise InvalidInput(f"the path must end in {ending}, got {target}")
    if not target.parent.is_dir():
        raise InvalidInput(f"cannot save {target}: there is no folder {target.parent}")
    return target


def made_folder(path: str | Path) -> Path:
    """The folder, made if it is missing; raises CannotWrite where nothing could be written into it.

    >>> made_folder("/dev/null")
    Traceback (most recent call last):
    ...
    cdprlab.errors.CannotWrite: cannot write to the folder /dev/null: something else has that name
    """
    import tempfile

    folder = as_path(path)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder) as probe:
            probe.write(bytes(_ROOM))
    except OSError as error:
        reason = "something else has that name" if isinstance(error, FileExistsError) else error.strerror
        raise CannotWrite(f"cannot write to the folder {shortened(str(path))}: {reason}") from error
    return folder


def as_path(path: str | Path) -> Path:
    """A path, checked: text that can name a file, of at most 255 bytes between its slashes.

    >>> as_path("")
    Traceback (most recent call last):
    ...
    cdprlab.errors.InvalidInput: a path must be text that can name a file, got ''
    """
    with suppress(TypeError, ValueError):   # a lone surrogate is the second
        name = os.fsencode(path)
        if name and b"\0" not in name and len(name) < 4096 and max(map(len, name.split(b"/"))) < 256:
            return Path(path)
    raise InvalidInput(f"a path must be text that can name a file, got {quoted(path)}")
