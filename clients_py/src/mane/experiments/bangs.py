"""Bangs in a wind toward the forehead, after Figure 11 of [AUK92]: what keeps hair out of a head.

The published field, (0, 0, -500), is turned so that it presses bangs on the forehead.
"""

from __future__ import annotations

import numpy as np

from mane.client import Client
from mane.experiments import published
from mane.experiments.published import SEGMENTS, UNIT_M
from mane.experiments.recurrences import Polar, PseudoForce, integrate
from mane.experiments.report import Report
from mane.experiments.scene import kept
from mane.experiments.sheet import draw_rows
from mane.painter import Look, View

FIELD = (0.0, 0.0, -500.0)
FRAMES = 30
ARRIVED = 10
"""Until this frame the pseudo-force is to keep hair out; then some has come into its own speed."""
SHOWN = (0, 5, ARRIVED, 20)
D = 0.4  # Of a segment, as published lengths are: bangs of 9 cm.
FALL = 0.2
ZENITHS, AZIMUTHS = (0.9, 1.1), (-0.5, 0.5)
SHELTER = PseudoForce(published.RADII_M, alpha=-0.75, near_m=4 * UNIT_M, epsilon=0.1)
WEAKENED = {
    "alpha": SHELTER.alpha,
    "near_m": SHELTER.near_m,
    "epsilon": [SHELTER.epsilon] * SEGMENTS,
}
CASES = {
    "the field as it is": {},
    "pseudo-force": WEAKENED,
    "nodes turned out": {"avoid_head": True},
}
VIEW = View(50, 6, 0.36)
NODES_OFF = 1e-5
"""How far nodes may be from the recurrences, over the hair's length: rounding of float32."""


def run(client: Client, report: Report, quick: bool) -> None:
    rows, columns, size = (4, 11, 160) if quick else (8, 25, 320)
    hair = [
        published.falling_hair(zenith, azimuth, D, FALL)
        for zenith in np.linspace(*ZENITHS, rows)
        for azimuth in np.linspace(*AZIMUTHS, columns)
    ]
    fields = [FIELD] * FRAMES
    with kept(client, hair, scalp=published.HEAD) as groom:
        played = {
            name: published.play(client, groom, fields, published.as_published(D, **changes))
            for name, changes in CASES.items()
        }
    inside = {name: count_inside(nodes) for name, nodes in played.items()}
    count = len(hair) * SEGMENTS
    free, weakened, kept_out = inside.values()
    most, first = int(free.max()), int(np.argmax(weakened > 0))
    report.values["nodes"] = count
    report.values["the field as it is: nodes inside at most, of all"] = most
    report.values["pseudo-force: first frame with a node inside"] = first
    report.fact(
        "the field as it is: nodes inside at most, of all",
        "> 1/3",
        f"{most} of {count}",
        most > count / 3,
    )
    report.at_most(
        f"pseudo-force: nodes inside until frame {ARRIVED}", weakened[: ARRIVED + 1].max(), 0
    )
    report.at_most("nodes turned out: nodes inside at any time", kept_out.max(), 0)
    for name, shelter in (("the field as it is", None), ("pseudo-force", SHELTER)):
        theory = integrate(Polar.begin, played[name][0], fields, published.push(D), shelter)
        off = np.linalg.norm(played[name] - theory, axis=-1) / (SEGMENTS * D * UNIT_M)
        report.at_most(f"{name}: nodes off the recurrences over the length", off.max(), NODES_OFF)
    frames = np.arange(FRAMES + 1)
    report.table(
        "inside", {"frame": frames} | {name.replace(" ", "_"): n for name, n in inside.items()}
    )
    moments = {f"frame {frame}": frame for frame in SHOWN}
    path, look = report.path("frames", ".png"), Look(size=size)
    draw_rows(path, published.drawn_head(), played, moments, VIEW, look)
    plot(report, played, inside, count)


def count_inside(nodes: np.ndarray) -> np.ndarray:
    """Of the ellipsoid, without pores, (frame,)."""
    return np.count_nonzero(published.level(nodes[:, :, 1:]) < 0, axis=(1, 2))


def plot(report: Report, played: dict, inside: dict, count: int) -> None:
    with report.figure("inside", columns=4, width=4.2) as (*profiles, counts):
        for axes, (name, nodes) in zip(profiles, played.items(), strict=True):
            draw_profile(axes, nodes[ARRIVED])
            axes.set(title=f"{name}, frame {ARRIVED}")
            counts.plot(100 * inside[name] / count, "o-", ms=3, label=name)
        counts.axvline(ARRIVED, color="k", ls="--", lw=1)
        counts.set(xlabel="frame", ylabel="[%]", ylim=(-2, 70), title="Nodes inside the head")
        counts.legend(loc="upper left")


def draw_profile(axes, nodes: np.ndarray) -> None:
    """Hair of the middle from the side, on the cut through the head."""
    off = np.abs(nodes[:, 0, 0])
    turn = np.linspace(0, 2 * np.pi, 200)
    edge = 100 * published.RADII_M[[2, 1], None] * np.stack([np.cos(turn), np.sin(turn)])
    axes.fill(*edge, color="0.85")
    for hair in nodes[off < off.min() + 1e-3]:
        axes.plot(100 * hair[:, 2], 100 * hair[:, 1], "k.-", lw=0.8, ms=3)
        deep = 100 * hair[1:][published.level(hair[1:]) < 0]
        axes.plot(deep[:, 2], deep[:, 1], "r.", ms=5)
    axes.set(aspect="equal", xlim=(1, 15), ylim=(-2, 10.5), xlabel="toward the face [cm]")
