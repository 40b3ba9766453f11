"""Robots that are not what their model says: each number off by a small error, drawn from a seed."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import numpy as np

from ..arrays import Array, as_seed, checked, frozen
from ..errors import InvalidInput
from .world import World


@checked
def perturbed(world: World, exit_points: Annotated[float, "[m] ≥ 0"] = 0.0,
              anchor_points: Annotated[float, "[m] ≥ 0"] = 0.0, mass: Annotated[float, "≥ 0"] = 0.0,
              center_of_mass: Annotated[float, "[m] ≥ 0"] = 0.0,
              lengths: Annotated[float, "[m] ≥ 0"] = 0.0, seed: int = 0) -> World:
    """A world like it, each number off by an error drawn evenly from ± the one given.

    exit_points, anchor_points, center_of_mass : of each coordinate that the motion pattern leaves
        free [m]
    mass : as a fraction, below 1; the inertia follows
    lengths : of each winch's encoder zero: it reads l + `Cable.length_offset` [m]
    seed : the same one draws the same errors for every size
    Returns World, whose ``errors`` says by how much, by these names: (m, d) and (d,) in world and
        platform axes, (m,), and the fraction. It is saved like any other, its errors are not.
    Raises InvalidInput for negative sizes, and for errors the motion pattern has no room for.

    >>> import cdprlab as cl
    >>> world = cl.load_world("caroca")
    >>> real = perturbed(world, exit_points=0.005, seed=1)
    >>> np.allclose(real.robot.exit_points - world.robot.exit_points, real.errors["exit_points"])
    True
    """
    robot, body = world.robot, world.robot.platform
    m, d = robot.n_cables, robot.dimension
    if mass >= 1:
        raise InvalidInput(f"mass must be a fraction below 1, got {mass:g}")
    if anchor_points and not robot.pattern.turns:
        raise InvalidInput(f"in {robot.motion_pattern} all cables meet at P: anchor_points must be 0")
    rng = np.random.default_rng(as_seed(seed))

    def drawn(size: float, *shape: int) -> Array:
        return np.asarray(rng.uniform(-1.0, 1.0, shape) * size)

    errors = {"exit_points": drawn(exit_points, m, d), "anchor_points": drawn(anchor_points, m, d),
              "mass": drawn(mass), "center_of_mass": drawn(center_of_mass, d), "lengths": drawn(lengths, m)}
    if robot.motion_pattern == "2R3T":   # all anchor points lie on the platform's x′ axis
        errors["anchor_points"][:, 1:] = 0.0
    cables = [replace(cable, exit_point=cable.exit_point + exit_error @ turn,
                      anchor_point=cable.anchor_point + anchor_error,
                      length_offset=cable.length_offset + offset)
              for cable, turn, exit_error, anchor_error, offset
              in zip(robot.cables, robot.exit_rotations, errors["exit_points"], errors["anchor_points"],
                     errors["lengths"])]
    heavier = 1 + float(errors["mass"])
    platform = replace(body, mass=body.mass * heavier, inertia=body.inertia * heavier,
                       center_of_mass=body.center_of_mass + errors["center_of_mass"])
    return replace(world, robot=replace(robot, cables=tuple(cables), platform=platform),
                   errors={name: frozen(error) for name, error in errors.items()})
