"""Compares Mane with other rod codes: one hair that hangs from a horizontal clamp.

A code's row says how far its tip comes to rest from the exact elastica, over the strand's length,
and what a step and a sixtieth of a second cost it. Time is processor time of one core. Prints a
table, and as the last line one JSON object. tests/bench/run builds and installs what it needs.
"""

import argparse
import contextlib
import importlib
import json
import subprocess
import sys
from pathlib import Path

from rods import strand, table
from rods.strand import Row

PROGRAM = Path(__file__).resolve().parents[2] / "build" / "bench" / "tests" / "bench" / "peers"
RESOLUTIONS = ("1", "2", "3", "5", "10", "20", "40")
PEERS = {"mujoco": "mujoco_rods", "pyelastica": "pyelastica_rods", "newton": "newton_rods"}


def mane_rows() -> list[Row]:
    x, z = strand.reference_tip()
    command = [PROGRAM, repr(x), repr(z), *RESOLUTIONS]
    answer = json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)
    return [Row(**row) for row in answer["rows"]]


def peer_rows(names: list[str]) -> list[Row]:
    """Rows of the peers that run here; what keeps one from running is said on stderr."""
    rows = []
    for name in names:
        try:
            with contextlib.redirect_stdout(sys.stderr):
                rows += importlib.import_module(f"rods.{PEERS[name]}").rows()
        except Exception as error:  # A foreign code's failure must not cost the others' rows.
            print(f"{name}: left out: {type(error).__name__}: {error}", file=sys.stderr)
    return rows


def main() -> int:
    parser = argparse.ArgumentParser(prog="tests/bench/run peers", description=__doc__)
    parser.add_argument("--only", choices=PEERS, action="append", help="this peer; may be repeated")
    arguments = parser.parse_args()
    mane = mane_rows()
    rows = [*mane, *peer_rows(arguments.only or list(PEERS))]
    print(table.text(rows, mane))
    print(json.dumps(table.summary(rows, mane)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
