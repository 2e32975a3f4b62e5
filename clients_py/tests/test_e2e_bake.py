"""Bakes on a real daemon: the frames of LOCKSTEP, progress, cancellation."""

from __future__ import annotations

import asyncio
import itertools

import numpy as np
import pytest

import mane
import mane.aio
from conftest import make_guide, make_guides, shake, start_daemon, stop_daemon


@pytest.fixture
def long_bake(client):
    """A bake that takes far longer than the tests that stop it."""
    groom = client.create_groom([make_guide(element_count=50) for _ in range(100)])
    bake = client.bake(groom, mane.Motion(np.arange(16_000) / 60), substeps=64)
    yield bake
    bake.cancel()
    for _ in bake.watch():
        pass
    client.delete_groom(groom)


@pytest.mark.parametrize("format", list(mane.FrameFormat))
def test_a_bake_gives_the_frames_of_lockstep_bit_for_bit(client, groom, format):
    motion = shake(0.5)
    options = {"format": format, "points_per_guide": 9, "substeps": 2}
    bake = client.bake(groom, motion, **options)
    assert bake.name.startswith("jobs/") and bake.job.kind == "bake"
    assert bake.wait().state == mane.JobState.SUCCEEDED
    baked = list(bake.frames())
    with client.open_head(groom, "lockstep", **options) as head:
        streamed = list(head.play(motion))
    for one, other in zip(baked, streamed, strict=True):
        assert (one.index, one.time_s) == (other.index, other.time_s)
        np.testing.assert_array_equal(one.positions, other.positions)
    client.delete_job(bake.job)
    with pytest.raises(mane.NotFound):
        client.get_job(bake.job)


def test_head_space_and_environment_reach_a_bake(client, groom):
    calm = client.bake(groom, shake(0.2), space="head")
    windy = client.bake(
        groom, shake(0.2), space="head", environment=mane.Environment(wind_velocity=(30, 0, 0))
    )
    calm.wait(), windy.wait()
    roots = [g.root_position for g in client.export_groom(groom).guides]
    last = [list(bake.frames())[-1].positions for bake in (calm, windy)]
    for positions in last:
        np.testing.assert_allclose(positions[:, 0], roots, atol=1e-6)
    assert np.abs(last[0] - last[1]).max() > 1e-4


def test_calm_hair_is_baked_and_streamed_with_fewer_elements(client):
    generate = mane.GuideGeneration("caucasian_curly", 32, 0.1, 8, seed=3)
    groom = client.create_groom(scalp=mane.Ellipsoid((0.08, 0.1, 0.09)), generate=generate)
    motion = mane.Motion(np.arange(120) / 60)
    tolerant = mane.Environment(detail_tolerance_m=0.01)
    bake = client.bake(groom, motion, environment=tolerant)
    bake.wait()
    baked = list(bake.frames())
    with client.open_head(groom, "lockstep", environment=tolerant) as head:
        streamed = list(head.play(motion))
    client.delete_groom(groom)
    elements = [frame.stepped_elements for frame in baked]
    assert elements[-1] < 0.7 * elements[0]
    assert elements == [frame.stepped_elements for frame in streamed]
    for one, other in zip(baked, streamed, strict=True):
        np.testing.assert_array_equal(one.positions, other.positions)


def test_poses_a_second_apart_are_baked_however_they_are_rounded(client, groom):
    times = np.array([1.2, 2.2, 3.2])
    assert times[1] - times[0] > 1
    assert client.bake(groom, mane.Motion(times)).wait().state == mane.JobState.SUCCEEDED


def test_progress_only_grows_and_ends_at_one(client, groom):
    bake = client.bake(groom, mane.Motion(np.arange(2000) / 60))
    seen = list(bake.watch())
    assert seen[-1].state == mane.JobState.SUCCEEDED and seen[-1].progress == 1
    progress = [job.progress for job in seen]
    assert progress == sorted(progress)
    assert all(0 <= value <= 1 for value in progress)
    done = client.get_job(bake.name)
    assert done.result_bytes > 0 and done.error == ""
    assert done.create_time <= done.start_time <= done.end_time
    assert done.name in [job.name for job in client.list_jobs(page_size=1)]


def test_a_running_bake_can_be_cancelled_and_not_read(client, long_bake):
    for job in long_bake.watch():
        if job.state == mane.JobState.RUNNING:
            break
    with pytest.raises(mane.FailedPrecondition):
        next(long_bake.frames())
    with pytest.raises(mane.FailedPrecondition):
        client.delete_job(long_bake.job)
    long_bake.cancel()
    with pytest.raises(mane.JobFailed, match="was cancelled"):
        long_bake.wait()
    assert long_bake.job.state == mane.JobState.CANCELLED
    assert long_bake.cancel().state == mane.JobState.CANCELLED  # As it is.
    with pytest.raises(mane.FailedPrecondition):
        next(long_bake.frames())


def test_asyncio_bakes(groom, maned):
    async def run():
        async with mane.aio.Client(maned.address) as client:
            motion = shake(0.2)
            bake = await client.bake(groom, motion, format="generalized")
            assert (await bake.wait()).state == mane.JobState.SUCCEEDED
            baked = [frame async for frame in bake.frames()]
            async with client.open_head(groom, "lockstep", format="generalized") as head:
                streamed = [frame async for frame in head.play(motion)]
            assert bake.name in [job.name async for job in client.list_jobs()]
            await client.delete_job(bake.job)
            with pytest.raises(mane.NotFound):
                await client.get_job(bake.job)
            return baked, streamed

    baked, streamed = asyncio.run(asyncio.wait_for(run(), 60))
    for one, other in zip(baked, streamed, strict=True):
        np.testing.assert_array_equal(one.positions, other.positions)


def test_grooms_and_finished_bakes_survive_a_kill(tmp_path):
    motion = shake(0.2)
    daemon = start_daemon(tmp_path)
    try:
        with mane.Client(daemon.address) as client:
            groom = client.create_groom(make_guides(3))
            bake = client.bake(groom, motion)
            bake.wait()
            before = [frame.positions for frame in bake.frames()]
    finally:
        daemon.process.kill()
        daemon.process.wait()
    daemon = start_daemon(tmp_path)
    try:
        with mane.Client(daemon.address) as client:
            assert client.get_groom(groom).etag == groom.etag
            assert client.get_job(bake.job).state == mane.JobState.SUCCEEDED
            after = [frame.positions for frame in client.read_bake(bake.job, bake._reading)]
            with client.open_head(groom, "lockstep") as head:
                replayed = [frame.positions for frame in head.play(motion)]
    finally:
        assert stop_daemon(daemon) == 0
    for frames in zip(before, after, replayed, strict=True):
        for one, other in itertools.pairwise(frames):
            np.testing.assert_array_equal(one, other)
