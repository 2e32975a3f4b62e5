"""Sources compiled for one instruction set share no function with others.

The linker keeps one copy of a function that several objects define. Were that the one of a kernel
source, every machine would run its instructions.
"""

import os
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
MANED = os.environ.get("MANED", str(ROOT / "build" / "ci" / "server" / "app" / "maned"))
OBJECTS = sorted(Path(MANED).parents[1].rglob("batch_kernel_*.o"))


def shared_symbols(obj: Path) -> list[str]:
    """Functions of an object that the linker may take for those of another."""
    out = subprocess.run(["nm", "-C", "--defined-only", obj], check=True, capture_output=True, text=True)
    symbols = [line.split(maxsplit=2) for line in out.stdout.splitlines()]
    return [name for _, kind, name in symbols if kind in "WVuvw"]


@pytest.mark.parametrize("obj", OBJECTS, ids=lambda path: path.name)
def test_kernels_keep_their_functions_to_themselves(obj):
    isa = obj.name.removeprefix("batch_kernel_").removesuffix(".cpp.o")
    names = shared_symbols(obj)
    assert names, "no templates in a kernel source?"
    assert [name for name in names if f"::{isa}::" not in name] == []


def test_there_are_kernels():
    assert len(OBJECTS) >= 2
