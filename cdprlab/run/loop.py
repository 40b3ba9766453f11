"""The closed loop, step by step: with tensions from a controller, or with winches."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping
from struct import Struct
from typing import Any

import numpy as np

from ..arrays import Array, frozen
from ..mechanics.cables import cable_lengths
from ..mechanics.statics import wrench_matrix
from ..mechanics.trajectory import Reference
from ..robot import Robot
from ..robot.pose import Pose, rotation_vector
from ..simulate import Simulator
from ..world import World
from .controllers import Controller
from .distributor import Distributor
from .drive import Drive
from .record import Run

Progress = Callable[[int, int], Any]
"""``(steps done, steps in all)``, called about a hundred times in a run."""


class Loop:
    """One closed loop and the table that it fills.

    controller : (t, state, reference) → wrench; distributor : its tensions; neither has a say where winches wind
    external_wrench : (n,), t → (n,) or None
    steps : of control, N
    cuts : step → cables cut as it begins
    drive : of mobile bases, None where none drives
    """

    def __init__(self, robot: Robot, controller: Controller, distributor: Distributor, external_wrench: Any, steps: int,
                 cuts: Mapping[int, list[int]], drive: Drive | None) -> None:
        self.robot, self.controller, self.distributor = robot, controller, distributor
        self.external_wrench, self.cuts, self.drive = external_wrench, cuts, drive
        d, m = robot.dimension, robot.n_cables
        self.widths = (d, d * d, 3 if d == 2 else 6, robot.n_dof, m, m, m)
        self.table = np.empty((steps, sum(self.widths)))
        self.feasible: Any = None
        self.commanded_lengths: Array | None = None

    def fly(self, engine: Simulator, reference: Reference, substeps: int, progress: Progress | None) -> float:
        """The loop itself; returns the elapsed time [s]."""
        self.reference = reference
        push = self.external_wrench
        if push is not None and not callable(push):
            engine.push(push)
        steps, table, concatenate = self.table.shape[0], self.table, np.concatenate
        every, distribute = max(1, steps // 100), self.distributor.tensions
        began = time.perf_counter()
        for k, wish in enumerate(map(Reference, *reference)):
            if self.drive is not None:
                self.drive.step(engine)
            if k in self.cuts:
                engine.cut(self.cuts[k])
                self.distributor.cut(self.cuts[k])
            state = engine.state()
            if callable(push):
                engine.push(push(state.time))
            wanted = np.asarray(self.controller(state.time, state, wish), dtype=np.float64)
            tensions = distribute(engine.wrench_matrix, wanted, state.time)
            lengths = engine.lengths
            engine.step(tensions, substeps)
            # One row of one table: kept as separate arrays, the log would push the loop out of the cache.
            concatenate((state.position, state.rotation.ravel(), state.twist, wanted, lengths, tensions,
                         engine.tensions), out=table[k])
            if progress is not None and ((k + 1) % every == 0 or k + 1 == steps):
                progress(k + 1, steps)
        return time.perf_counter() - began

    def wind(self, engine: Simulator, reference: Reference, ahead: Reference, substeps: int,
             progress: Progress | None) -> float:
        """The loop with winches: by each step's end, the lengths of where the platform should then be."""
        self.reference, push = reference, self.external_wrench
        if push is not None and not callable(push):
            engine.push(push)
        steps, period = self.table.shape[0], engine.dt * substeps
        sample, wind, every = engine.sample, engine.wind, max(1, steps // 100)
        began = time.perf_counter()
        start, m = list(sample()), self.robot.n_cables
        # Packed rows are the quickest log from Python numbers: lists and tuples would call the garbage collector.
        pack, log = Struct(f"{1 + m + len(start)}d").pack, []
        for k, lengths in enumerate(self._lengths(engine, ahead.pose)):
            if k in self.cuts:
                engine.cut(self.cuts[k])
            if callable(push):
                engine.push(push(k * period))
            log.append(pack(wind(lengths, substeps), *lengths, *sample()))
            if progress is not None and ((k + 1) % every == 0 or k + 1 == steps):
                progress(k + 1, steps)
        rows = np.frombuffer(b"".join(log)).reshape(steps, -1)
        elapsed = time.perf_counter() - began
        self.feasible, self.commanded_lengths = rows[:, 0] == 1, rows[:, 1:1 + m].copy()
        self._fill(np.vstack([start, rows[:, 1 + m:]]))
        return elapsed

    def _lengths(self, engine: Simulator, ahead: Pose) -> Iterator[list[float]]:
        """Rope lengths for each step's end; where bases drive, to where they will then stand."""
        if self.drive is None:
            return map(np.ndarray.tolist, cable_lengths(self.robot, ahead))
        return (cable_lengths(self.drive.step(engine), pose).tolist() for pose in ahead)

    def _fill(self, samples: Array) -> None:
        """The table from N + 1 samples: states as each step began, tensions as it ended, no wrench or tension asked."""
        m, states = self.robot.n_cables, sum(self.widths[:3])
        self.table[:] = np.nan
        self.table[:, :states] = samples[:-1, :states]
        self.table[:, states + self.widths[3]:][:, :m] = samples[:-1, states:states + m]
        self.table[:, -m:] = samples[1:, -m:]

    def log(self, world: World, task: str, method: str, cables: str, times: Array, factor: float, dt: float,
            period: float, settings: dict[str, Any]) -> Run:
        """The table as a Run."""
        columns = [frozen(np.ascontiguousarray(part))
                   for part in np.split(self.table, np.cumsum(self.widths)[:-1], axis=1)]
        positions, rotations, twists, wrenches, lengths, commanded, measured = columns
        d = world.robot.dimension
        poses = Pose.of(positions, rotations.reshape(-1, d, d))
        if self.feasible is None:
            W = wrench_matrix(world.robot, poses) if self.drive is None else np.array(self.drive.matrices)
            self.feasible = self.distributor.feasible(W, -wrenches, commanded, self.cuts)
        return Run(world, task, method, cables, frozen(times), poses, twists, self.reference, commanded, measured,
                   lengths, _errors(world.robot, poses, self.reference.pose), self.feasible, factor, dt, period,
                   settings, None if self.commanded_lengths is None else frozen(self.commanded_lengths),
                   None if self.drive is None else frozen(np.array(self.drive.poses)))


def _errors(robot: Robot, poses: Pose, wanted: Pose) -> Array:
    """(N, n) reference minus pose in the motion pattern's rows."""
    turn = rotation_vector(wanted.rotation @ np.swapaxes(poses.rotation, -1, -2))
    full = np.concatenate([wanted.position - poses.position, turn], axis=-1)
    return frozen((full[..., None, :] @ robot.pattern.basis(poses.rotation))[..., 0, :])
