"""World files: YAML ↔ `World`. Every mistake is named by file, line, key and cable."""

from .model import Box, Scene, Task
from .world import World, load_world, world_names, world_schema

__all__ = ["Box", "Scene", "Task", "World", "load_world", "world_names", "world_schema"]
