"""Styles of either kind: those that the server ships, and those of files."""

from __future__ import annotations

import os
from dataclasses import dataclass

from mane import style_json
from mane.beam_style import BeamStyle
from mane.style import Style


@dataclass(frozen=True, eq=False)
class StylePreset:
    """A shipped style.

    Attributes:
      name: such as `bob`.
      description: one sentence.
      style: for a head of human size with its centre at the origin.
    """

    name: str
    description: str
    style: Style | BeamStyle


def load_style(path: str | os.PathLike) -> Style | BeamStyle:
    """The style of a JSON file: a `BeamStyle` where its one field is `beam_style`, else a `Style`.

    InvalidArgument names the file and the field that is wrong.
    """
    message = style_json.load(path)
    kind = BeamStyle if isinstance(message, BeamStyle.MESSAGE) else Style
    return kind(message)
