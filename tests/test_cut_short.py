"""A flight that ends early: the error keeps its type and carries what was flown until then."""

import sys
import warnings
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import cdprlab as cl
from cdprlab.errors import CdprWarning
from cdprlab.fastkit import STOPPED, Trip, in_hall, pick_and_place, run_mission
from cdprlab.fastkit.mission.around_the_shelf import BOUNDS, PALLETS, START
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


def interrupted(work: Callable[[], Any], at: int, error: BaseException | None) -> int:
    """How many lines of the package a piece of work comes by; at one of them the error happens."""
    count, root = 0, str(Path(cl.__file__).parent)

    def by_line(frame: Any, event: str, _: Any) -> Any:
        nonlocal count
        count += event == "line"
        if event == "line" and count == at and error:
            raise error
        return by_line

    before = sys.gettrace()
    sys.settrace(lambda frame, *_: by_line if frame.f_code.co_filename.startswith(root) else None)
    try:
        work()
    finally:
        sys.settrace(before)
    return count


@pytest.mark.parametrize("cables", ["tension", "length"])
def test_ctrl_c_at_any_line_once_the_first_step_is_flown(cables: str):
    """While steps are flown, and while what they came to is written down."""
    world, began = cl.load_world("planar_rigid"), []
    with cl.open_simulator(world, cables) as engine:
        def fly() -> None:
            cl.run(world, cables=cables, duration=0.01, simulator=engine, progress=lambda *_: began.append(0))

        fly()
        lines = interrupted(fly, 0, None)
        rng, kept = np.random.default_rng(4), 0
        for at in [*rng.integers(lines // 2, lines, 20).tolist(), *range(lines - 60, lines - 1, 4)]:
            began.clear()
            with pytest.raises(KeyboardInterrupt) as caught:
                interrupted(fly, at, KeyboardInterrupt())
            if began and hasattr(caught.value, "run"):
                kept += 1
                assert caught.value.run.cut_short == "KeyboardInterrupt" and caught.value.run.time.size <= 10
    assert kept >= 30


def test_a_warning_that_somebody_makes_an_error_costs_no_flight(recwarn: pytest.WarningsRecorder):
    def push(W: Any, w_e: Any, low: Any, high: Any) -> Any:
        return -np.linalg.pinv(W) @ w_e

    warnings.simplefilter("error")
    with pytest.raises(CdprWarning, match="carry") as caught:
        cl.run(cl.load_world("planar_rigid"), method=push, infeasible="send", duration=0.01)
    assert caught.value.run.time.size == 10


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


def test_repetitions_cut_short_are_those_that_were_finished():
    def interrupt(done: int, _: int) -> None:
        if done == 2:
            raise KeyboardInterrupt

    def ask(progress: Any = None, **how: Any) -> Any:
        return cl.repeat(cl.load_world("planar_point"), 3, errors={"mass": 0.1}, duration=0.02, n_jobs=1,
                         progress=progress, **how)

    with pytest.raises(KeyboardInterrupt) as caught:
        ask(interrupt)
    found = caught.value.run
    assert found.cut_short == "KeyboardInterrupt" == found.table()["cut short"] and "cut short" not in ask().table()
    np.testing.assert_array_equal(found.final_errors, ask().final_errors[:2])
    with pytest.raises(Mistake) as first:
        ask(controller=failing(0.01, Mistake()))
    assert first.value.run.time.size == 10


def test_a_mission_cut_short_is_saved_as_far_as_it_came(tmp_path):
    world = in_hall(cl.load_world("fastkit_suspended"), BOUNDS, PALLETS)

    def ask(until: float) -> Any:
        def interrupt(_: str, time: float) -> None:
            if time > until:
                raise KeyboardInterrupt

        with pytest.raises(KeyboardInterrupt) as caught:
            run_mission(world, BOUNDS, START, beams=31, progress=interrupt)
        return caught.value.run

    for until, rows in ((0.0, 1), (0.45, 5)):
        mission = ask(until)
        mission.save(tmp_path)
        assert mission.state == STOPPED and mission.cut_short == mission.reason == "KeyboardInterrupt"
        assert len((tmp_path / "way_there.csv").read_text().splitlines()) == 1 + rows == 1 + mission.journey.time.size
    with pytest.MonkeyPatch.context() as patch:   # as if it had arrived
        patch.setattr("cdprlab.fastkit.mission.states.at_the_shelf", lambda _: "")
        patch.setattr("cdprlab.fastkit.mission.states.stands_still", lambda _: "")
        last = {name: getattr(mission.journey, name)[-1:] for name in (
            "time", "estimates", "deviations", "clearance", "waiting")}
        patch.setattr(Trip, "drive_there", lambda trip, there: setattr(there, "journey", replace(
            mission.journey, poses=np.array([trip.berth]), **last)))
        mission = ask(0.9)
    assert {"way there", "work"} == {*mission.parts} and mission.job.cut_short and mission.now >= 0.9
    mission.save(tmp_path / "more")
    assert {"log.npz", "way_there.csv"} < {path.name for path in (tmp_path / "more").iterdir()}


def test_a_job_cut_short_before_its_first_step(tmp_path, monkeypatch: pytest.MonkeyPatch):
    def drive(*_: Any) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(SpatialSimulator, "drive", drive)
    with pytest.raises(KeyboardInterrupt) as caught:
        pick_and_place(cl.load_world("fastkit_suspended"))
    assert not caught.value.run.time.size
    caught.value.run.save(tmp_path)


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
