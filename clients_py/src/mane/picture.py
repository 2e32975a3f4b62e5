"""Pictures and videos of animated hair on a head, as files. mane.painter draws them."""

from __future__ import annotations

import multiprocessing
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from types import MappingProxyType

import numpy as np

from mane.errors import InvalidArgument
from mane.mesh import Mesh
from mane.motion import Motion
from mane.painter import Look, Painter, View

VIEWS = (View(35, 8), View(150, 12))
"""Three-quarter front and three-quarter back."""

_DEFAULT_LOOK = Look()
_FRAMES_PER_WORKER = 30  # For fewer it is not worth starting another process.


def draw_sheet(
    path: str | os.PathLike,
    mesh: Mesh | None,
    positions: np.ndarray,
    motion: Motion,
    *,
    moments: int = 5,
    views: Sequence[View] = VIEWS,
    title: str = "",
    look: Look = _DEFAULT_LOOK,
    bodies: Mapping[str, Mesh] = MappingProxyType({}),
) -> None:
    """Writes one picture: a row for every view, a column for every one of `moments` moments.

    path: the file's ending chooses its format, such as .png. mesh: the head, or None for hair
    alone. positions: (frames, guides, points, 3) world [m]. motion: the head pose of every frame.
    bodies: what else is drawn, by the names in `motion.bodies`. The moments are spread evenly from
    the first frame to the last.

    Raises InvalidArgument for shapes that do not fit and numbers that are not finite.
    """
    from PIL import Image, ImageDraw, ImageFont

    painter, size = Painter(mesh, positions, motion, look, bodies), look.size
    chosen = np.linspace(0, len(motion) - 1, max(1, min(moments, len(motion)))).round().astype(int)
    rows = [np.hstack([painter.frame(index, view) for index in chosen]) for view in views]
    sheet = Image.fromarray(np.vstack(rows))
    draw, font = ImageDraw.Draw(sheet), ImageFont.load_default(max(10, size // 26))
    for column, index in enumerate(chosen):
        seconds = motion.times_s[index] - motion.times_s[0]
        draw.text((size * column + size // 40, size // 60), f"{seconds:.2f} s", (20, 22, 26), font)
    draw.text((size // 40, sheet.height - size // 14), title, (235, 235, 235), font)
    sheet.save(path)


def write_video(
    path: str | os.PathLike,
    mesh: Mesh | None,
    positions: np.ndarray,
    motion: Motion,
    *,
    views: Sequence[View] = VIEWS,
    look: Look = _DEFAULT_LOOK,
    workers: int = 1,
    progress: Callable[[Iterable], Iterable] = iter,
) -> None:
    """Writes an H.264 MP4 with the views side by side, one picture a frame, at the motion's rate.

    workers: at most so many processes draw, at least 1. With more than one, the main module of the
    calling program must be safe to import (`if __name__ == "__main__":`). progress: gives back what
    it is given, the pictures, and may count them on the way, as progress bars do. The other
    arguments are those of `draw_sheet`.

    Raises InvalidArgument as `draw_sheet` does, and for fewer than two poses.
    """
    import imageio_ffmpeg

    if len(motion) < 2:
        raise InvalidArgument.of("motion", f"has {len(motion)} pose, must have at least 2")
    painter = Painter(mesh, positions, motion, look)
    # Else it forks, and a fork of a process that talks gRPC may break.
    os.environ.setdefault("IMAGEIO_FFMPEG_NO_PREVENT_SIGINT", "1")
    writer = imageio_ffmpeg.write_frames(
        str(path),
        (look.size * len(views), look.size),
        fps=(len(motion) - 1) / motion.duration_s,
        codec="libx264",
        quality=7,
        macro_block_size=16,
        ffmpeg_log_level="error",
    )
    writer.send(None)
    try:
        useful = min(workers, -(-len(motion) // _FRAMES_PER_WORKER))
        pictures = _draw_all(painter, len(motion), views, useful)
        for picture in progress(pictures):
            writer.send(picture)
    finally:
        writer.close()


def _draw_all(painter: Painter, frames: int, views, workers: int) -> Iterator[np.ndarray]:
    """The pictures of all frames in order, drawn by that many processes."""
    if workers == 1:
        yield from (_side_by_side(painter, index, views) for index in range(frames))
        return
    # Spawned, because a fork of a process that talks gRPC may hang.
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(workers, context, _take, (painter, views)) as pool:
        for first in range(0, frames, 4 * workers):  # In batches, so that few pictures wait.
            yield from pool.map(_draw_taken, range(first, min(first + 4 * workers, frames)))


def _side_by_side(painter: Painter, index: int, views: Sequence[View]) -> np.ndarray:
    return np.hstack([painter.frame(index, view) for view in views])


_taken: tuple[Painter, Sequence[View]]  # What this drawing process draws.


def _take(painter: Painter, views: Sequence[View]) -> None:
    global _taken
    _taken = painter, views


def _draw_taken(index: int) -> np.ndarray:
    return _side_by_side(_taken[0], index, _taken[1])
