"""Compares two versions of the API: what would break clients of the old one.

The rule is stricter than the wire format: within a version of the package everything stays under
its name and number, in its file, of its type; things are only added.
"""

import subprocess
import tempfile
from pathlib import Path

from google.protobuf import descriptor_pb2

PROTO = Path(__file__).resolve().parents[2] / "proto"
RELEASED = Path(__file__).resolve().parent / "released.binpb"

_Field = descriptor_pb2.FieldDescriptorProto


def compile_api(root: Path = PROTO) -> descriptor_pb2.FileDescriptorSet:
    """The API as the .proto files under `root` have it now. CalledProcessError if they are wrong."""
    files = sorted(str(path.relative_to(root)) for path in root.glob("mane/v1/*.proto"))
    with tempfile.NamedTemporaryFile(suffix=".binpb") as out:
        subprocess.run(
            ["protoc", f"-I{root}", f"--descriptor_set_out={out.name}", *files], check=True
        )
        return descriptor_pb2.FileDescriptorSet.FromString(Path(out.name).read_bytes())


def breakages(
    old: descriptor_pb2.FileDescriptorSet, new: descriptor_pb2.FileDescriptorSet
) -> list[str]:
    """One sentence for each thing in `old` that a client may rely on and `new` has not."""
    found = []
    new_index = _index(new)
    for name, (kind, file, item) in _index(old).items():
        if name not in new_index:
            found.append(f"{kind} {name} is gone")
            continue
        new_kind, new_file, new_item = new_index[name]
        if new_kind != kind:
            found.append(f"{kind} {name} became a {new_kind}")
            continue
        if new_file != file:
            found.append(f"{kind} {name} moved from {file} to {new_file}")
        found += _COMPARE[kind](name, item, new_item)
    return found


def _index(files) -> dict[str, tuple]:
    """Full name -> (kind, file, descriptor) of every message, enum and service."""
    found = {}

    def add_message(prefix, file, message):
        name = f"{prefix}.{message.name}"
        found[name] = ("message", file, message)
        for nested in message.nested_type:
            add_message(name, file, nested)
        for enum in message.enum_type:
            found[f"{name}.{enum.name}"] = ("enum", file, enum)

    for file in files.file:
        for message in file.message_type:
            add_message(file.package, file.name, message)
        for enum in file.enum_type:
            found[f"{file.package}.{enum.name}"] = ("enum", file.name, enum)
        for service in file.service:
            found[f"{file.package}.{service.name}"] = ("service", file.name, service)
    return found


def _field_shape(message, field) -> dict[str, object]:
    """Everything about a field that shows on the wire or in generated code."""
    oneof = None
    if field.HasField("oneof_index") and not field.proto3_optional:
        oneof = message.oneof_decl[field.oneof_index].name
    return {
        "name": field.name,
        "type": f"{_Field.Type.Name(field.type)}{field.type_name}",
        "label": _Field.Label.Name(field.label),
        "presence": field.proto3_optional,
        "oneof": oneof,
        "JSON name": field.json_name,
        "packing": field.options.packed if field.options.HasField("packed") else None,
        "default": field.default_value if field.HasField("default_value") else None,
    }


def _message_breakages(name, old, new) -> list[str]:
    found = []
    new_fields = {field.number: field for field in new.field}
    for field in old.field:
        if field.number not in new_fields:
            found.append(f"field {name}.{field.name} = {field.number} is gone")
            continue
        before = _field_shape(old, field)
        after = _field_shape(new, new_fields[field.number])
        found += [
            f"field {name}.{field.name} = {field.number}: {key} was {before[key]}, is {after[key]}"
            for key in before
            if before[key] != after[key]
        ]
    kept = [range(r.start, r.end) for r in new.reserved_range]
    return found + _reserved_breakages(
        name, [range(r.start, r.end) for r in old.reserved_range], old, kept, new
    )


def _enum_breakages(name, old, new) -> list[str]:
    values = {(value.name, value.number) for value in new.value}
    found = [
        f"value {name}.{value.name} = {value.number} is gone"
        for value in old.value
        if (value.name, value.number) not in values
    ]
    # The ranges of enums include their end.
    kept = [range(r.start, r.end + 1) for r in new.reserved_range]
    return found + _reserved_breakages(
        name, [range(r.start, r.end + 1) for r in old.reserved_range], old, kept, new
    )


def _reserved_breakages(name, old_ranges, old, new_ranges, new) -> list[str]:
    """A number or name that was reserved because something used it once stays reserved."""
    found = [
        f"{name}: reserved numbers {r.start} to {r.stop - 1} are free again"
        for r in old_ranges
        if not any(k.start <= r.start and r.stop <= k.stop for k in new_ranges)
    ]
    lost = sorted(set(old.reserved_name) - set(new.reserved_name))
    return found + [f"{name}: reserved name {word} is free again" for word in lost]


def _service_breakages(name, old, new) -> list[str]:
    found = []
    new_methods = {method.name: method for method in new.method}
    for method in old.method:
        if method.name not in new_methods:
            found.append(f"method {name}.{method.name} is gone")
            continue
        after = new_methods[method.name]
        found += [
            f"method {name}.{method.name}: {key} was {getattr(method, key)}"
            for key in ("input_type", "output_type", "client_streaming", "server_streaming")
            if getattr(method, key) != getattr(after, key)
        ]
    return found


_COMPARE = {
    "message": _message_breakages,
    "enum": _enum_breakages,
    "service": _service_breakages,
}
