"""Hair across a slab that tilts: below the angle of friction it stays, above it slides."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mane.bodies import Body
from mane.client import Client
from mane.experiments.report import Report
from mane.experiments.scene import (
    animated,
    hair_on_slab,
    kept,
    onto_slab,
    slab,
)
from mane.groom import Groom, Guide
from mane.motion import Motion
from mane.pose import Environment, Pose

FRICTIONS = tuple(round(0.1 * k, 1) for k in range(1, 11))
"""mu of the slabs, the same in all directions."""

RATE_HZ = 60.0
LENGTH_M = 0.2
ELEMENT_COUNT = 8
POINTS = 17
APART_M = 1.0
COMES_TO_LIE_S = 0.5
WATCHED_S = 2.0
SLIDES_M = 1e-3
"""A tip that moves as far within `WATCHED_S` slides."""
ROUNDS = 8
TILT_PER_S = np.radians(1.0)
"""Of the slow tilt."""
PART_BELOW = 0.9
"""Of the angle of friction, where creep is measured."""
CREEPS_AFTER_S = 3.0
"""When hair lies as it will."""
CREEP_M_PER_S = 5e-7
"""At most: what is held goes back where it was (contact.md, K12), as exactly as float32 tells."""


def run(client: Client, report: Report, quick: bool) -> None:
    frictions = FRICTIONS[::3] if quick else FRICTIONS
    guides, bodies = side_by_side(frictions)
    with kept(client, guides, bodies=bodies) as groom:
        measured = np.array([angle(client, groom, k, mu) for k, mu in enumerate(frictions)])
        creep = np.array([creeping(client, groom, k, mu) for k, mu in enumerate(frictions)])
        tilts, moved = tilted_slowly(client, groom, np.radians(26 if quick else 60))
    theory = np.arctan(frictions)

    for mu, expected, found in zip(frictions, theory, measured, strict=True):
        what = f"mu = {mu:g}: angle at which it slides"
        report.equal(what, np.degrees(expected), np.degrees(found), 0.05, " degrees")
    what = f"creep at {PART_BELOW:g} of the angle of friction [m/s]"
    report.at_most(what, float(creep.max()), CREEP_M_PER_S)

    report.table(
        "angles",
        {"mu": frictions, "theory_rad": theory, "measured_rad": measured,
         "creep_m_per_s": creep},
    )  # fmt: skip
    columns = {f"mu_{mu:g}_m": moved[:, k] for k, mu in enumerate(frictions)}
    report.table("tilt", {"angle_rad": tilts} | columns)
    with report.figure("angles", columns=3, width=5) as (angle_axes, tilt_axes, creep_axes):
        fine = np.linspace(0, 1.05, 100)
        angle_axes.plot(fine, np.degrees(np.arctan(fine)), "k", label=r"atan $\mu$")
        angle_axes.plot(frictions, np.degrees(measured), "o", mfc="none", label="Mane, bisected")
        angle_axes.set(
            xlabel=r"$\mu$", ylabel="angle at which hair slides [degrees]", title="Stick and slip"
        )
        for k, mu in enumerate(frictions):
            tilt_axes.semilogy(
                np.degrees(tilts) / np.degrees(theory[k]), 1e3 * np.maximum(moved[:, k], 1e-7),
                label=rf"$\mu$ = {mu:g}",
            )  # fmt: skip
        tilt_axes.axvline(1, color="k", ls="--", lw=1)
        tilt_axes.set(
            xlim=(0.5, 1.7),
            xlabel=r"angle / atan $\mu$",
            ylabel="way of the tip [mm]",
            title=f"Slow tilt, {np.degrees(TILT_PER_S):g} degree a second",
        )
        creep_axes.axhline(1e6 * CREEP_M_PER_S, color="k", lw=1, label="limit")
        creep_axes.plot(frictions, 1e6 * creep, "o", mfc="none", label="Mane")
        creep_axes.set(
            xlabel=r"$\mu$",
            ylabel=r"fastest point [$\mu$m/s]",
            ylim=(0, None),
            title=rf"Creep at {PART_BELOW:g} atan $\mu$",
        )
        for axes in (angle_axes, tilt_axes, creep_axes):
            axes.legend()


def side_by_side(frictions: Sequence[float]) -> tuple[list[Guide], list[Body]]:
    """A strand on a slab of its own for each mu."""
    places = [np.array([0, 0, k * APART_M]) for k in range(len(frictions))]
    guides = [hair_on_slab(LENGTH_M, ELEMENT_COUNT, place) for place in places]
    bodies = [
        slab(f"slab-{k}", 0.3, friction=mu, friction_anisotropy=0, pose=Pose(position=places[k]))
        for k, mu in enumerate(frictions)
    ]
    return guides, bodies


def across(tilt: float) -> Environment:
    """As if slabs were tilted by that angle about the hair [rad]."""
    return onto_slab(tilt, (0, 0, 1))


def lies_and_slides(
    client: Client, groom: Groom, tilt: float, begin_s: float, seconds: float
) -> np.ndarray:
    """Positions from a time on, (frame, guide, point, 3), on slabs that are tilted at once."""
    count = round((begin_s + seconds) * RATE_HZ)
    motion = Motion(np.arange(count + 1) / RATE_HZ)
    frames = animated(client, groom, motion, POINTS, environment=across(tilt))
    return frames[round(begin_s * RATE_HZ) :]


def angle(client: Client, groom: Groom, guide: int, mu: float) -> float:
    """The angle at which a strand begins to slide [rad], by bisection."""
    holds, slides = 0.5 * np.arctan(mu), min(1.5, 1.5 * np.arctan(mu))
    for _ in range(ROUNDS):
        middle = (holds + slides) / 2
        tips = lies_and_slides(client, groom, middle, COMES_TO_LIE_S, WATCHED_S)[:, guide, -1]
        if np.linalg.norm(tips[-1] - tips[0]) < SLIDES_M:
            holds = middle
        else:
            slides = middle
    return (holds + slides) / 2


def creeping(client: Client, groom: Groom, guide: int, mu: float) -> float:
    """Speed of the fastest point below the angle of friction, over a second [m/s]."""
    tilt = PART_BELOW * np.arctan(mu)
    moving = lies_and_slides(client, groom, tilt, CREEPS_AFTER_S, 1.0)[:, guide]
    return float(np.linalg.norm(moving[-1] - moving[0], axis=-1).max())


def tilted_slowly(client: Client, groom: Groom, up_to: float) -> tuple[np.ndarray, np.ndarray]:
    """Angles [rad], and how far tips have come from where they first lay, (angle, guide) [m]."""
    tilts = np.arange(0, up_to, TILT_PER_S / RATE_HZ)
    tips = []
    with client.open_head(groom, "lockstep", points_per_guide=2, space="head") as head:
        for k, tilt in enumerate(tilts):
            head.set_environment(across(tilt))
            tips.append(head.step(Pose(k / RATE_HZ)).positions[:, -1].astype(np.float64))
    return tilts, np.linalg.norm(np.array(tips) - tips[0], axis=-1)
