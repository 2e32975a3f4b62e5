"""Fixtures: a real daemon, clients of it, and small grooms."""

from __future__ import annotations

import os
import subprocess
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

# Else gRPC's handlers of forks write into the standard error of what tests start, ffmpeg's among
# it, which is read. It is looked at when gRPC is imported.
os.environ.setdefault("GRPC_ENABLE_FORK_SUPPORT", "0")

import numpy as np  # noqa: E402
import pytest  # noqa: E402

import mane  # noqa: E402

START_TIMEOUT_S = 20.0


@dataclass
class Daemon:
    """A running `maned`."""

    address: str
    process: subprocess.Popen
    log: Path


def start_daemon(folder: Path, *options: str) -> Daemon:
    """Starts the daemon that MANED names, on a free loopback port; waits until it serves."""
    binary = os.environ.get("MANED")
    if not binary:
        pytest.fail("MANED is not set: it must hold the path of the maned binary to test against")
    port_file = folder / "port"
    port_file.unlink(missing_ok=True)
    command = [
        binary, "--listen", "127.0.0.1:0", "--data-dir", str(folder / "data"),
        "--port-file", str(port_file), *options,
    ]  # fmt: skip
    log = folder / "maned.log"
    with open(log, "ab") as output:
        process = subprocess.Popen(command, stdout=output, stderr=output)
    deadline = time.monotonic() + START_TIMEOUT_S
    while not (port_file.exists() and port_file.read_text().strip()):
        if process.poll() is not None or time.monotonic() > deadline:
            process.kill()
            pytest.fail(f"{' '.join(command)} does not serve:\n{log.read_text()}")
        time.sleep(0.02)
    return Daemon(f"127.0.0.1:{port_file.read_text().strip()}", process, log)


def stop_daemon(daemon: Daemon) -> int:
    """Ends the daemon as an operator would; returns its exit code."""
    daemon.process.terminate()
    try:
        return daemon.process.wait(START_TIMEOUT_S)
    except subprocess.TimeoutExpired:
        daemon.process.kill()
        daemon.process.wait()
        pytest.fail(f"maned does not end on SIGTERM:\n{daemon.log.read_text()}")


@pytest.fixture(scope="session")
def maned(tmp_path_factory) -> Iterator[Daemon]:
    """One daemon for all tests; it must still run, and end cleanly, after the last."""
    daemon = start_daemon(tmp_path_factory.mktemp("maned"))
    try:
        yield daemon
        assert daemon.process.poll() is None, f"maned died:\n{daemon.log.read_text()}"
    finally:
        code = stop_daemon(daemon)
    assert code == 0, f"maned ended with {code}:\n{daemon.log.read_text()}"


@pytest.fixture
def client(maned) -> Iterator[mane.Client]:
    with mane.Client(maned.address) as client:
        yield client


def make_guide(**changes) -> mane.Guide:
    """A guide of ordinary hair that grows upward; every physical parameter is given."""
    values = {
        "root_position": (0.0, 0.1, 0.0),
        "root_frame": mane.frame_along((0, 1, 0)),
        "length_m": 0.15,
        "element_count": 4,
        "radius_1_m": 5e-5,
        "radius_2_m": 4e-5,
        "young_modulus_pa": 3.9e9,
        "poisson_ratio": 0.48,
        "density_kg_m3": 1300,
        "internal_friction": 5e-10,
        "air_drag": 5e-6,
        "natural_curvature_1": 20.0,
        "natural_twist": 10.0,
    }
    return mane.Guide(**(values | changes))


def make_guides(count: int, seed: int = 1) -> list[mane.Guide]:
    """Guides of different lengths, element counts, roots and curls."""
    rng = np.random.default_rng(seed)
    return [
        make_guide(
            root_position=rng.uniform(-0.1, 0.1, 3),
            root_frame=mane.frame_along(rng.normal(size=3)),
            length_m=rng.uniform(0.05, 0.2),
            element_count=int(rng.integers(1, 7)),
            natural_curvature_1=rng.uniform(-60, 60),
            natural_curvature_2=rng.uniform(-60, 60),
            natural_twist=rng.uniform(-30, 30),
        )
        for _ in range(count)
    ]


def shake(seconds: float = 1.0, rate_hz: float = 60.0) -> mane.Motion:
    """A head that moves to and fro and turns."""
    times = np.arange(round(seconds * rate_hz)) / rate_hz
    positions = np.outer(0.05 * np.sin(2 * np.pi * times), (1, 0.3, 0.2))
    half = 0.25 * np.sin(2 * np.pi * 1.3 * times)
    zeros = np.zeros_like(times)
    return mane.Motion(
        times, positions, np.stack([zeros, np.sin(half), zeros, np.cos(half)], axis=1)
    )


@pytest.fixture
def groom(client) -> Iterator[mane.Groom]:
    """Five guides of different kinds."""
    groom = client.create_groom(make_guides(5))
    yield groom
    client.delete_groom(groom)
