"""A whole head of hair that shakes, for every hair type of [SH06]: pictures, and what tips do."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from mane import mesh
from mane.client import Client
from mane.demo import KINDS, Hair, animate, load_motion
from mane.experiments.report import Report
from mane.groom import GuideGeneration
from mane.motion import Motion
from mane.painter import Look
from mane.picture import draw_sheet

LENGTH_M = 0.25
STILL_S = 3.0
"""How long the head stands still after the shake."""


def run(client: Client, report: Report, quick: bool) -> None:
    guides, size = (12, 96) if quick else (100, 320)
    head, motion = mesh.mannequin(), then_still(load_motion("shake"))
    hairs = {name: kind for name, kind in KINDS.items() if name is not Hair.ALL}
    aside, columns = {}, {"time_s": motion.times_s}
    for name, kind in hairs.items():
        generate = GuideGeneration(
            kind.hair_type, guides, LENGTH_M, seed=1, curl_variation=kind.curl_variation
        )
        positions = animate(client, head, generate, motion, kind.points, 4, name)
        look = Look(kind.hair_color, tip_part=kind.tip_part, size=size)
        draw_sheet(
            report.path(name, ".png"), head, positions, motion, title=f"{name}, 25 cm", look=look
        )
        tips = in_head(positions, motion)[:, :, -1]
        aside[name] = np.sqrt(((tips - tips[0]) ** 2).sum(axis=2).mean(axis=1))
        columns[f"tips_from_rest_{name}_m"] = aside[name]
        print(name, lengths(positions).max()/LENGTH_M, np.isfinite(positions).all(), aside[name].max(), aside[name][-1])


def then_still(motion: Motion) -> Motion:
    """The motion, and its last pose for `STILL_S` more."""
    rate_hz = (len(motion) - 1) / motion.duration_s
    more = round(STILL_S * rate_hz)
    times = motion.times_s[-1] + np.arange(1, more + 1) / rate_hz
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
