"""Numbers over a scalp, as `ScalpMap` of the API says them, drawn as images.

An image shows the head from above: the crown in the middle, the forehead at the bottom, +X at the
right. The distance from the middle is the polar angle, whose pi is the circle that fills it.
"""

from __future__ import annotations

import numpy as np

from mane import grey_png
from mane.errors import InvalidArgument
from mane.v1 import style_pb2

UNSET = {"density": 1.0, "length": 0.25, "protrusion": 0.5}
"""The maps of a style, and the value of each where it is unset."""


def value_at(scalp_map: style_pb2.ScalpMap, unset: float, polar, azimuth) -> np.ndarray:
    """The map at angles that broadcast [rad]; `unset`: its value where none is set."""
    value = scalp_map.value if scalp_map.HasField("value") else unset
    values = np.full(np.broadcast(polar, azimuth).shape, value)
    if scalp_map.by_polar:
        at, factor = _stops(scalp_map.by_polar)
        values = values * np.interp(polar, at, factor)
    if scalp_map.by_azimuth:
        at, factor = _stops(scalp_map.by_azimuth)
        around = np.concatenate([at[-1:] - 2 * np.pi, at, at[:1] + 2 * np.pi])
        values = values * np.interp(
            azimuth, around, np.concatenate([factor[-1:], factor, factor[:1]])
        )
    if scalp_map.png:
        values = values * _at_pixel(grey_png.decode(scalp_map.png, "png"), polar, azimuth)
    return values


def drawn(style: style_pb2.Style, name: str, size: int = 512) -> np.ndarray:
    """A map of a style, by its name, drawn over the whole sphere: (size, size)."""
    if name not in UNSET:
        raise InvalidArgument.of("map", f"is {name!r}, must be one of {', '.join(UNSET)}")
    along = (np.arange(size) + 0.5) / size - 0.5
    x, z = np.meshgrid(along, along)
    polar = np.minimum(2 * np.pi * np.hypot(x, z), np.pi)
    return value_at(getattr(style, name), UNSET[name], polar, np.arctan2(x, z))


def _stops(stops) -> tuple[np.ndarray, np.ndarray]:
    return np.array([stop.at for stop in stops]), np.array([stop.value for stop in stops])


def _at_pixel(image: np.ndarray, polar, azimuth) -> np.ndarray:
    """Bilinear between the middles of pixels, constant beyond the outermost."""
    height, width = image.shape
    radius = polar / (2 * np.pi)
    x = np.clip((0.5 + radius * np.sin(azimuth)) * width - 0.5, 0, width - 1)
    y = np.clip((0.5 + radius * np.cos(azimuth)) * height - 0.5, 0, height - 1)
    left, top = x.astype(np.int64), y.astype(np.int64)
    right, bottom = np.minimum(left + 1, width - 1), np.minimum(top + 1, height - 1)
    s, t = x - left, y - top
    upper = (1 - s) * image[top, left] + s * image[top, right]
    lower = (1 - s) * image[bottom, left] + s * image[bottom, right]
    return (1 - t) * upper + t * lower
