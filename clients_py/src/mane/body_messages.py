"""Conversions between bodies that hair meets and the API's messages."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import fields

import numpy as np

from mane.bodies import (
    Body,
    BodySummary,
    CapsuleBody,
    EllipsoidBody,
    Material,
    MeshReport,
    ScalpContact,
)
from mane.mesh import Mesh
from mane.pose import Pose
from mane.v1 import animation_pb2, groom_pb2
from mane.value_messages import MESH_ARRAYS, from_rigid, from_vector3, mesh_pieces, rigid, vector3

_LISTS = {name: MESH_ARRAYS[name] for name in ("vertices", "triangles")}


def pieces(bodies: Iterable[Body]) -> Iterator[groom_pb2.Body]:
    """The messages of an upload: a body, then the pieces of its mesh."""
    for value in bodies:
        yield body(value)
        if isinstance(value.shape, Mesh):
            for piece in mesh_pieces(value.shape, _LISTS):
                yield groom_pb2.Body(name=value.name, mesh=piece)


def body(value: Body) -> groom_pb2.Body:
    """All but the lists of a mesh."""
    message = groom_pb2.Body(
        name=value.name,
        material=_material(value.material),
        friction=value.friction,
        friction_anisotropy=value.friction_anisotropy,
        moving=value.moving,
        pose=rigid(value.pose),
    )
    match value.shape:
        case EllipsoidBody(radii_m=radii):
            message.ellipsoid.radii_m.CopyFrom(vector3(radii, "radii_m"))
        case CapsuleBody(a=a, b=b, radius_m=radius):
            message.capsule.CopyFrom(
                groom_pb2.CapsuleBody(a=vector3(a), b=vector3(b), radius_m=radius)
            )
        case _:
            message.mesh.SetInParent()
    return message


def join(bodies: list[groom_pb2.Body], piece: groom_pb2.Body) -> None:
    """Adds the next message of a download to `bodies`: one more, or more of the last one's mesh."""
    if not bodies or bodies[-1].name != piece.name:
        bodies.append(piece)
        return
    for name in _LISTS:
        setattr(bodies[-1].mesh, name, getattr(bodies[-1].mesh, name) + getattr(piece.mesh, name))


def from_body(message: groom_pb2.Body) -> Body:
    match message.WhichOneof("shape"):
        case "ellipsoid":
            shape = EllipsoidBody(from_vector3(message.ellipsoid.radii_m))
        case "capsule":
            capsule = message.capsule
            shape = CapsuleBody(from_vector3(capsule.a), from_vector3(capsule.b), capsule.radius_m)
        case _:
            arrays = [
                np.frombuffer(getattr(message.mesh, name), kind).reshape(-1, 3)
                for name, kind in _LISTS.items()
            ]
            shape = Mesh(*arrays)
    return Body(
        message.name,
        shape,
        **_from_friction(message),
        moving=message.moving,
        pose=from_rigid(0.0, message.pose),
    )


def scalp_contact(value: ScalpContact) -> groom_pb2.ScalpContact:
    return groom_pb2.ScalpContact(
        material=_material(value.material),
        friction=value.friction,
        friction_anisotropy=value.friction_anisotropy,
    )


def from_scalp_contact(message: groom_pb2.ScalpContact) -> ScalpContact:
    return ScalpContact(**_from_friction(message), mesh=_from_report(message))


def from_summary(message: groom_pb2.BodySummary) -> BodySummary:
    shape = groom_pb2.BodySummary.Shape.Name(message.shape).removeprefix("SHAPE_").lower()
    return BodySummary(message.name, shape, message.moving, _from_report(message))


def body_poses(poses: dict[str, Pose]) -> list[animation_pb2.BodyPose]:
    return [animation_pb2.BodyPose(name=name, pose=rigid(pose)) for name, pose in poses.items()]


def _material(value: Material) -> int:
    return groom_pb2.Material.Value(f"MATERIAL_{value.name}")


def _from_friction(message: groom_pb2.Body | groom_pb2.ScalpContact) -> dict:
    given = {
        name: getattr(message, name) if message.HasField(name) else None
        for name in ("friction", "friction_anisotropy")
    }
    name = groom_pb2.Material.Name(message.material).removeprefix("MATERIAL_").lower()
    return {"material": name, **given}


def _from_report(message: groom_pb2.BodySummary | groom_pb2.ScalpContact) -> MeshReport | None:
    if not message.HasField("mesh"):
        return None
    return MeshReport(**{f.name: getattr(message.mesh, f.name) for f in fields(MeshReport)})
