"""Styles by beams as documents: JSON there and back, which kind a file is of, operations."""

from __future__ import annotations

import json

import pytest

import mane
from mane import style_messages
from mane.style import GUIDES
from mane.v1 import beam_style_pb2, style_pb2

FRONT = mane.PoreRegion(zenith=(0.4, 1.1), azimuth=(-0.7, 0.7))


def violated(error: mane.Error) -> str:
    return error.field_violations[0].field


def whole_style() -> mane.BeamStyle:
    """A style in which much is set."""
    return (
        mane.BeamStyle(seed=2**60 + 1, guide_count=40, gravity_m_s2=0)
        .with_part("all", pores=FRONT, hair_count=50, length_m=0.2, spread="uniform")
        .with_part("tail", tied_at=(0, 0.1, -0.12), tied_along=(0, 1, -1), tied_radius_m=0.02)
        .comb(point=(0, 0.3, -0.3), where=[((0, 1, 0), 0.05)])
        .comb(FRONT, point=(0, 0, 1), strength_m_s2=9, softening_m=0.1, part="all")
        .draw(point=(0, -1, 0), strength_m_s2=3)
        .force(acceleration=(0, 0, -5), part="tail")
        .cut(FRONT, height_m=0.0)
        .cut(by_pore=((-0.04, 0.01), (0.1, 0.1)), keep=[((1, 0, 0), -0.2)], part="all")
    )


def test_a_style_survives_json_and_files_and_is_stable(tmp_path):
    style = whole_style()
    text = style.to_json()
    again = mane.BeamStyle.from_json(text)
    assert again == style and again.to_json() == text
    style.save(tmp_path / "style.json")
    loaded = mane.BeamStyle.load(tmp_path / "style.json")
    assert loaded == style and mane.load_style(tmp_path / "style.json") == style
    assert loaded.message.HasField("gravity_m_s2") and loaded.message.gravity_m_s2 == 0
    assert style.copy() == style and style.copy().message is not style.message
    assert eval(repr(style), {"BeamStyle": mane.BeamStyle}) == style


def test_a_file_says_which_kind_it_is(tmp_path):
    document = json.loads(whole_style().to_json())
    assert list(document) == ["beam_style"]
    assert list(document["beam_style"]) == [
        "seed", "gravity_m_s2", "parts", "forces", "cuts", "guide_count",
    ]  # fmt: skip
    assert mane.BeamStyle().to_json() == '{\n  "beam_style": {}\n}\n'
    wisps = mane.Style(seed=3)
    wisps.save(tmp_path / "wisps.json")
    assert mane.load_style(tmp_path / "wisps.json") == wisps
    with pytest.raises(mane.InvalidArgument, match="wisps.json.*is a Style"):
        mane.BeamStyle.load(tmp_path / "wisps.json")
    with pytest.raises(mane.InvalidArgument, match="is a BeamStyle"):
        mane.Style.from_json(whole_style().to_json())
    assert whole_style() != wisps and wisps != whole_style()


@pytest.mark.parametrize(
    ("text", "field", "says"),
    [
        ('{"beam_style": {"part": []}}', "beam_style.part", "did you mean parts"),
        (
            '{"beam_style": {"parts": [{}, {"cuts": [{"hight_m": 1}]}]}}',
            "beam_style.parts[1].cuts[0].hight_m",
            "did you mean height_m",
        ),
        (
            '{"beam_style": {"parts": [{"spread": "THICK"}]}}',
            "beam_style.parts[0].spread",
            "THICK",
        ),
        ('{"beam_style": {"guide_count": -1}}', "beam_style.guide_count", "-1"),
        ('{"beam_style": {}, "seed": 3}', "seed", "must not stand beside beam_style"),
        ('{"beam_style": 3}', "beam_style", "must be an object"),
        ('{"beam_style": {},\n', "json", "line 2"),
    ],
)
def test_what_is_wrong_in_a_file_is_named_by_file_and_field(tmp_path, text, field, says):
    file = tmp_path / "style.json"
    file.write_text(text)
    with pytest.raises(mane.InvalidArgument) as caught:
        mane.load_style(file)
    assert violated(caught.value) == field
    told = str(caught.value)
    assert str(file) in told and field in told and says in told and "\n" not in told


def test_operations_leave_the_style_as_it_is():
    style = mane.BeamStyle(seed=1).with_part("all")
    before = style.copy()
    for changed in (
        style.with_part("more"), style.with_hair_count(5), style.cut(height_m=0),
        style.comb(point=(0, 1, 0)), style.draw(point=(0, 1, 0)),
        style.force(acceleration=(0, 1, 0)), style.cut(height_m=0, part="all"),
    ):  # fmt: skip
        assert style == before != changed


def test_operations_say_what_they_are():
    message = whole_style().message
    everything, tail = message.parts
    assert (everything.name, everything.hair_count, everything.length_m) == ("all", 50, 0.2)
    assert everything.spread == beam_style_pb2.BeamPart.SPREAD_UNIFORM
    assert (everything.pores.zenith.low, everything.pores.azimuth.high) == (0.4, 0.7)
    assert (tail.tied_at.z, tail.tied_along.y, tail.tied_radius_m) == (-0.12, 1, 0.02)
    assert not tail.HasField("hair_count") and not everything.HasField("tied_at")
    around, toward = message.forces
    assert around.kind == beam_style_pb2.BeamForce.KIND_AROUND
    assert around.where[0].offset_m == 0.05 and around.strength_m_s2 == 25
    assert toward.kind == beam_style_pb2.BeamForce.KIND_TOWARD and toward.point.y == -1
    combed, pushed = everything.forces[0], tail.forces[0]
    assert (combed.strength_m_s2, combed.softening_m, combed.pores.zenith.high) == (9, 0.1, 1.1)
    assert pushed.kind == beam_style_pb2.BeamForce.KIND_UNIFORM and pushed.acceleration.z == -5
    assert message.cuts[0].HasField("height_m") and message.cuts[0].pores.zenith.low == 0.4
    by_pore = everything.cuts[0].by_pore
    assert (by_pore.low_y_m, by_pore.low_length_m) == (-0.04, 0.01)
    assert (by_pore.high_y_m, by_pore.high_length_m) == (0.1, 0.1)
    assert everything.cuts[0].keep[0].normal.x == 1
    assert not everything.cuts[0].HasField("height_m")


def test_hair_counts_keep_their_shares():
    style = mane.BeamStyle().with_part("a", hair_count=1000).with_part("b")  # 10,000 of it.
    counts = [part.hair_count for part in style.with_hair_count(1100).message.parts]
    assert counts == [100, 1000]
    assert [part.hair_count for part in style.with_hair_count(2).message.parts] == [1, 2]
    for count in (1, 0):
        with pytest.raises(mane.InvalidArgument, match="at least 1"):
            style.with_hair_count(count)


@pytest.mark.parametrize(
    ("change", "field"),
    [
        (lambda style: style.with_part(length=3), "part"),
        (lambda style: style.with_part(hair_count=-3), "part"),
        (lambda style: style.with_part(spread="thick"), "spread"),
        (lambda style: style.with_part(pores=(0, 1)), "pores"),
        (lambda style: style.with_part(pores=mane.PoreRegion(zenith=1)), "pores.zenith"),
        (lambda style: style.with_part(tied_at=(0, 1)), "tied_at"),
        (lambda style: style.comb(point=(0, 1)), "point"),
        (lambda style: style.comb(point=(0, 1, 0), part="tail"), "part"),
        (lambda style: style.comb(point=(0, 1, 0), where=[(1, 2, 3)]), "where[0]"),
        (lambda style: style.force(acceleration=3), "acceleration"),
        (lambda style: style.cut(by_pore=(1, 2)), "by_pore"),
        (lambda style: style.cut(keep=[((0, 1), 0.1)]), "keep[0].normal"),
        (lambda style: style.cut(mane.Region(), height_m=1), "pores"),
    ],
)
def test_wrong_shapes_are_refused_by_field(change, field):
    with pytest.raises(mane.InvalidArgument) as caught:
        change(mane.BeamStyle())
    assert violated(caught.value) == field


def test_a_style_takes_fields_and_refuses_others():
    with pytest.raises(mane.InvalidArgument) as caught:
        mane.BeamStyle(wisp_count=3)
    assert violated(caught.value) == "beam_style"


def test_uploads_hold_the_kind_of_style_that_was_given():
    head = mane.Ellipsoid((0.08, 0.11, 0.09))
    for style, other in ((whole_style(), "style"), (mane.Style(seed=4), "beam_style")):
        first = next(style_messages.apply_style(style, GUIDES, head, None, (), "", ""))
        assert getattr(first.header, style.NAME) == style.message
        assert not first.header.HasField(other)
    assert isinstance(first, style_pb2.ApplyStyleRequest)
