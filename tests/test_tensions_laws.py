"""Every method at thousands of poses against brute force: limits met two at a time in a basis of its own."""

import ast
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from polygons import Candidates
from scipy.optimize import linprog
from scipy.spatial import ConvexHull

import cdprlab as cl
from robots import random_poses, robot_1r2t, robot_3r3t

POSES = 2000
SPACES = {"caroca": ([-3, -1.8, 0.3], [3, 1.8, 3]), "caroca_light": ([-3, -1.8, 0.3], [3, 1.8, 3]),
          "cogiro": ([-6, -4, 0.5], [6, 4, 4.5]), "ipanema3": ([-7, -5, -0.2], [7, 5, 3])}
ROBOTS = (*SPACES, "planar")
COMPLETE = ("linear_program", "quadratic_program", "barycenter", "relaxed")
INCOMPLETE = ("pseudo_inverse", "closed_form", "improved_closed_form", "puncture")


@cache
def problem(name):
    """W, w_e, limits and brute force at random rotated poses, some of them out of reach."""
    rng = np.random.default_rng(5)
    if name == "planar":
        robot = robot_1r2t()
        poses, push = random_poses(robot, POSES, 5, turn=0.3), rng.normal(size=(POSES, 3)) * [900, 900, 150]
    else:
        robot, push = cl.load_world(name).robot, 0.0
        poses = cl.Pose(rng.uniform(*SPACES[name], (POSES, 3)), rpy=rng.uniform(-0.3, 0.3, (POSES, 3)))
    W, w_e = cl.wrench_matrix(robot, poses), cl.gravity_wrench(robot, poses) + push
    low, high = robot.tension_min, robot.tension_max
    return W, w_e, low, high, Candidates(W, w_e, low, high)


def asked(name, method, **options):
    W, w_e, low, high, _ = problem(name)
    return cl.distribute_tensions(W, w_e, low, high, method, **options)


@pytest.mark.parametrize("name", ROBOTS)
def test_brute_force_agrees_with_a_linear_program(name):
    W, w_e, low, high, brute = problem(name)
    assert 0.5 < brute.feasible.mean() < 0.995
    some = {*np.flatnonzero(~brute.feasible)[:15], *range(15)}
    for k in some:
        found = linprog(np.ones(low.size), A_eq=W[k], b_eq=-w_e[k], bounds=np.stack([low, high], axis=1))
        assert brute.feasible[k] == (found.status == 0)
        if brute.feasible[k]:
            assert brute.best(brute.points.sum(axis=-1))[k] == pytest.approx(found.fun, rel=1e-7)


@pytest.mark.parametrize("method", [*COMPLETE, *INCOMPLETE, "kernel"])
@pytest.mark.parametrize("name", ROBOTS)
def test_feasible_means_balanced_within_limits_and_complete_means_never_missed(name, method):
    W, w_e, low, high, brute = problem(name)
    found = asked(name, method)
    good, missed = found.feasible, brute.feasible & ~found.feasible
    residual = np.abs((W @ found.tensions[..., None])[..., 0] + w_e).max(axis=-1)
    assert (residual[good] <= 1e-8 * (1 + np.abs(w_e[good]).max(axis=-1))).all()
    assert (found.tensions[good] >= low).all() and (found.tensions[good] <= high).all()
    assert not (good & ~brute.feasible).any()
    assert ((found.reason == "") == good).all()
    if method == "kernel" and name != "planar":
        assert not good.any() and all("here r = 2" in text for text in found.reason)
    elif method in INCOMPLETE:
        assert not found.complete
        assert all(text.endswith("the LP says a distribution exists") for text in found.reason[missed])
        assert all(text.endswith("the LP says none exists") for text in found.reason[~brute.feasible])
    else:
        assert found.complete and not missed.any()


@pytest.mark.parametrize("name", ROBOTS)
def test_programs_find_the_best_corner_and_the_exact_projection(name):
    *_, brute = problem(name)
    least_sum, least_norm = asked(name, "linear_program"), asked(name, "quadratic_program")
    good = brute.feasible
    np.testing.assert_allclose(least_sum.tensions[good].sum(axis=-1), brute.best(brute.points.sum(axis=-1))[good],
                               rtol=1e-9)
    norms = np.linalg.norm(brute.points, axis=-1)
    np.testing.assert_allclose(np.linalg.norm(least_norm.tensions[good], axis=-1), brute.best(norms)[good], rtol=1e-9)
    nearest = np.where(brute.inside, norms, np.inf).argmin(axis=1)[good]
    np.testing.assert_allclose(least_norm.tensions[good], brute.points[good, nearest], rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize("name", ["caroca", "caroca_light", "cogiro", "ipanema3"])
def test_barycenter_is_the_area_centroid(name):
    *_, brute = problem(name)
    found = asked(name, "barycenter")
    for k in np.flatnonzero(brute.feasible)[:150]:
        corners = (brute.points[k, brute.corners & brute.inside[k]] - brute.least_norm[k]) @ brute.null[k]
        ring = corners[ConvexHull(corners).vertices]
        x, y = ring[:, 0], ring[:, 1]
        twice = x * np.roll(y, -1) - np.roll(x, -1) * y
        center = ((ring + np.roll(ring, -1, axis=0)) * twice[:, None]).sum(axis=0) / (3 * twice.sum())
        expected = brute.least_norm[k] + brute.null[k] @ center
        np.testing.assert_allclose(found.tensions[k], expected, rtol=1e-6, atol=1e-7 * np.ptp(corners))


@pytest.mark.parametrize("method", ["barycenter", "linear_program", "improved_closed_form", "puncture"])
@pytest.mark.parametrize("name", ["caroca_light", "planar"])
def test_no_basis_is_preferred(name, method):
    """Cables in another order and wrenches in other units: elimination meets another basis, the answer is the same."""
    W, w_e, low, high, _ = problem(name)
    rng = np.random.default_rng(2)
    order, mix = rng.permutation(low.size), rng.normal(size=(W.shape[1], W.shape[1]))
    mix += 3 * np.eye(W.shape[1])
    other = cl.distribute_tensions(mix @ W[:, :, order], w_e @ mix.T, low[order], high[order], method)
    one = asked(name, method)
    np.testing.assert_array_equal(one.feasible, other.feasible)
    np.testing.assert_allclose(one.tensions[one.feasible][:, order], other.tensions[one.feasible], rtol=1e-6, atol=1e-6)


def test_planar_barycenter_is_the_middle_and_the_kernel_interval_is_exact():
    W, _, low, high, brute = problem("planar")
    lowest, middle, highest = (asked("planar", "kernel", choice=choice) for choice in ("lowest", "middle", "highest"))
    good = brute.feasible
    for end in (lowest, highest):
        assert (end.margin[good] <= 1e-9 * high.max()).all()
    np.testing.assert_allclose(middle.tensions[good], (lowest.tensions + highest.tensions)[good] / 2, rtol=1e-9)
    np.testing.assert_allclose(asked("planar", "barycenter").tensions[good], middle.tensions[good], rtol=1e-12)
    h, past = brute.null[..., 0], 1e-6 * (highest.tensions - lowest.tensions)
    assert (np.abs(W @ h[..., None]).max() < 1e-12) and (highest.tensions - lowest.tensions)[good].sum(-1).min() > 0
    beyond = np.stack([lowest.tensions - past, highest.tensions + past])
    assert ((beyond < low) | (beyond > high)).any(axis=-1)[:, good].all()


def test_closed_forms_and_puncture_are_what_they_claim():
    W, w_e, low, high, _ = problem("cogiro")
    middle = (low + high) / 2
    closed, improved, puncture = (asked("cogiro", name) for name in ("closed_form", "improved_closed_form", "puncture"))
    formula = middle - (np.linalg.pinv(W) @ (w_e + W @ middle)[..., None])[..., 0]
    np.testing.assert_allclose(closed.tensions, formula, rtol=1e-9, atol=1e-6)
    assert (improved.feasible >= closed.feasible).all() and improved.feasible.sum() > closed.feasible.sum()
    np.testing.assert_allclose(improved.tensions[closed.feasible], closed.tensions[closed.feasible], rtol=1e-12)
    np.testing.assert_array_equal(puncture.feasible, improved.feasible)
    good = puncture.feasible
    # On the way from the least norm to the improved closed form, and no nearer to the first keeps the limits.
    least = -(np.linalg.pinv(W) @ w_e[..., None])[good, :, 0]
    inner, at = improved.tensions[good], puncture.tensions[good]
    way = inner - least
    share = ((at - least) * way).sum(axis=-1) / np.maximum((way * way).sum(axis=-1), 1e-12)
    np.testing.assert_allclose(at, least + share[:, None] * way, rtol=1e-7, atol=1e-5)
    before = at - 1e-6 * way
    outside = ((before < low) | (before > high)).any(axis=-1)
    kept = ((least >= low) & (least <= high)).all(axis=-1)
    assert (outside | kept).all() and 0 < kept.sum() < len(kept)
    np.testing.assert_allclose(at[kept], least[kept], rtol=1e-9, atol=1e-6)


def test_the_improved_closed_form_says_what_it_misses():
    world = cl.load_world("caroca_light")
    pose = cl.Pose([1, 0.5, 2], rpy=[0.1, -0.05, 0.15])
    W, w_e = cl.wrench_matrix(world.robot, pose), cl.gravity_wrench(world.robot, pose)
    found = cl.distribute_tensions(W, w_e, 1, 6500, "improved_closed_form")
    assert not found.feasible
    assert found.reason == "the improved closed form ran out of redundancy; the LP says a distribution exists"
    assert cl.distribute_tensions(W, w_e, 1, 6500, "linear_program").feasible
    *_, brute = problem("caroca_light")
    missed = (brute.feasible & ~asked("caroca_light", "improved_closed_form").feasible).sum() / brute.feasible.sum()
    assert 0.2 < missed < 0.4      # the thesis' corrections say about 28 %


def test_three_redundant_cables():
    """Nine cables: the linear program goes on, what needs a polygon says so."""
    W, w_e, *_ = problem("caroca_light")
    more = np.concatenate([W, np.random.default_rng(4).normal(size=(POSES, 6, 1))], axis=2)[:25]
    found = cl.distribute_tensions(more, w_e[:25], 1, 6500, "linear_program")
    for k in range(25):
        program = linprog(np.ones(9), A_eq=more[k], b_eq=-w_e[k], bounds=(1, 6500))
        assert found.feasible[k] == (program.status == 0)
        if found.feasible[k]:
            assert found.tensions[k].sum() == pytest.approx(program.fun, rel=1e-6)
    for method, says in (("barycenter", "at most 2"), ("kernel", "r = 3")):
        other = cl.distribute_tensions(more, w_e[:25], 1, 6500, method)
        assert not other.feasible.any() and all(says in text for text in other.reason)
        assert np.isnan(other.tensions).all()


def test_numba_stays_in_its_room_and_does_without_a_cache(monkeypatch):
    folder = Path(cl.__file__).parent
    importing = {path.relative_to(folder).as_posix() for path in folder.rglob("*.py")
                 for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))) if isinstance(node, ast.Import)
                 for alias in node.names if alias.name.split(".")[0] == "numba"}
    assert importing == {"compiled/jit.py"}
    from cdprlab.compiled import jit
    asked_for = []

    def njit(signature, **options):
        asked_for.append(options.get("cache", False))
        if options.get("cache"):
            raise RuntimeError("cannot cache function: no locator available")
        return lambda function: function

    def function():
        pass

    monkeypatch.setattr(jit.numba, "njit", njit)
    monkeypatch.setattr(jit.announcement, "often", "once")
    assert jit.machine_code(function) is function and asked_for == [True, False]
    assert "NUMBA_CACHE_DIR" in jit.announcement.often


def test_a_suspended_robot_cannot_be_pulled_to_the_middle_of_its_limits():
    robot = robot_3r3t()
    pose = cl.Pose([0, 0, 1])
    found = cl.distribute_tensions(cl.wrench_matrix(robot, pose), cl.gravity_wrench(robot, pose), 50, 10000,
                                   "closed_form")
    assert (found.tensions < 3000).all()   # 5025 N is the middle


def mixed_problem(rng):
    """1 to 6 rows, r from −1 to 3, limits from zero, equal or wide, tensions inside, on the border or missing."""
    n = rng.integers(1, 7)
    m = max(1, n + rng.integers(-1, 4))
    W = rng.normal(size=(n, m)) if rng.random() < 0.5 else rng.integers(-2, 3, (n, m)).astype(float)
    low = rng.choice([0.0, 1.0, 5.0], m)
    high = low + rng.choice([0.0, 1.0, 10.0, 1000.0], m)
    tau = low + (high - low) * rng.random(m)
    kind = rng.choice(["inside", "border", "anywhere"])
    if kind == "border":
        tau = np.where(rng.random(m) < 0.7, np.where(rng.random(m) < 0.5, low, high), tau)
    return W, -W @ tau + (kind == "anywhere") * rng.normal(size=n) * rng.choice([1, 10, 300]), low, high, kind


def test_problems_of_every_size_and_kind():
    rng = np.random.default_rng(8)
    for _ in range(250):
        W, w_e, low, high, kind = mixed_problem(rng)
        r = low.size - np.linalg.matrix_rank(W)
        exists = kind != "anywhere" or linprog(low, A_eq=W, b_eq=-w_e, bounds=np.stack([low, high], axis=1)).status == 0
        for method in cl.tension_methods():
            found = cl.distribute_tensions(W, w_e, low, high, method)
            applies = {"barycenter": r <= 2, "kernel": r == 1}.get(method, True)
            assert found.feasible == exists or not (found.complete and applies)
            assert exists or not found.feasible
            assert (found.reason == "") == found.feasible
            if found.feasible:
                assert ((found.tensions >= low) & (found.tensions <= high)).all()
                assert np.abs(W @ found.tensions + w_e).max() <= 1.001e-8 * (1 + np.abs(w_e).max())
