"""The command line: help that teaches, exit codes, and a whole session on a real daemon."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import mane
from conftest import make_guide, shake
from mane.motion import write_csv

COMMANDS = [
    "status", "animate", "bake", "groom create", "groom import", "groom report", "groom list",
    "groom show", "groom delete", "style presets", "style show", "style apply", "style map",
    "style picture", "job list", "job show", "job cancel", "experiment curly-clump",
    "experiment pendulum", "experiment buckling", "experiment head-shake",
    "experiment cantilever", "experiment bend-twist",
]  # fmt: skip


def command(*arguments: str) -> list[str]:
    return [str(Path(sys.executable).with_name("mane")), *arguments]


def run(*arguments: str, server: str | None = None, code: int = 0) -> str:
    """Output of a command that must end with `code`: stdout, or stderr for a failure."""
    environment = os.environ | {"COLUMNS": "100", "TERM": "dumb"}
    environment.pop("MANE_SERVER", None)
    if server:
        environment["MANE_SERVER"] = server
    done = subprocess.run(
        command(*arguments), env=environment, capture_output=True, text=True, timeout=120
    )
    assert done.returncode == code, f"{done.returncode}: {done.stdout}{done.stderr}"
    return done.stdout if code == 0 else done.stderr


@pytest.fixture
def motion_file(tmp_path) -> Path:
    write_csv(tmp_path / "shake.csv", shake(0.5))
    return tmp_path / "shake.csv"


@pytest.mark.parametrize("name", COMMANDS)
def test_help_shows_an_example_of_every_command(name):
    text = run(*name.split(), "--help")
    assert "Usage:" in text and "Examples:" in text
    assert f"mane {name}" in text.split("Examples:")[1]


def test_bare_command_shows_a_first_tour():
    text = run("--help")
    for name in ("mane status", "mane groom create", "mane style apply", "mane animate"):
        assert name in text


@pytest.mark.parametrize(
    "arguments",
    [
        ["fly"],
        ["groom", "create"],
        ["groom", "create", "x", "--hair-type", "bald"],
        ["groom", "create", "x", "--unit", "yard"],
        ["groom", "create", "x", "--body", "hat"],
        ["groom", "create", "x", "--body", "hat=no-such-file.obj"],
        ["groom", "create", "x", "--body-material", "stone"],
        ["groom", "create", "x", "--wisp-radius", "0.2"],
        ["style", "apply", "bob"],
        ["style", "apply", "bob", "-o", "x", "--unit", "yard"],
        ["style", "apply", "bob", "-o", "x", "--scalp", "no-such-file.obj"],
        ["style", "apply", "bob", "-o", "x", "--picture", "/no/such/folder/x.png"],
        ["style", "map", "bob", "colour", "-o", "x.png"],
        ["groom", "import", "no-such-file.npz", "x"],
        ["groom", "import", __file__, "x", "--unit", "yard"],
        ["groom", "import", __file__, "x", "--axes", "inside out"],
        ["groom", "import", __file__, "x", "--elements", "65"],
        ["animate", "no-such-file.bvh", "-g", "x", "-o", "x.npz"],
        ["animate", __file__, "-g", "x", "-o", "/no/such/folder/x.npz"],
        ["animate", __file__, "-g", "x"],
    ],
)
def test_wrong_usage_ends_with_2(arguments):
    assert "Usage:" in run(*arguments, code=2)


def test_a_wisp_radius_is_finite():
    assert "finite" in run("groom", "create", "x", "--wisp-radius", "nan", code=2)


def test_no_server_ends_with_1_and_says_so_in_one_line():
    text = run("status", server="127.0.0.1:1", code=1)
    assert text.startswith("error: no answer from 127.0.0.1:1")
    assert text.count("\n") == 1


def test_a_file_that_is_no_motion_ends_with_1(tmp_path):
    arguments = ["animate", __file__, "-g", "x", "-o", str(tmp_path / "x.npz")]
    text = run(*arguments, server="127.0.0.1:1", code=1)
    assert "must end in .bvh or .csv" in text and text.count("\n") == 1


def test_a_whole_session(maned, motion_file, tmp_path):
    server = maned.address
    assert "serving" in run("status", server=server)
    made = run("groom", "create", "cli-demo", "--guides", "20", "--length", "0.15", server=server)
    assert "grooms/cli-demo: 20 guides" in made
    assert "grooms/cli-demo " in run("groom", "list", server=server)
    shown = run("groom", "show", "cli-demo", server=server)
    assert "caucasian_wavy" in shown and "0.150 m" in shown

    output, picture = tmp_path / "hair.npz", tmp_path / "hair.png"
    run("animate", str(motion_file), "-g", "cli-demo", "-o", str(output),
        "--picture", str(picture), "--rate", "30", "--points", "8", server=server)  # fmt: skip
    with np.load(output) as animated:
        frames = len(animated["times_s"])
        assert animated["positions"].shape == (frames, 20, 8, 3)
        assert animated["head_positions"].shape == (frames, 3)
        assert animated["head_orientations"].shape == (frames, 4)
        assert np.isfinite(animated["positions"]).all()
        positions = animated["positions"]
    with Image.open(picture) as image:
        assert len(np.unique(np.asarray(image).reshape(-1, 3), axis=0)) > 100

    output = tmp_path / "baked.npz"
    run("bake", str(motion_file), "-g", "cli-demo", "-o", str(output), "--rate", "30",
        "--points", "8", server=server)  # fmt: skip
    with np.load(output) as baked:
        np.testing.assert_array_equal(baked["positions"], positions)
    jobs = run("job", "list", server=server)
    name = next(word for word in jobs.split() if word.startswith("jobs/"))
    assert "succeeded" in run("job", "show", name, server=server)
    assert "succeeded" in run("job", "cancel", name, server=server)  # As it is.

    assert "deleted cli-demo" in run("groom", "delete", "cli-demo", server=server)
    text = run("groom", "show", "cli-demo", server=server, code=1)
    assert text.startswith("error: ") and "cli-demo" in text and text.count("\n") == 1


def test_hair_grows_on_an_obj_file(maned, tmp_path):
    obj = tmp_path / "head.obj"
    mane.mesh.save_obj(obj, mane.mesh.mannequin())
    made = run("groom", "create", "cli-obj", "--scalp", str(obj), "--guides", "5",
               server=maned.address)  # fmt: skip
    assert "5 guides" in made
    run("groom", "delete", "cli-obj", server=maned.address)


def test_hair_meets_scalp_and_bodies(maned, tmp_path):
    obj = tmp_path / "bust.obj"
    mane.mesh.save_obj(obj, mane.mesh.mannequin())
    run("groom", "create", "cli-met", "--guides", "5", "--scalp-contact", "--body",
        f"bust={obj}", "--body-material", "wool", "--wisp-radius", "0.01",
        server=maned.address)  # fmt: skip
    shown = run("groom", "show", "cli-met", server=maned.address)
    assert "scalp, bust (mesh of " in shown
    run("groom", "delete", "cli-met", server=maned.address)


def test_strands_are_imported_reported_and_drawn(maned, tmp_path):
    server, picture = maned.address, tmp_path / "strands.png"
    t = np.linspace(0, 1, 300)
    hanging = [np.stack([0.03 * np.sin(k + 2 * t), -0.15 * t, 0 * t], 1) for k in range(6)]
    upright = np.stack([0 * t, 0.3 * t, 0 * t], 1)
    np.savez(tmp_path / "strands.npz", points=100 * np.stack([*hanging, upright]))  # Centimetres.
    told = run("groom", "import", str(tmp_path / "strands.npz"), "cli-strands", "--unit", "cm",
               "--points", "40", "--picture", str(picture), server=server)  # fmt: skip
    assert "grooms/cli-strands: 7 guides" in told and "7, of 280 points" in told
    assert "do not hold" in told and "the worst 1 of 1 strands" in told
    again = run("groom", "report", "cli-strands", server=server)
    assert "7, of 280 points" in again and "the worst 1 of 1 strands" in again
    assert "imported" in run("groom", "show", "cli-strands", server=server)
    with Image.open(picture) as image:
        pixels = np.asarray(image.convert("RGB")).reshape(-1, 3).astype(int)
    orange, dark = (pixels[:, 0] > 200) & (pixels[:, 2] < 120), pixels.sum(axis=1) < 300
    assert orange.sum() > 500 and dark.sum() > 500
    run("groom", "delete", "cli-strands", server=server)
    run("groom", "create", "cli-grown", "--guides", "2", server=server)
    text = run("groom", "report", "cli-grown", server=server, code=1)
    assert "not made from strands" in text and text.count("\n") == 1
    run("groom", "delete", "cli-grown", server=server)


def test_a_file_that_is_no_strands_ends_with_1():
    text = run("groom", "import", __file__, "x", server="127.0.0.1:1", code=1)
    assert "must end in one of .npz" in text and text.count("\n") == 1


def test_an_interrupted_bake_is_cancelled(client, maned, tmp_path):
    groom = client.create_groom([make_guide(element_count=50) for _ in range(100)])
    write_csv(tmp_path / "long.csv", mane.Motion(np.arange(16_000) / 60))
    arguments = ["--server", maned.address, "bake", str(tmp_path / "long.csv"),
                 "-g", groom.name, "-o", str(tmp_path / "x.npz"), "--substeps", "64"]  # fmt: skip
    known = {job.name for job in client.list_jobs()}
    # A suite that was started in the background ignores interrupts, and so would the command.
    process = subprocess.Popen(
        command(*arguments), stderr=subprocess.PIPE, text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )  # fmt: skip
    try:
        deadline = time.monotonic() + 60
        while not (mine := [j for j in client.list_jobs() if j.name not in known]):
            assert process.poll() is None and time.monotonic() < deadline
            time.sleep(0.05)
        for job in client.watch_job(mine[0]):
            if job.state == mane.JobState.RUNNING:
                break
        process.send_signal(signal.SIGINT)
        _, text = process.communicate(timeout=60)
    finally:
        process.kill()
    assert process.returncode != 0 and "cancelled" in text
    last = list(client.watch_job(mine[0]))[-1]
    assert last.state == mane.JobState.CANCELLED
    client.delete_groom(groom)
