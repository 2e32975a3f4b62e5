"""The kernels for 64-bit ARM pass their tests in an emulator."""

import subprocess
from pathlib import Path

import pytest


@pytest.mark.slow
def test_the_kernels_hold_on_arm():
    script = Path(__file__).resolve().parent / "neon" / "run"
    result = subprocess.run([script], capture_output=True, text=True, timeout=3600)
    assert result.returncode == 0, result.stdout + result.stderr
    assert result.stdout.endswith("tests/neon/run: ok\n")
