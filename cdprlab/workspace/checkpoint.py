"""Finished chunks of a sweep on disk, each under a name that only the very same question has."""

import pickle
import warnings
from contextlib import suppress
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import CannotWrite, InvalidInput
from ..robot import Robot
from ..robot.pose import Pose
from ..world.files import made_folder, replaced
from .criterion import Criterion, Judgement


class Checkpoint:
    """A folder of ``KEY.npz``, KEY a hash of robot, criterion and the chunk's poses: anything else is judged anew."""

    def __init__(self, folder: str | Path, robot: Robot, criterion: Criterion, margin: bool, chunk: int) -> None:
        self.folder = made_folder(folder)
        import hashlib  # here only: it takes a twentieth of the time of `import cdprlab`

        self._question = hashlib.sha256()
        _feed(self._question, (robot, criterion, margin, chunk))

    def load(self, poses: Pose) -> Judgement | None:
        """The chunk's judgement, if it is there and whole."""
        try:
            with self._path(poses).open("rb") as file, np.load(file) as stored:
                found = Judgement(stored["inside"], stored["margin"])
        except Exception:   # what numpy says of a damaged file depends on the damage
            return None
        kinds = found.inside.dtype.kind + found.margin.dtype.kind
        whole = kinds == "bf" and found.inside.shape == found.margin.shape == (len(poses),)
        return found if whole else None

    def save(self, poses: Pose, judgement: Judgement) -> None:
        """Keep the chunk; warns where that fails, and the sweep goes on."""
        path = self._path(poses)
        try:
            with replaced(path) as file:
                np.savez(file, inside=judgement.inside, margin=judgement.margin)
        except CannotWrite as error:
            if self.load(poses) is None:    # or somebody who shares the folder was quicker
                warnings.warn(f"part of a workspace is judged but not kept: {error}", stacklevel=2)
        for left in self.folder.glob(f"*{path.stem}*.part"):    # of who was killed while writing it
            with suppress(OSError):
                left.unlink()

    def _path(self, poses: Pose) -> Path:
        key = self._question.copy()
        _feed(key, (poses.position, poses.rotation))
        return self.folder / f"{key.hexdigest()[:32]}.npz"


def _feed(key: Any, value: Any) -> None:
    """Everything a value consists of, into the hash; what a dataclass has worked out for itself is left out."""
    key.update(type(value).__qualname__.encode())
    if isinstance(value, np.ndarray):
        key.update(f"{value.shape}{value.dtype}".encode() + np.ascontiguousarray(value).tobytes())
    elif is_dataclass(value):
        for field in fields(value):
            key.update(field.name.encode())
            _feed(key, getattr(value, field.name))
    elif isinstance(value, dict):
        _feed(key, sorted(value.items()))
    elif isinstance(value, list | tuple):
        key.update(str(len(value)).encode())
        for item in value:
            _feed(key, item)
    else:
        try:
            key.update(pickle.dumps(value))   # its repr may be an address, which another object gets next
        except Exception:
            raise InvalidInput("a checkpoint needs a criterion that can be pickled, "
                               f"got {type(value).__qualname__}") from None
