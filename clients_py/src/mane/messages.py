"""Conversions between this package's classes and the API's messages."""

from __future__ import annotations

import uuid
from collections.abc import Iterable, Iterator
from dataclasses import fields, replace
from datetime import UTC, datetime

import numpy as np

from mane import body_messages, hair_messages
from mane.bodies import Body, ScalpContact
from mane.errors import Internal
from mane.groom import (
    Ellipsoid,
    Groom,
    Guide,
    GuideGeneration,
    HairType,
    RestShape,
    StrandModel,
)
from mane.hairs import Hairs
from mane.helix import Strands
from mane.mesh import Mesh
from mane.motion import Motion
from mane.pose import IDENTITY, Environment, Pose, choice
from mane.strands import ImportSummary
from mane.v1 import animation_pb2, bake_pb2, groom_pb2
from mane.value_messages import (
    MESH_ARRAYS,
    PIECE_BYTES,
    from_quaternion,
    from_vector3,
    mesh_pieces,
    quaternion,
    rigid,
    vector3,
)

def request_id() -> str:
    """A fresh identifier that makes a retry of the same request safe."""
    return str(uuid.uuid4())


def resource_name(collection: str, resource) -> str:
    """`grooms/x` for a resource object, for `grooms/x` and for plain `x`."""
    name = resource if isinstance(resource, str) else resource.name
    return name if name.startswith(f"{collection}/") else f"{collection}/{name}"


def head_pose(pose: Pose) -> animation_pb2.HeadPose:
    bodies = body_messages.body_poses(pose.bodies)
    return animation_pb2.HeadPose(time_s=pose.time_s, pose=rigid(pose), bodies=bodies)


def environment(value: Environment) -> animation_pb2.Environment:
    message = animation_pb2.Environment(
        internal_friction_scale=value.internal_friction_scale,
        air_drag_scale=value.air_drag_scale,
        gust_strength=value.gust_strength,
        gust_period_s=value.gust_period_s,
        turbulence_speed=value.turbulence_speed,
        turbulence_size_m=value.turbulence_size_m,
        wind_seed=value.wind_seed,
        detail_tolerance_m=value.detail_tolerance_m,
    )
    if value.wind_velocity is not None:
        message.wind_velocity.CopyFrom(vector3(value.wind_velocity, "wind_velocity"))
    if value.gravity is not None:
        message.gravity.CopyFrom(vector3(value.gravity, "gravity"))
    return message


def guide(value: Guide) -> groom_pb2.Guide:
    return groom_pb2.Guide(
        root_position=vector3(value.root_position),
        root_frame=quaternion(value.root_frame),
        length_m=value.length_m,
        element_count=value.element_count,
        element_lengths_m=value.element_lengths_m,
        radius_1_m=value.radius_1_m,
        radius_2_m=value.radius_2_m,
        young_modulus_pa=value.young_modulus_pa,
        poisson_ratio=value.poisson_ratio,
        density_kg_m3=value.density_kg_m3,
        internal_friction=value.internal_friction,
        air_drag=value.air_drag,
        natural_twist=value.natural_twist,
        natural_curvature_1=value.natural_curvature_1,
        natural_curvature_2=value.natural_curvature_2,
        model=strand_model(value.model),
        wisp_radius_m=value.wisp_radius_m,
    )


def from_guide(message: groom_pb2.Guide) -> Guide:
    turned = message.HasField("root_frame")
    return Guide(
        root_position=from_vector3(message.root_position),
        root_frame=from_quaternion(message.root_frame) if turned else IDENTITY,
        length_m=message.length_m,
        element_count=message.element_count,
        element_lengths_m=message.element_lengths_m,
        radius_1_m=message.radius_1_m,
        radius_2_m=message.radius_2_m,
        young_modulus_pa=message.young_modulus_pa,
        poisson_ratio=message.poisson_ratio,
        density_kg_m3=message.density_kg_m3,
        internal_friction=message.internal_friction,
        air_drag=message.air_drag,
        natural_twist=message.natural_twist or (0.0,),
        natural_curvature_1=message.natural_curvature_1 or (0.0,),
        natural_curvature_2=message.natural_curvature_2 or (0.0,),
        model=_MODELS.get(message.model, StrandModel.SUPER_HELIX),  # Unset is.
        wisp_radius_m=message.wisp_radius_m,
    )


def hair_type(value: HairType | str) -> int:
    name = choice("hair_type", HairType, value).name
    return groom_pb2.HairType.Value(f"HAIR_TYPE_{name}")


_MODELS = {
    groom_pb2.STRAND_MODEL_SUPER_HELIX: StrandModel.SUPER_HELIX,
    groom_pb2.STRAND_MODEL_WOUND: StrandModel.WOUND,
}


def strand_model(value: StrandModel | str | None) -> int:
    """None is UNSPECIFIED."""
    if value is None:
        return groom_pb2.STRAND_MODEL_UNSPECIFIED
    return groom_pb2.StrandModel.Value(f"STRAND_MODEL_{choice('model', StrandModel, value).name}")


def generation(value: GuideGeneration) -> groom_pb2.GuideGeneration:
    return groom_pb2.GuideGeneration(
        hair_type=hair_type(value.hair_type),
        guide_count=value.guide_count,
        length_m=value.length_m,
        element_count=value.element_count,
        seed=value.seed,
        curl_variation=value.curl_variation,
        root_droop=value.root_droop,
        error_target=value.error_target,
        model=strand_model(value.model),
        wisp_radius_m=value.wisp_radius_m,
    )


def ellipsoid(value: Ellipsoid) -> groom_pb2.EllipsoidScalp:
    return groom_pb2.EllipsoidScalp(
        center=vector3(value.center),
        radii_m=vector3(value.radii_m),
        cap_axis=vector3(value.cap_axis),
        cap_angle=value.cap_angle,
    )


def from_ellipsoid(message: groom_pb2.EllipsoidScalp) -> Ellipsoid:
    axis = from_vector3(message.cap_axis) if message.HasField("cap_axis") else (0.0, 1.0, 0.0)
    return Ellipsoid(
        radii_m=from_vector3(message.radii_m),
        center=from_vector3(message.center),
        cap_axis=axis,
        cap_angle=message.cap_angle,
    )


def create_header(
    groom_id: str,
    display_name: str,
    generate: GuideGeneration | None,
    contact: ScalpContact | None = None,
    hairs: Hairs | None = None,
) -> groom_pb2.CreateGroomHeader:
    return groom_pb2.CreateGroomHeader(
        groom_id=groom_id,
        display_name=display_name,
        request_id=request_id(),
        generate=None if generate is None else generation(generate),
        scalp_contact=None if contact is None else body_messages.scalp_contact(contact),
        hair_offset_unit_m=0.0 if hairs is None else hairs.offset_unit_m,
    )


def create_groom(
    header: groom_pb2.CreateGroomHeader,
    guides: Iterable[Guide],
    scalp: Mesh | Ellipsoid | None,
    bodies: Iterable[Body] = (),
    hairs: Hairs | None = None,
) -> Iterator[groom_pb2.CreateGroomRequest]:
    """The messages of one upload, each about `PIECE_BYTES` at most."""
    if isinstance(scalp, Ellipsoid):
        header.ellipsoid.CopyFrom(ellipsoid(scalp))
    yield groom_pb2.CreateGroomRequest(header=header)
    if scalp is not None and not isinstance(scalp, Ellipsoid):
        for piece in mesh_pieces(scalp):
            yield groom_pb2.CreateGroomRequest(scalp_mesh=piece)
    for body in body_messages.pieces(bodies):
        yield groom_pb2.CreateGroomRequest(body=body)
    for batch in guide_batches(guides):
        yield groom_pb2.CreateGroomRequest(guides=batch)
    for batch in hair_messages.batches(hairs):
        yield groom_pb2.CreateGroomRequest(hairs=batch)
    yield groom_pb2.CreateGroomRequest(commit=groom_pb2.CommitGroom())


def guide_batches(guides: Iterable[Guide]) -> Iterator[groom_pb2.GuideBatch]:
    batch, size = groom_pb2.GuideBatch(), 0
    for value in guides:
        message = guide(value)
        if size and size + message.ByteSize() > PIECE_BYTES:
            yield batch
            batch, size = groom_pb2.GuideBatch(), 0
        batch.guides.append(message)
        size += message.ByteSize() + 8  # Tag and length.
    if size:
        yield batch


def export_groom(groom, hairs: bool) -> groom_pb2.ExportGroomRequest:
    return groom_pb2.ExportGroomRequest(name=resource_name("grooms", groom), omit_hairs=not hairs)


class ExportedGroom:
    """Collects the pieces of one download, made with the same `hairs` as its request."""

    def __init__(self, hairs: bool = True):
        self._with_hairs = hairs
        self._groom: groom_pb2.Groom | None = None
        self._guides: list[Guide] = []
        self._bodies: list[groom_pb2.Body] = []
        self._hairs = hair_messages.ExportedHairs()
        self._ellipsoid: groom_pb2.EllipsoidScalp | None = None
        self._mesh = {field: bytearray() for field in MESH_ARRAYS}

    def add(self, part: groom_pb2.ExportGroomResponse) -> None:
        match part.WhichOneof("part"):
            case "groom":
                self._groom = part.groom
            case "guides":
                self._guides += map(from_guide, part.guides.guides)
            case "body":
                body_messages.join(self._bodies, part.body)
            case "hairs":
                self._hairs.add(part.hairs)
            case "ellipsoid":
                self._ellipsoid = part.ellipsoid
            case "scalp_mesh":
                for field, data in self._mesh.items():
                    data += getattr(part.scalp_mesh, field)

    def groom(self) -> Groom:
        """The whole groom. Internal where the download is not complete."""
        told = self._groom
        if told is None or not self._complete(told):
            raise Internal("the server's export of the groom is not complete")
        return replace(
            from_groom(told),
            guides=tuple(self._guides),
            scalp=self._scalp(),
            bodies=tuple(map(body_messages.from_body, self._bodies)),
            hairs=self._hairs.hairs(told.hair_offset_unit_m),
        )

    def _complete(self, told: groom_pb2.Groom) -> bool:
        hairs = (told.hair_count, told.hair_point_count) if self._with_hairs else (0, 0)
        counts = (len(self._guides), len(self._bodies), self._hairs.counts())
        return counts == (told.guide_count, told.body_count, hairs)

    def _scalp(self) -> Mesh | Ellipsoid | None:
        if self._ellipsoid is not None:
            return from_ellipsoid(self._ellipsoid)
        if not self._mesh["vertices"]:
            return None
        arrays = {
            field: np.frombuffer(self._mesh[field], MESH_ARRAYS[field]) for field in self._mesh
        }
        return Mesh(
            arrays["vertices"].reshape(-1, 3),
            arrays["triangles"].reshape(-1, 3),
            arrays["hair_triangles"],
        )


def from_groom(message: groom_pb2.Groom) -> Groom:
    preset = groom_pb2.HairType.Name(message.hair_type).removeprefix("HAIR_TYPE_").lower()
    imported = message.HasField("import_summary")
    contact = message.scalp_contact if message.HasField("scalp_contact") else None
    return Groom(
        name=message.name,
        display_name=message.display_name,
        create_time=utc(message, "create_time"),
        guide_count=message.guide_count,
        element_count=message.element_count,
        longest_guide_m=message.longest_guide_m,
        hair_type=None if preset == "unspecified" else HairType(preset),
        seed=message.seed,
        etag=message.etag,
        has_scalp=message.has_scalp,
        import_summary=from_import_summary(message.import_summary) if imported else None,
        body_count=message.body_count,
        body_summaries=tuple(map(body_messages.from_summary, message.bodies)),
        scalp_contact=None if contact is None else body_messages.from_scalp_contact(contact),
        hair_count=message.hair_count,
        hair_point_count=message.hair_point_count,
    )


def from_import_summary(message: groom_pb2.ImportSummary) -> ImportSummary:
    return ImportSummary(**{f.name: getattr(message, f.name) for f in fields(ImportSummary)})


def from_rest_shape(message: groom_pb2.ComputeRestShapeResponse, strands: Strands) -> RestShape:
    """`strands`: the groom's."""
    points = message.points_per_guide
    return RestShape(
        positions=np.frombuffer(message.positions, "<f8").reshape(-1, points, 3).copy(),
        curvatures=strands.by_guide(np.frombuffer(message.curvatures, "<f8").copy()),
        residuals=np.frombuffer(message.residuals, "<f8").copy(),
    )


def of_groom(kind, groom):
    """A request of class `kind` that only names a groom."""
    return kind(name=resource_name("grooms", groom))


def of_job(kind, job):
    """A request of class `kind` that only names a job."""
    return kind(name=resource_name("jobs", job))


def rest_shape(
    groom, head_orientation, gravity, points_per_guide: int
) -> groom_pb2.ComputeRestShapeRequest:
    request = groom_pb2.ComputeRestShapeRequest(
        name=resource_name("grooms", groom), points_per_guide=points_per_guide
    )
    if head_orientation is not None:
        request.head_orientation.CopyFrom(quaternion(head_orientation, "head_orientation"))
    if gravity is not None:
        request.gravity.CopyFrom(vector3(gravity, "gravity"))
    return request


def bake(
    groom, motion: Motion, points_per_guide: int, substeps: int, surroundings: Environment | None
) -> bake_pb2.BakeAnimationRequest:
    request = bake_pb2.BakeAnimationRequest(
        groom=resource_name("grooms", groom),
        motion=track(motion),
        points_per_guide=points_per_guide,
        substeps=substeps,
        request_id=request_id(),
    )
    if surroundings is not None:
        request.environment.CopyFrom(environment(surroundings))
    return request


def track(motion: Motion) -> bake_pb2.PoseTrack:
    bodies = [
        bake_pb2.BodyTrack(name=name, **_packed(moving)) for name, moving in motion.bodies.items()
    ]
    times = motion.times_s.astype("<f8").tobytes()
    return bake_pb2.PoseTrack(times_s=times, bodies=bodies, **_packed(motion))


def _packed(motion: Motion) -> dict[str, bytes]:
    return {
        "positions": motion.positions.astype("<f8").tobytes(),
        "orientations": motion.orientations.astype("<f8").tobytes(),
    }


def utc(message, field: str) -> datetime | None:
    """The UTC time in a timestamp field, or None where it is unset."""
    if not message.HasField(field):
        return None
    return getattr(message, field).ToDatetime(tzinfo=UTC)
