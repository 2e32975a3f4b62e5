"""The container image builds, and its daemon serves and drains."""

import subprocess
from pathlib import Path

import pytest


@pytest.mark.slow
def test_the_image_builds_serves_and_drains():
    script = Path(__file__).resolve().parent.parent / "deploy" / "image"
    result = subprocess.run([script], capture_output=True, text=True, timeout=3600)
    assert result.returncode == 0, result.stdout + result.stderr
    assert result.stdout.endswith("deploy/image: ok\n")
