"""Uploads, downloads and conversions, without a server."""

from __future__ import annotations

from dataclasses import fields

import numpy as np
import pytest

import mane
from conftest import make_guide, make_guides
from mane import messages, value_messages
from mane.helix import Strands
from mane.v1 import groom_pb2, types_pb2

MESSAGE_LIMIT = 1024 * 1024


def big_mesh(vertices: int = 200_000, triangles: int = 150_000) -> mane.Mesh:
    rng = np.random.default_rng(4)
    return mane.Mesh(
        rng.normal(size=(vertices, 3)).astype(np.float32),
        rng.integers(0, vertices, (triangles, 3)).astype(np.uint32),
        np.arange(0, triangles, 2, dtype=np.uint32),
    )


def upload(guides, scalp) -> list[groom_pb2.CreateGroomRequest]:
    header = messages.create_header("id", "name", None)
    return list(messages.create_groom(header, guides, scalp))


def download(requests, count: int) -> mane.Groom:
    """Plays a server that sends back what was uploaded."""
    parts = messages.ExportedGroom()
    parts.add(groom_pb2.ExportGroomResponse(groom=groom_pb2.Groom(guide_count=count)))
    for request in requests:
        if request.WhichOneof("part") == "guides":
            parts.add(groom_pb2.ExportGroomResponse(guides=request.guides))
        elif request.WhichOneof("part") == "scalp_mesh":
            parts.add(groom_pb2.ExportGroomResponse(scalp_mesh=request.scalp_mesh))
        elif request.header.HasField("ellipsoid"):
            parts.add(groom_pb2.ExportGroomResponse(ellipsoid=request.header.ellipsoid))
    return parts.groom()


def assert_same_guide(a: mane.Guide, b: mane.Guide) -> None:
    for field in fields(mane.Guide):
        np.testing.assert_array_equal(getattr(a, field.name), getattr(b, field.name), field.name)


def test_bodies_travel_in_pieces_below_the_limit_and_come_back():
    big = big_mesh()
    bodies = [
        mane.Body("ball", mane.EllipsoidBody((0.1, 0.2, 0.1)), material="wool", moving=True),
        mane.Body("coat", big, friction=0.7),
    ]
    header = messages.create_header("id", "name", None, mane.ScalpContact("skin", 0.5))
    requests = list(messages.create_groom(header, (), None, bodies))
    assert all(request.ByteSize() < MESSAGE_LIMIT for request in requests)
    assert requests[0].header.scalp_contact.friction == 0.5
    assert not requests[0].header.scalp_contact.HasField("friction_anisotropy")
    assert requests[1].body.material == groom_pb2.MATERIAL_WOOL
    assert not requests[1].body.HasField("friction")
    parts = messages.ExportedGroom()
    parts.add(groom_pb2.ExportGroomResponse(groom=groom_pb2.Groom(body_count=2)))
    for request in requests[1:-1]:
        assert not request.body.mesh.hair_triangles
        parts.add(groom_pb2.ExportGroomResponse(body=request.body))
    ball, coat = parts.groom().bodies
    assert ball.material == mane.Material.WOOL and ball.moving and coat.friction == 0.7
    np.testing.assert_array_equal(coat.shape.vertices, big.vertices)
    np.testing.assert_array_equal(coat.shape.triangles, big.triangles)


def test_a_pose_carries_bodies():
    pose = mane.Pose(1.0, bodies={"hand": mane.Pose(position=(1, 2, 3))})
    sent = messages.head_pose(pose).bodies
    assert [body.name for body in sent] == ["hand"] and sent[0].pose.position.z == 3


def test_guides_survive_the_way_there_and_back():
    guides = [
        *make_guides(5),
        make_guide(element_count=0, element_lengths_m=[0.1, 0.05]),
        make_guide(model=mane.StrandModel.WOUND),
    ]
    back = download(upload(guides, None), len(guides)).guides
    for sent, received in zip(guides, back, strict=True):
        assert_same_guide(sent, received)


def test_big_uploads_travel_in_messages_under_the_limit():
    curls = {"element_count": 256, "natural_twist": np.arange(256.0)}
    guides = [make_guide(**curls) for _ in range(1000)]
    requests = upload(guides, big_mesh())
    assert len(requests) > 8
    assert max(request.ByteSize() for request in requests) < MESSAGE_LIMIT
    assert sum(len(request.guides.guides) for request in requests) == 1000


def test_mesh_pieces_hold_whole_vertices_and_add_up():
    mesh = big_mesh()
    pieces = list(value_messages.mesh_pieces(mesh))
    assert all(len(piece.vertices) % 12 == len(piece.triangles) % 12 == 0 for piece in pieces)
    back = download(upload([], mesh), 0).scalp
    np.testing.assert_array_equal(back.vertices, mesh.vertices)
    np.testing.assert_array_equal(back.triangles, mesh.triangles)
    np.testing.assert_array_equal(back.hair_triangles, mesh.hair_triangles)


def test_ellipsoid_survives_the_way_there_and_back():
    sent = mane.Ellipsoid((0.1, 0.2, 0.3), (1, 2, 3), (0, 0, 1), 0.7)
    back = download(upload([], sent), 0).scalp
    for field in fields(mane.Ellipsoid):
        np.testing.assert_array_equal(getattr(back, field.name), getattr(sent, field.name))


def test_incomplete_download_is_an_error():
    with pytest.raises(mane.Internal, match="not complete"):
        download(upload(make_guides(2), None), 3)


def test_names_may_be_given_whole_in_part_or_as_objects():
    for groom in ("x", "grooms/x", mane.Groom("grooms/x")):
        assert messages.resource_name("grooms", groom) == "grooms/x"


def test_every_hair_type_of_the_api_is_known():
    known = {groom_pb2.HairType.Name(messages.hair_type(value)) for value in mane.HairType}
    assert known == set(groom_pb2.HairType.keys()) - {"HAIR_TYPE_UNSPECIFIED"}
    with pytest.raises(mane.InvalidArgument, match="'bald', must be one of asian_smooth"):
        messages.hair_type("bald")


def test_every_strand_model_of_the_api_is_known():
    def of_guide(model):
        return messages.guide(make_guide(model=model))

    def of_generation(model):
        generate = mane.GuideGeneration("asian_smooth", 1, 0.1, model=model)
        return messages.generation(generate)

    for make in (of_guide, of_generation):
        known = {groom_pb2.StrandModel.Name(make(value).model) for value in mane.StrandModel}
        assert known == set(groom_pb2.StrandModel.keys()) - {"STRAND_MODEL_UNSPECIFIED"}
        assert make("Wound").model == groom_pb2.STRAND_MODEL_WOUND
        with pytest.raises(mane.InvalidArgument, match="'knitted', must be one of super-helix"):
            make("knitted")
    unset = mane.GuideGeneration("asian_smooth", 1, 0.1)
    assert messages.generation(unset).model == groom_pb2.STRAND_MODEL_UNSPECIFIED
    assert messages.from_guide(groom_pb2.Guide()).model == mane.StrandModel.SUPER_HELIX


def test_rest_curvatures_come_guide_by_guide():
    guides = [make_guide(element_count=2), make_guide(element_count=3, model="wound")]
    numbers = np.arange(2 * 3 + 3 * 4.0)
    message = groom_pb2.ComputeRestShapeResponse(
        points_per_guide=2,
        positions=bytes(2 * 2 * 3 * 8),
        curvatures=numbers.astype("<f8").tobytes(),
    )
    plain, wound = messages.from_rest_shape(message, Strands(guides)).curvatures
    np.testing.assert_array_equal(plain, numbers[:6].reshape(2, 3))
    np.testing.assert_array_equal(wound, numbers[6:].reshape(3, 4))


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"root_position": (1, 2)}, "root_position"),
        ({"root_frame": (0, 0, 1)}, "root_frame"),
        ({"natural_twist": [[1.0]]}, "natural_twist"),
    ],
)
def test_wrong_shapes_of_a_guide_are_refused_by_field(changes, field):
    with pytest.raises(mane.InvalidArgument) as caught:
        make_guide(**changes)
    assert caught.value.field_violations[0].field == field


def test_unset_orientation_means_identity():
    pose = value_messages.from_rigid(2.0, types_pb2.Pose())
    assert pose.time_s == 2.0
    np.testing.assert_array_equal(pose.orientation, (0, 0, 0, 1))
