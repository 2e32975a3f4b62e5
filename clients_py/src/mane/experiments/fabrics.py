"""Hair over fabrics that are drawn along under it: friction of each material, with and against the
scales, as in [SH06] 4.2."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from mane.bodies import Body, Material
from mane.client import Client
from mane.experiments.report import Report
from mane.experiments.scene import animated, hair_on_slab, kept, onto_slab, slab
from mane.groom import Guide
from mane.motion import Motion
from mane.pose import Pose

MATERIALS = (
    Material.WOOL, Material.SKIN, Material.LEATHER, Material.COTTON, Material.SILK,
    Material.POLISHED,
)  # fmt: skip
TURNS = np.radians((45, 67.5, 90, 112.5, 135))
"""Where fabrics go, from downhill [rad]: up to 90 degrees they draw hair towards its tip and so
slide along its scales, from there on against them."""
TILT = np.radians(45)

RATE_HZ = 60.0
LENGTH_M = 0.15
ELEMENT_COUNT = 8
GRAVITO_BENDING = 200  # Much softer hair flutters where it is rubbed against its scales.
POINTS = 33
SPEED_M_S = 0.08
DRAWN_S = 6.0
SLAB_M = 0.5  # Half its width.
APART_M = 3.0


@dataclass(frozen=True)
class Sample:
    """A fabric that goes one way. friction, anisotropy: of its material."""

    material: Material
    turn: float
    friction: float
    anisotropy: float

    def deflection(self) -> float:
        """Where soft hair points in the end, from downhill [rad].

        It lies along the sum of what pulls it: weight, sin(tilt) per unit of it, downhill, and
        friction, mu cos(tilt), the way that the fabric goes. The hair slides the opposite way, so
        mu = mu_0 (1 - alpha cos(turn - deflection)).
        """

        def across(deflection: float) -> float:
            """Of the two, the part across the hair."""
            mu = self.friction * (1 - self.anisotropy * np.cos(self.turn - deflection))
            rubbed = mu * np.cos(TILT) * np.sin(self.turn - deflection)
            return rubbed - np.sin(TILT) * np.sin(deflection)

        return brentq(across, 0, self.turn)

    def rubbed(self, deflection: np.ndarray) -> np.ndarray:
        """The coefficient of friction by which hair is deflected so."""
        return np.tan(TILT) * np.sin(deflection) / np.sin(self.turn - deflection)

    def law(self, slide: np.ndarray) -> np.ndarray:
        """The coefficient of [SH06] 4.2 by the angle between sliding and tangent."""
        return self.friction * (1 + self.anisotropy * np.cos(slide))


def run(client: Client, report: Report, quick: bool) -> None:
    materials = (Material.WOOL, Material.SILK) if quick else MATERIALS
    guides, bodies, motion = drawn(materials)
    with kept(client, guides, bodies=bodies) as groom:
        told = client.export_groom(groom).bodies
        moving = animated(
            client, groom, motion, POINTS, 1, onto_slab(TILT, (0.0, -1.0, 0.0))
        )
    samples = [
        Sample(material, turn, body.friction, body.friction_anisotropy)
        for (material, turn), body in zip(pairs(materials), told, strict=True)
    ]
    lines = moving - np.array([guide.root_position for guide in guides])[:, None]
    measured = deflections(lines)
    theory = np.array([sample.deflection() for sample in samples])
    rubbed = np.array([s.rubbed(angle) for s, angle in zip(samples, measured, strict=True)])
    slides = np.pi - np.array([sample.turn for sample in samples]) + measured
    law = np.array([s.law(angle) for s, angle in zip(samples, slides, strict=True)])

    shape = len(materials), len(TURNS)
    for material, off in zip(materials, (rubbed / law - 1).reshape(shape), strict=True):
        what = f"{material}: friction over the cosine law's, largest error"
        report.at_most(what, np.abs(off).max(), 0.02)
    for material, row in zip(materials, np.arange(len(samples)).reshape(shape), strict=True):
        against, along = rubbed[row[-1]], rubbed[row[0]]
        expected = law[row[-1]] / law[row[0]]
        what = f"{material}: friction against the scales over that along them"
        report.equal(what, expected, against / along, 0.02)
    off = np.abs(measured - theory).max()
    report.at_most("largest error of a deflection", np.degrees(off), 0.5, " degrees")

    report.table(
        "deflections",
        {"mu": [s.friction for s in samples], "alpha": [s.anisotropy for s in samples],
         "turn_rad": [s.turn for s in samples], "deflection_theory_rad": theory,
         "deflection_rad": measured, "mu_law": law, "mu_measured": rubbed},
    )  # fmt: skip
    with report.figure("deflections", columns=3, width=5) as (law_axes, trails, lag):
        for k, material in enumerate(materials):
            rows = np.arange(len(samples)).reshape(shape)[k]
            color = f"C{k}"
            slide = np.linspace(slides[rows].min(), slides[rows].max(), 50)
            law_axes.plot(np.cos(slide), samples[rows[0]].law(slide), color=color)
            law_axes.plot(np.cos(slides[rows]), rubbed[rows], "o", mfc="none", color=color)
            for row in (rows[0], rows[-1]):
                tip = 100 * lines[:, row, -1]
                style = "-" if row == rows[0] else "--"
                trails.plot(tip[:, 2], tip[:, 1], style, color=color)
                last = 100 * lines[-1, row]
                trails.plot(last[:, 2], last[:, 1], style, color=color, lw=0.6)
            lag.plot(np.degrees(TURNS), np.degrees(theory[rows]), color=color)
            lag.plot(np.degrees(TURNS), np.degrees(measured[rows]), "o", mfc="none", color=color,
                     label=str(material))  # fmt: skip
        law_axes.set(
            xlabel="cosine between sliding and tangent (root to tip)",
            ylabel="coefficient of friction",
            title=r"Lines: $\mu_0 (1 + \alpha \cos)$",
        )
        trails.set(
            xlabel="aside [cm]",
            ylabel="uphill of the root [cm]",
            aspect="equal",
            title=f"Tips' trails and last shapes; fabric goes {degrees(TURNS[0])} (full)\n"
            f"and {degrees(TURNS[-1])} (dashed) from downhill",
        )
        lag.set(
            xlabel="where the fabric goes, from downhill [degrees]",
            ylabel="deflection of the hair [degrees]",
            title="Lines: balance of weight and friction",
        )
        lag.legend()


def pairs(materials) -> list[tuple[Material, float]]:
    return [(material, turn) for material in materials for turn in TURNS]


def drawn(materials) -> tuple[list[Guide], list[Body], Motion]:
    """A strand on a fabric of its own for every material and way, and how fabrics move."""
    guides, bodies, ways = [], [], {}
    times = np.arange(round(DRAWN_S * RATE_HZ) + 1) / RATE_HZ
    for k, (material, turn) in enumerate(pairs(materials)):
        root = np.array([0, 0, k * APART_M])
        guides.append(hair_on_slab(LENGTH_M, ELEMENT_COUNT, root, GRAVITO_BENDING))
        velocity = SPEED_M_S * np.array([0, -np.cos(turn), np.sin(turn)])
        # Half of the way to the strand, half of it beyond.
        way = root - (0, LENGTH_M / 2, 0) + np.outer(times - DRAWN_S / 2, velocity)
        name = f"fabric-{k}"
        bodies.append(
            slab(name, SLAB_M, material=material, moving=True, pose=Pose(position=way[0]))
        )
        ways[name] = Motion(times, way)
    return guides, bodies, Motion(times, bodies=ways)


def deflections(lines: np.ndarray) -> np.ndarray:
    """From downhill, of the half that ends at the tip, mean over the last half second [rad].

    lines: relative to the roots, (frame, guide, point, 3).
    """
    half = lines[-round(RATE_HZ / 2) :, :, -1] - lines[-round(RATE_HZ / 2) :, :, POINTS // 2]
    return np.arctan2(half[..., 2], -half[..., 1]).mean(axis=0)


def degrees(angle: float) -> str:
    return f"{np.degrees(angle):g}°"
