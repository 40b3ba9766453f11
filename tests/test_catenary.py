"""Cables that sag: against exact sums, chains and parabolas; and the lengths at which such cables hold a pose."""

from dataclasses import replace
from decimal import Decimal, localcontext

import numpy as np
import pytest
from scipy.optimize import root

import cdprlab as cl
import robots
from cdprlab.errors import InfeasibleTensions, InvalidInput, WorldError
from cdprlab.mechanics.cables import anchor_offsets
from cdprlab.mechanics.catenary import straight_tensions


def cables(count, seed):
    """Spans, lengths, densities 1e-6 to 1e3 kg/m and EA 1e2 to 1e9 N: taut, nearly straight, hanging low, plumb."""
    rng = np.random.default_rng(seed)
    chord, steep = 10**rng.uniform(-1, 2, count), np.pi / 2 * (1 - 10**rng.uniform(-9, 0, count))
    steep = rng.choice([-1, 1], count) * np.where(rng.random(count) < 0.1, np.pi / 2, steep)
    span = chord[:, None] * np.column_stack([np.where(np.abs(steep) == np.pi / 2, 0.0, np.cos(steep)), np.sin(steep)])
    longer = rng.choice([-0.045, 1e-4, 3.0], count) * 10**rng.uniform(-5, 0, count)
    density, ea = 10**rng.uniform(-6, 3, count), 10**rng.uniform(2, 9, count)
    keep = density * 9.81 * 40 * chord < 0.004 * ea     # or its own weight strains it
    return span[keep], (chord * (1 + longer))[keep], density[keep], ea[keep]


def exact_end(force, length, density, ea):
    """Irvine's formula as printed, in 60 digits: where a cable pulled at A with (h, v) ends."""
    with localcontext() as context:
        context.prec = 60
        h, v, L, ea = (Decimal(float(number)) for number in (*force, length, ea))
        w = Decimal(float(density)) * Decimal("9.81")
        low, high = (v, v + w * L)
        at_exit, at_anchor = ((h * h + f * f).sqrt() for f in (low, high))
        turn = ((high + at_anchor) / (low + at_exit)).ln() if h else Decimal(0)   # arcsinh(high/h) − arcsinh(low/h)
        return h * L / ea + h / w * turn, (v * L + w * L * L / 2) / ea + (at_anchor - at_exit) / w


@pytest.mark.parametrize("seed", range(3))
def test_span_and_force_keep_nine_digits(seed):
    span, length, density, ea = cables(120, seed)
    cable = cl.sagging_cable(span, length, density, ea)
    digits = np.finfo(np.longdouble).eps / 1.1e-19   # 1 where the machine has 64 binary digits, as PCs have
    for i, force in enumerate(cable.force_at_exit):
        ends = [exact_end(force * np.add(1, turn), length[i], density[i], ea[i])
                for turn in ((0, 0), (1e-9, 0), (0, 1e-9))]
        missing = np.array([float(Decimal(float(s)) - end) for s, end in zip(span[i], ends[0])])
        size = np.linalg.norm(span[i])
        np.testing.assert_allclose(missing, 0, atol=1e-9 * size)
        slope = np.array([[float(moved - end) for moved, end in zip(there, ends[0])] for there in ends[1:]]).T
        if span[i, 0] > 1e-6 * size:    # nearer to plumb, this force is no longer what two differences of ends say
            off = np.linalg.solve(slope, missing) * 1e-9
            assert np.abs(off).max() < 1e-9 * max(1.0, digits), (span[i], length[i], density[i], ea[i])


@pytest.mark.parametrize(("span", "length", "density", "ea"), [
    ([3.0, -1.0], 3.3, 0.2, 1e4), ([2.0, 4.0], 4.44, 1.0, 5e3), ([0.5, 0.1], 2.0, 0.05, 1e3)])
def test_a_chain_of_4000_links_hangs_alike(span, length, density, ea):
    """Links that stretch, their weights in their middles: the least of second order in a link's length."""
    n, w = 4000, 9.81 * density * length / 4000
    along = w * (np.arange(n) + 0.5)

    def joints(force):
        pulls = np.column_stack([np.full(n, force[0]), force[1] + along])
        stretched = pulls / np.linalg.norm(pulls, axis=1)[:, None] + pulls / ea
        return np.vstack([[0, 0], np.cumsum(stretched, axis=0) * length / n])

    cable = cl.sagging_cable(span, length, density, ea)
    chain = root(lambda force: joints(force)[-1] - span, [0.5 * n * w, -0.4 * n * w], tol=1e-13).x
    np.testing.assert_allclose(cable.force_at_exit, chain, rtol=1e-6)
    np.testing.assert_allclose(cable.points(n + 1), joints(chain), atol=1e-6 * length)


def test_small_sag_is_a_parabolas():
    """w d² / 8 h below the chord's middle, to the square of sag over span; c / L − 1 = h / EA − (w d)² / 24 h²."""
    h, d, w, ea = 400.0, 5.0, 0.02 * 9.81, 1e6
    cable = cl.sagging_cable([d, 0.0], d / (1 + h / ea - (w * d / h)**2 / 24), 0.02, ea)
    sag = w * d * d / 8 / h
    assert cable.force_at_exit[0] == pytest.approx(h, rel=(sag / d)**2 + h / ea)
    assert -cable.points(3)[1, 1] == pytest.approx(sag, rel=10 * (sag / d)**2 + h / ea)


def test_ends_carry_the_weight_and_a_batch_is_its_cables_turned_anywhere():
    span, length, density, ea = cables(60, 7)
    cable, rng = cl.sagging_cable(span, length, density, ea), np.random.default_rng(1)
    both = cable.force_at_exit + cable.force_at_anchor
    rounding = 1e-15 * np.abs(cable.force_at_exit).max(axis=1)
    assert (np.abs(both[:, 1] + density * 9.81 * length) < 10 * rounding).all()
    assert (both[:, 0] == 0).all() and (cable.force_at_exit[:, 0] >= 0).all()
    turn = rng.uniform(-np.pi, np.pi, len(span))
    level = np.column_stack([np.cos(turn), np.sin(turn)])
    spatial = cl.sagging_cable(np.column_stack([span[:, :1] * level, span[:, 1]]), length, density, ea)
    np.testing.assert_allclose(spatial.force_at_anchor[:, 2], cable.force_at_anchor[:, 1], rtol=1e-9)
    np.testing.assert_allclose(spatial.force_at_anchor[:, :2], cable.force_at_anchor[:, :1] * level, rtol=1e-6)
    np.testing.assert_allclose(cable.points(9)[:, -1], span, atol=1e-9)
    for i in (0, 1, -1):
        alone = cl.sagging_cable(span[i], length[i], density[i], ea[i])
        assert alone.points(4).shape == (4, 2)
        np.testing.assert_allclose(alone.force_at_exit, cable.force_at_exit[i], rtol=1e-11)


def test_plumb_cables_by_hand():
    w, ea = 9.81 * 0.5, 1e4
    hung = cl.sagging_cable([0, 0, -3.0], 4.0, 0.5, ea)   # a loop: each side carries itself
    deepest = hung.points(4001)[:, 2].min()
    assert -deepest == pytest.approx(3.5, abs=4 * w * 4 / ea) and not hung.force_at_exit[:2].any()
    taut = cl.sagging_cable([0.0, 3.0], 2.9, 0.5, ea)
    assert taut.force_at_exit[1] == pytest.approx(ea * (3 / 2.9 - 1) - w * 2.9 / 2, rel=1e-12)
    assert cl.sagging_cable([0.0, 0.0], 1.0, 0.5, ea).force_at_exit[1] == pytest.approx(-w / 2, rel=1e-12)
    just = cl.sagging_cable([0.0, -3.0], 3.0, 0.5, ea)   # as long as its span: its weight stretches it to a small loop
    assert just.force_at_anchor[1] == pytest.approx(-w * 9 * w / (4 * ea + 6 * w), rel=1e-9)


@pytest.mark.parametrize(("span", "length", "density", "ea"), [
    ([0.06250315, -30.78097241], 30.781053702615658, 2.043895e-06, 237744.49),
    ([0.04643584, 35.49574898], 35.4957873110757, 0.000357996, 223865173.6)])
def test_a_light_cable_that_is_nearly_plumb_ends_where_it_should(span, length, density, ea):
    """Slack by a millionth, its force is found by many small steps: 200 left 5e-5 m."""
    np.testing.assert_allclose(cl.sagging_cable(span, length, density, ea).points(2)[-1], span, atol=1e-12)


@pytest.mark.parametrize(("wrong", "told"), [
    ({"length": 3.7}, "strained by 8"), ({"length": 0.0}, "length must be positive"), ({"span": [4.0]}, "span must be"),
    ({"linear_density": [0.1, -1.0]}, "linear_density must be positive"), ({"axial_stiffness": 0}, "axial_stiffness"),
    ({"length": np.ones(3), "linear_density": np.ones(2)}, "do not fit together"), ({"gravity": 0.0}, "gravity")])
def test_what_is_no_cable_is_told(wrong, told):
    given = {"span": [4.0, 0.0], "length": 4.1, "linear_density": 0.1, "axial_stiffness": 1e5}
    with pytest.raises(InvalidInput, match=told):
        cl.sagging_cable(**(given | wrong))


# --- a robot on such cables -----------------------------------------------------------------------------
def sagging(name, density=0.3, ea=1e6):
    """A robot of heavy cables, a pose, and the tensions of straight ones."""
    robot, pose = robots.case(name, 1)
    robot = replace(robot, linear_density=density, elasticity=cl.Elasticity(ea))
    W, low, high = cl.wrench_matrix(robot, pose), robot.tension_min, robot.tension_max
    straight = cl.distribute_tensions(W, cl.gravity_wrench(robot, pose), low + 50, high).require()
    return robot, pose, straight.tensions


def held(robot, pose, lengths):
    """What sagging cables and weight exert on the platform, and the pulls."""
    forces = cl.sagging_cable(-cl.cable_vectors(robot, pose), lengths, robot.linear_density,
                              robot.elasticity.axial_stiffness, robot.gravity).force_at_anchor
    arms = anchor_offsets(robot, pose)
    moments = [robots.cross(arm, force) for arm, force in zip(arms, forces)]
    wrench = robots.in_rows(robot, pose, forces.sum(axis=0), np.sum(moments, axis=0))
    return wrench + cl.gravity_wrench(robot, pose), np.linalg.norm(forces, axis=1)


@pytest.mark.parametrize("name", ["2T", "1R2T", "3R3T"])
def test_the_pose_is_held_by_the_nearest_pulls(name):
    robot, pose, tensions = sagging(name)
    found = cl.sagging_lengths(robot, pose, tensions)
    missing, pulls = held(robot, pose, found.lengths)
    np.testing.assert_allclose(missing, 0, atol=1e-7)
    np.testing.assert_allclose(pulls, found.tensions, rtol=1e-9)
    rng, off = np.random.default_rng(0), found.tensions - tensions
    assert np.abs(off).max() > 0.1
    for _ in range(3):   # other pulls that hold it are farther away, whichever way they lie
        other = cl.sagging_lengths(robot, pose, found.tensions + rng.normal(0, 0.01, robot.n_cables)).tensions
        way = other - found.tensions
        assert np.abs(way).max() < 1e-9 or abs(off @ way) < 1e-3 * np.linalg.norm(off) * np.linalg.norm(way)


def test_of_two_lengths_the_shorter_is_meant():
    robot, pose, tensions = sagging("1R2T")
    found = cl.sagging_lengths(robot, pose, tensions)
    for i, length in enumerate(found.lengths):
        def pull(longer, i=i):
            return held(robot, pose, np.array(found.lengths) + longer * (np.arange(4) == i))[1][i]
        assert pull(1e-4 * length) < found.tensions[i] < pull(200 * length)


def test_light_cables_are_straight():
    robot, pose, tensions = sagging("3R3T", density=1e-7, ea=1e8)
    found = cl.sagging_lengths(robot, pose, tensions)
    np.testing.assert_allclose(found.tensions, tensions, rtol=1e-6)
    lengths = cl.cable_lengths(robot, pose)
    np.testing.assert_allclose(found.lengths, lengths / (1 + tensions / 1e8), rtol=1e-9)


def test_a_pull_that_spans_nothing_is_named():
    robot, pose, tensions = sagging("1R2T")
    heavy = replace(robot, linear_density=12.0)
    with pytest.raises(InfeasibleTensions, match=r"cable [12] would have to pull with .* the least that spans it is"):
        cl.sagging_lengths(heavy, pose, tensions)
    with pytest.raises(InvalidInput, match="linear_density"):
        cl.sagging_lengths(replace(robot, linear_density=0.0), pose, tensions)


def test_where_cables_count_as_straight():
    """At that pull the end turns away from the straight line by the angle asked for, but for terms of second order."""
    robot, pose, _ = sagging("3R3T")
    for angle in (1e-2, 1e-3):
        span = -cl.cable_vectors(robot, pose)
        pulls, chord = straight_tensions(robot, pose, angle), np.linalg.norm(span, axis=1)
        level = np.linalg.norm(span[:, :-1], axis=1)
        w = robot.linear_density * robot.gravity
        lengths = chord / (1 + pulls / 1e9 - (w * level / pulls)**2 / 24)
        force = -cl.sagging_cable(span, lengths, robot.linear_density, 1e9).force_at_anchor
        turned = np.linalg.norm(np.cross(force, span), axis=1) / chord / np.linalg.norm(force, axis=1)
        np.testing.assert_allclose(turned, angle, rtol=5 * angle)


def test_the_world_file_gives_the_weight():
    document = cl.load_world("caroca").to_dict() | {"cable": {"linear_density": 0.05}}
    world = cl.World.from_dict(document)
    assert world.robot.linear_density == 0.05 and world.robot.elasticity is None
    assert world.to_dict()["cable"] == {"linear_density": 0.05}
    for wrong, told in (({"linear_density": -1}, "linear_density"), ({"damping": 0.1}, "damping")):
        with pytest.raises(WorldError, match=told):
            cl.World.from_dict(document | {"cable": wrong})


def test_heavy_cables_are_drawn_as_they_hang():
    """Cables hang through by w c² / 8 T, light ones not at all."""
    from matplotlib.figure import Figure

    from cdprlab.view.drawing import RobotDrawing
    robot, pose, tensions = sagging("1R2T")
    curves = {}
    for density in (0.0, robot.linear_density):
        drawing = RobotDrawing(Figure().subplots(), replace(robot, linear_density=density), None, pose)
        drawing.move(pose, tensions)
        curves[density] = np.array(drawing.cables.get_segments())
    vectors = cl.cable_vectors(robot, pose)
    sag = robot.linear_density * 9.81 * (vectors**2).sum(axis=1) / 8 / tensions
    below = (curves[0.0] - curves[robot.linear_density])[..., 1].max(axis=1)
    np.testing.assert_allclose(below, sag, rtol=0.02)
