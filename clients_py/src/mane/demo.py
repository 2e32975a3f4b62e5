"""`python -m mane.demo`: hair that a server generates, on a moving head, as a picture and a video.

For every hair type: the server makes a groom on the head (the shipped mannequin, or a mesh of your
own), animates it in LOCKSTEP over the motion at 60 poses a second, and this program draws what came
back. The grooms are deleted afterwards.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from mane import clips, mesh
from mane.beams import AnimationModel
from mane.bodies import Material, ScalpContact
from mane.channel import DEFAULT_SERVER, SERVER_VARIABLE
from mane.client import Client
from mane.errors import Error, InvalidArgument
from mane.groom import GuideGeneration, HairType, StrandModel
from mane.motion import Motion
from mane.painter import Look
from mane.picture import VIEWS, draw_sheet, write_video
from mane.progress import counted, err, out, waiting

RATE_HZ = 60.0
DEFAULT_MOTION = "shake"


class Hair(StrEnum):
    """What `--hair` takes."""

    SMOOTH = "smooth"
    WAVY = "wavy"
    CURLY = "curly"
    FUZZY = "fuzzy"
    ALL = "all"


@dataclass(frozen=True)
class Kind:
    """A hair type, and how to show it.

    hair_color: linear RGB. tip_part: of the drawn wisps, see `Look`. points: along each guide, so
    many that curls show. curl_variation: see `GuideGeneration`; so little that fuzzy guides stay
    wound.
    """

    hair_type: HairType
    hair_color: tuple[float, float, float]
    tip_part: float
    points: int
    curl_variation: float | None = None


KINDS = {
    Hair.SMOOTH: Kind(HairType.ASIAN_SMOOTH, (0.030, 0.022, 0.020), 0.6, 32),
    Hair.WAVY: Kind(HairType.CAUCASIAN_WAVY, (0.180, 0.085, 0.035), 0.5, 48),
    Hair.CURLY: Kind(HairType.CAUCASIAN_CURLY, (0.120, 0.040, 0.018), 0.4, 96),
    Hair.FUZZY: Kind(HairType.AFRICAN_FUZZY, (0.040, 0.025, 0.018), 1.3, 128, 0.08),
}


def demo(
    server: Annotated[
        str, typer.Option(envvar=SERVER_VARIABLE, help="Address of maned, host:port.")
    ] = DEFAULT_SERVER,
    out_dir: Annotated[
        Path, typer.Option("--out", file_okay=False, help="Folder for pictures and videos.")
    ] = Path("."),
    hair: Annotated[Hair, typer.Option(help="Which hair type.")] = Hair.WAVY,
    head: Annotated[
        Path | None,
        typer.Option(
            exists=True,
            dir_okay=False,
            help="OBJ file of a head or a whole body, Y up, face toward +Z; else the mannequin.",
        ),
    ] = None,
    group: Annotated[
        str | None, typer.Option(help="Group of the OBJ file that is the skin; else all of it.")
    ] = None,
    unit: Annotated[float, typer.Option(help="Length of the OBJ file's unit, metres.")] = 1.0,
    motion: Annotated[
        str,
        typer.Option(help=f"A .bvh or .csv file, or a clip: {', '.join(clips.NAMES)}."),
    ] = DEFAULT_MOTION,
    length: Annotated[float, typer.Option(help="Length of the hair, metres.")] = 0.25,
    guides: Annotated[int, typer.Option(min=1, help="Guide strands.")] = 120,
    model: Annotated[
        StrandModel | None, typer.Option(help="As of `mane groom create`; by hair unless given.")
    ] = None,
    animation: Annotated[
        AnimationModel, typer.Option(help="How the hair is animated: as --model of `mane animate`.")
    ] = AnimationModel.SUPER_HELIX,
    seconds: Annotated[
        float | None, typer.Option(min=0.1, help="Only the first seconds of the motion.")
    ] = None,
    substeps: Annotated[int, typer.Option(min=1, max=64, help="Time steps per frame.")] = 1,
    seed: Annotated[int, typer.Option(min=0, help="Of everything random.")] = 1,
    scalp_contact: Annotated[
        bool, typer.Option(help="Let hair meet head and shoulders, and not pass through.")
    ] = True,
    size: Annotated[int, typer.Option(help="Pixels of a picture's side, a multiple of 16.")] = 480,
    video: Annotated[bool, typer.Option(help="Also write videos.")] = True,
) -> None:
    """Hair on a moving head: a picture from two sides at several times, and a short video.

    Examples:

        python -m mane.demo --server 127.0.0.1:7420 --out demo --hair all
        python -m mane.demo --out demo --motion walk --hair curly --length 0.3
        python -m mane.demo --out demo --head body.obj --group body --unit 0.1 --motion walk.bvh
    """
    kinds = KINDS if hair is Hair.ALL else {hair: KINDS[hair]}
    scalp = mesh.load_head(head, group, unit) if head else mesh.mannequin()
    track = load_motion(motion, seconds)
    out_dir.mkdir(parents=True, exist_ok=True)
    with Client(server) as client:
        for name, kind in kinds.items():
            generate = GuideGeneration(
                kind.hair_type,
                guides,
                length,
                seed=seed,
                curl_variation=kind.curl_variation,
                model=model,
            )
            look = Look(kind.hair_color, tip_part=kind.tip_part, size=size)
            positions = animate(
                client,
                scalp,
                generate,
                track,
                kind.points,
                substeps,
                name,
                scalp_contact,
                animation,
            )
            stem = f"{head.stem if head else 'mannequin'}-{Path(motion).stem}-{name}"
            title = f"{name}, {100 * length:g} cm, {guides} guides, {Path(motion).stem}"
            draw(out_dir / stem, scalp, positions, track, title, look, video)


def load_motion(name: str, seconds: float | None = None) -> Motion:
    """A clip by its name, or a .bvh or .csv file, at 60 poses a second; only its first seconds.

    Raises InvalidArgument for what is neither.
    """
    if name in clips.NAMES:
        track = clips.load(name)
    elif Path(name).is_file():
        track = Motion.load(name)
    else:
        raise InvalidArgument.of(
            "motion", f"is {name!r}, must be a .bvh or .csv file or one of {', '.join(clips.NAMES)}"
        )
    track = track.resampled(RATE_HZ)
    if seconds is None:
        return track
    count = max(2, round(seconds * RATE_HZ) + 1)
    return Motion(track.times_s[:count], track.positions[:count], track.orientations[:count])


def animate(
    client: Client,
    scalp: mesh.Mesh,
    generate: GuideGeneration,
    motion: Motion,
    points: int,
    substeps: int,
    label: str,
    scalp_contact: bool = False,
    animation: AnimationModel = AnimationModel.SUPER_HELIX,
) -> np.ndarray:
    """Hair over the whole motion: (frames, guides, points, 3) float32, world [m].

    The server generates a groom for it, which is deleted at the end.
    """
    with waiting(f"{label}: the server makes the groom"):
        groom = client.create_groom(
            scalp=scalp,
            scalp_contact=ScalpContact(Material.SKIN) if scalp_contact else None,
            generate=generate,
            display_name="mane.demo",
        )
    try:
        options = {"points_per_guide": points, "substeps": substeps, "model": animation}
        with client.open_head(groom, "lockstep", **options) as moving:
            frames = counted(moving.play(motion), len(motion), f"{label}: animating")
            return np.stack([frame.positions for frame in frames])
    finally:
        client.delete_groom(groom)


def draw(
    stem: Path,
    scalp: mesh.Mesh,
    positions: np.ndarray,
    motion: Motion,
    title: str,
    look: Look,
    video: bool,
) -> None:
    """Writes `stem`.png and, where wanted, `stem`.mp4, and says where they are."""
    picture, film = (stem.with_name(stem.name + ending) for ending in (".png", ".mp4"))
    with waiting("drawing the picture"):
        draw_sheet(picture, scalp, positions, motion, title=title, look=look)
    out.print(f"{picture.absolute()}: {title}, from {len(VIEWS)} sides at several times")
    if video:
        write_video(
            film,
            scalp,
            positions,
            motion,
            look=look,
            workers=os.cpu_count() or 1,
            progress=lambda pictures: counted(pictures, len(motion), "drawing the video"),
        )
        out.print(f"{film.absolute()}: {len(motion)} frames, {motion.duration_s:.1f} s")


def main() -> None:
    """Runs the demo; what fails is said in one line."""
    try:
        typer.run(demo)
    except (Error, OSError, ImportError) as error:
        err.print(f"error: {' '.join(str(error).split())}", markup=False, style="red")
        raise SystemExit(1) from None


if __name__ == "__main__":
    main()
