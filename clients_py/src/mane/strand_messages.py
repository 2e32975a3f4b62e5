"""Conversions between strands, import options and reports, and the API's messages."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import asdict, fields

import numpy as np
from numpy.typing import ArrayLike

from mane import hair_messages, messages
from mane.bodies import Body
from mane.errors import InvalidArgument
from mane.groom import Ellipsoid, HairType
from mane.hairs import Hairs
from mane.mesh import Mesh
from mane.strands import HairProperties, ImportOptions, ImportReport, Strand
from mane.v1 import groom_pb2

_REPORT_ARRAYS = {
    "element_counts": "<u4",
    "largest_fit_distances": "<f4",
    "rms_fit_distances": "<f4",
    "bounds_met": "?",
    "held": "?",
    "stiffness_factors": "<f4",
    "needed_stiffness_factors": "<f4",
    "tip_deviations": "<f4",
    "largest_deviations": "<f4",
}


def properties(value: HairProperties) -> groom_pb2.HairProperties:
    return groom_pb2.HairProperties(**asdict(value))


def strand(value: Strand) -> groom_pb2.ImportedStrand:
    frame = value.root_frame
    return groom_pb2.ImportedStrand(
        points=value.points.astype("<f4").tobytes(),
        root_frame=None if frame is None else messages.quaternion(frame, "root_frame"),
        properties=properties(value.properties),
    )


def options(value: ImportOptions) -> groom_pb2.ImportOptions:
    return groom_pb2.ImportOptions(
        hair_type=messages.hair_type(value.hair_type),
        properties=properties(value.properties),
        element_count=value.element_count,
        error_bound_m=value.error_bound_m,
        noise_m=value.noise_m,
        hold=value.hold,
        max_stiffness_factor=value.max_stiffness_factor,
        stability_margin=value.stability_margin,
        wisp_radius_m=value.wisp_radius_m,
    )


def create_groom(
    header: groom_pb2.CreateGroomHeader,
    strands: Iterable[Strand | ArrayLike],
    chosen: ImportOptions,
    scalp: Mesh | Ellipsoid | None,
    bodies: Iterable[Body] = (),
    hairs: Hairs | None = None,
) -> Iterator[groom_pb2.CreateGroomRequest]:
    """The messages of one upload of strands, each about `messages.PIECE_BYTES` at most.

    What this side refuses is refused here, before the first message is sent.
    """
    header.import_options.CopyFrom(options(chosen))
    whole = [_strand_at(i, value) for i, value in enumerate(strands)]
    return _parts(header, whole, scalp, bodies, hairs)


def _strand_at(index: int, value: Strand | ArrayLike) -> Strand:
    try:
        return value if isinstance(value, Strand) else Strand(value)
    except InvalidArgument as error:
        raise InvalidArgument.of(f"strands[{index}]", str(error)) from error


def _parts(
    header, strands: list[Strand], scalp, bodies, hairs: Hairs | None
) -> Iterator[groom_pb2.CreateGroomRequest]:
    *parts, commit = messages.create_groom(header, (), scalp, bodies)
    yield from parts
    for batch in _batches(strands):
        yield groom_pb2.CreateGroomRequest(strands=batch)
    for batch in hair_messages.batches(hairs):
        yield groom_pb2.CreateGroomRequest(hairs=batch)
    yield commit


def _batches(strands: list[Strand]) -> Iterator[groom_pb2.StrandBatch]:
    batch, size = groom_pb2.StrandBatch(), 0
    for value in strands:
        message = strand(value)
        if size and size + message.ByteSize() > messages.PIECE_BYTES:
            yield batch
            batch, size = groom_pb2.StrandBatch(), 0
        batch.strands.append(message)
        size += message.ByteSize() + 8  # Tag and length.
    if size:
        yield batch


def from_report(message: groom_pb2.ImportReport) -> ImportReport:
    arrays = {
        name: np.frombuffer(getattr(message, name), dtype).copy()
        for name, dtype in _REPORT_ARRAYS.items()
    }
    summary = messages.from_import_summary(message.summary)
    return ImportReport(summary, _from_options(message.options), **arrays)


def _from_options(message: groom_pb2.ImportOptions) -> ImportOptions:
    preset = groom_pb2.HairType.Name(message.hair_type).removeprefix("HAIR_TYPE_").lower()
    return ImportOptions(
        hair_type=HairType(preset),
        properties=HairProperties(
            **{
                f.name: getattr(message.properties, f.name)
                for f in fields(HairProperties)
                if message.properties.HasField(f.name)
            }
        ),
        element_count=message.element_count,
        error_bound_m=message.error_bound_m,
        noise_m=message.noise_m if message.HasField("noise_m") else None,
        hold=message.hold,
        max_stiffness_factor=message.max_stiffness_factor,
        stability_margin=message.stability_margin,
        wisp_radius_m=message.wisp_radius_m,
    )
