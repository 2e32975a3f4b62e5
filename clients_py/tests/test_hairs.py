"""Hairs on their guides: numbers that the server's tests hold too, and the laws of the carriage."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import mane
from conftest import make_guide
from mane import hair_messages, hairs

UNIT_M = 1e-6


def wild(rng, guides: int = 20, points: int = 16) -> tuple[np.ndarray, np.ndarray]:
    """Points of guides that go to and fro, and their root frames."""
    places = np.cumsum(0.01 * rng.normal(size=(guides, points, 3)), axis=1)
    return places, Rotation.random(guides, rng).as_quat()


def some_hairs(rng, guides: int = 20, count: int = 100, reach_m: float = 0.03) -> hairs.Hairs:
    counts = rng.integers(2, 40, count)
    parts = np.concatenate([np.sort(rng.uniform(0, 1, n)) for n in counts])
    return hairs.Hairs(
        np.sort(rng.integers(0, guides, count)), counts, parts,
        rng.uniform(-reach_m, reach_m, (counts.sum(), 3)), rng.integers(0, 256, (count, 3)),
    )  # fmt: skip


def exported(value: hairs.Hairs) -> hairs.Hairs:
    """As they come back from a server."""
    parts = hair_messages.ExportedHairs()
    for batch in hair_messages.batches(value):
        parts.add(batch)
    assert parts.counts() == (len(value), len(value.parts))
    return parts.hairs(value.offset_unit_m)


def test_numbers_are_those_of_the_server():
    """server/wire/assemble_hair_test.cpp holds the same."""
    k = np.arange(6)
    points = np.stack([0.01 * k, 0.002 * k**2, 0.0005 * k**3 - 0.003 * k], axis=1)[None]
    parts = np.array([0, 6554, 30000, 50001, 65535]) / 65535
    offsets = UNIT_M * np.array(
        [[0, 0, 0], [1000, -2000, 3000], [-32768, 0, 32767], [5, 20000, -7], [100, -100, 10000]]
    )
    value = hairs.Hairs([0], [5], parts, offsets, offset_unit_m=UNIT_M)
    got = hairs.assemble(points, [[0.1, -0.2, 0.3, 0.9]], value)
    expected = [
        [0.0, 0.0, 0.0],
        [0.00657556, -0.00140369, 0.00118462],
        [-0.0050273, -0.02163451, 0.01752796],
        [0.02125573, 0.03980272, 0.01673346],
        [0.04583381, 0.0428588, 0.05312727],
    ]
    np.testing.assert_allclose(got, expected, atol=2e-8)


def test_hairs_ride_back_to_where_they_were():
    rng = np.random.default_rng(1)
    points, roots = wild(rng)
    value = some_hairs(rng)
    curves = points[np.repeat(value.guides, value.point_counts), 3] + value.offsets
    made = hairs.ride_on(
        points, roots, value.guides, value.point_counts, value.parts, curves, value.colours
    )
    back = exported(made)
    np.testing.assert_array_equal(back.colours, value.colours)
    away = np.linalg.norm(hairs.assemble(points, roots, back) - curves, axis=1)
    assert away.max() <= np.sqrt(0.75) * made.offset_unit_m + 1e-7
    again = exported(back)
    for name in ("guides", "point_counts", "parts", "offsets", "colours"):
        np.testing.assert_array_equal(getattr(again, name), getattr(back, name))


def test_a_rigid_motion_moves_hairs_rigidly():
    rng = np.random.default_rng(2)
    points, roots = wild(rng)
    value = some_hairs(rng)
    turn, shift = Rotation.random(rng=rng), np.array([1.0, 2.0, 3.0])
    moved = points @ turn.as_matrix().T + shift
    here = hairs.assemble(points, roots, value)
    there = hairs.assemble(moved, (turn * Rotation.from_quat(roots)).as_quat(), value)
    np.testing.assert_allclose(there, here @ turn.as_matrix().T + shift, atol=1e-6)


def test_hairs_keep_their_distance_from_a_guide_that_bends():
    rng = np.random.default_rng(3)
    value = some_hairs(rng, guides=1)
    centres = hairs.Hairs(value.guides, value.point_counts, value.parts, 0 * value.offsets)
    s = np.linspace(0, 0.3, 48)
    for rate in (5, 50, 200):
        helix = np.stack([0.6 * s, 0.8 / rate * np.cos(rate * s), 0.8 / rate * np.sin(rate * s)], 1)
        root = [mane.frame_along((0.6, 0, 0.8))]
        away = hairs.assemble(helix[None], root, value) - hairs.assemble(helix[None], root, centres)
        np.testing.assert_allclose(
            np.linalg.norm(away, axis=1), np.linalg.norm(value.offsets, axis=1), atol=1e-7
        )


def test_offsets_of_zero_lie_on_the_guide_and_nothing_is_undefined():
    rng = np.random.default_rng(4)
    points, roots = wild(rng, points=6)
    points[0] = points[0, 0]  # A guide of one point.
    points[1, 3:] = points[1, 2]
    points[2, 1::2], points[2, ::2] = points[2, 1], points[2, 0]
    count = len(points)
    value = hairs.Hairs(
        np.arange(count), np.full(count, 6), np.tile(np.arange(6) / 5, count),
        np.zeros((6 * count, 3)),
    )  # fmt: skip
    got = hairs.assemble(points, roots, value).reshape(points.shape)
    np.testing.assert_allclose(got, points, atol=1e-7)
    two = hairs.assemble(points[:, :2], roots, value).reshape(points.shape)
    np.testing.assert_allclose(two[:, 1], 0.8 * points[:, 0] + 0.2 * points[:, 1], atol=1e-7)


def test_root_frames_turn_with_the_head():
    guides = [make_guide(root_frame=mane.frame_along(d)) for d in ((0, 1, 0), (1, 0, 1))]
    turn = Rotation.from_rotvec((0, 0.3, 0.1))
    frames = Rotation.from_quat(hairs.root_frames(guides, turn.as_quat()))
    for guide, frame in zip(guides, frames, strict=True):
        own = Rotation.from_quat(guide.root_frame)
        np.testing.assert_allclose(frame.as_matrix(), (turn * own).as_matrix(), atol=1e-12)


def test_batches_are_whole_hairs_within_the_servers_limit():
    rng = np.random.default_rng(5)
    counts = rng.integers(2, 1001, 1000)
    value = hairs.Hairs(np.zeros(1000), counts, np.zeros(counts.sum()), np.zeros((counts.sum(), 3)))
    batches = list(hair_messages.batches(value))
    assert len(batches) > 5 and max(batch.ByteSize() for batch in batches) < 1 << 20
    for batch in batches:
        assert len(batch.places) == 8 * np.frombuffer(batch.point_counts, "<u2").sum()
        assert not batch.colours
    assert not list(hair_messages.batches(None))


@pytest.mark.parametrize(
    "field, values",
    [
        ("point_counts", {"point_counts": [2]}),
        ("parts", {"parts": [0, 1, 0]}),
        ("offsets", {"offsets": np.zeros((4, 2))}),
        ("colours", {"colours": [1, 2, 3]}),
        ("offsets", {"offsets": np.full((4, 3), 0.04), "offset_unit_m": UNIT_M}),
        ("offsets", {"offsets": np.full((4, 3), np.nan)}),
    ],
)
def test_what_does_not_fit_is_refused(field, values):
    fine = {
        "guides": [0, 1], "point_counts": [2, 2], "parts": [0, 1, 0, 1], "offsets": np.zeros((4, 3))
    }  # fmt: skip
    hairs.Hairs(**fine)
    with pytest.raises(mane.InvalidArgument) as refused:
        hairs.Hairs(**(fine | values))
    assert refused.value.field_violations[0].field == field
