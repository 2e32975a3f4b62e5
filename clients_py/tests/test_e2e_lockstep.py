"""Heads in LOCKSTEP on a real daemon: one frame for each pose, the same bits every time."""

from __future__ import annotations

import asyncio
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import mane
import mane.aio
from conftest import make_guides, shake


def play(client: mane.Client, groom, motion: mane.Motion, **options) -> list[mane.Frame]:
    with client.open_head(groom, "lockstep", **options) as head:
        return list(head.play(motion))


def stacked(frames) -> np.ndarray:
    return np.stack([frame.positions for frame in frames])


def in_head_frame(frame: mane.Frame) -> np.ndarray:
    pose = frame.head_pose
    relative = frame.positions.astype(np.float64) - pose.position
    return relative @ Rotation.from_quat(pose.orientation).as_matrix()


def test_wind_gusts_and_eddies_by_its_seed(client, groom):
    def blown(**variation) -> np.ndarray:
        wind = mane.Environment(wind_velocity=(3, 0, 0), **variation)
        return stacked(play(client, groom, shake(), environment=wind))

    calm = blown()
    eddies = {"turbulence_speed": 3, "turbulence_size_m": 0.1, "wind_seed": 5}
    assert np.abs(blown(**eddies) - calm).max() > 1e-4
    np.testing.assert_array_equal(blown(**eddies), blown(**eddies))
    assert np.abs(blown(**eddies | {"wind_seed": 6}) - blown(**eddies)).max() > 1e-5
    assert np.abs(blown(gust_strength=0.5, gust_period_s=0.2) - calm).max() > 1e-4
    with pytest.raises(mane.InvalidArgument, match="turbulence_size_m"):
        blown(turbulence_size_m=0)


def test_diagnostics_come_where_they_are_asked_for(client, groom):
    silent = play(client, groom, shake())
    assert all(frame.diagnostics is None for frame in silent)
    frames = play(client, groom, shake(), diagnostics=True)
    np.testing.assert_array_equal(stacked(frames), stacked(silent))
    first, last = frames[0].diagnostics, frames[-1].diagnostics
    assert first.kinetic_energy_j == 0 and first.imbalance < 1e-3
    assert last.kinetic_energy_j > 0 and last.imbalance > first.imbalance
    assert last.largest_angle_rad > 0


def test_every_pose_yields_its_frame(client, groom):
    motion = shake()
    frames = play(client, groom, motion, points_per_guide=7)
    assert [f.index for f in frames] == list(range(1, len(motion) + 1))
    assert [f.time_s for f in frames] == motion.times_s.tolist()
    for frame, pose in zip(frames, motion.poses(), strict=True):
        np.testing.assert_allclose(frame.head_pose.position, pose.position, atol=1e-12)
        turned = abs(frame.head_pose.orientation @ pose.orientation)
        assert turned == pytest.approx(1, abs=1e-12)
        assert frame.positions.shape == (5, 7, 3) and frame.positions.dtype == np.float32
        assert frame.skipped == 0 and frame.repaired_guides == 0
        assert np.isfinite(frame.positions).all()


def test_replay_is_the_same_bit_for_bit_however_it_is_sent(client, groom):
    motion = shake()
    first = stacked(play(client, groom, motion))
    np.testing.assert_array_equal(stacked(play(client, groom, motion)), first)
    with client.open_head(groom, "lockstep") as head:
        stepped = [head.step(pose) for pose in motion.poses()]
    np.testing.assert_array_equal(stacked(stepped), first)
    assert np.ptp(first[:, :, -1], axis=0).max() > 0.01  # The hair did move.


def test_formats_and_spaces_show_the_same_hair(client, groom):
    motion = shake(0.3)
    exact = play(client, groom, motion)
    for format in mane.FrameFormat:
        for space in mane.Space:
            frames = play(client, groom, motion, format=format, space=space)
            for frame, reference in zip(frames, exact, strict=True):
                wanted = reference.positions if space == "world" else in_head_frame(reference)
                rounding = 4e-7  # Float32 positions and angles of strands of 0.2 m.
                if format == "quantized16":
                    box = np.ptp(wanted, axis=1, keepdims=True)
                    assert np.all(np.abs(frame.positions - wanted) <= box / 131070 + rounding)
                else:
                    np.testing.assert_allclose(frame.positions, wanted, atol=rounding)
                assert (frame.angles is not None) == (format == "generalized")


def test_roots_are_clamped_and_strands_keep_their_length(client, groom):
    guides = client.export_groom(groom).guides
    roots = np.array([g.root_position for g in guides])
    frames = play(client, groom, shake(), points_per_guide=50)
    steps = np.array([g.length_m for g in guides])[:, None] / 49
    for frame in frames:
        turn = Rotation.from_quat(frame.head_pose.orientation)
        clamped = turn.apply(roots) + frame.head_pose.position
        np.testing.assert_allclose(frame.positions[:, 0], clamped, atol=1e-6)
        chords = np.linalg.norm(np.diff(frame.positions, axis=1), axis=2)
        assert np.all(chords <= steps + 1e-6)


def test_hair_starts_at_rest(client, groom):
    pose = mane.Pose(0, (1, 2, 3))
    rest = client.rest_shape(groom, points_per_guide=16).positions
    with client.open_head(groom, "lockstep", initial_pose=pose) as head:
        first = head.step(pose)
        np.testing.assert_allclose(first.positions, rest + pose.position, atol=1e-5)
        later = [head.step(mane.Pose(k / 60, pose.position)) for k in range(1, 30)]
    np.testing.assert_allclose(later[-1].positions, first.positions, atol=1e-4)


def test_teleport_moves_hair_with_the_head(client, groom):
    with client.open_head(groom, "lockstep") as head:
        before = list(head.play(shake(0.4)))[-1]
        there = mane.Pose(0.5, (10, 0, -5), Rotation.from_rotvec([0, 2, 0]).as_quat())
        after = head.teleport(there)
    assert after.index == before.index + 1 and after.time_s == 0.5
    np.testing.assert_allclose(in_head_frame(after), in_head_frame(before), atol=2e-6)


def test_reset_puts_hair_to_rest(client, groom):
    rest = client.rest_shape(groom).positions
    with client.open_head(groom, "lockstep") as head:
        shaken = list(head.play(shake(0.4)))[-1]
        assert np.abs(in_head_frame(shaken) - rest).max() > 1e-3
        head.reset()
        frame = head.teleport(mane.Pose(0.5))
    np.testing.assert_allclose(frame.positions, rest, atol=1e-5)


def test_wind_and_gravity_push_the_hair(client, groom):
    still = [mane.Pose(k / 60) for k in range(60)]

    def middles(environment) -> np.ndarray:
        with client.open_head(groom, "lockstep") as head:
            head.step(mane.Pose(-1 / 60))
            head.set_environment(environment)
            return list(head.play(still))[-1].positions.mean(axis=1)

    calm = middles(mane.Environment())
    blown = middles(mane.Environment(wind_velocity=(20, 0, 0)))
    assert np.all(blown[:, 0] > calm[:, 0])
    lifted = middles(mane.Environment(gravity=(0, 9.81, 0)))
    assert np.all(lifted[:, 1] > calm[:, 1])


def test_leaving_a_motion_early_does_not_disturb_what_follows(client, groom):
    motion = shake(0.5)
    full = play(client, groom, motion)
    with client.open_head(groom, "lockstep") as head:
        for frame in head.play(motion, in_flight=6):
            if frame.index == 10:
                break
        sent = list(motion.poses())[: head._last_index]
        after = head.step(mane.Pose(1.0))
    assert after.index == len(sent) + 1 and after.time_s == 1.0
    np.testing.assert_array_equal(frame.positions, full[9].positions)


def test_a_closed_head_refuses_poses(client, groom):
    with client.open_head(groom, "lockstep") as head:
        head.step(mane.Pose(0))
    head.close()
    with pytest.raises(mane.FailedPrecondition, match="is closed"):
        head.step(mane.Pose(1))


def test_eight_heads_at_once_give_what_each_gives_alone(client, maned):
    grooms = [client.create_groom(make_guides(4, seed=k)) for k in range(8)]
    motions = [shake(0.5).shifted(world=(k, 0, 0)) for k in range(8)]
    alone = [stacked(play(client, *pair)) for pair in zip(grooms, motions, strict=True)]

    def own_client(pair) -> np.ndarray:
        with mane.Client(maned.address) as own:
            return stacked(play(own, *pair))

    with ThreadPoolExecutor(8) as threads:
        together = list(threads.map(own_client, zip(grooms, motions, strict=True)))
    for one, other in zip(alone, together, strict=True):
        np.testing.assert_array_equal(one, other)

    async def play_async(client, groom, motion) -> np.ndarray:
        async with client.open_head(groom, "lockstep") as head:
            return stacked([frame async for frame in head.play(motion)])

    async def all_at_once():
        async with mane.aio.Client(maned.address) as client:
            pairs = zip(grooms, motions, strict=True)
            return await asyncio.gather(*(play_async(client, *pair) for pair in pairs))

    for one, other in zip(alone, asyncio.run(all_at_once()), strict=True):
        np.testing.assert_array_equal(one, other)
    for groom in grooms:
        client.delete_groom(groom)


def test_deleting_a_groom_leaves_its_heads_alone(client):
    groom = client.create_groom(make_guides(2))
    with client.open_head(groom, "lockstep") as head:
        head.step(mane.Pose(0))
        client.delete_groom(groom)
        assert head.step(mane.Pose(1 / 60)).index == 2
