"""PyBullet: imported when first needed, kept quiet, and where its bodies are."""

from __future__ import annotations

import contextlib
import math
import os
import threading
from collections.abc import Iterator
from functools import cache, partial
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Array
from ..errors import needed_by
from ..robot.pose import rotation_vector

ORIGIN, STRAIGHT = [0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]
Link = tuple[float, int, list[float], list[float], int, int, list[int]]
"""Mass, shape (−1: none), place in the parent and orientation, parent (0: the base), joint and its axis."""

_IMPORTING = threading.Lock()


class Bullet(NamedTuple):
    """One client of PyBullet (DIRECT mode, no window), in which a world's bodies live.

    What the engine can do is asked of it by the engine's names, functions bound to this client.
    In the loop they are the module's own, and the client stands in its position: keywords take
    twice the time.

    engine : the module; client : its number
    """

    engine: Any
    client: int

    def __getattr__(self, name: str) -> Any:
        found = getattr(self.engine, name)
        return partial(found, physicsClientId=self.client) if callable(found) else found

    def placed(self, body: int, link: int = -1) -> tuple[Array, Array]:
        """Center of mass [m] and rotation of a link, or of a body's base (−1)."""
        place, turn = (self.getBasePositionAndOrientation(body) if link < 0 else
                       self.getLinkState(body, link, computeForwardKinematics=1)[:2])
        return np.array(place), np.array(self.getMatrixFromQuaternion(turn)).reshape(3, 3)

    def add_box(self, size: Array, position: Array, yaw: float, mass: float = 0.0) -> int:
        """A solid box, which nothing moves if it has no mass."""
        shape = self.createCollisionShape(self.GEOM_BOX, halfExtents=(size / 2).tolist())
        return int(self.createMultiBody(mass, shape, basePosition=position.tolist(),
                                        baseOrientation=self.getQuaternionFromEuler([0, 0, yaw])))

    def fix(self, a: int, link_a: int, b: int, link_b: int) -> int:
        """A constraint that holds b at a as they are now; frames are in centers of mass."""
        (pa, ra), (pb, rb) = self.placed(a, link_a), self.placed(b, link_b)
        return int(self.createConstraint(
            a, link_a, b, link_b, self.JOINT_FIXED, [0, 0, 0], (ra.T @ (pb - pa)).tolist(),
            [0, 0, 0],
            parentFrameOrientation=quaternion_of(ra.T @ rb)))

    def add_chain(self, links: list[Link], joints: list[float], position: list[float] = ORIGIN,
                  turn: list[float] = STRAIGHT) -> int:
        """One body of these links, without motors, damping or a limit of its joints' speeds.

        joints : their values; position, turn : of its base, which is fixed
        """
        n = len(links)
        mass, shapes, places, turns, parents, kinds, axes = map(list, zip(*links))
        body = int(self.createMultiBody(
            0, -1, basePosition=position, baseOrientation=turn,
            linkMasses=mass, linkCollisionShapeIndices=shapes, linkVisualShapeIndices=[-1] * n,
            linkPositions=places,
            linkOrientations=turns, linkInertialFramePositions=[ORIGIN] * n,
            linkInertialFrameOrientations=[STRAIGHT] * n, linkParentIndices=parents,
            linkJointTypes=kinds,
            linkJointAxis=axes))
        # Joints start with motors of 1000 N that would hold the robot in place.
        self.setJointMotorControlArray(body, list(range(n)), self.VELOCITY_CONTROL,
                                       forces=[0] * n)
        # The default of 100 m/s caps the tension at 100 m_tip/dt. In a call of its own: given
        # together with a link's other settings, Bullet applies all of them to the base.
        self.changeDynamics(body, -1, maxJointVelocity=1e30)
        for link in range(-1, n):
            self.changeDynamics(body, link, linearDamping=0, angularDamping=0, jointDamping=0)
        for joint, value in enumerate(joints):
            self.resetJointState(body, joint, value)
        return body


@cache
def import_pybullet() -> Any:
    """The engine, its start-up banner kept off the terminal; raises MissingDependency naming the way to get it."""
    with (needed_by("the spatial engine", "planar worlds, tensions and sets work without it"), _IMPORTING,
          _without_banner()):
        import pybullet
    return pybullet


@contextlib.contextmanager
def _without_banner() -> Iterator[None]:
    """Keep from stderr the one line that PyBullet's C prints there as it is imported.

    The stream is the whole process's: whatever others write meanwhile arrives, a little later.
    """
    import tempfile

    try:
        stderr, heard = os.dup(2), tempfile.TemporaryFile()   # noqa: SIM115 (closed below)
    except OSError:   # it is closed, or nothing can be written anywhere: then let it print
        yield
        return
    with heard:
        os.dup2(heard.fileno(), 2)
        try:
            yield
        finally:
            os.dup2(stderr, 2)
            os.close(stderr)
            heard.seek(0)
            os.write(2, b"".join(line for line in heard if not line.startswith(b"pybullet build time")))


def quaternion_of(rotation: Array) -> list[float]:
    """(x, y, z, w) of a rotation matrix."""
    turn = rotation_vector(rotation)
    half = float(np.linalg.norm(turn)) / 2
    return [*(turn / 2 * np.sinc(half / np.pi)).tolist(), math.cos(half)]


def turn_z_to(direction: Array) -> list[float]:
    """Quaternion of the shortest turn from the z axis to a direction."""
    x, y, z = direction / np.linalg.norm(direction)
    if z < -1 + 1e-9:
        return [1.0, 0.0, 0.0, 0.0]
    scale = math.sqrt(2 * (1 + z))
    return [-y / scale, x / scale, 0.0, scale / 2]
