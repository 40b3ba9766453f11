"""The coupled pair in the engine, as navigation drives it: bodies on wheels, among people who walk."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from ...arrays import Array, checked
from ...errors import InvalidInput
from ...robot import Robot
from ...robot.pose import Pose
from ...run.log import Log
from ...simulate.spatial import SpatialSimulator
from ...world import World
from ..navigation.driving import KinematicPair, Walker
from ..navigation.hall import Hall
from ..navigation.vehicle import ACTIVE, Vehicle
from ..plane import Motion, Period, placed, relative

_STEP = 4e-3      # s of the engine
_AT_ONCE = 5      # of its steps in one call


@checked
class EnginePair(KinematicPair):
    """Two coupled bases in the engine, the platform fixed to the active one, all cables at their least tension.

    world : its bases stand coupled, its pose is the platform's between them
    vehicle : Vehicle; hall : for exact clearances; pose : (3,) of the pair at first [m, m, rad]
    walkers : people; seed : of all noise

    Its ``log`` is what the engine measured on the way, one row a period: tensions (m,) [N],
    wheels (2, k) load of each wheel [N], tilts, the larger of the two bases' [rad].
    """

    log: Log

    def __init__(self, world: World, vehicle: Vehicle, hall: Hall, pose: ArrayLike,
                 walkers: tuple[Walker, ...] = (), seed: int = 0) -> None:
        super().__init__(vehicle, hall, pose, walkers, seed=seed)
        self.engine = engine = SpatialSimulator(moved_pair(world, pose), "tension", _STEP, bodies=True,
                                                solver_iterations=20)
        engine.bases.couple()
        engine.bases.lock(engine.platform)
        self.log = Log({"tensions": (engine.tensions.shape, "N"),
                        "wheels": ((2, len(world.robot.bases[0].footprint)), "N"),
                        "tilts": ((), "rad")})

    def move(self, twist: Motion, period: Period) -> None:
        engine = self.engine
        engine.drive([*self.vehicle.base_speeds(twist), 0, 0, 0])
        for _ in range(round(period / _STEP / _AT_ONCE)):
            engine.step(engine.world.robot.tension_min, _AT_ONCE)
        self.pose = self.vehicle.pose_of(engine.base_poses[0])
        self.log.keep(engine.tensions, *engine.wheel_loads().values(), engine.tilts.max())

    def __enter__(self) -> EnginePair:
        return self

    def __exit__(self, *_: object) -> None:
        self.engine.close()


@checked
def pair_pose(world: World) -> tuple[Array, float]:
    """(3,) pose of the pair as a world's bases stand, the active one behind, and how far apart they are.

    Raises InvalidInput unless there are two bases that look the same way, one behind the other.
    """
    bases = world.robot.bases
    if len(bases) != 2 or bases[0].name != ACTIVE:
        raise InvalidInput(f"a pair is a base {ACTIVE!r} and one it tows, in this order; there are "
                           f"{', '.join(base.name for base in bases) or 'none'}")
    active, passive = bases
    off = passive.position - active.position
    spacing, heading = float(np.linalg.norm(off)), float(np.arctan2(off[1], off[0]))
    if max(abs(np.sin((base.heading - heading) / 2)) for base in bases) > 1e-6:
        raise InvalidInput("coupled bases stand one behind the other and look along their line")
    return np.array([*(active.position + passive.position) / 2, heading]), spacing


def moved_pair(world: World, pose: ArrayLike) -> World:
    """A world whose pair, and the platform between the bases, stand somewhere else on the floor.

    pose : (3,) of the pair [m, m, rad]
    """
    here = pair_pose(world)[0]
    return replace(world, robot=shifted_bases(world.robot, here, pose),
                   pose=shifted_pose(world.pose, here, pose), tasks={})


def shifted_bases(robot: Robot, here: ArrayLike, there: ArrayLike) -> Robot:
    """A robot whose bases stand as they do when all that belongs to the pose ``here`` is where ``there`` is."""
    return robot.with_bases({base.name: shifted(base.pose, here, there) for base in robot.bases})


def shifted_pose(pose: Pose, here: ArrayLike, there: ArrayLike) -> Pose:
    """A body's pose in space as it is when all that belongs to the pose ``here`` is where ``there`` is."""
    x, y, spin = shifted((*pose.position[:2], 0.0), here, there)
    turned = Pose([x, y, pose.position[2]], rpy=[0, 0, spin])
    return Pose.of(turned.position, turned.rotation @ pose.rotation)


def shifted(place: ArrayLike, here: ArrayLike, there: ArrayLike) -> tuple[float, float, float]:
    """A place (x, y, heading) as it is when all that belongs to the pose ``here`` is where ``there`` is."""
    return tuple(placed(there, relative(place, here)).tolist())
