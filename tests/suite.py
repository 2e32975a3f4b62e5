"""Runs all tests of the repository and sums them up; tests/run starts it."""

import argparse
import os
import shutil
import subprocess
import sys
import time
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
RESULTS = ROOT / "build" / "test-results"
MANED = ROOT / "build" / "ci" / "server" / "app" / "maned"
PYTHON = str(ROOT / "build" / "venv" / "bin" / "python")
JOBS = str(os.cpu_count())

DESCRIPTION = """
Builds everything and runs all tests: C++ unit and end-to-end tests, Python tests, the checks of
include arrows, API compatibility, format and lint. With --full also the static analyser, and the
unit tests once more under AddressSanitizer with UndefinedBehaviorSanitizer and under
ThreadSanitizer. Ends with the line `N passed, N failed`; the exit code is 0 only when nothing failed.
"""


@dataclass
class Totals:
    passed: int = 0
    failed: int = 0
    failures: list[str] = field(default_factory=list)

    def add(self, name: str, ok: bool) -> None:
        if ok:
            self.passed += 1
        else:
            self.failed += 1
            self.failures.append(name)


def run_command(title: str, command: list[str]) -> bool:
    """Runs one command from the root, its output below a headline. Whether it succeeded."""
    print(f"\n=== {title}: {' '.join(command)}", flush=True)
    start = time.monotonic()
    try:
        environment = os.environ | {"MANED": str(MANED)}
        ok = subprocess.run(command, cwd=ROOT, env=environment).returncode == 0
    except OSError as error:
        print(error)
        ok = False
    print(f"=== {title}: {'ok' if ok else 'FAILED'}, {time.monotonic() - start:.0f} s", flush=True)
    return ok


def add_report(totals: Totals, title: str, ok: bool, report: Path) -> None:
    """Adds the cases of a JUnit file. A run that failed without a failed case, or that has no case,
    is a failure of its own."""
    cases = []
    if report.exists():
        cases = ElementTree.parse(report).getroot().iter("testcase")
        cases = [case for case in cases if case.find("skipped") is None]
    failed_before = totals.failed
    for case in cases:
        wrong = case.find("failure") is not None or case.find("error") is not None
        name = "::".join(filter(None, (case.get("classname"), case.get("name"))))
        totals.add(f"{title}: {name}", not wrong)
    if not cases:
        totals.add(f"{title}: ran no test", False)
    elif not ok and totals.failed == failed_before:
        totals.add(f"{title}: ended with an error", False)


def build(totals: Totals, preset: str) -> bool:
    """Configures and builds a preset."""
    configured = (ROOT / "build" / preset / "build.ninja").exists()
    presets = (ROOT / "CMakePresets.json").stat().st_mtime
    if configured and (ROOT / "build" / preset / "build.ninja").stat().st_mtime > presets:
        ok = True
    else:
        ok = run_command(f"configure {preset}", ["cmake", "--preset", preset])
    ok = ok and run_command(
        f"build {preset}", ["cmake", "--build", "--preset", preset, "--parallel", JOBS]
    )
    totals.add(f"build {preset}", ok)
    return ok


def run_ctest(totals: Totals, preset: str) -> None:
    report = RESULTS / f"ctest-{preset}.xml"
    command = ["ctest", "--preset", preset, "--parallel", JOBS, "--output-junit", str(report)]
    ok = run_command(f"ctest {preset}", command)
    add_report(totals, f"ctest {preset}", ok, report)


def run_pytest(totals: Totals, folder: str, slow: bool) -> None:
    report = RESULTS / f"pytest-{folder.replace('/', '-')}.xml"
    command = [PYTHON, "-m", "pytest", folder, f"--junitxml={report}", "--durations=5"]
    if folder == "tests" and slow:
        command += ["-m", "slow or not slow"]
    ok = run_command(f"pytest {folder}", command)
    add_report(totals, f"pytest {folder}", ok, report)


def sources() -> list[str]:
    """Our C++ files."""
    folders = ("server", "client_cpp", "tests")
    files = (path for folder in folders for path in (ROOT / folder).rglob("*"))
    return sorted(str(p.relative_to(ROOT)) for p in files if p.suffix in (".h", ".cpp"))


def check_format(totals: Totals) -> None:
    command = ["clang-format-14", "--dry-run", "-Werror", *sources()]
    print(f"\n=== format: clang-format-14 --dry-run -Werror, {len(command) - 3} files", flush=True)
    ok = subprocess.run(command, cwd=ROOT).returncode == 0
    if not ok:
        print("repair with: clang-format-14 -i FILE...")
    totals.add("format", ok)


def parse_arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="tests/run",
        description=DESCRIPTION,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--full", action="store_true", help="also sanitizers and the static analyser")
    parser.add_argument("--slow", action="store_true", help="also the container image (minutes)")
    return parser.parse_args()


def main() -> int:
    arguments = parse_arguments()
    start = time.monotonic()
    shutil.rmtree(RESULTS, ignore_errors=True)
    RESULTS.mkdir(parents=True)
    totals = Totals()

    check_format(totals)
    if build(totals, "ci"):
        run_ctest(totals, "ci")
        run_pytest(totals, "clients_py/tests", arguments.slow)
        totals.add("lint", run_command("lint", ["python3", "tests/lint.py", "build/ci"]))
    run_pytest(totals, "tests", arguments.slow)
    if arguments.full:
        for preset in ("asan", "tsan"):
            if build(totals, preset):
                run_ctest(totals, preset)
        analyze = ["python3", "tests/lint.py", "--analyze", "build/ci"]
        totals.add("analyser", run_command("analyser", analyze))

    for name in totals.failures:
        print(f"FAILED {name}")
    print(f"\n{time.monotonic() - start:.0f} s")
    print(f"{totals.passed} passed, {totals.failed} failed")
    return 0 if totals.failed == 0 and totals.passed > 0 else 1


if __name__ == "__main__":
    sys.exit(main())
