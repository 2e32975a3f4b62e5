"""What styles of every kind are: documents that people save, diff and replay."""

from __future__ import annotations

import os
from pathlib import Path
from typing import ClassVar, Self

import numpy as np
from google.protobuf.message import Message
from numpy.typing import ArrayLike

from mane import style_json
from mane.errors import InvalidArgument

HalfSpace = tuple[ArrayLike, float]
"""All x with normal . x >= offset_m: the normal (3,) and the offset [m], head frame."""


class StyleDocument:
    """A style, whole, as a message of the API.

    Args:
      message: is copied; None is an empty one.
      fields: of the message, in place of its own: `seed`, ...
    """

    MESSAGE: ClassVar[type[Message]]
    NAME: ClassVar[str]  # Of the field of an upload's header.

    def __init__(self, message: Message | None = None, /, **fields):
        self.message = self.MESSAGE()
        if message is not None:
            self.message.CopyFrom(message)
        try:
            given = self.MESSAGE(**fields)
        except (TypeError, ValueError) as error:
            raise InvalidArgument.of(self.NAME, str(error)) from error
        for name in fields:
            self.message.ClearField(name)
        self.message.MergeFrom(given)

    @classmethod
    def load(cls, path: str | os.PathLike) -> Self:
        """The style of a JSON file. InvalidArgument names the file and the field that is wrong."""
        return cls(style_json.load(path, (cls.MESSAGE,)))

    @classmethod
    def from_json(cls, text: str) -> Self:
        """The style of a JSON text. InvalidArgument names the field that is wrong."""
        return cls(style_json.parse(text, kinds=(cls.MESSAGE,)))

    def to_json(self) -> str:
        """As JSON, protobuf's own mapping: names as in the API, in its order; what is unset is left
        out."""
        return style_json.text(self.message)

    def save(self, path: str | os.PathLike) -> None:
        """Writes a JSON file."""
        Path(path).write_text(self.to_json(), encoding="utf-8")

    def copy(self) -> Self:
        return type(self)(self.message)

    def __eq__(self, other) -> bool:
        return isinstance(other, type(self)) and self.message == other.message

    __hash__ = None

    def __repr__(self) -> str:
        return f"{type(self).__name__}.from_json({self.to_json()!r})"


def array(field: str, values: ArrayLike, shape: tuple[int, ...]) -> np.ndarray:
    """`values` as float64 of that shape, -1 for any length."""
    try:
        numbers = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InvalidArgument.of(field, f"must be numbers: {error}") from error
    fits = numbers.ndim == len(shape) and all(
        want in (-1, have) for want, have in zip(shape, numbers.shape, strict=True)
    )
    if not fits:
        wanted = str(shape).replace("-1", "k")
        raise InvalidArgument.of(field, f"has shape {numbers.shape}, must be {wanted}")
    return numbers


def half_space(field: str, value: HalfSpace, message: type[Message]) -> Message:
    """As a message with a `normal` and an `offset_m`."""
    try:
        normal, offset_m = value
        made = message(offset_m=float(offset_m))
    except (TypeError, ValueError):
        raise InvalidArgument.of(
            field, f"is {value!r}, must be a normal (3,) and an offset in metres"
        ) from None
    x, y, z = array(f"{field}.normal", normal, (3,))
    made.normal.x, made.normal.y, made.normal.z = x, y, z
    return made
