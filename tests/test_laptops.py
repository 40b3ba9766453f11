"""Every laptop: the engine each machine is asked for, what a missing package costs, places without installing."""

import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from packaging.requirements import Requirement

import cdprlab as cl
from cdprlab.cli import doctor
from cdprlab.cli.main import main
from cdprlab.errors import WorldError, install_command, requirements

CHECKOUT = Path(__file__).parent.parent
PROJECT = tomllib.loads((CHECKOUT / "pyproject.toml").read_text(encoding="utf-8"))["project"]

LESSONS = list((CHECKOUT / "lessons").glob("*.ipynb"))

MACHINES = {
    "linux": {"sys_platform": "linux", "platform_machine": "x86_64", "os_name": "posix"},
    "linux on arm": {"sys_platform": "linux", "platform_machine": "aarch64", "os_name": "posix"},
    "windows": {"sys_platform": "win32", "platform_machine": "AMD64", "os_name": "nt"},
    "mac": {"sys_platform": "darwin", "platform_machine": "arm64", "os_name": "posix"},
    "intel mac": {"sys_platform": "darwin", "platform_machine": "x86_64", "os_name": "posix"},
}
ENGINES = {   # where PyPI has wheels
    ("linux", "3.11"): "pybullet", ("linux", "3.12"): "pybullet-arm64", ("linux", "3.13"): "pybullet-arm64",
    **{(name, python): "pybullet-arm64" for name in ("windows", "mac") for python in ("3.11", "3.12", "3.13")},
}


@pytest.mark.parametrize("python", ["3.11", "3.12", "3.13", "3.14"])
@pytest.mark.parametrize("machine", MACHINES)
def test_each_machine_is_asked_for_one_engine_at_most(machine: str, python: str):
    here = {**MACHINES[machine], "python_version": python, "python_full_version": f"{python}.1"}
    pins = (CHECKOUT / "requirements.txt").read_text(encoding="utf-8").splitlines()
    for lines in (PROJECT["dependencies"], [line for line in pins if re.match(r"\w.*==", line)]):
        asked = [need.name for need in map(Requirement, lines)
                 if need.name.startswith("pybullet") and (need.marker is None or need.marker.evaluate(here))]
        engine = ENGINES.get((machine, python))
        assert asked == ([engine] if engine else [])


def test_conda_s_environment_asks_for_all_that_pip_would():
    text = (CHECKOUT / "environment.yml").read_text(encoding="utf-8")
    listed = {Requirement(line).name.replace("matplotlib-base", "matplotlib")
              for line in re.findall(r"^ +- ([a-z][\w.-]+(?:[<>=].*)?)$", text, re.MULTILINE)
              if not line.startswith("python=")}
    wanted = map(Requirement, [*PROJECT["dependencies"], *PROJECT["optional-dependencies"]["lab"]])
    assert {need.name for need in wanted} - listed == {"pybullet-arm64"}
    assert "python=3.14" in text   # for which pip is asked for no PyBullet beside conda's


# --- what is missing ----------------------------------------------------------------------------------
PLANAR = "cl.run(cl.load_world('planar_rigid'), duration=0.01)"
FEATURES = {
    "pybullet": "cl.run(cl.load_world('caroca'), duration=0.01)",
    "pymunk": PLANAR,
    "matplotlib": f"cl.plot({PLANAR})",
    "k3d": f"cl.view.save_scene({PLANAR}, 'scene.html')",
    "ipywidgets": "__import__('cdprlab.course').course.pose_explorer(cl.load_world('planar_rigid'))",
    "qpsolvers": "cl.distribute_tensions([[1.0, -1.0]], [0.0], 1.0, 9.0, solver='osqp')",
}


@pytest.mark.parametrize("module", FEATURES)
def test_what_is_missing_costs_its_feature_with_one_line(module: str, tmp_path: Path):
    code = (f"import sys; sys.modules[{module!r}] = None\nimport cdprlab as cl\n"
            f"cl.distribute_tensions([[1.0, -1.0]], [0.0], 1.0, 9.0).require()\n"
            f"try: {FEATURES[module]}\nexcept cl.errors.MissingDependency as error: print(error)")
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    (line,) = done.stdout.splitlines()
    assert f"needs {module}, which is not installed" in line and install_command(module) in line


def test_without_numba_the_same_comes_out(tmp_path: Path):
    code = ("import sys; sys.modules['numba'] = None\nimport cdprlab as cl\n"
            f"print({PLANAR}.measured_tensions[-1].tolist())")
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    expected = cl.run(cl.load_world("planar_rigid"), duration=0.01).measured_tensions[-1]
    assert eval(done.stdout.splitlines()[-1]) == pytest.approx(expected.tolist(), rel=1e-9)


@pytest.mark.parametrize(("elsewhere", "words"), [
    ({"sys_platform": "linux", "platform_machine": "aarch64"}, "conda create"),
    ({"python_version": "3.14"}, "3.1"),
])
def test_where_pypi_has_no_engine_the_command_makes_an_environment(elsewhere: dict[str, str], words: str,
                                                                   monkeypatch: pytest.MonkeyPatch):
    there = requirements(**elsewhere)
    monkeypatch.setattr("cdprlab.errors.requirements", lambda **machine: there)
    assert words in install_command("pybullet") and "pip install" not in install_command("pybullet")


# --- doctor, lessons, worlds --------------------------------------------------------------------------
def test_doctor_finds_a_wheel_that_computes_something_else(monkeypatch: pytest.MonkeyPatch):
    planar = next(part for part in doctor.PARTS if part.name == "planar engine")
    assert doctor.examine(planar).works
    monkeypatch.setitem(doctor.FLIGHTS, "planar_rigid", (5.13963e-6, 5.0, 43.5905946))   # 2e-6 of it off
    found = doctor.examine(planar)
    assert not found.works and "computes something else" in found.said


def test_doctor_names_what_is_missing_and_the_command(monkeypatch: pytest.MonkeyPatch,
                                                      capsys: pytest.CaptureFixture[str]):
    parts = doctor.Part("numbers", ("numpy",)), doctor.Part("abaci", ("abacus", "soroban"))
    monkeypatch.setattr(doctor, "PARTS", parts)
    assert main(["doctor"]) == 1
    assert f"To mend it: {install_command('abacus', 'soroban')}" in capsys.readouterr().out


def test_both_engines_at_once_are_noticed(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(doctor, "packages_distributions", lambda: {"numpy": ["numpy", "pytest"]})
    found = doctor.examine(doctor.Part("engine", ("numpy",)))
    assert not found.works and "uninstall" in found.remedy


def test_lessons_are_copied_and_the_mission_is_listed(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    assert main(["lessons", str(tmp_path / "mine")]) == 0
    assert len(list((tmp_path / "mine").glob("*.ipynb"))) == len(LESSONS)
    assert main(["worlds"]) == 0
    (line,) = [line for line in capsys.readouterr().out.splitlines() if line.startswith("fastkit_suspended ")]
    assert line.endswith("pick_and_place, mission")
    assert main(["run", "caroca", "--task", "mission"]) == 2


def test_a_console_that_knows_few_letters_is_no_error():
    done = subprocess.run([sys.executable, "-m", "cdprlab", "workspace", "--help"], capture_output=True, timeout=120,
                          cwd=CHECKOUT, env={**os.environ, "PYTHONIOENCODING": "ascii"})
    assert done.returncode == 0 and b"m/s? or" in done.stdout, done.stderr


def test_addresses_are_no_worlds_and_endings_may_be_large(tmp_path: Path):
    with pytest.raises(WorldError, match="not read from addresses"):
        cl.load_world("https://example.org/robot.yaml")
    cl.load_world("caroca").save(tmp_path / "robot.yaml")
    shutil.copy(tmp_path / "robot.yaml", tmp_path / "ROBOT.YAML")
    assert cl.load_world(tmp_path / "ROBOT.YAML").name == "caroca"


# --- places without installing ------------------------------------------------------------------------
def test_binder_shows_no_solutions(tmp_path: Path):
    """What is left of the repository once Binder has built it."""
    home = tmp_path / "home"
    shutil.copytree(CHECKOUT / "lessons", home / "lessons")
    shutil.copytree(CHECKOUT / "tests" / "wrong_answers", home / "tests" / "wrong_answers")
    (home / ".git").mkdir()
    script = (CHECKOUT / ".binder" / "postBuild").read_text(encoding="utf-8")
    script = script.replace("python -m cdprlab.compiled\n", "")   # which takes its time, and hides nothing
    script = script.replace("python ", f"PYTHONPATH={CHECKOUT} {sys.executable} ")
    done = subprocess.run(["bash", "-c", script], cwd=home, capture_output=True, text=True, timeout=250)
    assert done.returncode == 0, done.stderr
    left = [path for path in home.rglob("*") if path.is_file()]
    assert len([path for path in left if path.parent.name == "my_lessons" and path.suffix == ".ipynb"]) == len(LESSONS)
    assert [path for path in left if b"BEGIN SOLUTION" in path.read_bytes()] == [] and not (home / ".git").exists()


def test_one_address_everywhere():
    home = PROJECT["urls"]["Homepage"].removeprefix("https://github.com/")
    pages = [CHECKOUT / "README.md", CHECKOUT / "docs" / "install.md"]
    named = {name for page in pages for name in re.findall(
        r"(?:github\.com|/gh|colab\.research\.google\.com/github|codespaces\.new)/(cdprlab/[\w-]+)",
        page.read_text(encoding="utf-8"))}
    assert named == {home}


def test_the_readme_s_links_lead_to_files_that_are_there():
    """Absolute ones, since package pages show it too."""
    text = (CHECKOUT / "README.md").read_text(encoding="utf-8")
    assert re.findall(r"\]\((?!https?://|#)[^)]*\)", text) == []
    for path in re.findall(rf"{PROJECT['urls']['Homepage']}/(?:blob|raw)/main/([^)#]+)", text):
        assert (CHECKOUT / path).exists(), path


