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
