"""Measures how near strands of few elements come to the converged rod.

Prints a table, and as the last line one JSON object, each with N = 5 and 10 elements of the lengths
that generated hair has: distance of the resting tip of a heavy cantilever (gravito-bending number
163, smooth hair of 20 cm) and of rods that bend and twist out of their plane, relative to the
length; first natural frequency of a cantilever without weight, relative; rms distance of the tip
over two seconds of a moderate shake of the head, 20 cm; and that of the batched float32 step from
the double-precision one. tests/bench/run builds what it needs.
"""

import argparse
import json
import subprocess
from pathlib import Path

PROGRAM = Path(__file__).resolve().parents[2] / "build" / "bench" / "tests" / "bench" / "accuracy"
ROWS = {
    "resting tip, heavy cantilever": "static_tip",
    "  equal lengths": "static_tip_equal_lengths",
    "resting tip, bent and twisted": "bend_twist",
    "first frequency": "first_frequency",
    "  equal lengths ": "first_frequency_equal_lengths",
}


def main() -> None:
    argparse.ArgumentParser(
        prog="tests/bench/run accuracy",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    ).parse_args()
    output = subprocess.run([PROGRAM], check=True, capture_output=True, text=True).stdout
    result = json.loads(output)

    rows = {title: result[key] for title, key in ROWS.items()}
    for hair in result["shake"]:
        rows[f"shaken tip, {hair}"] = result["shake"][hair]
        rows[f"  equal lengths, {hair}"] = result["shake_equal_lengths"][hair]
    for hair, errors in result["float_over_double"].items():
        rows[f"float32 over double, {hair}"] = errors
    print(f"{'relative error':<34}{'N = 5':>10}{'N = 10':>10}")
    for title, errors in rows.items():
        print(f"{title:<34}{errors['5']:>10.2g}{errors['10']:>10.2g}")
    print(json.dumps(result))


if __name__ == "__main__":
    main()
