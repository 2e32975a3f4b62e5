"""Hairstyles on a real daemon: hair as arrays, the groom it becomes, errors, the command."""

from __future__ import annotations

import asyncio
import time

import numpy as np
import pytest
from PIL import Image

import mane
import mane.aio
from mane import grey_png, scalp_maps, style_messages
from mane.hairstyle import Hairstyle
from mane.style import GUIDES
from mane.v1 import style_pb2
from test_cli import run

WISPS, STRANDS, LENGTH_M = 200, 2000, 0.12
HEAD = mane.Ellipsoid((0.08, 0.11, 0.09), cap_angle=1.3)


def small(**fields) -> mane.Style:
    """A style of few wisps of short hair in two colours."""
    style = mane.Style(**{"seed": 5, "wisp_count": WISPS, "strand_count": STRANDS} | fields)
    style.message.segment_length_m = 0.015
    style.message.colour.hue.uniform.high = 0.1
    style.message.colour.saturation.constant.value = 1
    style.message.colour.value.constant.value = 1
    return style.with_map("length", value=LENGTH_M, by_polar=[(0, 1), (1.5, 0.7)])


@pytest.fixture(scope="module")
def styled(maned):
    """The style on an ellipsoid, done: its job, its hair and its groom."""
    with mane.Client(maned.address) as client:
        job = client.apply_style(small(), scalp=HEAD, groom_id="styled", display_name="Small")
        job = list(client.watch_job(job))[-1].require_success()
        yield job, client.read_hairstyle(job), client.get_groom("styled")
        client.delete_groom("styled")


def finish(client: mane.Client, job: mane.Job) -> Hairstyle:
    list(client.watch_job(job))[-1].require_success()
    return client.read_hairstyle(job)


def drop(client: mane.Client, hairstyle: Hairstyle) -> None:
    client.delete_groom(hairstyle.report.groom)


def assert_sound(hairstyle: Hairstyle, style: mane.Style) -> None:
    """What holds of every hairstyle."""
    masters, members, report = hairstyle.masters, hairstyle.members, hairstyle.report
    count = len(masters.lengths)
    assert report.wisp_count == count <= style.message.wisp_count
    assert len(masters.joint_counts) == count
    assert masters.joint_counts.sum() == len(masters.outline) == len(masters.points)
    assert report.strand_count == len(members.wisps) == len(members.colours)
    assert members.point_counts.sum() == len(members.points) == report.control_point_count
    assert members.point_counts.min() >= 2 and members.wisps.max() < count
    assert np.all(np.diff(members.wisps.astype(int)) >= 0)
    for points in (masters.points, members.points, hairstyle.density.values):
        assert np.isfinite(points).all()
    steps = np.linalg.norm(np.diff(masters.outline[: masters.joint_counts[0]], axis=0), axis=1)
    np.testing.assert_allclose(steps, style.message.segment_length_m, rtol=1e-3)


def test_hair_comes_as_arrays(styled):
    job, hairstyle, _ = styled
    assert job.kind == "style" and job.progress == 1 and job.result_bytes > 0
    assert_sound(hairstyle, small())
    masters, members = hairstyle.masters, hairstyle.members
    assert len(masters.lengths) == WISPS and len(members.wisps) == STRANDS
    assert 0.69 * LENGTH_M <= masters.lengths.min() < masters.lengths.max() <= 1.001 * LENGTH_M
    # Ten a wisp, by chance: few have none.
    assert (np.bincount(members.wisps, minlength=WISPS) > 0).mean() > 0.95
    roots = members.points[members.first_point[:-1]]
    np.testing.assert_allclose(np.linalg.norm(roots / HEAD.radii_m, axis=1), 1, atol=0.02)
    # Red to yellow, no two wisps alike for long.
    assert (members.colours[:, 0] == 255).all() and (members.colours[:, 2] == 0).all()
    assert len(np.unique(members.colours[:, 1])) > 50
    lowest, highest = members.points.min(axis=0), members.points.max(axis=0)
    top = hairstyle.density.low + hairstyle.density.cell_m * np.array(
        hairstyle.density.values.shape[::-1]
    )
    assert (hairstyle.density.low <= lowest + 0.05).all() and (top >= highest - 0.05).all()
    assert hairstyle.density.values.max() > 0
    # Gravity, of which the style says nothing else.
    assert (hairstyle.field.values == np.float32([0, -1, 0])).all()


def test_maps_come_back_as_they_are_drawn_here(styled):
    _, hairstyle, _ = styled
    assert set(hairstyle.maps) == set(scalp_maps.UNSET)
    for name, values in hairstyle.maps.items():
        assert values.shape == (512, 512)
        mine = scalp_maps.drawn(small().message, name)
        np.testing.assert_allclose(values, mine, atol=0.6 * mine.max() / 255)


def test_the_groom_opens_as_a_head_and_moves(client, styled):
    _, hairstyle, groom = styled
    assert hairstyle.report.groom == groom.name == "grooms/styled"
    assert groom.display_name == "Small" and groom.has_scalp
    assert groom.guide_count == WISPS and groom.hair_count == STRANDS
    whole = client.export_groom(groom)
    assert len(whole.hairs) == STRANDS
    np.testing.assert_array_equal(whole.hairs.colours, hairstyle.members.colours)
    first = hairstyle.masters.points[hairstyle.masters.first_joint[:-1]]
    with client.open_head(groom, "lockstep") as head:
        still = head.step(mane.Pose(0)).positions
        np.testing.assert_allclose(still[:, 0], first, atol=1e-3)
        moved = [head.step(mane.Pose(k / 60, (0.1 * k, 0, 0))) for k in range(1, 10)][-1]
    bent = moved.positions - still - np.float32([0.9, 0, 0])
    assert np.abs(bent[:, 0]).max() < 1e-4 < 0.01 < np.abs(bent[:, -1]).max()


def test_the_same_style_makes_the_same_bits_and_another_seed_others(client, styled):
    _, first, groom = styled
    again = finish(client, client.apply_style(small(), scalp=HEAD))
    for name in ("masters", "members", "density", "field"):
        for key, value in vars(getattr(first, name)).items():
            np.testing.assert_array_equal(value, getattr(getattr(again, name), key), key)
    assert client.get_groom(again.report.groom).guide_count == groom.guide_count
    drop(client, again)
    other = finish(client, client.apply_style(small(seed=6), scalp=HEAD))
    assert not np.array_equal(other.masters.outline[:100], first.masters.outline[:100])
    drop(client, other)


def test_a_dressed_style_on_the_mannequin(client):
    behind = (0, 0.1, -0.16)
    front = mane.Region(azimuth=(-0.8, 0.8))
    style = (
        small()
        .with_map("length", value=0.25)
        .with_map("density", image=np.linspace(0.5, 1, 64).reshape(8, 8))
        .wave(front, kind="curly", amplitude_m=0.005, period_m=0.08)
        .cut(front, length_m=0.06)
        .tie(mane.Region(azimuth=(1.5, -1.5)), point=behind, radius_m=0.02)
    )
    job = client.apply_style(
        style,
        scalp=mane.mesh.mannequin(),
        scalp_contact=mane.ScalpContact("skin"),
        bodies=[mane.Body("pearl", mane.EllipsoidBody((0.02, 0.02, 0.02)))],
        groom_id="dressed",
    )
    hairstyle = finish(client, job)
    assert_sound(hairstyle, style)
    masters, outcomes = hairstyle.masters, hairstyle.report.outcomes
    assert len(outcomes) == 1 and 0 < outcomes[0].met <= outcomes[0].selected < WISPS
    last = masters.first_joint[1:] - 1
    roots = masters.points[masters.first_joint[:-1]]
    in_front = (np.abs(roots[:, 0]) < 0.03) & (roots[:, 2] > 0.06)
    assert in_front.any() and masters.lengths[in_front].max() <= 0.0601
    assert masters.lengths[roots[:, 2] < -0.05].min() > 0.2
    near = np.array(
        [
            np.linalg.norm(masters.points[a : b + 1] - behind, axis=1).min()
            for a, b in zip(masters.first_joint[:-1], last, strict=True)
        ]
    )
    assert (near < 0.025).sum() >= 0.8 * outcomes[0].met
    groom = client.get_groom("dressed")
    assert groom.scalp_contact is not None and groom.body_count == 1
    client.delete_groom(groom)


def test_a_repeated_request_gets_the_same_job(client):
    requests = list(style_messages.apply_style(small(), GUIDES, HEAD, None, (), "", "again"))
    first, second = (client._styling.ApplyStyle(iter(requests)) for _ in range(2))
    assert first.name == second.name
    hairstyle = finish(client, first.name)
    assert client._styling.ApplyStyle(iter(requests)).name == first.name
    drop(client, hairstyle)


def test_a_running_style_can_be_cancelled_within_a_second_and_not_read(client):
    long = small(wisp_count=3000, strand_count=300_000).with_map("length", value=0.5)
    job = client.apply_style(long, scalp=HEAD, groom_id="never")
    for now in client.watch_job(job):
        if now.state == mane.JobState.RUNNING:
            break
    with pytest.raises(mane.FailedPrecondition):
        client.read_hairstyle(job)
    begin = time.monotonic()
    client.cancel_job(job)
    *_, last = client.watch_job(job)
    assert last.state == mane.JobState.CANCELLED and time.monotonic() - begin < 1.5
    with pytest.raises(mane.FailedPrecondition):
        client.read_hairstyle(job)
    with pytest.raises(mane.NotFound):
        client.get_groom("never")


def bad(change) -> mane.Style:
    style = small()
    change(style.message)
    return style


@pytest.mark.parametrize(
    ("style", "field"),
    [
        (small(wisp_count=20_001), "header.style.wisp_count"),
        (small(fuzziness=2), "header.style.fuzziness"),
        (small().with_map("length", value=6), "header.style.length.value"),
        (
            small().with_map("length", by_polar=[(1, 1), (0.5, 1)]),
            "header.style.length.by_polar[1].at",
        ),
        (
            bad(
                lambda message: message.queues.add(
                    constraints=[style_pb2.Constraint(kind=1, path=[{"x": 0}], radius_m=-1)]
                )
            ),
            "header.style.queues[0].constraints[0].radius_m",
        ),
        (bad(lambda message: message.field.add(kind=1, strength=1e9)), "header.style.field[0]"),
        (
            small().braid(path=[(0, 0, 0), (0, -1, 0)], strand_count=10),
            "header.style.operations[0]",
        ),
        (
            small().tie(mane.Region(polar=(0, 4)), point=(0, 0.1, 0)),
            "header.style.operations[0].region.polar",
        ),
    ],
)
def test_errors_name_fields(client, style, field):
    with pytest.raises(mane.InvalidArgument) as caught:
        client.apply_style(style, scalp=HEAD)
    assert caught.value.field_violations[0].field.startswith(field)


def test_a_style_needs_a_scalp_and_a_free_name(client, styled):
    with pytest.raises(mane.InvalidArgument, match="scalp"):
        client.apply_style(small(), scalp=None)
    with pytest.raises((mane.AlreadyExists, mane.JobFailed), match="styled"):
        job = client.apply_style(small(), scalp=HEAD, groom_id="styled")
        finish(client, job)
    with pytest.raises(mane.NotFound):
        client.read_hairstyle("nothing")


def test_presets_are_styles_that_are_documents(client):
    presets = client.style_presets()
    assert presets and len({preset.name for preset in presets}) == len(presets)
    for preset in presets:
        assert preset.description.endswith(".")
        assert type(preset.style).from_json(preset.style.to_json()) == preset.style


def test_asyncio_makes_styles(maned, styled):
    _, first, _ = styled

    async def run_it():
        async with mane.aio.Client(maned.address) as client:
            job = await client.apply_style(small(), scalp=HEAD)
            [update async for update in client.watch_job(job)][-1].require_success()
            hairstyle = await client.read_hairstyle(job)
            await client.delete_groom(hairstyle.report.groom)
            return hairstyle, await client.style_presets()

    hairstyle, presets = asyncio.run(asyncio.wait_for(run_it(), 60))
    np.testing.assert_array_equal(hairstyle.members.points, first.members.points)
    assert presets


def test_the_command_makes_pictures_and_files(client, maned, tmp_path):
    server = maned.address
    document, npz, image = (tmp_path / name for name in ("style.json", "hair.npz", "hair.png"))
    small().save(document)
    told = run("style", "apply", str(document), "-o", "cli-style", "--strands", "500",
               "--wisps", "50", "--picture", str(image), "--npz", str(npz),
               server=server)  # fmt: skip
    assert "grooms/cli-style: 50 guides, 500 hairs" in told and "seconds" in told
    assert "cli-style" in run("groom", "list", server=server)
    hairstyle = Hairstyle.load(npz)
    assert len(hairstyle.members.wisps) == 500
    with Image.open(image) as picture:
        pixels = np.asarray(picture).astype(int)
        assert picture.size == (1920, 640)
    assert ((pixels[..., 0] > 90) & (pixels[..., 2] < 60)).sum() > 2000  # Red hair.

    name = next(word for word in told.split() if word.startswith("jobs/"))
    run("style", "picture", name, "-o", str(tmp_path / "again.png"), server=server)
    assert (tmp_path / "again.png").read_bytes()
    run("style", "picture", str(npz), "-o", str(tmp_path / "small.png"), "--size", "96")
    said = run("style", "map", name, "length", "-o", str(tmp_path / "job.png"), server=server)
    assert "white is 0.119" in said and "style.with_map('length', value=0.119" in said
    run("style", "map", str(document), "length", "-o", str(tmp_path / "here.png"))
    one, other = (
        grey_png.decode((tmp_path / name).read_bytes()) for name in ("job.png", "here.png")
    )
    np.testing.assert_allclose(one, other, atol=1.1 / 255)
    client.delete_groom("cli-style")


def test_the_command_shows_presets(client, maned, tmp_path):
    preset = client.style_presets()[0]
    assert preset.name in run("style", "presets", server=maned.address)
    run("style", "show", preset.name, "-o", str(tmp_path / "x.json"), server=maned.address)
    assert mane.Style.load(tmp_path / "x.json") == preset.style
    shown = run("style", "show", preset.name, server=maned.address)
    assert mane.Style.from_json(shown) == preset.style
    text = run("style", "show", "bald", server=maned.address, code=1)
    assert "there is no preset 'bald'" in text and preset.name in text


def test_a_wrong_field_in_a_document_ends_with_1(tmp_path):
    (tmp_path / "x.json").write_text('{"wisps": 3}')
    text = run("style", "apply", str(tmp_path / "x.json"), "-o", "x",
               server="127.0.0.1:1", code=1)  # fmt: skip
    assert "x.json: wisps: there is no such field; did you mean" in text and text.count("\n") == 1
