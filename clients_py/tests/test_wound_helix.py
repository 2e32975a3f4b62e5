"""Rebuilding wound strands from their coordinates.

Against an independent integrator (RK4 of the axis frame and of the tangent off it), against closed
forms (the natural helix, a changed one, a coil pulled out), and for what hair is: of unit speed.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import mane
from conftest import make_guide, make_guides
from mane.helix import Strands

CURLY = {"natural_twist": 94.0, "natural_curvature_1": 80.0, "natural_curvature_2": 120.0}


def wound_guides(count: int, seed: int = 1) -> list[mane.Guide]:
    """Wound guides, each of its own curl, which varies along it."""
    rng = np.random.default_rng(seed)
    guides = []
    for guide in make_guides(count, seed):
        curl = {
            name: mean + rng.uniform(-30, 30, guide.element_count) for name, mean in CURLY.items()
        }
        guides.append(replace(guide, model="wound", **curl))
    return guides


def random_coordinates(guides, size: float = 2.0, seed: int = 3) -> list[np.ndarray]:
    rng = np.random.default_rng(seed)
    return [rng.uniform(-size, size, (guide.element_count, 4)) for guide in guides]


def flat(coordinates) -> np.ndarray:
    return np.concatenate([x.ravel() for x in coordinates])


def coil_frame(natural: np.ndarray) -> np.ndarray:
    """Columns: the coil's axis, the tangent's direction off it, and their product."""
    axis = natural / np.linalg.norm(natural)
    across = np.array([1.0, 0, 0]) - axis[0] * axis
    across /= np.linalg.norm(across)
    return np.column_stack([axis, across, np.cross(axis, across)])


def integrate_rk4(guide: mane.Guide, coordinates: np.ndarray, steps: int) -> np.ndarray:
    """Ends of the elements, root first (N + 1, 3), by RK4 over (A, r)."""
    natural = guide.resolved_natural()
    frame = Rotation.from_quat(guide.root_frame).as_matrix() @ coil_frame(natural[0])
    place, phase = np.array(guide.root_position), 0.0
    result = [place]
    for length, strain, x in zip(
        guide.resolved_element_lengths_m(), natural, coordinates, strict=True
    ):
        winding = length * np.linalg.norm(strain)
        turn = np.hypot(winding + x[0], x[3])
        beta = np.array([turn - winding, x[1], x[2]])
        slope = np.arccos(strain[0] / np.linalg.norm(strain)) - np.arctan2(x[3], winding + x[0])

        def rate(A, u, beta=beta, slope=slope, phase=phase, winding=winding):
            dA = np.stack([np.cross(row, beta) for row in A])  # Rows of A [beta].
            at = phase + winding * u
            off = np.sin(slope) * np.array([np.cos(at), np.sin(at)])
            return dA, A @ (np.cos(slope), *off)

        h = 1 / steps
        for k in range(steps):
            k1, v1 = rate(frame, k * h)
            k2, v2 = rate(frame + h / 2 * k1, (k + 0.5) * h)
            k3, v3 = rate(frame + h / 2 * k2, (k + 0.5) * h)
            k4, v4 = rate(frame + h * k3, (k + 1) * h)
            frame = frame + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
            place = place + length * h / 6 * (v1 + 2 * v2 + 2 * v3 + v4)
        phase += winding
        result.append(place)
    return np.array(result)


@pytest.mark.parametrize("part", [None, 0.0, 1e-9, 0.5, 1.0, 1 + 1e-9, 2.5])
def test_agrees_with_an_independent_integrator(part):
    """`part`: |beta| over the winding; one formula must hold however fast the axis turns."""
    guides = [replace(g, element_count=4, **CURLY) for g in wound_guides(3)]
    coordinates = random_coordinates(guides)
    if part is not None:
        for guide, x in zip(guides, coordinates, strict=True):
            winding = np.linalg.norm(guide.resolved_natural(), axis=1) * guide.length_m / 4
            x[:, [0, 3]] = 0
            x *= (part * winding / np.linalg.norm(x, axis=1))[:, None]
    built = Strands(guides).positions(flat(coordinates), 5)  # At the ends of the elements.
    for guide, x, points in zip(guides, coordinates, built, strict=True):
        np.testing.assert_allclose(points, integrate_rk4(guide, x, 600), atol=1e-8)


def test_curl_that_varies_agrees_with_an_independent_integrator():
    lengths = [0.02, 0.05, 0.03]
    guide = make_guide(
        length_m=0, element_count=0, element_lengths_m=lengths, model="wound",
        natural_twist=[94, 60, -80], natural_curvature_1=[80, 0, 20],
        natural_curvature_2=[120, -150, 90],
    )  # fmt: skip
    x = random_coordinates([make_guide(element_count=3)])
    points = Strands([guide]).positions(flat(x), 11)[0]  # Every centimetre.
    np.testing.assert_allclose(points[[0, 2, 7, 10]], integrate_rk4(guide, x[0], 300), atol=1e-8)


@pytest.mark.parametrize(
    "natural", [(94, 80, 120), (150, 0, 1880), (-94, 80, -120), (0, -300, 0), (300, 1e-6, 0)]
)
def test_the_natural_shape_is_the_helix_of_its_curvatures(natural):
    names = ("natural_twist", "natural_curvature_1", "natural_curvature_2")
    plain = [replace(g, **dict(zip(names, natural, strict=True))) for g in make_guides(5)]
    wound = [replace(guide, model="wound") for guide in plain]
    theta = [g.resolved_natural() * g.resolved_element_lengths_m()[:, None] for g in plain]
    strands = Strands(wound)
    assert strands.coordinate_count == 4 * strands.element_count
    built = strands.positions(np.zeros(strands.coordinate_count), 40)
    np.testing.assert_allclose(built, Strands(plain).positions(flat(theta), 40), atol=1e-13)


def test_a_pulled_out_coil_is_straight_along_its_axis():
    guide = make_guide(model="wound", **CURLY)
    natural = guide.resolved_natural()[0]
    omega, rise = np.linalg.norm(natural), natural[0] / np.linalg.norm(natural)
    # lambda = 1 at half the natural winding.
    strain = np.array([omega * rise / 2 - omega, 0, 0, omega * np.sqrt(1 - rise**2) / 2])
    x = np.outer(guide.resolved_element_lengths_m(), strain)
    built = Strands([guide]).positions(x, 9)[0]
    axis = Rotation.from_quat(guide.root_frame).apply(natural / omega)
    straight = guide.root_position + np.outer(np.linspace(0, guide.length_m, 9), axis)
    np.testing.assert_allclose(built, straight, atol=1e-15)


def test_hair_has_unit_speed_and_no_gaps():
    guides = wound_guides(6)
    points = 4001
    built = Strands(guides).positions(flat(random_coordinates(guides)), points)
    for guide, strand in zip(guides, built, strict=True):
        np.testing.assert_allclose(strand[0], guide.root_position, atol=1e-15)
        step = guide.length_m / (points - 1)
        chords = np.linalg.norm(np.diff(strand, axis=0), axis=1)
        assert chords.max() <= step * (1 + 1e-9)
        # Of an arc of curvature k < 500 / m; the tangent turns at joints.
        turned = np.count_nonzero(chords < step * (1 - (500 * step) ** 2 / 24))
        assert turned <= guide.element_count - 1
        assert chords.sum() == pytest.approx(guide.length_m, rel=1e-3)


def test_plain_and_wound_guides_stand_side_by_side():
    guides = make_guides(6)
    guides[1::2] = [replace(guide, model="wound", **CURLY) for guide in guides[1::2]]
    strands = Strands(guides)
    widths = [3, 4] * 3
    rng = np.random.default_rng(4)
    coordinates = [
        rng.normal(size=(guide.element_count, width))
        for guide, width in zip(guides, widths, strict=True)
    ]
    built = strands.positions(flat(coordinates), 7)
    for guide, x, points in zip(guides, coordinates, built, strict=True):
        np.testing.assert_allclose(points, Strands([guide]).positions(x, 7)[0], atol=1e-14)
    for x, back in zip(coordinates, strands.by_guide(flat(coordinates)), strict=True):
        np.testing.assert_array_equal(back, x)
    with pytest.raises(ValueError, match="reshape"):
        strands.positions(flat(coordinates)[:-1], 7)


def test_a_turned_root_turns_the_strand():
    guides = wound_guides(4)
    turn, away = Rotation.from_rotvec([0.4, -1.0, 2.0]), np.array([1, 2, 3])
    moved = [
        replace(
            guide,
            root_position=turn.apply(guide.root_position) + away,
            root_frame=(turn * Rotation.from_quat(guide.root_frame)).as_quat(),
        )
        for guide in guides
    ]
    x = flat(random_coordinates(guides))
    here, there = Strands(guides).positions(x, 9), Strands(moved).positions(x, 9)
    wanted = turn.apply(here.reshape(-1, 3)).reshape(here.shape) + away
    np.testing.assert_allclose(there, wanted, atol=1e-14)


def test_a_wound_guide_without_curvature_is_refused():
    with pytest.raises(mane.InvalidArgument, match="no curvature"):
        Strands([make_guide(model="wound", natural_curvature_1=[1, 0, 1, 1])])
