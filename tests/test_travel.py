"""Objects travel alike: copied, pickled or sent to a worker, their arrays stay read-only; == is one bool."""

import copy
import io
import pickle
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import Any

import faces
import joblib
import numpy as np
import pytest

import cdprlab as cl

CAROCA = cl.load_world("caroca")
FLAT = cl.load_world("planar_mcdpr")
TURNED = cl.quintic(CAROCA.pose, CAROCA.pose, 1.0)
W, W_E = cl.wrench_matrix(CAROCA.robot, CAROCA.pose), cl.gravity_wrench(CAROCA.robot, CAROCA.pose)
ONES = np.ones(6)
POINT = cl.load_world("point_mass")
SPREAD = cl.Pose([[0.5, 0.1, 1.0], [-0.5, 0.3, 1.2], [0.2, -0.4, 0.8], [0.0, 0.0, 1.5]])
MADE: dict[str, Callable[[], Any]] = {
    "World": lambda: cl.load_world("fastkit_suspended"), "Robot": lambda: FLAT.robot, "Pose": lambda: CAROCA.pose,
    "Run": lambda: cl.run(CAROCA, cables="force", duration=3e-3),
    "TensionDistribution": lambda: cl.distribute_tensions(W, W_E, 50.0, 1e4),
    "TensionComparison": lambda: cl.compare_tensions(CAROCA, methods="quadratic_program", time_step=5.0),
    "Polytope": lambda: cl.available_twist_set(CAROCA.robot, CAROCA.pose),
    "PoseGrid": lambda: cl.PoseGrid({"x": np.arange(3.0)}, CAROCA.pose), "Trajectory": lambda: TURNED,
    "Reference": lambda: TURNED(0.5), "Judgement": lambda: cl.workspace(CAROCA.robot, CAROCA.pose, cl.WrenchClosure()),
    "TippingRows": lambda: cl.tipping_rows(FLAT.robot, FLAT.pose),
    "TwistResolution": lambda: cl.resolve_twist(CAROCA.robot, CAROCA.pose, np.zeros(6)),
    "TwistFeasible": lambda: cl.TwistFeasible(half_widths=ONES), "WrenchFeasible": lambda: cl.WrenchFeasible(ONES),
    "DynamicEquilibrium": lambda: cl.DynamicEquilibrium(ONES), "Box": lambda: cl.Box(np.zeros(3), np.ones(3)),
    "Both": lambda: cl.WrenchFeasible(ONES) & cl.DynamicEquilibrium(ONES),
    "ComputedTorque": lambda: cl.ComputedTorque(),
    "LengthControl": lambda: cl.LengthControl(100.0, [20.0] * 8), "Pulley": lambda: cl.Pulley(0.04, [0, 0, 1]),
    "Sensors": lambda: cl.Sensors(length_offset=np.full(8, 1e-3)),
    "perturbed": lambda: cl.perturbed(CAROCA, exit_points=0.01, lengths=0.001),
    "Run of another robot": lambda: cl.run(POINT, duration=3e-3, real=cl.perturbed(POINT, mass=0.01),
                                           sensors=cl.Sensors()),
    "Repetition": lambda: cl.repeat(POINT, 2, errors={"mass": 0.1}, duration=2e-3),
    "Calibration": lambda: cl.calibrate(POINT.robot, SPREAD, cl.cable_lengths(POINT.robot, SPREAD),
                                        unknown=("length_offsets",)),
    "ConfigurationSequence": lambda: cl.plan_configurations(POINT.robot, [-0.5, 0.1, 1], [0.5, 0.1, 1])[0],
    "AtRest": lambda: cl.equilibrium(POINT.robot, cl.cable_lengths(POINT.robot, POINT.pose), POINT.pose),
    "SaggingCable": lambda: cl.sagging_cable([4.0, -1.0], 4.3, 0.05, 1e5),
    **{f"fastkit's {name}": partial(faces.made, name) for name in
       ("vehicle", "hall", "grid", "journey", "mission", "trip", "sensors", "job", "plan")},
}


def sent(thing: Any) -> Any:
    file = io.BytesIO()
    joblib.dump(thing, file)
    file.seek(0)
    return joblib.load(file)


WAYS: list[Callable[[Any], Any]] = [lambda x: pickle.loads(pickle.dumps(x)), copy.deepcopy, copy.copy, sent]
FRESH = {"Reference", "Judgement", "fastkit's mission", "fastkit's sensors"}
"""Answers of a function that nobody else holds: theirs until they travel."""


def arrays(thing: Any, name: str = "") -> Iterator[tuple[str, Any]]:
    """Each array that one reaches from a thing by names that are public, and how."""
    if isinstance(thing, np.ndarray):
        yield name, thing
        return
    if isinstance(thing, cl.Pose):
        parts: Any = {"position": thing.position, "rotation": thing.rotation}
    elif isinstance(thing, Mapping):
        parts = thing
    elif isinstance(thing, tuple):
        parts = dict(enumerate(thing))
    else:
        parts = getattr(thing, "__dict__", {})
    for key, part in parts.items():
        if not str(key).startswith("_") and key != "document":
            yield from arrays(part, f"{name}.{key}")


@pytest.mark.parametrize("what", MADE)
def test_arrays_stay_read_only_wherever_an_object_goes(what: str):
    thing = MADE[what]()
    for way in WAYS + [lambda x: x] * (what not in FRESH):
        there = way(thing)
        found = dict(arrays(there))
        assert found and [name for name, array in found.items() if array.flags.writeable] == []
        assert (thing == there) in (True, False) and (thing != there) in (True, False)


def test_tuples_of_arrays_compare_by_what_they_hold():
    a = TURNED(0.5)
    assert a == pickle.loads(pickle.dumps(a)) and a == copy.deepcopy(a) and a != TURNED(0.6)._replace(twist=ONES)
