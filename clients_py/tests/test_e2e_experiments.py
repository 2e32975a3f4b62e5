"""Every experiment, quick, on a real daemon: the laws hold, files come out, no groom stays."""

from __future__ import annotations

import csv
import json

import numpy as np
import pytest
from PIL import Image

from mane.experiments import curly_clump, shoulders
from mane.experiments.report import Report
from test_cli import run

# What is asserted is asserted by number here, so that no bound can be loosened unseen.
LAWS = {
    "curly-clump": {
        "where friction rules, the swing is as 1 / gamma: 1e-8 to 1e-7": (9.7, 10.3),
        "swing at twice the time step, relative change": (0, 0.01),
    },
    "pendulum": {
        "decay at nu = 5e-06, step -> 0": (0.2424, 0.2473),
        "decay at nu = 5e-05, step -> 0": (2.424, 2.473),
        "decay without drag, step -> 0": (0, 0.002),
    },
    "buckling": {
        "N = 10: critical length / (EI / rho S g)^(1/3)": (1.9842, 1.9886),
        "N = 20: critical length / (EI / rho S g)^(1/3)": (1.9858, 1.9870),
        "shaken upright: largest error of a growth rate": (0, 0.1),
    },
    "head-shake": {"smooth: longest guide at any time over its length": (0.99, 1.00001)},
    "cantilever": {
        "N = 5: largest tip error / L": (0, 0.06),
        "N = 10: largest tip error / L": (0, 0.02),
        "N = 20: largest tip error / L": (0, 0.0055),
    },
    "bend-twist": {
        "N = 10: critical load, largest relative error": (0, 0.015),
        "N = 20: critical load, largest relative error": (0, 0.00375),
        "N = 10: largest tip error / L, away from the border": (0, 0.01),
        "N = 20: largest tip error / L, away from the border": (0, 0.0025),
    },
    "fabrics": {
        "wool: friction over the cosine law's, largest error": (0, 0.02),
        "wool: friction against the scales over that along them": (1.60, 1.66),
        "silk: friction against the scales over that along them": (1.13, 1.17),
        "largest error of a deflection": (0, 0.5),
    },
    "stick-slip": {
        "mu = 0.1: angle at which it slides": (5.425, 5.997),
        "mu = 0.4: angle at which it slides": (20.71, 22.89),
        "mu = 1: angle at which it slides": (42.75, 47.25),
        "creep at 0.9 of the angle of friction [m/s]": (0, 5e-7),
    },
    "wisps-collide": {
        "swing, let go of a wind of 1.5 m/s: largest change of the sum of momenta by the impact": (
            (0, 0.05)
        ),
        "swing, let go of a wind of 1.5 m/s: smallest distance over the sum of radii": (0.5, 1.1),
        "crossed at 1 m/s: smallest distance over the sum of radii": (0.3, 1.1),
        "caught at 1 m/s: smallest distance over the sum of radii": (0.3, 1.1),
        "caught at 3.5 m/s: smallest distance over the sum of radii": (0.3, 1.5),
    },
    "cohesion": {"curly: spread of the tips with wisps over without": (0.1, 0.7)},
    "gust": {
        "polar: nodes off the recurrences over the length": (0, 1e-3),
        "across: nodes off the recurrences over the length": (0, 1e-5),
        "polar: part of tip segments that still rise in frame 20": (0.8, 1),
        "polar: part of root segments that still rise in frame 20": (0, 0.3),
        "polar: inflections of a hair, frame 20": (0.8, 1.2),
    },
    "bangs": {
        "the field as it is: nodes inside at most, of all": (250, 500),
        "pseudo-force: nodes inside until frame 10": (0, 0),
        "nodes turned out: nodes inside at any time": (0, 0),
        "pseudo-force: nodes off the recurrences over the length": (0, 1e-5),
    },
    "flutter": {
        "sigma = 12 degrees: largest turn of a joint": (11, 12.01),
        "mean turn of joints, free over limited": (1.3, 3),
        "tips moved by fluctuation, limited over free": (1.3, 10),
    },
    "beams": {
        "smooth, free, stop: most that a beam's segment is stretched by": (0, 1e-4),
        "curly: beams' nodes off the rods' rest shape": (0, 0.5),
        "wavy: motion in the frame of a change to beam, over that before": (0, 1.5),
        "wavy: motion in the frame of a change to Super-Helix, over that before": (0, 1.5),
        "wavy, free, stop, Super-Helix: half period [s]": (0.2, 0.35),
        "wavy, free, stop, beam: half period [s]": (0.2, 0.35),
    },
}  # fmt: skip


@pytest.mark.parametrize("name", LAWS)
def test_laws_hold(name, maned, client, tmp_path):
    said = run("experiment", name, "--quick", "--out", str(tmp_path), server=maned.address)
    found = json.loads((tmp_path / f"{name}.json").read_text())
    assert found["holds"] and all(fact["holds"] for fact in found["facts"])
    for law, (low, high) in LAWS[name].items():
        assert low <= found["values"][law] <= high, law
        assert law in said or law not in {fact["what"] for fact in found["facts"]}
    pictures = list(tmp_path.glob(f"{name}-*.png"))
    assert pictures
    for picture in pictures:
        assert str(picture) in said
        with Image.open(picture) as image:
            assert len(np.unique(np.asarray(image.convert("RGB")).reshape(-1, 3), axis=0)) > 50
    for path in tmp_path.glob("*.csv"):
        with open(path, newline="") as file:
            rows = np.array(list(csv.reader(file))[1:], dtype=float)
        assert len(rows) > 1 and np.isfinite(rows).all(), path
    assert not [g for g in client.list_grooms() if g.display_name.startswith("mane")]


def test_hair_lies_on_the_shoulders_of_a_walker(client, tmp_path):
    report = Report("shoulders", tmp_path)
    shoulders.run(client, report, quick=True)
    found = report.values
    name = "wavy 45 cm"
    # Not in torso and shoulders; in ears, which are thinner than hair is sampled, somewhat.
    for what, limit in (
        ("stands: deepest point, limit 1 mm", 1),
        ("walks: deepest point, limit 3 mm", 3),
    ):
        assert -3 < found[f"{name}, {what}, in torso [mm]"] < limit, what
        assert found[f"{name}, {what}, in head [mm]"] < 3, what
        assert found[f"{name}, {what}, part of all points that are deeper"] < 1e-3, what
    assert found[f"{name}: fastest tip after 5 s of standing"] < 1
    with Image.open(tmp_path / "shoulders-wavy-45-cm.png") as image:
        assert len(np.unique(np.asarray(image.convert("RGB")).reshape(-1, 3), axis=0)) > 1000
    assert not [g for g in client.list_grooms() if g.display_name.startswith("mane")]


def test_same_server_same_numbers(maned, tmp_path):
    for folder in ("one", "two"):
        run("experiment", "curly-clump", "--quick", "--out", str(tmp_path / folder),
            server=maned.address)  # fmt: skip
    first, second = (tmp_path / each / "curly-clump-span.csv" for each in ("one", "two"))
    assert first.read_bytes() == second.read_bytes()


def test_disagreement_ends_with_1(maned, client, tmp_path, monkeypatch):
    # As if the clump's friction were none of the server's business.
    guide = curly_clump.clump(1e-10)
    monkeypatch.setattr(curly_clump, "clump", lambda friction: guide)
    report = Report("curly-clump", tmp_path)
    curly_clump.run(client, report, quick=True)
    assert not report.holds
