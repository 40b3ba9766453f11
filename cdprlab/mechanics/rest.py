"""Where a load comes to rest on cables of given lengths: fewer cables than freedoms, or slack ones, included."""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_array, checked, frozen, lasting
from ..errors import InvalidInput, NoConvergence
from ..robot import Robot
from ..robot.pose import Pose
from .cables import check_dimension
from .kinematics import moved_rates, seen_from
from .optimization import least_squares
from .statics import gravity_wrench

_TAUT = 1e-6
"""[m] a cable that much shorter than its length is slack."""

_STILL = 1e-9
"""Of the weight and of a metre: what may be left of equilibrium and of taut cables' lengths."""


@lasting
class AtRest(NamedTuple):
    """A pose at rest, and the (m,) tensions that hold it there, 0 of slack cables [N]."""

    pose: Pose
    tensions: Array


@checked
def equilibrium(robot: Robot, lengths: ArrayLike, guess: Pose, *,
                axial_stiffness: Annotated[float, "[N] > 0"] | None = None) -> AtRest:
    """Where the load hangs still: the least potential energy min −w_g · x with l(x) ≤ lengths, near a guess.

    At rest W τ + w_g = 0 with τ ≥ 0, and τ_i = 0 where l_i is below its length: cables do not
    stretch, and only pull. Where more are taut than the pose has freedoms, τ is one of many.

    robot : m cables, with gravity
    lengths : (m,) of the cables [m]
    guess : single pose to descend from
    axial_stiffness : EA of cables that stretch, τ_i = EA (l_i − L_i) / L_i where they are taut;
        default: they do not [N]
    Returns AtRest: ``(pose, tensions)``.
    Raises InvalidInput; NoConvergence where no pose near the guess is at rest.
    Source: Carricato and Merlet 2013 (geometrico-static problem of underconstrained robots).

    >>> import cdprlab as cl
    >>> world = cl.load_world("caroca")
    >>> pose, tensions = equilibrium(world.robot, cl.cable_lengths(world.robot, world.pose) + 0.01, world.pose)
    >>> bool(pose.position[2] < world.pose.position[2] and (tensions >= 0).all())
    True
    """
    from scipy.optimize import minimize, nnls

    allowed = as_array(lengths, "lengths", (robot.n_cables,), "m", positive=True)
    check_dimension(robot, guess)
    if guess.batch_shape:
        raise InvalidInput("equilibrium descends from one pose, not from a batch")
    if robot.gravity <= 0:
        raise InvalidInput("without gravity nothing hangs: the robot's gravity must be positive [m/s²]")
    weight, n = robot.mass * robot.gravity, robot.n_dof
    stiffness = (axial_stiffness or 0.0) / weight   # 0 of cables that do not stretch
    near = seen_from(robot, guess)

    # Forces and energies are those of a weight of 1 N.
    def over(x: Array) -> Array:
        return near(x)[1].lengths - allowed

    def stretched(x: Array) -> Array:
        return stiffness * np.maximum(over(x) / allowed, 0.0)

    def energy(x: Array) -> float:
        pose = near(x)[0]
        center = pose.position + pose.rotation @ robot.platform.center_of_mass
        return float(center[-1] + stretched(x) @ np.maximum(over(x), 0.0) / 2)

    def missed(x: Array, pulls: Array) -> Array:
        pose, cables = near(x)
        return cables.wrench_matrix @ pulls + gravity_wrench(robot, pose) / weight

    def slope(x: Array) -> Array:
        return -missed(x, stretched(x)) @ moved_rates(robot, guess, x)

    pulls = np.zeros(robot.n_cables)
    if stiffness:   # Newton's steps alone may go to and fro where a cable turns slack
        x = minimize(energy, np.zeros(n), jac=slope, method="BFGS").x
    else:
        kept = {"type": "ineq", "fun": lambda x: -over(x),
                "jac": lambda x: near(x)[1].wrench_matrix.T @ moved_rates(robot, guess, x)}
        x = minimize(energy, np.zeros(n), jac=slope, constraints=[kept], method="SLSQP",
                     options={"maxiter": 1000, "ftol": 1e-14}).x
        # The program says which cables carry; equilibrium and their lengths then say exactly where.
        taut = over(x) > -_TAUT
        if taut.any():
            pulls[taut] = nnls(near(x)[1].wrench_matrix[:, taut], -missed(x, pulls))[0]
    carrying = pulls > _STILL   # one that carries but rounding might end up pushing

    def tensions(z: Array) -> Array:
        found = stretched(z[:n])
        found[carrying] += z[n:]
        return found

    def unrest(z: Array) -> Array:
        return np.concatenate([missed(z[:n], tensions(z)), over(z[:n])[carrying]])

    z = least_squares(unrest, np.concatenate([x, pulls[carrying]]))
    longer = over(z[:n])
    if not (np.abs(unrest(z)).max() <= _STILL and (stiffness or longer.max() <= _TAUT) and tensions(z).min() >= 0):
        raise NoConvergence("no pose near the guess is at rest on cables of these lengths; check the lengths, or start "
                            "nearer to where the load should hang", longer)
    return AtRest(near(z[:n])[0], frozen(weight * tensions(z)))
