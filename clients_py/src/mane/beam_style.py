"""Hairstyles by bending beams as documents, and what a hairdresser does to them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import StrEnum

from numpy.typing import ArrayLike

from mane.errors import InvalidArgument
from mane.pose import choice
from mane.style_document import HalfSpace, StyleDocument, array, half_space
from mane.v1 import beam_style_pb2
from mane.value_messages import vector3

_KINDS = beam_style_pb2.BeamForce


class Spread(StrEnum):
    """How the pores of a part lie."""

    RANDOM = "random"
    UNIFORM = "uniform"


@dataclass(frozen=True)
class PoreRegion:
    """Where hair grows, or which hair is meant, by polar coordinates of its pore on the head's
    hull; nothing given is all of it.

    Attributes:
      zenith: low and high [rad] from straight up, in [0, pi].
      azimuth: low and high [rad] from the forehead (+Z) toward +X, in [-pi, pi]; low > high goes
        through the nape.
    """

    zenith: tuple[float, float] | None = None
    azimuth: tuple[float, float] | None = None

    def message(self, field: str = "pores") -> beam_style_pb2.PoreRegion:
        """As the API has it. InvalidArgument names a part of `field` that has another shape."""
        message = beam_style_pb2.PoreRegion()
        for name in ("zenith", "azimuth"):
            if getattr(self, name) is not None:
                low, high = array(f"{field}.{name}", getattr(self, name), (2,))
                interval = beam_style_pb2.PoreRegion.Interval(low=low, high=high)
                getattr(message, name).CopyFrom(interval)
        return message


class BeamStyle(StyleDocument):
    """A hairstyle by bending beams, whole: the document that people save, diff and replay.

    `message` holds it, with the fields that `proto/mane/v1/beam_style.proto` describes; what is
    unset has the value named there. Every operation leaves this style as it is and gives back a
    changed copy:

        front = mane.PoreRegion(zenith=(0.4, 1.1), azimuth=(-0.7, 0.7))
        style = (
            mane.BeamStyle(seed=3)
            .with_part("all", pores=mane.PoreRegion(zenith=(0, 1.8)), length_m=0.2)
            .comb(point=(0, 0.3, -0.3))
            .cut(front, height_m=0.09)
        )

    As JSON it is the field `beam_style` of a document that holds nothing else.

    Args:
      message: is copied; None is an empty one.
      fields: of the message, in place of its own: `seed`, `guide_count`, ...
    """

    MESSAGE = beam_style_pb2.BeamStyle
    NAME = "beam_style"

    def with_part(
        self,
        name: str = "",
        *,
        pores: PoreRegion | None = None,
        tied_at: ArrayLike | None = None,
        tied_along: ArrayLike | None = None,
        spread: Spread | str = Spread.RANDOM,
        **numbers: float,
    ) -> BeamStyle:
        """With one more part: hair that is made alike.

        Args:
          name: operations on the part say it.
          pores: where it grows; None is all of the hull.
          tied_at: (3,), head frame [m]: it grows from a disc about this point instead, of radius
            `tied_radius_m`, and sets out along `tied_along` (3,), backwards unless given. That is a
            ponytail.
          spread: a `Spread` or its value.
          numbers: other fields of a `BeamPart`: `hair_count`, `segment_count`, `length_m`,
            `length_fluctuation`, `rigidity_n_m2`, ...
        """
        spread = beam_style_pb2.BeamPart.Spread.Value(
            f"SPREAD_{choice('spread', Spread, spread).name}"
        )
        try:
            part = beam_style_pb2.BeamPart(name=name, spread=spread, **numbers)
        except (TypeError, ValueError) as error:
            raise InvalidArgument.of("part", str(error)) from error
        if pores is not None:
            part.pores.CopyFrom(_region(pores))
        for field, given in (("tied_at", tied_at), ("tied_along", tied_along)):
            if given is not None:
                getattr(part, field).CopyFrom(vector3(given, field))
        changed = self.copy()
        changed.message.parts.append(part)
        return changed

    def with_hair_count(self, count: int) -> BeamStyle:
        """With so many hairs in all, shared among the parts as they are now, at least one each."""
        if not self.message.parts or count < len(self.message.parts):
            raise InvalidArgument.of(
                "count",
                f"is {count}, must be at least 1 for each of {len(self.message.parts)} parts",
            )
        now = [part.hair_count if part.HasField("hair_count") else 10_000
               for part in self.message.parts]  # fmt: skip
        changed = self.copy()
        begin = 0
        for part, own in zip(changed.message.parts, now, strict=True):
            # Rounded so that the parts add up.
            part.hair_count = max(
                1, round(count * (begin + own) / sum(now)) - round(count * begin / sum(now))
            )
            begin += own
        return changed

    def cut(
        self,
        pores: PoreRegion | None = None,
        *,
        height_m: float | None = None,
        keep: Sequence[HalfSpace] = (),
        by_pore: tuple[tuple[float, float], tuple[float, float]] | None = None,
        part: str | None = None,
    ) -> BeamStyle:
        """Cuts hair where it first leaves what is kept.

        Args:
          pores: which hair; None is all of it.
          height_m: keeps what is not below this y, head frame [m].
          keep: pairs of a normal (3,) and an offset [m]: keeps what is in all of them.
          by_pore: two pairs (y, length) [m]: the longest length left of hair whose pore has that
            height, linear between the two, constant beyond.
          part: name of the one part to cut; None is all parts.
        """
        cut = beam_style_pb2.BeamCut(height_m=height_m, keep=_half_spaces("keep", keep))
        if pores is not None:
            cut.pores.CopyFrom(_region(pores))
        if by_pore is not None:
            (low_y, low), (high_y, high) = array("by_pore", by_pore, (2, 2))
            cut.by_pore.low_y_m, cut.by_pore.low_length_m = low_y, low
            cut.by_pore.high_y_m, cut.by_pore.high_length_m = high_y, high
        return self._changed(part, "cuts", cut)

    def comb(
        self,
        pores: PoreRegion | None = None,
        *,
        point: ArrayLike,
        strength_m_s2: float = 25.0,
        softening_m: float | None = None,
        where: Sequence[HalfSpace] = (),
        part: str | None = None,
    ) -> BeamStyle:
        """Combs hair toward a point, along the head: it is not lifted.

        Args:
          pores: which hair; None is all of it.
          point: (3,), head frame [m].
          strength_m_s2: against gravity's 9.81.
          softening_m: within this distance of the point it falls off; None is 0.01.
          where: pairs of a normal (3,) and an offset [m]: acts only in all of them.
          part: name of the one part that is combed; None is all parts.
        """
        force = _force(_KINDS.KIND_AROUND, pores, where)
        return self._toward(force, point, strength_m_s2, softening_m, part)

    def draw(
        self,
        pores: PoreRegion | None = None,
        *,
        point: ArrayLike,
        strength_m_s2: float = 25.0,
        softening_m: float | None = None,
        where: Sequence[HalfSpace] = (),
        part: str | None = None,
    ) -> BeamStyle:
        """Draws hair toward a point, also away from the head; arguments as of `comb`."""
        force = _force(_KINDS.KIND_TOWARD, pores, where)
        return self._toward(force, point, strength_m_s2, softening_m, part)

    def force(
        self,
        pores: PoreRegion | None = None,
        *,
        acceleration: ArrayLike,
        where: Sequence[HalfSpace] = (),
        part: str | None = None,
    ) -> BeamStyle:
        """Adds a uniform acceleration (3,) [m/s^2] to gravity; other arguments as of `comb`."""
        force = _force(_KINDS.KIND_UNIFORM, pores, where)
        force.acceleration.CopyFrom(vector3(acceleration, "acceleration"))
        return self._changed(part, "forces", force)

    def _toward(self, force, point, strength_m_s2, softening_m, part) -> BeamStyle:
        force.point.CopyFrom(vector3(point, "point"))
        force.strength_m_s2 = strength_m_s2
        if softening_m is not None:
            force.softening_m = softening_m
        return self._changed(part, "forces", force)

    def _changed(self, part: str | None, field: str, added) -> BeamStyle:
        """With one more entry in a list of the style, or of its part of that name."""
        changed = self.copy()
        if part is None:
            getattr(changed.message, field).append(added)
            return changed
        for each in changed.message.parts:
            if each.name == part:
                getattr(each, field).append(added)
                return changed
        names = ", ".join(repr(each.name) for each in self.message.parts) or "none"
        raise InvalidArgument.of("part", f"is {part!r}, must be one of the parts: {names}")


def _region(pores: PoreRegion) -> beam_style_pb2.PoreRegion:
    if not isinstance(pores, PoreRegion):
        raise InvalidArgument.of("pores", f"is {pores!r}, must be a PoreRegion")
    return pores.message()


def _half_spaces(field: str, values: Iterable[HalfSpace]) -> list[beam_style_pb2.BeamHalfSpace]:
    return [
        half_space(f"{field}[{index}]", value, beam_style_pb2.BeamHalfSpace)
        for index, value in enumerate(values)
    ]


def _force(kind: int, pores: PoreRegion | None, where: Sequence[HalfSpace]):
    force = beam_style_pb2.BeamForce(kind=kind, where=_half_spaces("where", where))
    if pores is not None:
        force.pores.CopyFrom(_region(pores))
    return force
