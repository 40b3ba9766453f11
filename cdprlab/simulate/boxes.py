"""Spatial worlds with loose boxes, and a gripper on the platform that takes hold of them, draws them in and lets go.

The gripper is a constraint between platform and box, whose place on the platform may be moved.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_array
from ..errors import InvalidInput
from ..robot.pose import Pose
from ..world import World
from .spatial import DEFAULT_TIP_MASS, SpatialSimulator, quaternion_of
from .state import State


class BoxSimulator(SpatialSimulator):
    """A spatial world with boxes that may be gripped; arguments as `SpatialSimulator`."""

    def __init__(self, world: World, cables: str = "tension", dt: float = 1e-3, *, tip_mass: float = DEFAULT_TIP_MASS,
                 solver_iterations: int = 5) -> None:
        self._boxes: dict[str, int] = {}
        self._box_sizes: dict[str, Array] = {}
        self._grips: dict[str, int] = {}
        self._drawn: dict[str, tuple[Array, Array]] = {}
        super().__init__(world, cables, dt, tip_mass=tip_mass, solver_iterations=solver_iterations)

    def reset(self, pose: Pose | None = None) -> State:
        for name in list(self._grips):
            self.release(name)
        return super().reset(pose)

    def add_box(self, name: str, position: ArrayLike, size: ArrayLike, mass: float, yaw: float = 0.0,
                friction: float = 0.5) -> None:
        """Put a loose box into the world.

        position : (3,) of its center [m]; size : (3,) [m]; mass : [kg]; yaw : [rad]
        friction : the box's factor of the coefficient of friction; boards and floor have 0.5
        """
        if name in self._boxes:
            raise InvalidInput(f"there is a box {name!r} already")
        b, client = self._bullet, self._client
        half = (as_array(size, "size", (3,), "m") / 2).tolist()
        shape = b.createCollisionShape(b.GEOM_BOX, halfExtents=half, physicsClientId=client)
        place = as_array(position, "position", (3,), "m").tolist()
        self._boxes[name] = int(b.createMultiBody(mass, shape, basePosition=place, physicsClientId=client,
                                                  baseOrientation=b.getQuaternionFromEuler([0, 0, yaw])))
        b.changeDynamics(self._boxes[name], -1, lateralFriction=friction, physicsClientId=client)
        self._box_sizes[name] = 2 * np.array(half)

    def box_pose(self, name: str) -> Pose:
        """Where a loose box is."""
        place, turn = self._bullet.getBasePositionAndOrientation(self._box(name), self._client)
        matrix = np.array(self._bullet.getMatrixFromQuaternion(turn)).reshape(3, 3)
        return Pose.of(np.array(place), matrix)

    def grip(self, name: str) -> None:
        """Hold a loose box at the platform, as they are to each other now."""
        if name not in self._grips:
            # What is held must not also push: platform and box overlap where the box lies in the tray.
            self._bullet.setCollisionFilterPair(self._platform, self._box(name), -1, -1, 0,
                                                physicsClientId=self._client)
            (pa, ra), (pb, rb) = self._placed(self._platform), self._placed(self._box(name))
            self._drawn[name] = ra.T @ (pb - pa), ra.T @ rb
            self._grips[name] = self._fixed(self._platform, -1, self._box(name), -1)

    def draw(self, name: str, stroke: ArrayLike) -> None:
        """Let the gripper hold a gripped box off the place where it was gripped.

        stroke : (3,) in platform axes, a little more every step or the box is torn away [m]
        """
        if name not in self._grips:
            raise InvalidInput(f"box {name!r} is not gripped; gripped are {', '.join(self._grips) or 'none'}")
        pivot = self._drawn[name][1].T @ -as_array(stroke, "stroke", (3,), "m")
        self._bullet.changeConstraint(self._grips[name], jointChildPivot=pivot.tolist(), physicsClientId=self._client)

    def is_gripped(self, name: str) -> bool:
        """Whether a loose box is held at the platform."""
        return name in self._grips

    def release(self, name: str) -> None:
        """Let a box go."""
        if name in self._grips:
            self._bullet.removeConstraint(self._grips.pop(name), physicsClientId=self._client)

    def _box(self, name: str) -> int:
        if name not in self._boxes:
            raise InvalidInput(f"there is no box {name!r}; there are {', '.join(self._boxes) or 'none'}")
        return self._boxes[name]

    def _fixed(self, a: int, link_a: int, b: int, link_b: int) -> int:
        """Hold b at a as they are now; frames are in centers of mass."""
        (pa, ra), (pb, rb) = self._placed(a, link_a), self._placed(b, link_b)
        engine = self._bullet
        constraint = engine.createConstraint(
            a, link_a, b, link_b, engine.JOINT_FIXED, [0, 0, 0], (ra.T @ (pb - pa)).tolist(), [0, 0, 0],
            parentFrameOrientation=quaternion_of(ra.T @ rb), physicsClientId=self._client)
        return int(constraint)

    def _placed(self, body: int, link: int = -1) -> tuple[Array, Array]:
        """Center of mass and rotation of a link, or of a body's base (−1)."""
        b, client = self._bullet, self._client
        place, turn = (b.getBasePositionAndOrientation(body, client) if link < 0 else
                       b.getLinkState(body, link, 0, 1, client)[:2])
        return np.array(place), np.array(b.getMatrixFromQuaternion(turn)).reshape(3, 3)
