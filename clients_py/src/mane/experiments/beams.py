"""Beams against Super-Helices: the same hair and motion, and changing over between them."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import AbstractContextManager
from itertools import product

import numpy as np

from mane import mesh
from mane.beams import AnimationModel
from mane.bodies import Material, ScalpContact
from mane.client import Client
from mane.demo import KINDS, RATE_HZ, Hair
from mane.experiments.depth import Solid
from mane.experiments.report import Report
from mane.experiments.scene import kept
from mane.experiments.sheet import draw_rows
from mane.experiments.swings import STOPS_S, free_swing, shake, stop
from mane.groom import Groom, GuideGeneration
from mane.motion import Motion
from mane.painter import Look, View

HAIRS = (Hair.SMOOTH, Hair.WAVY, Hair.CURLY)
HELIX, BEAM = AnimationModel.SUPER_HELIX, AnimationModel.BEAM
NAMES = {HELIX: "Super-Helix", BEAM: "beam"}
ON_SCALP = "on the scalp, stop"
MOTIONS = {"free, stop": stop(), "free, shake": shake(), ON_SCALP: stop()}
LENGTH_M = 0.25
CURVE_POINTS = 256
SUBSTEPS = 4  # So that damping is the models' rather than the steps'.

CHANGES = {round(1.0 * RATE_HZ): BEAM, round(2.0 * RATE_HZ): HELIX}
"""Frames of the shake from which on hair has the model."""
BEFORE = round(0.25 * RATE_HZ)
"""Frames before a change whose motion counts."""
SHOWN_S = (0.0, 0.1, 0.25, 0.5, 1.0)
"""After the stop."""
VIEW = View(20, 6, 0.72)

DEEP_M = 3e-3
EVERY = 6
"""Of so many frames one is searched for points that are deep."""

MOST_JUMP = 1.5
MOST_AFTER = 3.0
MOST_INSIDE = {HELIX: 0.01, BEAM: 0.2}
"""Beams stay out of an ellipsoid that is inside the head, and know nothing of neck and shoulders."""
MOST_OFF_REST_M = 5e-4
MOST_STRETCH = 1e-4


def run(client: Client, report: Report, quick: bool) -> None:
    guides, many, size = (16, 160, 160) if quick else (100, 2000, 320)
    head = mesh.mannequin()
    solid, aside, moves, wavy = Solid(head), {}, {}, {}
    for hair in HAIRS:
        for meets, names in ((False, ("free, stop", "free, shake")), (True, (ON_SCALP,))):
            with grown(client, head, hair, guides, meets) as groom:
                for name, model in product(names, NAMES):
                    played = animated(client, groom, MOTIONS[name], {0: model})
                    tips = played[:, :, -1, 0]
                    swing = aside[hair, name, model] = (tips - tips[0]).mean(axis=1)
                    tell(report, f"{hair}, {name}", model, played, solid if meets else None)
                    tell_swing(report, hair, name, model, swing)
                    if hair is Hair.WAVY and meets:
                        wavy[f"{hair}, {NAMES[model]}"] = played
                if meets:
                    off = off_rest(client, groom)
                    what = f"{hair}: beams' nodes off the rods' rest shape"
                    report.at_most(what, 1e3 * off, 1e3 * MOST_OFF_REST_M, " mm")
                    moves[hair] = check_changes(client, report, hair, groom)
    tell_times(client, report, head, many)
    for name, motion in MOTIONS.items():
        columns = {
            f"{hair}_{model}_m".replace("-", "_"): aside[hair, name, model]
            for hair in HAIRS
            for model in NAMES
        }
        report.table(
            name.replace(", ", "-").replace(" ", "-"), {"time_s": motion.times_s} | columns
        )
    moments = {f"{after:g} s": round((STOPS_S + after) * RATE_HZ) for after in SHOWN_S}
    look = Look(KINDS[Hair.WAVY].hair_color, tip_part=KINDS[Hair.WAVY].tip_part, size=size)
    draw_rows(report.path("frames", ".png"), head, wavy, moments, VIEW, look)
    plot(report, aside, moves)


def grown(
    client: Client, head: mesh.Mesh, hair: Hair, guides: int, meets: bool
) -> AbstractContextManager[Groom]:
    kind = KINDS[hair]
    generate = GuideGeneration(
        kind.hair_type, guides, LENGTH_M, seed=1, curl_variation=kind.curl_variation
    )
    contact = ScalpContact(Material.SKIN) if meets else None
    return kept(client, scalp=head, scalp_contact=contact, generate=generate)


def animated(
    client: Client, groom: Groom, motion: Motion, models: Mapping[int, AnimationModel]
) -> np.ndarray:
    """Points of hair in the head's axes, nodes where it is beams, (frame, guide, point, 3) [m].
    models: what it is animated by, by the frame from which on it is."""
    options = {
        "space": "head",
        "points_per_guide": segments_of(client, groom) + 1,
        "substeps": SUBSTEPS,
        "model": models.get(0, HELIX),
    }
    frames = []
    with client.open_head(groom, "lockstep", **options) as head:
        for index, pose in enumerate(motion.poses()):
            if index and index in models:
                head.set_model(models[index])
            frames.append(head.step(pose).positions)
    return np.stack(frames).astype(np.float64)


def segments_of(client: Client, groom: Groom) -> int:
    """Of each guide as a beam: what the server finds that its curls take."""
    with client.open_head(groom, "lockstep", model=BEAM) as head:
        frame = head.step(next(Motion(np.zeros(1)).poses()))
    return frame.stepped_elements // len(frame.positions)


def stretch(nodes: np.ndarray) -> float:
    """The largest relative change of a segment's length."""
    lengths = np.linalg.norm(np.diff(nodes, axis=2), axis=3)
    return float(np.abs(lengths / lengths[0] - 1).max())


def tell(
    report: Report, what: str, model: AnimationModel, played: np.ndarray, solid: Solid | None
) -> None:
    """Lengths of beams, and where hair meets the scalp what of it goes through."""
    if model is BEAM:
        stretched = f"{what}: most that a beam's segment is stretched by"
        report.at_most(stretched, stretch(played), MOST_STRETCH)
    if solid is not None:
        inside = f"{what}, {NAMES[model]}: part of points in the skin"
        report.at_most(inside, part_inside(solid, played), MOST_INSIDE[model])


def tell_swing(report: Report, hair: Hair, name: str, model: AnimationModel, aside) -> None:
    found = {"largest swing [mm]": float(1e3 * np.abs(aside).max())}
    if name.endswith("stop"):
        found = free_swing(MOTIONS[name], aside)
    for what, value in found.items():
        report.values[f"{hair}, {name}, {NAMES[model]}: {what}"] = value


def part_inside(solid: Solid, points: np.ndarray) -> float:
    """Of all but roots, how many are deeper than `DEEP_M` and not beyond reach, where most are."""
    depths = solid.depths(points[::EVERY, :, 1:])
    return float((depths > DEEP_M).mean(axis=(1, 2)).max())


def off_rest(client: Client, groom: Groom) -> float:
    """How far nodes of beams that stand still are from the curves at which rods rest [m]."""
    still = Motion(np.arange(30) / RATE_HZ)
    nodes = animated(client, groom, still, {0: BEAM})[-1]
    with client.open_head(groom, "lockstep", space="head", points_per_guide=CURVE_POINTS) as head:
        curves = head.step(next(still.poses())).positions.astype(np.float64)
    begin, along = curves[:, None, :-1], np.diff(curves, axis=1)[:, None]
    away = nodes[:, :, None] - begin
    part = (away * along).sum(-1) / np.maximum((along**2).sum(-1), 1e-18)
    nearest = np.clip(part, 0, 1)[..., None] * along
    return float(np.linalg.norm(away - nearest, axis=-1).min(axis=2).max())


def check_changes(client: Client, report: Report, hair: Hair, groom: Groom) -> np.ndarray:
    """The largest motion of any point from one frame to the next, (frame - 1,) [m], while the head
    shakes and changes its model."""
    points = animated(client, groom, shake(), CHANGES)
    moves = np.linalg.norm(np.diff(points, axis=0), axis=-1).max(axis=(1, 2))
    for frame, model in CHANGES.items():
        before = moves[frame - 1 - BEFORE : frame - 1].max()
        what = f"{hair}: motion in the frame of a change to {NAMES[model]}, over that before"
        report.at_most(what, moves[frame - 1] / before, MOST_JUMP)
        after = moves[frame - 1 : frame - 1 + BEFORE].max()
        what = f"{hair}: in a quarter of a second after the change to {NAMES[model]}"
        report.at_most(what, float(after / before), MOST_AFTER)
    return moves


def tell_times(client: Client, report: Report, head: mesh.Mesh, guides: int) -> None:
    """Median time that the server spends on a frame of the shake, a step each."""
    for meets, where in ((False, "free"), (True, "on the scalp")):
        with grown(client, head, Hair.WAVY, guides, meets) as groom:
            times = {}
            for model, name in NAMES.items():
                with client.open_head(groom, "lockstep", model=model) as played:
                    times[model] = np.median([frame.step_ms for frame in played.play(shake())])
                what = f"{Hair.WAVY}, {where}, {guides} guides, {name}: a frame [ms]"
                report.values[what] = float(times[model])
        report.values[f"{Hair.WAVY}, {where}: time of Super-Helices over that of beams"] = float(
            times[HELIX] / times[BEAM]
        )


def plot(report: Report, aside: dict, moves: dict) -> None:
    with report.figure("swing", columns=3, rows=len(MOTIONS), width=5) as every:
        for axes, (hair, name) in zip(
            every, ((hair, name) for name in MOTIONS for hair in HAIRS), strict=True
        ):
            for model, label in NAMES.items():
                axes.plot(MOTIONS[name].times_s, 100 * aside[hair, name, model], label=label)
            if name.endswith("stop"):
                axes.axvline(STOPS_S, color="k", ls="--", lw=1, label="the head stops")
            axes.set(xlabel="time [s]", ylabel="tips aside, mean [cm]", title=f"{hair}, {name}")
            axes.legend()
    with report.figure("changes", columns=3, width=5) as every:
        for axes, hair in zip(every, HAIRS, strict=True):
            axes.plot(shake().times_s[1:], 1e3 * moves[hair], color="k", lw=1)
            begin, end = (frame / RATE_HZ for frame in CHANGES)
            axes.axvspan(begin, end, color="C1", alpha=0.2, label="beams")
            axes.set(
                xlabel="time [s]",
                ylabel="largest motion of a point in a frame [mm]",
                title=f"{hair}: no jump where the model changes",
                ylim=(0, None),
            )
            axes.legend()
