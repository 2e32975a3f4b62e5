#!/usr/bin/env python3
"""Checks the house's arrows: which folder of server/ may include which, and which libraries.

Run it directly or by ctest. FOLDERS is the one table; each CMakeLists.txt must agree with it.
"""

import re
import tempfile
import unittest
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


@dataclass(frozen=True)
class Folder:
    """One static library. An arrow leads to `deps` and on to theirs.

    `libraries` are the outside headers it may include, by the names in LIBRARIES, and
    `source_libraries` those that only its .cpp files may. A `pure` folder knows no files, clocks,
    threads or streams.
    """

    deps: tuple[str, ...] = ()
    libraries: tuple[str, ...] = ()
    source_libraries: tuple[str, ...] = ()
    pure: bool = False


FOLDERS = {
    "base": Folder(libraries=("fmt",)),
    "math": Folder(("base",), ("Eigen",), pure=True),
    "exec": Folder(("base",), ("tbb",)),
    "simd": Folder(("base",), ("fmt", "intrinsics")),
    "rod": Folder(("math", "simd"), ("Eigen",), pure=True),
    "beam": Folder(("math", "simd"), ("Eigen", "fmt"), pure=True),
    "contact": Folder(("rod", "exec"), ("Eigen", "fmt"), ("xxhash", "embree")),
    "wire": Folder(("math",), ("Eigen",), pure=True),
    "groom": Folder(("rod", "beam", "exec", "wire"), ("Eigen", "fmt"), ("xxhash",)),
    "styling": Folder(("groom", "contact", "beam"), ("Eigen", "fmt"), ("png",)),
    "head": Folder(("groom", "contact", "beam", "exec", "wire"), ("Eigen", "fmt")),
    "session": Folder(("head",), ("Eigen", "fmt"), ("spdlog", "posix")),
    "storage": Folder(("base",), ("fmt",), ("spdlog", "sqlite", "posix")),
    "jobs": Folder(("storage",), ("fmt",), ("spdlog",)),
    "rpc": Folder(
        ("session", "jobs", "storage", "groom", "styling"),
        ("Eigen", "fmt", "grpc", "protobuf", "proto"),
        ("spdlog", "posix"),
    ),
    "app": Folder(("rpc",), ("fmt",), ("spdlog", "grpc", "CLI11", "toml++", "posix")),
}

LIBRARIES = {
    "fmt": ("fmt/",),
    "Eigen": ("Eigen/",),
    "tbb": ("tbb/", "oneapi/"),
    "sqlite": ("sqlite3.h",),
    "spdlog": ("spdlog/",),
    "grpc": ("grpc/", "grpcpp/", "google/rpc/"),
    "protobuf": ("google/protobuf/",),
    "proto": ("mane/v1/",),
    "absl": ("absl/",),
    "CLI11": ("CLI/",),
    "toml++": ("toml++/",),
    "gtest": ("gtest/", "gmock/"),
    "xxhash": ("xxhash.h",),
    "embree": ("embree3/",),
    "png": ("png.h",),
    "intrinsics": ("arm_neon.h", "immintrin.h"),
    "posix": (
        *("sys/", "netinet/", "arpa/"),
        *("fcntl.h", "poll.h", "pthread.h", "signal.h", "spawn.h", "stdlib.h", "unistd.h"),
    ),
}

# Standard headers that a pure folder does without.
IMPURE = frozenset(
    "atomic chrono condition_variable csignal cstdio ctime filesystem fstream future iostream mutex "
    "print semaphore shared_mutex stop_token syncstream thread".split()
)

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.MULTILINE)
DEPS = re.compile(r"mane_library\(\s*(\w+)\b([^)]*)\)")


def reachable(folder: str, deps: dict[str, tuple[str, ...]]) -> set[str]:
    """Everything at the end of an arrow, or of a chain of arrows, from `folder`."""
    found: set[str] = set()
    ahead = list(deps.get(folder, ()))
    while ahead:
        name = ahead.pop()
        if name not in found:
            found.add(name)
            ahead.extend(deps.get(name, ()))
    return found


def library_of(header: str) -> str | None:
    """The name in LIBRARIES to which a header that is not ours belongs; None for a standard one."""
    if "/" not in header and header.endswith(".pb.h"):
        return "proto"  # Messages of a folder's own.
    for name, prefixes in LIBRARIES.items():
        if any(header == p or (p.endswith("/") and header.startswith(p)) for p in prefixes):
            return name
    return None if re.fullmatch(r"[a-z_0-9]+", header) else header


def include_faults(folder: str, file: Path, text: str) -> list[str]:
    """What is wrong with the includes of one source file of `folder`."""
    rules = FOLDERS[folder]
    allowed = {folder} | reachable(folder, {name: f.deps for name, f in FOLDERS.items()})
    libraries = set(rules.libraries)
    if file.suffix == ".cpp":
        libraries |= set(rules.source_libraries)
    is_test = file.stem.endswith("_test") or file.stem.startswith("test_")
    if is_test:
        libraries |= {"gtest", "posix"}
    faults = []
    for quote, header in INCLUDE.findall(text):
        library = library_of(header)
        target = header.split("/")[0]
        if quote == '"' and library is None:
            faults.append(f'{file}: "{header}": name the folder: "{folder}/{header}"')
        elif quote == '"' and library == header:
            if target not in allowed:
                faults.append(f'{file}: {folder} may not include {target} ("{header}")')
        elif library is not None and library not in libraries:
            faults.append(f"{file}: {folder} may not include {library} (<{header}>)")
        elif library is None and rules.pure and not is_test and header in IMPURE:
            faults.append(f"{file}: {folder} is pure and may not include <{header}>")
    return faults


def declared_deps(cmake: str) -> tuple[str, ...] | None:
    """DEPS of the mane_library call in a CMakeLists.txt; None without such a call."""
    call = DEPS.search(cmake)
    if not call:
        return None
    words = call[2].split()
    if "DEPS" not in words:
        return ()
    deps = []
    for word in words[words.index("DEPS") + 1 :]:
        if word in ("SOURCES", "LIBS"):
            break
        deps.append(word.removeprefix("mane_"))
    return tuple(deps)


def faults_of(server: Path) -> list[str]:
    """Everything that breaks the table in the tree `server`."""
    faults = []
    present = {path.parent.name for path in server.glob("*/CMakeLists.txt")}
    faults += [f"server/{name} is not in the table" for name in sorted(present - FOLDERS.keys())]
    faults += [f"server/{name} has no CMakeLists.txt" for name in sorted(FOLDERS.keys() - present)]
    table = {name: folder.deps for name, folder in FOLDERS.items()}
    faults += [f"{name} reaches itself" for name in table if name in reachable(name, table)]
    for name in sorted(present & FOLDERS.keys()):
        deps = declared_deps((server / name / "CMakeLists.txt").read_text())
        if deps is not None:
            declared = reachable(name, table | {name: deps}) - {"proto"}
            wrong = declared ^ reachable(name, table)
            if wrong:
                faults.append(f"server/{name}/CMakeLists.txt: DEPS differ in {sorted(wrong)}")
        elif name != "app":  # app is a program.
            faults.append(f"server/{name}/CMakeLists.txt has no mane_library")
        for file in sorted((server / name).rglob("*")):
            if file.suffix in (".h", ".cpp"):
                faults += include_faults(name, file, file.read_text())
    return faults


class Layers(unittest.TestCase):
    def test_the_tree_keeps_the_arrows(self):
        faults = faults_of(ROOT / "server")
        self.assertEqual(faults, [], "\n" + "\n".join(faults))


class Checker(unittest.TestCase):
    """The check itself finds what it is there for."""

    def faults(self, folder, include, name="x.cpp"):
        return include_faults(folder, Path(name), f"#pragma once\n#include {include}\n")

    def test_arrows_are_followed_and_not_reversed(self):
        self.assertEqual(self.faults("head", '"rod/helix.h"'), [])
        self.assertEqual(self.faults("rod", '"rod/helix.h"'), [])
        self.assertEqual(len(self.faults("rod", '"head/head.h"')), 1)
        self.assertEqual(len(self.faults("storage", '"groom/groom.h"')), 1)

    def test_includes_name_their_folder(self):
        self.assertEqual(len(self.faults("rod", '"helix.h"')), 1)
        self.assertEqual(len(self.faults("rod", '"../head/head.h"')), 1)

    def test_transport_stays_in_rpc(self):
        for header in ("<grpcpp/grpcpp.h>", "<google/protobuf/message.h>"):
            self.assertEqual(self.faults("rpc", header), [], header)
        for header in ("<grpcpp/grpcpp.h>", "<google/protobuf/message.h>", "<absl/time/time.h>"):
            for folder in ("base", "rod", "head", "session", "jobs", "storage"):
                self.assertEqual(len(self.faults(folder, header)), 1, f"{folder} {header}")
        self.assertEqual(len(self.faults("session", '"mane/v1/types.pb.h"')), 1)

    def test_pure_folders_know_no_world(self):
        for header in ("<thread>", "<chrono>", "<fstream>", "<spdlog/spdlog.h>", "<unistd.h>"):
            for folder in ("math", "rod"):
                self.assertEqual(len(self.faults(folder, header)), 1, f"{folder} {header}")
        self.assertEqual(self.faults("rod", "<vector>"), [])

    def test_logging_stays_out_of_headers(self):
        self.assertEqual(self.faults("session", "<spdlog/spdlog.h>"), [])
        self.assertEqual(len(self.faults("session", "<spdlog/spdlog.h>", "x.h")), 1)

    def test_unknown_libraries_are_refused(self):
        self.assertEqual(len(self.faults("session", "<boost/asio.hpp>")), 1)
        self.assertEqual(len(self.faults("math", "<gtest/gtest.h>")), 1)
        self.assertEqual(self.faults("math", "<gtest/gtest.h>", "x_test.cpp"), [])

    def test_build_files_are_compared_with_the_table(self):
        with tempfile.TemporaryDirectory() as folder:
            server = Path(folder)
            for name, rules in FOLDERS.items():
                deps = " ".join(f"mane_{d}" for d in rules.deps)
                (server / name).mkdir()
                text = f"mane_library({name} SOURCES x.cpp\n  DEPS {deps}\n  LIBS fmt::fmt)\n"
                (server / name / "CMakeLists.txt").write_text(text)
            self.assertEqual(faults_of(server), [])
            text = "mane_library(rod SOURCES x.cpp DEPS mane_math mane_head)\n"
            (server / "rod" / "CMakeLists.txt").write_text(text)
            self.assertTrue(any("rod/CMakeLists.txt" in fault for fault in faults_of(server)))
            (server / "odd").mkdir()
            (server / "odd" / "CMakeLists.txt").write_text("")
            self.assertIn("server/odd is not in the table", faults_of(server))


if __name__ == "__main__":
    unittest.main()
