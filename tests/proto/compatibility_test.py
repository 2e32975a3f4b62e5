"""The API breaks no client of the last release, and the check that says so sees every breakage."""

import pytest
from compatibility import RELEASED, breakages, compile_api
from google.protobuf import descriptor_pb2, text_format

SAMPLE = """
file {
  name: "a.proto" package: "p" syntax: "proto3"
  message_type {
    name: "M"
    field { name: "x" number: 1 type: TYPE_DOUBLE label: LABEL_OPTIONAL json_name: "x" }
    field { name: "y" number: 2 type: TYPE_INT32 label: LABEL_OPTIONAL json_name: "y"
            oneof_index: 0 }
    field { name: "z" number: 3 type: TYPE_MESSAGE type_name: ".p.M.Inner" label: LABEL_REPEATED
            json_name: "z" }
    oneof_decl { name: "kind" }
    nested_type { name: "Inner" }
    enum_type { name: "Color" value { name: "RED" number: 0 } value { name: "BLUE" number: 1 }
                reserved_range { start: 5 end: 6 } }
    reserved_range { start: 10 end: 13 }
    reserved_name: "old"
  }
  message_type { name: "N" }
  enum_type { name: "E" value { name: "ZERO" number: 0 } }
  service {
    name: "S"
    method { name: "Do" input_type: ".p.M" output_type: ".p.N" server_streaming: true }
  }
}
"""


def sample():
    return text_format.Parse(SAMPLE, descriptor_pb2.FileDescriptorSet())


def message(api):
    return api.file[0].message_type[0]


def method(api):
    return api.file[0].service[0].method[0]


def move_to_another_file(api):
    other = api.file.add(name="b.proto", package="p", syntax="proto3")
    other.message_type.add(name="N")
    del api.file[0].message_type[1]


def join_the_oneof(api):
    message(api).field[0].oneof_index = 0


def leave_the_oneof(api):
    message(api).field[1].ClearField("oneof_index")


# What is done to the API -> a part of the sentence that must come back.
BREAKING = {
    "package renamed": (lambda a: setattr(a.file[0], "package", "q"), "message p.M is gone"),
    "message removed": (lambda a: a.file[0].message_type.pop(1), "message p.N is gone"),
    "nested message removed": (lambda a: message(a).nested_type.pop(0), "p.M.Inner is gone"),
    "message renamed": (
        lambda a: setattr(a.file[0].message_type[1], "name", "N2"),
        "message p.N is gone",
    ),
    "message moved": (move_to_another_file, "moved from a.proto to b.proto"),
    "field removed": (lambda a: message(a).field.pop(0), "field p.M.x = 1 is gone"),
    "field renumbered": (lambda a: setattr(message(a).field[0], "number", 4), "x = 1 is gone"),
    "field renamed": (lambda a: setattr(message(a).field[0], "name", "w"), "name was x, is w"),
    "field retyped": (lambda a: setattr(message(a).field[0], "type", 2), "type was TYPE_DOUBLE"),
    "field of another message": (
        lambda a: setattr(message(a).field[2], "type_name", ".p.N"),
        "type was TYPE_MESSAGE.p.M.Inner",
    ),
    "label changed": (lambda a: setattr(message(a).field[0], "label", 3), "label was"),
    "presence changed": (
        lambda a: setattr(message(a).field[0], "proto3_optional", True),
        "presence was False",
    ),
    "field joins a oneof": (join_the_oneof, "oneof was None, is kind"),
    "field leaves a oneof": (leave_the_oneof, "oneof was kind, is None"),
    "JSON name changed": (lambda a: setattr(message(a).field[0], "json_name", "X"), "JSON name"),
    "packing changed": (
        lambda a: setattr(message(a).field[0].options, "packed", False),
        "packing was",
    ),
    "reserved number freed": (
        lambda a: setattr(message(a).reserved_range[0], "end", 12),
        "reserved numbers 10 to 12",
    ),
    "reserved name freed": (lambda a: message(a).reserved_name.pop(), "reserved name old"),
    "reserved enum number freed": (
        lambda a: setattr(message(a).enum_type[0].reserved_range[0], "end", 5),
        "reserved numbers 5 to 6",
    ),
    "enum removed": (lambda a: a.file[0].enum_type.pop(0), "enum p.E is gone"),
    "enum value removed": (lambda a: message(a).enum_type[0].value.pop(1), "BLUE = 1 is gone"),
    "enum value renamed": (
        lambda a: setattr(message(a).enum_type[0].value[1], "name", "CYAN"),
        "BLUE = 1 is gone",
    ),
    "enum value renumbered": (
        lambda a: setattr(message(a).enum_type[0].value[1], "number", 2),
        "BLUE = 1 is gone",
    ),
    "service removed": (lambda a: a.file[0].service.pop(0), "service p.S is gone"),
    "method removed": (lambda a: a.file[0].service[0].method.pop(0), "method p.S.Do is gone"),
    "method renamed": (lambda a: setattr(method(a), "name", "Did"), "method p.S.Do is gone"),
    "request changed": (lambda a: setattr(method(a), "input_type", ".p.N"), "input_type was"),
    "answer changed": (lambda a: setattr(method(a), "output_type", ".p.M"), "output_type was"),
    "client streams": (lambda a: setattr(method(a), "client_streaming", True), "client_streaming"),
    "server streams not": (
        lambda a: setattr(method(a), "server_streaming", False),
        "server_streaming was True",
    ),
}

COMPATIBLE = {
    "nothing": lambda a: None,
    "field added": lambda a: message(a).field.add(name="n", number=20, type=1, label=1),
    "field added to the oneof": lambda a: message(a).field.add(
        name="n", number=20, type=1, label=1, oneof_index=0
    ),
    "message added": lambda a: a.file[0].message_type.add(name="New"),
    "file added": lambda a: a.file.add(name="c.proto", package="p").message_type.add(name="New"),
    "enum value added": lambda a: message(a).enum_type[0].value.add(name="RED2", number=9),
    "method added": lambda a: a.file[0].service[0].method.add(name="More"),
    "number reserved": lambda a: message(a).reserved_range.add(start=50, end=60),
    "reserved range widened": lambda a: setattr(message(a).reserved_range[0], "end", 99),
}


def test_the_api_breaks_no_client_of_the_last_release():
    released = descriptor_pb2.FileDescriptorSet.FromString(RELEASED.read_bytes())
    assert len(released.file) >= 5, f"{RELEASED} is not the API"
    assert breakages(released, compile_api()) == []


@pytest.mark.parametrize("name", BREAKING)
def test_a_breaking_change_is_seen(name):
    change, sentence = BREAKING[name]
    old, new = sample(), sample()
    change(new)
    found = breakages(old, new)
    assert any(sentence in line for line in found), found


@pytest.mark.parametrize("name", COMPATIBLE)
def test_an_addition_is_allowed(name):
    old, new = sample(), sample()
    COMPATIBLE[name](new)
    assert breakages(old, new) == []


def test_every_part_of_the_api_is_guarded():
    """Removing any one field, value or method of the real API is seen."""
    api, cut = compile_api(), compile_api()
    removed = 0
    for file in cut.file:
        lists = [m.field for m in file.message_type]
        lists += [e.value for e in file.enum_type]
        lists += [s.method for s in file.service]
        for items in lists:
            for i in range(len(items)):
                kept = items.pop(i)
                assert breakages(api, cut), kept
                items.insert(i, kept)
                removed += 1
    assert removed > 100
