"""Conversions between hairs and the API's messages."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from mane.errors import InvalidArgument
from mane.hairs import TIP_PART, Hairs
from mane.v1 import groom_pb2
from mane.value_messages import PIECE_BYTES

_PLACE = np.dtype([("part", "<u2"), ("offset", "<i2", 3)])
_ARRAYS = {"guides": "<u4", "point_counts": "<u2", "places": _PLACE, "colours": "u1"}
_HAIR_BYTES = 9  # Guide, count, colour.


def batches(hairs: Hairs | None) -> Iterator[groom_pb2.HairBatch]:
    """Batches of whole hairs, of about `PIECE_BYTES` at most; none for None."""
    if hairs is None:
        return
    places = _places(hairs)
    first = hairs.first_point
    ends = np.cumsum(_HAIR_BYTES + _PLACE.itemsize * hairs.point_counts)
    begin = 0
    while begin < len(hairs):
        sent = ends[begin - 1] if begin else 0
        end = max(begin + 1, int(np.searchsorted(ends, sent + PIECE_BYTES, side="right")))
        some = slice(begin, end)
        colours = b"" if hairs.colours is None else hairs.colours[some].tobytes()
        yield groom_pb2.HairBatch(
            guides=hairs.guides[some].astype("<u4").tobytes(),
            point_counts=hairs.point_counts[some].astype("<u2").tobytes(),
            places=places[first[begin] : first[end]].tobytes(),
            colours=colours,
        )
        begin = end


def _places(hairs: Hairs) -> np.ndarray:
    if not np.all((hairs.parts >= 0) & (hairs.parts <= 1)):
        raise InvalidArgument.of("parts", "must be between 0 and 1")
    if np.any((hairs.point_counts < 0) | (hairs.point_counts > 65535)):
        raise InvalidArgument.of("point_counts", "must be between 2 and 1000")
    places = np.empty(len(hairs.parts), _PLACE)
    places["part"] = np.rint(hairs.parts.astype(np.float64) * TIP_PART)
    places["offset"] = np.rint(hairs.offsets / hairs.offset_unit_m)
    return places


class ExportedHairs:
    """Collects the hairs of one download."""

    def __init__(self):
        self._lists = {field: bytearray() for field in _ARRAYS}

    def add(self, batch: groom_pb2.HairBatch) -> None:
        for field, data in self._lists.items():
            data += getattr(batch, field)

    def counts(self) -> tuple[int, int]:
        """Hairs and control points until now."""
        return len(self._lists["guides"]) // 4, len(self._lists["places"]) // _PLACE.itemsize

    def hairs(self, offset_unit_m: float) -> Hairs | None:
        """All of them; None for none."""
        if not self._lists["guides"]:
            return None
        arrays = {field: np.frombuffer(self._lists[field], _ARRAYS[field]) for field in _ARRAYS}
        colours = arrays["colours"].reshape(-1, 3).copy()
        return Hairs(
            arrays["guides"].copy(),
            arrays["point_counts"],
            arrays["places"]["part"] / TIP_PART,
            arrays["places"]["offset"] * offset_unit_m,
            colours if len(colours) else None,
            offset_unit_m,
        )
