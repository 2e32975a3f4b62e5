"""Files of strands: every format says the same, and what is no such file is refused."""

from __future__ import annotations

import json
import struct

import numpy as np
import pytest

import mane
from mane.strand_files import load_strands, thinned

STRANDS = [
    np.array([(0, 0, 0), (0, -0.5, 0.25), (0.125, -1, 0.5)]),
    np.array([(1, 0, 0), (1, -1, 0)]),
    np.array([(2, 0, 0), (2, -1, 0), (2, -2, 0), (2, -3, 0.75)]),
]


def write_npz(path):
    counts = [len(strand) for strand in STRANDS]
    np.savez(path, points=np.concatenate(STRANDS), counts=counts)


def write_json(path):
    path.write_text(json.dumps([strand.tolist() for strand in STRANDS]))


def write_json_object(path):
    path.write_text(json.dumps({"strands": [strand.tolist() for strand in STRANDS]}))


def write_csv(path):
    lines = [f"{i},{x},{y},{z}" for i, strand in enumerate(STRANDS) for x, y, z in strand]
    path.write_text("\n".join(["strand,x,y,z", *lines, ""]))


def write_hair(path, arrays=0b11111):
    """By the format's description: header, segments, points, thickness, transparency, colours."""
    count = sum(len(strand) for strand in STRANDS)
    data = b"HAIR" + struct.pack("<4I", len(STRANDS), count, arrays, 5)
    data += struct.pack("<2f3f", 1, 0, 1, 1, 1) + b"made by a test".ljust(88, b"\0")
    assert len(data) == 128
    if arrays & 1:
        data += struct.pack(f"<{len(STRANDS)}H", *(len(strand) - 1 for strand in STRANDS))
    data += np.concatenate(STRANDS).astype("<f4").tobytes()
    path.write_bytes(data + bytes(4 * 5 * count))


def write_data(path):
    """With an entry of one point, which is no hair."""
    data = struct.pack("<i", len(STRANDS) + 1) + struct.pack("<i3f", 1, 9, 9, 9)
    for strand in STRANDS:
        data += struct.pack("<i", len(strand)) + strand.astype("<f4").tobytes()
    path.write_bytes(data)


@pytest.mark.parametrize(
    ("name", "write"),
    [
        ("a.npz", write_npz),
        ("a.json", write_json),
        ("b.json", write_json_object),
        ("a.csv", write_csv),
        ("a.hair", write_hair),
        ("a.DATA", write_data),
    ],
)
def test_every_format_says_the_same(tmp_path, name, write):
    write(tmp_path / name)
    for read, sent in zip(load_strands(tmp_path / name), STRANDS, strict=True):
        np.testing.assert_array_equal(read, sent)
    left = load_strands(tmp_path / name, unit="cm", axes="unity")
    np.testing.assert_allclose(left[0][2], (-0.00125, -0.01, 0.005))


def test_npz_of_equal_strands(tmp_path):
    points = np.arange(24.0).reshape(2, 4, 3)
    np.savez(tmp_path / "a.npz", points=points)
    np.testing.assert_array_equal(np.stack(load_strands(tmp_path / "a.npz")), points)


def test_hair_of_equal_strands_needs_no_segments(tmp_path):
    path = tmp_path / "a.hair"
    data = b"HAIR" + struct.pack("<4I", 2, 12, 0b10, 5) + bytes(20 + 88)
    points = np.arange(36, dtype="<f4")
    path.write_bytes(data + points.tobytes())
    np.testing.assert_array_equal(np.stack(load_strands(path)), points.reshape(2, 6, 3))


BAD = {
    "a.txt": b"strands",
    "no-header.csv": b"0,1,2,3\n0,1,2,4\n",
    "no-number.csv": b"strand,x,y,z\n0,1,2,three\n",
    "short-row.csv": b"strand,x,y,z\n0,1,2,3\n0,1,2\n",
    "empty.csv": b"strand,x,y,z\n",
    "none.json": b"[]",
    "flat.json": b"[[1, 2, 3]]",
    "broken.json": b"[[[1, 2",
    "words.json": b'{"hair": []}',
    "no.hair": b"HAIRY" * 3,
    "no-points.hair": b"HAIR" + struct.pack("<4I", 2, 12, 0b01, 5) + bytes(108),
    "wrong-count.hair": b"HAIR" + struct.pack("<4I", 2, 11, 0b10, 5) + bytes(108 + 132),
    "cut.hair": b"HAIR" + struct.pack("<4I", 2, 12, 0b10, 5) + bytes(108 + 100),
    "cut.data": struct.pack("<ii3f", 1, 2, 1, 2, 3),
    "negative.data": struct.pack("<ii", 1, -1),
    "no.npz": b"PK\3\4 and no more",
}


@pytest.mark.parametrize("name", BAD)
def test_what_is_no_such_file_is_refused_by_name(tmp_path, name):
    (tmp_path / name).write_bytes(BAD[name])
    with pytest.raises(mane.InvalidArgument, match=name):
        load_strands(tmp_path / name)


def test_npz_that_does_not_add_up_is_refused(tmp_path):
    np.savez(tmp_path / "a.npz", points=np.zeros((5, 3)), counts=[2, 2])
    with pytest.raises(mane.InvalidArgument, match="add up to 4, not 5"):
        load_strands(tmp_path / "a.npz")


def test_thinning_keeps_the_ends_and_an_even_choice():
    strands = [np.stack([np.full(50, i), np.arange(50.0), np.zeros(50)], 1) for i in range(100)]
    few = thinned(strands, 10, 8)
    assert [int(strand[0, 0]) for strand in few] == list(range(0, 100, 10))
    for strand in few:
        assert len(strand) == 8 and strand[0, 1] == 0 and strand[-1, 1] == 49
        assert np.all(np.diff(strand[:, 1]) >= 6)
    assert thinned(strands, 0, 0) is strands
    assert len(thinned(strands[:3], 10)) == 3 and len(thinned(strands, 1, 1)[0]) == 2
