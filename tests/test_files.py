"""What is written is whole or not there: full disks, kills, links, permissions, damaged checkpoints."""

import os
import re
import signal
import subprocess
import sys
import threading
import warnings
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import cdprlab as cl
from cdprlab.errors import CannotWrite, InvalidInput
from cdprlab.run.log import write_rows
from cdprlab.view.film import save_gif, save_png
from cdprlab.view.plots import save_figure
from cdprlab.workspace import Criterion, Judgement, position_grid
from cdprlab.world.files import checked_path, made_folder, replaced, write_text
from robots import robot_1r2t

WINDOWS = sys.platform == "win32"
ROOT = not WINDOWS and os.geteuid() == 0
FRAME = np.zeros((20, 20, 3), dtype=np.uint8)


# --- one function writes ----------------------------------------------------------------------------
@pytest.mark.parametrize("error", [OSError(28, "No space left on device"), KeyboardInterrupt(), ValueError("no")])
def test_an_error_in_the_middle_leaves_the_old_file_and_nothing_else(error, tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("old")
    with pytest.raises(CannotWrite if isinstance(error, OSError) else type(error)) as caught, replaced(path) as file:
        file.write(b"new, and not yet all of it")
        raise error
    assert path.read_text() == "old" and os.listdir(tmp_path) == ["log.csv"]
    if isinstance(error, OSError):
        assert str(caught.value) == f"cannot write {path}: No space left on device"


@pytest.mark.skipif(WINDOWS, reason="links need rights there")
def test_links_are_followed_and_permissions_kept(tmp_path):
    true, link, dangling = tmp_path / "true.csv", tmp_path / "link.csv", tmp_path / "dangling.csv"
    true.write_text("old")
    true.chmod(0o640)
    link.symlink_to(true)
    dangling.symlink_to(tmp_path / "later.csv")
    write_text(link, "new")
    write_text(dangling, "also")
    assert link.is_symlink() and true.read_text() == "new" and true.stat().st_mode & 0o777 == 0o640
    assert dangling.is_symlink() and (tmp_path / "later.csv").read_text() == "also"
    assert len(os.listdir(tmp_path)) == 4


@pytest.mark.skipif(WINDOWS, reason="no such devices there")
def test_what_is_no_plain_file_stays_what_it_is(tmp_path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    heard = []
    reader = threading.Thread(target=lambda: heard.append(pipe.read_text()))
    reader.start()
    write_text(pipe, "words")
    reader.join(10)
    write_text("/dev/null", "nothing")
    assert heard == ["words"] and pipe.is_fifo() and not Path("/dev/null").is_file()


@pytest.mark.skipif(WINDOWS or ROOT, reason="nothing is write-protected from root")
def test_what_is_write_protected_stays(tmp_path):
    path = tmp_path / "kept.yaml"
    path.write_text("old")
    path.chmod(0o444)
    with pytest.raises(CannotWrite, match="write-protected"):
        write_text(path, "new")
    assert path.read_text() == "old" and os.listdir(tmp_path) == ["kept.yaml"]


@pytest.mark.parametrize("write", [
    lambda path: cl.load_world("planar_point").save(path),
    lambda path: save_png(FRAME, path.with_suffix(".png"), ""),
    lambda path: save_gif([FRAME], path.with_suffix(".gif"), 0.1, ""),
    lambda path: save_figure(cl.plot(cl.compare_tensions(cl.load_world("planar_rigid"), methods="pseudo_inverse")),
                             path.with_suffix(".svg")),
    lambda path: write_rows(path, [("a", "b")]),
    lambda path: cl.run(cl.load_world("planar_point"), duration=0.01).save(path.parent),
], ids=["world", "still", "film", "figure", "rows", "run"])
def test_every_writer_goes_that_way(write, tmp_path, monkeypatch):
    """With moving into place forbidden nothing new may appear: no writer opens its target itself."""
    def refuse(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "replace", refuse)
    with pytest.raises(CannotWrite, match="No space left"):
        write(tmp_path / "file.yaml")
    assert os.listdir(tmp_path) == []


def test_no_other_file_of_the_package_writes_by_itself():
    """The law behind the test above, for the writers of tomorrow."""
    writing = re.compile(r"""\.write_(text|bytes)\(|open\(["'][wax]|savez\w*\((?!file)|savefig\((?!file|buffer)""")
    package = Path(cl.__file__).parent
    texts = {path.name: path.read_text(encoding="utf-8") for path in package.rglob("*.py")}
    assert [name for name, text in texts.items() if writing.search(text)] == ["files.py"]


@pytest.mark.parametrize("path", ["", "a\0b", 42, None, b"bytes"])
def test_what_names_no_file_is_refused(path):
    for check in (checked_path, made_folder):
        with pytest.raises(InvalidInput, match="a path must be text"):
            check(path)


def test_a_folder_that_cannot_be_written_to_is_refused(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(CannotWrite, match="something else has that name"):
        made_folder(tmp_path / "file")
    with pytest.raises(CannotWrite, match="cannot write"):
        made_folder(tmp_path / "file" / "below")
    with pytest.raises(CannotWrite, match="Is a directory"):
        cl.load_world("planar_point").save(tmp_path)
    assert made_folder(tmp_path / "new" / "one").is_dir() and os.listdir(tmp_path / "new" / "one") == []


_SAVING = """
import sys, numpy as np
from cdprlab.world.files import replaced
print("ready", flush=True)
for number in range(10**6):
    with replaced(sys.argv[1]) as file:
        np.savez(file, numbers=np.full(20_000, number))
"""


@pytest.mark.skipif(WINDOWS, reason="SIGKILL")
@pytest.mark.parametrize("kills", [3, pytest.param(10, marks=pytest.mark.long)])
def test_a_process_killed_while_saving_leaves_a_readable_file(kills, tmp_path):
    path, rng = tmp_path / "log.npz", np.random.default_rng(3)
    np.savez(path, numbers=np.full(20_000, -1))
    for _ in range(kills):
        with subprocess.Popen([sys.executable, "-c", _SAVING, path], stdout=subprocess.PIPE) as process:
            process.stdout.readline()
            with pytest.raises(subprocess.TimeoutExpired):
                process.wait(0.02 + 0.2 * rng.random())
            process.send_signal(signal.SIGKILL)
        with np.load(path) as kept:
            assert len(kept["numbers"]) == 20_000 and np.ptp(kept["numbers"]) == 0


# --- checkpoints ----------------------------------------------------------------------------------------
GRID = position_grid([-1.0, 0.2], [1.0, 1.8], 0.05)


def sweep(folder, **options):
    return cl.workspace(robot_1r2t(), GRID, cl.WrenchFeasible(), chunk=256, checkpoint=folder, **options)


def short(path, dtype=bool):
    np.savez(path, inside=np.ones(1, dtype), margin=np.ones(1))


def rewritten(path, **changes):
    with np.load(path) as file:
        arrays = dict(file)
    np.savez(path, **arrays | {name: change(arrays[name]) for name, change in changes.items()})


DAMAGE = {
    "empty": lambda path: path.write_bytes(b""),
    "cut off": lambda path: path.write_bytes(path.read_bytes()[:200]),
    "garbage": lambda path: path.write_bytes(np.random.default_rng(0).bytes(500)),
    "bit flip": lambda path: path.write_bytes(path.read_bytes()[:300] + b"\xff" + path.read_bytes()[301:]),
    "of one pose": short,
    "numbers for flags": lambda path: np.savez(path, inside=np.ones(256), margin=np.ones(256)),
    "other keys": lambda path: np.savez(path, verdict=np.ones(256, bool)),
    "objects": lambda path: np.savez(path, inside=np.array([None] * 256), margin=np.ones(256)),
    "one array": lambda path: path.write_bytes(b"\x93NUMPY"),
    "of another chunk": lambda path: path.write_bytes(sorted(path.parent.iterdir())[1].read_bytes()),
    "half as exact": lambda path: rewritten(path, margin=lambda margin: margin.astype(np.float32)),
    "other answers": lambda path: rewritten(path, inside=np.logical_not),
}


@pytest.mark.parametrize("harm", DAMAGE.values(), ids=DAMAGE.keys())
def test_a_damaged_or_foreign_part_is_judged_anew_and_kept_again(harm, tmp_path):
    first, parts = sweep(tmp_path), sorted(tmp_path.iterdir())
    whole = [part.read_bytes() for part in parts]
    for part in parts[::2]:
        harm(part)
    again = sweep(tmp_path)
    assert np.array_equal(again.inside, first.inside) and np.array_equal(again.margin, first.margin)
    assert [part.stat().st_size for part in sorted(tmp_path.iterdir())] == list(map(len, whole))


def test_a_folder_in_a_part_s_place_is_said_and_costs_no_answer(tmp_path):
    first, part = sweep(tmp_path), min(tmp_path.iterdir())
    part.unlink()
    part.mkdir()
    with pytest.warns(UserWarning, match="done but not kept"):
        assert np.array_equal(sweep(tmp_path).inside, first.inside)


def test_threads_and_processes_share_a_checkpoint(tmp_path):
    first, answers = sweep(None), []
    threads = [threading.Thread(target=lambda: answers.append(sweep(tmp_path))) for _ in range(4)]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    answers.append(sweep(tmp_path, n_jobs=2))
    assert len(answers) == 5 and all(np.array_equal(found.inside, first.inside) for found in answers)
    assert {path.suffix for path in tmp_path.iterdir()} == {".npz"}


def test_what_a_killed_sweep_left_half_written_is_cleared_away(tmp_path):
    sweep(tmp_path)
    part = min(tmp_path.iterdir())
    part.rename(tmp_path / f".{part.name}.0123.part")
    sweep(tmp_path)
    assert {path.suffix for path in tmp_path.iterdir()} == {".npz"}


class Nearer(Criterion):
    """A criterion of a user's, no dataclass: nothing but its attributes tells two of them apart."""

    def __init__(self, reach):
        self.reach = reach

    def judge(self, robot, poses, margin=True):
        left = self.reach - np.linalg.norm(poses.position, axis=1)
        return Judgement(left > 0, left)


def test_two_criteria_of_one_class_are_two_questions(tmp_path):
    """Their repr is an address, and the next object may get the same one."""
    counts = [int(cl.workspace(robot_1r2t(), GRID, Nearer(reach), checkpoint=tmp_path)[0].sum())
              for reach in (0.5, 1.0, 1.5)]
    assert counts[0] < counts[1] < counts[2]


def test_another_law_of_one_class_is_another_question(tmp_path, monkeypatch):
    first = cl.workspace(robot_1r2t(), GRID, Nearer(1.0), checkpoint=tmp_path).inside

    def judge(self, robot, poses, margin=True):
        return Judgement(np.ones(len(poses), bool), np.zeros(len(poses)))

    monkeypatch.setattr(Nearer, "judge", judge)
    assert not first.all() and cl.workspace(robot_1r2t(), GRID, Nearer(1.0), checkpoint=tmp_path).inside.all()


def test_another_version_of_the_package_is_another_question(tmp_path, monkeypatch):
    sweep(tmp_path)
    kept = set(os.listdir(tmp_path))
    sweep(tmp_path)
    assert set(os.listdir(tmp_path)) == kept
    read = Path.read_bytes
    monkeypatch.setattr(Path, "read_bytes", lambda path: read(path) + b"# changed" * (path.name == "law.py"))
    sweep(tmp_path)
    assert len(os.listdir(tmp_path)) == 2 * len(kept)


def test_a_criterion_that_cannot_be_told_apart_keeps_no_checkpoint(tmp_path):
    own = Nearer(1.0)
    own.rule = lambda: None
    with pytest.raises(InvalidInput, match="can be pickled"):
        cl.workspace(robot_1r2t(), GRID, own, checkpoint=tmp_path)


_SWEEPING = """
import sys, cdprlab as cl
from cdprlab.workspace import position_grid
print("ready", flush=True)
robot, grid = cl.load_world("planar_rigid").robot, position_grid([-1.0, 0.2], [1.0, 1.8], 0.02)
cl.workspace(robot, grid, cl.WrenchFeasible(), chunk=64, checkpoint=sys.argv[1])
"""


@pytest.mark.skipif(WINDOWS, reason="SIGKILL")
@pytest.mark.parametrize("kills", [2, pytest.param(10, marks=pytest.mark.long)])
def test_a_sweep_killed_again_and_again_comes_to_the_same_answer(kills, tmp_path):
    rng = np.random.default_rng(5)
    for _ in range(kills):
        with subprocess.Popen([sys.executable, "-c", _SWEEPING, tmp_path], stdout=subprocess.PIPE) as process:
            process.stdout.readline()
            try:
                process.wait(0.05 + 0.15 * rng.random())
            except subprocess.TimeoutExpired:
                process.send_signal(signal.SIGKILL)
    robot, grid = cl.load_world("planar_rigid").robot, position_grid([-1.0, 0.2], [1.0, 1.8], 0.02)
    kept = cl.workspace(robot, grid, cl.WrenchFeasible(), chunk=64, checkpoint=tmp_path)
    plain = cl.workspace(robot, grid, cl.WrenchFeasible(), chunk=64)
    assert np.array_equal(kept.inside, plain.inside) and np.array_equal(kept.margin, plain.margin)
    assert {path.suffix for path in tmp_path.iterdir()} == {".npz"}


# --- films ----------------------------------------------------------------------------------------------
@pytest.mark.parametrize("fps", [1, 8, 12, 24, 25, 30, 60, 90, 144, 1000])
def test_a_film_plays_as_long_as_it_promises(fps, tmp_path):
    """To half a hundredth of a second, GIF's grain; no picture shorter than players show."""
    rng = np.random.default_rng(fps)
    frames = [rng.integers(0, 255, (24, 24, 3), dtype=np.uint8) for _ in range(int(1.5 * fps) + 1)]
    with Image.open(save_gif(frames, tmp_path / "film.gif", 1 / fps, "")) as film:
        lengths = []
        for k in range(film.n_frames):
            film.seek(k)
            lengths.append(film.info["duration"])
        assert np.array_equal(np.array(film.convert("RGB")).shape, frames[-1].shape)
    *played, pause = lengths
    assert abs(sum(played) - 1000 * (len(frames) - 1) / fps) <= 5 and min(played) >= 20 and pause == 1000
