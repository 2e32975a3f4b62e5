"""Conversions between styles and hairstyles, and the API's messages."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import fields

import numpy as np

from mane import grey_png, messages, strand_messages
from mane.bodies import Body, ScalpContact
from mane.errors import Internal
from mane.groom import Ellipsoid
from mane.hairstyle import DensityField, Hairstyle, Masters, Members, Outcome, StyleReport
from mane.mesh import Mesh
from mane.strands import ImportOptions
from mane.style import Style, StylePreset
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
    style: Style,
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
        style=style.message,
        guides=strand_messages.options(guides),
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
        self._density: style_pb2.HairstylePart.DensityField | None = None
        self._volume = bytearray()
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
                if self._density is None:
                    self._density = part.density
                self._volume += part.density.values
            case "map":
                self._maps[part.map.name] = part.map.white * grey_png.decode(part.map.png)

    def hairstyle(self) -> Hairstyle:
        """The whole hairstyle. Internal where the download is not complete."""
        if self._report is None or self._density is None:
            raise Internal("the server's hairstyle is not complete")
        report = from_report(self._report)
        masters = Masters(**_arrays(self._masters, _MASTERS))
        members = Members(**_arrays(self._members, _MEMBERS))
        field = self._density
        shape = (field.nodes_z, field.nodes_y, field.nodes_x)
        told = (report.wisp_count, report.strand_count, report.control_point_count)
        came = (len(masters.lengths), len(members.wisps), len(members.points))
        if told != came or len(self._volume) != 4 * np.prod(shape, dtype=np.int64):
            raise Internal("the server's hairstyle is not complete")
        density = DensityField(
            low=np.array(from_vector3(field.low)),
            cell_m=field.cell_m,
            values=np.frombuffer(self._volume, "<f4").reshape(shape),
        )
        return Hairstyle(masters, members, density, self._maps, report)


def from_report(message: style_pb2.StyleReport) -> StyleReport:
    values = {f.name: getattr(message, f.name) for f in fields(StyleReport)}
    outcomes = [
        Outcome(**{f.name: getattr(outcome, f.name) for f in fields(Outcome)})
        for outcome in message.outcomes
    ]
    return StyleReport(**values | {"outcomes": tuple(outcomes)})


def from_presets(message: style_pb2.ListStylePresetsResponse) -> list[StylePreset]:
    return [
        StylePreset(preset.name, preset.description, Style(preset.style))
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
