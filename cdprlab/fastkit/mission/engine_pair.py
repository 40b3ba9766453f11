"""The coupled pair in the engine, as navigation drives it: bodies on wheels, ray-test scanners, people who walk."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ...arrays import Array, as_array
from ...errors import InvalidInput
from ...robot.pose import Pose
from ...simulate import open_simulator
from ...simulate.mobile import MobileSimulator
from ...simulate.scanner import Bystander, ray_distances
from ...world import World
from ..navigation import Hall, Odometry, Vehicle, Walker
from ..navigation.driving import clearance, step_between
from ..navigation.plan_view import carried

_BODY = 6         # the link of a base that is the base
_AT_ONCE = 5      # engine steps in one call
_WALLS, _PALLET = ("north wall", "south wall", "west wall", "east wall"), "pallet"


class Drive(NamedTuple):
    """What the engine measured on the way, one row a period.

    tensions : (N, m) [N]; wheels : (N, 2 k) load of each wheel [N]; tilts : (N,) larger of the two bases' [rad]
    """

    tensions: Array
    wheels: Array
    tilts: Array


class EnginePair:
    """Two coupled bases in the engine, the platform fixed to the active one, all cables at their least tension.

    world : its bases stand coupled, its pose is the platform's between them
    vehicle : Vehicle; hall : for exact clearances; pose : (3,) of the pair at first [m, m, rad]
    walkers : people; seed : of all noise; dt : engine step [s]; odometry : how wrong the wheels are
    """

    def __init__(self, world: World, vehicle: Vehicle, hall: Hall, pose: ArrayLike,
                 walkers: tuple[Walker, ...] = (), seed: int = 0, dt: float = 4e-3,
                 odometry: Odometry | None = None) -> None:
        self.vehicle, self.hall, self.walkers = vehicle, hall, walkers
        self.odometry = Odometry() if odometry is None else odometry
        engine = open_simulator(moved_pair(world, vehicle, pose), "tension", dt, bodies=True, solver_iterations=20)
        assert isinstance(engine, MobileSimulator)
        self.engine, self._random = engine, np.random.default_rng(seed)
        engine.couple()
        engine._fixed(engine._bodies[0], _BODY, engine._platform, -1)
        self._tensions = np.array(world.robot.tension_min)
        self._bystanders = [Bystander(engine, walker.place, walker.radius) for walker in walkers]
        self.log: list[tuple[Array, Array, float]] = []

    @property
    def pose(self) -> Array:
        return self.vehicle.pose_of(self.engine.base_poses[0])

    @property
    def people(self) -> Array:
        return np.array([[*walker.place, walker.radius] for walker in self.walkers]).reshape(-1, 3)

    def drive(self, twist: Array, period: float) -> Array:
        before, engine = self.pose, self.engine
        engine.drive([*self.vehicle.base_speeds(twist), 0, 0, 0])
        for _ in range(round(period / engine.dt / _AT_ONCE)):
            engine.step(self._tensions, _AT_ONCE)
        after = self.pose
        for walker, bystander in zip(self.walkers, self._bystanders):
            walker.walk(period, self.vehicle.outline(after))
            bystander.put(walker.place)
        self.log.append((np.array(engine.tensions), np.concatenate(list(engine.wheel_loads().values())),
                         float(engine.tilts.max())))
        return self.odometry.measured(step_between(before, after), self._random)

    def scan(self) -> Array:
        points = []
        for scanner in self.vehicle.scanners:
            origin, directions = scanner.beams_from(self.pose)
            far = ray_distances(self.engine, np.array([*origin, scanner.height]),
                                np.insert(directions, 2, 0.0, axis=1), scanner.range)
            points.append(scanner.points(scanner.measured(far, self._random)))
        return np.concatenate(points)

    def clearance(self) -> float:
        return clearance(self.vehicle, self.pose, self.hall, self.people)

    def measured(self) -> Drive:
        """What the engine measured on the way."""
        tensions, wheels, tilts = (np.array(column) for column in zip(*self.log)) if self.log else (np.zeros(0),) * 3
        return Drive(tensions, wheels, tilts)

    def __enter__(self) -> EnginePair:
        return self

    def __exit__(self, *_: object) -> None:
        self.engine.close()


def pair_pose(world: World, active: str = "active") -> tuple[Array, float]:
    """(3,) pose of the pair as a world's bases stand, the active one behind, and how far apart they are.

    Raises InvalidInput unless there are two bases that look the same way, one behind the other.
    """
    bases = world.robot.bases
    if len(bases) != 2 or bases[0].name != active:
        raise InvalidInput(f"a pair is a base {active!r} and one it tows, in this order; there are "
                           f"{', '.join(base.name for base in bases) or 'none'}")
    off = bases[1].position - bases[0].position
    spacing, heading = float(np.linalg.norm(off)), float(np.arctan2(off[1], off[0]))
    if max(abs(np.sin((base.heading - heading) / 2)) for base in bases) > 1e-6:
        raise InvalidInput("coupled bases stand one behind the other and look along their line")
    return np.array([*(bases[0].position + bases[1].position) / 2, heading]), spacing


def moved_pair(world: World, vehicle: Vehicle, pose: ArrayLike) -> World:
    """A world whose pair, and the platform between the bases, stand somewhere else on the floor.

    pose : (3,) of the pair [m, m, rad]
    """
    here, there = pair_pose(world)[0], np.asarray(pose, dtype=float)
    spin = there[2] - here[2]
    c, s = np.cos(spin), np.sin(spin)
    turned = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    x, y = carried([*there[:2], spin], [world.pose.position[:2] - here[:2]])[0]
    platform = Pose.of(np.array([x, y, world.pose.position[2]]), turned @ world.pose.rotation)
    names = [base.name for base in world.robot.bases]
    places = {name: tuple(base.tolist()) for name, base in zip(names, vehicle.bases(there))}
    return replace(world, robot=world.robot.with_bases(places), pose=platform, tasks={})


def in_hall(world: World, bounds: ArrayLike, pallets: ArrayLike = (), height: float = 1.2) -> World:
    """A world with walls around the floor and pallets on it.

    bounds : (2, 2) of the floor, the walls just outside [m]; pallets : (k, 5) center, edges [m], heading [rad]
    height : of walls and pallets [m]

    >>> import cdprlab as cl
    >>> fastkit = cl.load_world("fastkit_suspended")
    >>> len(in_hall(fastkit, [[-5, -6], [7, 2]], [[3, -3, 0.8, 1.2, 0.3]]).scene.boxes) - len(fastkit.scene.boxes)
    5
    """
    (west, south), (east, north) = as_array(bounds, "bounds", (2, 2), "m").tolist()
    x, y, length, depth, thick = (west + east) / 2, (south + north) / 2, east - west, north - south, 0.1
    walls = [(x, north + thick / 2, length, thick, 0.0), (x, south - thick / 2, length, thick, 0.0),
             (west - thick / 2, y, thick, depth, 0.0), (east + thick / 2, y, thick, depth, 0.0)]
    names = list(_WALLS)
    rows = [*walls, *np.asarray(pallets, dtype=float).reshape(-1, 5).tolist()]
    names += [f"{_PALLET} {k}" for k in range(1, len(rows) - 3)]
    document = world.to_dict()
    scene = document.setdefault("scene", {})
    scene["boxes"] = [*scene.get("boxes", []), *(
        {"name": name, "position": [px, py, height / 2], "size": [along, across, height], "yaw": yaw}
        for name, (px, py, along, across, yaw) in zip(names, rows))]
    return World.from_dict(document)


def without_hall(world: World) -> World:
    """The world without what `in_hall` put there: in pictures it would stand between the eye and the work."""
    boxes = tuple(box for box in world.scene.boxes
                  if box.name not in _WALLS and not box.name.startswith(f"{_PALLET} "))
    return replace(world, scene=replace(world.scene, boxes=boxes))
