"""Pictures of several cases side by side: a row for every case, a column for every moment."""

from __future__ import annotations

import os
from collections.abc import Mapping

import numpy as np

from mane.mesh import Mesh
from mane.motion import Motion
from mane.painter import Look, Painter, View

_TITLE, _NOTE = (245, 245, 245), (20, 22, 26)


def draw_rows(
    path: str | os.PathLike,
    head: Mesh,
    rows: Mapping[str, np.ndarray],
    moments: Mapping[str, int],
    view: View,
    look: Look,
) -> None:
    """Writes one picture.

    rows: hair in the head's axes by what it is called, (frame, guide, point, 3) [m]. moments:
    frames by what they are called.
    """
    from PIL import Image, ImageDraw, ImageFont

    chosen, size = list(moments.values()), look.size
    still = Motion(np.arange(float(len(chosen))))
    strips = []
    for positions in rows.values():
        painter = Painter(head, positions[chosen], still, look)
        strips.append(np.hstack([painter.frame(i, view) for i in range(len(chosen))]))
    sheet = Image.fromarray(np.vstack(strips))
    draw, font = ImageDraw.Draw(sheet), ImageFont.load_default(max(10, size // 20))
    for row, name in enumerate(rows):
        for column, moment in enumerate(moments):
            draw.text((size * column + size // 40, size * row + size // 60), moment, _NOTE, font)
        draw.text((size // 40, size * (row + 1) - size // 12), name, _TITLE, font)
    sheet.save(path)
