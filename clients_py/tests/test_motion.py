"""Head motion: forward kinematics of BVH files, CSV files, resampling, refusal of bad input."""

from __future__ import annotations

import re

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import mane
from mane.motion import read_bvh, read_csv, write_csv

# A hip with legs 8 long and a neck 3 above it, a head 1 above that, its top 2 higher, so 14 from
# the foot to the top. Channels are declared in an order of their own in each joint.
BVH = """HIERARCHY
ROOT Hips
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Yrotation Zrotation Xrotation
  JOINT Leg
  {
    OFFSET 0.5 0 0
    CHANNELS 3 Zrotation Xrotation Yrotation
    End Site
    {
      OFFSET 0 -8 0
    }
  }
  JOINT Neck
  {
    OFFSET 0 3 0
    CHANNELS 3 Xrotation Yrotation Zrotation
    JOINT Head
    {
      OFFSET 0 1 0
      CHANNELS 2 Zrotation Yrotation
      End Site
      {
        OFFSET 0 2 0
      }
    }
  }
}
MOTION
Frames: 2
Frame Time: 0.025
1 8 2  0 0 0   0 0 0   0 0 0   0 0
1 8 2  90 0 0  0 0 0   90 0 0  0 90
"""


def write(tmp_path, text: str, name: str = "clip.bvh"):
    path = tmp_path / name
    path.write_text(text)
    return path


def random_motion(count: int = 50, seed: int = 3) -> mane.Motion:
    rng = np.random.default_rng(seed)
    times = np.cumsum(rng.uniform(0.005, 0.02, count))
    return mane.Motion(times, rng.normal(size=(count, 3)), Rotation.random(count, rng).as_quat())


def about(axis: int, degrees: float) -> np.ndarray:
    """A rotation matrix about a coordinate axis, written out: independent of the code tested."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrix = np.eye(3)
    matrix[i, i] = matrix[j, j] = c
    matrix[i, j], matrix[j, i] = -s, s
    return matrix


def test_bodies_move_along_with_the_motion():
    hand = random_motion()
    rng = np.random.default_rng(5)
    motion = mane.Motion(hand.times_s, rng.normal(size=(len(hand), 3)), bodies={"hand": hand})
    for k, pose in enumerate(motion.poses()):
        np.testing.assert_array_equal(pose.bodies["hand"].position, hand.positions[k])
        np.testing.assert_array_equal(pose.bodies["hand"].orientation, hand.orientations[k])
    again = motion.resampled(30).bodies["hand"]
    np.testing.assert_array_equal(again.positions, hand.resampled(30).positions)
    moved = motion.shifted(time_s=2, world=(1, 2, 3), head=(0, 5, 0)).bodies["hand"]
    np.testing.assert_allclose(moved.positions, hand.positions + (1, 2, 3))
    np.testing.assert_allclose(moved.times_s, hand.times_s + 2)


def test_bodies_of_other_times_are_refused():
    with pytest.raises(mane.InvalidArgument, match="hand"):
        mane.Motion([0.0, 1.0], bodies={"hand": mane.Motion([0.0, 1.5])})


def test_bvh_rest_pose_is_upright_and_scaled_to_the_height(tmp_path):
    motion = read_bvh(write(tmp_path, BVH), height_m=1.4)
    np.testing.assert_allclose(motion.positions[0], [0.1, 1.2, 0.2], atol=1e-15)
    np.testing.assert_allclose(motion.orientations[0], [0, 0, 0, 1], atol=1e-15)
    np.testing.assert_allclose(motion.times_s, [0, 0.025])


def test_bvh_forward_kinematics_by_hand(tmp_path):
    # Hips turn 90 degrees about Y; the neck then 90 about its X, which points to the world's -Z:
    # the neck's Y points along the hips' Z, the world's X. So the head is 3 up and 1 along X.
    motion = read_bvh(write(tmp_path, BVH), unit_m=1.0)
    np.testing.assert_allclose(motion.positions[1], [1 + 1, 8 + 3, 2], atol=1e-14)
    np.testing.assert_allclose(
        Rotation.from_quat(motion.orientations[1]).as_matrix(),
        about(1, 90) @ about(0, 90) @ about(1, 90),
        atol=1e-14,
    )


def test_bvh_channels_multiply_in_the_declared_order(tmp_path):
    angles = (31.0, -47.0, 113.0)
    text = BVH.replace("Frames: 2", "Frames: 1").replace("1 8 2  0 0 0   0 0 0   0 0 0   0 0\n", "")
    row = "0 0 0  {} {} {}  0 0 0  0 0 0  0 0".format(*angles)
    text = text.replace("1 8 2  90 0 0  0 0 0   90 0 0  0 90", row)
    motion = read_bvh(write(tmp_path, text), unit_m=1.0)
    expected = about(1, angles[0]) @ about(2, angles[1]) @ about(0, angles[2])
    matrix = Rotation.from_quat(motion.orientations[0]).as_matrix()
    np.testing.assert_allclose(matrix, expected, atol=1e-14)


def test_bvh_standing_height_is_that_of_a_figure_with_spread_legs_in_the_rest_pose(tmp_path):
    # Rest legs slant; both frames turn them upright again about Z.
    text = BVH.replace("OFFSET 0 -8 0", "OFFSET 4.8 -6.4 0")
    text = re.sub(r"(?m)^1 8 2 .*$", "1 8 2  0 0 0  -36.86989764584402 0 0  0 0 0  0 0", text)
    motion = read_bvh(write(tmp_path, text), height_m=1.4)
    np.testing.assert_allclose(motion.positions[0], [0.1, 1.2, 0.2], atol=1e-12)


def test_bvh_leading_t_pose_is_left_out_and_taken_as_upright(tmp_path):
    rows = ["5 8 2  0 0 0  0 0 0  20 0 0  0 0"]
    rows += [f"{0.01 * k} 8 2  0 0 0  0 0 0  {20 + k} 0 0  0 0" for k in range(4)]
    text = BVH[: BVH.index("1 8 2")].replace("Frames: 2", "Frames: 5") + "\n".join(rows)
    path = write(tmp_path, text)
    motion = read_bvh(path, unit_m=1.0)
    assert len(motion) == 4 and motion.times_s[0] == 0
    turned = Rotation.from_quat(motion.orientations).as_rotvec(degrees=True)
    np.testing.assert_allclose(turned, [[k, 0, 0] for k in range(4)], atol=1e-12)
    assert len(read_bvh(path, t_pose=False)) == 5


def test_bvh_in_z_up_axes_gives_the_same_motion(tmp_path):
    # The same clip in axes where (x, y, z) here are (y, z, x) there: left +y, up +z, forward +x.
    swap = {"X": "Y", "Y": "Z", "Z": "X"}
    text = re.sub(r"([XYZ])(position|rotation)", lambda m: swap[m[1]] + m[2], BVH)
    text = re.sub(r"OFFSET (\S+) (\S+) (\S+)", r"OFFSET \3 \1 \2", text)
    plain = read_bvh(write(tmp_path, BVH), unit_m=1.0)
    swapped = read_bvh(write(tmp_path, text, "z.bvh"), unit_m=1.0, axes="z_up")
    np.testing.assert_allclose(swapped.positions, plain.positions, atol=1e-14)
    np.testing.assert_allclose(swapped.orientations, plain.orientations, atol=1e-14)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (("HIERARCHY", "HIERARCHIE"), "HIERARCHY"),
        (("Frames: 2", "Frames: 3"), "must be 3 frames times 14 channels"),
        (("Xposition", "Wposition"), "unknown channel 'Wposition'"),
        (("0.025", "0"), "2 frames of 0.0 s"),
        (("1 8 2  90", "1 nan 2  90"), "not finite"),
        (("OFFSET 0 3 0", "OFFSET 0 three 0"), "three"),
        (("MOTION", "}\nMOTION"), "too many"),
    ],
)
def test_broken_bvh_is_refused_with_file_and_reason(tmp_path, change, says):
    path = write(tmp_path, BVH.replace(*change, 1))
    with pytest.raises(mane.InvalidArgument, match=f"clip.bvh.*{re.escape(says)}"):
        read_bvh(path)


def test_unknown_joint_is_refused_with_the_known_ones(tmp_path):
    with pytest.raises(mane.InvalidArgument, match=r"'Skull'.*Hips, Leg, Neck, Head"):
        read_bvh(write(tmp_path, BVH), joint="Skull")


def test_csv_round_trip_is_exact(tmp_path):
    motion = random_motion()
    write_csv(tmp_path / "m.csv", motion)
    again = mane.Motion.load(tmp_path / "m.csv")
    for name in ("times_s", "positions", "orientations"):
        np.testing.assert_array_equal(getattr(again, name), getattr(motion, name))


def test_csv_columns_may_stand_in_any_order(tmp_path):
    path = write(tmp_path, "qw,x,y,z,qx,qy,qz,time_s\n1, 2,3,4, 0,0,0, 5\n", "m.csv")
    motion = read_csv(path)
    assert motion.times_s.tolist() == [5]
    assert motion.positions.tolist() == [[2, 3, 4]]
    assert motion.orientations.tolist() == [[0, 0, 0, 1]]


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("time_s,x,y,z\n", "lacks columns qx, qy, qz, qw"),
        ("time_s,x,y,z,qx,qy,qz,qw\n", "holds no poses"),
        ("time_s,x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,0,1\n1,a,0,0,0,0,0,1\n", "m.csv:3"),
        ("time_s,x,y,z,qx,qy,qz,qw\n0,0,0\n", "m.csv:2"),
    ],
)
def test_broken_csv_is_refused_with_line_and_reason(tmp_path, text, says):
    with pytest.raises(mane.InvalidArgument, match=says):
        read_csv(write(tmp_path, text, "m.csv"))


def test_other_files_are_refused(tmp_path):
    with pytest.raises(mane.InvalidArgument, match=r"must end in \.bvh or \.csv"):
        mane.Motion.load(write(tmp_path, "", "m.fbx"))


@pytest.mark.parametrize(
    ("arguments", "field"),
    [
        (([], None, None), "times_s"),
        (([0, 1, 1], None, None), "times_s[2]"),
        (([0, np.nan], None, None), "times_s[1]"),
        (([0], [[0, np.inf, 0]], None), "positions[0, 1]"),
        (([0], [[0, 0]], None), "positions"),
        (([0, 1], None, [[0, 0, 0, 1], [0, 0, 0, 1.02]]), "orientations[1]"),
    ],
)
def test_bad_motion_is_refused_by_field(arguments, field):
    with pytest.raises(mane.InvalidArgument) as caught:
        mane.Motion(*arguments)
    assert [v.field for v in caught.value.field_violations] == [field]


def test_resampling_at_the_same_rate_keeps_every_pose():
    times = np.arange(61) / 60
    motion = mane.Motion(times, np.random.default_rng(1).normal(size=(61, 3)))
    again = motion.resampled(60)
    assert len(again) == 61
    np.testing.assert_allclose(again.times_s, motion.times_s, atol=1e-12)
    np.testing.assert_allclose(again.positions, motion.positions, atol=1e-12)


def test_resampling_interpolates_lines_and_great_arcs():
    turn = Rotation.from_rotvec([[0, 0, 0], [0, 1.0, 0]]).as_quat()
    motion = mane.Motion([2.0, 3.0], [[0, 0, 0], [4, 0, 0]], turn).resampled(4)
    np.testing.assert_allclose(motion.times_s, [2, 2.25, 2.5, 2.75, 3])
    np.testing.assert_allclose(motion.positions[:, 0], [0, 1, 2, 3, 4], atol=1e-12)
    turned = Rotation.from_quat(motion.orientations).as_rotvec()
    np.testing.assert_allclose(turned[:, 1], [0, 0.25, 0.5, 0.75, 1], atol=1e-12)


def test_shifting_in_the_head_frame_follows_the_orientation():
    quarter = Rotation.from_rotvec([0, np.pi / 2, 0]).as_quat()
    motion = mane.Motion([0.0], [[1, 2, 3]], [quarter])
    moved = motion.shifted(time_s=5, world=(0, 1, 0), head=(0, 0, 1))
    assert moved.times_s.tolist() == [5]
    np.testing.assert_allclose(moved.positions, [[2, 3, 3]], atol=1e-15)


def test_poses_are_the_rows():
    motion = random_motion(3)
    for k, pose in enumerate(motion.poses()):
        assert pose.time_s == motion.times_s[k]
        np.testing.assert_array_equal(pose.position, motion.positions[k])
        np.testing.assert_array_equal(pose.orientation, motion.orientations[k])
