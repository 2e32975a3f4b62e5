"""The asyncio client on a real daemon: the same answers as the other one."""

from __future__ import annotations

import asyncio
from dataclasses import replace

import numpy as np
import pytest

import mane
import mane.aio
from conftest import make_guides, shake


def run(coroutine):
    return asyncio.run(asyncio.wait_for(coroutine, 60))


def test_grooms(client, maned):
    async def talk():
        async with mane.aio.Client(maned.address) as aio_client:
            groom = await aio_client.create_groom(make_guides(3), groom_id="asynchronous")
            assert groom.name in [g.name async for g in aio_client.list_grooms(page_size=1)]
            found = await aio_client.get_groom("asynchronous")
            exported = await aio_client.export_groom(groom)
            rest = await aio_client.rest_shape(groom, points_per_guide=5)
            assert replace(exported, guides=(), scalp=None).etag == found.etag == groom.etag
            other = client.rest_shape(groom, points_per_guide=5)
            np.testing.assert_array_equal(rest.positions, other.positions)
            await aio_client.delete_groom(groom)
            with pytest.raises(mane.NotFound, match="asynchronous"):
                await aio_client.export_groom(groom)

    run(talk())


def test_lockstep_gives_the_bits_of_the_other_client(client, groom, maned):
    motion = shake(0.5)
    with client.open_head(groom, "lockstep") as head:
        expected = [frame.positions for frame in head.play(motion)]

    async def talk():
        async with (
            mane.aio.Client(maned.address) as aio_client,
            aio_client.open_head(groom, "lockstep") as head,
        ):
            frames = [await head.step(pose) for pose in list(motion.poses())[:10]]
            frames += [frame async for frame in head.play(list(motion.poses())[10:])]
            frames.append(await head.teleport(mane.Pose(2.0)))
            head.reset()
            head.set_environment(mane.Environment(gravity=(0, 0, 0)))
            frames.append(await head.step(mane.Pose(2.5)))
        await head.close()  # Once more does no harm.
        with pytest.raises(mane.FailedPrecondition, match="is closed"):
            await head.step(mane.Pose(3.0))
        return frames

    frames = run(talk())
    assert [f.index for f in frames] == list(range(1, len(motion) + 3))
    np.testing.assert_array_equal([f.positions for f in frames[:-2]], expected)


def test_errors_end_the_head_and_reach_the_caller(groom, maned):
    async def talk():
        async with mane.aio.Client(maned.address) as client:
            with pytest.raises(mane.NotFound, match="nobody"):
                async with client.open_head("nobody", "lockstep"):
                    pass
            async with client.open_head(groom, "lockstep") as head:
                with pytest.raises(mane.InvalidArgument, match="nan"):
                    await head.step(mane.Pose(0, (np.nan, 0, 0)))
            with pytest.raises(RuntimeError, match="own"):
                async with client.open_head(groom, "lockstep"):
                    raise RuntimeError("own")

    run(talk())


def test_what_was_wrong_arrives_although_more_is_being_sent(groom, maned):
    # The server refuses the third of many poses that are under way.
    times = [0.0, 0.1, 0.05, *(0.1 * k for k in range(2, 40))]

    async def talk():
        async with mane.aio.Client(maned.address) as client:
            for _ in range(20):
                async with client.open_head(groom, "lockstep") as head:
                    with pytest.raises(mane.InvalidArgument, match=r"pose\.time_s is 0\.05"):
                        async for _ in head.play(map(mane.Pose, times), in_flight=30):
                            pass

    run(talk())


def test_a_step_that_is_given_up_does_not_disturb_what_follows(client, groom, maned):
    poses = list(shake(0.2).poses())
    with client.open_head(groom, "lockstep") as head:
        expected = [head.step(pose).positions for pose in poses]

    async def talk():
        async with (
            mane.aio.Client(maned.address) as aio_client,
            aio_client.open_head(groom, "lockstep") as head,
        ):
            given_up = asyncio.create_task(head.step(poses[0]))
            await asyncio.sleep(0)
            given_up.cancel()
            with pytest.raises(asyncio.CancelledError):
                await given_up
            return [(await head.step(pose)).positions for pose in poses[1:]]

    np.testing.assert_array_equal(run(talk()), expected[1:])


def test_a_cancelled_task_leaves_the_server_in_order(groom, maned):
    async def talk():
        async with mane.aio.Client(maned.address) as client:
            opened = asyncio.Event()

            async def watch():
                async with client.open_head(groom, "realtime") as head:
                    opened.set()
                    async for _ in head.frames():
                        pass

            task = asyncio.create_task(watch())
            await opened.wait()
            task.cancel()
            with pytest.raises(asyncio.CancelledError):
                await task
            assert (await client.status()).serving

    run(talk())
