"""`World` → document: the robot and pose of now laid over what they were read from; all else keeps its text."""

from types import SimpleNamespace
from typing import Any

from ..robot import Cable
from .blocks import CableBlock, SceneBlock, TaskBlock, WorldFile
from .document import copied, overlay, own, plain, styled
from .reader import read


def updated_document(world: Any) -> Any:
    """A copy of the world's document that says what the world is now; only values that changed are touched."""
    document = copied(world.document) if world.document else styled(WorldFile.of(world))
    for block in ("cable_limits", "cable"):
        if document.get(block):
            _share(own(document, block), world.robot.cables)
            if not document[block]:
                del document[block]
    wanted, scene = WorldFile.of(world), SceneBlock.of(world.scene)
    found = SimpleNamespace(**read(document, world.name))
    if scene != SceneBlock.of(found.scene):
        document["scene"] = styled(scene)
    overlay(document, {"tasks": _tasks(found)}, {"tasks": _tasks(world)})
    # The second round catches what follows a changed value by default: inertia that is left out
    # follows the mass.
    for _ in range(2):
        present = WorldFile.of(found)
        if present == wanted:
            break
        overlay(document, present, wanted)
        found = SimpleNamespace(**read(document, world.name))
    return document


def _tasks(world: Any) -> Any:
    return {name: TaskBlock.described(task) for name, task in world.tasks.items()}


def _share(shared: Any, cables: tuple[Cable, ...]) -> None:
    """Put what all cables share into the block for all, and drop from it what no longer holds for all."""
    for key in CableBlock.model_fields.keys() & shared:
        values = [CableBlock.of(cable)[key] for cable in cables]
        if None in values:
            del shared[key]
        elif values.count(values[0]) == len(values):
            overlay(shared, {key: plain(shared[key])}, {key: values[0]})
