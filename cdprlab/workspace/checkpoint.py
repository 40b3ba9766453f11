"""Finished chunks of a sweep on disk, each under a name that only the very same question has."""

import hashlib
import os
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import InvalidInput, quoted
from ..robot import Robot
from ..robot.pose import Pose
from .criterion import Criterion, Judgement


class Checkpoint:
    """A folder of ``KEY.npz``, KEY a hash of robot, criterion and the chunk's poses: anything else is judged anew."""

    def __init__(self, folder: str | Path, robot: Robot, criterion: Criterion, margin: bool, chunk: int) -> None:
        self.folder = Path(folder)
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
        except (OSError, ValueError) as error:
            raise InvalidInput(f"checkpoint must be a folder, got {quoted(str(folder))}: {error}") from None
        self._question = hashlib.sha256()
        _feed(self._question, (robot, criterion, margin, chunk))

    def load(self, poses: Pose) -> Judgement | None:
        """The chunk's judgement, if it is there and whole."""
        path = self._path(poses)
        if not path.exists():
            return None
        with np.load(path) as stored:
            return Judgement(stored["inside"], stored["margin"])

    def save(self, poses: Pose, judgement: Judgement) -> None:
        """Written beside and moved into place: an interrupted write leaves nothing that looks finished."""
        path = self._path(poses)
        part = path.with_name(f"{path.stem}.{os.getpid()}.part")
        with part.open("wb") as file:
            np.savez(file, inside=judgement.inside, margin=judgement.margin)
        part.replace(path)

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
        key.update(repr(value).encode())
