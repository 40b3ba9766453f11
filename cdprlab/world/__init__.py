"""World files: YAML ↔ `World`. Every mistake is named by file, line, key and cable."""

from .files import load_world, world_names, world_schema
from .model import Box, Scene, Task, World

__all__ = ["Box", "Scene", "Task", "World", "load_world", "world_names", "world_schema"]
