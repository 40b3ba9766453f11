"""A mobile base as a body in PyBullet: it stands on wheels, drives, tips over, and carries its cables' legs.

A base hangs on six joints of its own, two along the floor, one about the vertical, one up, two to tilt, so that driving
is commanded exactly while rising and tilting are left to physics. Its wheels are spheres without friction: driving is
the joints' business, and a sphere touches at the one point the footprint names. Everything of a base, legs included,
is one multibody, which Bullet solves without the slip a constraint between bodies would bring.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..arrays import Array
from ..robot import Base
from .spatial import leg_joints, turn_z_to

ALONG, ACROSS, ABOUT, BODY = 0, 1, 2, 6  # joints that drive, and the link that is the base
_WHEEL = 0.05  # m
_STRAIGHT = [0, 0, 0, 1]
_ORIGIN = [0, 0, 0]


def drum_joint(k: int) -> int:
    """The prismatic joint of a base's k-th leg, counted from 0."""
    return BODY + 3 * (k + 1)


def make_base(engine: Any, client: int, base: Base, exits: Array, anchors: Array, middle: Array,
              tip_mass: float) -> int:
    """The body of a base where the world puts it, its legs reaching to the anchor points.

    exits : (k, 3) of its cables, in its own frame [m]; anchors : (k, 3) in the world [m]
    middle : (3,) of where the platform is to be: legs aimed there keep far from singular [m]
    tip_mass : [kg]
    """
    links, values = _standing(engine, client, base), [*base.pose, 0.0, 0.0, 0.0, 0.0]
    slide, swing = engine.JOINT_PRISMATIC, engine.JOINT_REVOLUTE
    seen, ends = ((points - base.origin) @ base.rotation for points in (middle, anchors))   # in the base's frame
    for exit_point, anchor in zip(exits, ends):
        frame, first = turn_z_to(seen - exit_point), len(links)
        links += [(0, -1, (exit_point - base.center_of_mass).tolist(), frame, BODY + 1, swing, [1, 0, 0]),
                  (0, -1, _ORIGIN, _STRAIGHT, first + 1, swing, [0, 1, 0]),
                  (tip_mass, -1, _ORIGIN, _STRAIGHT, first + 2, slide, [0, 0, 1])]
        axes = np.array(engine.getMatrixFromQuaternion(frame)).reshape(3, 3)
        values += leg_joints(axes.T @ (anchor - exit_point))
    body = _multibody(engine, client, links)
    engine.changeDynamics(body, BODY, localInertiaDiagonal=_inertia(base), physicsClientId=client)
    engine.changeDynamics(body, BODY, lateralFriction=0.0, physicsClientId=client)
    for joint, value in enumerate(values):
        engine.resetJointState(body, joint, value, physicsClientId=client)
    return body


def _standing(engine: Any, client: int, base: Base) -> list[Any]:
    """Links of a base without legs: (mass, shape, place in the parent, orientation, parent, joint, axis)."""
    slide, swing, com, n = engine.JOINT_PRISMATIC, engine.JOINT_REVOLUTE, base.center_of_mass, len(base.footprint)
    wheels = engine.createCollisionShapeArray(
        shapeTypes=[engine.GEOM_SPHERE] * n, radii=[_WHEEL] * n, physicsClientId=client,
        collisionFramePositions=[[x - com[0], y - com[1], _WHEEL - com[2]] for x, y in base.footprint.tolist()])
    free = [(slide, [1, 0, 0]), (slide, [0, 1, 0]), (swing, [0, 0, 1]),
            (slide, [0, 0, 1]), (swing, [1, 0, 0]), (swing, [0, 1, 0])]
    links: list[Any] = [(0, -1, _ORIGIN, _STRAIGHT, k, kind, axis) for k, (kind, axis) in enumerate(free)]
    return [*links, (base.mass, wheels, com.tolist(), _STRAIGHT, BODY, engine.JOINT_FIXED, [0, 0, 1])]


def _multibody(engine: Any, client: int, links: list[Any]) -> int:
    """One body of these links, without motors, damping or a limit of its joints' speeds."""
    mass, shapes, places, turns, parents, kinds, axes = map(list, zip(*links))
    body = int(engine.createMultiBody(
        0, -1, basePosition=_ORIGIN, linkMasses=mass, linkCollisionShapeIndices=shapes,
        linkVisualShapeIndices=[-1] * len(links), linkPositions=places, linkOrientations=turns,
        linkInertialFramePositions=[_ORIGIN] * len(links), linkInertialFrameOrientations=[_STRAIGHT] * len(links),
        linkParentIndices=parents, linkJointTypes=kinds, linkJointAxis=axes, physicsClientId=client))
    engine.setJointMotorControlArray(body, list(range(len(links))), engine.VELOCITY_CONTROL, forces=[0] * len(links),
                                     physicsClientId=client)
    engine.changeDynamics(body, -1, maxJointVelocity=1e9, physicsClientId=client)
    for link in range(-1, len(links)):
        engine.changeDynamics(body, link, linearDamping=0, angularDamping=0, jointDamping=0, physicsClientId=client)
    return body


def _inertia(base: Base) -> list[float]:
    """Of a uniform box over the footprint, twice as high as its center of mass [kg m²]."""
    x, y = np.ptp(base.footprint, axis=0)
    z = 2 * base.center_of_mass[2]
    return (base.mass / 12 * np.array([y * y + z * z, x * x + z * z, x * x + y * y])).tolist()
