"""Bad input to heads and jobs: named field, value and range; nobody else is disturbed."""

from __future__ import annotations

import threading

import numpy as np
import pytest

import mane
from conftest import make_guide, shake
from mane import stream
from mane.v1 import animation_pb2


@pytest.fixture
def neighbour(client, groom):
    """A head that must go on, with the same bits, whatever happens to others."""
    poses = list(shake(0.5).poses())
    with client.open_head(groom, "lockstep") as head:
        undisturbed = [head.step(pose).positions for pose in poses]
    with client.open_head(groom, "lockstep") as head:
        before = [head.step(pose).positions for pose in poses[:15]]
        yield
        after = [head.step(pose).positions for pose in poses[15:]]
    np.testing.assert_array_equal(before + after, undisturbed)


def violated(error: mane.Error) -> str:
    return error.field_violations[0].field


BAD_POSES = [
    (mane.Pose(1.0, (np.nan, 0, 0)), "pose.pose.position.x", "nan"),
    (mane.Pose(1.0, (0, np.inf, 0)), "pose.pose.position.y", "inf"),
    (mane.Pose(1.0, (0, 0, 2e6)), "pose.pose.position.z", "2000000"),
    (mane.Pose(1.0, orientation=(0, 0, 0, 1.1)), "pose.pose.orientation", "1.1"),
    (mane.Pose(1.0, orientation=(0, 0, 0, 0)), "pose.pose.orientation", "0"),
    (mane.Pose(1.0, orientation=(0, np.nan, 0, 1)), "pose.pose.orientation", "nan"),
    (mane.Pose(np.nan), "pose.time_s", "nan"),
    (mane.Pose(0.5), "pose.time_s", "0.5"),  # The same time again.
    (mane.Pose(0.25), "pose.time_s", "0.25"),  # Back.
]


@pytest.mark.parametrize(("pose", "field", "value"), BAD_POSES)
def test_bad_pose_ends_a_lockstep_head(client, groom, neighbour, pose, field, value):
    with client.open_head(groom, "lockstep") as head:
        head.step(mane.Pose(0.5))
        with pytest.raises(mane.InvalidArgument) as caught:
            head.step(pose)
        assert violated(caught.value) == field and value in str(caught.value)
        with pytest.raises(mane.InvalidArgument):  # And says so again.
            head.step(mane.Pose(2.0))


@pytest.mark.parametrize(("pose", "field", "value"), BAD_POSES)
def test_bad_pose_ends_a_realtime_head(client, groom, neighbour, pose, field, value):
    with client.open_head(groom, "realtime") as head:
        head.push(mane.Pose(0.5))
        head.push(pose)
        with pytest.raises(mane.InvalidArgument) as caught:
            for _ in head.frames():
                pass
        assert violated(caught.value) == field and value in str(caught.value)
        assert head.resumptions == 0


def test_a_quaternion_within_one_percent_is_normalised(client, groom):
    with client.open_head(groom, "lockstep") as head:
        frame = head.step(mane.Pose(0, orientation=(0, 0, 0.006, 1.005)))
    assert np.linalg.norm(frame.head_pose.orientation) == pytest.approx(1, abs=1e-12)


@pytest.mark.parametrize(
    ("environment", "field"),
    [
        (mane.Environment(wind_velocity=(101, 0, 0)), "environment.wind_velocity.x"),
        (mane.Environment(gravity=(0, np.nan, 0)), "environment.gravity.y"),
        (mane.Environment(air_drag_scale=-1), "environment.air_drag_scale"),
        (mane.Environment(detail_tolerance_m=11), "environment.detail_tolerance_m"),
        (mane.Environment(internal_friction_scale=1001), "environment.internal_friction_scale"),
    ],
)
def test_bad_environment_is_refused(client, groom, neighbour, environment, field):
    with client.open_head(groom, "lockstep") as head:
        head.set_environment(environment)
        with pytest.raises(mane.InvalidArgument) as caught:
            head.step(mane.Pose(0))
        assert violated(caught.value) == field
    with pytest.raises(mane.InvalidArgument, match=field):
        client.open_head(groom, "lockstep", environment=environment)


@pytest.mark.parametrize(
    ("options", "field"),
    [
        ({"points_per_guide": 1}, "open.points_per_guide"),
        ({"points_per_guide": 257}, "open.points_per_guide"),
        ({"substeps": 65}, "open.substeps"),
        ({"rate_hz": 1000}, "open.rate_hz"),
        ({"rate_hz": np.nan}, "open.rate_hz"),
        ({"pose_delay_s": 0.5}, "open.pose_delay_s"),
        ({"max_unacked_frames": 17}, "open.max_unacked_frames"),
        ({"initial_pose": mane.Pose(0, (np.inf, 0, 0))}, "open.initial_pose.position.x"),
    ],
)
def test_bad_options_are_refused(client, groom, neighbour, options, field):
    with pytest.raises(mane.InvalidArgument) as caught:
        client.open_head(groom, "realtime", **options)
    assert violated(caught.value) == field


@pytest.mark.parametrize("pacing", list(mane.Pacing))
@pytest.mark.parametrize("format", list(mane.FrameFormat))
def test_unknown_groom_is_not_found(client, pacing, format):
    with pytest.raises(mane.NotFound, match="grooms/nobody"):
        client.open_head("nobody", pacing, format=format)


@pytest.mark.parametrize("name", ["", "grooms/", "grooms/a/b", "grooms/UPPER", "../etc/passwd"])
def test_names_that_cannot_be_are_refused(client, name):
    with pytest.raises((mane.InvalidArgument, mane.NotFound)):
        client.get_groom(name)


def test_messages_out_of_order_are_refused(client, groom, neighbour):
    pose = animation_pb2.AnimateRequest(pose=animation_pb2.HeadPose())
    with pytest.raises(mane.InvalidArgument, match="first message must be open"):
        list(client._stream(client._animation.Animate(iter([pose]))))
    message = animation_pb2.OpenHead(groom=groom.name, pacing=animation_pb2.PACING_LOCKSTEP)
    twice = [animation_pb2.AnimateRequest(open=message)] * 2
    with pytest.raises(mane.InvalidArgument, match="open was sent twice"):
        list(client._stream(client._animation.Animate(iter(twice))))
    empty = [twice[0], animation_pb2.AnimateRequest()]
    with pytest.raises(mane.InvalidArgument, match="neither a pose nor any other kind"):
        list(client._stream(client._animation.Animate(iter(empty))))


def test_a_message_over_the_limit_is_refused(client, neighbour):
    guide = make_guide(element_count=256, natural_twist=np.zeros(200_000))
    with pytest.raises((mane.ResourceExhausted, mane.InvalidArgument)):
        client.create_groom([guide])


def test_a_client_that_vanishes_is_forgotten(client, groom, neighbour):
    for pacing in mane.Pacing:
        opening = animation_pb2.AnimateRequest(open=stream.open_head(groom.name, pacing))
        gone = threading.Event()

        def requests(opening=opening, gone=gone):
            yield opening
            gone.wait(30)

        call = client._animation.Animate(requests())
        assert next(call).WhichOneof("kind") == "opened"
        call.cancel()
        gone.set()
    assert client.status().serving


@pytest.mark.parametrize("pacing", list(mane.Pacing))
def test_a_client_closed_before_its_head_ends_it(groom, maned, pacing):
    with mane.Client(maned.address) as client:
        head = client.open_head(groom, pacing)
    with pytest.raises(mane.Error):
        for k in range(10_000):
            head.step(mane.Pose(k)) if pacing == "lockstep" else next(head.frames())
    head.close()


def test_bad_bakes_are_refused(client, groom, neighbour):
    with pytest.raises(mane.NotFound, match="grooms/nobody"):
        client.bake("nobody", shake(0.1))
    long = mane.Motion(np.arange(16_001) / 60)
    with pytest.raises((mane.InvalidArgument, mane.ResourceExhausted), match="16001"):
        client.bake(groom, long)
    with pytest.raises(mane.InvalidArgument, match="points_per_guide"):
        client.bake(groom, shake(0.1), points_per_guide=300)
    for ask in (client.get_job, client.cancel_job, client.delete_job):
        with pytest.raises(mane.NotFound, match="nothing"):
            ask("nothing")
    with pytest.raises(mane.NotFound, match="nothing"):
        list(client.watch_job("nothing"))
