"""Whatever is given, the answer is an error of cdprlab's own on one line: arguments, world files, plans."""

import dataclasses
import pickle
import time
from pathlib import Path
from typing import Any

import faces
import matplotlib.pyplot as plt
import numpy as np
import pytest
import yaml

import cdprlab as cl
from cdprlab import fastkit
from cdprlab.arrays import LARGEST
from cdprlab.configurations.measured import compatible_configurations
from cdprlab.configurations.region import region
from cdprlab.configurations.sides import side_range
from cdprlab.errors import InvalidInput, NoConvergence, WorldError, quoted
from cdprlab.workspace.grids import low_discrepancy_poses
from cdprlab.world import Task

CAROCA = cl.load_world("caroca")
POINT = cl.load_world("point_mass")
GRID = cl.Pose([[0.0, 0.0, 1.0]])
W, W_E = cl.wrench_matrix(CAROCA.robot, CAROCA.pose), cl.gravity_wrench(CAROCA.robot, CAROCA.pose)
LENGTHS = cl.cable_lengths(CAROCA.robot, CAROCA.pose)
CABLE, PLATFORM = CAROCA.robot.cables[0], CAROCA.robot.platform
BASE = cl.load_world("planar_mcdpr").robot.bases[0]
HEAVY = dataclasses.replace(cl.load_world("planar_rigid").robot, linear_density=0.1, elasticity=cl.Elasticity(1e6))


def fields(part: Any) -> dict[str, Any]:
    return {field.name: getattr(part, field.name) for field in dataclasses.fields(part)}


SPREAD = cl.Pose([[0.1 * k, -0.1 * k**2, 1 + 0.1 * k] for k in range(6)])
GOOD: dict[str, dict[str, Any]] = {
    "Base": fields(BASE), "Cable": fields(CABLE), "Pulley": {"radius": 0.045, "axis": [0, 0, 1]},
    "Platform": fields(PLATFORM), "Robot": fields(CAROCA.robot),
    "World": fields(CAROCA), "Pose": {"position": [0, 0, 1], "rpy": [0, 0, 0]},
    "available_twist_set": {"robot": CAROCA.robot, "pose": CAROCA.pose, "moving": "all", "pivot": "base"},
    "available_wrench_set": {"robot": CAROCA.robot, "pose": CAROCA.pose, "tipping": False, "friction": None},
    "base_jacobian": {"robot": CAROCA.robot, "pose": CAROCA.pose, "pivot": "base"},
    "cable_directions": {"robot": CAROCA.robot, "pose": CAROCA.pose},
    "cable_lengths": {"robot": CAROCA.robot, "pose": CAROCA.pose},
    "cable_vectors": {"robot": CAROCA.robot, "pose": CAROCA.pose},
    "classify_configurations": {"robot": POINT.robot, "position": [0.5, 0.1, 1.0], "position_uncertainty": 0.05,
                                "exit_uncertainty": 0.02, "form": "corners"},
    "distribute_tensions": {"W": W, "w_e": W_E, "tension_min": 50.0, "tension_max": 1e4,
                            "method": "quadratic_program"},
    "equilibrium": {"robot": CAROCA.robot, "lengths": LENGTHS, "guess": CAROCA.pose},
    "forward_kinematics": {"robot": CAROCA.robot, "lengths": LENGTHS, "guess": CAROCA.pose, "tolerance": 1e-9},
    "gravity_wrench": {"robot": CAROCA.robot, "pose": CAROCA.pose},
    "hold": {"pose": CAROCA.pose, "duration": 1.0},
    "jacobian": {"robot": CAROCA.robot, "pose": CAROCA.pose},
    "load_world": {"name_or_path": "caroca"},
    "place_bases": {"robot": cl.load_world("planar_mcdpr").robot, "poses": cl.load_world("planar_mcdpr").pose,
                    "wrenches": [0.0, -9.81], "tipping": True, "margin": 0.0, "evaluations": 3},
    "plan_configurations": {"robot": POINT.robot, "start": [-1, 0.3, 1], "goal": [1, 0.3, 1], "method": "stability",
                            "position_uncertainty": 0.05, "exit_uncertainty": 0.02},
    "quintic": {"start": CAROCA.pose, "end": CAROCA.pose, "duration": 1.0, "start_twist": None,
                "end_acceleration": None},
    "resolve_twist": {"robot": CAROCA.robot, "pose": CAROCA.pose, "twist": np.zeros(6),
                      "pivot": "base"},
    "run": {"world": CAROCA, "task": "default", "method": "quadratic_program", "cables": "force", "controller": None,
            "dt": 1e-3, "control_period": None, "infeasible": "relax", "external_wrench": None, "duration": 2e-3,
            "cut": None, "winch": "real", "real": CAROCA, "sensors": None, "progress": None, "simulator": None},
    "open_simulator": {"world": POINT, "cables": "force", "dt": 1e-3},
    "compare_tensions": {"world": CAROCA, "task": "default", "methods": "kernel", "time_step": 1.0},
    "sagging_cable": {"span": [4.0, -1.0], "length": 4.3, "linear_density": 0.05, "axial_stiffness": 1e5,
                      "gravity": 9.81},
    "sagging_lengths": {"robot": HEAVY, "pose": cl.load_world("planar_rigid").pose, "tensions": np.full(4, 300.0)},
    "stiffness": {"robot": CAROCA.robot, "pose": CAROCA.pose, "tensions": np.full(8, 400.0), "axial_stiffness": 1e5},
    "tipping_moments": {"robot": CAROCA.robot, "pose": CAROCA.pose, "tensions": np.full(8, 400.0)},
    "tipping_rows": {"robot": CAROCA.robot, "pose": CAROCA.pose},
    "workspace": {"robot": CAROCA.robot, "poses": GRID, "criterion": cl.WrenchFeasible(), "margin": True,
                  "n_jobs": None, "chunk": 4096, "checkpoint": None, "progress": None},
    "wrench_matrix": {"robot": CAROCA.robot, "pose": CAROCA.pose},
    "LengthControl": {"kp": 100.0, "kd": [20.0, 30.0]},
    "Sensors": fields(cl.Sensors(rate=100.0)),
    "perturbed": {"world": CAROCA, "exit_points": 0.01, "anchor_points": 0.0, "mass": 0.1, "center_of_mass": 0.0,
                  "lengths": 0.01, "seed": 0},
    "repeat": {"world": POINT, "runs": 1, "task": "default", "errors": {"mass": 0.1}, "real": None, "sensors": None,
               "seed": 0, "n_jobs": None, "checkpoint": None, "progress": None, "duration": 2e-3},
    "plot": {"run_or_table": None},
    "calibrate": {"robot": POINT.robot, "poses": SPREAD, "lengths": cl.cable_lengths(POINT.robot, SPREAD),
                  "unknown": ("length_offsets",), "tensions": None, "length_noise": 1e-4},
    "calibration_poses": {"world": POINT, "count": 2, "seed": 0},
    "read_log": {"csv": "no_such.csv", "columns": None, "world": None},
}
"""Public name → arguments that it takes; each is in turn replaced by each of the bad ones."""

LEFT_OUT = {
    "made by functions, not by hand": {
        "Calibration", "Configuration", "ConfigurationSequence",
        "Judgement", "Polytope", "PoseGrid", "Reference", "Run",
        "Simulator", "State", "TensionComparison",
        "TensionDistribution", "Trajectory", "TwistResolution"},
    "of a run": {"identify_friction"},
    "judged with `workspace`, or flown": {
        "ComputedTorque", "Criterion", "DynamicEquilibrium", "InterferenceFree", "StaticEquilibrium",
        "StaticallyStable",
        "TippingSafe", "TorqueControl", "TwistFeasible", "VelocityControl", "WrenchClosure", "WrenchFeasible"},
    "without arguments, or no function": {"CdprError", "errors", "tension_methods", "world_names", "world_schema"},
}

BAD: list[Any] = [None, True, float("nan"), float("inf"), -1.0, 0, -3, 1e300, 10**400, "x", "x" * 5000, "", b"x", 1j,
                  [], [[]], [1, "x"], [None], {}, {"a": 1}, {1, 2}, object(), np.array([]), np.zeros((2, 7)),
                  np.nan * np.ones(6), np.array("x"), ["a", ["b"]], lambda *_: None, cl.Pose([0, 0]),
                  cl.Pose([[0, 0, 1]] * 2), POINT.robot, CAROCA, Path("no/such/folder/x.yaml"),
                  "no\0where.yaml", 2**70, 1.5, "1e3", slice(3), 1e-320, "\ud800", np.zeros((1,) * 40), [1e29] * 6,
                  np.ma.masked_array(np.ones(8), [1] * 8), (x for x in [1.0]), np.array([1, None], dtype=object)]

CALLS = [(name, key, k) for name, words in GOOD.items() for key in words for k in range(len(BAD))]


def test_every_public_name_is_called_with_bad_values_or_left_out_for_a_reason():
    assert set(cl.__all__) == set(GOOD) | set().union(*LEFT_OUT.values())


def call(name: str, key: str, k: int, folder: Path) -> str:
    """What is wrong with the answer to one bad value; '' if nothing is."""
    words = GOOD[name] | {key: BAD[k]}
    try:
        with np.errstate(all="ignore"):
            answer = getattr(cl, name)(**words)
        if isinstance(answer, cl.Simulator):
            answer.close()
    except cl.CdprError as error:
        short = len(str(error).splitlines()) <= 1 and len(str(error)) < 2000
        return "" if short else f"{name}({key}): {str(error)[:300]}"
    except Exception as error:
        return f"{name}({key}={quoted(BAD[k])}): {type(error).__name__}: {error}"
    return ""


@pytest.mark.filterwarnings("ignore")
def test_bad_values_raise_errors_of_our_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)
    chosen = np.random.default_rng(12).choice(len(CALLS), 500, replace=False)
    assert [wrong for i in chosen if (wrong := call(*CALLS[i], tmp_path))] == []


@pytest.mark.long
@pytest.mark.filterwarnings("ignore")
def test_all_bad_values_raise_errors_of_our_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)
    assert [wrong for one in CALLS if (wrong := call(*one, tmp_path))] == []


BRIEF = [None, True, np.nan, np.inf, -1.0, 1e300, 10**400, 2**70, "x", 1j, [], [[]], ["a"], ["a", ["b"]], {}, object(),
         np.zeros((2, 7)), np.ones((3, 3, 3)), [1e300] * 3, [1.0, np.nan, 0], cl.Pose([0, 0]), CAROCA,
         {"active": "x"}, (1, 2, 3), np.array([]), float, 0, "x" * 5000, "\ud800", 1e-320, range(3), -10**400,
         np.array([1, None], dtype=object), np.ma.masked_array(np.ones(6), [1] * 6), memoryview(b"a"),
         (x for x in [1.0])]


def spoiled(function: Any, words: dict[str, Any], key: str, bad: Any) -> str:
    """What is wrong with the answer of a function to one bad value; '' if nothing is."""
    try:
        with np.errstate(all="ignore"):
            function(**words | {key: bad})
    except cl.CdprError as error:
        return "" if len(str(error).splitlines()) <= 1 and len(str(error)) < 600 else str(error)[:300]
    except Exception as error:
        own = bad is float and "float expected" in str(error)   # a callable of the caller's: its error is kept
        return "" if own else f"{quoted(bad)}: {type(error).__name__}: {error}"
    finally:
        plt.close("all")
    return ""


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("face", [faces.library, faces.of_fastkit, faces.of_course])
@pytest.mark.parametrize("share", [0.02, pytest.param(1.0, marks=pytest.mark.long)])
def test_methods_and_wings_raise_errors_of_our_own(face: Any, share: float, tmp_path: Path,
                                                   monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)
    calls = [(name, *call, key, k) for name, call in face().items() for key in call[1] for k in range(len(BRIEF))]
    chosen = np.random.default_rng(12).choice(len(calls), round(share * len(calls)), replace=False)
    assert {(calls[i][0], calls[i][3]): wrong for i in chosen
            if (wrong := spoiled(*calls[i][1:4], BRIEF[calls[i][4]]))} == {}


def test_a_message_is_one_line_and_errors_travel_whole():
    assert quoted("x" * 5000) == quoted("x" * 6000) and len(quoted([10**5000] * 99)) <= 200
    with pytest.raises(InvalidInput, match="finite and at most"):
        cl.Pose([1e300, 0, 0])
    with pytest.raises(InvalidInput, match="at most 1e"):
        cl.hold(CAROCA.pose, LARGEST * 1e10)
    sent = NoConvergence("two\nlines", np.ones(3))
    got = pickle.loads(pickle.dumps(sent))
    assert str(got) == "two lines" and (got.residuals == 1).all()
    assert pickle.loads(pickle.dumps(WorldError(["a", "b"]))).problems == ("a", "b")


@pytest.mark.parametrize("name, options", [
    ("planar_rigid", {"solver_iterations": bad}) for bad in (0, -1, 1.5, "x", 10**9)] + [
    ("caroca", {"tip_mass": bad}) for bad in (0, -1.0, np.nan, np.inf, "x", 10**400)] + [("caroca", {"bodies": 5})])
def test_options_of_engines_are_checked(name: str, options: dict[str, Any]):
    with pytest.raises(InvalidInput, match=next(iter(options))):
        cl.open_simulator(cl.load_world(name), **options)


WALL = fastkit.Hall.of([[2, 0, 1, 1, 0]], [[-5, -5], [5, 5]])


def test_an_argument_too_many_is_not_left_out_in_silence():
    with pytest.raises(TypeError, match="positional"):
        fastkit.Scanner(0.0, 0.0, 0.0, 3.0, 1.0, 9, 0.01, 0.2, 5.0)
    with pytest.raises(TypeError, match="multiple values"):
        fastkit.Scanner(0.0, x=1.0)



@pytest.mark.parametrize("make", [
    lambda bad: cl.Winch(bad), lambda bad: cl.Winch(0.04, bad), lambda bad: cl.Winch(0.04, efficiency=3 + bad),
    lambda bad: cl.Winch(0.04, coulomb=bad), lambda bad: cl.Winch(0.04, torque=bad), lambda bad: cl.Elasticity(bad),
    lambda bad: cl.Elasticity(1e5, bad), lambda bad: cl.Scene(None, bad * np.inf, ()),
    lambda bad: cl.Scene([bad], 0.0, ()),
    lambda bad: cl.Box([0, 0], [1, bad]), lambda bad: cl.TorqueControl(toward=bad), lambda bad: cl.VelocityControl(bad),
    lambda bad: fastkit.Scanner(noise=bad),
    lambda bad: fastkit.Scanner(range=bad), lambda bad: fastkit.Scanner(beams=int(np.nan_to_num(bad))),
    lambda bad: fastkit.Odometry(per_turn=bad), lambda bad: fastkit.Walker([[0, 0], [1, 0]], bad),
    lambda bad: fastkit.Phase("a", "b", bad), lambda bad: fastkit.Machine((), (), bad),
    lambda bad: fastkit.OccupancyGrid.of(WALL, reach=bad), lambda bad: dataclasses.replace(WALL, sizes=[[bad]]),
    lambda bad: region([[0, 0, 3], [4, 0, 3], [0, 3, 3.0]], bad),
    lambda bad: side_range([0, 0], [1, 1], [0.2, 0.1], 0.0, bad, "corners"),
    lambda bad: compatible_configurations(POINT.robot, np.full(4, 2.0), bad),
    lambda bad: compatible_configurations(POINT.robot, np.full(4, 2.0), exit_uncertainty=bad),
    lambda bad: low_discrepancy_poses([0, 0], [1, 1], 5, turn=bad),
    lambda bad: dataclasses.replace(CAROCA.robot, gravity=bad), lambda bad: dataclasses.replace(CAROCA, document=bad)])
@pytest.mark.parametrize("bad", [-1.0, np.nan])
def test_what_must_not_be_negative_is_refused_where_it_is_given(make: Any, bad: float):
    with pytest.raises(InvalidInput):
        make(bad)


def test_infinity_is_a_limit_and_nothing_else():
    assert cl.Winch(0.04, torque=np.inf, speed=np.inf).tension_max == np.inf == cl.Elasticity(np.inf).axial_stiffness
    for give in (lambda: cl.Box([0, 0], [1, 1], np.inf), lambda: cl.Winch(np.inf),
                 lambda: cl.hold(CAROCA.pose, np.inf)):
        with pytest.raises(InvalidInput, match=r"at most 1e\+?30"):
            give()


def test_a_closed_simulator_says_so():
    simulator = cl.open_simulator(POINT)
    simulator.close()
    with pytest.raises(InvalidInput, match="closed"):
        simulator.step(np.ones(4))


# --- plans ----------------------------------------------------------------------------------------------
def ring(m: int) -> cl.Robot:
    angles = np.arange(m) * 2 * np.pi / m + np.pi / m
    cables = tuple(cl.Cable([3 * np.cos(a), 3 * np.sin(a), 3.0], [0, 0, 0], 1.0, 500.0) for a in angles)
    return dataclasses.replace(POINT.robot, cables=cables)


@pytest.mark.parametrize("m", [6, 8, 12])
@pytest.mark.parametrize("depth", [1.0, 2.97])
def test_a_plan_ends_whatever_is_uncertain_at_its_end(m: int, depth: float):
    began = time.process_time()
    plans = cl.plan_configurations(ring(m), [-0.5, 0.2, 1], [3 * np.cos(np.pi / m) - 0.02, 0.1, depth])
    assert plans and time.process_time() - began < 5   # 0.1 s; five leaves room for a busy machine
    assert len({len(plan.configurations) for plan in plans}) == 1


# --- world files ------------------------------------------------------------------------------------------
TEXT = cl.load_world("planar_point").to_yaml()
ODD = {
    "brackets": "a: " + "[" * 500 + "]" * 500, "nested": "\n".join(" " * i + "a:" for i in range(100)),
    "itself": "&a {name: *a}\n", "digits": TEXT.replace("mass:", "mass: " + "9" * 5000 + " #", 1),
    "date": TEXT.replace("title:", "title: 2001-99-99 #", 1), "tag": TEXT.replace("mass:", "mass: !!int zz #", 1),
    "aliases": "a: &a [x,x,x,x,x,x,x,x,x]\n" + "".join(
        f"{chr(98 + i)}: &{chr(98 + i)} [{','.join(['*' + chr(97 + i)] * 9)}]\n" for i in range(6)),
    "long": "# comment\n" * 200_000, "many": "a: [" + "1," * 300_000, "directive": "%YAML 1.3\n---\n" + TEXT,
    "tab": "\ta: 1", "nul": "a: \0b", "two": TEXT + "---\nb: 2\n", "set": "!!set {a, b}", "undefined": "a: *b",
    "cables": TEXT.replace("cables:", "cables:\n" + "  - {exit_point: [0, 1], anchor_point: [0, 0]}\n" * 201, 1),
    "alias": "a: *" + "b" * 5000, "words": TEXT.replace("title:", "title: " + "x " * 200_000 + " #", 1),
    "lines": TEXT + "".join(f"key{i}: 1\n" for i in range(5000)),
    "keys": TEXT + "".join(f"key{i}: 1\n" for i in range(2500)),
    "twice": "a: 1\na: 2\n", "binary": "!!binary zz", "open": "a: [1", "merge": "<<: 5\n", "list": "- 1\n",
}


@pytest.mark.parametrize("what", ODD)
def test_a_mistake_in_yaml_is_one_line_at_once(what: str):
    began = time.process_time()
    with pytest.raises(WorldError) as told:
        cl.World.from_yaml(ODD[what], path="theirs.yaml")
    assert "\n" not in str(told.value) and str(told.value).startswith("theirs.yaml") and len(str(told.value)) < 500
    assert time.process_time() - began < 2   # under half a second; the rest is for a busy machine


@pytest.mark.parametrize("value", ["2001-99-99", "2001-01-01T99:99:99", "9" * 5000, "!!int zz", "!!bool zz", "0x_",
                                   "1_"])
def test_what_python_cannot_make_a_value_of_is_told_with_its_line(value: str):
    with pytest.raises(WorldError, match=r"^theirs\.yaml:8: not valid YAML: .*( is no |9…)"):
        cl.World.from_yaml(TEXT.replace("mass:", f"mass: {value} #", 1), path="theirs.yaml")


def test_an_anchor_may_be_used_twice(recwarn: pytest.WarningsRecorder):
    with pytest.raises(WorldError, match="unknown key"):
        cl.World.from_yaml(TEXT + "extra: [&a 1, &a 2]\n")
    assert not recwarn.list


@pytest.mark.parametrize("name", ["x" * 5000, None, 5, "no/such.yaml", "a\0b.yaml"])
def test_worlds_that_cannot_be_read(name: Any):
    with pytest.raises(InvalidInput):
        cl.load_world(name)


@pytest.mark.parametrize("name", cl.world_names())
def test_what_is_saved_reads_the_same_in_yaml_1_1(name: str):
    world = dataclasses.replace(cl.load_world(name), name="no", title="1:30", source="2001-01-01")
    text = world.to_yaml()
    assert cl.World.from_dict(yaml.safe_load(text)).to_dict() == world.to_dict()


def test_numbers_are_written_for_both_readers():
    document = POINT.to_dict() | {"winch": {"drum_radius": 3e-5, "inertia": 1e20}}
    text = cl.World.from_dict(document).to_yaml()
    assert yaml.safe_load(text)["winch"] == document["winch"] and "3.0e-05" in text


@pytest.mark.parametrize("name", cl.world_names())
def test_tasks_and_scene_that_were_changed_are_saved(name: str):
    world = cl.load_world(name)
    tasks = {**world.tasks, "again": world.tasks["default"], "still": Task("hold", world.pose, world.pose, 3.0)}
    changed = dataclasses.replace(world, tasks=tasks,
                                  scene=dataclasses.replace(world.scene, floor_height=-0.25))
    back = cl.World.from_yaml(changed.to_yaml())
    assert set(back.tasks) == set(tasks) and back.scene.floor_height == -0.25
    assert len(back.scene.boxes) == len(world.scene.boxes)
    np.testing.assert_allclose(back.tasks["again"].end.position, world.tasks["default"].end.position)
    del tasks["again"]
    assert "again" not in cl.World.from_yaml(dataclasses.replace(back, tasks=tasks).to_yaml()).tasks


@pytest.mark.parametrize("words", [
    {"name": "two words"}, {"pose": cl.Pose([[0, 0, 1]])}, {"pose": cl.Pose([0, 0])}, {"tasks": {"x": 5}},
    {"tasks": 5}, {"robot": None}, {"title": 5},
    {"tasks": {"x": cl.load_world("fastkit_suspended").task("pick_and_place")}},
    {"tasks": {"x": Task("hold", cl.Pose([0, 0]), cl.Pose([0, 0]), 1.0)}}])
def test_a_changed_world_is_checked_like_a_file(words: dict[str, Any]):
    with pytest.raises(InvalidInput):
        dataclasses.replace(CAROCA, **words)


@pytest.mark.parametrize("words", [{"box_mass": -1.0}, {"box_mass": "x"}, {"place": [0, 1]}, {"stroke": np.zeros(3)},
                                   {"seat": [np.nan] * 3}, {"coupled": {"nobody": (0, 0, 0)}}])
def test_a_changed_job_is_checked_like_a_file(words: dict[str, Any]):
    world = cl.load_world("fastkit_suspended")
    with pytest.raises(InvalidInput):
        dataclasses.replace(world, tasks={"x": dataclasses.replace(world.task("pick_and_place"), **words)})


def test_keys_that_a_run_takes_no_notice_of():
    fastkit = cl.load_world("fastkit_suspended")
    assert fastkit.idle_keys()[:2] == ("cable", "speed") and "cable" not in fastkit.idle_keys("elastic")
    assert CAROCA.idle_keys() == ("speed",) and CAROCA.idle_keys("length") == ("tension",)


def mutated(text: str, rng: np.random.Generator) -> str:
    """A world file with a few characters, words or lines changed, doubled, swapped or gone."""
    odd = ["", "~", "[", "{", ":", "- ", "&a ", "*a", "!!int ", "1e999", "-1", "nan", ".inf", "0x", "1_0", "'", '"',
           "\t", "yes", "2001-01-01", "1:30", "<<: ", "é", "\0", "5.0e4", "[]", "{}", "1e300", "010", "# ", "\n",
           "|", ">", "%", "@"]
    for _ in range(rng.integers(1, 4)):
        a, b = sorted(rng.integers(0, len(text) + 1, 2))
        b = min(b, a + int(rng.integers(0, 12)))
        text = text[:a] + str(rng.choice(odd)) * int(rng.integers(1, 3)) + text[b:]
    return text


def mutations(count: int) -> tuple[int, list[str]]:
    """How many of mutated worlds are taken, and what went wrong."""
    rng, texts, taken, wrong = np.random.default_rng(7), [cl.load_world(n).to_yaml() for n in cl.world_names()], 0, []
    for k in range(count):
        text = mutated(texts[k % len(texts)], rng)
        try:
            world = cl.World.from_yaml(text)
            taken += 1
            again = cl.World.from_yaml(world.to_yaml())
            if again.to_dict() != world.to_dict():
                wrong.append(f"another world: {text}")
        except WorldError as error:
            if "\n" in str(error):
                wrong.append(str(error))
        except Exception as error:
            wrong.append(f"{type(error).__name__}: {str(error)[:200]}\n{text}")
    return taken, wrong


def test_mutated_worlds_are_refused_or_saved_the_same():
    taken, wrong = mutations(300)
    assert taken > 30 and wrong == []


@pytest.mark.long
def test_many_mutated_worlds_are_refused_or_saved_the_same():
    assert mutations(10_000)[1] == []


@pytest.mark.parametrize("seed", [-1, 1.5, True, 2**70])
def test_what_random_numbers_start_from_is_a_whole_number(seed):
    world = cl.load_world("planar_rigid")
    for ask in (lambda: cl.run(world, duration=0.01, seed=seed),
                lambda: low_discrepancy_poses([0, 0], [1, 1], 5, seed)):
        with pytest.raises(cl.CdprError, match="seed must be a whole number"):
            ask()
