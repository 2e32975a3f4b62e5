"""Any hair in, no sag: strands go in as points, and stay there when the head is animated."""

from __future__ import annotations

import asyncio

import numpy as np
import pytest
from scipy.spatial import cKDTree

import mane
import mane.aio
from conftest import Daemon, make_guide, start_daemon, stop_daemon

SETTLE_S, RATE_HZ, POINTS = 5.0, 60.0, 256
# Beyond the fit: float32 animation, chords between the points of a frame, and the drift of what is
# nearly soft enough to buckle [m].
TOLERANCE_M = 1e-4


@pytest.fixture
def keep(client):
    """Imports strands into grooms that are deleted after the test."""
    kept = []

    def create(strands, groom_id="", scalp=None, **options) -> mane.Groom:
        groom = client.create_groom(
            strands=strands,
            import_options=mane.ImportOptions(**options),
            groom_id=groom_id,
            scalp=scalp,
        )
        kept.append(groom)
        return groom

    yield create
    for groom in kept:
        client.delete_groom(groom)


def at_rest(client, hair_type: str, length_m: float, points: int, count: int = 8):
    """Strands of generated hair in its rest shape: roots in all directions of a scalp."""
    generate = mane.GuideGeneration(hair_type, count, length_m, seed=3, root_droop=0.6)
    scalp = mane.Ellipsoid((0.08, 0.1, 0.09), cap_angle=1.5)
    groom = client.create_groom(scalp=scalp, generate=generate)
    rest = client.rest_shape(groom, points_per_guide=points)
    client.delete_groom(groom)
    return list(rest.positions)


def coils(points: int, noise_m: float = 0.0, count: int = 6):
    """Hanging coils of two turns, wider toward the tip, with noisy points."""
    rng = np.random.default_rng(5)
    t = np.linspace(0, 1, points)
    strands = []
    for phase in np.linspace(0, 5, count):
        angle, radius = phase + 4 * np.pi * t, 0.006 + 0.006 * t
        axis = np.stack([0.1 * np.cos(phase) + 0 * t, -0.16 * t, 0.1 * np.sin(phase) + 0 * t], 1)
        round_it = np.stack([np.cos(angle), 0 * t, np.sin(angle)], 1)
        strands.append(axis + radius[:, None] * round_it + rng.normal(0, noise_m, (points, 3)))
    return strands


def arcs(points: int, count: int = 6):
    """Hair that leaves the head upright, or tilted, turns over, and hangs down."""
    t = np.linspace(0, 1, points)
    strands = []
    for tilt, around in zip(np.linspace(0, 1.2, count), np.linspace(0, 5, count), strict=True):
        # The direction turns from upward, tilted, to nearly straight down within a third.
        angle = np.pi / 2 - tilt - (np.pi * 0.98 - tilt) * (1 - np.exp(-((5 * t) ** 2)))
        step = 0.15 * np.stack([np.cos(angle), np.sin(angle), 0.2 * np.sin(3 * t)], 1) / points
        way = np.concatenate([np.zeros((1, 3)), np.cumsum(step[:-1], axis=0)])
        turn = np.array(
            [[np.cos(around), 0, np.sin(around)], [0, 1, 0], [-np.sin(around), 0, np.cos(around)]]
        )
        strands.append((way + np.array((0.03, 0.1, 0))) @ turn.T)
    return strands


def settle(client, groom) -> np.ndarray:
    """Positions after five seconds on a head that stands still, (strand, point, 3)."""
    options = {"points_per_guide": POINTS}
    with client.open_head(groom, "lockstep", **options) as head:
        for step in range(round(SETTLE_S * RATE_HZ) + 1):
            frame = head.step(mane.Pose(step / RATE_HZ))
    return frame.positions.astype(np.float64)


def deviations(strands, positions) -> np.ndarray:
    """Farthest of each strand's points from where it is now, tips from tips, (strand,) [m]."""
    far = []
    for given, now in zip(strands, positions, strict=True):
        fine = np.concatenate([now[:-1] + (now[1:] - now[:-1]) * u for u in np.arange(0, 1, 0.1)])
        nearest, _ = cKDTree(np.concatenate([fine, now[-1:]])).query(given)
        far.append(max(nearest.max(), np.linalg.norm(given[-1] - now[-1])))
    return np.array(far)


CASES = {
    "smooth hair at rest, 25 points": lambda c: at_rest(c, "asian_smooth", 0.2, 25),
    "wavy hair at rest, 25 points": lambda c: at_rest(c, "caucasian_wavy", 0.2, 25),
    "wavy hair at rest, 50 points": lambda c: at_rest(c, "caucasian_wavy", 0.2, 50),
    "wavy hair at rest, 100 points": lambda c: at_rest(c, "caucasian_wavy", 0.2, 100),
    "hanging coils, 50 points": lambda c: coils(50),
    "noisy hanging coils, 100 points": lambda c: coils(100, 2e-4),
    "upright and tilted roots, 40 points": lambda c: arcs(40),
}


@pytest.mark.parametrize("case", CASES)
def test_imported_hair_stays_where_it_was_and_without_hold_it_sags(client, keep, case):
    strands = CASES[case](client)
    options = {"error_bound_m": 1e-3, "element_count": 32}
    groom = keep(strands, **options)
    report = client.import_report(groom)
    assert report.held.all(), report.needed_stiffness_factors
    assert report.bounds_met.all(), report.largest_fit_distances
    held = deviations(strands, settle(client, groom))
    assert np.all(held <= report.largest_fit_distances + TOLERANCE_M), held

    limp = keep(strands, hold=False, **options)
    settled = settle(client, limp)
    sagged = deviations(strands, settled)
    assert np.median(sagged) > 5 * np.median(held), (sagged, held)
    told = client.import_report(limp)
    assert not told.held.all() and np.all(told.stiffness_factors == 1)
    # What statics foretold, dynamics does, to a tenth.
    tips = [np.linalg.norm(g[-1] - s[-1]) for g, s in zip(strands, settled, strict=True)]
    assert np.abs(tips - told.tip_deviations).max() < 0.1 * max(tips) + 1e-3


def test_rest_shape_of_an_import_is_the_imported_shape(client, keep):
    strands = arcs(40)
    groom = keep(strands, element_count=32)
    report = client.import_report(groom)
    rest = client.rest_shape(groom, points_per_guide=POINTS)
    assert np.all(rest.residuals <= 1e-6)
    far = deviations(strands, rest.positions)
    assert np.all(far <= report.largest_fit_distances + 1e-5), far


def test_what_does_not_hold_is_reported_and_falls(client, keep):
    upright = np.linspace((0, 0.1, 0), (0, 0.3, 0), 30)
    hanging = np.linspace((0, 0.1, 0), (0, -0.1, 0), 30)
    groom = keep([upright, hanging], hair_type="asian_smooth")
    summary, report = groom.import_summary, client.import_report(groom)
    assert report.held.tolist() == [False, True] and summary.not_held_count == 1
    assert report.stiffness_factors[0] == 4 < report.needed_stiffness_factors[0]
    assert report.tip_deviations[0] > 0.1 > 1e-4 > report.tip_deviations[1]
    assert summary.largest_tip_deviation_m == pytest.approx(report.tip_deviations[0])
    positions = settle(client, groom)
    assert positions[0, -1, 1] < 0.2  # It lies where statics put it: a head starts there.
    np.testing.assert_allclose(positions[1, -1], hanging[-1], atol=1e-4)
    stiff = keep([upright], hair_type="asian_smooth", max_stiffness_factor=100)
    assert client.import_report(stiff).held.all()
    np.testing.assert_allclose(settle(client, stiff)[0, -1], upright[-1], atol=1e-3)


def test_an_import_and_its_report_survive_a_restart(tmp_path):
    strands = coils(40)
    daemon: Daemon = start_daemon(tmp_path)
    with mane.Client(daemon.address) as client:
        groom = client.create_groom(strands=strands, groom_id="coils")
        before, positions = client.import_report(groom), settle(client, groom)
    assert stop_daemon(daemon) == 0
    daemon = start_daemon(tmp_path)
    try:
        with mane.Client(daemon.address) as client:
            found = client.get_groom("coils")
            assert found.import_summary == groom.import_summary == before.summary
            assert [g.import_summary for g in client.list_grooms()] == [before.summary]
            after = client.import_report("coils")
            np.testing.assert_array_equal(after.tip_deviations, before.tip_deviations)
            np.testing.assert_array_equal(after.element_counts, before.element_counts)
            np.testing.assert_array_equal(settle(client, found), positions)
    finally:
        assert stop_daemon(daemon) == 0


def test_options_come_back_as_applied(client, keep):
    properties = mane.HairProperties(young_modulus_pa=3e9, air_drag=2e-5)
    groom = keep(
        [np.linspace((0, 0, 0), (0, -0.1, 0), 10)],
        hair_type="caucasian_curly", properties=properties, element_count=7, error_bound_m=0,
        noise_m=1e-4, max_stiffness_factor=2, stability_margin=0.05, wisp_radius_m=0.01,
    )  # fmt: skip
    options = client.import_report(groom).options
    assert options == mane.ImportOptions(
        mane.HairType.CAUCASIAN_CURLY, properties, 7, 0, 1e-4, True, 2, 0.05, 0.01
    )
    guide = client.export_groom(groom).guides[0]
    assert guide.young_modulus_pa == 3e9 and guide.air_drag == 2e-5
    assert len(guide.resolved_element_lengths_m()) == 7


def test_strands_with_frames_properties_and_a_scalp(client, keep):
    points = np.linspace((0, 0.1, 0), (0, 0, 0), 12)
    frame = mane.frame_along((0, -1, 0), (1, 0, 1))
    own = mane.Strand(points, frame, mane.HairProperties(radius_1_m=6e-5, radius_2_m=4e-5))
    groom = keep([own, points], scalp=mane.Ellipsoid((0.1, 0.1, 0.1)))
    assert groom.has_scalp and groom.hair_type is None
    first, second = client.export_groom(groom).guides
    assert abs(first.root_frame @ frame) == pytest.approx(1, abs=1e-12)
    assert (first.radius_1_m, first.radius_2_m) == (6e-5, 4e-5)
    assert second.radius_1_m != 6e-5


def test_the_asyncio_client_imports_too(maned):
    async def run():
        async with mane.aio.Client(maned.address) as client:
            groom = await client.create_groom(strands=coils(30, count=2))
            report = await client.import_report(groom)
            await client.delete_groom(groom)
            return groom, report

    groom, report = asyncio.run(run())
    assert report.summary == groom.import_summary and len(report.held) == 2


def spoilt(**changes) -> mane.Strand:
    points = np.linspace((0, 0, 0), (0, -0.2, 0), 5)
    for (row, column), value in changes.pop("at", {}).items():
        points[row, column] = value
    return mane.Strand(**({"points": points} | changes))


@pytest.mark.parametrize(
    ("strand", "field", "value"),
    [
        (spoilt(at={(3, 1): np.nan}), "points[3].y", "nan"),
        (spoilt(at={(0, 0): np.inf}), "points[0].x", "inf"),
        (spoilt(at={(4, 2): -2e6}), "points[4].z", "-2000000"),
        (spoilt(at={(4, 1): -9}), "points", "5 m"),
        (spoilt(points=np.zeros((1, 3))), "points", "1 points"),
        (spoilt(points=np.zeros((0, 3))), "points", "0 points"),
        (spoilt(points=np.ones((20, 3))), "points", "0 m"),
        (spoilt(points=np.cumsum(np.full((1001, 3), 1e-4), 0)), "points", "1001"),
        (spoilt(root_frame=(0, 0, 0, 2)), "root_frame", "2"),
        (spoilt(root_frame=(np.nan, 0, 0, 1)), "root_frame", "nan"),
        (spoilt(properties=mane.HairProperties(radius_1_m=0)), "properties.radius_1_m", "0"),
        (spoilt(properties=mane.HairProperties(air_drag=np.nan)), "properties.air_drag", "nan"),
    ],
)
def test_bad_strands_are_refused_by_index_field_and_value(client, strand, field, value):
    before = {g.name for g in client.list_grooms()}
    with pytest.raises(mane.InvalidArgument) as caught:
        client.create_groom(strands=[spoilt(), spoilt(), strand])
    assert caught.value.field_violations[0].field == f"strands[2].{field}"
    assert value in str(caught.value)
    assert {g.name for g in client.list_grooms()} == before


@pytest.mark.parametrize(
    ("options", "field"),
    [
        ({"element_count": 65}, "element_count"),
        ({"error_bound_m": -1e-3}, "error_bound_m"),
        ({"error_bound_m": np.nan}, "error_bound_m"),
        ({"noise_m": 1.0}, "noise_m"),
        ({"max_stiffness_factor": 0.5}, "max_stiffness_factor"),
        ({"stability_margin": 1.0}, "stability_margin"),
        ({"properties": mane.HairProperties(density_kg_m3=0)}, "properties.density_kg_m3"),
    ],
)
def test_bad_options_are_refused(client, options, field):
    with pytest.raises(mane.InvalidArgument) as caught:
        client.create_groom(strands=[spoilt()], import_options=mane.ImportOptions(**options))
    assert caught.value.field_violations[0].field == f"header.import_options.{field}"


def test_misfits_are_refused(client, groom):
    with pytest.raises(mane.InvalidArgument, match="guides"):
        client.create_groom([make_guide()], strands=[spoilt()])
    with pytest.raises(mane.InvalidArgument, match="strands"):
        client.create_groom(import_options=mane.ImportOptions())
    with pytest.raises(mane.InvalidArgument, match="generate"):
        generate = mane.GuideGeneration("asian_smooth", 5, 0.1)
        client.create_groom(strands=[spoilt()], generate=generate)
    with pytest.raises(mane.InvalidArgument, match=r"strands\[1\]: points: has shape \(5, 2\)"):
        client.create_groom(strands=[spoilt(), np.zeros((5, 2))])
    with pytest.raises(mane.InvalidArgument, match="hair_type"):
        client.create_groom(strands=[spoilt()], import_options=mane.ImportOptions(hair_type="bald"))
    with pytest.raises(mane.FailedPrecondition, match="not made from strands"):
        client.import_report(groom)
    with pytest.raises(mane.NotFound, match="nobody"):
        client.import_report("nobody")
