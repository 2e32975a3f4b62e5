"""Conversions between styles and hairstyles, and the API's messages."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import fields

import numpy as np

from mane import grey_png, messages, strand_messages
from mane.beam_style import BeamStyle
from mane.bodies import Body, ScalpContact
from mane.errors import Internal
from mane.groom import Ellipsoid
from mane.hairstyle import Hairstyle, Masters, Members, Outcome, StyleReport, Volume
from mane.mesh import Mesh
from mane.strands import ImportOptions
from mane.style import Style
from mane.styles import StylePreset
from mane.v1 import style_pb2
from mane.value_messages import from_vector3

_MASTERS = {
    "joint_counts": ("<u4", (-1,)),
    "outline": ("<f4", (-1, 3)),
    "points": ("<f4", (-1, 3)),
    "lengths": ("<f4", (-1,)),
}
_MEMBERS = {
    "wisps": ("<u4", (-1,)),
    "point_counts": ("<u4", (-1,)),
    "points": ("<f4", (-1, 3)),
    "colours": ("u1", (-1, 3)),
}


def apply_style(
    style: Style | BeamStyle,
    guides: ImportOptions,
    scalp: Mesh | Ellipsoid | None,
    contact: ScalpContact | None,
    bodies: Iterable[Body],
    groom_id: str,
    display_name: str,
) -> Iterator[style_pb2.ApplyStyleRequest]:
    """The messages of one upload: those of a groom without guides, under a header of their own."""
    parts = messages.create_groom(
        messages.create_header(groom_id, display_name, None, contact), (), scalp, bodies
    )
    made = next(parts).header
    header = style_pb2.ApplyStyleHeader(
        groom_id=made.groom_id,
        display_name=made.display_name,
        request_id=made.request_id,
        guides=strand_messages.options(guides),
        **{style.NAME: style.message},
    )
    for name in ("ellipsoid", "scalp_contact"):
        if made.HasField(name):
            getattr(header, name).CopyFrom(getattr(made, name))
    return _under(header, parts)


def _under(header: style_pb2.ApplyStyleHeader, parts) -> Iterator[style_pb2.ApplyStyleRequest]:
    yield style_pb2.ApplyStyleRequest(header=header)
    for part in parts:
        kind = part.WhichOneof("part")
        yield style_pb2.ApplyStyleRequest(**{kind: getattr(part, kind)})


class DownloadedHairstyle:
    """Collects the parts of one download."""

    def __init__(self):
        self._report: style_pb2.StyleReport | None = None
        self._masters = {name: bytearray() for name in _MASTERS}
        self._members = {name: bytearray() for name in _MEMBERS}
        self._density = _DownloadedVolume(1)
        self._field = _DownloadedVolume(3)
        self._maps: dict[str, np.ndarray] = {}

    def add(self, part: style_pb2.HairstylePart) -> None:
        match part.WhichOneof("part"):
            case "report":
                self._report = part.report
            case "masters":
                _join(self._masters, part.masters)
            case "members":
                _join(self._members, part.members)
            case "density":
                self._density.add(part.density)
            case "field":
                self._field.add(part.field)
            case "map":
                self._maps[part.map.name] = part.map.white * grey_png.decode(part.map.png)

    def hairstyle(self) -> Hairstyle:
        """The whole hairstyle. Internal where the download is not complete."""
        if self._report is None:
            raise Internal("the server's hairstyle is not complete")
        report = from_report(self._report)
        masters = Masters(**_arrays(self._masters, _MASTERS))
        members = Members(**_arrays(self._members, _MEMBERS))
        told = (report.wisp_count, report.strand_count, report.control_point_count)
        came = (len(masters.lengths), len(members.wisps), len(members.points))
        if told != came:
            raise Internal("the server's hairstyle is not complete")
        if not self._maps:  # Hair by beams.
            return Hairstyle(masters, members, None, None, {}, report)
        volumes = self._density.volume(), self._field.volume()
        return Hairstyle(masters, members, *volumes, self._maps, report)


class _DownloadedVolume:
    """Collects the pieces of a `Volume` with so many numbers a node."""

    def __init__(self, width: int):
        self._width = width
        self._first = None
        self._values = bytearray()

    def add(self, piece) -> None:
        if self._first is None:
            self._first = piece
        self._values += piece.values

    def volume(self) -> Volume:
        first = self._first
        if first is None:
            raise Internal("the server's hairstyle is not complete")
        shape = (first.nodes_z, first.nodes_y, first.nodes_x)
        if len(self._values) != 4 * self._width * np.prod(shape, dtype=np.int64):
            raise Internal("the server's hairstyle is not complete")
        return Volume(
            low=np.array(from_vector3(first.low)),
            cell_m=first.cell_m,
            values=np.frombuffer(self._values, "<f4").reshape(
                shape if self._width == 1 else (*shape, self._width)
            ),
        )


def from_report(message: style_pb2.StyleReport) -> StyleReport:
    values = {f.name: getattr(message, f.name) for f in fields(StyleReport)}
    outcomes = [
        Outcome(**{f.name: getattr(outcome, f.name) for f in fields(Outcome)})
        for outcome in message.outcomes
    ]
    return StyleReport(**values | {"outcomes": tuple(outcomes)})


def from_presets(message: style_pb2.ListStylePresetsResponse) -> list[StylePreset]:
    return [
        StylePreset(
            preset.name,
            preset.description,
            BeamStyle(preset.beam_style) if preset.HasField("beam_style") else Style(preset.style),
        )
        for preset in message.presets
    ]


def _join(lists: dict[str, bytearray], part) -> None:
    for name, data in lists.items():
        data += getattr(part, name)


def _arrays(lists: dict[str, bytearray], kinds) -> dict[str, np.ndarray]:
    return {
        name: np.frombuffer(lists[name], dtype).reshape(shape)
        for name, (dtype, shape) in kinds.items()
    }
