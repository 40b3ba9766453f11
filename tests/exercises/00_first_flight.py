"""Lesson 00: the exercises' kind of input, and the mutants that answer the same."""

from __future__ import annotations

import numpy as np

import cdprlab as cl


def hardest(rng, lesson):
    steps, m = rng.integers(2, 40), rng.integers(2, 12)
    return [("hardest_pull", (np.sort(rng.uniform(0, 9, steps)), rng.uniform(10, 500, (steps, m))))]


def support(rng, lesson):
    m = rng.integers(2, 12)
    return [("support_force", (rng.normal(size=(m, 3)) + [0, 0, 4], rng.normal(size=(m, 3)), rng.uniform(5, 500, m)))]


def cut(rng, lesson):
    world = cl.load_world(rng.choice(["okoli_cube", "caroca"]))
    m = world.robot.n_cables
    cable, duration = int(rng.integers(1, m + 1)), rng.integers(2, 10) * 1e-3
    return [("cut_and_fall", (world, rng.uniform(100, 300, m), cable, duration))]


DRAWS = {"hardest": hardest, "support": support, "cut": cut}
EQUIVALENT: dict[str, dict[str, str]] = {}
