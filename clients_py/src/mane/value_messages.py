"""Conversions of vectors, rotations, poses and meshes, which many messages hold."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import ArrayLike

from mane.mesh import Mesh
from mane.pose import IDENTITY, Pose, vector
from mane.v1 import groom_pb2, types_pb2

# Uploads travel in pieces of about this size, well under the server's limit of 1 MiB a message.
PIECE_BYTES = 512 * 1024

MESH_ARRAYS = {"vertices": "<f4", "triangles": "<u4", "hair_triangles": "<u4"}


def vector3(values: ArrayLike, name: str = "vector") -> types_pb2.Vector3:
    x, y, z = vector(name, values, 3)
    return types_pb2.Vector3(x=x, y=y, z=z)


def quaternion(values: ArrayLike, name: str = "quaternion") -> types_pb2.Quaternion:
    x, y, z, w = vector(name, values, 4)
    return types_pb2.Quaternion(x=x, y=y, z=z, w=w)


def from_vector3(message: types_pb2.Vector3) -> tuple[float, float, float]:
    return message.x, message.y, message.z


def from_quaternion(message: types_pb2.Quaternion) -> tuple[float, float, float, float]:
    return message.x, message.y, message.z, message.w


def rigid(pose: Pose) -> types_pb2.Pose:
    return types_pb2.Pose(position=vector3(pose.position), orientation=quaternion(pose.orientation))


def from_rigid(time_s: float, message: types_pb2.Pose) -> Pose:
    turned = message.HasField("orientation")
    orientation = from_quaternion(message.orientation) if turned else IDENTITY
    return Pose(time_s, from_vector3(message.position), orientation)


def mesh_pieces(
    mesh: Mesh, arrays: dict[str, str] = MESH_ARRAYS
) -> Iterator[groom_pb2.TriangleMesh]:
    """Pieces of whole vertices and triangles, to be concatenated, of those `arrays`."""
    for field, dtype in arrays.items():
        data = np.ascontiguousarray(getattr(mesh, field), dtype=dtype).tobytes()
        step = PIECE_BYTES // 12 * 12
        for begin in range(0, len(data), step):
            yield groom_pb2.TriangleMesh(**{field: data[begin : begin + step]})
