"""Long hair over the shoulders of somebody who walks: how deep it gets, and how still it rests."""

from __future__ import annotations

import os
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from mane.bodies import Body, Material, ScalpContact
from mane.client import Client
from mane.demo import KINDS, RATE_HZ, Hair, Kind
from mane.experiments.depth import REACH_M, Solid
from mane.experiments.report import Report
from mane.experiments.scene import kept
from mane.experiments.walker import Walker, walker
from mane.frames import Frame
from mane.groom import GuideGeneration
from mane.motion import Motion
from mane.painter import Look
from mane.picture import draw_sheet
from mane.pose import Pose

LENGTHS_M = (0.3, 0.45)
HAIRS = (Hair.SMOOTH, Hair.WAVY)
SEED = 1
POINTS = 64  # So near each other that what cuts a corner between points that meet bodies shows.
BEFORE_S = 1.0
AFTER_S = 5.0
STANDS_S = 6.0
"""Without walking, as long as that; in the last second tips are watched."""
EVERY = 3
"""Of so many frames one is searched for points that are deep."""
ROOT_M = 6e-3
"""Hair leaves the skin up to here."""
EDGE_M = 0.03
"""So near the edges where a body is cut off at the waist nothing is measured."""
STANDING_M, WALKING_M = 1e-3, 3e-3
"""How deep hair may get."""
RESTING_M_S = 1e-3


@dataclass(frozen=True)
class Played:
    """What came back. positions: (frame, guide, point, 3) world [m]; step_ms: (frame,). motion: of
    the head and all bodies. limits: how deep hair may be, (frame,) [m]."""

    positions: np.ndarray
    step_ms: np.ndarray
    motion: Motion
    limits: np.ndarray

    @staticmethod
    def of(frames: list[Frame], motion: Motion, limits: np.ndarray) -> Played:
        steps = np.array([frame.step_ms for frame in frames])
        return Played(np.stack([frame.positions for frame in frames]), steps, motion, limits)


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
            played, stood = animate(client, figure, KINDS[hair], length_m, guides)
            for what, each in (("stands", stood), ("walks", played)):
                deepest[name] = depths(report, f"{name}, {what}", solids, each, length_m)
            speeds[name] = resting(report, name, stood, played)
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
        limits = played.limits
        depth_axes.plot(times, 1e3 * limits, "k--", lw=1, label="limit")
        depth_axes.set(ylabel="deepest point [mm]", ylim=(-1, None), title="Depth in the body")
        speed_axes.axhline(1e3 * RESTING_M_S, color="k", ls="--", lw=1)
        speed_axes.set(ylabel="fastest tip, in the head's axes [mm/s]", title="Coming to rest")
        step_axes.set(ylabel="step on the server [ms]", title=f"Time, {guides} guides")
        step_axes.legend()


def animate(
    client: Client, figure: Walker, kind: Kind, length_m: float, guides: int
) -> tuple[Played, Played]:
    """Hair that the server generates, over the whole walk, and while the figure stands upright."""
    first = next(figure.motion.poses())
    generate = GuideGeneration(
        kind.hair_type, guides, length_m, seed=SEED, curl_variation=kind.curl_variation
    )
    at_first = {name: on_head(first, first.bodies[name]) for name in figure.parts}
    bodies = [
        Body(name, part, Material.COTTON, moving=True, pose=at_first[name])
        for name, part in figure.parts.items()
    ]
    times = np.arange(round(STANDS_S * RATE_HZ) + 1) / RATE_HZ
    standing = Motion(
        times,
        bodies={
            name: Motion(
                times,
                np.tile(pose.position, (len(times), 1)),
                np.tile(pose.orientation, (len(times), 1)),
            )
            for name, pose in at_first.items()
        },
    )
    content = {"scalp": figure.head, "scalp_contact": ScalpContact(Material.SKIN)}
    played = []
    with kept(client, generate=generate, bodies=bodies, **content) as groom:
        for motion, limits in (
            (figure.motion, np.where(figure.walking(), WALKING_M, STANDING_M)),
            (standing, np.full(len(standing), STANDING_M)),
        ):
            begin = next(motion.poses())
            options = {"points_per_guide": POINTS, "initial_pose": begin}
            with client.open_head(groom, "lockstep", **options) as head:
                played.append(Played.of(list(head.play(motion)), motion, limits))
    return played[0], played[1]


def on_head(head: Pose, body: Pose) -> Pose:
    """Body -> head, of two poses in the world."""
    turn = Rotation.from_quat(head.orientation).inv()
    orientation = (turn * Rotation.from_quat(body.orientation)).as_quat()
    return Pose(position=turn.apply(body.position - head.position), orientation=orientation)


def depths(
    report: Report, name: str, solids: dict[str, Solid], played: Played, length_m: float
) -> np.ndarray:
    """The deepest point of every frame that is searched, (frame,) [m]; reports the worst."""
    points = played.positions.shape[2]
    first = int(np.ceil(ROOT_M / length_m * (points - 1)))
    lines = played.positions[::EVERY, :, first:].astype(np.float64)
    times, limits = played.motion.times_s[::EVERY], played.limits[::EVERY]
    by_part = {}
    for part, solid in solids.items():
        motion = played.motion if part == "head" else played.motion.bodies[part]
        inside = within(lines, motion, EVERY)
        by_part[part] = solid.depths(inside)
        if part != "head":
            by_part[part][inside[..., 1] < solid.lowest_m + EDGE_M] = -REACH_M
    deepest = np.max(list(by_part.values()), axis=0)
    for limit in np.unique(limits):
        frames = limits == limit
        found = {part: depth[frames].max() for part, depth in by_part.items()}
        part = max(found, key=found.get)
        what = f"{name}: deepest point, limit {1e3 * limit:g} mm"
        report.at_most(what, 1e3 * found[part], 1e3 * limit, " mm")
        frame, guide, point = np.unravel_index(
            by_part[part][frames].argmax(), by_part[part][frames].shape
        )
        report.values[f"{what}, its time [s]"] = float(times[frames][frame])
        report.values[f"{what}, its guide"] = int(guide)
        report.values[f"{what}, its way along the guide [m]"] = (
            length_m * (point + first) / (points - 1)
        )
        for each, depth in found.items():
            report.values[f"{what}, in {each} [mm]"] = float(1e3 * depth)
        deep = deepest[frames] > limit
        report.values[f"{what}, part of all points that are deeper"] = float(deep.mean())
        report.values[f"{what}, guides that ever are"] = int(deep.any(axis=(0, 2)).sum())
    return deepest.max(axis=(1, 2))


def resting(report: Report, name: str, stood: Played, played: Played) -> np.ndarray:
    """Speed of the fastest tip in the head's axes, (frame - 1,) [m/s], over the walk; reports that
    of hair that has stood."""
    speeds = []
    for each in (stood, played):
        tips = within(each.positions[:, :, [-1]].astype(np.float64), each.motion)[:, :, 0]
        speeds.append(np.linalg.norm(np.diff(tips, axis=0), axis=2) * RATE_HZ)
    late = speeds[0][-round(RATE_HZ) :].max(axis=0)
    what = f"{name}: fastest tip after {STANDS_S - 1:g} s of standing"
    report.at_most(what, 1e3 * late.max(), 1e3 * RESTING_M_S, " mm/s")
    report.values[f"{what}, its guide"] = int(late.argmax())
    report.values[f"{what}, tips faster than the limit"] = int((late > RESTING_M_S).sum())
    report.values[f"{name}: fastest tip {AFTER_S:g} s after the walk [mm/s]"] = float(
        1e3 * speeds[1][-1].max()
    )
    report.values[f"{name}: step, median [ms]"] = float(np.median(played.step_ms))
    report.values[f"{name}: step, longest [ms]"] = float(played.step_ms.max())
    return speeds[1].max(axis=1)


def within(lines: np.ndarray, motion: Motion, every: int = 1) -> np.ndarray:
    """Positions (frame, guide, point, 3) from the world's axes into those of a body, whose motion
    has `every` times as many frames."""
    turns = Rotation.from_quat(motion.orientations[::every]).as_matrix()
    return np.einsum("fgpj,fji->fgpi", lines - motion.positions[::every, None, None], turns)
