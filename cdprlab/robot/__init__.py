"""What a cable robot is made of: frozen `Cable`, `Platform`, `Base`, `Robot`, and its motion pattern."""

from .parts import Base, Cable, Elasticity, Platform, Pulley, Winch, box_inertia, check_order
from .pattern import MOTION_PATTERNS, MotionPattern
from .pose import turned_to
from .robot import STANDARD_GRAVITY, Robot

__all__ = ["MOTION_PATTERNS", "STANDARD_GRAVITY", "Base", "Cable", "Elasticity", "MotionPattern", "Platform", "Pulley",
           "Robot", "Winch", "box_inertia", "check_order", "turned_to"]
