"""Short hair that flutters, Figure 12 of [AUK92].

Joints that hardly turn make more of fluctuations, and yet smooth curves.
"""

from __future__ import annotations

import numpy as np

from mane.client import Client
from mane.experiments import published
from mane.experiments.published import HEAD, SEGMENTS, TURNS_AT
from mane.experiments.report import Report
from mane.experiments.scene import kept
from mane.experiments.sheet import draw_rows
from mane.painter import Look, View

FRAMES = 40
SHOWN = (10, 15, 20, 30)
PERIOD = 10
"""Frames from one draw to the next."""
D = 0.4  # Of a segment, as published lengths are: hair of 9 cm.
FALL = 0.2
CAP_AXIS, CAP_ANGLE = (0.0, 0.8, -0.6), 1.4
WIND = 0.5
"""Of the gust's, which throws short hair about 2.5 times as far: lambda is as 1 / d."""
FLUCTUATION_RAD = 0.1
SEED = 1
FREE = 5
"""Segments at the pore whose joints are not limited."""
SIGMA_DEG = 12.0
NAMES = {180.0: "sigma = 180 degrees", SIGMA_DEG: f"sigma = {SIGMA_DEG:g} degrees"}
VIEW = View(125, 8, 0.44)


def run(client: Client, report: Report, quick: bool) -> None:
    count, size = (40, 160) if quick else (250, 320)
    pores = published.pores(count, CAP_AXIS, CAP_ANGLE)
    hair = [published.falling_hair(*pore, D, FALL) for pore in pores]
    fields, played, calm = WIND * published.gust(FRAMES), {}, {}
    with kept(client, hair, scalp=HEAD) as groom:
        for sigma, name in NAMES.items():
            limits = np.radians([180.0] * FREE + [sigma] * (SEGMENTS - FREE))
            for nodes, fluctuation in ((played, FLUCTUATION_RAD), (calm, 0.0)):
                beam = published.as_published(
                    D, largest_turn_rad=limits, fluctuation_rad=fluctuation, seed=SEED
                )
                nodes[name] = published.play(client, groom, fields, beam)
    turns = {name: np.degrees(joints(nodes)) for name, nodes in played.items()}
    off = {name: tips_off(played[name], calm[name]) for name in played}
    free, limited = NAMES.values()
    largest = turns[limited][1:].max()
    report.at_most(f"{limited}: largest turn of a joint", largest, SIGMA_DEG * (1 + 1e-4), " deg")
    report.values[f"{free}: largest turn of a joint"] = float(turns[free].max())
    later = np.arange(FRAMES + 1) > PERIOD  # From the second draw on.
    rough = {name: turns[name][later].mean() for name in turns}
    moved = {name: off[name][later].mean() for name in off}
    for what, above, below in (
        ("mean turn of joints, free over limited", rough[free], rough[limited]),
        ("tips moved by fluctuation, limited over free", moved[limited], moved[free]),
    ):
        report.values[what] = float(above / below)
        report.fact(what, "> 1.3", f"{above / below:.3g}", above > 1.3 * below)
    frames = np.arange(FRAMES + 1)
    columns = {"frame": frames}
    for name in played:
        short = name.replace(" = ", "_").replace(" ", "_")
        columns[f"{short}_mean_turn_deg"] = turns[name].mean(axis=(1, 2))
        columns[f"{short}_tips_off_m"] = off[name]
    report.table("joints", columns)
    moments = {f"frame {frame}": frame for frame in SHOWN}
    path, look = report.path("frames", ".png"), Look(size=size)
    rows = {f"no fluctuation, {limited}": calm[limited]} | played
    draw_rows(path, published.drawn_head(), rows, moments, VIEW, look)
    spectra = {name: spectrum(played[name][later], calm[name][later]) for name in played}
    plot(report, turns, off, spectra)


def joints(nodes: np.ndarray) -> np.ndarray:
    """Turns of the joints that may be limited [rad], (frame, guide, joint)."""
    return published.turns(nodes)[..., FREE - 1 :]


def tips_off(nodes: np.ndarray, calm: np.ndarray) -> np.ndarray:
    """How far tips are from where they were without fluctuation, rms, (frame,) [m]."""
    away = nodes[:, :, -1] - calm[:, :, -1]
    return np.sqrt((away**2).sum(axis=2).mean(axis=1))


def spectrum(nodes: np.ndarray, calm: np.ndarray) -> np.ndarray:
    """What fluctuation adds to directions of segments away from the pore, by waves along them, rms
    amplitude, (wave number,)."""
    added = (published.directions(nodes) - published.directions(calm))[..., FREE:, :]
    waves = np.fft.rfft(added, axis=-2) / added.shape[-2]
    return np.sqrt((np.abs(waves) ** 2).sum(axis=-1).mean(axis=(0, 1)))


def plot(report: Report, turns: dict, off: dict, spectra: dict) -> None:
    frames = np.arange(FRAMES + 1)
    with report.figure("joints", columns=3, width=5) as (turn_axes, tip_axes, wave_axes):
        for name in turns:
            turn_axes.plot(frames, turns[name].mean(axis=(1, 2)), "o-", ms=3, label=name)
            tip_axes.plot(frames, 1e3 * off[name], "o-", ms=3, label=name)
            wave_axes.semilogy(spectra[name], "o-", label=name)
        turn_axes.axhline(SIGMA_DEG, color="k", ls=":", lw=1)
        for axes in (turn_axes, tip_axes):
            axes.axvline(TURNS_AT - 0.5, color="k", ls="--", lw=1, label="the wind turns")
            axes.set(xlabel="frame")
        turn_axes.set(ylabel="turn of joints, mean [deg]", title="Smooth: joints turn little")
        tip_axes.set(ylabel="tips moved by fluctuation, rms [mm]", title="More of fluctuations")
        wave_axes.set(
            xlabel="waves along the hair beyond the pore",
            ylabel="added to directions, rms",
            title="Long waves grow, short ones go",
        )
        tip_axes.legend()
