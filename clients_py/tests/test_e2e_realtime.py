"""Heads in REALTIME on a real daemon: the newest frame wins, and a broken stream is mended."""

from __future__ import annotations

import asyncio
import contextlib
import itertools
import threading
import time
from collections.abc import Iterator

import numpy as np
import pytest

import mane
import mane.aio
from breaking_proxy import BreakingProxy
from conftest import make_guides, start_daemon, stop_daemon
from mane import messages, stream
from mane.v1 import animation_pb2

DEADLINE_S = 30.0


def pose_at(time_s: float) -> mane.Pose:
    """A head that goes to and fro once a second, 0.1 m to each side."""
    return mane.Pose(time_s, (0.1 * np.sin(2 * np.pi * time_s), 0, 0))


@contextlib.contextmanager
def pushing(head, rate_hz: float = 60.0) -> Iterator[threading.Event]:
    """Pushes poses of the real clock until the block ends; an error ends it as well."""
    stop = threading.Event()

    def push() -> None:
        with contextlib.suppress(mane.Error):
            while not stop.wait(1 / rate_hz):
                head.push(pose_at(time.monotonic()))

    thread = threading.Thread(target=push)
    thread.start()
    try:
        yield stop
    finally:
        stop.set()
        thread.join()


def take(head, count: int) -> list[mane.Frame]:
    return list(itertools.islice(head.frames(DEADLINE_S), count))


def wait_until(condition) -> None:
    deadline = time.monotonic() + DEADLINE_S
    while not condition():
        assert time.monotonic() < deadline, "it did not happen in time"
        time.sleep(0.01)


def test_frames_follow_the_poses(client, groom):
    roots = [g.root_position for g in client.export_groom(groom).guides]
    with client.open_head(groom, "realtime", rate_hz=60, pose_delay_s=0.05) as head:
        assert (head.guide_count, head.points_per_guide) == (5, 16)
        with pushing(head):
            wait_until(lambda: (head.newest() or pose_at(0)).time_s > 0)
            frames = take(head, 40)
    for earlier, later in itertools.pairwise(frames):
        assert later.index == earlier.index + 1 + later.skipped
        assert later.time_s >= earlier.time_s
    for frame in frames:
        clamped = roots + frame.head_pose.position
        np.testing.assert_allclose(frame.positions[:, 0], clamped, atol=1e-6)
        assert np.isfinite(frame.positions).all() and frame.repaired_guides == 0
    moved = np.ptp([frame.head_pose.position[0] for frame in frames])
    assert moved > 0.05


def test_newest_never_waits_and_repeats_itself(client, groom):
    with client.open_head(groom, "realtime", rate_hz=1) as head:
        wait_until(lambda: head.newest() is not None)
        assert head.newest() is head.newest()


def test_a_slow_reader_gets_fresh_frames_and_the_count_of_the_others(client, groom):
    with client.open_head(groom, "realtime", rate_hz=120) as head, pushing(head):
        seen = take(head, 1)
        for _ in range(5):
            # Slow: reads again only after the server has made many frames.
            wait_until(lambda: head._selector._newest and head._selector._newest.index
                       >= seen[-1].index + 20)  # fmt: skip
            now = time.monotonic()
            wait_until(lambda: head._selector._newest.newest_pose_time_s > now)  # noqa: B023
            frame = head.newest()
            assert frame.skipped == frame.index - seen[-1].index - 1 >= 19
            assert frame.newest_pose_time_s > now
            seen.append(frame)


def test_a_client_that_does_not_acknowledge_is_sent_no_more(client, groom):
    request = stream.open_head(groom.name, "realtime", rate_hz=120, max_unacked_frames=3)
    talk: list = [animation_pb2.AnimateRequest(open=request)]
    with client.open_head(groom, "realtime", rate_hz=120) as clock:
        gate = threading.Semaphore(1)

        def requests():
            while True:
                gate.acquire()
                if not talk:
                    return
                yield talk.pop(0)

        answers = client._animation.Animate(requests(), timeout=DEADLINE_S)
        assert next(answers).WhichOneof("kind") == "opened"
        unread = [next(answers).frame for _ in range(3)]
        assert [f.index for f in unread] == [1, 2, 3]
        take(clock, 60)  # Meanwhile the server makes about as many frames of the first head.
        acknowledge = animation_pb2.Acknowledge()
        talk.append(animation_pb2.AnimateRequest(acknowledge=acknowledge, acked_frame=3))
        gate.release()
        answer = next(a for a in answers if a.WhichOneof("kind") == "frame").frame
        assert answer.skipped == answer.index - 4 > 0
        gate.release()
        answers.cancel()


def test_any_clock_will_do(client, groom):
    for origin in (-1e6, 0.0, 1.7e9):
        begin = time.monotonic()
        with client.open_head(groom, "realtime") as head:
            wanted = None
            deadline = begin + DEADLINE_S
            while wanted is None and time.monotonic() < deadline:
                now = time.monotonic() - begin
                head.push(mane.Pose(origin + now, (now, 0, 0)))
                frame = head.newest()
                # Frames from before the first pose arrives are of time 0, whatever the origin.
                if frame and origin + 0.3 < frame.time_s <= origin + now:
                    wanted = frame
                time.sleep(1 / 60)
        assert wanted is not None, f"no frame shows a pose after {origin}"
        # The head is where it was at the moment that the frame shows.
        shown = wanted.time_s - origin
        np.testing.assert_allclose(wanted.head_pose.position[0], shown, atol=0.02)


def test_reset_teleport_and_environment_go_along(client, groom):
    with client.open_head(groom, "realtime") as head:
        head.push(mane.Pose(0))
        head.set_environment(mane.Environment(wind_velocity=(30, 0, 0)))
        head.teleport(mane.Pose(0.1, (5, 0, 0)))
        frames = head.frames(DEADLINE_S)
        assert any(frame.head_pose.position[0] == 5 for frame in frames)
        blown = take(head, 60)[-1].positions[:, -1, 0].mean()
        head.set_environment(mane.Environment(wind_velocity=(-30, 0, 0)))
        assert take(head, 60)[-1].positions[:, -1, 0].mean() < blown
        head.reset()
        take(head, 2)


def test_no_poses_is_noticed(client, groom):
    with client.open_head(groom, "realtime", rate_hz=30) as head:
        wait_until(lambda: any(n.code == "no_poses" for n in head.notices))


def test_a_closed_head_ends_its_frames_and_refuses_poses(client, groom):
    with client.open_head(groom, "realtime") as head:
        frames = head.frames(DEADLINE_S)
        next(frames)
    assert list(frames) == []
    with pytest.raises(mane.FailedPrecondition, match="is closed"):
        head.push(mane.Pose(1))


def test_a_head_that_sends_nothing_is_told_from_a_closed_one(client, groom):
    with client.open_head(groom, "realtime", rate_hz=1) as head:
        take(head, 1)
        with pytest.raises(mane.DeadlineExceeded, match=r"sent no frame for 0\.01 s"):
            take_soon = head.frames(timeout_s=0.01)
            for _ in range(3):
                next(take_soon)


def test_a_broken_connection_is_mended_without_a_jump(client, groom, maned):
    with (
        BreakingProxy(maned.address) as proxy,
        mane.Client(proxy.address) as through,
        through.open_head(groom, "realtime") as head,
        pushing(head),
    ):
        last = take(head, 20)[-1]
        for breaks in (1, 2):
            assert proxy.cut() >= 1
            wait_until(lambda: head.resumptions == breaks)  # noqa: B023
            after = take(head, 20)
            assert after[0].index > last.index and after[0].time_s >= last.time_s
            # Without a jump: hair this long, on this head, moves slower than 3 m/s.
            for earlier, later in itertools.pairwise([last, *after]):
                moved = np.abs(later.positions - earlier.positions).max()
                assert moved <= 3 * (later.time_s - earlier.time_s) + 0.2
            last = after[-1]


def test_the_environment_outlives_a_broken_connection(client, groom, maned):
    with (
        BreakingProxy(maned.address) as proxy,
        mane.Client(proxy.address) as through,
        through.open_head(groom, "realtime") as head,
    ):
        head.set_environment(mane.Environment(gravity=(0, 30, 0)))
        proxy.cut()  # Whether or not the change has arrived.
        wait_until(lambda: head.resumptions == 1)
        tips = take(head, 120)[-1].positions[:, -1, 1]
    assert np.all(tips > client.rest_shape(groom).positions[:, -1, 1])


def test_asyncio_mends_a_broken_connection(groom, maned):
    async def run() -> list[mane.Frame]:
        frames = []
        async with (
            mane.aio.Client(proxy.address) as client,
            client.open_head(groom, "realtime") as head,
        ):
            head.set_environment(mane.Environment(wind_velocity=(5, 0, 0)))
            async for frame in head.frames(DEADLINE_S):
                head.push(pose_at(time.monotonic()))
                frames.append(frame)
                if len(frames) == 10:
                    assert proxy.cut() >= 1
                if head.resumptions == 1 and len(frames) >= 20:
                    return frames

    with BreakingProxy(maned.address) as proxy:
        frames = asyncio.run(asyncio.wait_for(run(), DEADLINE_S))
    indices = [frame.index for frame in frames]
    assert indices == sorted(set(indices))


def test_asyncio_realtime_head(client, groom, maned):
    async def run() -> list[mane.Frame]:
        frames = []
        async with mane.aio.Client(maned.address) as client:
            assert (await client.status()).serving
            async with client.open_head(groom, "realtime", format="generalized") as head:
                assert head.newest() is None or head.newest().index >= 1
                async for frame in head.frames(DEADLINE_S):
                    head.push(pose_at(time.monotonic()))
                    frames.append(frame)
                    if len(frames) == 30:
                        break
                head.reset()
                head.teleport(pose_at(time.monotonic()))
                assert head.newest().index >= frames[-1].index
        with pytest.raises(mane.FailedPrecondition, match="is closed"):
            head.push(mane.Pose(1e9))
        return frames

    frames = asyncio.run(asyncio.wait_for(run(), DEADLINE_S))
    for earlier, later in itertools.pairwise(frames):
        assert later.index == earlier.index + 1 + later.skipped


def test_asyncio_bad_pose_is_refused(groom, maned):
    async def run() -> None:
        async with (
            mane.aio.Client(maned.address) as client,
            client.open_head(groom, "realtime") as head,
        ):
            head.push(mane.Pose(1.0))
            head.push(mane.Pose(0.5))
            async for _ in head.frames(DEADLINE_S):
                pass

    with pytest.raises(mane.InvalidArgument, match=r"pose\.time_s"):
        asyncio.run(asyncio.wait_for(run(), DEADLINE_S))


def test_eight_realtime_heads_at_once(client, groom, maned):
    heads = [client.open_head(groom, "realtime") for _ in range(8)]
    with contextlib.ExitStack() as stack:
        for head in heads:
            stack.enter_context(head)
            stack.enter_context(pushing(head))
        for head in heads:
            frames = take(head, 30)
            assert all(frame.repaired_guides == 0 for frame in frames)
    assert len({head.name for head in heads}) == 8


def test_a_server_that_is_gone_is_reported_after_the_grace(tmp_path):
    daemon = start_daemon(tmp_path, "--resume-grace-s", "1")
    try:
        with mane.Client(daemon.address) as client:
            groom = client.create_groom(make_guides(1))
            head = client.open_head(groom, "realtime")
            take(head, 2)
            daemon.process.kill()
            with pytest.raises(mane.Unavailable, match=daemon.address):
                for _ in head.frames(DEADLINE_S):
                    pass
            with pytest.raises(mane.Unavailable):
                head.push(mane.Pose(0))
            head.close()  # Has been told already.
    finally:
        daemon.process.kill()
        daemon.process.wait()


def test_a_server_that_stops_tells_its_heads_and_ends_cleanly(tmp_path):
    daemon = start_daemon(tmp_path, "--resume-grace-s", "1", "--drain-grace-s", "1")
    with mane.Client(daemon.address) as client:
        groom = client.create_groom(make_guides(1))
        head = client.open_head(groom, "realtime")
        take(head, 2)
        assert stop_daemon(daemon) == 0
        with pytest.raises((mane.Unavailable, mane.NotFound)):
            for _ in head.frames(DEADLINE_S):
                pass
        assert any(notice.code == "draining" for notice in head.notices)
        head.close()


def test_request_ids_replace_a_lost_first_try(client, groom):
    request = stream.open_head(groom.name, "realtime")
    opening = animation_pb2.AnimateRequest(open=request)

    def call():
        done = threading.Event()

        def requests():
            yield opening
            done.wait(DEADLINE_S)

        return client._animation.Animate(requests(), timeout=DEADLINE_S), done

    first, first_done = call()
    assert next(first).WhichOneof("kind") == "opened"
    second, second_done = call()  # only now: two calls under way may arrive in any order
    assert next(second).WhichOneof("kind") == "opened"
    with pytest.raises(mane.Error):
        for _ in client._stream(first):
            pass
    first_done.set()
    second_done.set()
    second.cancel()
    assert messages.request_id() != messages.request_id()
