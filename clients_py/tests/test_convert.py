"""Axes and units: known directions, rotations that commute with points, round trips."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import mane
from mane import convert

# Where a point one unit to the left, above and in front of a figure lies in each program.
KNOWN = {
    "mane": ([1, 0, 0], [0, 1, 0], [0, 0, 1]),
    "maya": ([1, 0, 0], [0, 1, 0], [0, 0, 1]),
    "blender": ([1, 0, 0], [0, 0, 1], [0, -1, 0]),
    "z_up": ([0, 1, 0], [0, 0, 1], [1, 0, 0]),
    "unity": ([-1, 0, 0], [0, 1, 0], [0, 0, 1]),
    "unreal": ([0, -1, 0], [0, 0, 1], [1, 0, 0]),
}
LEFT_HANDED = {"unity", "unreal"}


def test_every_convention_is_covered():
    assert set(KNOWN) == set(convert.CONVENTIONS)


@pytest.mark.parametrize("name", KNOWN)
def test_left_up_and_forward_become_x_y_and_z(name):
    unit = convert.CONVENTIONS[name].unit_m
    np.testing.assert_allclose(convert.points(KNOWN[name], name), unit * np.eye(3), atol=1e-15)


@pytest.mark.parametrize("name", KNOWN)
def test_handedness_is_the_sign_of_the_determinant(name):
    sign = -1 if name in LEFT_HANDED else 1
    assert round(np.linalg.det(convert.axes_matrix(name))) == sign


@pytest.mark.parametrize("name", KNOWN)
def test_rotating_then_converting_is_converting_then_rotating(name):
    rng = np.random.default_rng(7)
    quaternions = Rotation.random(20, rng).as_quat()
    points = rng.normal(size=(20, 3))
    # In a left-handed convention the same formula turns a point by the same numbers.
    turned = Rotation.from_quat(quaternions).apply(points)
    expected = convert.points(turned, name)
    converted = Rotation.from_quat(convert.quaternions(quaternions, name))
    np.testing.assert_allclose(converted.apply(convert.points(points, name)), expected, atol=1e-14)


@pytest.mark.parametrize("name", KNOWN)
def test_there_and_back_is_the_identity(name):
    rng = np.random.default_rng(8)
    points = rng.normal(size=(2, 5, 3))
    quaternions = Rotation.random(10, rng).as_quat()
    there = convert.points(points, "mane", name)
    np.testing.assert_allclose(convert.points(there, name), points, atol=1e-14)
    there = convert.quaternions(quaternions, "mane", name)
    np.testing.assert_allclose(convert.quaternions(there, name), quaternions, atol=1e-15)


@pytest.mark.parametrize(
    ("unit", "metres"),
    [("m", 2.0), ("dm", 0.2), ("cm", 0.02), ("mm", 0.002), ("inch", 0.0508), ("foot", 0.6096)],
)
def test_units(unit, metres):
    np.testing.assert_allclose(convert.metres([2.0], unit), [metres], rtol=1e-15)


def test_euler_angles_by_hand():
    # Capital letters turn about moving axes: R = Rz(90) Rx(90) takes z to Rz(-y) = x.
    q = convert.quaternion_from_euler("ZX", [90, 90])
    np.testing.assert_allclose(Rotation.from_quat(q).apply([0, 0, 1]), [1, 0, 0], atol=1e-15)


def test_quaternion_and_matrix_agree():
    q = np.array([0, 0, np.sin(0.3), np.cos(0.3)])
    c, s = np.cos(0.6), np.sin(0.6)
    matrix = convert.matrix_from_quaternion(q)
    np.testing.assert_allclose(matrix, [[c, -s, 0], [s, c, 0], [0, 0, 1]], atol=1e-15)
    np.testing.assert_allclose(convert.quaternion_from_matrix(matrix), q, atol=1e-15)


def test_unknown_names_are_refused_with_the_known_ones():
    with pytest.raises(mane.InvalidArgument, match="'maxx', must be one of mane, maya"):
        convert.points([0, 0, 0], "maxx")
    with pytest.raises(mane.InvalidArgument, match="'yard', must be one of m, dm"):
        convert.metres(1, "yard")


def test_frame_along_takes_the_first_axis_there():
    rng = np.random.default_rng(9)
    for direction in [*rng.normal(size=(20, 3)), (1, 0, 0), (-1, 0, 0), (-2, 1e-9, 0)]:
        axis = np.asarray(direction) / np.linalg.norm(direction)
        turned = Rotation.from_quat(mane.frame_along(direction)).apply([1, 0, 0])
        np.testing.assert_allclose(turned, axis, atol=1e-7)
        n1 = np.roll(direction, 1) + np.array([0.1, 0.2, 0.3])
        frame = Rotation.from_quat(mane.frame_along(direction, n1)).as_matrix()
        np.testing.assert_allclose(frame[:, 0], axis, atol=1e-12)
        assert frame[:, 1] @ n1 > 0 and abs(frame[:, 2] @ n1) < 1e-12


def test_frame_along_nothing_is_refused():
    with pytest.raises(mane.InvalidArgument, match="direction"):
        mane.frame_along((0, 0, 0))
    with pytest.raises(mane.InvalidArgument, match="n1"):
        mane.frame_along((0, 1, 0), n1=(0, 2, 0))
