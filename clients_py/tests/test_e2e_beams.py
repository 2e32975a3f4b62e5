"""Heads whose guides are beams, on a real daemon."""

from __future__ import annotations

import asyncio

import numpy as np
import pytest

import mane
import mane.aio
from conftest import shake

BEAM = mane.AnimationModel.BEAM
RODS = mane.AnimationModel.SUPER_HELIX


def play(client, groom, motion, **options) -> list[mane.Frame]:
    with client.open_head(groom, "lockstep", **options) as head:
        return list(head.play(motion))


def test_a_head_is_animated_as_beams_the_same_way_each_time(client, groom):
    options = {"model": "beam", "beam": mane.BeamMotion(segments=5), "diagnostics": True}
    frames = play(client, groom, shake(0.3), **options)
    again = play(client, groom, shake(0.3), **options)
    for one, other in zip(frames, again, strict=True):
        assert one.model == BEAM and one.diagnostics is None
        assert one.stepped_elements == 5 * len(one.positions)
        assert np.isfinite(one.positions).all()
        np.testing.assert_array_equal(one.positions, other.positions)
    rods = play(client, groom, shake(0.3))
    assert all(frame.model == RODS for frame in rods)
    assert np.abs(rods[-1].positions - frames[-1].positions).max() > 1e-3


def test_still_beams_keep_the_rest_shape_s_nodes(client, groom):
    still = mane.Motion(np.arange(30) / 60)
    options = {"space": "head", "points_per_guide": 33}
    beams = play(client, groom, still, model="beam", beam=mane.BeamMotion(segments=32), **options)
    rods = play(client, groom, still, **options)
    assert np.abs(beams[-1].positions - beams[0].positions).max() < 1e-5
    assert np.abs(beams[-1].positions - rods[0].positions).max() < 2e-3


def test_a_head_changes_its_model_without_a_jump(client, groom):
    poses = list(shake(1.0).poses())
    with client.open_head(groom, "lockstep") as head:
        frames = []
        for i, pose in enumerate(poses):
            if i == 20:
                head.set_model("beam", mane.BeamMotion(segments=12))
            if i == 40:
                head.set_model(RODS)
            frames.append(head.step(pose))
    assert [frame.model == BEAM for frame in frames] == [20 <= i < 40 for i in range(len(frames))]
    points = np.stack([frame.positions for frame in frames])
    moves = np.linalg.norm(np.diff(points, axis=0), axis=-1).max(axis=(1, 2))
    for change in (20, 40):
        assert moves[change - 1] < 1.5 * moves[change - 4 : change - 1].max() + 1e-3


def test_generalized_frames_cannot_show_beams(client, groom):
    with pytest.raises(mane.InvalidArgument) as caught:
        client.open_head(groom, "lockstep", format="generalized", model="beam")
    assert caught.value.field_violations[0].field == "open.model"
    with pytest.raises(mane.InvalidArgument, match="must be one of super_helix, beam"):
        client.open_head(groom, "lockstep", model="spring")
    with pytest.raises(mane.InvalidArgument) as caught:
        client.open_head(groom, "lockstep", beam=mane.BeamMotion(segments=3, epsilon=[1]))
    assert caught.value.field_violations[0].field == "open.beam.epsilon"


def test_a_bake_of_beams_gives_the_frames_of_lockstep(client, groom):
    options = {"model": "beam", "beam": mane.BeamMotion(segments=7, hold=2)}
    bake = client.bake(groom, shake(0.3), **options)
    assert bake.wait().state == mane.JobState.SUCCEEDED
    streamed = play(client, groom, shake(0.3), **options)
    for one, other in zip(bake.frames(), streamed, strict=True):
        assert one.model == BEAM
        np.testing.assert_array_equal(one.positions, other.positions)
    client.delete_job(bake.job)


def test_a_realtime_head_changes_its_model(client, groom):
    with client.open_head(groom, "realtime", may_shed=True) as head:
        head.push(mane.Pose(0.0))
        head.set_model(BEAM)
        assert any(frame.model == BEAM for frame in head.frames())
        head.set_model(RODS)
        assert any(frame.model == RODS for frame in head.frames())


def test_an_asynchronous_head_changes_its_model(maned, groom):
    async def last_model() -> mane.AnimationModel:
        async with (
            mane.aio.Client(maned.address) as client,
            client.open_head(groom, "lockstep") as head,
        ):
            head.set_model("beam")
            return (await head.step(mane.Pose(0.0))).model

    assert asyncio.run(last_model()) == BEAM
