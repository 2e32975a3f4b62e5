"""Runs the C++ program of a benchmark."""

import argparse
import json
import subprocess
from pathlib import Path

FOLDER = Path(__file__).resolve().parents[3] / "build" / "bench" / "tests" / "bench"


def result_of(benchmark: str, program: str, description: str) -> dict:
    """What `program` prints, one JSON object; answers `tests/bench/run BENCHMARK --help` before."""
    argparse.ArgumentParser(
        prog=f"tests/bench/run {benchmark}",
        description=description,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    ).parse_args()
    output = subprocess.run([FOLDER / program], check=True, capture_output=True, text=True).stdout
    return json.loads(output)


def print_table(result: dict) -> None:
    """Prints names and numbers, those of parts after the name of their whole."""
    rows = {}
    for name, value in result.items():
        parts = value.items() if isinstance(value, dict) else [("", value)]
        rows |= {f"{name} {part}".strip(): number for part, number in parts}
    for name, number in rows.items():
        print(f"{name:<{max(map(len, rows)) + 2}}{number:>10}")
