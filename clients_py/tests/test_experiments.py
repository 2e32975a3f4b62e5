"""The experiments' own theory against closed forms: what Mane is held against must be right."""

from __future__ import annotations

import json
import os
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_bvp
from scipy.optimize import brentq
from scipy.spatial import KDTree
from scipy.spatial.transform import Rotation
from scipy.special import jv

from mane.experiments import depth, gust, kirchhoff, modes, published, swings
from mane.experiments.buckling import Shaken
from mane.experiments.fabrics import TILT, Sample
from mane.experiments.pendulum import damped_wave
from mane.experiments.recurrences import Across, Polar, PseudoForce, integrate
from mane.experiments.report import Report
from mane.experiments.scene import UP, slab, straight_hair
from mane.experiments.walker import NECK, walker

# A body and a recorded walk, which the repository does not carry.
SHARED = Path(
    os.environ.get("MANE_SHARED", Path(__file__).resolve().parents[2].parent / "shared")
) / "data"  # fmt: skip


def test_the_planar_rod_is_the_elastica_of_a_collocation_solver():
    load = 20.0

    def rates(s, y):
        return np.vstack([y[1], -load * (1 - s) * np.cos(y[0]), np.cos(y[0]), -np.sin(y[0])])

    def ends(root, tip):
        return np.array([root[0], tip[1], root[2], root[3]])

    s = np.linspace(0, 1, 41)
    solved = solve_bvp(rates, ends, s, np.vstack([s, 0 * s, s, -s]), tol=1e-9, max_nodes=20000)
    assert solved.success
    rod = kirchhoff.Rod(load)
    angle = kirchhoff.planar_branch([kirchhoff.Rod(x) for x in (0.1, 1, 5, load)])[-1]
    tip = kirchhoff.shoot(rod, kirchhoff.hanging(angle)).centerlines[0, -1]
    np.testing.assert_allclose(tip, [*solved.y[2:, -1], 0], atol=1e-8)


def test_a_weightless_rod_is_its_natural_helix():
    twist, bend = 3.0, 4.0
    rod = kirchhoff.Rod(0.0, (twist, 0.0, bend), 0.7)
    line = kirchhoff.shoot(rod, [[0.0, -1.0, 0.0]]).centerlines[0]
    turn = np.hypot(twist, bend)
    along, across = twist / turn, bend / turn
    s = np.linspace(0, 1, len(line))
    # About the axis (along, 0, across) of the root's frame; radius bend / turn^2.
    axis, normal = np.array([along, 0, across]), np.array([0.0, 1.0, 0.0])
    side = np.array([across, 0, -along])
    radius = bend / turn**2
    helix = (
        np.outer(along * s, axis)
        + np.outer(radius * np.sin(turn * s), side)
        + np.outer(radius * (1 - np.cos(turn * s)), normal)
    )
    np.testing.assert_allclose(line, helix, atol=1e-8)


def test_equilibria_in_space_have_no_slope_of_energy_and_converge():
    rod = kirchhoff.Rod(15.0, (0.0, 0.0, 4.0), 0.68)
    found = kirchhoff.equilibria(rod, (0, -1, 0), 40)
    assert abs(found.centerlines[0, -1, 2]) > 0.3  # Out of the plane.
    np.testing.assert_allclose(found.weight_at_root[0], (0, -1, 0), atol=1e-9)
    assert np.all(np.diff(found.energies) > 0)
    # Energy is least among curves: d(energy)/d(load) is then the mean depth with its sign alone.
    near = [
        kirchhoff.equilibria(kirchhoff.Rod(load, rod.curvature, rod.torsion), (0, -1, 0), 40)
        for load in (14.99, 15.01)
    ]
    slope = (near[1].energies[0] - near[0].energies[0]) / 0.02
    height = np.trapezoid(found.centerlines[0, :, 1], dx=1 / kirchhoff.STEPS)
    assert slope == pytest.approx(height, abs=1e-4)


def test_the_planar_rod_gives_way_where_spatial_equilibria_begin():
    def others(load: float) -> int:
        rod = kirchhoff.Rod(load, (0.0, 0.0, 4.0), 1 / 1.48)
        lines = kirchhoff.equilibria(rod, (0, -1, 0), 40).centerlines
        return int((np.abs(lines[:, -1, 2]) > 1e-3).sum())

    from mane.experiments.bend_twist import critical_load

    critical = critical_load(4.0)
    assert others(0.99 * critical) == 0
    assert others(1.01 * critical) == 1


def test_modes_are_those_of_beam_chain_and_column():
    beam = modes.first_mode(1e-9, hangs=True)
    root = brentq(lambda x: np.cos(x) * np.cosh(x) + 1, 1.5, 2.5)
    assert beam.frequency == pytest.approx(root**2, rel=1e-9)
    assert beam.bending_part == pytest.approx(1, abs=1e-8)
    # A heavy strand swings as a chain does, J0(2 omega) = 0, stiffer by about G^(-1/2).
    chain = brentq(lambda x: jv(0, 2 * x), 1, 1.5)
    ratio = modes.first_mode(300.0, hangs=True).frequency / 300**0.5 / chain
    assert 1 < ratio < 1 + 1.5 * 300**-0.5
    # Greenhill: G = 9/4 j^2 with the first zero j of the Bessel function of order -1/3.
    zero = brentq(lambda x: jv(-1 / 3, x), 1.5, 2.5)
    assert modes.critical_number() == pytest.approx(9 / 4 * zero**2, rel=1e-9)
    with pytest.raises(ValueError, match="falls over"):
        modes.first_mode(8.0, hangs=False)


def test_floquet_growth_is_mathieus_at_small_amplitude():
    strand = Shaken(straight_hair(UP, 0.058, 10), hangs=False)
    (own_squared, *_), weight = strand.modal()
    own, amplitude = own_squared**0.5, 5e-5
    # x'' + (own^2 + e cos(2 own t)) x = 0 grows at |e| / (4 own), e = weight A (2 own)^2.
    expected = abs(weight[0, 0]) * amplitude * own
    assert strand.growth(amplitude, 2 * own, 512) == pytest.approx(expected, rel=0.02)


def test_a_damped_wave_is_fitted_exactly():
    times = np.linspace(0, 2, 200)
    wave = 3e-3 * np.exp(-0.7 * times) * np.cos(9 * times + 1) + 1e-4
    np.testing.assert_allclose(damped_wave(times, wave, 8.5), [0.7, 9, 3e-3], rtol=1e-6)


@pytest.mark.parametrize("turn", np.radians((30, 90, 150)))
def test_hair_on_a_fabric_points_along_weight_and_friction_together(turn):
    sample = Sample("wool", turn, friction=0.5, anisotropy=0.4)
    angle = sample.deflection()
    hair = np.array([np.cos(angle), np.sin(angle)])  # Downhill, aside.
    fabric = np.array([np.cos(turn), np.sin(turn)])
    mu = 0.5 * (1 + 0.4 * (-fabric @ hair))
    pull = np.array([np.sin(TILT), 0]) + mu * np.cos(TILT) * fabric
    np.testing.assert_allclose(pull / np.linalg.norm(pull), hair, atol=1e-9)
    assert sample.rubbed(angle) == pytest.approx(mu)
    assert sample.law(np.pi - turn + angle) == pytest.approx(mu)


def test_a_slab_is_a_closed_box_below_its_face():
    box = slab("box", 0.5).shape
    assert box.is_closed()
    corners = box.vertices.astype(float)[box.triangles]
    assert np.linalg.det(corners).sum() / 6 == pytest.approx(0.05 * 1.0**2)  # Its volume.
    assert box.vertices[:, 0].max() == 0


def test_a_report_tells_agreement_from_disagreement(tmp_path):
    report = Report("trial", tmp_path / "new")
    report.equal("first", 10.0, 10.4, 0.05, " m")
    assert report.holds
    report.at_most("second", 0.2, 0.1)
    assert not report.holds
    report.table("part", {"a": [1, 2], "b": [0.5, 1e-9]})
    with report.figure("part") as (axes,):
        axes.plot([1, 2])
    report.write()
    assert [path.name for path in report.files] == [
        "trial-part.csv",
        "trial-part.png",
        "trial.json",
    ]
    assert (tmp_path / "new" / "trial-part.csv").read_text() == "a,b\n1,0.5\n2,1e-09\n"
    content = json.loads(report.files[-1].read_text())
    assert [fact["holds"] for fact in content["facts"]] == [True, False]
    assert content["values"] == {"first": 10.4, "second": 0.2}


def test_depth_in_a_solid_is_that_of_a_box_and_has_the_right_sign_at_its_corners():
    solid = depth.Solid(slab("box", 0.1).shape)
    rng = np.random.default_rng(5)
    near = rng.uniform((-0.07, -0.12, -0.12), (0.02, 0.12, 0.12), (4000, 3))
    outside = np.maximum(np.abs(near - (-0.025, 0, 0)) - (0.025, 0.1, 0.1), 0)
    inside = np.minimum(0.025 - np.abs(near[:, 0] + 0.025), 0.1 - np.abs(near[:, 1:]).max(axis=1))
    expected = np.where(inside > 0, inside, -np.linalg.norm(outside, axis=1))
    told = (expected > -3e-3) & (expected < depth.REACH_M)
    found = solid.depths(near.reshape(40, 100, 3)).ravel()
    np.testing.assert_allclose(found[told], expected[told], atol=1e-7)
    assert np.all(found[expected < -3e-3] < -2e-3)


def test_a_walker_is_closed_parts_that_stay_together():
    figure = walker(None, None, 1.0, None, before_s=0.5, after_s=0.5)
    assert figure.head.is_closed() and len(figure.head.hair_triangles)
    assert figure.parts["torso"].is_closed()
    torso = figure.motion.bodies["torso"]
    necks = [
        Rotation.from_quat(track.orientations).apply(NECK) + track.positions
        for track in (figure.motion, torso)
    ]
    np.testing.assert_allclose(*necks, atol=1e-9)
    assert np.ptp(Rotation.from_quat(torso.orientations).as_rotvec()[:, 1]) > 0.1
    before, after = figure.motion.positions[: figure.walks.start], figure.motion.positions[-30:]
    assert np.ptp(before, axis=0).max() == np.ptp(after, axis=0).max() == 0


@pytest.mark.skipif(not SHARED.is_dir(), reason=f"needs {SHARED}: a body and a recorded walk")
@pytest.mark.parametrize("recorded", [SHARED / "motion" / "cmu_12_01_walk.bvh", None])
def test_a_body_that_walks_swings_its_arms(recorded):
    body = SHARED / "heads" / "makehuman_base.obj"
    figure = walker(body, "body", 0.1, recorded, before_s=0.1, after_s=0.1)
    assert sorted(figure.parts) == ["left-arm", "right-arm", "torso"]
    for mesh in (figure.head, *figure.parts.values()):
        assert mesh.is_closed()
    motion = figure.motion
    assert motion.positions[-1, 2] - motion.positions[0, 2] > 4  # It walks ahead,
    speed = np.linalg.norm(np.diff(motion.positions, axis=0), axis=1) * 60
    assert speed.max() < 2 and np.abs(np.diff(speed)).max() * 60 < 15  # And never jumps.
    for name, side in (("left-arm", 1), ("right-arm", -1)):
        arm = figure.parts[name]
        hand = arm.vertices[np.argmax(side * arm.vertices[:, 0])].astype(float)
        track = motion.bodies[name]
        hands = Rotation.from_quat(track.orientations).apply(hand) + track.positions
        below = hands - motion.positions
        assert below[:, 1].max() < -0.4 and np.abs(below[:, 0]).max() < 0.45
        assert np.ptp(below[:, 2]) > 0.1


def test_published_numbers_are_those_of_the_paper():
    segment = np.arange(1, 19)
    np.testing.assert_allclose(published.push(), 3 * 0.1**2 * segment / (2 * 18**3))
    # What the server makes of it: lambda_i = lambda_k i / k, in steps of 1/60 s.
    for d in (1.0, 0.4):
        served = published.tip_response(d) * segment / 18 / 60**2
        np.testing.assert_allclose(served, published.push(d))


@pytest.mark.parametrize("begin", (Polar.begin, Across.begin))
def test_recurrences_swing_at_the_frequency_of_their_eigenvalues(begin):
    """About the field's direction: by 2 asin(dt sqrt(lambda |F|) / 2) of a period in a step."""
    push, field, steps = 0.004, np.array((0.0, 0.0, 100.0)), 400
    rest = np.array([[(0, 0, 0), (0, 1e-3, 1), (0, 2e-3, 2)]])  # In the plane of Y and the field.
    nodes = integrate(begin, rest, [field] * steps, np.full(2, push))
    tilt = nodes[:, 0, 1, 1]
    turn = 2 * np.arcsin(np.sqrt(push * 100) / 2)
    # Still at first: x_{-1} = x_0, half a step before which the swing is farthest.
    expected = tilt[0] * np.cos(turn * (np.arange(steps + 1) + 0.5)) / np.cos(turn / 2)
    np.testing.assert_allclose(tilt, expected, atol=2e-3 * tilt[0])


def test_equations_agree_in_a_plane_of_the_axis():
    bent = np.array([[(0, 0, 0), (0, 0.2, 1), (0, -0.1, 2), (0, -1, 2)]])
    fields = [(0, -20.0, 15.0)] * 40
    polar, across = (
        integrate(begin, bent, fields, np.full(3, 1e-4)) for begin in (Polar.begin, Across.begin)
    )
    # Across, steps of delta turn by delta^3 / 12 less.
    np.testing.assert_allclose(polar, across, atol=1e-3)
    assert np.abs(polar[-1] - polar[0]).max() > 0.5
    lengths = np.linalg.norm(np.diff(across, axis=2), axis=3)
    np.testing.assert_allclose(lengths, np.broadcast_to(lengths[0], lengths.shape))


def test_the_pseudo_force_counts_where_hair_is_pressed_on_the_head_nearby():
    weak = PseudoForce(np.array((1.0, 2.0, 1.0)), alpha=-0.75, near_m=0.2, epsilon=0.1)
    F = np.array((0.0, 0.0, -5.0))
    ends = np.array([(0, 0, 1.1), (0, 0, 1.5), (0, 0, -1.1), (0, 2.1, 0), (0.3, 0, 1.1)])
    counts = weak.at(ends, F)[:, 2] / F[2]
    np.testing.assert_allclose(counts, (0.1, 1, 1, 1, 0.1))


def test_pores_lie_evenly_in_their_cap():
    axis = np.array((0, 0.8, -0.6))
    zenith, azimuth = published.pores(2000, axis, 1.3).T
    out = np.stack(
        [np.sin(zenith) * np.sin(azimuth), np.cos(zenith), np.sin(zenith) * np.cos(azimuth)], 1
    )
    cosine = out @ axis
    assert cosine.min() > np.cos(1.3)
    # Area goes with the cosine.
    np.testing.assert_allclose(cosine.mean(), (1 + np.cos(1.3)) / 2, atol=1e-3)
    apart = KDTree(out).query(out, k=2)[0][:, 1]
    assert apart.min() > 0.5 * apart.mean()


def test_curves_bend_back_where_they_have_an_inflection():
    s = np.linspace(0, 2 * np.pi, 19)
    wave, arch = (
        np.stack([0 * s, y, s], axis=1)[None, None] for y in (0.3 * np.sin(s), 0.3 * np.sin(s / 2))
    )
    assert published.inflections(wave) == 1 and published.inflections(arch) == 0
    assert gust.bends_back(wave) > 20 and gust.bends_back(arch) == 0
    turns = published.turns(arch)
    assert 0 < turns.max() < 0.2


def test_turning_points_of_a_damped_swing():
    times = np.arange(600) / 120
    swing = -np.exp(-1.2 * times) * np.cos(7 * times)  # It lags at first.
    when, size = swings.turning_points(times, swing)
    np.testing.assert_allclose(np.diff(when), np.pi / 7, atol=1 / 120)
    np.testing.assert_allclose(-np.diff(np.log(size)), 1.2 * np.pi / 7, rtol=0.02)
