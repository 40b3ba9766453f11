"""Statically stable poses: a small push meets a force that pushes back."""

from dataclasses import dataclass

import numpy as np

from ..arrays import Array, as_number, checked
from ..errors import InvalidInput
from ..mechanics.statics import gravity_wrench, stiffness, wrench_matrix
from ..robot import Robot
from ..robot.pose import Pose
from ..tensions import distribute_tensions
from .criterion import Criterion, Judgement


@checked
@dataclass(frozen=True)
class StaticallyStable(Criterion):
    """The weight is balanced, and every eigenvalue of the stiffness at these tensions exceeds ``least``.

    Lengths stay, cables stretch and turn; the weight's own part counts where the center of mass
    is not at P.

    method : tension distribution that decides how much the cables are pretensioned
    axial_stiffness : EA [N]; default that of the robot's cables
    length : turns are measured at this arm, which makes all of the matrix N/m [m]
    least : smallest eigenvalue asked for [N/m]
    margin : the smallest eigenvalue less ``least`` [N/m]; NaN where the method finds no
        tensions
    Source: Behzadipour and Khajepour 2006; Okoli 2016, sec. 2.5, whose statically stable
    workspace this is.
    """

    method: str = "quadratic_program"
    axial_stiffness: float | None = None
    length: float = 1.0
    least: float = 0.0
    unit = "N/m"

    def judge(self, robot: Robot, poses: Pose, margin: bool = True) -> Judgement:
        W, weight = wrench_matrix(robot, poses), gravity_wrench(robot, poses)
        found = distribute_tensions(W, np.broadcast_to(weight, W.shape[:-1]), robot.tension_min,
                                    robot.tension_max,
                                    self.method)
        smallest = np.full(poses.batch_shape, np.nan)
        held = np.asarray(found.feasible)
        if held.any():
            smallest[held] = smallest_stiffness(robot, poses[held], found.tensions[held],
                                                self.axial_stiffness,
                                                self.length)
        return Judgement(smallest > self.least, smallest - self.least)


def smallest_stiffness(robot: Robot, poses: Pose, tensions: Array,
                       axial_stiffness: float | None = None,
                       length: float = 1.0) -> Array:
    """Smallest eigenvalue of the symmetric stiffness of cables and weight, turns times ``length``.

    robot, poses : single or batched; tensions : (…, m) [N]
    axial_stiffness : EA [N]; default that of the robot's cables
    length : [m]
    Returns (…) [N/m].
    Raises InvalidInput if the stiffness of the cables is not known.

    >>> import cdprlab as cl
    >>> world = cl.load_world("planar_rigid")
    >>> float(smallest_stiffness(world.robot, world.pose, np.full(4, 100.0), 1e5)) > 0
    True
    """
    if axial_stiffness is None:
        if robot.elasticity is None:
            raise InvalidInput("the world says no cable stiffness: give axial_stiffness, EA [N], or add "
                               "`cable: {axial_stiffness: …}` to it")
        axial_stiffness = robot.elasticity.axial_stiffness
    arm = as_number(length, "length", "m", positive=True)
    K = stiffness(robot, poses, tensions, axial_stiffness, weight=True)
    scale = np.where(np.arange(robot.n_dof) < robot.n_dof - len(robot.pattern.turn_axes),
                     1.0, 1.0 / arm)
    symmetric = (K + np.swapaxes(K, -1, -2)) / 2 * scale[:, None] * scale
    return np.asarray(np.linalg.eigvalsh(symmetric)[..., 0])
