"""`mane animate` and `mane bake`: motion in, hair out."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from mane.beams import AnimationModel
from mane.client import Client
from mane.convert import CONVENTIONS
from mane.frames import Frame, FrameFormat
from mane.mesh import Mesh
from mane.motion import Motion, read_bvh
from mane.progress import counted, err, out, waiting, watched


def writable(path: Path | None) -> Path | None:
    """Refuses a file in a folder that does not exist, before the work rather than after it."""
    if path is not None and not path.absolute().parent.is_dir():
        raise typer.BadParameter(f"{path.parent} is not a folder")
    return path


_File = Annotated[
    Path,
    typer.Argument(
        exists=True, dir_okay=False, metavar="FILE", help="Head motion: a .bvh or .csv file."
    ),
]
_Groom = Annotated[str, typer.Option("-g", "--groom", help="Which hair, such as demo.")]
_Output = Annotated[
    Path,
    typer.Option(
        "-o", "--output", dir_okay=False, callback=writable, help="The .npz file to write."
    ),
]
_Picture = Annotated[
    Path | None,
    typer.Option(
        dir_okay=False,
        callback=writable,
        help="Also draw the hair at several times into this PNG file.",
    ),
]
_Rate = Annotated[float, typer.Option(min=1, help="Poses and frames per second.")]
_Points = Annotated[int, typer.Option(min=2, max=256, help="Points along each guide.")]
_Substeps = Annotated[int, typer.Option(min=1, max=64, help="Time steps per frame.")]
_Format = Annotated[FrameFormat, typer.Option(help="How frames travel to this program.")]
_Model = Annotated[AnimationModel, typer.Option(help="How the hair is animated.")]
_Joint = Annotated[str, typer.Option(help="BVH: the joint that carries the head.")]
_Height = Annotated[float, typer.Option(help="BVH: how tall the figure stands, metres.")]
_Axes = Annotated[str, typer.Option(help=f"BVH: the file's axes: {', '.join(CONVENTIONS)}.")]


def animate(
    context: typer.Context,
    file: _File,
    groom: _Groom,
    output: _Output,
    picture: _Picture = None,
    rate: _Rate = 60.0,
    points: _Points = 16,
    substeps: _Substeps = 1,
    format: _Format = FrameFormat.FLOAT32,
    model: _Model = AnimationModel.SUPER_HELIX,
    joint: _Joint = "Head",
    height: _Height = 1.7,
    axes: _Axes = "mane",
) -> None:
    """Stream a head motion to the server, and keep the hair that comes back.

    Examples:

    ```
    mane animate walk.bvh -g demo -o walk.npz
    mane animate walk.bvh -g demo -o walk.npz --picture walk.png --rate 120
    mane animate nod.csv -g demo -o nod.npz --points 32 --format generalized
    mane animate walk.bvh -g demo -o far.npz --model beam
    ```

    The .npz file holds times_s (frame), positions (frame, guide, point, 3) in world metres, and
    head_positions and head_orientations (x, y, z, w) of every frame. A CSV file has the columns
    time_s,x,y,z,qx,qy,qz,qw.
    """
    client: Client = context.obj
    motion = _load(file, rate, joint, height, axes)
    options = {"format": format, "points_per_guide": points, "substeps": substeps, "model": model}
    with client.open_head(groom, "lockstep", **options) as head:
        frames = counted(head.play(motion), len(motion), f"animating {groom}")
        positions = _collect(frames, len(motion))
    _save(output, motion, positions)
    if picture:
        _draw(client, groom, picture, motion, positions)


def bake(
    context: typer.Context,
    file: _File,
    groom: _Groom,
    output: _Output,
    picture: _Picture = None,
    rate: _Rate = 60.0,
    points: _Points = 16,
    substeps: _Substeps = 1,
    format: _Format = FrameFormat.FLOAT32,
    model: _Model = AnimationModel.SUPER_HELIX,
    joint: _Joint = "Head",
    height: _Height = 1.7,
    axes: _Axes = "mane",
) -> None:
    """Let the server animate a whole motion as a job, wait for it, and fetch the hair.

    Examples:

    ```
    mane bake walk.bvh -g demo -o walk.npz
    mane bake dance.csv -g demo -o dance.npz --picture dance.png --substeps 4
    ```

    The same frames as `mane animate`, but the work survives a restart of the server; `mane job`
    follows and cancels it. Interrupting this command cancels the job.
    """
    client: Client = context.obj
    motion = _load(file, rate, joint, height, axes)
    options = {"format": format, "points_per_guide": points, "substeps": substeps, "model": model}
    job = client.bake(groom, motion, **options)
    try:
        for _ in watched(job.watch(), f"baking {job.name}"):
            pass
    except KeyboardInterrupt:
        job.cancel()
        err.print(f"cancelled {job.name}")
        raise
    job.job.require_success()
    frames = counted(job.frames(), len(motion), "fetching frames")
    positions = _collect(frames, len(motion))
    _save(output, motion, positions)
    if picture:
        _draw(client, groom, picture, motion, positions)


def _load(file: Path, rate_hz: float, joint: str, height_m: float, axes: str) -> Motion:
    if file.suffix.lower() == ".bvh":
        motion = read_bvh(file, joint, height_m, axes=axes)
    else:
        motion = Motion.load(file)
    return motion.resampled(rate_hz)


def _collect(frames: Iterable[Frame], count: int) -> np.ndarray:
    """Positions of all frames, (frame, guide, point, 3) float32."""
    positions = None
    for row, frame in enumerate(frames):
        if positions is None:
            positions = np.empty((count, *frame.positions.shape), np.float32)
        positions[row] = frame.positions
    return positions


def _save(output: Path, motion: Motion, positions: np.ndarray) -> None:
    with open(output, "wb") as file:
        np.savez(
            file,
            times_s=motion.times_s,
            positions=positions,
            head_positions=motion.positions,
            head_orientations=motion.orientations,
        )
    frames, guides, points, _ = positions.shape
    out.print(f"{output}: {frames} frames, {guides} guides, {points} points")


def _draw(client: Client, groom: str, picture: Path, motion: Motion, positions) -> None:
    from mane.picture import draw_sheet  # Only here: it takes a while to load.

    scalp = client.export_groom(groom, hairs=False).scalp
    with waiting("drawing"):
        draw_sheet(picture, scalp if isinstance(scalp, Mesh) else None, positions, motion)
    out.print(f"{picture}: the hair at several times")
