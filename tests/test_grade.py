"""`python -m cdprlab grade`: right answers earn their points, attacks earn and change nothing, each file is a status.

What runs here runs with the jail of this machine; where none can be, the split alone is tried, without one.
"""

from __future__ import annotations

import contextlib
import copy
import csv
import io
import json
import os
import random
import runpy
import subprocess
import sys
import zipfile
from dataclasses import replace
from datetime import datetime, timedelta
from pathlib import Path
from typing import Any

import notebook_class as tiny
import notebooks
import pytest

from cdprlab.cli.main import main
from cdprlab.course import seed
from cdprlab.course.grading import Grader, Result, Submission, jail, late, read_submissions, write_reports
from cdprlab.course.grading.cells import code_cells
from cdprlab.course.grading.jail import find_jail
from cdprlab.course.grading.judge import Outcome
from cdprlab.errors import InvalidInput

NOW = datetime(2026, 11, 30, 12)


def _jail() -> str:
    try:
        return find_jail()[0]
    except InvalidInput as error:
        return f"none: {str(error)[:60]}"


JAIL = _jail()
jailed = pytest.mark.skipif(JAIL.startswith("none"), reason=f"no jail on this machine ({JAIL})")


def submission(student: str, notebook: Any, name: str = tiny.LESSON, when: datetime = NOW) -> Submission:
    data = notebook if isinstance(notebook, bytes) else json.dumps(notebook).encode()
    return Submission(student, name, when, lambda: io.BytesIO(data))


def pick(result: Result, check: str) -> Any:
    return next(outcome for outcome in result.outcomes if outcome.check == check)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("course")


@pytest.fixture(scope="module")
def grader(folder: Path) -> Grader:
    return Grader(tiny.write_source(folder), folder / "out", trust=True, seconds=20 + 4 * os.getloadavg()[0])


# --- attacks: what is handed in, and what it deserves ---------------------------------------------
RIGHT = tiny.solved()
ALWAYS_EQUAL = """
class Yes(float):
    __eq__ = __le__ = __ge__ = __lt__ = __gt__ = lambda s, o: True
    __ne__ = lambda s, o: False
    __hash__ = float.__hash__
    shape = (2,)
    def __iter__(s): return iter((Yes(7), Yes(5)))
    def __array__(s, *a, **k): return np.zeros(2).view(YesArray)
class YesArray(np.ndarray):
    __eq__ = __ne__ = __le__ = __ge__ = lambda s, o: True
double = said = applied = lambda *a: Yes(1)
"""
ALL_ALIKE = dict.fromkeys(tiny.EXERCISES, ALWAYS_EQUAL)
PATCHED = """
import numpy as np, numpy.testing, builtins, sys
for name in ("allclose", "isclose", "all", "array_equal"): setattr(np, name, lambda *a, **k: True)
for name in dir(np.testing):
    if name.startswith("assert"): setattr(np.testing, name, lambda *a, **k: None)
builtins.AssertionError = type("Quiet", (Exception,), {"__init__": lambda *a: None})
"""
SHELL = """
import ast
class NoAssert(ast.NodeTransformer):
    def visit_Assert(self, node): return ast.Pass()
ip = get_ipython()
ip.ast_transformers.append(NoAssert())
ip.input_transformers_cleanup.append(lambda lines: ["pass\\n"])
ip.run_cell = lambda *a, **k: None
"""
WIRE = """
import os, struct, json, threading
word = json.dumps({"value": {"tuple": [7, 5]}}).encode()
def shout():
    for fd in range(3, 40):
        try: os.write(fd, struct.pack(">Q", len(word)) + word)
        except OSError: pass
"""
OUTSIDE = '''
import glob, os, socket, subprocess, sys
def attempt(what, action):
    """What an attack got hold of."""
    try:
        found = action()
        return f"{what}: {found!r} " if found else ""
    except Exception: return ""
def look_around():
    def parent(): return open(f"/proc/{os.getppid()}/environ").read().count("CDPRLAB_SEED")
    def memory():
        maps = open(f"/proc/{os.getppid()}/maps").readline()
        with open(f"/proc/{os.getppid()}/mem", "rb") as file:
            file.seek(int(maps.split("-")[0], 16)); return file.read(8)
    def network():
        s = socket.create_connection(("127.0.0.1", PORT), 2); s.sendall(b"stolen"); return "sent"
    def route():
        u = socket.socket(socket.AF_INET, socket.SOCK_DGRAM); u.connect(("192.0.2.1", 9)); return u.getsockname()
    seen = attempt("parent", parent) + attempt("memory", memory) + attempt("network", network) + attempt("route", route)
    seen += attempt("course", lambda: os.listdir(COURSE))
    seen += attempt("secret", lambda: open(COURSE + "/out/secret.txt").read())
    seen += attempt("write", lambda: open(COURSE + "/out/grades.csv", "a").write("x"))
    seen += attempt("sources", lambda: glob.glob(CHECKOUT + "/lessons/source/*"))
    seen += attempt("tests", lambda: glob.glob(CHECKOUT + "/tests/*"))
    seen += attempt("package", lambda: open(CHECKOUT + "/cdprlab/planted.py", "w").write("x"))
    seen += attempt("home", lambda: [p for p in ("/home", "/etc/passwd", "/etc/shadow", "/root/.bashrc", "/var")
                                     if os.path.exists(p)])
    seen += attempt("variables", lambda: [k for k in os.environ if "SECRET" in k or "CDPRLAB_SEED" in k])
    seen += attempt("processes", lambda: len([p for p in os.listdir("/proc") if p.isdigit()]) > 6)
    seen += attempt("root", lambda: os.getuid() == 0)
    seen += attempt("kill", lambda: os.kill(os.getppid(), 0) or (os.getppid() > 2 and "other"))
    seen += attempt("startup", lambda: os.path.exists("/tmp/.ipython/profile_default/startup/00-help.py"))
    os.makedirs("/tmp/.ipython/profile_default/startup", exist_ok=True)
    open("/tmp/.ipython/profile_default/startup/00-help.py", "w").write("raise SystemExit")
    return seen or "saw nothing"
def said(word): return look_around()
'''
ATTACKS: dict[str, dict[str, Any]] = {
    "always equal": tiny.handed_in(own="import numpy as np", **ALL_ALIKE),
    "numpy and builtins patched": tiny.handed_in(own=PATCHED, **dict.fromkeys(tiny.EXERCISES, (
        "def double(x): return np.ones(2)\ndef said(w): return 'no'\ndef applied(f, x): return (0, 0)"))),
    "the shell's own machinery": tiny.handed_in(own=SHELL),
    "forged messages": tiny.handed_in(own=WIRE, double="def double(x): shout(); shout(); return np.ones(2)",
                                      said="def said(w): shout(); return 'no'"),
    "noise on every descriptor": tiny.handed_in(
        double="import os\ndef double(x):\n    for fd in range(3, 40):\n        try: os.write(fd, b'\\xff' * 4096)\n"
               "        except OSError: pass\n    return x"),
    "partial credit": tiny.handed_in(double="def double(x): get_ipython().displayhook(2.0); raise NotImplementedError",
                                     said="def said(w): get_ipython().displayhook(1000.0); raise ValueError"),
    "exits": tiny.handed_in(double="import os\ndef double(x): os._exit(0)", said="def said(w): raise SystemExit(0)",
                            applied="class Quiet(BaseException): pass\ndef applied(f, x): raise Quiet"),
    "kills": tiny.handed_in(double="import os\ndef double(x): os.kill(os.getppid(), 9); os.kill(-1, 9); return x"),
    "lies about sizes": tiny.handed_in(own=(
        "import base64, io, numpy as np\nfrom cdprlab.course.answers import plain\n"
        "head = io.BytesIO(); np.lib.format.write_array_header_1_0(head, "
        "{'descr': '<f8', 'fortran_order': False, 'shape': (10**12,)})\n"
        "plain._npy = lambda array: base64.b64encode(head.getvalue()).decode()"), double=RIGHT["double"]),
    "not what it is called": tiny.handed_in(
        double="class Robot: pass\ndef double(x):\n    r = Robot(); r.cables = 'x'; return r",
        said="class Cable:\n    def __reduce__(self): return print, ('ran',)\ndef said(w): return Cable()"),
    "callbacks abused": tiny.handed_in(applied=(
        "import gc\ndef applied(f, x):\n    import cdprlab.course.grading.worker as w\n"
        "    me = next(o for o in gc.get_objects() if type(o).__name__ == 'Worker')\n    got = []\n"
        "    for key in (-1, 99, '__import__', 0.5):\n        try: got.append(me.call_back(key, ('os',), {}))\n"
        "        except Exception as error: got.append(str(error))\n    return got, f(*range(1000))")),
    "checks looked for": tiny.handed_in(said=(
        "import gc\ndef said(w):\n    return str([o for o in gc.get_objects() if 'swordfish' in repr(o)[:10000]"
        " and 'gc.get' not in repr(o)])[:50] + ('swordfish' if 'loud' in globals() else '')")),
    "everything deleted": {**tiny.lesson(), "cells": [tiny.code("print(9)")]},
    "its own checks": tiny.handed_in(late="double = said = applied = None\nprint('Exercise 1 is right.')"),
    "worlds that are none": tiny.handed_in(double=(
        "import cdprlab as cl\nclass W(cl.World):\n    def __init__(s): pass\n"
        "    def to_dict(s): return {'name': ['x'] * 9}\n"
        "def double(x): return W()")),
    "answers that stop loops": tiny.handed_in(
        double="class End(StopIteration): pass\ndef double(x): raise End",
        said="def said(w): raise StopIteration", applied="def applied(f, x): raise StopAsyncIteration"),
    "arguments changed until they fit": tiny.handed_in(
        double="def double(x):\n    if x[0] != 1: x[:] = 0\n    return 2 * x"),
    "nothing and no number": tiny.handed_in(
        double="def double(x): return np.full(2, np.nan)", said="def said(w): return w and []",
        applied="def applied(f, x): return float('nan'), 10**6000"),
    "other classes' names": tiny.handed_in(own=(
        "import cdprlab as cl\nclass Liar:\n    __class__ = property(lambda s: s.kind)\n"
        "    def __init__(s, kind): s.kind = kind\n    def __getattr__(s, name): return s\n"
        "    def __call__(s, *a, **k): return s\n    def __iter__(s): return iter((7, 5))\n"
        "    def __float__(s): return 7.0\n    def __index__(s): return 7"),
        double="def double(x): return Liar(np.ndarray)", said="def said(w): return Liar(str)",
        applied="def applied(f, x): return Liar(cl.Pose)"),
    "pickles in arrays": tiny.handed_in(own=(
        "import base64, io, numpy as np\nfrom cdprlab.course.answers import plain\n"
        "class Boom:\n    def __reduce__(s): return exec, ('import os; os._exit(0)',)\n"
        "def _npy(array):\n    file = io.BytesIO()\n"
        "    np.save(file, np.array([Boom()], object), allow_pickle=True)\n"
        "    return base64.b64encode(file.getvalue()).decode()\nplain._npy = _npy"),
        double="def double(x): return np.ones(2)", said="def said(w): return np.ones(1)",
        applied="def applied(f, x): return np.ones(2)"),
    "an odd order of things": tiny.handed_in(own=(
        "import base64, io, numpy as np\nfrom cdprlab.course.answers import plain\n"
        "head = io.BytesIO()\nnp.lib.format.write_array_header_1_0(head, "
        "{'descr': [('a', '<f8')], 'fortran_order': True, 'shape': (0, 10**15)})\n"
        "plain._npy = lambda array: base64.b64encode(head.getvalue()).decode()"),
        double="def double(x): return np.ones(2)", applied="def applied(f, x): return np.ones(2)"),
    "callbacks called late": tiny.handed_in(
        applied="def applied(f, x):\n    global kept\n    kept = f\n    return lambda *a: f(f(x)), x",
        said="def said(w):\n    import threading\n    threading.Timer(0.01, lambda: kept(w)).start()\n"
             "    try: return kept(kept(w))\n    except NameError: return w"),
    "endless and enormous": tiny.handed_in(
        double="def double(x):\n    while True: yield 2.0", said="def said(w): return {w: {w: ('x' * 10**7,) * 9}}",
        applied="def applied(f, x):\n    loop = []\n    loop.append(loop)\n    return loop, x"),
    "what happens at the end": tiny.handed_in(own=(
        "import atexit, os, sys, time\natexit.register(lambda: time.sleep(999))\n"
        "class Never:\n    def __del__(s): time.sleep(999)\nnever = Never()\n"
        "sys.stderr.write('x' * 10**7)\nos.write(2, b'y' * 10**7)\nsys.stdout.close(); os.close(1)"),
        said="def said(w):\n    sys.settrace(None); sys.setrecursionlimit(10**9)\n    return said(w)"),
    "hung up": tiny.handed_in(
        double="import os\ndef double(x):\n    for fd in range(3, 40):\n        try: os.close(fd)\n"
               "        except OSError: pass\n    return 2 * x", said="def said(w): return w"),
    "text that breaks parsers": tiny.handed_in(own="(" * 10**5 + "-" * 10**5, late="x = 1\n" * 10**6,
                                              double="\ufeff%%time\n\udcff = 1", said="def said(w): return '\udcff'"),
    "depth": tiny.handed_in(double="def double(x):\n    for _ in range(5000): x = [x]\n    return x",
                            said="def said(w): return 'x' * 10**8"),
}
TAMPERED = {
    "thousand points": {"points": 1000, "locked": False}, "negative points": {"points": -9},
    "odd metadata": {"points": "NaN", "grade": "yes", "schema_version": 0},
}


SAMPLE = ("always equal", "the shell's own machinery", "forged messages", "exits", "checks looked for",
          "answers that stop loops", "arguments changed until they fit", "twins and bonus")
"""Of the attacks; the others are for `make long`."""


def all_attacks() -> dict[str, Any]:
    """Name → notebook, with those that change metadata."""
    found = dict(ATTACKS)
    for name, change in TAMPERED.items():
        found[name] = tiny.handed_in()
        tiny.at(found[name], "double-check")["metadata"]["nbgrader"].update(change)
        tiny.at(found[name], "double-check")["source"] = "pass"
    found["twins and bonus"] = tiny.handed_in()
    found["twins and bonus"]["cells"] += [tiny.code("pass", grade_id="double-check", grade=True, points=50),
                                          tiny.code("pass", grade_id="bonus-check", grade=True, points=50)]
    return found


def attack_table() -> str:
    """What the instructors' page says was tried."""
    return "\n".join(["| tried by students' cells and answers | earns |", "|---|---|",
                      *(f"| {name} | 0 |" for name in all_attacks())])


def assert_nothing_earned(result: Result) -> None:
    assert result.points == 0 and result.max_points == sum(tiny.POINTS.values()), result
    assert [outcome.check for outcome in result.outcomes] == list(tiny.POINTS)


@pytest.fixture(scope="module")
def attacked(grader: Grader) -> dict[str, Result]:
    """Some attacks and an honest student, in one batch."""
    batch = [submission(name, notebook) for name, notebook in all_attacks().items() if name in SAMPLE]
    batch.append(submission("honest", tiny.handed_in(**RIGHT)))
    return {result.student: result for result in grader.grade(batch, jobs=2)}


@pytest.mark.parametrize("attack", SAMPLE)
def test_attacks_earn_nothing(attacked: dict[str, Result], attack: str):
    assert_nothing_earned(attacked[attack])


@jailed   # some end every process that they may
@pytest.mark.long
def test_no_attack_earns_anything(grader: Grader):
    for result in grader.grade([submission(name, notebook) for name, notebook in all_attacks().items()], jobs=2):
        assert_nothing_earned(result)


def test_who_comes_after_them_is_graded_as_ever(attacked: dict[str, Result]):
    assert attacked["honest"].points == 9 and attacked["honest"].status == "graded"
    assert attacked["exits"].status == "stopped"


def test_nobody_reads_a_check(attacked: dict[str, Result]):
    assert not any(tiny.SECRET in outcome.message for outcome in attacked["checks looked for"].outcomes)


@jailed
def test_the_jail_holds(grader: Grader, folder: Path):
    import socket

    with socket.create_server(("127.0.0.1", 0)) as server:
        places = (f"PORT, COURSE, CHECKOUT = {server.getsockname()[1]}, {str(folder)!r}, {str(notebooks.CHECKOUT)!r}\n")
        spies = [submission(name, tiny.handed_in(said=places + OUTSIDE)) for name in ("spy", "next spy")]
        for result in grader.grade(spies, jobs=1):
            assert "you say saw nothing" in pick(result, "said-check").message
        server.settimeout(0.1)
        with pytest.raises(TimeoutError):
            server.accept()


@jailed
def test_no_child_outlives_and_no_bomb_goes_off(grader: Grader):
    mark = f"sleeper{os.getpid()}"
    double = ("import os, subprocess, sys\ndef double(x):\n"
              "    if os.fork() == 0:\n        os.setsid()\n"
              f"        os.execv(sys.executable, [sys.executable, '-c', 'import time; time.sleep(99)', '{mark}'])\n"
              "    return x")
    said = ("import os, signal\ndef said(w):\n    n = 0\n    try:\n        while n < 500:\n"
            "            if os.fork() == 0: signal.pause()\n"
            "            n += 1\n    except OSError: return f'{n} processes'\n    return 'no limit'")
    applied = ("def applied(f, x):\n    n = 0\n    try:\n        for name in range(99):\n"
               "            with open(f'/tmp/{name}', 'wb') as file: n += file.write(bytes(2**24))\n"
               "    except OSError: return f'{n >> 20} MB', 0\n    return 'no limit', 0")
    (result,) = grader.grade([submission("bombs", tiny.handed_in(double=double, said=said, applied=applied))])
    assert result.points == 0 and "no limit" not in "".join(outcome.message for outcome in result.outcomes)
    assert "processes" in pick(result, "said-check").message and " MB" in pick(result, "applied-check").message
    left = subprocess.run(["ps", "-eo", "args"], capture_output=True, text=True).stdout
    assert mark not in left


def test_endless_and_greedy_answers_cost_their_own_exercise(grader: Grader):
    quick = copy.copy(grader)
    quick.seconds = 5 + 2 * os.getloadavg()[0]   # an idle machine needs less than one
    stubborn = ("import signal\nfor s in (2, 14, 15): signal.signal(s, signal.SIG_IGN)\n"
                "def double(x):\n    while True: pass")
    greedy = "import numpy as np\ndef said(w): return np.ones(2**29)"
    (result,) = quick.grade([submission("endless", tiny.handed_in(**{**RIGHT, "double": stubborn, "said": greedy}))])
    assert [outcome.status for outcome in result.outcomes] == ["timed out", "out of memory", "graded"], result
    assert (result.status, result.points) == ("out of memory", 4)


# --- honest students ------------------------------------------------------------------------------
def test_what_costs_nothing(grader: Grader):
    double = ("%matplotlib inline\nimport sys\ndef double(x):\n    np.float64(1.0) / np.float64(0.0)\n"
              "    print('!', file=sys.stderr)\n    return factor * np.asarray(x)")
    noisy = tiny.handed_in(own="import warnings\nwarnings.warn('so what')\nprint('x' * 10**6)\n1 / 0",
                           late="import turtle_x", **{**RIGHT, "double": double})
    noisy["metadata"] = {"kernelspec": {"name": "ir", "language": "R"}}
    noisy["cells"][0]["outputs"] = [{"output_type": "stream", "text": "y" * 10**6}]
    noisy["cells"].append({**tiny.at(tiny.handed_in(), "said-answer")})   # an untouched copy, at the end
    bare = tiny.handed_in(**RIGHT)
    bare["cells"] = [tiny.at(bare, f"{name}-answer") for name in RIGHT]
    changed = tiny.handed_in(own="factor = 3.0\ndef helper(v): return factor * np.asarray(v, float)",
                             **{**RIGHT, "double": "def double(x): return helper(x)",
                                "applied": "def applied(f, x): return f(x)"})
    changed["cells"].insert(7, tiny.at(tiny.handed_in(**RIGHT), "applied-answer"))
    for result in grader.grade([submission("noisy", b"\xef\xbb\xbf" + json.dumps(noisy).encode()),
                                submission("bare", json.dumps(bare).encode("utf-16")),
                                submission("own factor", changed)], jobs=2):
        assert (result.points, result.status) == (9, "graded"), result


@pytest.mark.long
def test_a_slow_cell_of_ones_own_costs_itself(grader: Grader):
    slow = tiny.handed_in(own="import time\nwhile True: time.sleep(1)", **RIGHT)
    (result,) = grader.grade([submission("slow", slow)])
    assert result.points == 9


def test_an_answer_may_not_simply_call_what_it_shall_write(folder: Path):
    notebook = tiny.lesson()
    for name in RIGHT:
        tiny.at(notebook, f"{name}-answer")["metadata"]["tags"] = ["without world_names", "without tension_methods"]
    place = folder / "forbidding" / tiny.LESSON
    place.mkdir(parents=True)
    (place / f"{tiny.LESSON}.ipynb").write_text(json.dumps(notebook))
    strict = Grader(folder / "forbidding", folder / "forbidden", trust=True)
    (result,) = strict.grade([submission("ada", tiny.handed_in(
        own="import cdprlab as cl\nfrom cdprlab import course\nmine = [getattr(cl, 'world' + '_names')]",
        double="def double(x):\n    'Not cl.world_names'\n    cl.tension_methods\n    return 2 * x",
        said="def said(w):\n    mine[0]()\n    return w + '!'",
        applied="def applied(f, x):\n    try: course.fallback('01_cable-vectors')\n"
                "    except RuntimeError as error: return str(error), x"))])
    assert [outcome.points for outcome in result.outcomes] == [2, 0, 0], result
    assert "world_names yourself" in pick(result, "said-check").message
    assert "answers no exercise" in pick(result, "applied-check").message


# --- files and statuses -----------------------------------------------------------------------------
def test_every_file_is_a_status(grader: Grader, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(Grader, "run", instead_of_a_run)
    whole = tiny.handed_in(**RIGHT)
    odd = json.loads(json.dumps(whole))
    tiny.at(odd, "said-check")["metadata"]["nbgrader"]["checksum"] = {}
    tiny.at(odd, "double-check")["metadata"] = {"nbgrader": 7, "tags": {}}
    odd["cells"] += [1, None, {"source": {}}, {"cell_type": "code"}, {"cell_type": "code", "metadata": [], "source": 3},
                     tiny.code("\udcff", grade_id=["x"], grade=True, points=10**400), {**tiny.code("x"), "id": []}]
    text = json.dumps(whole).encode()
    broken = {"cut off": text[:500], "list": b"[]", "empty": b"", "nested": b"[" * 10**6, "number": b'{"cells": 3}',
              "huge": b" " * (64 * 2**20 + 1), "digits": b'{"cells": [' + b"1" * 10**4 + b"]}",
              "version 3": b'{"nbformat": 3, "worksheets": [{"cells": []}]}', "text": b'"cells"', "none": b"null"}
    files = broken | {"latin": json.dumps(tiny.handed_in(own="# Größe", **RIGHT), ensure_ascii=False).encode("latin-1"),
                      "nul": text + b"\0\0", "odd cells": json.dumps(odd).encode(),
                      "not a number": text.replace(b": 2", b": NaN")}
    results = {result.student: result
               for result in grader.grade([submission(name, data) for name, data in files.items()])}
    for name in broken:
        assert (results[name].status, results[name].points, results[name].max_points) == ("broken file", 0, 9), name
    statuses = {name: results[name].status for name in files if name not in broken}
    assert statuses == {"latin": "broken file", "nul": "broken file", "odd cells": "graded", "not a number": "graded"}
    (other,) = grader.grade([submission("eve", {"cells": [tiny.code("1")]}, "")])
    assert other.status == "no such lesson"
    (found,) = grader.grade([submission("eve", whole, "homework")])   # by its cells
    assert found.lesson == tiny.LESSON


def instead_of_a_run(self: Grader, lesson: Any, *_: Any) -> list[Outcome]:
    """What a judge might say, at once."""
    return [Outcome(check.grade_id, check.points, check.points) for check in lesson.checks]


def counting(ran: list[str]) -> Any:
    """The same, and it writes down whose."""
    return lambda self, lesson, cells, student: ran.append(student) or instead_of_a_run(self, lesson)


def test_of_two_files_for_one_lesson_the_later_counts(grader: Grader, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(Grader, "run", instead_of_a_run)
    early, broken = submission("gus", tiny.handed_in(), ""), submission("gus", b"", when=NOW + timedelta(1))
    for batch in ([early, broken], [broken, early]):
        (result,) = grader.grade(batch)
        assert result.status == "broken file"
        assert json.loads(grader.place(result).read_text(encoding="utf-8"))["status"] == "broken file"


def test_late_missing_and_reports(grader: Grader, folder: Path, monkeypatch: pytest.MonkeyPatch):
    def run(self: Grader, lesson: Any, cells: Any, student: str) -> list[Outcome]:
        first, *others = instead_of_a_run(self, lesson)
        said = "you say <script>boo</script>"
        return [replace(first, points=0.0, message=said, hint=said) if "script" in student else first, *others]

    monkeypatch.setattr(Grader, "run", run)
    batch = [submission("ada", tiny.handed_in()), submission("<script>alert(1)</script>", tiny.handed_in()),
             submission("ben", tiny.handed_in(), when=NOW + timedelta(1.5)),
             replace(submission("dan", tiny.handed_in()), late=True)]   # so says the platform
    results = [late(result, {"": NOW}, 0.25) for result in grader.grade(batch)]
    told = {result.student: (result.status, result.points) for result in results}
    assert [told[name] for name in ("ada", "ben", "dan")] == [("graded", 9), ("late", 4.5), ("late", 6.75)]
    assert late(results[0], {"": NOW, tiny.LESSON: NOW - timedelta(9)}, 0.25).points == 0
    results += grader.missing(results, ["ada", "ben", "cyd"])
    write_reports(folder / "told", results)
    rows = list(csv.DictReader((folder / "told" / "grades.csv").read_text(encoding="utf-8").splitlines()))
    assert {row["student"]: row["status"] for row in rows}["cyd"] == "missing" and len(rows) == 5
    assert list(rows[0]) == ["student", "lesson", "status", "points", "max_points", *tiny.POINTS]
    pages = {path: path.read_text(encoding="utf-8") for path in (folder / "told").rglob("*.html")}
    assert not any("<script" in page for page in pages.values())
    assert any("&lt;script&gt;boo" in page for page in pages.values())
    assert "cyd" in pages[folder / "told" / "class.html"] and "3 of 4 (75%)" in pages[folder / "told" / "class.html"]


def test_hidden_parts_and_what_they_hold_come_back_only_when_revealed(grader: Grader, folder: Path):
    telltale = {"double": "asked = []\ndef double(x):\n    asked.append(x)\n    return 2 * x",
                "said": "def said(w):\n    asked.append(w)\n    return 'so!' if w == 'so' else 'asked for ' + w",
                "applied": "def applied(f, x): return f'{asked}', x\nraise ValueError(f'{asked}')"}
    keyed = {**RIGHT, "applied": "def applied(f, x): return [f(f(x)) if x == 5 else '', x]"}
    results = grader.grade([submission("telltale", tiny.handed_in(**telltale)),
                            submission("ada", tiny.handed_in(**keyed)), submission("ben", tiny.handed_in(**keyed))])
    for reveal in (False, True):
        write_reports(folder / "told", results, reveal)
        page = (folder / "told" / "feedback" / "telltale" / f"{tiny.LESSON}.html").read_text(encoding="utf-8")
        assert [word in page for word in ("mellon", "asked for mellon", "sesame")] == [reveal] * 3
        assert "7.25" not in page and "not []" in page
    # `course.seed(7)` in a check is the student's own.
    seeds = {pick(result, "applied-check").message for result in results}
    assert len(seeds) == 3 and not any(message.endswith("seed 7") for message in seeds)


def test_what_was_graded_stays_graded(grader: Grader, monkeypatch: pytest.MonkeyPatch):
    ran: list[str] = []
    monkeypatch.setattr(Grader, "run", counting(ran))
    batch = [submission("ada", tiny.handed_in(**RIGHT)), submission("fay", tiny.handed_in(said=RIGHT["said"]))]
    first = grader.grade(batch)
    kept = {result.student: grader.place(result).read_bytes() for result in first}
    ran.clear()
    assert grader.grade(batch) == first and ran == []
    assert {result.student: grader.place(result).read_bytes() for result in first} == kept
    grader.place(first[1]).write_text('{"half": ')   # as a killed writer would leave it, if it did not write whole
    grader.grade(batch)
    assert ran == ["fay"]


def test_killed_and_resumed_it_gives_the_same_file(grader: Grader, folder: Path, monkeypatch: pytest.MonkeyPatch):
    batch = [submission(name, tiny.handed_in(own=f"name = {name!r}")) for name in ("ann", "bob", "cat")]
    ran: list[str] = []

    def run(self: Grader, lesson: Any, cells: Any, student: str) -> list[Outcome]:
        if student == "cat" and "dead" not in ran:
            raise KeyboardInterrupt
        ran.append(student)
        return instead_of_a_run(self, lesson)

    monkeypatch.setattr(Grader, "run", run)
    with pytest.raises(KeyboardInterrupt):
        grader.grade(batch, jobs=1)
    assert ran == ["ann", "bob"]
    ran.append("dead")
    write_reports(folder / "resumed", grader.grade(batch, jobs=1))
    assert ran == ["ann", "bob", "dead", "cat"]
    for path in (grader.out / "results").rglob("*.json"):
        if path.parent.name in ("ann", "bob", "cat"):
            path.unlink()
    write_reports(folder / "at once", grader.grade(batch, jobs=2))
    files = [{path.relative_to(folder / place): path.read_bytes() for path in (folder / place).rglob("*.*")}
             for place in ("resumed", "at once")]
    assert files[0] == files[1] and len(files[0]) == 5


def test_versions(folder: Path, monkeypatch: pytest.MonkeyPatch):
    source = folder / "versions" / tiny.LESSON
    source.mkdir(parents=True)
    old, new = tiny.lesson(), json.loads(json.dumps(tiny.lesson()).replace("A word, please.", "One word, please."))
    tiny.at(new, "double-check")["metadata"]["nbgrader"]["points"] = 5
    (source / f"{tiny.LESSON}.ipynb").write_text(json.dumps(new))
    (source / "before.ipynb").write_text(json.dumps(old))
    strange = tiny.handed_in(**RIGHT)
    for cell in strange["cells"]:
        if cell["metadata"]:
            cell["metadata"]["nbgrader"]["checksum"] = "0" * 32
            cell["source"] += "\n# changed"
    without = tiny.handed_in(**RIGHT)
    without["cells"] = [cell for cell in without["cells"] if not cell["metadata"].get("nbgrader", {}).get("grade")]
    monkeypatch.setattr(Grader, "run", instead_of_a_run)
    results = Grader(folder / "versions", folder / "kept", trust=True).grade(
        [submission("old copy", tiny.handed_in(**RIGHT)), submission("strange", strange),
         submission("without", without)])
    assert [(result.status, result.points) for result in results] == [
        ("graded", 9), ("another version", 12), ("graded", 12)]


def test_own_hidden_checks_are_graded_at_the_next_call(folder: Path, monkeypatch: pytest.MonkeyPatch):
    source = tiny.write_source(folder / "own")
    page = source / tiny.LESSON / f"{tiny.LESSON}.ipynb"
    ran: list[str] = []
    monkeypatch.setattr(Grader, "run", counting(ran))
    for _ in range(2):
        for _ in range(2):
            (result,) = Grader(source, folder / "own" / "out", trust=True).grade([submission("ada", tiny.handed_in())])
            assert result.status == "graded"   # what was handed out is as it was
        page.write_text(page.read_text().replace("mellon", "friend"))
    assert ran == [".solution", "ada"] * 2


def test_a_lesson_whose_solutions_fail_grades_nobody_and_stops_nobody(grader: Grader, folder: Path,
                                                                      monkeypatch: pytest.MonkeyPatch):
    source = tiny.write_source(folder / "failing")
    (source / "91_good").mkdir()
    good = json.dumps(tiny.lesson()).replace("-check", "-test")
    (source / "91_good" / "91_good.ipynb").write_text(good)
    monkeypatch.setattr(Grader, "run", lambda self, lesson, *_: [
        replace(outcome, points=0.0, message="never") if outcome.check == "said-check" else outcome
        for outcome in instead_of_a_run(self, lesson)])
    failing, graded = Grader(source, folder / "failing" / "out", trust=True).grade(
        [submission("ada", tiny.handed_in()), submission("ben", good.encode(), "91_good")])
    assert (failing.status, failing.points) == ("no such lesson", 0) and "fails said-check: never" in failing.note
    assert (graded.status, graded.points) == ("graded", 9)


def test_checksums_are_nbgraders():
    for name in notebooks.names()[:3]:
        released = {grader["grade_id"]: grader["checksum"] for cell in notebooks.read_copy(name).cells
                    if (grader := notebooks.grader(cell)).get("grade")}
        source = code_cells(json.loads((notebooks.SOURCE / name / f"{name}.ipynb").read_text(encoding="utf-8")))
        assert {cell.grade_id: cell.version for cell in source if cell.kind == "check"} == released


def test_seeds(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.delenv("CDPRLAB_SEED", raising=False)
    assert seed(7) == 7
    drawn = []
    for key in ("secret ada", "secret ben", "secret ada", "other ada"):
        monkeypatch.setenv("CDPRLAB_SEED", key)
        drawn.append(seed(7))
    assert drawn[0] == drawn[2] and len(set(drawn)) == 3


# --- what platforms hand over -------------------------------------------------------------------------
def test_names_of_platforms_and_zips_that_are_traps(tmp_path: Path):
    with zipfile.ZipFile(tmp_path / "canvas.zip", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("lovelaceada_LATE_123_456_00_first_flight-1.ipynb", "{}")
        archive.writestr("Ben Okri_77_assignsubmission_file_/01_geometry.ipynb", "{}")
        archive.writestr("Ben Okri_78_assignsubmission_file_/deeper/01_geometry.ipynb", "{}")
        archive.writestr("Cy D_79_assignsubmission_file_01_geometry.ipynb", "{}")
        archive.writestr("../../../evil/02_wrench_matrix.ipynb", "{}")
        archive.writestr("/tmp/evil.ipynb", "{}")
        archive.writestr("bomb.ipynb", bytes(200 * 2**20))
        archive.writestr(zipfile.ZipInfo("dee/00_first_flight.ipynb", (1980, 0, 0, 0, 0, 0)), "{}")
    (tmp_path / "cyd").mkdir()
    (tmp_path / "cyd" / "00_first_flight (2).ipynb").write_text("{}")
    (tmp_path / "dan.ipynb").write_text("{}")
    (tmp_path / "eve.ipynb").symlink_to("/etc/passwd")
    (tmp_path / "half.zip").write_bytes(b"PK\x03\x04")
    before = set(tmp_path.parent.rglob("*"))
    found = {(one.student, one.name): one for one in read_submissions(tmp_path)}
    assert set(found) == {("lovelaceada", "00_first_flight"), ("Ben Okri 77", "01_geometry"), ("Cy D", "01_geometry"),
                          ("Ben Okri 78", "01_geometry"), ("bomb", ""), ("cyd", "00_first_flight"), ("dan", ""),
                          ("dee", "00_first_flight"), ("half.zip", "")}
    assert found["lovelaceada", "00_first_flight"].late and len(found["bomb", ""].read()) == 64 * 2**20 + 1
    assert set(tmp_path.parent.rglob("*")) == before


def test_nobody_hands_in_for_somebody_else(tmp_path: Path):
    """Within their own folder students choose the names."""
    mallory = tmp_path / "mallory"
    (mallory / "ada").mkdir(parents=True)
    for name in ("ada_1_2_00_x.ipynb", "ada_1_assignsubmission_file_00_x.ipynb", "ada/00_x.ipynb"):
        (mallory / name).write_text("{}")
    with zipfile.ZipFile(mallory / "more.zip", "w") as archive:
        archive.writestr("ada/00_x.ipynb", "{}")
    with zipfile.ZipFile(tmp_path / "canvas.zip", "w") as archive:
        archive.writestr("mallory_1_2_ada_3_4_00_x.ipynb", "{}")
        archive.writestr("mallory_5_assignsubmission_file_/ada_6_assignsubmission_file_/00_x.ipynb", "{}")
    assert {one.student.split()[0] for one in read_submissions(tmp_path)} == {"mallory"}


def test_names_are_safe_and_nobody_is_lost(tmp_path: Path):
    names = ["=cmd|' /C calc'!A0", "ada", "=ada", "+ada", "x" * 200, "x" * 201, "\N{CJK UNIFIED IDEOGRAPH-20000}" * 60,
             "two\nlines", "nul\udcff", "a\\..\\up", "con:", "-1+1", "@sum(a1)", "\tab"]
    for name in names:
        with contextlib.suppress(OSError):   # too long for this file system
            (tmp_path / f"{name}.ipynb").write_text("{}")
    made = len(list(tmp_path.iterdir()))
    found = [one.student for one in read_submissions(tmp_path)]
    assert len(set(found)) == len(found) == made > 10
    for name in found:
        assert not set(name) & set("=|/\\\n\t:'") and name[0] not in "+-@. " and len(f"{name}.json".encode()) < 255


@pytest.fixture
def engine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A machine without bubblewrap, where `docker` writes down what it was told, and runs it without a container."""
    monkeypatch.setattr(jail, "BUBBLEWRAP", "no-such-program")
    log, program = tmp_path / "docker.log", tmp_path / "docker"
    program.write_text(f"#!/bin/sh\necho \"$@\" >>{log}\nwhile [ \"$1\" != {jail.IMAGE} ]; do shift; done\nshift\n"
                       f"export PATH={Path(sys.executable).parent}:$PATH PYTHONPATH={notebooks.CHECKOUT}\n"
                       "exec python \"$@\"\n")
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}:/usr/bin:/bin")
    return log


def test_a_container_where_there_is_no_bubblewrap(engine: Path, grader: Grader):
    elsewhere = copy.copy(grader)
    elsewhere.jail, python = find_jail()
    elsewhere.command = [*python, *grader.command[-2:]]
    (result,) = elsewhere.grade([submission("contained", tiny.handed_in(**RIGHT))])
    assert (elsewhere.jail, result.points) == ("docker", 9)
    told = engine.read_text().splitlines()[-1].split()
    for words in ("--rm", "--network none", "--read-only", "--cap-drop ALL", "--user 65534:65534", "--memory 2g",
                  "--pids-limit 64", "--security-opt no-new-privileges"):
        assert words in " ".join(told)
    assert told[-3:] == [jail.IMAGE, "-m", "cdprlab.course.grading.worker"] and "--volume" not in told


@pytest.mark.parametrize("spoiled", ["exit 1", "echo 0.0.1"])
def test_without_a_jail_it_refuses(engine: Path, folder: Path, spoiled: str, capsys: pytest.CaptureFixture[str]):
    """Also where the image is missing, or holds another version."""
    (engine.parent / "docker").write_text(f"#!/bin/sh\n{spoiled}\n")
    (engine.parent / "ada.ipynb").write_text("{}")
    arguments = ["grade", str(engine.parent), "--source", str(folder / "source"), "--out", str(engine.parent / "out")]
    assert main(arguments) == 2 and "no jail" in capsys.readouterr().err
    assert not (engine.parent / "out").exists()
    name, command = find_jail(trust=True)
    assert name == "none" and not any("CDPRLAB_SEED" in word for word in command)


@pytest.mark.parametrize("arguments, message", [
    (["grade", "nowhere"], "there is no nowhere"),
    (["grade", "{empty}"], "no notebooks in"),
    (["grade", "{here}", "--source", "{here}"], "no lessons in"),
    (["grade", "{here}", "--due", "tomorrow"], "--due takes a date"),
    (["grade", "{here}", "--roster", "none.csv"], "cannot read the roster"),
    (["grade", "{here}", "--lesson", "99_x", "--trust", "--source", "{source}"], "there is no lesson '99_x'"),
])
def test_wrong_use_is_one_line(arguments, message, tmp_path, monkeypatch, capsys, grader, folder):
    monkeypatch.chdir(tmp_path)
    here = tmp_path / "here"
    here.mkdir()
    (here / "ada.ipynb").write_text("{}")
    (tmp_path / "empty").mkdir()
    places = {"here": str(here), "empty": str(tmp_path / "empty"), "source": str(folder / "source")}
    assert main([part.format(**places) for part in arguments]) == 2
    error = capsys.readouterr().err
    assert message in error and len(error.strip().splitlines()) == 1


# --- the lessons themselves ---------------------------------------------------------------------------
@pytest.fixture(scope="module")
def course(folder: Path) -> Grader:
    return Grader(notebooks.SOURCE, folder / "course", trust=True)


def answered(name: str, **answers: str) -> dict[str, Any]:
    """A student's copy of a lesson with its solutions, but for some answers."""
    copy, source = notebooks.read_copy(name), notebooks.read_source(name)
    for answer, index in notebooks.answers(copy).items():
        copy.cells[index].source = answers.get(answer) or source.cells[notebooks.answers(source)[answer]].source
    return copy


def _full_marks(course: Grader, name: str) -> None:
    """Proved for every lesson before anybody is graded."""
    result = course.prove(course.lessons[name][0])
    assert result.points == result.max_points > 0, result
    assert all(outcome.split for outcome in result.outcomes)


def other_answers(name: str) -> dict[str, list[str]]:
    """Answer → right ones, written otherwise."""
    page = notebooks.CHECKOUT / "tests" / "exercises" / f"{name}.py"
    others = runpy.run_path(str(page)).get("OTHERS", {}) if page.exists() else {}
    return {f"{exercise}-answer": [code.strip() for _, code in found] for exercise, found in others.items()}


def test_a_lesson_through_the_split(course: Grader):
    """Its solutions; then other right answers to some exercises and wrong ones to the rest."""
    rng = random.Random(16)
    name = rng.choice(["01_geometry", "02_wrench_matrix", "09_available_wrench_set"])
    _full_marks(course, name)
    right, wrong = other_answers(name), notebooks.wrong_answers(name)
    mixed = {answer: rng.choice(right[answer]) if answer in right and index % 2 else rng.choice(mistakes)[1]
             for index, (answer, mistakes) in enumerate(wrong.items())}
    (result,) = course.grade([submission("mixed", answered(name, **mixed), name)])
    for answer, code in mixed.items():
        outcome = pick(result, notebooks.check_of(answer))
        assert outcome.passed == (code in right.get(answer, ())), outcome


@pytest.mark.long
@pytest.mark.parametrize("name", notebooks.names())
def test_every_lesson_through_the_split(course: Grader, name: str):
    pytest.importorskip("pybullet", reason="PyBullet has no wheel here")
    _full_marks(course, name)
    others = {answer: list(codes) for answer, codes in other_answers(name).items()}
    while any(others.values()):
        batch = {answer: codes.pop() for answer, codes in others.items() if codes}
        (result,) = course.grade([submission("another", answered(name, **batch), name)])
        assert result.points == result.max_points, (batch, result)


@pytest.mark.long
@pytest.mark.parametrize("name", notebooks.names())
def test_every_planted_mistake_through_the_split(course: Grader, name: str):
    pytest.importorskip("pybullet", reason="PyBullet has no wheel here")
    planted = [(answer, what, code) for answer, mistakes in notebooks.wrong_answers(name).items()
               for what, code in mistakes]
    results = course.grade([submission(f"{name} {i}", answered(name, **{answer: code}), name)
                            for i, (answer, _, code) in enumerate(planted)])
    for (answer, what, _), result in zip(planted, results, strict=True):
        assert pick(result, notebooks.check_of(answer)).points == 0, f"{answer}, {what}"


def test_the_split_needs_no_jail(grader: Grader):
    """Where no jail can be the rest is tried at least: a worker as an ordinary process."""
    alone = copy.copy(grader)
    alone.command = [sys.executable, *grader.command[-2:]]
    results = alone.grade([submission("alone", tiny.handed_in(**RIGHT)), submission("eve", ATTACKS["always equal"])])
    assert [result.points for result in results] == [9, 0]


def test_what_is_no_message_earns_nothing(grader: Grader):
    """A worker that only makes noise: it earns nothing, and the judge goes on."""
    alone = copy.copy(grader)
    alone.command = [sys.executable, "-c", "import sys; sys.stdout.buffer.write(bytes(99))"]
    outcomes = alone.run(alone.lessons[tiny.LESSON][0], code_cells(tiny.handed_in(**RIGHT)), "eve")
    assert [outcome.points for outcome in outcomes] == [0, 0, 0]
