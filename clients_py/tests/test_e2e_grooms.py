"""Grooms on a real daemon: what is sent comes back, and rest shapes obey mechanics."""

from __future__ import annotations

import itertools
from dataclasses import fields

import numpy as np
import pytest

import mane
from conftest import make_guide, make_guides
from mane import messages, value_messages
from mane.helix import Strands


@pytest.fixture
def keep(client):
    """Creates grooms that are deleted after the test."""
    kept = []

    def create(*args, **kwargs) -> mane.Groom:
        kept.append(client.create_groom(*args, **kwargs))
        return kept[-1]

    yield create
    for groom in kept:
        client.delete_groom(groom)


def sphere(rows: int, columns: int, radius_m: float = 0.1) -> mane.Mesh:
    """A closed sphere, counter-clockwise seen from outside; hair grows on its upper half."""
    polar, around = np.meshgrid(
        np.linspace(0.02, np.pi - 0.02, rows), np.arange(columns) * 2 * np.pi / columns,
        indexing="ij",
    )  # fmt: skip
    vertices = radius_m * np.stack(
        [np.sin(polar) * np.sin(around), np.cos(polar), np.sin(polar) * np.cos(around)], axis=-1
    )
    row, column = np.meshgrid(np.arange(rows - 1), np.arange(columns), indexing="ij")
    a, b = row * columns + column, row * columns + (column + 1) % columns
    c, d = a + columns, b + columns
    triangles = np.stack([a, c, b, b, c, d], axis=-1).reshape(-1, 3)
    upper = np.flatnonzero(vertices.reshape(-1, 3)[triangles, 1].mean(axis=1) > 0)
    return mane.Mesh(vertices.reshape(-1, 3), triangles, upper)


def test_server_serves(client, maned):
    status = client.status()
    assert status.serving and status.state == "serving" and status.server == maned.address


def test_every_parameter_of_a_guide_comes_back(keep, client):
    guides = [
        *make_guides(4),
        make_guide(length_m=0, element_count=0, element_lengths_m=[0.1, 0.05]),
    ]
    groom = keep(guides, display_name="a few guides")
    assert groom.name.startswith("grooms/") and groom.display_name == "a few guides"
    assert groom.guide_count == 5 and groom.hair_type is None and not groom.has_scalp
    assert groom.element_count == sum(len(g.resolved_element_lengths_m()) for g in guides)
    assert groom.longest_guide_m == pytest.approx(max(*(g.length_m for g in guides), 0.15))
    exported = client.export_groom(groom)
    assert exported.etag == groom.etag
    for sent, back in zip(guides, exported.guides, strict=True):
        lengths = (g.resolved_element_lengths_m() for g in (sent, back))
        np.testing.assert_allclose(*lengths, rtol=1e-12)
        turned = abs(sent.root_frame @ back.root_frame)  # Of unit quaternions, up to their sign.
        assert turned == pytest.approx(1, abs=1e-12)
        count = len(sent.resolved_element_lengths_m())
        for field in fields(mane.Guide):
            if field.name in ("length_m", "element_count", "element_lengths_m", "root_frame"):
                continue
            values = [getattr(g, field.name) for g in (sent, back)]
            if field.name == "model":
                assert values[0] == values[1]
                continue
            if field.name.startswith("natural"):  # One for all, or one per element.
                values = [np.broadcast_to(v, count) for v in values]
            np.testing.assert_allclose(*values, rtol=1e-12, err_msg=field.name)


def test_a_groom_chosen_by_id_is_found_listed_and_deleted(client):
    groom = client.create_groom([make_guide()], groom_id="found-and-lost")
    assert groom.name == "grooms/found-and-lost"
    found = client.get_groom("found-and-lost")
    assert (found.etag, found.create_time) == (groom.etag, groom.create_time)
    assert groom.name in [g.name for g in client.list_grooms()]
    with pytest.raises(mane.AlreadyExists, match="found-and-lost"):
        client.create_groom([make_guide(length_m=0.1)], groom_id="found-and-lost")
    client.delete_groom(groom)
    for ask in (client.get_groom, client.delete_groom, client.export_groom, client.rest_shape):
        with pytest.raises(mane.NotFound, match="found-and-lost"):
            ask(groom)
    assert groom.name not in [g.name for g in client.list_grooms()]


def test_paging_lists_every_groom_once_by_name(keep, client):
    names = {keep([make_guide()], groom_id=f"page-{k}").name for k in range(5)}
    listed = [g.name for g in client.list_grooms(page_size=2)]
    assert listed == sorted(listed) and len(set(listed)) == len(listed)
    assert names <= set(listed)


def test_equal_content_has_equal_etags(keep):
    one, same, other = (keep([make_guide(length_m=x)]) for x in (0.1, 0.1, 0.11))
    assert one.name != same.name
    assert one.etag == same.etag != other.etag


def test_a_repeated_request_makes_one_groom(client):
    header = messages.create_header("", "", None)
    answers = [
        client._grooms.CreateGroom(messages.create_groom(header, [make_guide()], None), timeout=60)
        for _ in range(2)
    ]
    assert answers[0].name == answers[1].name
    client.delete_groom(answers[0].name)


def test_generated_hair_is_the_same_for_the_same_seed(keep, client):
    scalp = mane.Ellipsoid((0.08, 0.1, 0.09), cap_angle=1.2)
    grooms = []
    for seed in (7, 7, 8):
        generate = mane.GuideGeneration("caucasian_curly", 12, 0.12, 6, seed=seed)
        grooms.append(keep(scalp=scalp, generate=generate))
    assert grooms[0].hair_type == mane.HairType.CAUCASIAN_CURLY and grooms[0].seed == 7
    assert (grooms[0].guide_count, grooms[0].element_count) == (12, 72)
    assert grooms[0].etag == grooms[1].etag != grooms[2].etag
    exported = client.export_groom(grooms[0])
    assert isinstance(exported.scalp, mane.Ellipsoid)
    roots = np.array([g.root_position for g in exported.guides])
    np.testing.assert_allclose(np.sum((roots / scalp.radii_m) ** 2, axis=1), 1, atol=1e-6)


def test_a_mesh_larger_than_a_message_comes_back(keep, client):
    scalp = sphere(240, 240)
    assert scalp.vertices.nbytes > value_messages.PIECE_BYTES
    generate = mane.GuideGeneration("asian_smooth", 5, 0.1, 3)
    exported = client.export_groom(keep(scalp=scalp, generate=generate))
    for name in ("vertices", "triangles", "hair_triangles"):
        np.testing.assert_array_equal(getattr(exported.scalp, name), getattr(scalp, name))
    roots = np.array([g.root_position for g in exported.guides])
    assert np.all(roots[:, 1] > 0)  # Where hair grows.
    np.testing.assert_allclose(np.linalg.norm(roots, axis=1), 0.1, rtol=1e-3)


def test_hair_grows_on_the_mannequin(keep):
    generate = mane.GuideGeneration(mane.HairType.AFRICAN_FUZZY, 8, 0.05)
    groom = keep(scalp=mane.mesh.mannequin(), generate=generate)
    assert groom.has_scalp and groom.guide_count == 8


def test_rest_shape_without_gravity_is_the_natural_helix(keep, client):
    guides = make_guides(6)
    rest = client.rest_shape(keep(guides), gravity=(0, 0, 0), points_per_guide=20)
    natural = np.concatenate([guide.resolved_natural() for guide in guides])
    lengths = np.concatenate([g.resolved_element_lengths_m() for g in guides])
    np.testing.assert_allclose(np.concatenate(rest.curvatures), natural, atol=1e-6)
    helices = Strands(guides).positions(natural * lengths[:, None], 20)
    np.testing.assert_allclose(rest.positions, helices, atol=1e-9)
    assert rest.residuals.shape == (6,)


def test_rest_shape_under_gravity_balances_and_fits_its_curvatures(keep, client):
    guides = make_guides(6)
    rest = client.rest_shape(keep(guides), points_per_guide=30)
    assert np.all(rest.residuals <= 1e-6)
    lengths = np.concatenate([g.resolved_element_lengths_m() for g in guides])
    helices = Strands(guides).positions(np.concatenate(rest.curvatures) * lengths[:, None], 30)
    np.testing.assert_allclose(rest.positions, helices, atol=1e-9)


def test_a_limp_strand_hangs_and_follows_head_and_gravity(keep, client):
    limp = make_guide(
        root_frame=mane.frame_along((0, 0, 1)), root_position=(0, 0, 0), young_modulus_pa=1e6,
        length_m=0.2, element_count=10, natural_curvature_1=0, natural_twist=0,
    )  # fmt: skip
    groom = keep([limp])
    tip = client.rest_shape(groom).positions[0, -1]
    assert tip[1] < -0.15 and abs(tip[0]) < 1e-6 < tip[2]
    # Turned half round about Z, down in the world is up in the head frame.
    half_turn = client.rest_shape(groom, head_orientation=(0, 0, 1, 0)).positions[0, -1]
    np.testing.assert_allclose(half_turn, tip * (1, -1, 1), atol=1e-6)
    upward = client.rest_shape(groom, gravity=(0, 9.81, 0)).positions[0, -1]
    np.testing.assert_allclose(upward, half_turn, atol=1e-6)


@pytest.mark.parametrize(
    ("changes", "field", "value"),
    [
        ({"length_m": 0.0}, "length_m", "0"),
        ({"length_m": -0.1}, "length_m", "-0.1"),
        ({"length_m": np.nan}, "length_m", "nan"),
        ({"length_m": 6.0}, "length_m", "6"),
        ({"element_count": 0}, "element_count", "0"),
        ({"element_count": 100_000}, "element_count", "100000"),
        ({"element_lengths_m": [0.1, -0.1, 0.1, 0.05]}, "element_lengths_m", "-0.1"),
        ({"radius_1_m": 0.0}, "radius_1_m", "0"),
        ({"radius_2_m": -1e-5}, "radius_2_m", "-1e-05"),
        ({"young_modulus_pa": np.inf}, "young_modulus_pa", "inf"),
        ({"poisson_ratio": 0.6}, "poisson_ratio", "0.6"),
        ({"density_kg_m3": 0.0}, "density_kg_m3", "0"),
        ({"internal_friction": -1.0}, "internal_friction", "-1"),
        ({"air_drag": 11.0}, "air_drag", "11"),
        ({"root_frame": (0, 0, 0, 1.1)}, "root_frame", "1.1"),
        ({"root_position": (0, np.nan, 0)}, "root_position", "nan"),
        ({"natural_twist": [1.0, 2.0]}, "natural_twist", "2"),
        ({"natural_curvature_2": np.nan}, "natural_curvature_2", "nan"),
    ],
)
def test_bad_guides_are_refused_by_index_field_and_value(client, changes, field, value):
    guides = [make_guide(), make_guide(**changes)]
    before = {g.name for g in client.list_grooms()}
    with pytest.raises(mane.InvalidArgument) as caught:
        client.create_groom(guides)
    assert caught.value.field_violations[0].field.startswith(f"guides[1].{field}")
    assert value in str(caught.value)
    assert {g.name for g in client.list_grooms()} == before


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ({}, "guides"),
        ({"generate": mane.GuideGeneration("asian_smooth", 5, 0.1)}, "scalp"),
        ({"guides": [make_guide()], "groom_id": "No Capitals"}, "groom_id"),
        ({"guides": [make_guide()], "display_name": "x" * 201}, "display_name"),
        ({"guides": itertools.repeat(make_guide(), 200_000)}, "guides"),
    ],
)
def test_bad_uploads_are_refused(client, arguments, says):
    with pytest.raises((mane.InvalidArgument, mane.ResourceExhausted), match=says):
        client.create_groom(**arguments)
