"""Explorers that grey controls: these change nothing, all others do, and Reset goes back."""

import numpy as np
import pytest
from every_explorer import EVERY_EXPLORER

from cdprlab.course import Slider

GREYING = ("force polygon, 2 cables", "Gauss–Newton", "tensions", "workspaces", "bases", "configurations")
LATER = ("slack", "form")
"""Of a flight to come; and of uncertainties larger than those at the start."""


@pytest.fixture(scope="module", params=GREYING)
def explorer(request):
    made = EVERY_EXPLORER[request.param]()
    yield made
    made.close()


def other(control, now):
    """Another value of a control, far from the present one."""
    if isinstance(control, Slider):
        return control.high if now < (control.low + control.high) / 2 else control.low
    return next(option for option in reversed(control.options) if option != now)


def told(explorer):
    return explorer.text, explorer.picture


def test_a_grey_control_changes_nothing_and_says_why(explorer):
    rng = np.random.default_rng(15)
    start = explorer.values
    for _ in range(2):
        idle = explorer.idle(explorer.values)
        for name, why in idle.items():
            assert explorer.sliders[name].disabled and explorer.controls[name].label in explorer._why.value and why
            before = told(explorer)
            explorer.set(**{name: other(explorer.controls[name], explorer.values[name])})
            if explorer.idle(explorer.values).keys() == idle.keys():
                assert told(explorer) == before, name
        explorer.set(**start)
        explorer.set(**{name: control.options[rng.integers(len(control.options))]
                        for name, control in explorer.controls.items() if not isinstance(control, Slider)})
    explorer.set(**start)


def test_every_other_control_changes_something(explorer):
    start, before = explorer.values, told(explorer)
    for name, control in explorer.controls.items():
        if name not in explorer.idle(start) and name not in LATER:
            explorer.set(**{name: other(control, start[name])})
            assert told(explorer) != before, name
            explorer.set(**start)


def test_reset_goes_back_to_the_picture_first_shown(explorer):
    explorer._repr_mimebundle_()
    before = told(explorer)
    explorer.set(**{name: other(control, explorer.values[name]) for name, control in explorer.controls.items()
                    if isinstance(control, Slider)})
    explorer.reset()
    assert told(explorer) == before and "<i>" not in explorer._numbers.value
