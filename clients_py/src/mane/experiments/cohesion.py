"""A clump of three guides that is shaken: wisps keep it together."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mane.client import Client
from mane.experiments.report import Report
from mane.experiments.scene import DOWN, animated, far_body, kept, straight_hair
from mane.groom import Guide
from mane.motion import Motion

CURVATURES = (0.0, 60.0, 120.0)
"""Natural, of the three guides [rad/m]: straight, wavy, curly."""
NAMES = ("straight", "wavy", "curly")
RADIUS_M = 6e-3
APART_M = 8e-3  # Roots.
DRAGS = (5e-6, 1.5e-5, 5e-5)
"""Of the three [kg/(m s)], so that they swing apart."""

LENGTH_M = 0.18
ELEMENT_COUNT = 16
POINTS = 49
RATE_HZ = 60.0
SUBSTEPS = 2
FREQUENCY_HZ = 1.5
AMPLITUDE_M = 0.04


def run(client: Client, report: Report, quick: bool) -> None:
    motion = shaking(3.0 if quick else 8.0)
    spreads = {
        name: [spread(client, curvature, radius, motion) for radius in (RADIUS_M, 0)]
        for name, curvature in zip(NAMES, CURVATURES, strict=True)
    }
    later = motion.times_s > 1 / FREQUENCY_HZ
    for name, (wisps, free) in spreads.items():
        part = wisps[later].mean() / free[later].mean()
        report.at_most(f"{name}: spread of the tips with wisps over without", part, 0.7)
    columns = {
        f"{name}_{kind}_m": values
        for name, both in spreads.items()
        for kind, values in zip(("wisps", "free"), both, strict=True)
    }
    report.table("spread", {"time_s": motion.times_s} | columns)
    with report.figure("spread", columns=3, width=5) as each:
        for axes, (name, both) in zip(each, spreads.items(), strict=True):
            for label, values in zip(("wisps", "without"), both, strict=True):
                axes.plot(motion.times_s, 1e3 * values, label=label)
            axes.set(xlabel="time [s]", ylabel="spread of tips [mm]", title=name)
            axes.legend()


def clump(curvature: float, radius_m: float) -> list[Guide]:
    """Three guides that hang from a triangle of roots."""
    hair = replace(
        straight_hair(DOWN, LENGTH_M, ELEMENT_COUNT),
        natural_curvature_1=curvature,
        natural_twist=curvature / 2,
        internal_friction=1e-10,
        wisp_radius_m=radius_m,
    )
    turns = 2 * np.pi * np.arange(3) / 3
    roots = APART_M / 3**0.5 * np.stack([np.cos(turns), 0 * turns, np.sin(turns)], axis=1)
    return [
        replace(hair, root_position=root, air_drag=drag)
        for root, drag in zip(roots, DRAGS, strict=True)
    ]


def spread(client: Client, curvature: float, radius_m: float, motion: Motion) -> np.ndarray:
    """How far tips are from their middle beyond what they are at rest, rms, (frame,) [m]."""
    with kept(client, clump(curvature, radius_m), bodies=[far_body()]) as groom:
        tips = animated(client, groom, motion, POINTS, SUBSTEPS)[:, :, -1]
    away = tips - tips.mean(axis=1, keepdims=True)
    return np.sqrt(((away - away[0]) ** 2).sum(axis=2).mean(axis=1))


def shaking(seconds: float) -> Motion:
    times = np.arange(round(seconds * RATE_HZ) + 1) / RATE_HZ
    aside = AMPLITUDE_M * np.sin(2 * np.pi * FREQUENCY_HZ * times)
    return Motion(times, np.outer(aside, (1, 0, 0.4)))
