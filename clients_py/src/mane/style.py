"""Hairstyles by wisps as documents, and what a hairdresser does to them."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Literal

from numpy.typing import ArrayLike

from mane import grey_png, scalp_maps
from mane.errors import InvalidArgument
from mane.pose import choice
from mane.strands import ImportOptions
from mane.style_document import HalfSpace, StyleDocument, array, half_space
from mane.v1 import style_pb2
from mane.value_messages import vector3

Image = ArrayLike | str | os.PathLike | bytes
"""Numbers (height, width) in [0, 1], or a PNG file: its path or its content."""

GUIDES = ImportOptions(element_count=10, error_bound_m=0)
"""How master strands become guides unless told otherwise."""


_HALF_SPACE = style_pb2.ScalpRegion.HalfSpace


class StrandKind(StrEnum):
    """Patterns of shipped prototype strands."""

    STRAIGHT = "straight"
    WAVY = "wavy"
    CURLY = "curly"
    FUZZY = "fuzzy"
    KINKY = "kinky"


@dataclass(frozen=True, eq=False)
class Region:
    """A part of the scalp: where everything that is given holds; nothing given is all of it.

    Angles are about the middle of the hair region: polar from straight up, azimuth from the
    forehead (+Z) toward +X.

    Attributes:
      polar: low and high [rad], in [0, pi].
      azimuth: low and high [rad], in [-pi, pi]; low > high goes through the nape.
      half_spaces: at most 16 pairs of a normal (3,) and an offset [m], head frame; points with
        normal . x >= offset are in.
      mask: an image over the scalp, as maps are: lighter than half is in.
      wisps: numbers of wisps, from 0.
    """

    polar: tuple[float, float] | None = None
    azimuth: tuple[float, float] | None = None
    half_spaces: Sequence[HalfSpace] = ()
    mask: Image | None = None
    wisps: Sequence[int] = ()

    def message(self, field: str = "region") -> style_pb2.ScalpRegion:
        """As the API has it. InvalidArgument names a part of `field` that has another shape."""
        message = style_pb2.ScalpRegion()
        for name in ("polar", "azimuth"):
            if getattr(self, name) is not None:
                low, high = array(f"{field}.{name}", getattr(self, name), (2,))
                getattr(message, name).CopyFrom(style_pb2.ScalpRegion.Interval(low=low, high=high))
        for index, each in enumerate(self.half_spaces):
            path = f"{field}.half_spaces[{index}]"
            message.half_spaces.append(half_space(path, each, _HALF_SPACE))
        if self.mask is not None:
            message.mask_png = grey_png.of(self.mask, f"{field}.mask")
        try:
            message.wisps.extend(int(wisp) for wisp in self.wisps)
        except (TypeError, ValueError) as error:
            raise InvalidArgument.of(
                f"{field}.wisps", f"must be numbers of wisps: {error}"
            ) from error
        return message


class Style(StyleDocument):
    """A hairstyle by wisps, whole: the document that people save, diff and replay.

    `message` holds it, with the fields that `proto/mane/v1/style.proto` describes; what is unset
    has the value named there. Every operation leaves this style as it is and gives back a changed
    copy:

        style = mane.Style(seed=3, wisp_count=1000).with_map("length", value=0.3)
        tail = style.tie(mane.Region(polar=(0, 1.2)), point=(0, 0.12, -0.14))

    Args:
      message: is copied; None is an empty one.
      fields: of the message, in place of its own: `seed`, `wisp_count`, ...
    """

    MESSAGE = style_pb2.Style
    NAME = "style"

    def with_map(
        self,
        name: Literal["density", "length", "protrusion"],
        *,
        value: float | None = None,
        by_polar: Iterable[tuple[float, float]] = (),
        by_azimuth: Iterable[tuple[float, float]] = (),
        image: Image | None = None,
    ) -> Style:
        """With another map: the product of what is given.

        Args:
          name: `density` of strands, relative; `length` of master strands [m]; `protrusion`, 1
            where roots leave along the normal, 0 along the scalp.
          value: everywhere; None is the map's own, see `mane.scalp_maps.UNSET`.
          by_polar: factors over the polar angle, pairs (at, value), `at` increasing in [0, pi];
            linear between them.
          by_azimuth: factors over the azimuth likewise, in [-pi, pi], periodic.
          image: a factor, see `mane.scalp_maps`. Arrays travel in 8 bits.
        """
        if name not in scalp_maps.UNSET:
            known = ", ".join(scalp_maps.UNSET)
            raise InvalidArgument.of("name", f"is {name!r}, must be one of {known}")
        scalp_map = style_pb2.ScalpMap(
            value=value,
            by_polar=_stops(f"{name}.by_polar", by_polar),
            by_azimuth=_stops(f"{name}.by_azimuth", by_azimuth),
            png=None if image is None else grey_png.of(image, f"{name}.image"),
        )
        changed = self.copy()
        getattr(changed.message, name).CopyFrom(scalp_map)
        return changed

    def with_prototype(self, kind: StrandKind | str = StrandKind.STRAIGHT, **synthesis) -> Style:
        """With another prototype strand for all hair; arguments as of `wave`."""
        changed = self.copy()
        changed.message.synthesis.CopyFrom(_synthesis(kind, **synthesis))
        return changed

    def cut(
        self,
        region: Region | None = None,
        *,
        length_m: float = 0.0,
        plane: HalfSpace | None = None,
    ) -> Style:
        """Shortens hair of a region; None is all of it.

        Args:
          length_m: longest that is left [m]; 0 for what `plane` leaves.
          plane: hair that is beyond it when it hangs ends where it meets it; a normal (3,) and an
            offset [m].
        """
        cut = style_pb2.HairdressingOperation.Cut(length_m=length_m)
        if plane is not None:
            cut.plane.CopyFrom(half_space("plane", plane, _HALF_SPACE))
        return self._dressed(region, cut=cut)

    def wave(
        self,
        region: Region | None = None,
        *,
        kind: StrandKind | str = StrandKind.WAVY,
        **synthesis,
    ) -> Style:
        """Gives hair of a region another pattern.

        Args:
          kind: a `StrandKind` or its value.
          amplitude_m, period_m: radius of its curls and length of a turn [m]; 0 for its own. A turn
            needs four segments at least: `segment_length_m` of the style says how long one is.
          points: in place of a shipped strand, one's own: (k, 3), root first [m], k from 4.
          window: control points that are compared, at most 200; 0 for the longest structure.
          temperature: 0 follows the prototype, more strays from it, up to 10.
        """
        wave = style_pb2.HairdressingOperation.Wave(synthesis=_synthesis(kind, **synthesis))
        return self._dressed(region, wave=wave)

    def comb(
        self,
        region: Region | None = None,
        *,
        path: ArrayLike,
        radius_m: float = 0.03,
        weight: float | None = None,
    ) -> Style:
        """Leads hair of a region along a path.

        Args:
          path: (k, 3), head frame [m], k from 2.
          radius_m: how far from the path it acts [m].
          weight: against the hair's own way, in [0, 1]; None is 0.8.
        """
        comb = style_pb2.HairdressingOperation.Comb(
            path=_path(path), radius_m=radius_m, weight=weight
        )
        return self._dressed(region, comb=comb)

    def tie(
        self, region: Region | None = None, *, point: ArrayLike, radius_m: float = 0.015
    ) -> Style:
        """Gathers hair of a region at a point (3,), head frame [m], in a ribbon of that radius."""
        tie = style_pb2.HairdressingOperation.Tie(point=vector3(point, "point"), radius_m=radius_m)
        return self._dressed(region, tie=tie)

    def braid(
        self,
        region: Region | None = None,
        *,
        path: ArrayLike,
        strand_count: int = 3,
        radius_m: float = 0.02,
        period_m: float = 0.1,
    ) -> Style:
        """Gathers hair of a region at the start of a path, and braids it along that.

        Args:
          path: (k, 3), head frame [m], k from 2.
          strand_count: 2 to 9.
          radius_m: half the width of the braid [m].
          period_m: length in which each strand is back in its place [m].
        """
        braid = style_pb2.HairdressingOperation.Braid(
            path=_path(path), strand_count=strand_count, radius_m=radius_m, period_m=period_m
        )
        return self._dressed(region, braid=braid)

    def _dressed(self, region: Region | None, **operation) -> Style:
        changed = self.copy()
        added = changed.message.operations.add(**operation)
        if region is not None:
            if not isinstance(region, Region):
                raise InvalidArgument.of("region", f"is {region!r}, must be a Region")
            added.region.CopyFrom(region.message())
        return changed


def _stops(field: str, stops: Iterable[tuple[float, float]]) -> list[style_pb2.Stop]:
    pairs = list(stops)
    numbers = array(field, pairs, (-1, 2)) if pairs else ()
    return [style_pb2.Stop(at=at, value=value) for at, value in numbers]


def _path(path: ArrayLike) -> list:
    points = array("path", path, (-1, 3))
    if len(points) < 2:
        raise InvalidArgument.of("path", f"has shape {points.shape}, must have 2 points or more")
    return [vector3(point) for point in points]


def _synthesis(
    kind: StrandKind | str,
    *,
    points: ArrayLike | None = None,
    amplitude_m: float = 0.0,
    period_m: float = 0.0,
    window: int = 0,
    temperature: float = 0.0,
) -> style_pb2.Synthesis:
    if points is None:
        name = choice("kind", StrandKind, kind).name
        prototype = style_pb2.Prototype(
            kind=style_pb2.StrandKind.Value(f"STRAND_KIND_{name}"),
            amplitude_m=amplitude_m,
            period_m=period_m,
        )
    else:
        line = array("points", points, (-1, 3))
        prototype = style_pb2.Prototype(points=line.astype("<f4").tobytes())
    return style_pb2.Synthesis(prototype=prototype, window=window, temperature=temperature)
