"""Styles as documents: JSON there and back, maps and PNG files, hairdressing operations."""

from __future__ import annotations

import json

import numpy as np
import pytest
from PIL import Image

import mane
from mane import grey_png, scalp_maps
from mane.v1 import style_pb2


def violated(error: mane.Error) -> str:
    return error.field_violations[0].field


def whole_style() -> mane.Style:
    """A style in which much is set."""
    front = mane.Region(
        polar=(0.2, 1.3),
        azimuth=(-0.5, 0.5),
        half_spaces=[((0, 1, 0), 0.05)],
        mask=np.linspace(0, 1, 12).reshape(3, 4),
        wisps=[0, 3, 5],
    )
    style = mane.Style(
        style_pb2.Style(
            radii_m=[0.01, 0.005],
            queues=[
                style_pb2.ConstraintQueue(
                    name="pin",
                    constraints=[
                        style_pb2.Constraint(kind=style_pb2.Constraint.KIND_POINT, radius_m=0.02)
                    ],
                )
            ],
        ),
        seed=2**60 + 1,
        wisp_count=200,
        strand_count=0,
    )
    return (
        style.with_map("length", value=0.3, by_polar=[(0, 1), (1.5, 0.5)])
        .with_map("density", image=np.eye(5))
        .with_prototype("curly", amplitude_m=0.004)
        .cut(front, length_m=0.1, plane=((0, -1, 0), 0.02))
        .wave(points=np.arange(12.0).reshape(4, 3), temperature=0.5)
        .comb(front, path=[(0, 0.1, 0), (0, 0.1, -0.1)], weight=0)
        .tie(point=(0, 0.12, -0.14))
        .braid(path=[(0, 0, -0.1), (0, -0.2, -0.1)], strand_count=5)
    )


def test_a_style_survives_json_and_files_and_is_stable(tmp_path):
    style = whole_style()
    text = style.to_json()
    again = mane.Style.from_json(text)
    assert again == style and again.to_json() == text
    style.save(tmp_path / "style.json")
    loaded = mane.Style.load(tmp_path / "style.json")
    assert loaded == style
    assert loaded.message.HasField("strand_count") and loaded.message.strand_count == 0
    assert loaded.message.operations[2].comb.HasField("weight")


def test_json_has_the_names_of_the_api_in_its_order_and_only_what_is_set():
    document = json.loads(whole_style().to_json())
    assert list(document) == [
        "seed", "wisp_count", "strand_count", "density", "length", "synthesis", "radii_m", "queues",
        "operations",
    ]  # fmt: skip
    assert document["length"]["by_polar"][1] == {"at": 1.5, "value": 0.5}
    assert document["seed"] == str(2**60 + 1)  # JSON's own numbers would lose digits.
    assert mane.Style().to_json() == "{}\n"


@pytest.mark.parametrize(
    ("text", "field", "says"),
    [
        ('{"lenght": {}}', "lenght", "did you mean length"),
        (
            '{"queues": [{}, {"constraints": [{"radus_m": 1}]}]}',
            "queues[1].constraints[0].radus_m",
            "did you mean radius_m",
        ),
        ('{"synthesis": {"prototype": {"xyz": 1}}}', "synthesis.prototype.xyz", "there are kind"),
        ('{"wisp_count": -1}', "wisp_count", "-1"),
        ('{"length": {"by_polar": [{"at": "x"}]}}', "length.by_polar[0].at", "x"),
        ('{"synthesis": {"prototype": {"kind": "LONG"}}}', "synthesis.prototype.kind", "LONG"),
        ('{"radii_m": [1, null]}', "radii_m[1]", "null"),
        ('{\n"seed": 1,\n', "json", "line 3"),
    ],
)
def test_what_is_wrong_in_a_file_is_named_by_file_and_field(tmp_path, text, field, says):
    file = tmp_path / "style.json"
    file.write_text(text)
    with pytest.raises(mane.InvalidArgument) as caught:
        mane.Style.load(file)
    assert violated(caught.value) == field
    told = str(caught.value)
    assert str(file) in told and field in told and says in told and "\n" not in told


def test_a_style_takes_fields_and_refuses_others():
    assert mane.Style(seed=3).message.seed == 3
    assert mane.Style(mane.Style(seed=3, wisp_count=5).message, seed=0).message.seed == 0
    with pytest.raises(mane.InvalidArgument, match="wisps"):
        mane.Style(wisps=3)
    with pytest.raises(mane.InvalidArgument):
        mane.Style(wisp_count=-1)


def test_operations_leave_the_style_as_it_is():
    style = mane.Style(seed=1)
    before = style.copy()
    path = [(0, 0, 0), (0, 1, 0)]
    for changed in (
        style.cut(length_m=0.1), style.wave(), style.comb(path=path), style.tie(point=(0, 1, 0)),
        style.braid(path=path), style.with_map("length", value=1), style.with_prototype("wavy"),
    ):  # fmt: skip
        assert style == before != changed
    assert style.copy() == style and style.copy().message is not style.message


def test_operations_say_what_they_are():
    cut, wave, comb, tie, braid = whole_style().message.operations
    assert cut.cut.length_m == 0.1
    assert (cut.cut.plane.normal.y, cut.cut.plane.offset_m) == (-1, 0.02)
    assert (cut.region.polar.low, cut.region.polar.high) == (0.2, 1.3)
    assert (cut.region.azimuth.low, cut.region.azimuth.high) == (-0.5, 0.5)
    assert cut.region.half_spaces[0].offset_m == 0.05 and list(cut.region.wisps) == [0, 3, 5]
    assert not wave.HasField("region")
    points = np.frombuffer(wave.wave.synthesis.prototype.points, "<f4")
    np.testing.assert_array_equal(points, np.arange(12))
    assert wave.wave.synthesis.temperature == 0.5
    assert comb.comb.path[1].z == -0.1 and comb.comb.weight == 0
    assert not mane.Style().comb(path=np.eye(3)).message.operations[0].comb.HasField("weight")
    assert tie.tie.point.y == 0.12 and tie.tie.radius_m == 0.015
    assert (braid.braid.strand_count, len(braid.braid.path)) == (5, 2)
    synthesis = whole_style().message.synthesis
    assert synthesis.prototype.kind == style_pb2.STRAND_KIND_CURLY
    assert synthesis.prototype.amplitude_m == 0.004


def test_every_strand_kind_of_the_api_is_known():
    known = {
        style_pb2.StrandKind.Name(
            mane.Style().with_prototype(kind).message.synthesis.prototype.kind
        )
        for kind in mane.StrandKind
    }
    assert known == set(style_pb2.StrandKind.keys()) - {"STRAND_KIND_UNSPECIFIED"}


@pytest.mark.parametrize(
    ("change", "field"),
    [
        (lambda style: style.comb(path=(0, 1, 0)), "path"),
        (lambda style: style.comb(path=[(0, 1, 0)]), "path"),
        (lambda style: style.braid(path=np.zeros((4, 2))), "path"),
        (lambda style: style.braid(path=[[0, 0, 0], [1]]), "path"),
        (lambda style: style.tie(point=(0, 1)), "point"),
        (lambda style: style.cut(plane=(0, 1, 0)), "plane"),
        (lambda style: style.cut(plane=((0, 1), 0.1)), "plane.normal"),
        (lambda style: style.wave(kind="bald"), "kind"),
        (lambda style: style.wave("curly"), "region"),
        (lambda style: style.wave(points=np.zeros(12)), "points"),
        (lambda style: style.cut(mane.Region(polar=(1, 2, 3)), length_m=1), "region.polar"),
        (lambda style: style.cut(mane.Region(azimuth=1), length_m=1), "region.azimuth"),
        (lambda style: style.cut(mane.Region(half_spaces=[(1, 2, 3)])), "region.half_spaces[0]"),
        (lambda style: style.cut(mane.Region(wisps=["a"])), "region.wisps"),
        (lambda style: style.cut(mane.Region(wisps=[-1])), "region.wisps"),
        (lambda style: style.cut(mane.Region(mask=np.zeros(3))), "region.mask"),
        (lambda style: style.with_map("colour"), "name"),
        (lambda style: style.with_map("length", by_polar=[1, 2]), "length.by_polar"),
        (lambda style: style.with_map("length", image=np.full((2, 2), 1.5)), "length.image"),
        (lambda style: style.with_map("length", image=np.full((2, 2), np.nan)), "length.image"),
        (lambda style: style.with_map("length", image=np.zeros((0, 2))), "length.image"),
        (lambda style: style.with_map("length", image=np.zeros((1, 4097))), "length.image"),
        (lambda style: style.with_map("length", image=__file__), "length.image"),
    ],
)
def test_wrong_shapes_are_refused_by_field(change, field):
    with pytest.raises(mane.InvalidArgument) as caught:
        change(mane.Style())
    assert violated(caught.value) == field


def test_a_map_takes_arrays_and_files_and_is_replaced_whole(tmp_path):
    values = np.array([[0.0, 0.2, 0.4], [0.6, 0.8, 1.0]])
    style = mane.Style().with_map("density", value=2, by_azimuth=[(-1, 0.5), (1, 1)], image=values)
    message = style.message.density
    assert message.value == 2 and message.by_azimuth[0].at == -1
    np.testing.assert_allclose(grey_png.decode(message.png), values, atol=1e-6)
    (tmp_path / "map.png").write_bytes(message.png)
    for image in (tmp_path / "map.png", str(tmp_path / "map.png"), message.png):
        again = style.with_map("density", image=image).message.density
        assert again.png == message.png
        assert not again.HasField("value") and not again.by_azimuth


def test_png_files_of_any_kind_are_numbers(tmp_path):
    def saved(image: Image.Image) -> np.ndarray:
        image.save(tmp_path / "x.png")
        return grey_png.decode((tmp_path / "x.png").read_bytes())

    grey = np.arange(256, dtype=np.uint8).reshape(16, 16)
    np.testing.assert_allclose(saved(Image.fromarray(grey)), grey / 255, atol=1e-6)
    np.testing.assert_allclose(saved(Image.fromarray(grey).convert("RGB")), grey / 255, atol=1e-6)
    wide = np.array([[0, 1, 40000, 65535]], np.uint16)
    np.testing.assert_allclose(saved(Image.fromarray(wide)), wide / 65535, atol=1e-6)
    half = Image.new("RGBA", (1, 1), (255, 0, 0, 51))
    np.testing.assert_allclose(saved(half), 0.2126 * 0.2, atol=1e-6)
    assert saved(Image.new("1", (2, 3), 1)).tolist() == [[1, 1]] * 3
    with pytest.raises(mane.InvalidArgument, match="not a readable PNG"):
        grey_png.decode(b"\x89PNG\r\n\x1a\n and no more")


def test_a_map_is_the_product_of_its_factors():
    style = mane.Style().with_map(
        "length",
        by_polar=[(0.5, 1), (1.5, 0.2)],
        by_azimuth=[(-3, 2), (0, 1), (3, 4)],
        image=np.full((1, 1), 1.0),
    )
    polar = np.array([0, 1.0, 3, 1, 1, 1])
    azimuth = np.array([0, 0, 0, 3, np.pi, -np.pi])
    # The nape lies half-way between the last stop and the first.
    expected = 0.25 * np.array([1, 0.6, 0.2, 0.6 * 4, 0.6 * 3, 0.6 * 3])
    values = scalp_maps.value_at(style.message.length, scalp_maps.UNSET["length"], polar, azimuth)
    np.testing.assert_allclose(values, expected, rtol=1e-6)


def test_a_drawn_map_shows_crown_forehead_and_the_heads_left():
    style = mane.Style().with_map(
        "density", by_azimuth=[(-2, 1), (-1, 0), (0, 0), (np.pi / 2, 1), (3, 1)]
    )
    picture = scalp_maps.drawn(style.message, "density", 64)
    assert picture.shape == (64, 64)
    assert picture[60, 32] < 0.1  # Forehead, at the bottom.
    assert picture[32, 60] > 0.95 and picture[32, 3] == pytest.approx(0.57, abs=0.05)
    polar = mane.Style().with_map("length", value=1, by_polar=[(0, 0), (np.pi, 1)])
    picture = scalp_maps.drawn(polar.message, "length", 64)
    np.testing.assert_allclose(picture[32, 32:], np.hypot(0.5, np.arange(32) + 0.5) / 32, atol=1e-6)
    assert picture[0, 0] == 1  # Outside the circle: straight down.


def test_a_drawn_map_given_back_is_the_same_map():
    style = mane.Style().with_map("protrusion", by_polar=[(0, 1), (2, 0.3)])
    drawn = scalp_maps.drawn(style.message, "protrusion")
    white = drawn.max()
    again = mane.Style().with_map("protrusion", value=white, image=drawn / white)
    np.testing.assert_allclose(
        scalp_maps.drawn(again.message, "protrusion"), drawn, atol=white / 255
    )
    with pytest.raises(mane.InvalidArgument, match="must be one of density, length, protrusion"):
        scalp_maps.drawn(style.message, "colour")
