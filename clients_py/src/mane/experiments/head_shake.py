"""A whole head of hair that shakes, for every hair type of [SH06]: pictures, and what tips do."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from mane import mesh
from mane.client import Client
from mane.demo import KINDS, RATE_HZ, animate, load_motion
from mane.experiments.report import Report
from mane.experiments.scene import kept, mass_per_length
from mane.groom import GuideGeneration
from mane.motion import Motion
from mane.painter import Look
from mane.picture import draw_sheet

LENGTH_M = 0.25
SUBSTEPS = 4
HALF_SECOND = round(RATE_HZ / 2)  # Frames.
STILL_S = 3.0
"""How long the head stands still after the shake."""


def run(client: Client, report: Report, quick: bool) -> None:
    guides, size = (12, 96) if quick else (100, 320)
    head, motion = mesh.mannequin(), then_still(load_motion("shake"))
    stop_s = motion.times_s[-1] - STILL_S
    aside = {}
    for name, kind in KINDS.items():
        generate = GuideGeneration(
            kind.hair_type, guides, LENGTH_M, seed=1, curl_variation=kind.curl_variation
        )
        positions = animate(client, head, generate, motion, kind.points, SUBSTEPS, name)
        look = Look(kind.hair_color, tip_part=kind.tip_part, size=size)
        title = f"{name}, {100 * LENGTH_M:g} cm, {guides} guides"
        draw_sheet(report.path(name, ".png"), head, positions, motion, title=title, look=look)
        longest = lengths(positions).max() / LENGTH_M
        report.at_most(f"{name}: longest guide at any time over its length", longest, 1 + 1e-5)
        tips = in_head(positions, motion)[:, :, -1]
        aside[name] = rms(tips - tips[0])
        speed = rms(np.diff(tips, axis=0)) * RATE_HZ
        begin = speed[motion.times_s[1:] > stop_s][:HALF_SECOND].mean()
        end = speed[-HALF_SECOND:].mean()
        later_s = STILL_S - 0.5
        air = np.exp(-damping_by_air(client, head, generate) * later_s)
        what = f"{name}: part of the tips' speed {later_s:g} s after the shake; air alone leaves"
        report.at_most(what, end / begin, air)
        report.values[f"{name}: tips farthest from rest, rms [m]"] = float(aside[name].max())
    columns = {f"tips_from_rest_{name}_m": values for name, values in aside.items()}
    report.table("tips", {"time_s": motion.times_s} | columns)
    with report.figure("tips", width=8) as (axes,):
        for name, values in aside.items():
            axes.plot(motion.times_s, 100 * values, label=name)
        axes.axvline(stop_s, color="k", ls="--", lw=1, label="the head stands still")
        axes.set(
            xlabel="time [s]",
            ylabel="distance of tips from rest, in the head's axes, rms [cm]",
            title=f"Head shake: {guides} guides of {100 * LENGTH_M:g} cm",
        )
        axes.legend()


def damping_by_air(client: Client, head: mesh.Mesh, generate: GuideGeneration) -> float:
    """nu / (2 rho S) of such hair [1/s]."""
    with kept(client, scalp=head, generate=replace(generate, guide_count=1)) as groom:
        guide = client.export_groom(groom).guides[0]
    return guide.air_drag / (2 * mass_per_length(guide))


def rms(vectors: np.ndarray) -> np.ndarray:
    """Root mean square length of (frame, guide, 3), (frame,)."""
    return np.sqrt((vectors**2).sum(axis=2).mean(axis=1))


def then_still(motion: Motion) -> Motion:
    """The motion, and its last pose for `STILL_S` more."""
    more = round(STILL_S * RATE_HZ)
    times = motion.times_s[-1] + np.arange(1, more + 1) / RATE_HZ
    return Motion(
        np.append(motion.times_s, times),
        np.append(motion.positions, np.tile(motion.positions[-1], (more, 1)), axis=0),
        np.append(motion.orientations, np.tile(motion.orientations[-1], (more, 1)), axis=0),
    )


def in_head(positions: np.ndarray, motion: Motion) -> np.ndarray:
    """Positions (frame, guide, point, 3) from the world's axes into those of each frame's head."""
    turns = Rotation.from_quat(motion.orientations).as_matrix()
    shifted = positions - motion.positions[:, None, None, :]
    return np.einsum("fgpj,fji->fgpi", shifted, turns)


def lengths(positions: np.ndarray) -> np.ndarray:
    """Of the polylines through the points, (frame, guide) [m]."""
    return np.linalg.norm(np.diff(positions.astype(np.float64), axis=2), axis=3).sum(axis=2)
