"""`World` → document: the robot and pose of now laid over what they were read from; all else keeps its text."""

from types import SimpleNamespace
from typing import Any

from ..robot import Cable
from .blocks import CableBlock, WorldFile
from .document import changed, copied, overlay, own
from .reader import read


def updated_document(world: Any) -> Any:
    """A copy of the world's document that says what the world is now; only values that changed are touched."""
    document = copied(world.document)
    if document.get("cable_limits"):
        _share_limits(own(document, "cable_limits"), world.robot.cables)
    wanted = WorldFile.of(world)
    # The second round catches what follows a changed value by default: inertia that is left out
    # follows the mass.
    for _ in range(2):
        present = WorldFile.of(SimpleNamespace(**read(document, world.name)))
        if present == wanted:
            break
        overlay(document, present, wanted)
    return document


def _share_limits(shared: Any, cables: tuple[Cable, ...]) -> None:
    """Put limits that all cables share into cable_limits, and drop a shared speed that no longer holds for all."""
    for key in list(shared):
        values = [CableBlock.of(cable)[key] for cable in cables]
        if None in values:
            del shared[key]
        elif values.count(values[0]) == len(values):
            shared[key] = changed(shared[key], values[0])
