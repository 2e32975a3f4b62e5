"""Hairstyles by beams on a real daemon: hair as arrays, their groom, errors, the command."""

from __future__ import annotations

import asyncio
import time

import numpy as np
import pytest
from PIL import Image

import mane
import mane.aio
from mane.hairstyle import Hairstyle
from test_cli import run

GUIDES, HAIRS = 12, 600
HEAD = mane.Ellipsoid((0.08, 0.11, 0.09))


def small(**fields) -> mane.BeamStyle:
    """Short hair and a tail."""
    return (
        mane.BeamStyle(**{"seed": 5, "guide_count": GUIDES} | fields)
        .with_part("all", pores=mane.PoreRegion(zenith=(0, 1.4)), hair_count=500, length_m=0.1)
        .with_part("tail", tied_at=(0, 0.03, -0.1), hair_count=100, length_m=0.2, segment_count=10)
        .cut(height_m=-0.05, part="all")
    )


def finish(client: mane.Client, job: mane.Job) -> Hairstyle:
    list(client.watch_job(job))[-1].require_success()
    return client.read_hairstyle(job)


@pytest.fixture(scope="module")
def styled(maned):
    """The style on an ellipsoid, done: its hair and its groom."""
    with mane.Client(maned.address) as client:
        hairstyle = finish(client, client.apply_style(small(), scalp=HEAD, groom_id="beams"))
        yield hairstyle, client.get_groom("beams")
        client.delete_groom("beams")


def test_hair_comes_as_arrays(styled):
    hairstyle, _ = styled
    masters, members, report = hairstyle.masters, hairstyle.members, hairstyle.report
    assert (report.wisp_count, report.strand_count) == (GUIDES, HAIRS)
    assert report.seconds_guides > 0 and report.missed == ()
    assert hairstyle.density is None and hairstyle.field is None and hairstyle.maps == {}
    assert len(masters.lengths) == GUIDES and len(members.colours) == HAIRS
    roots = members.points[members.first_point[:-1]]
    tied = roots[:, 2] < -0.095
    assert tied.sum() == 100
    np.testing.assert_allclose(np.linalg.norm(roots[~tied] / HEAD.radii_m, axis=1), 1, atol=1e-5)
    # Nothing is within the head.
    assert np.linalg.norm(members.points / HEAD.radii_m, axis=1).min() > 1 - 1e-5
    assert members.points[:, 1][np.repeat(~tied, members.point_counts)].min() > -0.05 - 1e-6
    # Guides are hairs, and none has fewer points than what rides on it.
    strands = members.strands()
    for guide, points in enumerate(np.split(masters.points, masters.first_joint[1:-1])):
        riding = [strands[hair] for hair in np.flatnonzero(members.wisps == guide)]
        assert any(np.array_equal(points, hair) for hair in riding)
        assert max(map(len, riding)) == len(points)


def test_colours_are_dark_brown_of_many_shades(styled):
    colours = styled[0].members.colours.astype(int)
    red, green, blue = colours.T
    assert np.all(red >= green) and np.all(green >= blue)
    assert 50 < red.mean() < 100 and red.std() > 5


def test_hair_that_is_drawn_back_stands_without_what_draws_it(client):
    presets = {preset.name: preset.style for preset in client.style_presets()}
    style = mane.BeamStyle(presets["beam-swept-back"].message, guide_count=30)
    finish(client, client.apply_style(style, scalp=mane.mesh.mannequin(), groom_id="drawn-back"))
    summary = client.import_report("drawn-back").summary
    client.delete_groom("drawn-back")
    assert summary.largest_stiffness_factor > 4
    assert summary.not_held_count == 0


def test_the_groom_opens_as_a_head_that_holds_the_hair(client, styled):
    hairstyle, groom = styled
    assert hairstyle.report.groom == groom.name
    assert groom.guide_count == GUIDES and groom.hair_count == HAIRS
    with client.open_head(groom, "lockstep", points_per_guide=64) as head:
        still = head.step(mane.Pose(0))
        later = [head.step(mane.Pose(k / 60)) for k in range(1, 31)][-1]
    first = hairstyle.masters.points[hairstyle.masters.first_joint[:-1]]
    np.testing.assert_allclose(still.positions[:, 0], first, atol=1e-3)
    # Held: it does not sag.
    assert np.abs(later.positions - still.positions).max() < 2e-3


def test_on_a_mesh_hair_begins_at_the_skin(client):
    head = mane.mesh.mannequin()
    style = mane.BeamStyle(guide_count=5).with_part(
        pores=mane.PoreRegion(zenith=(0, 0.8)), hair_count=50, length_m=0.05
    )
    hairstyle = finish(client, client.apply_style(style, scalp=head, groom_id="on-skin"))
    assert np.all(hairstyle.members.point_counts == 22)
    from scipy.spatial import cKDTree

    roots = hairstyle.members.points[hairstyle.members.first_point[:-1]]
    # Vertices of the mannequin are some 5 mm apart.
    assert cKDTree(head.vertices).query(roots)[0].max() < 6e-3
    client.delete_groom("on-skin")


def test_the_same_style_makes_the_same_bits_and_another_seed_others(client, styled):
    first, _ = styled
    again = finish(client, client.apply_style(small(), scalp=HEAD))
    for key, value in vars(first.members).items():
        np.testing.assert_array_equal(value, getattr(again.members, key), key)
    other = finish(client, client.apply_style(small(seed=6), scalp=HEAD))
    assert not np.array_equal(other.members.points[:100], first.members.points[:100])
    for made in (again, other):
        client.delete_groom(made.report.groom)


def test_a_running_style_can_be_cancelled_within_a_second(client):
    many = small(guide_count=2000).with_hair_count(200_000)
    job = client.apply_style(many, scalp=HEAD, groom_id="never")
    for now in client.watch_job(job):
        if now.state == mane.JobState.RUNNING:
            break
    begin = time.monotonic()
    client.cancel_job(job)
    *_, last = client.watch_job(job)
    assert last.state == mane.JobState.CANCELLED and time.monotonic() - begin < 1.5
    with pytest.raises(mane.NotFound):
        client.get_groom("never")


@pytest.mark.parametrize(
    ("style", "field"),
    [
        (mane.BeamStyle(), "header.beam_style.parts"),
        (small(guide_count=0), "header.beam_style.guide_count"),
        (small().with_part(length_m=6), "header.beam_style.parts[2].length_m"),
        (small().cut(), "header.beam_style.cuts[0].height_m"),
        (
            small().cut(mane.PoreRegion(zenith=(2, 1)), height_m=0, part="tail"),
            "header.beam_style.parts[1].cuts[0].pores.zenith.low",
        ),
        (small().comb(point=(0, 1, 0), strength_m_s2=-1), "header.beam_style.forces[0].strength_m"),
    ],
)
def test_errors_name_fields(client, style, field):
    with pytest.raises(mane.InvalidArgument) as caught:
        client.apply_style(style, scalp=HEAD)
    assert caught.value.field_violations[0].field.startswith(field)


def test_what_does_not_fit_the_head_fails_the_job(client):
    for style, field in (
        (small().with_part(tied_at=(0, 0, 0)), r"parts\[2\].tied_at"),
        (small().cut(height_m=1), r"cuts\[0\]"),
    ):
        with pytest.raises(mane.JobFailed, match=field):
            finish(client, client.apply_style(style, scalp=HEAD))


def test_asyncio_makes_styles(maned, styled):
    async def run_it():
        async with mane.aio.Client(maned.address) as client:
            job = await client.apply_style(small(), scalp=HEAD)
            [update async for update in client.watch_job(job)][-1].require_success()
            hairstyle = await client.read_hairstyle(job)
            await client.delete_groom(hairstyle.report.groom)
            return hairstyle, await client.style_presets()

    hairstyle, presets = asyncio.run(asyncio.wait_for(run_it(), 60))
    np.testing.assert_array_equal(hairstyle.members.points, styled[0].members.points)
    beams = [preset.name for preset in presets if isinstance(preset.style, mane.BeamStyle)]
    assert len(beams) == 5 and all(name.startswith("beam-") for name in beams)


def test_the_command_makes_pictures_and_files(client, maned, tmp_path):
    server = maned.address
    document, npz, image = (tmp_path / name for name in ("style.json", "hair.npz", "hair.png"))
    run("style", "show", "beam-short", "-o", str(document), server=server)
    told = run("style", "apply", str(document), "-o", "cli-beams", "--strands", "500",
               "--wisps", "20", "--picture", str(image), "--npz", str(npz),
               server=server)  # fmt: skip
    assert "grooms/cli-beams: 20 guides, 500 hairs" in told
    assert "members" in told and "crowded" not in told
    hairstyle = Hairstyle.load(npz)
    assert len(hairstyle.members.wisps) == 500 and hairstyle.density is None
    with Image.open(image) as picture:
        assert picture.size == (1920, 640)
    name = next(word for word in told.split() if word.startswith("jobs/"))
    run("style", "picture", name, "-o", str(tmp_path / "again.png"), "--size", "96", server=server)
    for made in (name, "beam-short", str(document)):
        text = run("style", "map", made, "length", "-o", str(tmp_path / "x.png"), server=server,
                   code=1)  # fmt: skip
        assert "beams, which have no maps" in text
    client.delete_groom("cli-beams")
