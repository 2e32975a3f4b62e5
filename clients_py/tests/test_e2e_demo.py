"""The demo against a real daemon: pictures and videos come out, and no groom stays behind."""

import subprocess
import sys

import imageio_ffmpeg
import numpy as np
import pytest
from PIL import Image

from mane import clips, mesh
from mane.demo import KINDS, Hair, animate, load_motion
from mane.errors import InvalidArgument
from mane.groom import GuideGeneration, StrandModel

QUICK = ("--guides", "12", "--size", "64", "--seconds", "0.1")


def run_demo(server, *options):
    command = [sys.executable, "-m", "mane.demo", "--server", server, *map(str, options)]
    return subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)


def test_a_picture_and_a_video_of_every_hair_type(maned, client, tmp_path):
    done = run_demo(maned.address, "--out", tmp_path, "--hair", "all", *QUICK)
    assert done.returncode == 0, done.stderr
    for hair in ("smooth", "wavy", "curly", "fuzzy"):
        picture, video = (tmp_path / f"mannequin-shake-{hair}.{e}" for e in ("png", "mp4"))
        assert str(picture) in done.stdout
        assert str(video) in done.stdout
        with Image.open(picture) as sheet:
            assert sheet.size == (5 * 64, 2 * 64)
        reader = imageio_ffmpeg.read_frames(str(video))
        assert next(reader)["source_size"] == (2 * 64, 64)
        assert sum(1 for _ in reader) == 7
    assert not [g for g in client.list_grooms() if g.display_name == "mane.demo"]


def test_a_head_and_a_motion_of_ones_own(maned, tmp_path):
    head = mesh.mannequin()
    mesh.save_obj(tmp_path / "mine.obj", mesh.Mesh(head.vertices * 10, head.triangles))
    (tmp_path / "still.csv").write_text(
        "time_s,x,y,z,qx,qy,qz,qw\n0,1,2,3,0,0,0,1\n0.05,1,2,3,0,0,0,1\n"
    )
    done = run_demo(
        maned.address, "--out", tmp_path / "new" / "folder", "--no-video", "--unit", 0.1,
        "--head", tmp_path / "mine.obj", "--group", "skin", "--motion", tmp_path / "still.csv",
        *QUICK,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    (only,) = (tmp_path / "new" / "folder").iterdir()
    assert only.name == "mine-still-wavy.png"


def test_fuzzy_guides_are_all_wound(client):
    kind = KINDS[Hair.FUZZY]
    generate = GuideGeneration(
        kind.hair_type, 120, 0.25, seed=1, curl_variation=kind.curl_variation
    )
    groom = client.create_groom(scalp=mesh.mannequin(), generate=generate)
    models = {guide.model for guide in client.export_groom(groom).guides}
    client.delete_groom(groom)
    assert models == {StrandModel.WOUND}


def test_hair_grows_on_the_hair_region_and_follows_the_head(client):
    head, motion = mesh.mannequin(), clips.load("turn")
    generate = GuideGeneration("caucasian_wavy", 20, 0.2, seed=3)
    positions = animate(client, head, generate, motion, 8, 1, "test")
    assert positions.shape == (len(motion), 20, 8, 3)
    centers = head.vertices[head.triangles[head.hair_triangles]].mean(axis=1)
    for index in (0, 60):  # Upright, and turned by 90 degrees to the left.
        x, y, z = positions[index, :, 0].T
        roots = np.stack([x, y, z] if index == 0 else [-z, y, x], 1)
        gap = np.linalg.norm(roots[:, None] - centers[None], axis=2).min(axis=1)
        assert gap.max() < 0.012
    assert not [g for g in client.list_grooms() if g.display_name == "mane.demo"]


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (("--motion", "dance"), "must be a .bvh or .csv file or one of nod"),
        (("--length", "-1"), "length"),
        (("--size", "100"), "multiple of 16"),
    ],
)
def test_bad_options_are_said_in_one_line(maned, tmp_path, options, says):
    done = run_demo(maned.address, "--out", tmp_path, *options)
    assert done.returncode == 1
    assert says in done.stderr
    assert "Traceback" not in done.stderr
    assert len(done.stderr.strip().splitlines()) == 1


def test_motions_are_60_poses_a_second_and_as_long_as_asked():
    whole, part = load_motion("nod"), load_motion("nod", seconds=1.5)
    np.testing.assert_allclose(np.diff(part.times_s), 1 / 60, atol=1e-8)
    assert part.duration_s == pytest.approx(1.5)
    np.testing.assert_array_equal(part.orientations, whole.orientations[: len(part)])
    with pytest.raises(InvalidArgument, match="dance"):
        load_motion("dance")
