"""Statically stable poses: a small push meets a force that pushes back."""

from dataclasses import dataclass

import numpy as np

from ..arrays import Array, checked
from ..errors import InvalidInput
from ..mechanics.statics import gravity_wrench, stiffness, wrench_matrix
from ..robot import Robot
from ..robot.pose import Pose
from ..tensions import distribute_tensions
from .criterion import Criterion, Judgement


@checked
@dataclass(frozen=True)
class StaticallyStable(Criterion):
    """The weight is balanced, and every eigenvalue of the stiffness at these tensions is positive.

    Lengths stay, cables stretch and turn; the weight's own part counts where the center of mass
    is not at P.

    method : tension distribution that decides how much the cables are pretensioned
    axial_stiffness : EA [N]; default that of the robot's cables
    margin : the smallest eigenvalue [N/m], turns measured at an arm of 1 m; NaN where the method
        finds no tensions
    Source: Behzadipour and Khajepour 2006; Okoli 2016, sec. 2.5, whose statically stable
    workspace this is.
    """

    method: str = "quadratic_program"
    axial_stiffness: float | None = None
    unit = "N/m"

    def judge(self, robot: Robot, poses: Pose, margin: bool = True) -> Judgement:
        W, weight = wrench_matrix(robot, poses), gravity_wrench(robot, poses)
        found = distribute_tensions(W, weight, robot.tension_min, robot.tension_max, self.method)
        smallest, held = np.full(poses.batch_shape, np.nan), found.feasible
        smallest[held] = smallest_stiffness(robot, poses[held], found.tensions[held], self.axial_stiffness)
        return Judgement(smallest > 0, smallest)


def smallest_stiffness(robot: Robot, poses: Pose, tensions: Array,
                       axial_stiffness: float | None = None) -> Array:
    """Smallest eigenvalue of the symmetric stiffness of cables and weight, turns measured at an arm of 1 m.

    robot, poses : single or batched; tensions : (…, m) [N]
    axial_stiffness : EA [N]; default that of the robot's cables
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
    K = stiffness(robot, poses, tensions, axial_stiffness, weight=True)
    return np.asarray(np.linalg.eigvalsh((K + np.swapaxes(K, -1, -2)) / 2)[..., 0])
