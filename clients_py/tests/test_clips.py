"""The motion clips that the package ships."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from mane import clips
from mane.errors import InvalidArgument

TOOL = Path(__file__).parents[1] / "tools" / "make_motions.py"


def angles(motion):
    """Yaw, pitch, roll, (k, 3) [deg]."""
    return Rotation.from_quat(motion.orientations).as_euler("YXZ", degrees=True)


def spin(motion):
    """Angular speed between poses, (k - 1,) [rad/s]."""
    rotation = Rotation.from_quat(motion.orientations)
    return (rotation[1:] * rotation[:-1].inv()).magnitude() / np.diff(motion.times_s)


@pytest.mark.parametrize("name", clips.NAMES)
def test_a_clip_has_60_poses_a_second_for_4_to_6_seconds(name):
    motion = clips.load(name)
    np.testing.assert_allclose(np.diff(motion.times_s), 1 / 60, atol=1e-8)
    assert motion.times_s[0] == 0
    assert 4 <= motion.duration_s <= 6


@pytest.mark.parametrize("name", clips.NAMES)
def test_a_clip_begins_and_ends_upright_and_at_rest(name):
    motion = clips.load(name)
    np.testing.assert_allclose(motion.positions[0], 0, atol=1e-9)
    np.testing.assert_allclose(motion.orientations[[0, -1]], [[0, 0, 0, 1]] * 2, atol=1e-9)
    speed = np.linalg.norm(np.diff(motion.positions, axis=0), axis=1) * 60
    assert max(speed[0], speed[-1]) < 2e-3
    assert max(spin(motion)[[0, -1]]) < 2e-3


@pytest.mark.parametrize("name", clips.NAMES)
def test_a_clip_is_smooth(name):
    """No jump in the acceleration: its change within a frame is a small part of its range."""
    motion = clips.load(name)
    vectors = np.hstack([motion.positions, motion.orientations])
    acceleration = np.diff(vectors, 2, axis=0) * 60**2
    jumps = np.abs(np.diff(acceleration, axis=0)).max(axis=0)
    assert (jumps <= 0.35 * np.ptp(acceleration, axis=0) + 1e-4).all()


def test_nod_pitches_and_nothing_else():
    yaw, pitch, roll = angles(clips.load("nod")).T
    assert 17 < pitch.max() < 20.1 and -20.1 < pitch.min() < -17
    np.testing.assert_allclose([yaw, roll], 0, atol=1e-6)


def test_shake_yaws_up_to_2_hz_and_nothing_else():
    motion = clips.load("shake")
    yaw, pitch, roll = angles(motion).T
    assert 33 < yaw.max() < 35.1 and -35.1 < yaw.min() < -33
    np.testing.assert_allclose([pitch, roll], 0, atol=1e-6)
    assert spin(motion).max() == pytest.approx(2 * np.pi * 2 * np.radians(35), rel=0.03)


@pytest.mark.parametrize(
    ("name", "speed", "bob", "sway"), [("walk", 1.4, 0.022, 0.020), ("run", 3.0, 0.045, 0.015)]
)
def test_gaits_go_forward_at_their_speed_with_bob_and_sway(name, speed, bob, sway):
    motion = clips.load(name)
    middle = slice(90, -90)
    x, y, z = motion.positions.T
    mean_speed = (z[middle][-1] - z[middle][0]) / np.ptp(motion.times_s[middle])
    assert mean_speed == pytest.approx(speed, rel=0.02)
    assert np.ptp(y[middle]) / 2 == pytest.approx(bob, rel=0.05)
    assert np.ptp(x[middle]) / 2 == pytest.approx(sway, rel=0.1)
    assert np.abs(angles(motion)).max() < 12


def test_turn_goes_90_degrees_within_0_4_seconds_and_back():
    motion = clips.load("turn")
    yaw = angles(motion)[:, 0]
    assert yaw.max() == pytest.approx(90, abs=1e-4)
    moving = np.abs(np.diff(yaw)) > 1e-6
    begin, end = (
        np.flatnonzero(np.diff(moving.astype(int)) == 1),
        np.flatnonzero(np.diff(moving.astype(int)) == -1),
    )
    assert len(begin) == len(end) == 2
    np.testing.assert_allclose((end - begin) / 60, 0.4, atol=0.04)


@pytest.mark.parametrize("name", clips.NAMES)
def test_the_script_makes_the_shipped_clips(name):
    spec = importlib.util.spec_from_file_location("make_motions", TOOL)
    tool = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(tool)
    assert sorted(tool.CLIPS) == list(clips.NAMES)
    made, shipped = tool.CLIPS[name](), clips.load(name)
    for field in ("times_s", "positions", "orientations"):
        np.testing.assert_allclose(getattr(made, field), getattr(shipped, field), atol=2e-8)


def test_an_unknown_clip_names_the_known_ones():
    with pytest.raises(InvalidArgument, match=r"'dance'.*nod, run, shake, turn, walk"):
        clips.load("dance")
