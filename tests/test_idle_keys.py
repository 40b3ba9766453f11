"""Each key of a world file has an effect in a run, or `World.idle_keys` says that it has none."""

import copy

import numpy as np
import pytest

import cdprlab as cl

PLANAR = {
    "name": "plane", "motion_pattern": "1R2T", "gravity": 9.81,
    "platform": {"mass": 2.0, "inertia": 0.1, "center_of_mass": [0.05, 0.02], "size": [0.4, 0.2], "center": [0, 0],
                 "pose": {"position": [1.0, 0.4], "angle": 0.1}},
    "cable_limits": {"tension": [5, 30], "speed": 0.2},
    "cables": [{"exit_point": [-0.4, 0.1], "anchor_point": [-0.2, -0.1], "base": "left", "length_offset": 0.001},
               {"exit_point": [-0.4, 1.4], "anchor_point": [-0.2, 0.1], "base": "left"},
               {"exit_point": [2.3, 1.4], "anchor_point": [0.2, 0.1]},
               {"exit_point": [2.3, 0.1], "anchor_point": [0.2, -0.1]}],
    "cable": {"axial_stiffness": 2e4, "damping": 0.1, "linear_density": 0.01,
              "pulley": {"radius": 0.03, "axis": [0.0, 1.0]}},
    "winch": {"drum_radius": 0.04, "gear_ratio": 5, "efficiency": 0.7, "torque": 1.0, "speed": 100.0},
    "bases": [{"name": "left", "pose": {"position": [0.05, 0.0]}, "mass": 20.0, "center_of_mass": [0.0, 0.4],
               "footprint": [[0.3, 0], [-0.3, 0]], "speed": {"rotation": 0.0, "translation": [0.1, 0.0]}}],
    "scene": {"floor": {"height": 0.29}, "boxes": [{"position": [1.0, 9.0], "size": [0.2, 0.2]}]},
    "tasks": {"default": {"kind": "quintic", "to": {"position": [1.2, 0.4]}, "duration": 0.4}},
}
SPATIAL = copy.deepcopy(PLANAR) | {
    "cable": PLANAR["cable"] | {"pulley": {"radius": 0.03, "axis": [0.0, 0.0, 1.0]}},
    "name": "space", "motion_pattern": "3R3T",
    "platform": {"mass": 2.0, "inertia": [0.1, 0.1, 0.1], "center_of_mass": [0.05, 0.02, 0.0], "size": [0.4, 0.4, 0.2],
                 "center": [0, 0, 0], "pose": {"position": [1.0, 0.0, 0.4], "rpy": [0.1, 0, 0]}},
    "cables": [{"exit_point": [x, y, z], "anchor_point": [0.2 if x > 1 else -0.2, 0.2 * y, 0.1 if z < 1 else -0.1],
                "length_offset": 0.001}
               | ({"base": "left"} if x < 0 else {}) for x in (-0.4, 2.3) for y in (-1.0, 1.0) for z in (0.1, 1.4)],
    "bases": [{"name": "left", "pose": {"position": [0.05, 0.0]}, "mass": 200.0, "center_of_mass": [0.0, 0.0, 0.4],
               "footprint": [[0.3, 0.5], [-0.3, 0.5], [-0.3, -0.5], [0.3, -0.5]],
               "speed": {"rotation": 0.0, "translation": [0.1, 0.0]}}],
    "scene": {"floor": {"height": 0.2}, "boxes": [{"position": [1.0, 0.0, 9.0], "size": [0.2, 0.2, 0.2]}]},
    "tasks": {"default": {"kind": "quintic", "to": {"position": [1.2, 0.0, 0.4]}, "duration": 0.4}},
}


CHANGES = {   # key as `idle_keys` says it: places and other values
    "gravity": [(("gravity",), 5.0)], "mass": [(("platform", "mass"), 3.0)],
    "inertia": [(("platform", "inertia"), lambda old: np.multiply(old, 3).tolist())],
    "center_of_mass": [(("platform", "center_of_mass"), lambda old: np.multiply(old, -1).tolist())],
    "size": [(("platform", "size"), lambda old: np.multiply(old, 3).tolist())],
    "center": [(("platform", "center"), lambda old: [*old[:-1], -0.5])],
    "pose": [(("platform", "pose", "position"), lambda old: [*old[:-1], 0.5])],
    "tension": [(("cable_limits", "tension"), [9, 20])], "speed": [(("cable_limits", "speed"), 0.02)],
    "cables": [(("cables", 0, "exit_point"), lambda old: [*old[:-1], 0.3])],
    "cable": [(("cable", "axial_stiffness"), 1e3), (("cable", "damping"), 0.9)],
    "pulley": [(("cable", "pulley"), lambda old: old | {"radius": 0.1})],
    "length_offset": [(("cables", 0, "length_offset"), 0.002)],
    "linear_density": [(("cable", "linear_density"), 0.5)],
    "winch": [(("winch", "torque"), 0.1), (("winch", "speed"), 1.0), (("winch", "drum_radius"), 0.3)],
    "bases.pose": [(("bases", 0, "pose", "position"), [-0.2, 0.0])], "bases.mass": [(("bases", 0, "mass"), 50.0)],
    "bases.center_of_mass": [(("bases", 0, "center_of_mass"), lambda old: [*old[:-1], 0.1])],
    "bases.footprint": [(("bases", 0, "footprint"), lambda old: np.multiply(old, 2).tolist())],
    "bases.speed": [(("bases", 0, "speed", "translation"), [0.01, 0.0])],
    "floor": [(("scene", "floor", "height"), 0.35)],
    "boxes": [(("scene", "boxes", 0, "position"), lambda old: [*old[:-1], 0.55])],
    "tasks": [(("tasks", "default", "duration"), 0.3)],
}


def changed(document, place, value):
    document = copy.deepcopy(document)
    block = document
    for step in place[:-1]:
        block = block[step]
    block[place[-1]] = value(block[place[-1]]) if callable(value) else value
    return cl.World.from_dict(document)


@pytest.mark.filterwarnings("ignore")
def test_encoders_are_read_where_the_real_robot_is_another():
    document = PLANAR | {"bases": [], "cables": [cable | {"base": None} for cable in PLANAR["cables"]]}
    said = [flown(cl.World.from_dict(document), "length", {"real": changed(document, *change)})
            for change in ((("name",), "real"), *CHANGES["length_offset"])]
    assert not np.array_equal(*said)


def flown(world, cables, options):
    run = cl.run(world, cables=cables, duration=0.03, dt=3e-3, **options)
    return np.concatenate([run.poses.position, run.measured_tensions, run.lengths], axis=1)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("document, cables, options", [
    (PLANAR, "tension", {}), (PLANAR, "length", {"base_speeds": [0, 0.5, 0]}), (SPATIAL, "tension", {}),
    (SPATIAL, "length", {}), (SPATIAL, "elastic", {"bodies": True})],
    ids=["planar tension", "planar length driven", "spatial tension", "spatial length", "spatial elastic bodies"])
def test_a_key_has_an_effect_or_is_said_to_have_none(document, cables, options):
    world = cl.World.from_dict(document)
    idle = world.idle_keys(cables, driven="base_speeds" in options, bodies=options.get("bodies", False),
                           sensed="sensors" in options)
    usual = flown(world, cables, options)
    for name, changes in CHANGES.items():
        felt = any(not np.array_equal(flown(changed(document, *change), cables, options), usual) for change in changes)
        assert felt == (name not in idle), name
    assert set(idle) <= set(CHANGES)
