"""Mistakes planted by machine in the exercises: a seeded tenth here, all of them by `make mutants`."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable
from typing import Any

import mutants
import notebooks
import numpy as np
import pytest

SHARE = 0.1

every_lesson = pytest.mark.parametrize("lesson", mutants.lessons())
needs_alarm = pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="no timer that stops a mutant here")


@pytest.fixture(autouse=True)
def _undrawn(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setitem(os.environ, "MPLBACKEND", "Agg")
    yield
    notebooks.round_to_nearest()


@needs_alarm
@every_lesson
def test_visible_checks_notice_mistakes_planted_by_machine(lesson: str):
    rng = np.random.default_rng(14)
    found = []
    for exercise in mutants.exercises(lesson):
        all_of_them = exercise.mutants()
        chosen = rng.choice(len(all_of_them), max(2, round(SHARE * len(all_of_them))), replace=False)
        verdicts = [exercise.verdict(all_of_them[index]) for index in sorted(chosen)]
        found += [f"{exercise.name}: {fault}" for fault in mutants.faults(exercise, verdicts)]
    assert found == [], f"`python tests/mutants.py {lesson}` tries all"


@pytest.mark.parametrize(("lesson", "write"), [
    pytest.param(lesson, write, marks=[pytest.mark.long] * bool((k + 2 * lists) % 4))
    for k, lesson in enumerate(mutants.lessons())
    for lists, write in enumerate((mutants.as_float32, mutants.as_lists))])
def test_right_answers_earn_their_points_however_they_are_written(lesson: str, write: Callable[[Any], Any]):
    for exercise in mutants.exercises(lesson):
        for name in exercise.functions:
            mutant = mutants.around(name, write.__name__, outward=write)
            verdict = exercise.noticed(mutant, exercise.check)
            assert verdict is None, f"{exercise.name}, {name} {write.__name__}: {verdict}"


@every_lesson
def test_other_right_answers_earn_their_points(lesson: str):
    for exercise in mutants.exercises(lesson):
        for what, source in exercise.others:
            verdict = exercise.noticed(mutants.Mutant(what, source), exercise.check)
            assert verdict is None, f"{exercise.name}, {what}: {verdict}"
