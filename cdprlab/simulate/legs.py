"""Cables as bodies of PyBullet: UPS legs, which pull at the platform with the tension commanded.

A leg is a universal joint at the exit point, an actuated prismatic joint, a point mass at the
tip, and a point-to-point constraint from the tip to the platform's anchor point. A pull on the
prismatic joint is the tension. With a 1e-4 kg tip the leg reproduces an ideal massless cable to
about 1 µm and 0.001 N.
"""

import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from ..arrays import Array
from .bullet import ORIGIN, STRAIGHT, Bullet, Link, turn_z_to

Leg = tuple[int, int]
"""A cable: the body it belongs to, and that body's prismatic joint, whose link is the tip."""

_UNBREAKABLE = 1e25    # N, and more than any robot has


class Legs:
    """The legs of a robot, tied to its platform.

    platform : body; pivots : (m, 3) anchor points in its frame [m]
    """

    def __init__(self, bullet: Bullet, legs: list[Leg], platform: int, pivots: Array) -> None:
        self._bullet, self._legs = bullet, legs
        # The platform as parent; pivots are in center-of-mass frames, and the tip's mass is its
        # origin.
        self._ties = [int(bullet.createConstraint(platform, -1, leg, tip,
                                                  bullet.JOINT_POINT2POINT,
                                                  ORIGIN, pivot, ORIGIN))
                      for (leg, tip), pivot in zip(legs, pivots.tolist())]
        # By default a constraint gives up above an impulse of 500 N s a step, without a word.
        for tie in self._ties:
            bullet.changeConstraint(tie, maxForce=_UNBREAKABLE)
        self._forces: list[Callable[[], Any]] = [partial(bullet.engine.getConstraintState, tie, bullet.client)
                                                 for tie in self._ties]

    def pull(self, tensions: Array) -> None:
        """Hold these (m,) tensions over the coming engine call [N]."""
        b, client = self._bullet
        control, torque = b.setJointMotorControl2, b.TORQUE_CONTROL
        for (leg, drum), tension in zip(self._legs, tensions.tolist()):
            # Joint torques last one step; positive lengthens the leg. All by position (targets
            # and gains, here unused, stand in between): PyBullet parses keywords in twice the
            # time of the call.
            control(leg, drum, torque, 0.0, 0.0, -tension, 0.0, 0.0, 0.0, client)

    def forces(self) -> list[tuple[float, float, float]]:
        """Of each tie in the last step, on the leg's tip [N]."""
        return [force() for force in self._forces]

    def cut(self, cable: int) -> None:
        """Untie one from the platform."""
        self._bullet.removeConstraint(self._ties[cable])
        self._forces[cable] = partial(tuple, (0.0, 0.0, 0.0))

    def remove(self) -> None:
        """Take them out of the world, with whatever they are part of."""
        for body in dict.fromkeys(body for body, _ in self._legs):   # takes its constraints along
            self._bullet.removeBody(body)
        self._legs = []


def fixed_leg(bullet: Bullet, exit_point: Array, anchor: Array, middle: Array, tip_mass: float) -> Leg:
    """A leg that stands in the world: a body of its own, which is faster than one body with all joints.

    middle : (3,) of where the platform is to be: legs aimed there keep their universal joints
        far from singular [m]
    """
    aim = turn_z_to(middle - exit_point)
    return bullet.add_chain(leg_links(bullet, tip_mass, 0, 0, ORIGIN, STRAIGHT),
                            leg_joints(bullet, aim, anchor - exit_point), exit_point.tolist(), aim), 2


def leg_links(bullet: Bullet, tip_mass: float, first: int, parent: int, place: list[float],
              turn: list[float]) -> list[Link]:
    """The links of a leg whose first one has this number, at a place of its parent."""
    slide, swing = bullet.JOINT_PRISMATIC, bullet.JOINT_REVOLUTE
    # All the mass sits at the tip without inertia: the constraint's three rows then decouple.
    return [(0.0, -1, place, turn, parent, swing, [1, 0, 0]),
            (0.0, -1, ORIGIN, STRAIGHT, first + 1, swing, [0, 1, 0]),
            (tip_mass, -1, ORIGIN, STRAIGHT, first + 2, slide, [0, 0, 1])]


def leg_joints(bullet: Bullet, aim: list[float], vector: Array) -> list[float]:
    """Joint values (a, b, ρ) with Rx(a) Ry(b) [0, 0, ρ] = vector, in the leg's base frame, which is turned by aim."""
    axes = np.array(bullet.getMatrixFromQuaternion(aim)).reshape(3, 3)
    length = float(np.linalg.norm(vector))
    x, y, z = (axes.T @ vector / length).tolist()
    return [math.atan2(-y, z), math.asin(x), length]
