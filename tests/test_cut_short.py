"""A flight that ends early: the error keeps its type and carries what was flown until then."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import cdprlab as cl
from cdprlab.fastkit import pick_and_place
from cdprlab.run.switching import follow_sequence
from cdprlab.simulate.spatial import SpatialSimulator


class Mistake(Exception):
    """Of the caller's own."""


class Closed(Exception):
    """Takes no more attributes."""

    __slots__ = ()

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError(name)


def failing(moment: float, error: BaseException) -> Callable[..., Any]:
    law = cl.ComputedTorque()

    def controller(t: float, state: Any, reference: Any) -> Any:
        if t > moment - 1e-9:
            raise error
        return law(t, state, reference)

    return controller


@pytest.mark.parametrize("name", ["planar_rigid", "caroca"])
@pytest.mark.parametrize("error", [Mistake("forgot a sign"), KeyboardInterrupt(), SystemExit(3)])
def test_an_error_in_a_controller_carries_the_flight_until_then(name: str, error: BaseException, tmp_path):
    world = cl.load_world(name)
    whole = cl.run(world, duration=0.04, control_period=2e-3)
    for steps in (0, 10):
        with pytest.raises(type(error)) as caught:
            cl.run(world, duration=0.04, control_period=2e-3, controller=failing(2e-3 * steps, error))
        flown = caught.value.run
        assert flown.cut_short.startswith(type(error).__name__)
        assert not whole.cut_short and "cut short" in flown.table() and "cut short" not in whole.table()
        for column, (values, _) in whole.columns().items():
            np.testing.assert_array_equal(flown.columns()[column][0], values[:steps], err_msg=column)
        flown.save(tmp_path / str(steps))
        assert len(np.load(tmp_path / str(steps) / "log.npz")["time"]) == steps


@pytest.mark.parametrize("cables", ["tension", "force", "length"])
def test_ctrl_c_between_two_steps_loses_none(cables: str):
    def interrupt(done: int, total: int):
        if done == 20:
            raise KeyboardInterrupt

    world = cl.load_world("caroca")
    whole = cl.run(world, cables=cables, duration=0.03)
    with pytest.raises(KeyboardInterrupt) as caught:
        cl.run(world, cables=cables, duration=0.03, progress=interrupt)
    flown = caught.value.run
    assert flown.time.size == 20
    np.testing.assert_array_equal(flown.measured_tensions, whole.measured_tensions[:20])


def test_an_error_that_takes_nothing_more_is_raised_as_it_is():
    with pytest.raises(Closed):
        cl.run(cl.load_world("planar_point"), duration=0.01, controller=failing(0.005, Closed()))


def test_a_sequence_cut_short():
    world = cl.load_world("marionet")
    sequence = cl.plan_configurations(world.robot, [0.6, 0.8, 0.8], [0.7, 0.8, 0.8])[0]
    with pytest.MonkeyPatch.context() as patch:
        reel, left = SpatialSimulator.reel, [300]

        def reel_until(self: Any, lengths: list[float]) -> None:
            left[0] -= 1
            if left[0] < 0:
                raise KeyboardInterrupt
            reel(self, lengths)

        patch.setattr(SpatialSimulator, "reel", reel_until)
        with pytest.raises(KeyboardInterrupt) as caught:
            follow_sequence(world, sequence)
    flown = caught.value.run
    assert 0 < flown.time.size <= 300 and len(flown.commanded_lengths) == len(flown.errors) == flown.time.size


@pytest.mark.parametrize("moment", [0.0, 1.5])
def test_a_job_cut_short(moment: float, tmp_path):
    def interrupt(done: int, total: int):
        if done >= 1e3 * moment:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt) as caught:
        pick_and_place(cl.load_world("fastkit_suspended"), progress=interrupt)
    job = caught.value.run
    assert job.cut_short == "KeyboardInterrupt" and job.time[-1] == pytest.approx(moment, abs=0.4)
    assert {len(values) for values, _ in job.columns().values()} == {job.time.size}
    assert job.table()["cut short"] == "KeyboardInterrupt"
    job.save(tmp_path)
