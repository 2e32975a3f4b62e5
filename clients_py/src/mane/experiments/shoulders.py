"""Long hair over the shoulders of somebody who walks: how deep it gets, and how still it rests."""

from __future__ import annotations

import os
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from mane.bodies import Body, Material, ScalpContact
from mane.client import Client
from mane.demo import KINDS, RATE_HZ, Hair, Kind
from mane.experiments.depth import Solid
from mane.experiments.report import Report
from mane.experiments.scene import kept
from mane.experiments.walker import Walker, walker
from mane.groom import GuideGeneration
from mane.motion import Motion
from mane.painter import Look
from mane.picture import draw_sheet
from mane.pose import Pose

LENGTHS_M = (0.3, 0.45)
HAIRS = (Hair.SMOOTH, Hair.WAVY)
SEED = 1
POINTS = 96  # So near each other that what cuts a corner between points that meet bodies shows.
BEFORE_S = 2.0
AFTER_S = 6.0
REST_S = 5.0
"""How long after the last step tips are watched, for the time that is left."""
EVERY = 2
"""Of so many frames one is searched for points that are deep."""
ROOT_M = 6e-3
"""Hair leaves the skin up to here."""
STANDING_M, WALKING_M = 1e-3, 3e-3
"""How deep hair may get."""
RESTING_M_S = 1e-3


@dataclass(frozen=True)
class Played:
    """What came back. positions: (frame, guide, point, 3) world [m]; step_ms: (frame,)."""

    positions: np.ndarray
    step_ms: np.ndarray


def run(
    client: Client,
    report: Report,
    quick: bool,
    body: str | os.PathLike | None = None,
    group: str | None = None,
    unit_m: float = 1.0,
    motion: str | os.PathLike | None = None,
) -> None:
    guides, size = (24, 160) if quick else (120, 320)
    figure = walker(body, group, unit_m, motion, BEFORE_S, AFTER_S)
    times = figure.motion.times_s
    solids = {name: Solid(part) for name, part in {"head": figure.head, **figure.parts}.items()}
    deepest, speeds, steps = {}, {}, {}
    for hair in HAIRS[1:] if quick else HAIRS:
        for length_m in LENGTHS_M[1:] if quick else LENGTHS_M:
            name = f"{hair} {100 * length_m:g} cm"
            played = animate(client, figure, KINDS[hair], length_m, guides)
            deepest[name] = depths(report, name, figure, solids, played, length_m)
            speeds[name] = resting(report, name, figure, played)
            steps[name] = played.step_ms
            part = name.replace(" ", "-")
            look = Look(KINDS[hair].hair_color, tip_part=KINDS[hair].tip_part, size=size)
            draw_sheet(
                report.path(part, ".png"), figure.head, played.positions, figure.motion,
                title=f"{name}, {guides} guides", look=look, bodies=figure.parts,
            )  # fmt: skip
    tables = ("depth", "deepest_m", deepest, EVERY), ("steps", "step_ms", steps, 1)
    for part, kind, rows, every in tables:
        columns = {f"{kind}_{name}".replace(" ", "_"): values for name, values in rows.items()}
        report.table(part, {"time_s": times[::every]} | columns)
    with report.figure("depth", columns=3, width=5) as (depth_axes, speed_axes, step_axes):
        for name in deepest:
            depth_axes.plot(times[::EVERY], 1e3 * deepest[name], label=name)
            speed_axes.semilogy(times[1:], 1e3 * np.maximum(speeds[name], 1e-8), label=name)
            step_axes.plot(times, steps[name], lw=0.7, label=name)
        walks = times[figure.walks.start], times[figure.walks.stop - 1]
        for axes in (depth_axes, speed_axes, step_axes):
            axes.axvspan(*walks, alpha=0.1, color="k", label="walks")
            axes.set(xlabel="time [s]")
        limits = np.where(figure.walking(), WALKING_M, STANDING_M)
        depth_axes.plot(times, 1e3 * limits, "k--", lw=1, label="limit")
        depth_axes.set(ylabel="deepest point [mm]", ylim=(-1, None), title="Depth in the body")
        speed_axes.axhline(1e3 * RESTING_M_S, color="k", ls="--", lw=1)
        speed_axes.set(ylabel="fastest tip, in the head's axes [mm/s]", title="Coming to rest")
        step_axes.set(ylabel="step on the server [ms]", title=f"Time, {guides} guides")
        depth_axes.legend()


def animate(client: Client, figure: Walker, kind: Kind, length_m: float, guides: int) -> Played:
    """Hair that the server generates, over the whole walk."""
    first = next(figure.motion.poses())
    generate = GuideGeneration(
        kind.hair_type, guides, length_m, seed=SEED, curl_variation=kind.curl_variation
    )
    bodies = [
        Body(name, part, Material.COTTON, moving=True, pose=on_head(first, first.bodies[name]))
        for name, part in figure.parts.items()
    ]
    content = {"scalp": figure.head, "scalp_contact": ScalpContact(Material.SKIN)}
    with (
        kept(client, generate=generate, bodies=bodies, **content) as groom,
        client.open_head(
            groom, "lockstep", points_per_guide=POINTS, initial_pose=first
        ) as head,
    ):
        frames = list(head.play(figure.motion))
    positions = np.stack([frame.positions for frame in frames])
    return Played(positions, np.array([frame.step_ms for frame in frames]))


def on_head(head: Pose, body: Pose) -> Pose:
    """Body -> head, of two poses in the world."""
    turn = Rotation.from_quat(head.orientation).inv()
    orientation = (turn * Rotation.from_quat(body.orientation)).as_quat()
    return Pose(position=turn.apply(body.position - head.position), orientation=orientation)


def depths(
    report: Report, name: str, figure: Walker, solids: dict[str, Solid], played: Played,
    length_m: float,
) -> np.ndarray:  # fmt: skip
    """The deepest point of every frame, (frame,) [m], and where that is too deep."""
    points = played.positions.shape[2]
    first = int(np.ceil(ROOT_M / length_m * (points - 1)))
    lines = played.positions[::EVERY, :, first:].astype(np.float64)
    by_part = {}
    for part, solid in solids.items():
        motion = figure.motion if part == "head" else figure.motion.bodies[part]
        by_part[part] = solid.depths(within(lines, motion, EVERY))
    walking = figure.walking()[::EVERY]
    for what, frames, limit in (
        ("stands", ~walking, STANDING_M), ("walks", walking, WALKING_M),
    ):  # fmt: skip
        found = {part: d[frames].max() for part, d in by_part.items()}
        part = max(found, key=found.get)
        report.at_most(f"{name}: deepest point while it {what}", 1e3 * found[part],
                       1e3 * limit, " mm")  # fmt: skip
        those = by_part[part][frames]
        frame, guide, point = np.unravel_index(those.argmax(), those.shape)
        where = f"{name}: deepest point while it {what}, its"
        report.values[f"{where} time [s]"] = float(figure.motion.times_s[::EVERY][frames][frame])
        report.values[f"{where} guide"] = int(guide)
        along_m = length_m * (point + first) / (points - 1)
        report.values[f"{where} way along the guide [m]"] = along_m
        for each, depth in found.items():
            report.values[f"{name}: deepest in {each} while it {what} [mm]"] = float(1e3 * depth)
    return np.max([d.max(axis=(1, 2)) for d in by_part.values()], axis=0)


def resting(report: Report, name: str, figure: Walker, played: Played) -> np.ndarray:
    """Speed of the fastest tip in the head's axes, (frame - 1,) [m/s]; reports what is left."""
    tips = within(played.positions[:, :, [-1]].astype(np.float64), figure.motion)[:, :, 0]
    speed = np.linalg.norm(np.diff(tips, axis=0), axis=2) * RATE_HZ
    since = figure.motion.times_s[1:] - figure.motion.times_s[figure.walks.stop - 1]
    late = speed[since >= REST_S]
    what = f"{name}: fastest tip {REST_S:g} s after the last step"
    report.at_most(what, 1e3 * late.max(), 1e3 * RESTING_M_S, " mm/s")
    report.values[f"{what}, its guide"] = int(late.max(axis=0).argmax())
    report.values[f"{name}: tips faster than that"] = int((late.max(axis=0) > RESTING_M_S).sum())
    report.values[f"{name}: step, median [ms]"] = float(np.median(played.step_ms))
    report.values[f"{name}: step, longest [ms]"] = float(played.step_ms.max())
    return speed.max(axis=1)


def within(lines: np.ndarray, motion: Motion, every: int = 1) -> np.ndarray:
    """Positions (frame, guide, point, 3) from the world's axes into those of a body, whose motion
    has `every` times as many frames."""
    turns = Rotation.from_quat(motion.orientations[::every]).as_matrix()
    return np.einsum("fgpj,fji->fgpi", lines - motion.positions[::every, None, None], turns)
