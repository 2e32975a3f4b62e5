"""Parts of a head's stream that need no server: acknowledgements, the newest frame, the outbox."""

from __future__ import annotations

import threading

import numpy as np
import pytest

import mane
from mane import beams, messages, stream
from mane.outbox import Feed, Outbox
from mane.v1 import animation_pb2

Request = animation_pb2.AnimateRequest


def frame(index: int) -> mane.Frame:
    return mane.Frame(index, 0.0, mane.Pose(), np.zeros((1, 2, 3), np.float32))


def pose(time_s: float) -> Request:
    return Request(pose=messages.head_pose(mane.Pose(time_s)))


RESET = Request(reset=animation_pb2.ResetHead())
OPEN = Request(open=animation_pb2.OpenHead(groom="grooms/x"))


@pytest.mark.parametrize(("window", "due_after"), [(1, 1), (2, 1), (3, 2), (4, 2), (5, 3), (16, 8)])
def test_acknowledgement_is_due_at_half_the_window(window, due_after):
    acknowledger = stream.Acknowledger(window)
    for start in (0, 100):  # The second time after a message has carried the first ones.
        due = [acknowledger.received(start + k) for k in range(1, due_after + 1)]
        assert due == [False] * (due_after - 1) + [True]
        assert acknowledger.stamp(Request()).acked_frame == start + due_after
        acknowledger.received(start + 100)
        acknowledger.stamp(Request())


def test_every_message_carries_the_last_frame_received():
    acknowledger = stream.Acknowledger(16)
    assert acknowledger.stamp(pose(0)).acked_frame == 0
    acknowledger.received(7)
    assert acknowledger.stamp(pose(1)).acked_frame == 7


def test_newest_frame_wins_and_the_others_are_counted():
    selector = stream.FrameSelector(next_index=1)
    assert selector.take() is None
    selector.offer(frame(1))
    assert selector.fresh and selector.take().skipped == 0
    assert not selector.fresh and selector.take().index == 1
    for index in (2, 3, 5):
        selector.offer(frame(index))
    taken = selector.take()
    assert (taken.index, taken.skipped) == (5, 3)


def test_skipped_frames_are_counted_from_the_head_s_next_one():
    selector = stream.FrameSelector(next_index=40)
    selector.offer(frame(42))
    assert selector.take().skipped == 2


def test_environment_changes_add_up_and_vectors_are_replaced_whole():
    memory = stream.EnvironmentMemory()
    assert memory.request() is None
    for change in (
        mane.Environment(wind_velocity=(1, 2, 3), air_drag_scale=2.0),
        mane.Environment(wind_velocity=(0, 0, 5)),
        mane.Environment(internal_friction_scale=0.0),
    ):
        memory.add(messages.environment(change))
    expected = mane.Environment(
        wind_velocity=(0, 0, 5), air_drag_scale=2.0, internal_friction_scale=0.0
    )
    assert memory.request().environment == messages.environment(expected)


def test_outbox_keeps_only_the_newest_of_many_waiting_poses():
    outbox = Outbox(pose_limit=4)
    for k in range(100):
        outbox.put(pose(k))
    assert [m.pose.time_s for m in outbox.messages] == [0, 1, 2, 99]


def test_outbox_never_drops_other_messages_nor_reorders():
    outbox = Outbox(pose_limit=1)
    for message in (pose(0), pose(1), RESET, pose(2), pose(3)):
        outbox.put(message)
    kinds = [m.WhichOneof("kind") for m in outbox.messages]
    assert kinds == ["pose", "reset", "pose"]
    assert [m.pose.time_s for m in outbox.messages] == [1, 0, 3]


def test_outbox_without_a_limit_keeps_all():
    outbox = Outbox()
    for k in range(100):
        outbox.put(pose(k))
    assert len(outbox.messages) == 100


def test_closed_feed_sends_what_waits_and_ends():
    outbox = Outbox()
    feed = Feed(outbox, OPEN)
    outbox.put(pose(1))
    feed.close()
    assert [m.WhichOneof("kind") for m in feed] == ["open", "pose"]


def test_abandoned_feed_leaves_what_waits_to_the_next_one():
    outbox = Outbox()
    first = Feed(outbox, OPEN)
    assert next(first) == OPEN
    outbox.put(pose(1))
    first.abandon()
    assert list(first) == []
    second = Feed(outbox, OPEN)
    second.close()
    assert len(list(second)) == 2


def test_feed_that_waits_wakes_up_for_a_message_and_for_its_end():
    outbox = Outbox()
    feed = Feed(outbox, OPEN)
    received = []
    reader = threading.Thread(target=lambda: received.extend(feed))
    reader.start()
    outbox.put(pose(1))
    feed.close()
    reader.join(10)
    assert not reader.is_alive() and len(received) == 2


def test_feed_stamps_each_message_when_it_goes():
    numbers = iter(range(10))

    def stamp(request):
        request.acked_frame = next(numbers)
        return request

    outbox = Outbox(stamp=stamp)
    feed = Feed(outbox, Request(open=OPEN.open))
    outbox.put(pose(1))
    feed.close()
    assert [m.acked_frame for m in feed] == [0, 1]


def test_a_message_put_first_overtakes_what_waits():
    outbox = Outbox()
    outbox.put(pose(1))
    outbox.put_first(RESET)
    feed = Feed(outbox, OPEN)
    feed.close()
    assert [m.WhichOneof("kind") for m in feed] == ["open", "reset", "pose"]


@pytest.mark.parametrize(
    ("options", "field"),
    [
        ({"pacing": "slow"}, "pacing"),
        ({"pacing": "lockstep", "format": "json"}, "format"),
        ({"pacing": "lockstep", "space": "moon"}, "space"),
    ],
)
def test_unknown_choices_are_refused_with_the_known_ones(options, field):
    with pytest.raises(mane.InvalidArgument, match=f"{field}: is '.*', must be one of "):
        stream.open_head("grooms/x", **options)


def test_the_last_model_is_repeated_with_the_last_beams():
    memory = stream.ModelMemory()
    assert memory.request() is None
    memory.add(beams.set_model("beam", mane.BeamMotion(segments=9)))
    memory.add(beams.set_model("super_helix", None))
    repeated = memory.request().model
    assert repeated.model == animation_pb2.ANIMATION_MODEL_SUPER_HELIX
    assert repeated.beam.segments == 9
