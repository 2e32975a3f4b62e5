"""The daemon as an operator meets it: start, port file, health check, refusals, drain."""

import os
import signal
import subprocess
import time
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
MANED = os.environ.get("MANED", str(ROOT / "build" / "ci" / "server" / "app" / "maned"))
DEADLINE_S = 30


class Daemon:
    """A maned of its own on a free port, with everything it says."""

    def __init__(self, folder: Path, *arguments: str, listen: str = "127.0.0.1:0"):
        self.port_file = folder / "port"
        self.log = folder / "log"
        self.port_file.unlink(missing_ok=True)
        with self.log.open("w") as log:
            self.process = subprocess.Popen(
                [
                    *(MANED, "--listen", listen, "--data-dir", str(folder / "data")),
                    *("--port-file", str(self.port_file), *arguments),
                ],
                stderr=log,
            )

    def wait_until_it_listens(self) -> int:
        deadline = time.monotonic() + DEADLINE_S
        while not self.port_file.exists():
            assert self.process.poll() is None, self.log.read_text()
            assert time.monotonic() < deadline, "no port file"
            time.sleep(0.01)
        return int(self.port_file.read_text())

    def stop(self, signal_number: int) -> int:
        self.process.send_signal(signal_number)
        return self.process.wait(DEADLINE_S)


@pytest.fixture
def start(tmp_path):
    daemons = []

    def start_one(*arguments, **options):
        daemons.append(Daemon(tmp_path, *arguments, **options))
        return daemons[-1]

    yield start_one
    for daemon in daemons:
        if daemon.process.poll() is None:
            daemon.process.kill()
            daemon.process.wait()


def maned(*arguments, **variables) -> subprocess.CompletedProcess:
    return subprocess.run(
        [MANED, *arguments],
        capture_output=True,
        text=True,
        timeout=DEADLINE_S,
        env=os.environ | variables,
    )


def is_healthy(port: int, *arguments: str) -> bool:
    return maned("--health-check", "--listen", f"127.0.0.1:{port}", *arguments).returncode == 0


@pytest.mark.parametrize("signal_number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_drains_a_healthy_daemon(start, signal_number):
    daemon = start()
    port = daemon.wait_until_it_listens()
    assert is_healthy(port)
    assert daemon.stop(signal_number) == 0
    assert not is_healthy(port)
    log = daemon.log.read_text()
    assert "event=draining" in log
    assert "event=stopped" in log


def test_the_log_is_one_line_an_event_and_holds_the_configuration(start):
    daemon = start("--workers", "1", "--max-heads", "7")
    daemon.wait_until_it_listens()
    assert daemon.stop(signal.SIGTERM) == 0
    lines = daemon.log.read_text().splitlines()
    assert all(line.startswith("time=") and " event=" in line for line in lines), lines
    configuration = [line for line in lines if "event=configuration" in line]
    assert len(configuration) == 1
    assert " workers=1 max-heads=7 " in configuration[0]


def test_the_environment_configures_too(tmp_path):
    refused = maned(MANE_WORKERS="none")
    assert refused.returncode == 2
    assert "MANE_WORKERS is 'none'" in refused.stderr


def test_an_instruction_set_that_this_machine_lacks_is_refused(tmp_path):
    refused = maned("--listen", "127.0.0.1:0", "--data-dir", str(tmp_path / "data"), MANE_ISA="mmx")
    assert refused.returncode == 1
    assert "MANE_ISA" in refused.stderr and "scalar" in refused.stderr


def test_a_second_daemon_on_the_same_folder_is_refused(start, tmp_path):
    start().wait_until_it_listens()
    second = maned("--listen", "127.0.0.1:0", "--data-dir", str(tmp_path / "data"))
    assert second.returncode == 1
    assert "event=start_failed" in second.stderr


def test_a_taken_port_is_refused(start, tmp_path):
    port = start().wait_until_it_listens()
    second = maned("--listen", f"127.0.0.1:{port}", "--data-dir", str(tmp_path / "other"))
    assert second.returncode == 1
    assert f"127.0.0.1:{port}" in second.stderr


def test_it_does_not_listen_off_loopback_without_tls_and_token(tmp_path):
    refused = maned("--listen", "0.0.0.0:0", "--data-dir", str(tmp_path))
    assert refused.returncode == 2
    assert "other machines can reach" in refused.stderr


def test_an_insecure_listener_is_an_explicit_and_loud_choice(start):
    daemon = start("--insecure-non-loopback", listen="0.0.0.0:0")
    assert is_healthy(daemon.wait_until_it_listens())
    assert "level=warning event=insecure_listener" in daemon.log.read_text()


def make_certificate(folder: Path, name: str) -> tuple[str, ...]:
    """Flags with a new self-signed certificate for a name that is not this machine's."""
    cert, key = folder / f"{name}.pem", folder / f"{name}-key.pem"
    subprocess.run(
        [
            *("openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256"),
            *("-nodes", "-days", "1", "-subj", "/CN=mane.example.org"),
            *("-keyout", str(key), "-out", str(cert)),
        ],
        check=True,
        capture_output=True,
    )
    return ("--tls-cert", str(cert), "--tls-key", str(key))


def test_tls_and_token_guard_a_listener_off_loopback(start, tmp_path):
    token, wrong = tmp_path / "token", tmp_path / "wrong"
    token.write_text("correct-horse-battery\n")
    wrong.write_text("correct-horse-batterie\n")
    tls = make_certificate(tmp_path, "own")
    daemon = start(*tls, "--token-file", str(token), listen="0.0.0.0:0")
    port = daemon.wait_until_it_listens()
    assert is_healthy(port, *tls, "--token-file", str(token))
    assert not is_healthy(port, *tls, "--token-file", str(wrong))
    assert not is_healthy(port, *tls)
    assert not is_healthy(port)
    assert "correct-horse" not in daemon.log.read_text()


def test_the_health_check_trusts_only_the_servers_certificate(start, tmp_path):
    tls = make_certificate(tmp_path, "own")
    port = start(*tls).wait_until_it_listens()
    assert is_healthy(port, *tls)
    assert not is_healthy(port, *make_certificate(tmp_path, "other"))


def test_help_teaches_and_the_version_is_told():
    page = maned("--help").stdout
    assert "MANE_LISTEN" in page
    assert "Examples:" in page
    assert maned("--version").stdout.startswith("maned 0.")
