"""Predictions: asked before an explorer opens, told beside the truth, which the explorer itself shows."""

import ast

import notebooks
import numpy as np
import pytest

import cdprlab as cl
from cdprlab import course
from cdprlab.course import Question, predict
from cdprlab.errors import InvalidInput
from cdprlab.fastkit import Vehicle


def asked():
    """(lesson, explorer's expression, questions' expressions) of every lesson."""
    for name in notebooks.names():
        for cell in notebooks.read_source(name).cells:
            for call in ast.walk(ast.parse(cell.source)) if "course.predict(" in cell.source else ():
                if isinstance(call, ast.Call) and ast.unparse(call.func) == "course.predict":
                    before = [line for line in cell.source.split("\n")
                              if line.startswith(("explorer", "turned", "designer"))]
                    yield name, "\n".join(before), *map(ast.unparse, call.args)



@pytest.fixture
def gains():
    explorer = predict(course.gain_explorer(), Question("stable for K_d below [1/s]", "stable for K_d below", kd=300.0),
                       Question("it gets", "worse", "better / worse"))
    yield explorer
    explorer.close()


def parts(explorer):
    """Form, answers beside truths, explorer."""
    return explorer.widget.children


def test_it_opens_when_every_question_is_answered(gains):
    form, truths, inside = parts(gains)
    _, number, choice, opens = form.children
    assert (inside.layout.display, truths.layout.display, opens.disabled) == ("none", "none", True)
    for entered in ("many", "", "1e"):
        number.value, choice.value = entered, "better"
        assert opens.disabled
    number.value = "400,5"
    assert not opens.disabled
    opens.click()
    assert (form.layout.display, inside.layout.display, truths.layout.display) == ("none", "", "")
    first, second = truths.children
    assert "you said <b>400.5</b>" in first.children[0].value and "it is" not in first.children[0].value
    first.children[1].click()
    assert f"it is <b>{gains.text.split('K_d below')[1].split()[0]}</b>" in first.children[0].value
    assert gains.values["kd"] == 300.0
    second.children[1].click()
    assert "you said <b>better</b>, it is <b>worse</b>" in second.children[0].value


def test_programs_see_no_difference(gains):
    gains.set(kd=100.0)
    assert "stable" in gains.text and gains.picture.startswith(b"\x89PNG")
    assert gains._repr_mimebundle_()[0]["text/plain"] if isinstance(gains._repr_mimebundle_(), tuple) \
        else gains._repr_mimebundle_()["text/plain"]


def test_a_truth_can_be_chosen():
    with pytest.raises(InvalidInput, match="one of rise / fall, got 'stay'"):
        Question("the pulls", "stay", "rise / fall")


def test_the_truths_are_folded_away():
    """They stand in the cell that asks."""
    asking = [(name, cell) for name in notebooks.names() for cell in notebooks.read_source(name).cells
              if cell.cell_type == "code" and "course.predict(" in cell.source]
    assert len(asking) >= 16
    assert [name for name, cell in asking if not cell.metadata.get("jupyter", {}).get("source_hidden")] == []


WORLDS = {
    "00": {"world": "caroca"}, "01": {"room": "caroca"}, "04": {"caroca": "caroca"}, "06": {"rigid": "planar_rigid"},
    "11": {"room": "marionet"}, "12": {"room": "marionet"}, "14": {"world": "fastkit_suspended"},
    "15": {"first": "caroca"}}
"""What lessons call them."""


@pytest.mark.parametrize("case", [*asked()], ids=lambda case: f"{case[0][:2]} {case[2][:40]}")
def test_every_lesson_finds_its_truths(case):
    """Where a question sends the controls they can go, and what is read there is there."""
    lesson, before, subject, *questions = case
    names = {"cl": cl, "np": np, "course": course, "ask": Question, "hanging_point": None,
             "brief": course.workshop_brief()}
    names |= {name: cl.load_world(world) for name, world in WORLDS.get(lesson[:2], {"planar": "planar_mcdpr"}).items()}
    if lesson.startswith("10"):
        names["pair"] = Vehicle.of(cl.load_world("fastkit_suspended").robot, 1.6)
    exec(before, names)
    explorer = eval(subject, names)
    explorer._repr_mimebundle_()
    for question in questions:
        asked = eval(question, names)
        assert asked.true_of(explorer), question
        assert len(asked.text) <= 62
    explorer.close()
