"""Units and axes of other programs.

Mane itself uses metres, right-handed axes with Y up, and a head that looks toward +Z; its left is
then +X. A convention is described by where its axes point in Mane's and by its unit of length.
Points, directions and rotations of left-handed conventions come out right as well.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial.transform import Rotation

from mane.errors import InvalidArgument

# Metres per unit.
UNITS_M = {
    "m": 1.0,
    "dm": 0.1,
    "cm": 0.01,
    "mm": 0.001,
    "inch": 0.0254,
    "foot": 0.3048,
}

_AXES = {
    "+x": (1, 0, 0),
    "-x": (-1, 0, 0),
    "+y": (0, 1, 0),
    "-y": (0, -1, 0),
    "+z": (0, 0, 1),
    "-z": (0, 0, -1),
}


@dataclass(frozen=True)
class Convention:
    """Axes and unit of a program.

    Attributes:
      left: the axis to the left of a figure, signed: `+x`, `-x`, `+y` ...
      up: the axis that points up.
      forward: the axis that the figure looks along.
      unit_m: metres per unit of length.
    """

    left: str
    up: str
    forward: str
    unit_m: float = 1.0


CONVENTIONS = {
    "mane": Convention("+x", "+y", "+z"),
    "maya": Convention("+x", "+y", "+z", 0.01),  # Right-handed, Y up, centimetres.
    "blender": Convention("+x", "+z", "-y"),  # Right-handed, Z up, metres.
    "z_up": Convention("+y", "+z", "+x"),  # Right-handed, Z up, X forward, metres (robotics).
    "unity": Convention("-x", "+y", "+z"),  # Left-handed, Y up, metres.
    "unreal": Convention("-y", "+z", "+x", 0.01),  # Left-handed, Z up, centimetres.
}


def metres(values: ArrayLike, unit: str) -> np.ndarray:
    """Lengths given in `unit`, a name in `UNITS_M`, in metres. Any shape."""
    if unit not in UNITS_M:
        raise InvalidArgument.of("unit", f"is {unit!r}, must be one of {', '.join(UNITS_M)}")
    return np.asarray(values, dtype=np.float64) * UNITS_M[unit]


def axes_matrix(source: str, target: str = "mane") -> np.ndarray:
    """Signed permutation that takes directions of `source` to `target`, (3, 3).

    Its determinant is -1 where one of the two is left-handed. Lengths are not converted.
    """
    return _to_mane(target).T @ _to_mane(source)


def points(values: ArrayLike, source: str, target: str = "mane") -> np.ndarray:
    """Points (..., 3) of one convention in the axes and unit of another."""
    scale = _convention(source).unit_m / _convention(target).unit_m
    return np.asarray(values, dtype=np.float64) @ axes_matrix(source, target).T * scale


def quaternions(values: ArrayLike, source: str, target: str = "mane") -> np.ndarray:
    """Rotations (..., 4), (x, y, z, w), of one convention in another.

    Both the rotated thing's own axes and the world's are taken to follow the convention: an upright
    head that looks forward is the identity on both sides.
    """
    values = np.asarray(values, dtype=np.float64)
    axes = axes_matrix(source, target)
    # A reflection turns a rotation about v into one about the reflected v, the other way round.
    vector = values[..., :3] @ axes.T * np.sign(np.linalg.det(axes))
    return np.concatenate([vector, values[..., 3:]], axis=-1)


def quaternion_from_euler(order: str, angles: ArrayLike, degrees: bool = True) -> np.ndarray:
    """Quaternions (..., 4) of Euler angles (..., len(order)).

    `order` as in `scipy.spatial.transform.Rotation.from_euler`: capital letters turn about the
    axes that move along (`ZXY`: R = Rz Rx Ry), small letters about fixed ones.
    """
    return Rotation.from_euler(order, np.asarray(angles), degrees=degrees).as_quat()


def quaternion_from_matrix(matrices: ArrayLike) -> np.ndarray:
    """Quaternions (..., 4) of rotation matrices (..., 3, 3)."""
    return Rotation.from_matrix(np.asarray(matrices, dtype=np.float64)).as_quat()


def matrix_from_quaternion(values: ArrayLike) -> np.ndarray:
    """Rotation matrices (..., 3, 3) of quaternions (..., 4)."""
    return Rotation.from_quat(np.asarray(values, dtype=np.float64)).as_matrix()


def _to_mane(name: str) -> np.ndarray:
    convention = _convention(name)
    return np.array([_AXES[a] for a in (convention.left, convention.up, convention.forward)], float)


def _convention(name: str) -> Convention:
    if name not in CONVENTIONS:
        raise InvalidArgument.of(
            "convention", f"is {name!r}, must be one of {', '.join(CONVENTIONS)}"
        )
    return CONVENTIONS[name]
