"""What is shipped: the wheel, what an import loads, and what works without PyBullet."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from cdprlab.errors import install_command

CHECKOUT = Path(__file__).parent.parent
HEAVY = ("pybullet", "pymunk", "matplotlib", "ipywidgets", "k3d", "scipy", "quadprog", "qpsolvers", "codac",
         "pydantic", "ruamel", "PIL", "tqdm", "numba", "joblib")
BLOCKED = "import sys; sys.modules['pybullet'] = None\n"


def python(*arguments: str, cwd: Path, path: Path | None = None) -> subprocess.CompletedProcess[str]:
    """Run this Python elsewhere: ``path`` goes first on sys.path, the environment's variables do not come along."""
    code = list(arguments)
    if path is not None:
        code = ["-c", f"import sys; sys.path.insert(0, {str(path)!r})\n" + arguments[1], *arguments[2:]]
    return subprocess.run([sys.executable, "-E", *code], cwd=cwd, capture_output=True, text=True, timeout=250)


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with cdprlab installed into it, from a wheel made from a source distribution."""
    work = tmp_path_factory.mktemp("wheel")
    for step in (["build", "--no-isolation", "--outdir", str(work), str(CHECKOUT)],
                 ["pip", "install", "--quiet", "--no-deps", "--no-index", "--disable-pip-version-check",
                  "--target", str(work / "site")]):
        wheels = map(str, work.glob("*.whl")) if step[0] == "pip" else ()
        done = python("-m", *step, *wheels, cwd=work)
        assert done.returncode == 0, done.stdout + done.stderr
    return work / "site"


def test_the_wheel_works_anywhere_and_brings_its_worlds(installed: Path, tmp_path: Path):
    done = python("-c", f"""
sys.path[:] = [entry for entry in sys.path if entry != {str(CHECKOUT)!r}]
import cdprlab as cl
print(cl.__file__, *cl.world_names())
print(cl.load_world("caroca").robot.n_cables)
""", cwd=tmp_path, path=installed)
    assert done.returncode == 0, done.stderr
    place, *names = done.stdout.splitlines()[0].split()
    assert Path(place).is_relative_to(installed)
    assert set(names) == {path.stem for path in (CHECKOUT / "worlds").glob("*.yaml")}
    assert done.stdout.splitlines()[1] == "8"


def test_the_wheel_holds_what_is_not_python(installed: Path):
    there = {path.relative_to(CHECKOUT / "cdprlab").as_posix() for path in (CHECKOUT / "cdprlab").rglob("*")
             if path.is_file() and path.suffix != ".py" and path.parent.name != "__pycache__"}
    assert "py.typed" in there
    assert {name for name in there if not (installed / "cdprlab" / name).is_file()} == set()
    for folder in ("share/jupyter/lab/settings/overrides.d", "etc/jupyter/labconfig/page_config.d"):
        assert (installed / folder / "cdprlab.json").is_file()


def test_the_checkout_works_from_any_directory(tmp_path: Path):
    done = python("-c", "import cdprlab as cl; print(len(cl.world_names()))", cwd=tmp_path, path=CHECKOUT)
    assert done.returncode == 0, done.stderr
    assert int(done.stdout) >= 7


def test_importing_loads_nothing_heavy(tmp_path: Path):
    done = python("-c", f"import cdprlab; print(*[name for name in {HEAVY} if name in sys.modules])",
                  cwd=tmp_path, path=CHECKOUT)
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == []


def test_importing_the_wing_of_fastkit_draws_nothing(tmp_path: Path):
    code = "import sys, cdprlab.fastkit as wing; print('matplotlib' in sys.modules, wing.plot_job.__name__)"
    done = python("-c", code, cwd=tmp_path, path=CHECKOUT)
    assert done.stdout.split() == ["False", "plot_job"], done.stderr


def test_without_pybullet_mechanics_work(tmp_path: Path):
    done = python("-c", BLOCKED + """
import cdprlab as cl
world = cl.load_world("caroca")
robot, pose = world.robot, world.pose
W, w_e = cl.wrench_matrix(robot, pose), cl.gravity_wrench(robot, pose)
print(cl.distribute_tensions(W, w_e, robot.tension_min, robot.tension_max).feasible)
""", cwd=tmp_path, path=CHECKOUT)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == "True"


def test_without_pybullet_a_spatial_run_says_the_ways_out_in_one_line(tmp_path: Path):
    done = python("-c", BLOCKED + """
from cdprlab.__main__ import main
sys.exit(main(["run", "caroca"]))
""", cwd=tmp_path, path=CHECKOUT)
    assert done.returncode == 2, done.stdout + done.stderr
    assert len(done.stderr.strip().splitlines()) == 1, done.stderr
    assert install_command("pybullet") in done.stderr


ROOMS_WITHOUT_ENGINE = ("pose", "world", "geometry", "kinematics", "statics", "tensions", "tensions_laws", "polytope",
                        "sets", "configurations", "trajectory", "control", "bases", "planar")


@pytest.mark.long
def test_without_pybullet_the_other_tests_pass():
    """Mechanics, tensions, sets and planar worlds; what draws or teaches them is left to the tests of its own."""
    tests = [str(CHECKOUT / "tests" / f"test_{room}.py") for room in ROOMS_WITHOUT_ENGINE]
    done = python("-c", BLOCKED + "import pytest; sys.exit(pytest.main(sys.argv[1:]))",
                  "-q", "-p", "no:cacheprovider", *tests, cwd=CHECKOUT)
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr


@pytest.mark.skipif(shutil.which("make") is None, reason="make is not installed")
def test_make_without_a_usable_python_says_so_in_one_line(tmp_path: Path):
    outside = {name: value for name, value in os.environ.items() if name not in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL")}
    done = subprocess.run(["make", "run", "PYTHON=no-such-python", f"VENV={tmp_path}/none"], cwd=CHECKOUT,
                          env=outside, capture_output=True, text=True, timeout=60)
    assert done.returncode != 0
    assert len(done.stderr.strip().splitlines()) == 1, done.stderr
    for word in ("3.11", "PyBullet", "uv`", "conda", "docker"):
        assert word in done.stderr


STAND_IN = """#!/bin/sh
# Says that it is Python {version}; makes environments that hold nothing but a python that says what it is asked for.
if test "$1" = -c; then exec {python} -c "import sys; sys.version_info = {version}; exec(sys.argv[1])" "$2"; fi
for last; do true; done
mkdir -p "$last/bin"
printf '#!/bin/sh\\ntest "$1" = -c && exit {missing}\\necho "{version}: $*"\\n' > "$last/bin/python"
touch "$last/bin/pip"; chmod +x "$last/bin/python" "$last/bin/pip"
"""


@pytest.mark.skipif(shutil.which("make") is None, reason="make is not installed")
@pytest.mark.parametrize(("there", "flown"), [
    ({"python3.11": 11, "python3.12": 12, "python3": 14}, "(3, 12): -m cdprlab run caroca"),
    ({"python3": 13}, "(3, 13): -m cdprlab run caroca"),
    ({"python3": 14, "uv": 13}, "(3, 13): -m cdprlab run caroca"),
    ({"python3": 14}, "(3, 14): -m cdprlab run planar_rigid"),
])
def test_make_takes_the_newest_python_with_an_engine(there: dict[str, int], flown: str, tmp_path: Path):
    for name, minor in there.items():
        (tmp_path / name).write_text(STAND_IN.format(python=sys.executable, version=(3, minor),
                                                      missing=int(minor > 13)))
        (tmp_path / name).chmod(0o755)
    tools = tmp_path / "tools"   # nothing else that the machine has
    tools.mkdir()
    for tool in ("sh", "make", "mkdir", "touch", "chmod", "test", "rm"):
        (tools / tool).symlink_to(str(shutil.which(tool)))
    done = subprocess.run(["make", "run", f"VENV={tmp_path}/venv"], cwd=CHECKOUT, capture_output=True, text=True,
                          timeout=60, env={"PATH": f"{tmp_path}:{tools}"})
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.splitlines()[-1] == flown
    assert ("no spatial engine" in done.stdout) == ("planar" in flown)


def test_the_readme_program_prints_what_it_says():
    pytest.importorskip("pybullet", reason="PyBullet has no wheel here")
    readme = (CHECKOUT / "README.md").read_text(encoding="utf-8")
    program, printed = readme.split("```python\n")[1].split("```")[0], readme.split("```text\n")[1].split("```")[0]
    done = python("-c", program, cwd=CHECKOUT, path=CHECKOUT)
    assert done.returncode == 0, done.stderr
    assert done.stdout == printed


def test_the_readme_lists_every_world():
    readme = (CHECKOUT / "README.md").read_text(encoding="utf-8")
    assert [path.stem for path in (CHECKOUT / "worlds").glob("*.yaml") if f"| `{path.stem}` |" not in readme] == []


def test_benchmarks_find_what_they_measure():
    """They run by `make bench` alone: here they are imported, so that no renamed thing is missed there."""
    done = python("-m", "pytest", "tests/benchmarks", "--collect-only", "-q", cwd=CHECKOUT)
    assert done.returncode == 0, done.stdout[-3000:]
