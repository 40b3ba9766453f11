"""The library's own functions, as later cells of a lesson call a student's: where results cannot be recorded."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ...arrays import Array
from ...compiled.columns import cables
from ...fastkit.mission.states import sure_of_being_at
from ...mechanics.trajectory import Reference
from ...run.controllers import ComputedTorque
from ...simulate.state import State
from ..props.point_load import lower_crossing


def _cable_vectors(exit_points: Array, anchor_points: Array, position: Array, rotation: Array) -> Array:
    lengths, W = cables(exit_points, anchor_points, np.asarray(position)[None], np.asarray(rotation)[None],
                           np.zeros((0, 4)))
    return lengths[0, :, None] * W[0, :exit_points.shape[1]].T


def _my_controller(t: float, state: State, reference: Reference, kp: float = 100.0, kd: float = 20.0) -> Array:
    return ComputedTorque(kp, kd)(t, state, reference)


LIBRARY: dict[str, tuple[Callable[..., Any], ...]] = {
    "01_cable-vectors": (_cable_vectors,),
    "03_circles": (lower_crossing,),
    "05_controller": (_my_controller,),
    "10_guard": (sure_of_being_at,),
}
"""Lesson and exercise → what stands in for its functions, in the order in which its cell defines them."""
