"""What checks say to a student, and the results to go on with."""

from __future__ import annotations

import re
import warnings
from pathlib import Path

import mutants
import notebooks
import numpy as np
import pytest

import cdprlab as cl
from cdprlab import course
from cdprlab.course.answers import fallback as stored


def test_a_failed_check_says_its_sentence_first_and_numbers_below():
    with pytest.raises(AssertionError) as failed:
        course.check(np.array([True, False]), "Cables pull.", yours=np.array([1.0, -2.0]), right=3)
    assert str(failed.value) == "Cables pull.\n  yours: [ 1., -2.]\n  right: 3"


def test_a_failed_check_shows_no_traceback_in_a_notebook():
    from IPython.core.interactiveshell import InteractiveShell

    shell = InteractiveShell.instance()
    shown: list[str] = []
    shell._showtraceback = lambda etype, evalue, stb: shown.extend(stb)
    shell.run_cell("from cdprlab import course\ndef helper():\n    course.check(False, 'Look again.')\nhelper()")
    assert shown == ["AssertionError: Look again.", "(line 4 of the check)"]
    InteractiveShell.clear_instance()


def test_an_answer_is_float_arrays_however_it_was_written():
    one, two, truth = course.answer(lambda: ([1, 2], np.float32(0.5), [True, False]))
    assert (one.dtype, two.dtype, truth.dtype) == (float, float, bool)
    assert course.answer(lambda: ["a", "b"]) == ["a", "b"]
    assert course.answer(lambda: [[1], [2, 3]]) == [[1], [2, 3]]


def test_a_forgotten_return_is_named():
    with pytest.raises(AssertionError, match="returned nothing: is there a `return`"):
        course.answer(lambda: None)
    assert course.answer(lambda: None, may_be_none=True) is None


def test_what_was_given_must_stay_as_it_is():
    def spoil(values):
        values *= 2
        return values

    given = np.ones(3)
    with pytest.raises(AssertionError, match="changes what it was given"):
        course.answer(spoil, given)
    assert (given == 1).all()


def test_warnings_of_an_answer_do_not_reach_stderr(capsys: pytest.CaptureFixture[str]):
    def warn():
        warnings.warn("old", DeprecationWarning, stacklevel=1)
        return 1.0

    with warnings.catch_warnings():
        warnings.simplefilter("always")
        warnings.showwarning = lambda message, *rest, **more: print(message, file=__import__("sys").stderr)
        course.answer(warn)
    captured = capsys.readouterr()
    assert (captured.out, captured.err) == ("old\n", "")


def test_recorded_results_come_back(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(stored, "RECORDED", tmp_path)
    pose, result = cl.Pose([1.0, 2.0, 3.0]), (np.eye(2), [1, None], {"a": True}, cl.Pose([0.5, 1.0], angle=0.1))
    monkeypatch.syspath_prepend(notebooks.SOURCE)
    notebooks.source_tool("record_fallbacks").record("99_both", {
        "one": [(stored.fingerprint((pose, 2)), result)],
        "other": [(stored.fingerprint((np.ones(k),)), k) for k in range(4)]})
    one, other = course.fallback("both")
    again = one(cl.Pose([1.0, 2.0, 3.0 + 1e-9]), 2)
    assert (again[0] == np.eye(2)).all() and again[1:3] == ([1, None], {"a": True})
    assert again[3].angle == pytest.approx(0.1) and [other(np.ones(k)) for k in range(4)] == [0, 1, 2, 3]
    with pytest.raises(cl.CdprError, match="only what this lesson's own cells ask"):
        other(np.zeros(2) + 7)
    with pytest.raises(cl.CdprError, match=r"no fallback 'none'; there are .*99_both"):
        course.fallback("none")


@pytest.mark.parametrize("lesson", sorted({path.stem[:2] for path in stored.RECORDED.glob("*.gz")}))
def test_every_exercise_of_a_recorded_lesson_has_a_fallback(lesson: str):
    (name,) = (name for name in notebooks.names() if name.startswith(lesson))
    notebook = notebooks.read_copy(name)
    text = "\n".join(cell.source for cell in notebook.cells if cell.cell_type == "code")
    stand_ins = re.findall(r'^# ([\w, ]+) = (course\.fallback\(".*"\)|lambda: \w+)$', text, re.MULTILINE)
    answers = [notebook.cells[index].source for index in notebooks.answers(notebook).values()]
    assert [functions for functions, _ in stand_ins] == [", ".join(mutants.defined(answer)) for answer in answers]
    named = [found[1] for _, offer in stand_ins if (found := re.fullmatch(r'course\.fallback\("([^"]+)"\)', offer))]
    # What is a student's own work, a design, is replaced by a robot of the lesson's, and recorded nowhere.
    recorded = {path.stem for path in stored.RECORDED.glob(f"{lesson}_*.gz")}
    assert recorded <= {*named, *(f"{lesson}_{exercise}" for exercise in named)}
    for exercise in named:
        course.fallback(exercise)
