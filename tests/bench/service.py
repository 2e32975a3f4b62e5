"""Measures the service on this machine: start, memory, real-time load, slow reader, opening, speed.

Prints a table, and as the last line one JSON object. tests/bench/run builds what it needs.
"""

import argparse
import json
import os
import platform
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import grpc
from grpc_health.v1 import health_pb2, health_pb2_grpc

ROOT = Path(__file__).resolve().parents[2]
BUILD = ROOT / "build" / "bench"
MANED = BUILD / "server" / "app" / "maned"
LOAD = BUILD / "tests" / "bench" / "service_load"


class Daemon:
    """A maned of the benchmark's own, timed from its start to its first healthy answer."""

    def __init__(self, data: Path):
        port_file = data.parent / "port"
        port_file.unlink(missing_ok=True)
        start = time.monotonic()
        self.process = subprocess.Popen(
            [
                *(MANED, "--listen", "127.0.0.1:0", "--data-dir", str(data)),
                *("--port-file", str(port_file), "--log-level", "warning"),
            ]
        )
        try:
            while not port_file.exists():
                if self.process.poll() is not None or time.monotonic() > start + 30:
                    raise RuntimeError("maned did not start")
                time.sleep(0.001)
            self.address = f"127.0.0.1:{port_file.read_text().strip()}"
            with grpc.insecure_channel(self.address) as channel:
                health = health_pb2_grpc.HealthStub(channel)
                answer = health.Check(health_pb2.HealthCheckRequest(), timeout=30)
            if answer.status != health_pb2.HealthCheckResponse.SERVING:
                raise RuntimeError(f"maned is not healthy: {answer}")
        except BaseException:
            self.stop()
            raise
        self.healthy_after_s = time.monotonic() - start

    def resident_mb(self) -> float:
        pages = int(Path(f"/proc/{self.process.pid}/statm").read_text().split()[1])
        return pages * os.sysconf("SC_PAGE_SIZE") / 1e6

    def cpu_s(self) -> float:
        fields = Path(f"/proc/{self.process.pid}/stat").read_text().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def load(self, what: str, **options) -> dict:
        """One measurement of the load generator."""
        flags = [f"--{key.replace('_', '-')}={value}" for key, value in options.items()]
        command = [LOAD, what, f"--server={self.address}", *flags]
        return json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)

    def stop(self) -> None:
        self.process.terminate()
        self.process.wait(30)


class MemoryWatch:
    """Resident memory of a daemon, sampled ten times a second while the context lasts."""

    def __init__(self, daemon: Daemon):
        self.samples: list[float] = []
        self._daemon = daemon
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run)

    def _run(self) -> None:
        while not self._stop.wait(0.1):
            self.samples.append(self._daemon.resident_mb())

    def __enter__(self):
        self._thread.start()
        return self

    def __exit__(self, *_):
        self._stop.set()
        self._thread.join()

    def growth_mb(self) -> float:
        """From the end of the first quarter, when everything is open, to the end."""
        return self.samples[-1] - self.samples[len(self.samples) // 4]


def measure(seconds: float, folder: Path) -> dict:
    data = folder / "data"
    daemon = Daemon(data)
    result = {"healthy_after_s": round(daemon.healthy_after_s, 3)}
    try:
        time.sleep(2)  # Idle is what it is after the start has settled.
        result["idle_mb"] = round(daemon.resident_mb(), 1)
        daemon.load("create", groom="g100", guides=100)
        daemon.load("create", groom="g200", guides=200)

        cpu = daemon.cpu_s()
        result["realtime"] = daemon.load("play", groom="g100", heads=8, seconds=seconds)
        result["realtime"]["server_cores"] = round((daemon.cpu_s() - cpu) / (seconds + 2), 3)
        result["realtime"]["resident_mb"] = round(daemon.resident_mb(), 1)

        with MemoryWatch(daemon) as memory:
            slow = daemon.load("play", groom="g100", heads=1, seconds=seconds / 2, read_rate=6)
        result["slow_reader"] = slow | {"resident_growth_mb": round(memory.growth_mb(), 2)}
    finally:
        daemon.stop()

    daemon = Daemon(data)
    try:
        result["open_200_guides"] = daemon.load("open", groom="g200", heads=21)
        result["lockstep"] = daemon.load("lockstep", groom="g100", seconds=20)
    finally:
        daemon.stop()
    return result


def processor() -> str:
    """The processor's own name where the system tells it."""
    for line in Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            return line.partition(":")[2].strip()
    return platform.machine()


def table(result: dict) -> str:
    realtime, slow = result["realtime"], result["slow_reader"]
    rows = [
        ("time to the first healthy answer", f"{result['healthy_after_s']} s", "1 s"),
        ("resident memory, idle", f"{result['idle_mb']} MB", "60 MB"),
        ("8 heads x 100 guides: missed deadlines", realtime["missed_deadlines"], "0"),
        ("  frames made of frames due", f"{realtime['frames_made']} / {realtime['frames_due']}", ""),
        ("  pose-to-frame age, median", f"{realtime['age_p50_ms']} ms", ""),
        ("  pose-to-frame age, 99th percentile", f"{realtime['age_p99_ms']} ms", "40 ms"),
        ("  processor time of the server", f"{realtime['server_cores']} cores", ""),
        ("slow reader (6 a second): oldest frame", f"{slow['age_max_ms']} ms", "200 ms"),
        ("  growth of the server's memory", f"{slow['resident_growth_mb']} MB", "flat"),
        ("opening 200 guides, first after start", f"{result['open_200_guides']['first_ms']} ms", ""),
        ("  later ones, worst", f"{result['open_200_guides']['others_max_ms']} ms", "50 ms"),
        ("LOCKSTEP, one head of 100 guides", f"{result['lockstep']['times_real_time']} x", "10 x"),
    ]
    return "\n".join(f"{name:42} {value!s:>18}   {goal:>8}" for name, value, goal in rows)


def main() -> int:
    parser = argparse.ArgumentParser(prog="tests/bench/run service", description=__doc__)
    parser.add_argument("--seconds", type=float, default=60, help="of real-time load (60)")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        result = measure(arguments.seconds, Path(folder))
    result["machine"] = {"cores": os.cpu_count(), "processor": processor()}
    print(f"{'':42} {'measured':>18}   {'reach':>8}")
    print(table(result))
    print(json.dumps(result))
    return 0


if __name__ == "__main__":
    sys.exit(main())
