"""What stands in a planar world's pymunk space: platform, floor, boxes, mobile bases, and the ropes between them."""

import math
from collections.abc import Sequence
from functools import partial, reduce
from itertools import permutations
from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from ..mechanics.statics import wrench_matrix
from ..robot.parts import DECK_HEIGHT
from ..robot.pose import Pose
from ..world import World
from .planar_bases import PlanarBases

_FRICTION = 0.5
_MOST_ITERATIONS = 1000
_MOST_ORDERED = 6
"""Ropes whose every order is tried."""

_CORNERS = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])
"""Of a box of size 1."""


class PlanarSpace:
    """A new pymunk space with a world's platform at rest.

    pymunk : the module
    start : the platform's pose
    iterations : of the constraint solver
    order : in which the solver takes the ropes, a rope of length zero each from a reel to the
        platform; empty: no ropes
    motion : (6,) the platform's x, y, angle and their rates [m, rad, m/s, rad/s], as last read
    velocities : x and y of one body after the other, the reels last [m/s]: what `write_velocities`
        lets the bodies have
    """

    def __init__(self, pymunk: Any, world: World, start: Pose, iterations: int, order: Sequence[int]) -> None:
        robot, platform, batch = world.robot, world.robot.platform, pymunk.batch
        space = self.space = pymunk.Space()
        space.gravity, space.iterations = (0.0, -robot.gravity), iterations
        body = self.body = pymunk.Body(robot.mass, float(platform.inertia))
        body.position = (start.position + start.rotation @ platform.center_of_mass).tolist()
        body.angle = float(start.angle)
        space.add(body)

        def add_solid(body: Any, corners: ArrayLike) -> None:
            shape = pymunk.Poly(body, np.asarray(corners, dtype=float).tolist())
            shape.friction = _FRICTION
            space.add(shape)

        def add_rope(anchor: Array) -> Any:
            """From a reel of its own to a point of the platform seen from its center of mass."""
            reel = pymunk.Body(body_type=pymunk.Body.STATIC)
            space.add(reel)
            rope = pymunk.SlideJoint(reel, body, (0, 0), anchor.tolist(), 0.0, 0.0)
            rope.error_bias = 0.0
            return rope

        add_solid(body, platform.center - platform.center_of_mass + _CORNERS * platform.size)
        if robot.motion_pattern == "1T":
            # The cables control x alone: a rail along x carries the rest.
            body.moment, height = math.inf, float(start.position[1])
            rail = pymunk.GrooveJoint(space.static_body, body, (-1e3, height), (1e3, height), (0, 0))
            rail.error_bias = 0.0
            space.add(rail)
        floor = world.scene.floor_height
        add_solid(space.static_body, [(x, floor + y) for x in (-1e3, 1e3) for y in (-1.0, 0.0)])
        for box in world.scene.boxes:
            add_solid(space.static_body, box.position + _CORNERS * box.size @ box.pose.rotation.T)
        # Kinematic: bases drive as told and no cable moves them. Their decks, over the footprint, are solid.
        self._bases = [pymunk.Body(body_type=pymunk.Body.KINEMATIC) for _ in robot.bases]
        for base, deck in zip(robot.bases, self._bases):
            space.add(deck)
            if len(base.footprint):
                left, right = sorted(base.footprint[:, 0].tolist())
                add_solid(deck, [(left, 0.0), (right, 0.0), (right, DECK_HEIGHT), (left, DECK_HEIGHT)])
        self.ropes = [add_rope(anchor) for anchor in robot.anchor_points - platform.center_of_mass] if order else []
        space.add(*[self.ropes[i] for i in order])
        # What is read and set every step, in one call each, in the engine's order: what moves,
        # then what does not, as it was added. Setting the reels one by one would take twice the
        # time.
        fields = batch.BodyFields
        motion = fields.POSITION | fields.ANGLE | fields.VELOCITY | fields.ANGULAR_VELOCITY
        # A flag works out its value whenever it is asked.
        told, velocity = SimpleNamespace(value=motion.value), SimpleNamespace(value=fields.VELOCITY.value)
        self._seen, given = batch.Buffer(), batch.Buffer()
        self._read = partial(batch.get_space_bodies, space, told, self._seen)
        self._read()
        self.motion = np.frombuffer(self._seen.float_buf(), count=6)
        # The platform, the ground, bases (which `place_bases` drives) and reels.
        self.velocities = np.zeros(2 * (2 + len(self._bases) + len(self.ropes)))
        given.set_float_buf(self.velocities)
        self.write_velocities = partial(batch.set_space_bodies, space, velocity, given)

    def clear(self) -> None:
        """Take everything out of the space. pymunk aborts where Python frees a body while pymunk frees its space."""
        self.space.remove(*self.space.constraints, *self.space.shapes, *self.space.bodies)

    def place_bases(self, bases: PlanarBases, dt: float) -> None:
        """Put the bases' bodies where the coming step takes them to where they are now, and let them drive."""
        for body, (x, y, heading), (vx, vy, spin) in zip(self._bases, bases.poses.tolist(),
                                                         bases.rates.tolist()):
            body.velocity, body.angular_velocity = (vx, vy), spin
            body.position, body.angle = (x - vx * dt, y - vy * dt), heading - spin * dt
            self.space.reindex_shapes_for_body(body)
        self.place_reels(bases)

    def place_reels(self, bases: PlanarBases) -> None:
        """Put the reels where the ropes come from."""
        for rope, place in zip(self.ropes, bases.reels.tolist()):
            rope.a.position = place

    def read_motion(self) -> None:
        """Bring `motion` up to date."""
        self._seen.clear()
        self._read()


def solving_order(world: World) -> tuple[tuple[int, ...], int]:
    """The order in which the ropes are best solved, and how many rounds bring the solver's error down a millionfold.

    Ropes are solved one after the other (Gauss and Seidel); a round over all of them projects
    the remaining error on one rope's complement after the other's. Left unfinished, taut
    redundant ropes would tighten each other step by step. How quickly it goes depends on who
    follows whom, not on who begins: of few ropes every order is tried, at every pose where a
    task starts or ends.
    """
    robot, m = world.robot, world.robot.n_cables
    weights = np.array([robot.mass, robot.mass, float(robot.platform.inertia)])[:robot.n_dof]
    projections = []
    for pose in (world.pose, *(end for task in world.tasks.values() for end in (task.start, task.end))):
        rows = wrench_matrix(robot, pose).T
        if robot.n_dof == 3:   # moments about the center of mass
            x, y = pose.rotation @ robot.platform.center_of_mass
            rows = rows - np.outer(x * rows[:, 1] - y * rows[:, 0], [0.0, 0.0, 1.0])
        rows = rows / np.sqrt(weights)
        lengths = np.maximum((rows**2).sum(axis=1), 1e-12)[:, None, None]
        projections.append(np.eye(robot.n_dof) - rows[:, :, None] * rows[:, None, :] / lengths)
    orders = [(0, *rest) for rest in permutations(range(1, m))] if m <= _MOST_ORDERED else [tuple(range(m))]
    rates = [max(np.abs(np.linalg.eigvals(reduce(np.matmul, pose[list(order)]))).max() for pose in projections)
             for order in orders]
    best = int(np.argmin(np.round(rates, 6)))
    if rates[best] > 1 - 1e-9:   # fewer ropes than freedoms: some error is nobody's
        return orders[best], _MOST_ITERATIONS if m >= robot.n_dof else 30
    rounds = math.ceil(math.log(1e-6) / math.log(max(rates[best], 1e-6)))
    return orders[best], min(max(rounds, 10), _MOST_ITERATIONS)
