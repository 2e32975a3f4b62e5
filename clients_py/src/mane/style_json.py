"""Styles from JSON, with errors for those who write it by hand."""

from __future__ import annotations

import difflib
import re

from google.protobuf import descriptor_pool, json_format

from mane.errors import FieldViolation, InvalidArgument
from mane.v1 import style_pb2

_NO_FIELD = re.compile(r'Message type "([\w.]+)" has no field named "(\w+)"')
_PLACE = re.compile(r' at "?Style\.?((?:\w+(?:\[\d+\])?\.?)*)')
_STEP = re.compile(r"Failed to parse (\w+) field: ")


def parse(text: str, source: str = "") -> style_pb2.Style:
    """The style of a JSON text, protobuf's own mapping.

    InvalidArgument names `source`, a file, and the field that is wrong, or the line where it is no
    JSON.
    """
    try:
        return json_format.Parse(text, style_pb2.Style())
    except json_format.ParseError as error:
        field, why = _told(str(error).splitlines()[0])
        place = ": ".join(part for part in (source, field) if part)
        raise InvalidArgument(f"{place}: {why}", (FieldViolation(field, why),)) from error


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
