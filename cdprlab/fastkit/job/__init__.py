"""Pick and place with mobile bases: a state machine and the job's record."""

from .job import pick_and_place
from .job_record import Job
from .machine import DONE, STOPPED, Machine, Phase, Sensors

__all__ = ["DONE", "STOPPED", "Job", "Machine", "Phase", "Sensors", "pick_and_place"]
