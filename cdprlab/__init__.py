"""A teaching sandbox for cable-driven parallel robots.

>>> import cdprlab as cl
>>> world = cl.load_world("caroca")
>>> cl.cable_lengths(world.robot, world.pose).shape
(8,)
"""

from . import errors
from .base_placement import place_bases
from .compare import TensionComparison, compare_tensions
from .configurations import ConfigurationSequence, classify_configurations, plan_configurations
from .control import ComputedTorque
from .errors import CdprError
from .geometry import cable_directions, cable_lengths, cable_vectors
from .kinematics import base_jacobian, forward_kinematics, jacobian
from .picking import Job, TorqueControl, VelocityControl, pick_and_place
from .pose import Pose
from .redundancy import TwistResolution, resolve_twist
from .robot import Base, Cable, Platform, Robot
from .run import Run, run
from .sets import Polytope, available_twist_set, available_wrench_set
from .simulate import Simulator, open_simulator
from .state import State
from .statics import gravity_wrench, stiffness, tipping_moments, tipping_rows, wrench_matrix
from .tensions import TensionDistribution, distribute_tensions, tension_methods
from .trajectory import Reference, Trajectory, hold, quintic
from .view import plot
from .workspace import (
    DynamicEquilibrium,
    InterferenceFree,
    StaticallyStable,
    StaticEquilibrium,
    TippingSafe,
    TwistFeasible,
    WrenchClosure,
    WrenchFeasible,
    workspace,
)
from .world import World, load_world, world_names, world_schema

__version__ = "0.1.0"

__all__ = [
    "Base", "Cable", "CdprError", "ComputedTorque", "ConfigurationSequence", "DynamicEquilibrium", "InterferenceFree",
    "Job", "Platform", "Polytope", "Pose", "Reference", "Robot", "Run", "Simulator", "State", "StaticEquilibrium",
    "StaticallyStable", "TensionComparison", "TensionDistribution", "TippingSafe", "TorqueControl", "Trajectory",
    "TwistFeasible", "TwistResolution", "VelocityControl", "World", "WrenchClosure", "WrenchFeasible",
    "available_twist_set", "available_wrench_set", "base_jacobian", "cable_directions", "cable_lengths",
    "cable_vectors", "classify_configurations", "compare_tensions", "distribute_tensions", "errors",
    "forward_kinematics", "gravity_wrench", "hold", "jacobian", "load_world", "open_simulator", "pick_and_place",
    "place_bases", "plan_configurations", "plot", "quintic", "resolve_twist", "run", "stiffness", "tension_methods",
    "tipping_moments", "tipping_rows", "workspace", "world_names", "world_schema", "wrench_matrix",
]
