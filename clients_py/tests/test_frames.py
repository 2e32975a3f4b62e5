"""Decoding of the three frame formats, from bytes made here by the API's description."""

from __future__ import annotations

import struct
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import mane
from conftest import make_guides
from mane.frames import FrameDecoder
from mane.helix import Strands

AT_ORIGIN = mane.Pose()


def positions(guides: int = 3, points: int = 5) -> np.ndarray:
    return np.random.default_rng(2).uniform(-2, 2, (guides, points, 3)).astype(np.float32)


def test_float32_is_exact_and_writable():
    sent = positions()
    data = b"".join(struct.pack("<f", x) for x in sent.ravel())
    decoded, angles = FrameDecoder("float32", 3, 5).decode(data, AT_ORIGIN)
    np.testing.assert_array_equal(decoded, sent)
    assert decoded.dtype == np.float32 and angles is None
    decoded[0] = 0


def test_quantized16_is_within_the_stated_error():
    sent = positions()
    data = b""
    for strand in sent:
        low, high = strand.min(axis=0), strand.max(axis=0)
        data += struct.pack("<6f", *low, *high)
        levels = np.rint((strand - low) / (high - low) * 65535).astype(int)
        data += struct.pack(f"<{levels.size}H", *levels.ravel())
    decoded, _ = FrameDecoder("quantized16", 3, 5).decode(data, AT_ORIGIN)
    size = np.ptp(sent, axis=1, keepdims=True)
    rounding = 4 * np.finfo(np.float32).eps  # Of the box's corners and of the result, |x| <= 2.
    assert np.all(np.abs(decoded - sent) <= size / 131070 + rounding)
    assert not np.array_equal(decoded, sent)


def test_quantized16_of_a_flat_box_is_exact():
    data = struct.pack("<6f", 1, 2, 3, 1, 2, 3) + struct.pack("<6H", 0, 7, 65535, 0, 7, 65535)
    decoded, _ = FrameDecoder("quantized16", 1, 2).decode(data, AT_ORIGIN)
    np.testing.assert_array_equal(decoded, [[[1, 2, 3], [1, 2, 3]]])


@pytest.mark.parametrize("space", ["world", "head"])
def test_generalized_is_rebuilt_in_the_asked_space(space):
    strands = Strands(make_guides(4))
    angles = np.random.default_rng(3).normal(size=(strands.element_count, 3)).astype(np.float32)
    data = b"".join(struct.pack("<f", x) for x in angles.ravel())
    pose = mane.Pose(0, (1, 2, 3), Rotation.from_rotvec([0.3, -1.0, 0.2]).as_quat())
    decoder = FrameDecoder("generalized", 4, 6, space, strands)
    decoded, given = decoder.decode(data, pose)
    expected = strands.positions(angles.astype(np.float64), 6)
    if space == "world":
        turned = Rotation.from_quat(pose.orientation).apply(expected.reshape(-1, 3))
        expected = turned.reshape(expected.shape) + pose.position
    np.testing.assert_allclose(decoded, expected, atol=5e-7)
    np.testing.assert_array_equal(np.concatenate(given), angles)
    assert decoded.dtype == np.float32


def test_generalized_frames_of_plain_and_wound_guides():
    guides = make_guides(4)
    guides[1], guides[3] = (replace(guide, model="wound") for guide in (guides[1], guides[3]))
    strands = Strands(guides)
    widths = [3, 4, 3, 4]
    sent = [
        np.random.default_rng(k).normal(size=(guide.element_count, width)).astype(np.float32)
        for k, (guide, width) in enumerate(zip(guides, widths, strict=True))
    ]
    data = b"".join(struct.pack("<f", x) for angles in sent for x in angles.ravel())
    decoded, given = FrameDecoder("generalized", 4, 6, "head", strands).decode(data, AT_ORIGIN)
    for k, (guide, angles) in enumerate(zip(guides, sent, strict=True)):
        np.testing.assert_array_equal(given[k], angles)
        alone = Strands([guide]).positions(angles, 6)[0]
        np.testing.assert_allclose(decoded[k], alone, atol=1e-7)
    with pytest.raises(mane.Internal, match="bytes arrived"):
        FrameDecoder("generalized", 4, 6, "head", strands).decode(data[:-4], AT_ORIGIN)


@pytest.mark.parametrize("format", list(mane.FrameFormat))
def test_a_frame_of_another_size_is_refused(format):
    decoder = FrameDecoder(format, 2, 4, strands=Strands(make_guides(2)))
    with pytest.raises(mane.Internal, match="7 bytes arrived"):
        decoder.decode(bytes(7), AT_ORIGIN)
