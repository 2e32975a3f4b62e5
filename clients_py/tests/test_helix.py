"""Rebuilding plain strands from element angles.

Against an independent integrator (RK4 of R' = R [kappa], r' = R e0, element by element), against
closed forms (an arc of a circle, a straight strand), and at the numerical seams.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import mane
from conftest import make_guide, make_guides
from mane.helix import Strands, stumpff


def angles_of(guide: mane.Guide, curvatures: np.ndarray) -> np.ndarray:
    """Element angles (N, 3) of twist and curvatures (N, 3) [rad/m]."""
    return curvatures * guide.resolved_element_lengths_m()[:, None]


def integrate_rk4(guide: mane.Guide, curvatures: np.ndarray, points: int, steps: int) -> np.ndarray:
    """Points at equal arc length, by RK4 over (R, r) with `steps` per point and element piece."""
    lengths = guide.resolved_element_lengths_m()
    ends = np.cumsum(lengths)
    frame = Rotation.from_quat(guide.root_frame).as_matrix()
    place = np.array(guide.root_position)
    arc, result = 0.0, []

    def rate(R, kappa):
        dR = np.stack([np.cross(row, kappa) for row in R])  # Rows of R [kappa].
        return dR, R[:, 0]

    for target in np.linspace(0, ends[-1], points):
        while arc < target - 1e-15:
            element = int(np.searchsorted(ends, arc + 1e-12, side="right"))
            stop = min(target, ends[min(element, len(ends) - 1)])
            kappa, h = curvatures[min(element, len(ends) - 1)], (stop - arc) / steps
            for _ in range(steps):
                k1, v1 = rate(frame, kappa)
                k2, v2 = rate(frame + h / 2 * k1, kappa)
                k3, v3 = rate(frame + h / 2 * k2, kappa)
                k4, v4 = rate(frame + h * k3, kappa)
                frame = frame + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
                place = place + h / 6 * (v1 + 2 * v2 + 2 * v3 + v4)
            arc = stop
        result.append(place)
    return np.array(result)


def test_agrees_with_an_independent_integrator():
    rng = np.random.default_rng(11)
    guides = make_guides(6, seed=12)
    guides.append(make_guide(length_m=0, element_count=0, element_lengths_m=[0.01, 0.04, 0.07]))
    curvatures = [rng.uniform(-80, 80, (len(g.resolved_element_lengths_m()), 3)) for g in guides]
    angles = np.concatenate([angles_of(g, k) for g, k in zip(guides, curvatures, strict=True)])
    built = Strands(guides).positions(angles, 9)
    for guide, kappa, points in zip(guides, curvatures, built, strict=True):
        # RK4's error: about angle * (angle / steps)^4 / 120 of the length, with angles below 10.
        np.testing.assert_allclose(points, integrate_rk4(guide, kappa, 9, 200), atol=2e-9)


@pytest.mark.parametrize("turn", [1e-12, 1e-3, 0.4999, 0.5001, 2.0, 2 * np.pi, 40.0])
def test_one_element_without_twist_is_a_circle(turn):
    length, points = 0.3, 13
    guide = make_guide(root_position=(0, 0, 0), root_frame=(0, 0, 0, 1), length_m=length,
                       element_count=1)  # fmt: skip
    built = Strands([guide]).positions(np.array([[0.0, 0.0, turn]]), points)[0]
    u = np.linspace(0, 1, points)
    radius = length / turn  # About n2: from +x toward +y.
    versine = 2 * np.sin(turn * u / 2) ** 2
    circle = np.stack([radius * np.sin(turn * u), radius * versine, 0 * u], axis=1)
    np.testing.assert_allclose(built, circle, atol=1e-15)


def test_bend_1_turns_about_n1_and_twist_alone_keeps_the_strand_straight():
    guide = make_guide(root_position=(0, 0, 0), root_frame=(0, 0, 0, 1), length_m=1.0,
                       element_count=2)  # fmt: skip
    bent = Strands([guide]).positions(np.array([[0, 0.5, 0], [0, 0.5, 0]]), 2)[0, -1]
    np.testing.assert_allclose(bent, [np.sin(1), 0, np.cos(1) - 1], atol=1e-15)
    twisted = Strands([guide]).positions(np.array([[3.0, 0, 0], [-9.0, 0, 0]]), 5)[0]
    np.testing.assert_allclose(twisted, np.outer(np.linspace(0, 1, 5), (1, 0, 0)), atol=1e-15)


def test_zero_angles_give_a_straight_strand_along_the_root():
    guides = make_guides(4)
    strands = Strands(guides)
    built = strands.positions(np.zeros((strands.element_count, 3)), 5)
    for guide, points in zip(guides, built, strict=True):
        along = Rotation.from_quat(guide.root_frame).apply([1, 0, 0]) * guide.length_m
        straight = guide.root_position + np.outer(np.linspace(0, 1, 5), along)
        np.testing.assert_allclose(points, straight, atol=1e-15)


def test_cutting_an_element_in_two_changes_nothing():
    whole = make_guide(length_m=0.2, element_count=1)
    cut = make_guide(length_m=0, element_count=0, element_lengths_m=[0.06, 0.14])
    q = np.array([[3.0, -5.0, 2.0]])
    one = Strands([whole]).positions(q, 21)
    two = Strands([cut]).positions(np.concatenate([0.3 * q, 0.7 * q]), 21)
    np.testing.assert_allclose(one, two, atol=1e-15)


def test_strand_never_leaves_its_length():
    guides = make_guides(20, seed=5)
    strands = Strands(guides)
    angles = np.random.default_rng(6).uniform(-20, 20, (strands.element_count, 3))
    built = strands.positions(angles, 200)
    chords = np.linalg.norm(np.diff(built, axis=1), axis=2)
    steps = np.array([g.length_m for g in guides]) / 199
    assert np.all(chords <= steps[:, None] * (1 + 1e-12))


def test_stumpff_functions_at_zero_at_the_seam_and_far_out():
    c1, c2, c3 = stumpff(np.array([0.0, 1e-300]))
    np.testing.assert_array_equal([c1, c2, c3], [[1, 1], [0.5, 0.5], [1 / 6, 1 / 6]])
    below, above = stumpff(np.array([0.25 * (1 - 1e-15), 0.25 * (1 + 1e-15)]))[2]
    assert abs(below - above) < 1e-15
    x = np.array([1.0, 3.0, 50.0, 1000.0])
    c1, c2, c3 = stumpff(x**2)
    np.testing.assert_allclose(c1, np.sin(x) / x, atol=1e-15)
    np.testing.assert_allclose(c2, (1 - np.cos(x)) / x**2, atol=1e-15)
    np.testing.assert_allclose(c3, (x - np.sin(x)) / x**3, rtol=1e-14)
