"""Pick and place with mobile bases: a state machine, two controllers of the winches, and the job's record."""

from .controllers import TorqueControl, VelocityControl, WinchControl
from .job import pick_and_place
from .machine import DONE, STOPPED, Machine, Phase, Sensors
from .record import Job

__all__ = ["DONE", "STOPPED", "Job", "Machine", "Phase", "Sensors", "TorqueControl", "VelocityControl", "WinchControl",
           "pick_and_place"]
