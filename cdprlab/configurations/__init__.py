"""Cable configurations of point-mass robots: which cables are taut, how certain that is, how to change them."""

from .classify import classify_configurations, taut_configurations
from .configuration import Configuration
from .detour import plan_detour
from .measured import compatible_configurations, hanging_position, reset_by_marks
from .sequence import ConfigurationSequence, plan_configurations

__all__ = ["Configuration", "ConfigurationSequence", "classify_configurations",
           "compatible_configurations",
           "hanging_position", "plan_configurations", "plan_detour", "reset_by_marks",
           "taut_configurations"]
