"""`World` → YAML: the robot and pose of now laid over the document they were read from; all else keeps its text."""

from __future__ import annotations

import copy
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from ..robot import Base, Cable, Platform, Robot

if TYPE_CHECKING:
    from ..robot.pose import Pose
    from .model import World

Block = dict[str, Any]


def updated_document(world: World, read: Callable[[Any], World]) -> Any:
    """A copy of the world's document that says what the world is now; only values that changed are touched.

    read : makes a world of a document
    """
    document = copy.deepcopy(world.document)
    _share_limits(document, world.robot.cables)
    wanted = described(world)
    # The second round catches what follows a changed value by default: inertia that is left out follows the mass.
    for _ in range(2):
        present = described(read(document))
        if present == wanted:
            break
        _overlay(document, present, wanted)
    return document


def described(world: World) -> Block:
    """Robot and pose as the blocks of a world file, every key spelled out, None for what it leaves out."""
    robot = world.robot
    return {
        "name": world.name, "title": world.title, "source": world.source, "engine": world.engine,
        "motion_pattern": robot.motion_pattern, "gravity": robot.gravity,
        "platform": _platform(robot.platform, world.pose), "cables": [_cable(cable) for cable in robot.cables],
        "bases": [_base(base) for base in robot.bases], **_drives(robot),
    }


def styled(value: Any, *, root: bool = True) -> Any:
    """Plain data as it reads best in YAML: what fits on a line in braces or brackets, the rest indented; no None."""
    from ruamel.yaml.comments import CommentedMap, CommentedSeq

    if isinstance(value, dict):
        node: Any = CommentedMap((key, styled(item, root=False)) for key, item in value.items() if item is not None)
    elif isinstance(value, list):
        node = CommentedSeq(styled(item, root=False) for item in value)
    else:
        return value
    if not root and len(str(value)) <= 110:
        node.fa.set_flow_style()
    return node


# --- parts → blocks -----------------------------------------------------------------------------------
def _platform(platform: Platform, pose: Pose) -> Block:
    return {"mass": platform.mass, "inertia": _inertia(platform.inertia),
            "center_of_mass": platform.center_of_mass.tolist(), "size": platform.size.tolist(),
            "center": platform.center.tolist(), "pose": _pose(pose)}


def _inertia(inertia: Any) -> Any:
    if inertia.ndim == 0:
        return float(inertia)
    principal, products = np.diag(inertia).tolist(), inertia[np.triu_indices(3, 1)].tolist()
    return principal + products if any(products) else principal


def _pose(pose: Pose) -> Block:
    planar = pose.dimension == 2
    return {"position": pose.position.tolist(), "rpy": None if planar else pose.rpy.tolist(),
            "angle": float(pose.angle) if planar else None}


def _cable(cable: Cable) -> Block:
    return {"exit_point": cable.exit_point.tolist(), "anchor_point": cable.anchor_point.tolist(),
            "tension": [cable.tension_min, cable.tension_max], "speed": _finite(cable.speed_max), "base": cable.base}


def _base(base: Base) -> Block:
    return {"name": base.name, "pose": {"position": base.position.tolist(), "heading": base.heading},
            "mass": base.mass, "center_of_mass": base.center_of_mass.tolist(), "footprint": base.footprint.tolist(),
            "speed": {"rotation": float(base.speed_max[0]), "translation": base.speed_max[1:].tolist()}}


def _drives(robot: Robot) -> Block:
    stretch, winch = robot.elasticity, robot.winch
    return {
        "cable": stretch and {"axial_stiffness": stretch.axial_stiffness, "damping": stretch.damping},
        "winch": winch and {"drum_radius": winch.drum_radius, "gear_ratio": winch.gear_ratio,
                            "efficiency": winch.efficiency, "torque": _finite(winch.torque),
                            "speed": _finite(winch.speed), "inertia": winch.inertia,
                            "friction": {"coulomb": winch.coulomb, "viscous": winch.viscous,
                                         "static": winch.static}},
    }


def _finite(limit: float) -> float | None:
    """A limit as the file has it: "unlimited" is said by leaving it out."""
    return None if np.isinf(limit) else float(limit)


# --- blocks → document --------------------------------------------------------------------------------
def _share_limits(document: Any, cables: tuple[Cable, ...]) -> None:
    """Put limits that all cables share into cable_limits, and drop a shared speed that no longer holds for all."""
    if not document.get("cable_limits"):
        return
    limits = _own(document, "cable_limits")
    for key in [key for key in ("tension", "speed") if key in limits]:
        values = [_cable(cable)[key] for cable in cables]
        if None in values:
            del limits[key]
        elif limits[key] != values[0] and values.count(values[0]) == len(values) and not _stated(document, key):
            limits[key] = _leaf(limits[key], values[0])


def _stated(document: Any, key: str) -> bool:
    return any(key in cable for cable in document["cables"])


def _overlay(node: Any, before: Block, after: Block) -> None:
    """Write into ``node`` what differs between the two descriptions."""
    for key, value in after.items():
        old = before.get(key)
        if old == value:
            continue
        if value is None or value == []:
            node.pop(key, None)
        elif isinstance(value, dict) and isinstance(old, dict):
            _overlay(_own(node, key), old, value)
        elif key in ("cables", "bases") and key in node:
            _overlay_list(_own(node, key), old or [], value)
        else:
            node[key] = _leaf(node.get(key), value)


def _overlay_list(node: Any, before: list[Block], after: list[Block]) -> None:
    kept = min(len(before), len(after))
    for i in range(kept):
        _overlay(_own(node, i), before[i], after[i])
    del node[kept:]
    node.extend(styled(block, root=False) for block in after[kept:])


def _own(node: Any, key: str | int) -> Any:
    """The block at ``key``, to be changed: a new one if there is none, a copy if others refer to it (YAML anchors)."""
    if isinstance(key, str) and key not in node:
        node[key] = styled({}, root=False)
    elif node[key].yaml_anchor() is not None:
        node[key] = copy.deepcopy(node[key])
        node[key].yaml_set_anchor(None)
    return node[key]


def _leaf(old: Any, value: Any) -> Any:
    """``value``, as a change of ``old`` where that is a list of the same length: its style and comments stay."""
    both_lists = isinstance(old, list) and isinstance(value, list)
    if not both_lists or len(old) != len(value) or old.yaml_anchor() is not None:
        return styled(value, root=False)
    for i, number in enumerate(value):
        if old[i] != number:
            old[i] = _leaf(old[i], number)
    return old
