"""Wisps that collide: two, whose momentum is kept, and one that a curtain of others catches."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from mane.client import Client
from mane.experiments.report import Report
from mane.experiments.scene import (
    ASIDE,
    DOWN,
    animated,
    far_body,
    kept,
    mass_per_length,
    straight_hair,
)
from mane.groom import frame_along
from mane.motion import Motion
from mane.pose import Environment

RADIUS_M = 3e-3
LENGTH_M = 0.2
POINTS = 65

SWING_HZ = 240.0
WINDS_M_S = (0.3, 1.5)
"""That hold a strand aside until it is let go."""
HELD_S = 3.0
SWINGS_S = 0.6
GAP_M = 1e-3  # At rest, between the wisps.

RATE_HZ = 60.0
SPEEDS_M_S = (0.5, 1.0, 2.0, 3.5, 4.0)
"""At which a head sets out all at once."""
ALONE_UP_TO_M_S = 1.0
"""Faster, hair winds around a single hair across it, tighter than its elements can follow."""
ALONE_M = np.array([0.1])  # Below the root: where one hair is across,
CURTAIN_M = np.arange(0.03, 0.22, 0.008)  # and where many are.
FURTHER_M = (0.0, 4e-3, 8e-3)
"""Apart at the start: what hair does when it is caught depends on when within a step it is."""
ACROSS_M = 0.2  # Their length.


@dataclass(frozen=True)
class Swing:
    """times_s from when the strand is let go; momenta along x, (frame, guide) [kg m/s]; gaps:
    distance of the wisps' middles over the sum of their radii, (frame,)."""

    times_s: np.ndarray
    momenta: np.ndarray
    gaps: np.ndarray


def run(client: Client, report: Report, quick: bool) -> None:
    winds = WINDS_M_S[1:] if quick else WINDS_M_S
    speeds = SPEEDS_M_S[1::2] if quick else SPEEDS_M_S
    swings = {wind: [swing(client, wind, radius) for radius in (RADIUS_M, 0)] for wind in winds}
    for wind, (met, free) in swings.items():
        total, expected = met.momenta.sum(axis=1), free.momenta.sum(axis=1)
        off = np.abs(total - expected).max() / np.abs(expected).max()
        name = f"swing, let go of a wind of {wind:g} m/s"
        report.at_most(f"{name}: largest change of the sum of momenta by the impact", off, 0.05)
        report.at_most(f"{name}: without wisps, distance over the sum of radii", free.gaps.min(), 0)
        least(report, name, met.gaps.min(), 0.5)
    for speed in speeds:
        if speed > ALONE_UP_TO_M_S:
            continue
        gaps = crossing(client, speed, ALONE_M)
        nearest = np.abs(gaps).argmin(axis=1)[:, None]
        least(report, f"crossed at {speed:g} m/s", np.take_along_axis(gaps, nearest, 1).min(), 0.3)
    crossings = {
        speed: np.min(
            [crossing(client, speed, CURTAIN_M, further).min(axis=1) for further in FURTHER_M],
            axis=0,
        )
        for speed in speeds
    }
    for speed, gaps in crossings.items():
        least(report, f"caught at {speed:g} m/s", gaps.min(), 0.3)

    times = np.arange(len(next(iter(crossings.values())))) / RATE_HZ
    met, free = swings[winds[-1]]
    report.table(
        "swing",
        {"time_s": met.times_s, "first_kg_m_per_s": met.momenta[:, 0],
         "second_kg_m_per_s": met.momenta[:, 1], "without_wisps_kg_m_per_s": free.momenta[:, 0]},
    )  # fmt: skip
    columns = {f"gap_at_{speed:g}_m_per_s": gaps for speed, gaps in crossings.items()}
    report.table("crossing", {"time_s": times} | columns)
    with report.figure("momentum", columns=2) as (momenta, gap_axes):
        total = met.momenta.sum(axis=1)
        for label, values, style in (
            ("first", met.momenta[:, 0], "-"),
            ("second", met.momenta[:, 1], "-"),
            ("both", total, "-"),
            ("without wisps", free.momenta.sum(axis=1), "k--"),
        ):
            momenta.plot(met.times_s, 1e6 * values, style, label=label)
        momenta.set(
            xlabel="time since let go [s]",
            ylabel="momentum along x [mg m/s]",
            title=f"A strand swings into another, {winds[-1]:g} m/s of wind let go",
        )
        for speed, gaps in crossings.items():
            gap_axes.plot(times, gaps, label=f"{speed:g} m/s")
        gap_axes.axhline(0, color="k", lw=1)
        gap_axes.set(
            xlabel="time [s]",
            ylabel="distance over the sum of radii",
            title="Caught by a curtain; below 0: passed through",
        )
        for axes in (momenta, gap_axes):
            axes.legend()


def least(report: Report, name: str, gap: float, bound: float) -> None:
    what = f"{name}: smallest distance over the sum of radii"
    report.values[what] = float(gap)
    report.fact(what, f">= {bound:g}", f"{gap:.3g}", gap >= bound)


def swing(client: Client, wind_m_s: float, radius_m: float) -> Swing:
    """A strand that wind holds aside is let go and swings into an equal one.

    Only the first feels air, and that only until it is let go. Both are equal pendulums; what they
    exert on each other cancels in the sum of their motions, which goes on as if they did not meet,
    as long as it is small.
    """
    strand = replace(
        straight_hair(DOWN, LENGTH_M, 8), wisp_radius_m=radius_m, internal_friction=1e-11
    )
    first = replace(strand, air_drag=2 * mass_per_length(strand))
    second = replace(strand, root_position=(-2 * RADIUS_M - GAP_M, 0, 0))
    held, free = (np.arange(round(s * SWING_HZ)) / SWING_HZ for s in (HELD_S, SWINGS_S))
    # Five times the drag, and as much less wind: it settles sooner.
    blows = Environment(wind_velocity=(wind_m_s / 5, 0, 0), air_drag_scale=5)
    still = Environment(wind_velocity=(0, 0, 0), air_drag_scale=0)
    options = {"points_per_guide": POINTS, "space": "head", "environment": blows}
    with (
        kept(client, [first, second], bodies=[far_body()]) as groom,
        client.open_head(groom, "lockstep", **options) as head,
    ):
        for _ in head.play(Motion(held)):
            pass
        head.set_environment(still)
        lines = np.stack([f.positions for f in head.play(Motion(held[-1] + 1 / SWING_HZ + free))])
    x = lines[..., 0].astype(np.float64)
    speed = np.gradient(x, 1 / SWING_HZ, axis=0)
    momenta = mass_per_length(strand) * np.trapezoid(speed, dx=LENGTH_M / (POINTS - 1), axis=2)
    gaps = (x[:, 0] - x[:, 1])[:, 1:].min(axis=1) / (2 * RADIUS_M)
    return Swing(free, momenta, gaps)


def crossing(
    client: Client, speed_m_s: float, below_m: np.ndarray, further_m: float = 0
) -> np.ndarray:
    """Hanging hair is left behind by a head that sets out, and is caught by stiff hair across it so
    far below its root: distances of its points over the sum of radii, (frame, point), negative
    behind what is nearest.

    They are farther apart than the head's first step, by further_m more: pairs are looked for where
    hair would go if it went on as it did, which hair at rest does not tell.
    """
    away_m = 2 * RADIUS_M + 5e-3 + further_m + speed_m_s / RATE_HZ
    hanging = replace(straight_hair(DOWN, LENGTH_M, 12), air_drag=2e-6, wisp_radius_m=RADIUS_M)
    across = replace(
        straight_hair(ASIDE, ACROSS_M, 4),
        root_frame=frame_along((0, 0, 1)),
        young_modulus_pa=1e13,
        wisp_radius_m=RADIUS_M,
    )
    curtain = [replace(across, root_position=(-away_m, -y, -ACROSS_M / 2)) for y in below_m]
    times = np.arange(round(0.6 * RATE_HZ)) / RATE_HZ
    motion = Motion(times, np.outer(speed_m_s * np.maximum(times - 0.1, 0), (1, 0, 0)))
    with kept(client, [hanging, *curtain], bodies=[far_body()]) as groom:
        lines = animated(client, groom, motion, POINTS)
    return np.array([signed_distances(f[0], f[1:]) for f in lines]) / (2 * RADIUS_M)


def signed_distances(hanging: np.ndarray, curtain: np.ndarray) -> np.ndarray:
    """Of a polyline's points, (point, 3) [m], from others, (guide, point, 3): (point,), negative
    where they are behind what is nearest along x."""
    away = hanging[:, None] - curtain.reshape(-1, 3)
    distance = np.linalg.norm(away, axis=2)
    nearest = distance.argmin(axis=1)[:, None]
    sign = np.take_along_axis(away[..., 0], nearest, axis=1)
    return np.copysign(np.take_along_axis(distance, nearest, axis=1), sign)[:, 0]
