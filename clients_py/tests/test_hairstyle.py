"""Hairstyles without a server: uploads, downloads, files and pictures."""

from __future__ import annotations

from dataclasses import fields

import numpy as np
import pytest
from PIL import Image

import mane
from mane import grey_png, style_messages
from mane.hairstyle import Hairstyle, Masters, Members, Outcome, StyleReport, Volume
from mane.painter import Look, Painter, View
from mane.strand_files import load_strands
from mane.style import GUIDES
from mane.style_picture import curves, draw_hairstyle
from mane.v1 import groom_pb2, style_pb2

MESSAGE_LIMIT = 1024 * 1024


def upload(scalp, bodies=(), contact=None, style=None) -> list[style_pb2.ApplyStyleRequest]:
    style = style or mane.Style(seed=3)
    return list(style_messages.apply_style(style, GUIDES, scalp, contact, bodies, "anna", "Anna's"))


def test_a_style_is_uploaded_with_its_head_in_pieces_below_the_limit():
    rng = np.random.default_rng(1)
    big = mane.Mesh(
        rng.normal(size=(200_000, 3)), rng.integers(0, 200_000, (150_000, 3)), np.arange(1000)
    )
    bodies = [mane.Body("ball", mane.EllipsoidBody((1, 1, 1))), mane.Body("coat", big)]
    header, *parts = upload(big, bodies, mane.ScalpContact("skin"))
    assert header.header.groom_id == "anna" and header.header.display_name == "Anna's"
    assert header.header.request_id and header.header.style.seed == 3
    assert not header.header.HasField("ellipsoid")
    assert header.header.scalp_contact.material == groom_pb2.MATERIAL_SKIN
    assert header.header.guides.hair_type == groom_pb2.HAIR_TYPE_CAUCASIAN_WAVY
    assert all(part.ByteSize() < MESSAGE_LIMIT for part in parts)
    kinds = [part.WhichOneof("part") for part in parts]
    assert kinds == sorted(kinds, key=["scalp_mesh", "body", "commit"].index)
    assert kinds.count("commit") == 1 and kinds.count("scalp_mesh") > 4
    vertices = b"".join(part.scalp_mesh.vertices for part in parts)
    np.testing.assert_array_equal(np.frombuffer(vertices, "<f4").reshape(-1, 3), big.vertices)
    coat = b"".join(part.body.mesh.triangles for part in parts)
    np.testing.assert_array_equal(np.frombuffer(coat, "<u4").reshape(-1, 3), big.triangles)


def test_an_ellipsoid_travels_in_the_header():
    header, commit = upload(mane.Ellipsoid((0.1, 0.2, 0.3), cap_angle=1))
    assert header.header.ellipsoid.radii_m.z == 0.3 and header.header.ellipsoid.cap_angle == 1
    assert not header.header.HasField("scalp_contact")
    assert commit.WhichOneof("part") == "commit"


def make_hairstyle(points=((3, 2), (4,)), wisps=(0, 1)) -> Hairstyle:
    """Straight strands down from the crown, of so many control points, wisp by wisp."""
    counts = [count for wisp in points for count in wisp]
    lines = [
        np.stack([np.full(count, 0.01 * k), -0.1 * np.arange(count), np.zeros(count)], 1)
        for k, count in enumerate(counts)
    ]
    members = Members(
        np.repeat(np.array(wisps, np.uint32), [len(wisp) for wisp in points]),
        np.array(counts, np.uint32),
        np.concatenate(lines).astype(np.float32),
        np.tile(np.array([[200, 10, 10], [10, 200, 10]], np.uint8), (len(counts), 1))[
            : len(counts)
        ],
    )
    joints = np.arange(15, dtype=np.float32).reshape(5, 3)
    masters = Masters(
        np.array([2, 3], np.uint32), joints, joints + 1, np.array([0.1, 0.2], np.float32)
    )
    report = StyleReport(
        groom="grooms/anna",
        outcomes=(Outcome(0, "tail", 0, 2, 2), Outcome(0, "tail", 1, 2, 1)),
        wisp_count=len(masters.lengths),
        strand_count=len(counts),
        control_point_count=len(members.points),
        seconds_roots=0.5,
    )
    low = np.array([0.0, -1, 2])
    density = Volume(low, 0.01, np.arange(24, dtype=np.float32).reshape(2, 3, 4))
    field = Volume(low, 0.01, np.arange(72, dtype=np.float32).reshape(2, 3, 4, 3))
    return Hairstyle(masters, members, density, field, {"length": np.full((2, 2), 0.25)}, report)


def parts_of(hairstyle: Hairstyle, split: bool) -> list[style_pb2.HairstylePart]:
    """What a server sends: every list at once, or strand by strand."""
    part, parts = style_pb2.HairstylePart, []
    m, first = hairstyle.masters, hairstyle.masters.first_joint
    ranges = [(i, i + 1) for i in range(len(m.lengths))] if split else [(0, len(m.lengths))]
    for a, b in ranges:
        joints = slice(first[a], first[b])
        parts.append(
            part(
                masters=part.Masters(
                    joint_counts=m.joint_counts[a:b].tobytes(),
                    lengths=m.lengths[a:b].tobytes(),
                    outline=m.outline[joints].tobytes(),
                    points=m.points[joints].tobytes(),
                )
            )
        )
    m, first = hairstyle.members, hairstyle.members.first_point
    ranges = [(i, i + 1) for i in range(len(m.wisps))] if split else [(0, len(m.wisps))]
    for a, b in ranges:
        parts.append(
            part(
                members=part.Members(
                    wisps=m.wisps[a:b].tobytes(),
                    point_counts=m.point_counts[a:b].tobytes(),
                    points=m.points[first[a] : first[b]].tobytes(),
                    colours=m.colours[a:b].tobytes(),
                )
            )
        )
    volume = hairstyle.density.values.tobytes()
    for data in (volume[:32], volume[32:]) if split else (volume,):
        density = part.DensityField(cell_m=0.01, nodes_x=4, nodes_y=3, nodes_z=2, values=data)
        density.low.y, density.low.z = -1, 2
        parts.append(part(density=density))
    vectors = hairstyle.field.values.tobytes()
    for data in (vectors[:96], vectors[96:]) if split else (vectors,):
        field = style_pb2.StylingField.Grid(
            cell_m=0.01, nodes_x=4, nodes_y=3, nodes_z=2, values=data
        )
        field.low.y, field.low.z = -1, 2
        parts.append(part(field=field))
    png = grey_png.encode(np.ones((2, 2)))
    parts.append(part(map=part.Map(name="length", white=0.25, png=png)))
    report = style_pb2.StyleReport(
        **{f.name: getattr(hairstyle.report, f.name) for f in fields(StyleReport)}
        | {
            "outcomes": [
                style_pb2.StyleReport.Outcome(**vars(o)) for o in hairstyle.report.outcomes
            ]
        }
    )
    return [*parts, part(report=report)]


def download(parts) -> Hairstyle:
    whole = style_messages.DownloadedHairstyle()
    for part in parts:
        whole.add(style_pb2.HairstylePart.FromString(part.SerializeToString()))
    return whole.hairstyle()


def assert_same(a: Hairstyle, b: Hairstyle) -> None:
    for name in ("masters", "members", "density", "field"):
        for key, value in vars(getattr(a, name)).items():
            other = getattr(getattr(b, name), key)
            np.testing.assert_array_equal(value, other, f"{name}.{key}")
            assert np.asarray(value).dtype == np.asarray(other).dtype, f"{name}.{key}"
    assert a.maps.keys() == b.maps.keys()
    for name, values in a.maps.items():
        np.testing.assert_array_equal(values, b.maps[name])
    assert a.report == b.report


@pytest.mark.parametrize("split", [False, True])
def test_a_hairstyle_comes_in_parts_and_is_whole(split):
    sent = make_hairstyle()
    received = download(parts_of(sent, split))
    assert_same(received, sent)
    assert received.masters.first_joint.tolist() == [0, 2, 5]
    assert received.members.first_point.tolist() == [0, 3, 5, 9]
    strands = received.members.strands()
    assert [len(strand) for strand in strands] == [3, 2, 4]
    np.testing.assert_array_equal(strands[2][:, 0], np.float32(0.02))
    assert received.report.missed == (Outcome(0, "tail", 1, 2, 1),)
    assert list(received.report.stages_s()) == [
        "roots", "masters", "deformation", "members", "guides",
    ]  # fmt: skip


def test_an_incomplete_hairstyle_is_an_error():
    parts = parts_of(make_hairstyle(), split=True)
    for lost in range(len(parts)):
        if parts[lost].WhichOneof("part") == "map":
            continue
        with pytest.raises(mane.Internal, match="not complete"):
            download(parts[:lost] + parts[lost + 1 :])


def test_a_hairstyle_survives_its_file_whose_members_are_strands(tmp_path):
    hairstyle = make_hairstyle()
    hairstyle.save(tmp_path / "hair.npz")
    assert_same(Hairstyle.load(tmp_path / "hair.npz"), hairstyle)
    strands = load_strands(tmp_path / "hair.npz")
    np.testing.assert_array_equal(strands[2], hairstyle.members.strands()[2])
    np.savez(tmp_path / "other.npz", points=np.zeros((2, 3)))
    for file in (tmp_path / "other.npz", __file__):
        with pytest.raises(mane.InvalidArgument, match="not a saved hairstyle"):
            Hairstyle.load(file)


def test_drawn_curves_go_through_control_points_and_are_smooth():
    angle = np.linspace(0, np.pi, 9)
    arc = np.stack([np.cos(angle), np.sin(angle), 0 * angle], 1).astype(np.float32)
    lines = [arc, arc[:2], arc[:1]]
    members = Members(
        np.zeros(3, np.uint32),
        np.array([len(line) for line in lines], np.uint32),
        np.concatenate(lines),
        np.zeros((3, 3), np.uint8),
    )
    drawn = curves(members, 41)
    assert drawn.shape == (3, 41, 3) and drawn.dtype == np.float32
    np.testing.assert_allclose(drawn[0, ::5], arc, atol=1e-6)
    # Off the ends, whose tangents are guesses, it is the circle to a part of the chords' error.
    radius = np.linalg.norm(drawn[0, 5:-5], axis=1)
    assert np.abs(radius - 1).max() < 0.002 < 1 - np.cos(np.pi / 16)
    np.testing.assert_allclose(drawn[1, [0, -1]], arc[:2], atol=1e-6)
    np.testing.assert_array_equal(drawn[2], np.broadcast_to(arc[0], (41, 3)))


def test_strands_are_drawn_in_their_own_colours():
    lines = np.zeros((2, 8, 3), np.float32)
    lines[:, :, 1] = np.linspace(0, -0.2, 8)
    lines[:, :, 0] = [[-0.1], [0.1]]
    thick = np.repeat(lines, 40, axis=0)
    thick[..., 0] += np.tile(np.linspace(0, 0.02, 40), 2)[:, None]
    colours = np.repeat(np.array([[1.0, 0, 0], [0, 0, 1.0]]), 40, axis=0)
    motion = mane.Motion([0.0], [[0, 0, 0]])
    painter = Painter(None, thick[None], motion, Look(colours, hairs=None, size=96))
    picture = painter.frame(0, View(0, 0)).astype(int)
    red = (picture[..., 0] > picture[..., 2] + 60).nonzero()[1]
    blue = (picture[..., 2] > picture[..., 0] + 60).nonzero()[1]
    assert len(red) > 50 and len(blue) > 50 and red.max() < blue.min()
    with pytest.raises(mane.InvalidArgument, match="hair_color: has shape"):
        Painter(None, thick[None], motion, Look(colours[:3], hairs=None))


def test_a_picture_shows_three_sides(tmp_path):
    roots = mane.mesh.mannequin()
    centers = roots.vertices[roots.triangles[roots.hair_triangles]].mean(axis=1)[::3]
    lines = centers[:, None] + np.linspace(0, 0.1, 6)[:, None] * np.array([0, -1, -0.5])
    count = len(lines)
    members = Members(
        np.zeros(count, np.uint32),
        np.full(count, 6, np.uint32),
        lines.reshape(-1, 3).astype(np.float32),
        np.tile(np.array([20, 180, 20], np.uint8), (count, 1)),
    )
    whole = make_hairstyle()
    hairstyle = Hairstyle(whole.masters, members, whole.density, whole.field, {}, whole.report)
    draw_hairstyle(tmp_path / "x.png", hairstyle, roots, title="green", size=96)
    with Image.open(tmp_path / "x.png") as image:
        assert image.size == (288, 96)
        pixels = np.asarray(image).astype(int)
    views = np.split(pixels, 3, axis=1)
    green = [(view[..., 1] > view[..., 0] + 20).sum() for view in views]
    assert green[2] > 1.3 * green[0] > 0 and green[1] > 0  # Hair leans back.
