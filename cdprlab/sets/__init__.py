"""What a robot can do at one pose: available twist set and available wrench set, as polytopes."""

from .polytope import Polytope
from .twist import available_twist_set, twist_set
from .wrench import available_wrench_set, sliding_rows
from .zonotope import hyperplane_shifting

__all__ = [
    "Polytope", "available_twist_set", "available_wrench_set", "hyperplane_shifting",
    "sliding_rows", "twist_set",
]
