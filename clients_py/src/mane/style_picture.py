"""Pictures of hairstyles: every member strand, in its colour, from several sides."""

from __future__ import annotations

import os
from collections.abc import Sequence

import numpy as np

from mane.hairstyle import Hairstyle, Members
from mane.mesh import Mesh
from mane.motion import Motion
from mane.painter import Look, Painter, View

VIEWS = (View(0, 4), View(90, 4), View(180, 4))
"""Front, side, back."""

_POINTS = 48  # Of a drawn strand: so many that curls are round.


def draw_hairstyle(
    path: str | os.PathLike,
    hairstyle: Hairstyle,
    mesh: Mesh | None = None,
    *,
    views: Sequence[View] = VIEWS,
    title: str = "",
    size: int = 640,
) -> None:
    """Writes one picture of the views side by side.

    Args:
      path: the file's ending chooses its format, such as .png.
      hairstyle: whose members are drawn.
      mesh: the head, or None for hair alone.
      views: from where.
      title: is written into it.
      size: pixels of a view's side, a multiple of 16.
    """
    from PIL import Image, ImageDraw, ImageFont

    hairs = curves(hairstyle.members, _POINTS)
    colours = (hairstyle.members.colours / 255.0) ** 2.2  # Linear.
    painter = Painter(
        mesh, hairs[None], Motion([0.0], [[0, 0, 0]]), Look(colours, hairs=None, size=size)
    )
    sheet = Image.fromarray(np.hstack([painter.frame(0, view) for view in views]))
    font = ImageFont.load_default(max(10, size // 26))
    ImageDraw.Draw(sheet).text((size // 40, size - size // 14), title, (235, 235, 235), font)
    sheet.save(path)


def curves(members: Members, count: int) -> np.ndarray:
    """Points on the splines of all members, `count` at equal parameters, (strand, count, 3)."""
    first = members.first_point[:-1, None]
    last = members.point_counts[:, None].astype(np.int64) - 1
    at = last * np.linspace(0, 1, count)  # In control points.
    knot = np.minimum(at.astype(np.int64), np.maximum(last - 1, 0))
    t = (at - knot).astype(np.float32)[..., None]
    a, b, c, d = (members.points[first + np.clip(knot + step, 0, last)] for step in (-1, 0, 1, 2))
    # Catmull-Rom, its ends doubled.
    return b + 0.5 * t * (c - a + t * (2 * a - 5 * b + 4 * c - d + t * (3 * (b - c) + d - a)))
