"""The head motion clips that this package ships, 60 poses a second, 5 to 6 s each.

`nod`, `shake`, `turn` move the head in place; `walk` and `run` go along +Z. All start at the
identity, at rest, and end at rest. tools/make_motions.py holds their formulas.
"""

from __future__ import annotations

from importlib import resources

from mane.errors import InvalidArgument
from mane.motion import Motion, read_csv

NAMES = ("nod", "run", "shake", "turn", "walk")
"""What `load` knows."""


def load(name: str) -> Motion:
    """The clip of that name. Raises InvalidArgument for an unknown one."""
    if name not in NAMES:
        raise InvalidArgument.of("name", f"is {name!r}, must be one of {', '.join(NAMES)}")
    with resources.as_file(resources.files("mane") / "data" / "motions" / f"{name}.csv") as path:
        return read_csv(path)
