"""The compiled room: what it says while it compiles, and that it answers the same where there is no numba."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest

from cdprlab.arrays import plain
from cdprlab.compiled import CENTROID, EMPTY, FOUND, NOTHING
from cdprlab.compiled.polygon import polygons

QUESTIONS = """
import json, sys
{first}
import numpy as np
import cdprlab as cl

world = cl.load_world("caroca_light")
robot = world.robot
poses = cl.Pose([[0, 0, 1.0], [1, 0.5, 2.0], [2.9, 1.7, 0.4]], rpy=[0.1, -0.05, 0.15])
W, w_e = cl.wrench_matrix(robot, poses), cl.gravity_wrench(robot, poses)
answers = {{}}
for method in cl.tension_methods():
    found = cl.distribute_tensions(W, w_e, robot.tension_min, robot.tension_max, method)
    answers[method] = [found.tensions.tolist(), found.feasible.tolist()]
for by, half in (("tensions", None), ("facets", [5.0] * 6)):
    inside, margin = cl.workspace(robot, poses, cl.WrenchFeasible(half_widths=half, by=by))
    answers[by] = [inside.tolist(), margin.tolist()]
run = cl.run(world, duration=0.02)
answers["run"] = [run.commanded_tensions.tolist(), run.errors.tolist()]
print(json.dumps([answers, sys.modules.get("numba") is not None]))
"""


def ask(*arguments):
    return subprocess.run([sys.executable, *arguments], capture_output=True, text=True, timeout=300, check=True)


def test_without_numba_the_same_functions_answer_the_same():
    told = [json.loads(ask("-c", QUESTIONS.format(first=first)).stdout.splitlines()[-1])
            for first in ("", "sys.modules['numba'] = None")]
    (compiled, with_numba), (plain, without) = told
    assert with_numba and not without
    for name, answer in compiled.items():
        for one, other in zip(answer, plain[name]):
            assert pytest.approx(numbers(one), rel=1e-7, abs=1e-7, nan_ok=True) == numbers(other), name


def numbers(nested):
    return [x for item in nested for x in numbers(item)] if isinstance(nested, list) else [nested]


def test_the_room_compiles_by_name_and_nobody_waits_afterwards():
    assert ask("-m", "cdprlab.compiled").returncode == 0
    again = ask("-m", "cdprlab.compiled")
    assert again.stdout == again.stderr == ""


@pytest.mark.parametrize("notebook, stream", [(False, "stderr"), (True, "stdout")])
def test_who_waits_for_the_compiler_is_told_once(tmp_path, notebook, stream):
    asked = f"""
import os, sys
os.environ["NUMBA_CACHE_DIR"] = {str(tmp_path)!r}
if {notebook}:
    sys.modules["ipykernel"] = sys
from cdprlab.compiled.jit import compiled_for

def half(x):
    return x / 2
def third(x):
    return x / 3
half.__module__ = third.__module__ = "cdprlab.compiled.halves"
assert compiled_for(0)(half)(3.0) == 1.5 and compiled_for(0)(third)(3.0) == 1.0
"""
    (tmp_path / "asked.py").write_text(asked, encoding="utf-8")
    told = ask(str(tmp_path / "asked.py"))
    assert getattr(told, stream) == "cdprlab compiles its numerical core, once …\n"
    assert len(told.stdout + told.stderr) == len(getattr(told, stream))


def test_in_a_fresh_install_few_poses_are_answered_before_anything_is_compiled(tmp_path):
    asked = f"""
import os
os.environ["NUMBA_CACHE_DIR"] = {str(tmp_path)!r}
import cdprlab as cl

world = cl.load_world("caroca")
robot = world.robot

def barycenters(count):
    poses = cl.Pose([[0, 0, 1.0]] * count)
    W, w_e = cl.wrench_matrix(robot, poses), cl.gravity_wrench(robot, poses)
    return cl.distribute_tensions(W, w_e, robot.tension_min, robot.tension_max, "barycenter").tensions[0]

def kept():
    return [file for _, _, files in os.walk({str(tmp_path)!r}) for file in files if "polygons" in file]

few = barycenters(1)
assert not kept()
many = barycenters(100)
assert kept() and abs(few - many).max() < 1e-9
"""
    ask("-c", asked)


def test_a_closed_error_stream_does_not_end_the_work(tmp_path):
    told = subprocess.run(
        ["sh", "-c", f'"{sys.executable}" -c "import cdprlab as cl; w = cl.load_world(\'caroca\'); '
                     'print(cl.wrench_matrix(w.robot, w.pose).shape)" 2>&-'],
        env={**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}, capture_output=True, text=True, timeout=300, check=False)
    assert (told.returncode, told.stdout) == (0, "(6, 8)\n")


@pytest.mark.parametrize("n, m", [(2, 3), (2, 4), (6, 7), (6, 8)])
def test_a_verdict_without_a_point_is_that_with_one_at_the_very_border_too(n, m):
    """Wrenches that only one corner of the limits' box balances, and some nudged out."""
    rng = np.random.default_rng(10 * n + m)
    W, normals = rng.normal(size=(2000, n, m)), rng.normal(size=(2000, n, 1))
    outermost = np.where((W * normals).sum(axis=1) > 0, 900.0, 10.0)
    out = normals[..., 0] * rng.choice([0, 1e-12, 3e-8, 1e-6, 1e-4], (2000, 1))
    problem = [plain(part) for part in (W, -np.einsum("kij,kj->ki", W, outermost) - out, np.full((1, m), 10.0),
                                        np.full((1, m), 900.0))]
    verdicts, found = polygons(*problem, NOTHING)[1], polygons(*problem, CENTROID)[1]
    assert set(found) == {FOUND, EMPTY}
    np.testing.assert_array_equal(verdicts, found)
    assert (found[(out == 0).all(axis=1)] == FOUND).all()
