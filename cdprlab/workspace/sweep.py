"""Many poses, judged chunk by chunk: over cores or a cluster, with progress, kept on disk if wanted."""

import signal
import threading
import warnings
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from ..arrays import Progress, as_count, checked
from ..errors import CdprWarning, InvalidInput, quoted
from ..mechanics.cables import have_directions, why_no_direction
from ..robot import Robot
from ..robot.pose import Pose
from .checkpoint import Checkpoint
from .criterion import Criterion, Judgement, judge_where_it_can_be, unknown
from .grids import PoseGrid

Answer = TypeVar("Answer")

Poses = Pose | PoseGrid
"""A batch of poses, or a grid that makes them when asked."""


@checked
def workspace(robot: Robot, poses: Poses, criterion: Criterion, *, margin: bool = True,
              n_jobs: int | None = None,
              chunk: int = 4096, checkpoint: str | Path | None = None, progress: Progress | None = None) -> Judgement:
    """Judge which poses belong to a workspace.

    robot : single robot
    poses : Pose of any batch shape, or a `PoseGrid`
    criterion : e.g. ``WrenchFeasible() & InterferenceFree(0.02)``
    margin : without it only verdicts are found, where that is quicker
    n_jobs : processes, −1 for all cores; by default one, or what ``joblib.parallel_config``
        says (Dask too)
    chunk : poses judged at a time; memory beyond poses and answers depends on it alone
    checkpoint : folder that keeps finished chunks; the same call goes on where an interrupted
        one stopped
    progress : called with (poses done, poses in all) after each chunk
    Returns Judgement ``(inside, margin)``, each of the poses' batch shape. Poses with an anchor
    point on its exit point are outside, and with a warning those where a cable cannot lie on
    its pulley.
    Raises InvalidInput for a criterion that does not fit the robot.

    >>> import cdprlab as cl
    >>> robot = cl.load_world("caroca").robot
    >>> workspace(robot, cl.Pose([[0, 0, 1], [0, 0, 3.6]]), cl.WrenchFeasible()).inside
    array([ True, False])
    """
    as_count(chunk, "chunk")
    shape, flat = _flattened(poses)
    count = len(flat)
    answer = unknown(np.zeros(count, dtype=bool))
    kept = Checkpoint(checkpoint, robot, criterion, margin, chunk) if checkpoint is not None else None
    lost, reason = 0, ""
    starts = range(0, count, chunk)
    calls = ((robot, flat[start:start + chunk], criterion, margin, kept) for start in starts)
    # The answers first: a generator of joblib's that is not asked to its end complains.
    for part, start in zip(over_cores(_part, calls, n_jobs), starts):
        answer.inside[start:start + chunk], answer.margin[start:start + chunk] = part
        if robot.pulleys.size:
            asked = flat[start:start + chunk]
            without = asked[~have_directions(robot, asked)]
            if len(without) and not lost:
                reason = f"at {without[0].position.tolist()} m {why_no_direction(robot, without[0])}"
            lost += len(without)
        if progress is not None:
            progress(min(start + chunk, count), count)
    if lost:
        warnings.warn(f"{lost} of {count} poses are outside because a cable cannot lie on its pulley: {reason}",
                      CdprWarning, stacklevel=3)
    return Judgement(answer.inside.reshape(shape), answer.margin.reshape(shape))


def _flattened(poses: Poses) -> tuple[tuple[int, ...], Poses]:
    if not isinstance(poses, Pose):
        return (len(poses),), poses
    d = poses.dimension
    return poses.batch_shape, Pose.of(poses.position.reshape(-1, d), poses.rotation.reshape(-1, d, d))


def _part(robot: Robot, poses: Pose, criterion: Criterion, margin: bool, kept: Checkpoint | None) -> Judgement:
    """A chunk's judgement: that kept on disk, else a new one, which is then kept."""
    where = poses.position, poses.rotation
    if kept and (known := kept.load(*where)):
        return Judgement(**known)
    found = judge_where_it_can_be(robot, poses, criterion, margin)
    if kept:
        kept.save(*where, **found._asdict())
    return found


def over_cores(work: Callable[..., Answer], calls: Iterable[tuple[Any, ...]], n_jobs: int | None) -> Iterator[Answer]:
    """The answers to many calls in their order, by as many processes; none but a few calls exist at a time."""
    from joblib import Parallel, delayed, effective_n_jobs

    if n_jobs is not None and not 0 < abs(n_jobs) <= 1000:
        raise InvalidInput(f"n_jobs must be a number of processes, or −1 for all cores, got {quoted(n_jobs)}")
    if effective_n_jobs(n_jobs) == 1:
        return (work(*call) for call in calls)
    # Processes that begin while interrupts are ignored never hear of Ctrl-C: it is for who has
    # asked, and is told once. Threads but the main one have no say in signals.
    asked = threading.current_thread() is threading.main_thread()
    before = signal.signal(signal.SIGINT, signal.SIG_IGN) if asked else None
    try:
        answers: Iterator[Answer] = Parallel(n_jobs=n_jobs, return_as="generator")(
            delayed(work)(*call) for call in calls)
        return answers
    finally:
        if asked:
            signal.signal(signal.SIGINT, before or signal.SIG_DFL)
