"""Styles of both kinds from JSON and to it, with errors for those who write it by hand.

A style by wisps is protobuf's own mapping of a `Style`. A style by beams is that of a `BeamStyle`
within `beam_style`, the only field of its document.
"""

from __future__ import annotations

import difflib
import json
import os
import re
from collections.abc import Sequence
from pathlib import Path

from google.protobuf import descriptor_pool, json_format

from mane.errors import FieldViolation, InvalidArgument
from mane.v1 import beam_style_pb2, style_pb2

_BEAMS = "beam_style"
_NO_FIELD = re.compile(r'Message type "([\w.]+)" has no field named "(\w+)"')
_PLACE = re.compile(r' at "?(?:Beam)?Style\.?((?:\w+(?:\[\d+\])?\.?)*)')
_STEP = re.compile(r"Failed to parse (\w+) field: ")

AnyStyle = style_pb2.Style | beam_style_pb2.BeamStyle
_ALL = (style_pb2.Style, beam_style_pb2.BeamStyle)


def load(path: str | os.PathLike, kinds: Sequence[type] = _ALL) -> AnyStyle:
    """As `parse`, of a file."""
    try:
        text = Path(path).read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        raise InvalidArgument.of(str(path), f"is not UTF-8 text: {error.reason}") from error
    return parse(text, str(path), kinds)


def parse(text: str, source: str = "", kinds: Sequence[type] = _ALL) -> AnyStyle:
    """The style of a JSON text, a message of one of the `kinds`.

    InvalidArgument names `source`, a file, and the field that is wrong, or the line where it is no
    JSON; or says that it is of another kind.
    """
    within = _beams(text, source)
    kind = style_pb2.Style if within is None else beam_style_pb2.BeamStyle
    if kind not in kinds:
        wanted = "a BeamStyle" if kind is beam_style_pb2.BeamStyle else "a Style"
        raise _wrong(source, _BEAMS, f"this document is {wanted}: load it as one")
    try:
        if within is None:
            return json_format.Parse(text, kind())
        return json_format.ParseDict(within, kind())
    except json_format.ParseError as error:
        field, why = _told(str(error).splitlines()[0])
        if within is not None:
            field = f"{_BEAMS}.{field}"
        raise _wrong(source, field, why) from error


def text(message: AnyStyle) -> str:
    """The document of a style: names as in the API, in its order; what is unset is left out."""
    document = json_format.MessageToDict(message, preserving_proto_field_name=True)
    if isinstance(message, beam_style_pb2.BeamStyle):
        document = {_BEAMS: document}
    return json.dumps(document, indent=2) + "\n"


def _beams(text: str, source: str) -> dict | None:
    """What a document of a style by beams holds; None of another, or of what is no JSON."""
    try:
        document = json.loads(text)
    except ValueError:
        return None
    if not isinstance(document, dict) or _BEAMS not in document:
        return None
    if others := sorted(set(document) - {_BEAMS}):
        raise _wrong(source, others[0], f"must not stand beside {_BEAMS}, which is a whole style")
    if not isinstance(document[_BEAMS], dict):
        raise _wrong(source, _BEAMS, "must be an object: a BeamStyle")
    return document[_BEAMS]


def _wrong(source: str, field: str, why: str) -> InvalidArgument:
    place = ": ".join(part for part in (source, field) if part)
    return InvalidArgument(f"{place}: {why}", (FieldViolation(field, why),))


def _told(text: str) -> tuple[str, str]:
    """The field's path, and what is wrong with it, out of the parser's message."""
    place = _PLACE.search(text)
    path = place[1].rstrip(".") if place else ".".join(_STEP.findall(text))
    if unknown := _NO_FIELD.search(text):
        message, name = unknown.groups()
        known = descriptor_pool.Default().FindMessageTypeByName(message).fields_by_name
        near = difflib.get_close_matches(name, known, n=1, cutoff=0.5)
        hint = f"did you mean {near[0]}?" if near else f"there are {', '.join(known)}"
        return ".".join(part for part in (path, name) if part), f"there is no such field; {hint}"
    cause = text[: place.start()] if place else text
    return path or "json", _STEP.sub("", cause).removeprefix("Failed to load JSON: ").rstrip(". ")
