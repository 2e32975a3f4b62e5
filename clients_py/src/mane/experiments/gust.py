"""A gust of wind that turns, Figure 10 of [AUK92]: hair goes on with the old one, and undulates."""

from __future__ import annotations

import numpy as np

from mane.client import Client
from mane.experiments import published
from mane.experiments.published import HEAD, SEGMENTS, TURNS_AT, UNIT_M
from mane.experiments.recurrences import Across, Polar, PseudoForce, integrate
from mane.experiments.report import Report
from mane.experiments.scene import kept
from mane.experiments.sheet import draw_rows
from mane.painter import Look, View

FRAMES = 30
SHOWN = (1, 10, 15, 20)
"""Frames of Figure 10."""
BEFORE, AFTER = TURNS_AT - 1, 20
LENGTH_M = SEGMENTS * UNIT_M
CAP_AXIS, CAP_ANGLE = (0.0, 0.8, -0.6), 1.3
FALL = 0.35
SHELTER = PseudoForce(published.RADII_M, alpha=-0.75, near_m=4 * UNIT_M, epsilon=0.1)
EQUATIONS = {"across": Across.begin, "polar": Polar.begin}
NODES_OFF = {"across": 1e-5, "polar": 1e-3}
"""How far nodes may be from the recurrences, over the hair's length: rounding of float32, which
tells the less of the azimuth the nearer to Y a segment is."""
WATCHED = {"root": 0, "middle": SEGMENTS // 2, "tip": SEGMENTS - 1}
VIEW = View(90, 4, 0.60)


def run(client: Client, report: Report, quick: bool) -> None:
    count, size = (60, 160) if quick else (300, 400)
    fields = published.gust(FRAMES)
    hair = [
        published.falling_hair(*pore, 1.0, FALL)
        for pore in published.pores(count, CAP_AXIS, CAP_ANGLE)
    ]
    weakened = {
        "alpha": SHELTER.alpha,
        "near_m": SHELTER.near_m,
        "epsilon": [SHELTER.epsilon] * SEGMENTS,
    }
    with kept(client, hair, scalp=HEAD) as groom:
        played = {
            name: published.play(
                client, groom, fields, published.as_published(equations=name, **weakened)
            )
            for name in EQUATIONS
        }
    theory = {
        name: integrate(EQUATIONS[name], nodes[0], fields, published.push(), SHELTER)
        for name, nodes in played.items()
    }
    frames = np.arange(FRAMES + 1)
    columns = {"frame": frames}
    for name, nodes in played.items():
        off = np.linalg.norm(nodes - theory[name], axis=-1).max() / LENGTH_M
        report.at_most(f"{name}: nodes off the recurrences over the length", off, NODES_OFF[name])
        check_undulation(report, name, nodes)
        up = elevations(nodes)
        for where, segment in WATCHED.items():
            columns[f"{name}_{where}_deg"] = up[..., segment].mean(axis=1)
        columns[f"{name}_bends_back_deg"] = bends_back(nodes).mean(axis=1)
    report.table("angles", columns)
    rows = {f"equations {name}": nodes for name, nodes in played.items()}
    moments = {f"frame {frame}": frame for frame in SHOWN}
    path, look = report.path("frames", ".png"), Look(size=size)
    draw_rows(path, published.drawn_head(), rows, moments, VIEW, look)
    plot(report, played["across"], theory["across"])


def check_undulation(report: Report, name: str, nodes: np.ndarray) -> None:
    """Frame 20 against the last of the old wind."""
    rises = np.diff(elevations(nodes), axis=0)[AFTER - 1] > 0
    for where, holds in (("tip", np.greater), ("root", np.less)):
        part = float(rises[:, WATCHED[where]].mean())
        what = f"{name}: part of {where} segments that still rise in frame {AFTER}"
        report.values[what] = part
        report.fact(what, f"{'>' if where == 'tip' else '<'} 1/2", f"{part:.2f}", holds(part, 0.5))
    for what, of_frames in (
        ("inflections of a hair", published.inflections(nodes).mean(axis=1)),
        ("what of a hair bends the other way [deg]", bends_back(nodes).mean(axis=1)),
    ):
        before, after = of_frames[BEFORE], of_frames[AFTER]
        report.values[f"{name}: {what}, frame {BEFORE}"] = float(before)
        report.values[f"{name}: {what}, frame {AFTER}"] = float(after)
        report.fact(
            f"{name}: {what}, frame {AFTER}",
            f"> {before:.3g}, frame {BEFORE}",
            f"{after:.3g}",
            after > before,
        )


def elevations(nodes: np.ndarray) -> np.ndarray:
    """Angles of segments above the horizon [deg], (frame, guide, segment)."""
    return np.degrees(np.arcsin(np.clip(published.directions(nodes)[..., 1], -1, 1)))


def bends_back(nodes: np.ndarray) -> np.ndarray:
    """Seen from the side, what a curve bends one way and what it bends the other: the lesser of
    them [deg], (frame, guide)."""
    e = published.directions(nodes)
    bends = np.degrees(np.cross(e[..., :-1, :], e[..., 1:, :])[..., 0])
    return np.minimum(np.maximum(bends, 0).sum(axis=-1), np.maximum(-bends, 0).sum(axis=-1))


def plot(report: Report, nodes: np.ndarray, theory: np.ndarray) -> None:
    frames = np.arange(FRAMES + 1)
    up, expected = (elevations(each).mean(axis=1) for each in (nodes, theory))
    with report.figure("angles", columns=3, width=5) as (profile, angles, speeds):
        off_back = np.abs(nodes[0, :, 0, 0]) + nodes[0, :, 0, 2]
        curve = 100 * nodes[:, int(np.argmin(off_back))]
        turn = np.linspace(0, 2 * np.pi, 200)
        profile.fill(*(100 * np.outer(published.RADII_M[[2, 1]], np.ones(200))
                       * np.stack([np.cos(turn), np.sin(turn)])), color="0.85")  # fmt: skip
        for frame in (*SHOWN, 25):
            profile.plot(-curve[frame, :, 2], curve[frame, :, 1], ".-", label=f"frame {frame}")
        profile.set(
            aspect="equal",
            xlabel="back [cm]",
            ylabel="up [cm]",
            title="One hair at the back, from the side",
        )
        for where, segment in WATCHED.items():
            (line,) = angles.plot(frames, up[:, segment], "o", ms=3, label=where)
            angles.plot(frames, expected[:, segment], lw=1, color=line.get_color())
            speeds.plot(frames[1:], np.diff(up[:, segment]), "o", ms=3, color=line.get_color())
            speeds.plot(frames[1:], np.diff(expected[:, segment]), lw=1, color=line.get_color())
        for axes in (angles, speeds):
            axes.axvline(TURNS_AT - 0.5, color="k", ls="--", lw=1, label="the wind turns down")
            axes.set(xlabel="frame")
        speeds.axhline(0, color="k", lw=0.8)
        angles.set(ylabel="above the horizon, mean [deg]", title="Segments (lines: recurrences)")
        speeds.set(ylabel="rises in a frame by, mean [deg]", title="Ends go on with the old wind")
        profile.legend(loc="lower left")
        angles.legend()
