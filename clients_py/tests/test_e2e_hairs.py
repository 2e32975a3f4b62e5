"""Hairs on a real daemon: kept as they were sent, and carried by every frame."""

from __future__ import annotations

import asyncio

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import mane
from conftest import make_guides, shake, start_daemon, stop_daemon
from mane import aio, hairs

POINTS = 16
GUIDES = 5


def wisps(client, guides, per_guide: int = 8, spread_m: float = 0.01):
    """Hairs about guides at rest: what rides, and the curves (point, 3) [m] that it stands for."""
    groom = client.create_groom(guides)
    rest = client.rest_shape(groom, points_per_guide=POINTS).positions
    client.delete_groom(groom)
    rng = np.random.default_rng(1)
    on = np.repeat(np.arange(len(guides)), per_guide)
    along = np.arange(0, POINTS, 3)
    counts = np.full(len(on), len(along))
    curves = (rest[on][:, along] + rng.uniform(-spread_m, spread_m, (len(on), 1, 3))).reshape(-1, 3)
    parts = np.tile(along / (POINTS - 1), len(on))
    colours = rng.integers(0, 256, (len(on), 3))
    roots = hairs.root_frames(guides)
    return hairs.ride_on(rest, roots, on, counts, parts, curves, colours), curves


def same(a: hairs.Hairs, b: hairs.Hairs) -> bool:
    names = ("guides", "point_counts", "parts", "offsets", "colours")
    return a.offset_unit_m == b.offset_unit_m and all(
        np.array_equal(getattr(a, name), getattr(b, name)) for name in names
    )


def test_hairs_are_kept_over_a_restart(tmp_path):
    daemon = start_daemon(tmp_path)
    try:
        with mane.Client(daemon.address) as client:
            guides = make_guides(GUIDES)
            bald = client.create_groom(guides)
            value, _ = wisps(client, guides)
            groom = client.create_groom(guides, hairs=value)
            assert (groom.hair_count, groom.hair_point_count) == (len(value), len(value.parts))
            first = client.export_groom(groom)
    finally:
        stop_daemon(daemon)
    daemon = start_daemon(tmp_path)
    try:
        with mane.Client(daemon.address) as client:
            second = client.export_groom(groom)
            assert same(first.hairs, second.hairs)
            assert client.export_groom(groom, hairs=False).hairs is None
            np.testing.assert_array_equal(first.hairs.colours, value.colours)
            again = client.create_groom(second.guides, hairs=second.hairs)
            assert again.etag == groom.etag != bald.etag
            assert client.create_groom(second.guides).etag == bald.etag
            assert client.export_groom(bald).hairs is None
    finally:
        stop_daemon(daemon)


@pytest.mark.parametrize("format", list(mane.FrameFormat))
def test_hairs_are_where_they_were_modelled_and_go_with_every_frame(client, format):
    guides = make_guides(GUIDES)
    made, curves = wisps(client, guides)
    groom = client.create_groom(guides, hairs=made)
    value = client.export_groom(groom).hairs
    poses = list(shake(0.5).poses())
    frames = {}
    for space in mane.Space:
        with client.open_head(
            groom, "lockstep", format=format, space=space, points_per_guide=POINTS
        ) as head:
            frames[space] = [head.step(pose) for pose in poses]
    at_rest = frames[mane.Space.HEAD][0]
    drawn = hairs.assemble(at_rest.positions, hairs.root_frames(guides), value)
    # Half a unit an axis, the frame's rounding, and how far it is from rest.
    assert np.linalg.norm(drawn - curves, axis=1).max() < made.offset_unit_m + 1e-4
    for here, there in zip(frames[mane.Space.HEAD], frames[mane.Space.WORLD], strict=True):
        inside = hairs.assemble(here.positions, hairs.root_frames(guides), value)
        pose = there.head_pose
        outside = hairs.assemble(
            there.positions, hairs.root_frames(guides, pose.orientation), value
        )
        turned = Rotation.from_quat(pose.orientation).apply(inside) + pose.position
        np.testing.assert_allclose(outside, turned, atol=2e-5)
    client.delete_groom(groom)


def test_hairs_ride_on_guides_that_the_server_makes(client, maned):
    value = hairs.Hairs(
        np.repeat(np.arange(30), 4), np.full(120, 2), np.tile([0, 1], 120),
        np.full((240, 3), 0.001), offset_unit_m=1e-6,
    )  # fmt: skip
    scalp = mane.Ellipsoid((0.08, 0.1, 0.09))
    generate = mane.GuideGeneration("asian_smooth", 30, 0.1)
    generated = client.create_groom(scalp=scalp, generate=generate, hairs=value)
    assert same(client.export_groom(generated).hairs, value)
    line = np.stack([np.zeros(5), 0.1 + np.linspace(0, 0.05, 5), np.zeros(5)], axis=1)
    imported = client.create_groom(strands=[line] * 30, hairs=value)
    assert imported.hair_count == 120

    async def of_another():
        async with aio.Client(maned.address) as other:
            groom = await other.create_groom(make_guides(30), hairs=value)
            return await other.export_groom(groom)

    np.testing.assert_array_equal(asyncio.run(of_another()).hairs.offsets, value.offsets)


def test_what_is_wrong_is_named(client):
    def upload(**changes):
        fine = {
            "guides": [0, 0, 1], "point_counts": [2, 2, 2], "parts": [0, 1] * 3,
            "offsets": np.zeros((6, 3)),
        }  # fmt: skip
        client.create_groom(make_guides(2), hairs=hairs.Hairs(**(fine | changes)))

    cases = {
        "hairs[2].guide": {"guides": [0, 0, 2]},
        "hairs[1].guide": {"guides": [1, 0, 1]},
        "hairs[1].point_count": {"point_counts": [3, 1, 2], "parts": [0, 0.5, 1, 1, 0, 1]},
        "hairs[0].places[1]": {"parts": [1, 0, 0, 1, 0, 1]},
        "header.hair_offset_unit_m": {"offset_unit_m": 2e-3},
    }
    for field, changes in cases.items():
        with pytest.raises(mane.InvalidArgument) as refused:
            upload(**changes)
        assert refused.value.field_violations[0].field == field
    upload()
