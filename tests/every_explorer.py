"""Every explorer, as the lessons open it."""

import numpy as np

import cdprlab as cl
from cdprlab import course
from cdprlab.fastkit import Vehicle


def hung(explorer):
    """With its load hung in the engine."""
    explorer.set(hang="yes")
    return explorer


EVERY_EXPLORER = {
    "hanging, CAROCA": lambda: course.hanging_explorer(cl.load_world("caroca")),
    "pose, CAROCA": lambda: course.pose_explorer(cl.load_world("caroca")),
    "pose, IPAnema 3": lambda: course.pose_explorer(cl.load_world("ipanema3")),
    "force polygon, 2 cables": lambda: course.equilibrium_explorer(2, internal=False),
    "force polygon, load let go in pymunk": lambda: course.equilibrium_explorer(3),
    "two circles, load hung": lambda: hung(course.two_circles_explorer()),
    "Gauss–Newton": lambda: course.forward_kinematics_explorer(3),
    "Gauss–Newton, platform hung": lambda: hung(course.forward_kinematics_explorer(6, error=100.0)),
    "tensions": lambda: course.tension_explorer(
        cl.load_world("caroca"), cl.Pose([-1.5, -0.6, 1.6], rpy=np.deg2rad([1.0, 9.0, -9.0]))),
    "gains": lambda: course.gain_explorer(kp=100, kd=20, dt=4.2, span=1.0),
    "workspaces": lambda: course.workspace_explorer(cl.load_world("planar_rigid")),
    "one real cable": lambda: course.real_cable_explorer(),
    "bases": lambda: course.base_explorer(cl.load_world("planar_mcdpr")),
    "twists": lambda: course.twist_set_explorer(cl.load_world("planar_mcdpr")),
    "wrenches": lambda: course.wrench_set_explorer(cl.load_world("planar_mcdpr")),
    "planning": lambda: course.planning_explorer(Vehicle.of(cl.load_world("fastkit_suspended").robot, 1.6)),
    "configurations, exact": lambda: course.configuration_explorer(cl.load_world("marionet"), uncertain=False),
    "model errors": lambda: course.model_error_explorer(cl.load_world("fastkit_suspended")),
    "configurations": lambda: course.configuration_explorer(cl.load_world("marionet")),
}
"""Name → what makes it."""
