"""Where a load comes to rest on cables of given lengths: fewer cables than freedoms, or slack ones, included."""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_array, checked, frozen, lasting
from ..errors import InvalidInput, NoConvergence
from ..robot import Robot
from ..robot.pose import Pose
from .cables import cable_lengths, check_dimension
from .kinematics import moved, moved_rates, moved_slope
from .optimization import least_squares
from .statics import gravity_wrench, wrench_matrix

_TAUT = 1e-6
"""[m] a cable that much shorter than its length is slack."""

_STILL = 1e-9
"""Of the weight and of a metre: what may be left of equilibrium and of taut cables' lengths."""

_NO_REST = ("no pose near the guess is at rest on cables of these lengths; check the lengths, or start nearer to "
            "where the load should hang")


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
    if axial_stiffness is not None:
        return _stretched(robot, allowed, guess, axial_stiffness)

    def height(x: Array) -> float:
        return _height(robot, moved(robot, guess, x))

    def slope(x: Array) -> Array:
        return -gravity_wrench(robot, moved(robot, guess, x)) @ moved_rates(robot, guess, x) / weight

    def spare(x: Array) -> Array:
        return allowed - cable_lengths(robot, moved(robot, guess, x))

    kept = {"type": "ineq", "fun": spare, "jac": lambda x: -moved_slope(robot, guess, x)}
    x = minimize(height, np.zeros(n), jac=slope, constraints=[kept], method="SLSQP",
                 options={"maxiter": 1000, "ftol": 1e-14}).x
    # The program says which cables carry; equilibrium and their lengths then say exactly where.
    taut = spare(x) < _TAUT
    pulls = np.zeros(robot.n_cables)
    W, w_g = wrench_matrix(robot, moved(robot, guess, x)), gravity_wrench(robot, moved(robot, guess, x))
    pulls[taut] = nnls(W[:, taut], -w_g / weight)[0] if taut.any() else 0.0
    carrying = pulls > _STILL   # one that carries but rounding might end up pushing

    def unrest(z: Array) -> Array:
        pose = moved(robot, guess, z[:n])
        missed = wrench_matrix(robot, pose)[:, carrying] @ z[n:] + gravity_wrench(robot, pose) / weight
        return np.concatenate([missed, (cable_lengths(robot, pose) - allowed)[carrying]])

    z = least_squares(unrest, np.concatenate([x, pulls[carrying]]))
    pose, tensions = moved(robot, guess, z[:n]), np.zeros(robot.n_cables)
    tensions[carrying] = weight * z[n:]
    over = cable_lengths(robot, pose) - allowed
    if np.abs(unrest(z)).max() > _STILL or over.max() > _TAUT or tensions.min() < 0:
        raise NoConvergence(_NO_REST, over)
    return AtRest(pose, frozen(tensions))


def _stretched(robot: Robot, lengths: Array, guess: Pose, stiffness: float) -> AtRest:
    """Where the weight's and the cables' energy is least, and W τ + w_g = 0."""
    from scipy.optimize import minimize

    weight = robot.mass * robot.gravity

    def pulls(pose: Pose) -> Array:
        return np.asarray(stiffness * np.maximum(cable_lengths(robot, pose) / lengths - 1, 0.0))

    def energy(x: Array) -> float:
        pose = moved(robot, guess, x)
        return _height(robot, pose) + float((pulls(pose)**2 * lengths).sum()) / (2 * stiffness * weight)

    def imbalance(x: Array) -> Array:
        pose = moved(robot, guess, x)
        return (wrench_matrix(robot, pose) @ pulls(pose) + gravity_wrench(robot, pose)) / weight

    def slope(x: Array) -> Array:
        return -imbalance(x) @ moved_rates(robot, guess, x)

    # Newton's steps alone may go to and fro where a cable turns slack.
    low = minimize(energy, np.zeros(robot.n_dof), jac=slope, method="BFGS").x
    x = least_squares(imbalance, low)
    if not np.abs(imbalance(x)).max() <= _STILL:
        raise NoConvergence(_NO_REST, imbalance(x))
    pose = moved(robot, guess, x)
    return AtRest(pose, frozen(pulls(pose)))


def _height(robot: Robot, pose: Pose) -> float:
    """Of the center of mass [m]."""
    return float((pose.position + pose.rotation @ robot.platform.center_of_mass)[-1])
