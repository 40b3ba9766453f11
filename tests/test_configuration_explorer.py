"""The configuration explorer: the library's classes and sequences, every end of every slider, flights, pictures."""

import itertools

import numpy as np
import pytest

import cdprlab as cl
from cdprlab import course
from cdprlab.configurations import classify_configurations, plan_configurations
from cdprlab.course.explorers.explorer import Slider
from cdprlab.course.pictures.configuration_plan import plot_sequences, plot_triplets
from cdprlab.course.pictures.flights import plot_flight
from cdprlab.errors import InvalidInput

WORLDS = ("marionet", "marionet_five")


@pytest.fixture(scope="module")
def explorer():
    explorer = course.configuration_explorer(cl.load_world("marionet"))
    yield explorer
    explorer.close()


def reset(explorer):
    explorer.set(**{name: control.start if isinstance(control, Slider) else control.options[0]
                    for name, control in explorer.controls.items()})


def test_it_says_what_the_library_says(explorer):
    reset(explorer)
    explorer.set(share=0.6, position_uncertainty=0.03, form="natural")
    start, goal = np.array([0.6, 0.8, 0.8]), np.array([1.9, 1.1, 0.5])
    found = plan_configurations(explorer.robot, start, goal, position_uncertainty=0.03)
    assert list(map(str, explorer.sequences)) == list(map(str, found))
    classes = classify_configurations(explorer.robot, start + 0.6 * (goal - start), 0.03, 0.02, form="natural")
    assert explorer.classes(explorer.values) == classes
    for chosen, verdict in classes.items():
        assert f"{chosen}: {verdict}" in explorer.text and f"{chosen} {verdict}" in explorer.alt_text
    assert all(str(sequence) in explorer.text for sequence in found)


@pytest.mark.parametrize("name", WORLDS)
def test_every_slider_answers_at_both_ends(name):
    explorer = course.configuration_explorer(cl.load_world(name))
    sliders = [control for control in explorer.controls.values() if isinstance(control, Slider)]
    choices = [control for control in explorer.controls.values() if not isinstance(control, Slider)]
    ends = [itertools.repeat("low"), itertools.repeat("high"), itertools.cycle(["low", "high"]),
            itertools.cycle(["high", "low"])]
    moves = [{slider.name: getattr(slider, end) for slider, end in zip(sliders, pattern)} for pattern in ends]
    for move in moves + [{choice.name: option} for choice in choices for option in choice.options]:
        explorer.set(**move)
        assert explorer.picture.startswith(b"\x89PNG") and "at (" in explorer.text
    explorer.close()


@pytest.mark.parametrize("corner", list(itertools.product((0, 1), repeat=2)))
def test_corners_of_the_room_have_no_sequence_but_a_reason(explorer, corner):
    reset(explorer)
    x, y = (explorer.controls[axis] for axis in ("Sx", "Sy"))
    explorer.set(Sx=(x.low, x.high)[corner[0]], Sy=(y.low, y.high)[corner[1]])
    if not explorer.sequences:
        assert "none: no three cables hold a load at the start" in explorer.text
        assert "no sequence" in explorer.alt_text
        with pytest.raises(InvalidInput, match="no sequence to fly"):
            explorer.fly()


def test_picking_more_than_there_are_takes_the_last(explorer):
    reset(explorer)
    explorer.set(pick=6)
    assert explorer.chosen(explorer.values) is explorer.sequences[-1]


def test_without_uncertainty_all_is_exact():
    explorer = course.configuration_explorer(cl.load_world("marionet"), uncertain=False)
    assert not {"form", "method", "exit_uncertainty", "position_uncertainty"} & set(explorer.controls)
    explorer.set(share=0.5)
    assert "uncertain" not in explorer.classes(explorer.values).values()
    explorer.close()


def test_the_chosen_sequence_flies_and_a_move_takes_the_flight_away(explorer):
    pytest.importorskip("pybullet", reason="PyBullet has no wheel here")
    reset(explorer)
    explorer.set(Sx=1.2, Sy=0.9, Sz=0.65, Gx=1.6, Gy=1.0, Gz=0.55, slack=0.02)
    explorer.button.click()
    assert explorer.run.position_errors.max() < 1e-5
    assert len(explorer.stage.children) == 2
    explorer.set(Sx=1.21)
    assert len(explorer.stage.children) == 1
    assert not explorer.button.disabled


def test_other_worlds_are_named():
    with pytest.raises(InvalidInput, match="3R3T"):
        course.configuration_explorer(cl.load_world("caroca"))
    with pytest.raises(InvalidInput, match="must be a World"):
        course.configuration_explorer(cl.load_world("marionet").robot)


# --- figures ------------------------------------------------------------------------------------------------
def test_figures_tell_in_words_what_they_show():
    world = cl.load_world("marionet")
    place = [1.38, 0.98, 0.6]
    figure = plot_triplets(world.robot, place, classify_configurations(world.robot, place, 0.05, 0.02))
    assert "A123 inside" in figure.alt_text and "A134 outside" in figure.alt_text
    own = plot_triplets(world.robot, [1.38, 0.98, 0.6], dict.fromkeys([(1, 2, 3), (1, 2, 4), (1, 3, 4), (2, 3, 4)],
                                                                    "uncertain"))
    assert own.alt_text.count("uncertain") == 4
    sequences = plan_configurations(world.robot, [0.6, 0.8, 0.8], [1.9, 1.1, 0.5])
    figure = plot_sequences(world.robot, sequences)
    assert len(figure.axes) == 3 and "A124 → A234: score 11, not safe" in figure.alt_text


def test_a_flights_figure_counts_what_was_not_planned():
    class World:
        name = "test"

    class Run:
        world, time, position_errors = World(), np.arange(10) * 0.1, np.linspace(0, 0.01, 10)

    planned = np.ones((10, 2), dtype=bool)
    planned[5:, 1] = False
    figure = plot_flight(Run(), planned, np.ones((10, 2), dtype=bool))
    assert "at most 10 mm off" in figure.alt_text and "50.0 % of the time" in figure.alt_text
