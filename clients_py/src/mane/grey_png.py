"""Grey PNG files of numbers in [0, 1]: 0 is black, 1 is white."""

from __future__ import annotations

import io
import os
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike
from PIL import Image, UnidentifiedImageError

from mane.errors import InvalidArgument

LARGEST_SIDE = 4096
_LUMA = np.array([0.2126, 0.7152, 0.0722], np.float32)
_SIGNATURE = b"\x89PNG\r\n\x1a\n"


def encode(values: ArrayLike, field: str = "image") -> bytes:
    """A PNG file of 8 bits of `values`, (height, width) in [0, 1], top row first.

    InvalidArgument names `field` where the shape or a number is another.
    """
    array = np.asarray(values, dtype=np.float64)
    if array.ndim != 2 or not 1 <= min(array.shape) <= max(array.shape) <= LARGEST_SIDE:
        raise InvalidArgument.of(
            field, f"has shape {array.shape}, must be (height, width), 1 to {LARGEST_SIDE} each"
        )
    if not ((array >= 0) & (array <= 1)).all():
        raise InvalidArgument.of(
            field, f"has numbers from {array.min():g} to {array.max():g}, must be in [0, 1]"
        )
    file = io.BytesIO()
    Image.fromarray(np.rint(255 * array).astype(np.uint8)).save(file, "PNG")
    return file.getvalue()


def decode(data: bytes, field: str = "image") -> np.ndarray:
    """The numbers of a PNG file, float32 (height, width) in [0, 1].

    Colours count by their luma, what is transparent as black. InvalidArgument names `field` where
    it is no PNG file.
    """
    try:
        with Image.open(io.BytesIO(data), formats=["PNG"]) as image:
            if image.mode.startswith("I"):
                return np.asarray(image, np.float32) / 65535
            if image.mode == "L":
                return np.asarray(image, np.float32) / 255
            colours = np.asarray(image.convert("RGBA"), np.float32) / 255
    except (UnidentifiedImageError, OSError, SyntaxError, Image.DecompressionBombError) as error:
        raise InvalidArgument.of(field, f"is not a readable PNG file: {error}") from error
    return (colours[..., :3] @ _LUMA) * colours[..., 3]


def of(image: ArrayLike | str | os.PathLike | bytes, field: str = "image") -> bytes:
    """A PNG file of what may stand for one: numbers as `encode` takes, its path, or itself."""
    if isinstance(image, bytes):
        data = image
    elif isinstance(image, str | os.PathLike):
        data = Path(image).read_bytes()
    else:
        return encode(image, field)
    if not data.startswith(_SIGNATURE):
        raise InvalidArgument.of(field, "is not a PNG file")
    return data
