"""Polytopes against independent linear programs, Qhull and geometry by hand."""

import itertools

import numpy as np
import pytest
from programs import lp_contains, lp_support
from scipy.optimize import linprog
from scipy.spatial import ConvexHull, QhullError

import cdprlab as cl
from cdprlab.errors import InvalidInput, NotListable
from cdprlab.sets import hyperplane_shifting
from cdprlab.sets.listing import needed
from cdprlab.sets.simplex import maximize

KINDS = ["rows", "zonotope", "image", "flat zonotope", "flat image", "point", "segment"]


def some_polytope(kind, n, seed):
    """A random set in n dimensions, its origin inside."""
    rng = np.random.default_rng(seed)
    if kind == "rows":
        return cl.Polytope.from_rows(rng.normal(size=(4 * n + 2, n)), rng.uniform(0.5, 2.0, 4 * n + 2))
    M = rng.normal(size=(n, n + 3))
    if kind == "point":
        return cl.Polytope.from_box(M, np.zeros(n + 3), np.zeros(n + 3))
    if kind == "segment":
        M = rng.normal(size=(n, 1)) @ rng.normal(size=(1, n + 3))
    if "flat" in kind:
        M = rng.normal(size=(n, n - 1)) @ rng.normal(size=(n - 1, n + 3))
    low, high = -rng.uniform(0.2, 2.0, n + 3), rng.uniform(0.2, 2.0, n + 3)
    if "image" not in kind:
        return cl.Polytope.from_box(M, low, high)
    A = np.concatenate([np.eye(n + 3), -np.eye(n + 3), rng.normal(size=(4, n + 3))])
    return cl.Polytope.from_image(M, A, np.concatenate([high, -low, rng.uniform(0.3, 1.0, 4)]))


@pytest.mark.parametrize("seed", range(40))
def test_linear_programs_agree_with_highs_degenerate_empty_and_unbounded_ones_too(seed):
    rng = np.random.default_rng(seed)
    k, r = rng.integers(1, 10), rng.integers(1, 30)
    A = rng.normal(size=(r, k)) if seed % 3 else rng.integers(-2, 3, size=(r, k)).astype(float)
    b = [np.abs(rng.normal(size=r)), rng.normal(size=r) + 1, rng.integers(0, 3, size=r).astype(float)][seed % 3]
    goals = rng.normal(size=(5, k))
    for value, goal in zip(maximize(A, b, goals).values, goals):
        found = linprog(-goal, A_ub=A, b_ub=b, bounds=(None, None), method="highs")
        expected = {0: -(found.fun or 0.0), 2: -np.inf, 3: np.inf}[found.status]
        assert value == pytest.approx(expected, rel=1e-8, abs=1e-8)


def test_a_batch_of_limits_and_objectives_is_each_program_alone():
    rng = np.random.default_rng(8)
    A, b, c = rng.normal(size=(12, 3)), rng.normal(size=(6, 1, 12)) + 0.7, rng.normal(size=(4, 3))
    together = maximize(A, b, c)
    assert together.values.shape == (6, 4) and np.isneginf(together.values).any() and np.isfinite(together.values).any()
    for i, j in np.ndindex(6, 4):
        alone = maximize(A, b[i, 0], c[j])
        np.testing.assert_allclose(together.values[i, j], alone.values, rtol=1e-12)
        np.testing.assert_allclose(together.points[i, j], alone.points, rtol=1e-9)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("n", [2, 3, 6])
def test_support_equals_an_independent_lp(kind, n):
    polytope = some_polytope(kind, n, seed=n)
    directions = np.random.default_rng(1).normal(size=(200, n))
    h = polytope.support(directions)
    np.testing.assert_allclose(h, lp_support(polytope, directions), rtol=0, atol=1e-9)
    points = polytope.support_point(directions)
    np.testing.assert_allclose((directions * points).sum(axis=1), h, rtol=0, atol=1e-9)
    assert polytope.contains(points).all()
    assert (directions @ points.T <= h[:, None] + 1e-9).all()


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("n", [2, 3, 6])
def test_contains_agrees_with_highs_inside_outside_and_off_a_flat_set(kind, n):
    polytope = some_polytope(kind, n, seed=n + 1)
    rng = np.random.default_rng(2)
    ends = polytope.support_point(rng.normal(size=(25, n)))
    mixed = np.concatenate([0.7 * ends + 0.3 * ends[::-1], 1.3 * ends, ends + 0.05 * rng.normal(size=ends.shape)])
    inside = polytope.contains(mixed)
    assert inside.tolist() == [lp_contains(polytope, x) for x in mixed]
    assert inside[:25].all() and (not inside.all() or kind == "point")
    assert polytope.contains(mixed.reshape(3, 25, n)).shape == (3, 25)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("n", [2, 3, 5])
def test_vertices_and_facets_are_each_others_dual(kind, n):
    polytope = some_polytope(kind, n, seed=n + 2)
    v, normals, offsets = polytope.vertices, polytope.normals, polytope.offsets
    scale = np.abs(v).max() + 1
    np.testing.assert_allclose((normals @ v.T).max(axis=1), offsets, rtol=0, atol=1e-8 * scale)
    directions = np.random.default_rng(3).normal(size=(100, n))
    np.testing.assert_allclose((directions @ v.T).max(axis=1), polytope.support(directions), rtol=0, atol=1e-8 * scale)
    on = np.abs(normals @ v.T - offsets[:, None]) < 1e-7 * scale    # facets by vertices
    assert (on.sum(axis=1) >= max(polytope.dimension, 1)).all() and (on.sum(axis=0) >= n).all()
    again = cl.Polytope.from_rows(normals, offsets)
    np.testing.assert_allclose(again.support(directions), polytope.support(directions), rtol=0, atol=1e-7 * scale)


def test_whether_a_set_is_listed_is_no_matter_of_rounding(monkeypatch):
    """Of this set's hulls Qhull gives up on three in a hundred, by how their last digits fall."""
    rng = np.random.default_rng(0)
    give_ups = []

    def rounded(points):
        try:
            return ConvexHull(points * (1 + 1e-16 * rng.integers(-2, 3, points.shape)))
        except QhullError:
            give_ups.append(points)
            raise

    monkeypatch.setattr("scipy.spatial.ConvexHull", rounded)
    for _ in range(60):
        polytope = some_polytope("image", 5, seed=7)
        assert len(polytope.normals) == 257 and len(polytope.vertices) == 439
    assert give_ups


@pytest.mark.parametrize("kind", ["rows", "zonotope", "image"])
@pytest.mark.parametrize("n", [2, 3])
def test_no_facet_and_no_vertex_is_superfluous(kind, n):
    polytope = some_polytope(kind, n, seed=n + 3)
    hull = ConvexHull(polytope.vertices)
    assert len(hull.vertices) == len(polytope.vertices)
    assert polytope.volume == pytest.approx(hull.volume, rel=1e-9)
    for i in range(len(polytope.offsets)):
        relaxed = polytope.offsets + (np.arange(len(polytope.offsets)) == i)
        assert maximize(polytope.normals, relaxed, polytope.normals[i]).values > polytope.offsets[i] + 1e-6


@pytest.mark.parametrize("n, k", [(2, 4), (2, 6), (3, 5), (3, 7), (4, 6), (6, 8)])
def test_hyperplane_shifting_gives_qhulls_merged_planes(n, k):
    rng = np.random.default_rng(n + k)
    generators = rng.normal(size=(n, k))
    normals, offsets = hyperplane_shifting(generators)
    corners = np.array(list(itertools.product([-1, 1], repeat=k))) @ generators.T
    planes = np.unique(ConvexHull(corners).equations.round(7), axis=0)
    mine = np.column_stack([normals, -offsets])
    assert len(planes) == len(mine)
    gaps = np.abs(planes[:, None] - mine[None]).max(axis=-1)
    assert (gaps.min(axis=0) < 1e-6).all() and (gaps.min(axis=1) < 1e-6).all()


def test_parallel_and_vanishing_generators_make_one_facet():
    generators = np.array([[1.0, 2.0, 0.0, 0.0, 0.0], [0, 0, 1, -1, 0], [0, 0, 1, 1, 0]])
    normals, offsets = hyperplane_shifting(generators)
    assert len(normals) == 6
    assert sorted(offsets.round(12)) == pytest.approx([np.sqrt(2)] * 4 + [3.0] * 2)


@pytest.mark.parametrize("kind", ["rows", "zonotope", "image"])
@pytest.mark.parametrize("n", [2, 6])
def test_axis_section_by_bisection(kind, n):
    polytope = some_polytope(kind, n, seed=n + 4)
    origin = 0.3 * polytope.support_point(np.ones(n))
    section = polytope.axis_section(origin)
    for axis, sign, end in [(i, s, section[i, (s + 1) // 2]) for i in range(n) for s in (-1, 1)]:
        way = sign * np.eye(n)[axis]
        low, high = 0.0, 100.0
        for _ in range(45):
            middle = (low + high) / 2
            low, high = (middle, high) if lp_contains(polytope, origin + middle * way) else (low, middle)
        assert sign * end == pytest.approx(low, abs=1e-5)   # HiGHS takes what is 1e-7 outside its rows
    reach = polytope.component_range()
    assert (section[:, 0] <= 0).all() and (section[:, 1] >= 0).all()
    assert (reach[:, 0] <= origin + section[:, 0] + 1e-9).all() and (reach[:, 1] >= origin + section[:, 1] - 1e-9).all()
    assert np.isnan(polytope.axis_section(origin + 100)).all()


def test_axis_section_at_the_border_and_off_a_flat_set():
    box = cl.Polytope.from_rows(np.concatenate([np.eye(2), -np.eye(2)]), [1, 1, 1, 1])
    np.testing.assert_allclose(box.axis_section([1 + 5e-10, 0.5]), [[-2, 0], [-1.5, 0.5]], atol=2e-9)
    line = cl.Polytope.from_box([[1.0], [1.0]], [-1], [1])
    assert (line.axis_section() == 0).all()
    np.testing.assert_allclose(line.component_range(), [[-1, 1], [-1, 1]])
    assert line.dimension == 1 and "flat: dimension 1" in repr(line) and line.volume == 0


@pytest.mark.parametrize("kind", ["rows", "zonotope", "image"])
def test_scale_takes_a_point_to_the_border(kind):
    polytope = some_polytope(kind, 3, seed=9)
    rng = np.random.default_rng(4)
    origin = 0.2 * polytope.support_point(rng.normal(size=3))
    x = rng.normal(size=(2, 5, 3))
    s = polytope.scale(x, origin)
    assert s.shape == (2, 5)
    border = origin + s[..., None] * (x - origin)
    assert polytope.contains(border).all()
    assert not polytope.contains(origin + 1.00001 * (border - origin)).any()


def test_scale_of_lines_that_miss_and_of_no_line():
    box = cl.Polytope.from_rows(np.concatenate([np.eye(2), -np.eye(2)]), [1, 1, 1, 1])
    assert box.scale([2.0, 0.0], [-3.0, 0.0]) == pytest.approx(0.8)     # from outside, through the set
    assert np.isnan(box.scale([3.0, 2.0], [-3.0, 2.0]))
    assert box.scale([0.5, 0.5], [0.5, 0.5]) == np.inf


@pytest.mark.parametrize("kind", ["rows", "zonotope", "image"])
def test_projection_and_slice_of_six_dimensions(kind):
    polytope = some_polytope(kind, 6, seed=11)
    origin = 0.3 * polytope.support_point(np.ones(6))
    for components in ([0, 4], [5, 1, 2]):
        d = np.random.default_rng(5).normal(size=(50, len(components)))
        wide = np.zeros((50, 6))
        wide[:, components] = d
        shadow, cut = polytope.project(components), polytope.slice(components, origin)
        np.testing.assert_allclose(shadow.support(d), polytope.support(wide), rtol=0, atol=1e-9)
        assert shadow.contains(cut.vertices).all()
        whole = np.tile(origin, (len(cut.vertices), 1))
        whole[:, components] = cut.vertices
        assert polytope.contains(whole).all()
        assert not polytope.contains(origin + 1.0001 * (whole - origin)).any()
        np.testing.assert_allclose((d @ shadow.vertices.T).max(axis=1), shadow.support(d), rtol=0, atol=1e-8)


def test_vertices_in_the_plane_run_counter_clockwise():
    x, y = some_polytope("image", 2, seed=3).vertices.T
    assert (x * np.roll(y, -1) - y * np.roll(x, -1)).sum() > 0
    dx, dy = np.roll(x, -1) - x, np.roll(y, -1) - y
    assert (dx * np.roll(dy, -1) - dy * np.roll(dx, -1) > 0).all()


def test_the_empty_set():
    nothing = cl.Polytope.from_image(np.eye(2), [[1, 0], [-1, 0], [0, 1], [0, -1]], [-1, -1, 1, 1])
    assert nothing.is_empty and nothing.dimension == -1 and nothing.volume == 0
    assert nothing.support([1.0, 0.0]) == -np.inf and not nothing.contains([0.0, 0.0])
    assert nothing.vertices.shape == (0, 2) and np.isnan(nothing.component_range()).all()
    assert (nothing.normals @ np.zeros(2) > nothing.offsets).any()


def test_unbounded_sets_answer_but_are_not_listed():
    strip = cl.Polytope.from_rows([[1, 0], [-1, 0], [0, 1]], [1, 1, np.inf])
    assert strip.support([0.0, 1.0]) == np.inf and strip.support([1.0, 0.0]) == pytest.approx(1.0)
    assert strip.contains([0.5, 1e6]) and not strip.contains([1.5, 0.0])
    np.testing.assert_array_equal(strip.axis_section(), [[-1, 1], [-np.inf, np.inf]])
    with pytest.raises(NotListable, match="unbounded"):
        _ = strip.vertices


def test_planes_that_touch_an_edge_or_nothing_are_superfluous():
    """Of the cube's planes, one through its edge, one that cuts its corner and one far off, only the cut is needed."""
    diagonal, corner = np.array([[1, 1, 0]]) / np.sqrt(2), np.ones((1, 3)) / np.sqrt(3)
    normals = np.concatenate([np.eye(3), -np.eye(3), diagonal, corner, corner])
    offsets = np.concatenate([np.ones(6), [np.sqrt(2), 1.5, 4]])
    np.testing.assert_array_equal(needed(normals, offsets), [0, 1, 2, 3, 4, 5, 7])


def test_too_large_to_list_but_not_to_ask():
    rng = np.random.default_rng(1)
    A = np.concatenate([np.eye(14), -np.eye(14), rng.normal(size=(4, 14))])
    image = cl.Polytope.from_image(rng.normal(size=(6, 14)), A, np.ones(32))
    with pytest.raises(NotListable, match="project"):
        _ = image.normals
    many = cl.Polytope.from_box(np.random.default_rng(0).normal(size=(6, 40)), -np.ones(40), np.ones(40))
    with pytest.raises(NotListable, match="40 cables"):
        _ = many.vertices
    assert many.contains(0.5 * many.support_point(np.ones(6)))


@pytest.mark.parametrize("make", [
    lambda: cl.Polytope.from_box(np.eye(2), [1, 0], [0, 1]),
    lambda: cl.Polytope.from_image(np.eye(2), np.eye(3), np.ones(3)),
    lambda: cl.Polytope.from_rows(np.eye(2), [1, np.nan]),
    lambda: some_polytope("rows", 2, 0).contains([1, 2, 3]),
    lambda: some_polytope("rows", 3, 0).project([0, 3]),
    lambda: some_polytope("rows", 3, 0).slice([1, 1]),
])
def test_input_that_fits_no_set(make):
    with pytest.raises(InvalidInput):
        make()
