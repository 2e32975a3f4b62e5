"""Pictures of imported hair: as it was given, and as it rests on the server."""

from __future__ import annotations

import os
from collections.abc import Sequence

import numpy as np

from mane.raster import Camera, ZBuffer

SIZE = 720  # Pixels of a view's side.
_BACKGROUND = np.array([0.80, 0.82, 0.85])  # Colours are linear, not sRGB.
_GIVEN = np.array([0.85, 0.20, 0.02])
_NOW = np.array([0.02, 0.04, 0.10])
_ALL_DEG = 35  # Where all hair is seen from: about Y, 0 is in front.
_ONE_DEG = (0, 90)  # And a single strand.
_CROSS_PIXELS = 4  # Half the width of a point's mark.


def draw_import(
    path: str | os.PathLike, given: Sequence[np.ndarray], positions: np.ndarray, title: str = "now"
) -> None:
    """Writes one picture: all hair as it was given and as it is now, side by side; below, from the
    front and from the side, the strand that moved most, its given points over it.

    path: the file's ending chooses its format. given: points of every strand, (k, 3) [m].
    positions: the strands now, (strand, point, 3) [m], in the same order and frame. title: of now.
    """
    from PIL import Image, ImageDraw, ImageFont

    moves = [
        np.linalg.norm(points[-1] - strand[-1])
        for points, strand in zip(given, positions, strict=True)
    ]
    worst = int(np.argmax(moves))
    lines = [np.stack([points[:-1], points[1:]], axis=1) for points in given]
    everything = np.concatenate([*given, positions.reshape(-1, 3)])
    before, after = (_Canvas(everything, _ALL_DEG) for _ in range(2))
    before.draw(np.concatenate(lines), _GIVEN)
    after.draw(positions, _NOW)
    views = [before, after]
    for azimuth in _ONE_DEG:
        views.append(_Canvas(np.concatenate([given[worst], positions[worst]]), azimuth))
        views[-1].draw_thick(positions[[worst]], _NOW)
        views[-1].draw_crosses(given[worst], _GIVEN)
    pictures = [view.image() for view in views]
    sheet = Image.fromarray(np.vstack([np.hstack(pictures[:2]), np.hstack(pictures[2:])]))
    draw, font = ImageDraw.Draw(sheet), ImageFont.load_default(SIZE // 30)
    moved = (
        f"strand {worst} moved most, its tip by {1e3 * moves[worst]:.2f} mm; given points over it"
    )
    for x, y, text in ((0, 0, "as given"), (SIZE, 0, title), (0, SIZE, moved)):
        draw.text((x + SIZE // 40, y + SIZE // 60), text, (20, 22, 26), font)
    sheet.save(path)


class _Canvas:
    """One view, from far away, that holds all of `shown` (points, 3)."""

    def __init__(self, shown: np.ndarray, azimuth_deg: float) -> None:
        low, high = shown.min(axis=0), shown.max(axis=0)
        target, angle = (low + high) / 2, np.radians(azimuth_deg)
        toward_eye = np.array([np.sin(angle), 0.1, np.cos(angle)]) / np.hypot(1, 0.1)
        far = 10 * max(np.linalg.norm(high - low), 1e-3)
        across = (shown - target) @ Camera(target + far * toward_eye, target, 1).axes()[:2].T
        height = 2.3 * max(np.abs(across).max(), 5e-4)  # Seen around the target [m].
        self._camera = Camera(target + far * toward_eye, target, height)
        self._pixel_m = height / SIZE
        self._buffer = ZBuffer(SIZE, SIZE, self._camera, _BACKGROUND)

    def draw(self, lines: np.ndarray, color: np.ndarray) -> None:
        """lines: (line, point, 3)."""
        self._buffer.lines(lines, np.broadcast_to(color, lines.shape))

    def draw_thick(self, lines: np.ndarray, color: np.ndarray) -> None:
        """Two pixels wide."""
        right, up, _ = self._camera.axes()
        for x, y in np.ndindex(4, 4):
            self.draw(lines + 0.5 * self._pixel_m * ((x - 1.5) * right + (y - 1.5) * up), color)

    def draw_crosses(self, points: np.ndarray, color: np.ndarray) -> None:
        """Marks that face the eye, a little before their points."""
        right, up, back = self._camera.axes()
        half = _CROSS_PIXELS * self._pixel_m
        ahead = points + 2 * half * back
        for arm in (half * right, half * up):
            self.draw_thick(np.stack([ahead - arm, ahead + arm], axis=1), color)

    def image(self) -> np.ndarray:
        """uint8 (SIZE, SIZE, 3)."""
        return self._buffer.image()
