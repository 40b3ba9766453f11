"""A teaching sandbox for cable-driven parallel robots.

>>> import cdprlab as cl
>>> world = cl.load_world("caroca")
>>> cl.cable_lengths(world.robot, world.pose).shape
(8,)
"""

from . import errors
from .arrays import Array as Array, Flags as Flags, Progress as Progress
from .configurations import Configuration, ConfigurationSequence, classify_configurations, plan_configurations
from .errors import CdprError
from .mechanics.cables import cable_directions, cable_lengths, cable_vectors
from .mechanics.calibration import Calibration, calibrate
from .mechanics.catenary import (
    SaggingCable as SaggingCable,
    SaggingLengths as SaggingLengths,
    sagging_cable,
    sagging_lengths,
)
from .mechanics.kinematics import Pivot as Pivot, base_jacobian, forward_kinematics, jacobian
from .mechanics.redundancy import TwistResolution, resolve_twist
from .mechanics.rest import AtRest as AtRest, equilibrium
from .mechanics.statics import (
    TippingRows as TippingRows,
    gravity_wrench,
    stiffness,
    tipping_moments,
    tipping_rows,
    wrench_matrix,
)
from .mechanics.trajectory import Reference, Trajectory, hold, quintic
from .mechanics.winch import Friction as Friction
from .robot import (
    Base,
    Cable,
    Elasticity as Elasticity,
    MotionPattern as MotionPattern,
    Platform,
    Pulley,
    Robot,
    Winch as Winch,
)
from .robot.pose import Pose
from .run import Cuts as Cuts, Run, run
from .run.compare import TensionComparison, compare_tensions
from .run.controllers import ComputedTorque, Controller as Controller, LengthControl
from .run.motors import identify_friction
from .run.reading import read_log
from .run.repeat import Repetition as Repetition, repeat
from .run.sensors import Sensors
from .run.winches import TorqueControl, VelocityControl
from .sets import Polytope, available_twist_set, available_wrench_set
from .simulate import Simulator, open_simulator
from .simulate.state import State
from .tensions import TensionDistribution, distribute_tensions, tension_methods
from .view import plot
from .workspace import (
    Criterion,
    DynamicEquilibrium,
    InterferenceFree,
    Judgement,
    PoseGrid,
    StaticallyStable,
    StaticEquilibrium,
    TippingSafe,
    TwistFeasible,
    WrenchClosure,
    WrenchFeasible,
    workspace,
)
from .workspace.calibration_poses import calibration_poses
from .workspace.placement import place_bases
from .world import Box as Box, Scene as Scene, Task as Task, World, load_world, world_names, world_schema
from .world.perturbation import perturbed

__version__ = "0.2.0"

__all__ = [
    "Base", "Cable", "Calibration", "CdprError", "ComputedTorque", "Configuration",
    "ConfigurationSequence", "Criterion",
    "DynamicEquilibrium", "InterferenceFree", "Judgement", "LengthControl",
    "Platform", "Polytope", "Pose", "PoseGrid", "Pulley", "Reference", "Robot", "Run", "Sensors", "Simulator", "State",
    "StaticEquilibrium",
    "StaticallyStable", "TensionComparison", "TensionDistribution", "TippingSafe",
    "TorqueControl", "Trajectory",
    "TwistFeasible", "TwistResolution", "VelocityControl", "World", "WrenchClosure",
    "WrenchFeasible",
    "available_twist_set", "available_wrench_set", "base_jacobian", "cable_directions",
    "cable_lengths",
    "cable_vectors", "calibrate", "calibration_poses", "classify_configurations",
    "compare_tensions", "distribute_tensions",
    "equilibrium", "errors",
    "forward_kinematics", "gravity_wrench", "hold", "identify_friction", "jacobian", "load_world",
    "open_simulator", "perturbed",
    "place_bases",
    "plan_configurations", "plot", "quintic", "read_log", "repeat", "resolve_twist", "run",
    "sagging_cable", "sagging_lengths", "stiffness",
    "tension_methods",
    "tipping_moments", "tipping_rows", "workspace", "world_names", "world_schema",
    "wrench_matrix",
]
