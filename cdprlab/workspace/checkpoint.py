"""Finished parts of long work on disk, each under a name that only the very same question has."""

import marshal
import pickle
import warnings
from contextlib import suppress
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import CannotWrite, InvalidInput, quoted
from ..world.files import made_folder, replaced
from .criterion import Criterion


class Checkpoint:
    """A folder of ``KEY.npz``, KEY a hash of cdprlab itself, of a question and of one of its parts.

    Anything else is answered anew.
    """

    def __init__(self, folder: str | Path, *question: Any) -> None:
        self.folder = made_folder(folder)
        sources = sorted(Path(__file__).parents[1].rglob("*.py"))
        self._question = _hashed([source.read_bytes() for source in sources], question)

    def load(self, *part: Any) -> dict[str, Any] | None:
        """The arrays of that part, if they are there, can be read and are what was kept under that name."""
        try:
            with self._path(part).open("rb") as file, np.load(file) as stored:
                arrays = dict(stored)
            return arrays if arrays.pop("seal") == _hashed(self._question, part, arrays) else None
        except Exception:   # what numpy says of a damaged file depends on the damage
            return None

    def save(self, *part: Any, **arrays: Any) -> None:
        """Keep the part's arrays; warns where that fails, and the work goes on."""
        path, arrays = self._path(part), {name: np.asarray(value) for name, value in arrays.items()}
        try:
            with replaced(path) as file:
                np.savez(file, seal=np.array(_hashed(self._question, part, arrays)), **arrays)
        except CannotWrite as error:
            if self.load(*part) is None:    # or somebody who shares the folder was quicker
                warnings.warn(f"part of the work is done but not kept: {error}", stacklevel=2)
        for left in self.folder.glob(f"*{path.stem}*.part"):    # of who was killed while writing it
            with suppress(OSError):
                left.unlink()

    def _path(self, part: tuple[Any, ...]) -> Path:
        return self.folder / f"{_hashed(self._question, part)[:32]}.npz"


def _hashed(*values: Any) -> str:
    from joblib import hash as digest

    try:
        told: str = digest(_told(values), "sha1")
    except pickle.PicklingError:   # a repr may be an address, which another object gets next
        raise InvalidInput("a checkpoint needs what can be pickled, "
                           f"got {quoted(values)}") from None
    return told


def _told(value: Any) -> Any:
    """Everything a value consists of; what a dataclass has worked out for itself is left out."""
    kind = type(value).__qualname__
    if isinstance(value, Criterion):
        kind += repr(marshal.dumps(getattr(value.judge, "__code__", None), 2))   # 2: the same bytes in every process
    if is_dataclass(value):
        value = {field.name: getattr(value, field.name) for field in fields(value) if field.init}
    if isinstance(value, dict):
        return kind, {key: _told(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return kind, [_told(item) for item in value]
    return kind, np.ascontiguousarray(value) if isinstance(value, np.ndarray) else value
