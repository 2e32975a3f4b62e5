#!/usr/bin/env python3
"""Runs clang-tidy over the product's sources, tests aside, skipping what passed before unchanged.

Its static analyser costs as much as all other checks together, and runs with --analyze only.
"""

import argparse
import hashlib
import json
import os
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
TIDY = "clang-tidy-14"
INCLUDE = re.compile(rb'^\s*#\s*include\s*"([^"]+)"', re.MULTILINE)
INCLUDE_FOLDERS = ("server", "client_cpp/include", "client_cpp/src", "client_cpp")


@cache
def digest_of_file(path: Path) -> bytes:
    return hashlib.sha256(path.read_bytes()).digest()


@cache
def direct_includes(path: Path) -> tuple[Path, ...]:
    """Our own headers that a file includes; the system's are constant enough."""
    found = []
    for name in INCLUDE.findall(path.read_bytes()):
        for folder in (path.parent, *(ROOT / f for f in INCLUDE_FOLDERS)):
            if (folder / name.decode()).is_file():
                found.append((folder / name.decode()).resolve())
                break
    return tuple(found)


def fingerprint(source: Path, command: str, checks: str) -> str:
    """Changes whenever the verdict on `source` may."""
    files, ahead = set(), [source]
    while ahead:
        path = ahead.pop()
        if path not in files:
            files.add(path)
            ahead.extend(direct_includes(path))
    total = hashlib.sha256((command + checks).encode())
    for path in [ROOT / ".clang-tidy", Path(__file__), *sorted(files)]:
        total.update(digest_of_file(path))
    for path in sorted((ROOT / "proto").rglob("*.proto")):
        total.update(digest_of_file(path))
    return total.hexdigest()


def is_product(source: Path) -> bool:
    name = source.relative_to(ROOT)
    return "tests" not in name.parts and not re.fullmatch(r"test_.*|.*_test", source.stem)


def lint(build: Path, source: Path, checks: str) -> str:
    """What clang-tidy has to say; empty when nothing."""
    command = [
        TIDY,
        "--quiet",
        f"-p={build}",
        f"--checks={checks}",
        "--extra-arg=-Wno-unknown-warning-option",
        str(source),
    ]
    result = subprocess.run(command, capture_output=True, text=True, cwd=ROOT)
    if result.returncode == 0:
        return ""
    return result.stdout + (result.stderr if not result.stdout else "")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("build", type=Path, help="a build folder with compile_commands.json")
    parser.add_argument("--analyze", action="store_true", help="with the static analyser")
    parser.add_argument("files", nargs="*", type=Path, help="only these sources")
    arguments = parser.parse_args()

    checks = "" if arguments.analyze else "-clang-analyzer-*"
    commands = json.loads((arguments.build / "compile_commands.json").read_text())
    wanted = {path.resolve() for path in arguments.files}
    passed = arguments.build / "lint-passed"
    passed.mkdir(exist_ok=True)

    work = {}
    generated = arguments.build.resolve()
    for entry in commands:
        source = Path(entry["file"])
        if generated in source.parents or not is_product(source):
            continue
        if not wanted or source in wanted:
            work[source] = passed / fingerprint(source, entry["command"], checks)
    stale = [source for source, stamp in work.items() if not stamp.exists()]
    print(f"{len(work)} files, {len(stale)} to look at", flush=True)

    failed = 0
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for source, complaint in zip(
            stale, pool.map(lambda source: lint(arguments.build, source, checks), stale), strict=True
        ):
            if complaint:
                failed += 1
                print(f"--- {source.relative_to(ROOT)}\n{complaint}", flush=True)
            else:
                work[source].touch()
    print(f"{failed} files with complaints")
    return 1 if failed or not work else 0


if __name__ == "__main__":
    sys.exit(main())
