"""Ropes that stretch ring as their world says: at their stiffness's frequency, as long as their damping lets them."""

import numpy as np
import pytest

import cdprlab as cl

MASS, STEP = 20.0, 1e-3


def between_six(axial_stiffness, damping=0.0, mass=MASS):
    """A point mass between three pairs of opposed ropes of 2 m, without gravity."""
    ends = 2.0 * np.vstack([np.eye(3), -np.eye(3)])
    return cl.World.from_dict({
        "name": "ringing", "motion_pattern": "3T", "gravity": 0.0, "scene": {"floor": {"height": -5}},
        "platform": {"mass": mass, "size": [0.1] * 3, "pose": {"position": [0, 0, 0]}},
        "cable": {"axial_stiffness": axial_stiffness, "damping": damping}, "cable_limits": {"tension": [0, 5e4]},
        "cables": [{"exit_point": list(end), "anchor_point": [0, 0, 0]} for end in ends.tolist()]})


def heights(world, start, unstrained, steps):
    z = np.empty(steps)
    with cl.open_simulator(world, "elastic", STEP) as simulator:
        simulator.reset(cl.Pose([0, 0, start]))
        for k in range(steps):
            simulator.wind(np.full(6, unstrained))
            z[k] = simulator.position[2]
    return z


def peaks(z):
    """(k,) indices and heights of the maxima, between the samples."""
    i = np.flatnonzero((z[1:-1] > z[:-2]) & (z[1:-1] >= z[2:])) + 1
    bend, slope = z[i - 1] - 2 * z[i] + z[i + 1], (z[i + 1] - z[i - 1]) / 2
    return i - slope / bend, z[i] - slope**2 / (2 * bend)


@pytest.mark.parametrize("axial_stiffness", [2e4, 2e5, 1e6])   # 5, 16 and 36 Hz
@pytest.mark.parametrize("damping", [0.0, 0.02, 0.1])
def test_frequency_and_damping_are_the_world_s(axial_stiffness, damping):
    """Two ropes in line, k = EA / ρ each and d = 2 ζ √(k m) each: together √2 ζ of critical.

    The other four are as tight, and hold the mass back by T / l each. Second order in ω dt:
    (ω dt)² / 12 of the frequency, which is 0.4 % at 36 Hz, and as much of the damping's part.
    """
    unstrained = 2 / 1.005
    stiffness = 2 * axial_stiffness / unstrained + 4 * axial_stiffness * 0.005 / 2
    omega = np.sqrt(stiffness / MASS)
    z = heights(between_six(axial_stiffness, damping), 2e-3, unstrained, int(4.5 * 2 * np.pi / omega / STEP))
    at, high = peaks(z)
    decay = np.log(high[0] / high[-1]) / (len(high) - 1)
    assert decay / np.hypot(2 * np.pi, decay) == pytest.approx(np.sqrt(2) * damping, rel=0.03, abs=1e-4)
    period = (at[-1] - at[0]) / (len(at) - 1) * STEP
    ringing = omega * np.sqrt(1 - 2 * damping**2)
    assert 2 * np.pi / period == pytest.approx(ringing, rel=0.01 if damping else 5e-3)


def test_slack_ropes_give_back_what_they_took():
    """5 cm up and thrown back and forth by ropes 1 cm too long: the amplitude stays over many bounces."""
    z = heights(between_six(1e5), 0.05, 2.01, 3000)
    assert np.abs(z[-1000:]).max() == pytest.approx(0.05, rel=1e-3) and z.min() == pytest.approx(-0.05, rel=1e-3)


@pytest.mark.parametrize("axial_stiffness", [1e7, 1e8, 1e9])
def test_what_rings_too_fast_for_the_step_settles(axial_stiffness):
    """ω dt of 3 to 30: it would alternate from step to step, and is damped."""
    z = heights(between_six(axial_stiffness, mass=1.0), 1e-5, 2 / (1 + 2e-5), 500)
    assert np.abs(z[-100:]).max() < 1e-9
