"""The head that the package ships."""

import importlib.util
from importlib import resources
from pathlib import Path

import numpy as np
import pytest
import trimesh

from mane.mesh import hair_region, load_obj, mannequin

TOOL = Path(__file__).parents[1] / "tools" / "make_mannequin.py"


@pytest.fixture(scope="module")
def head():
    return mannequin()


def test_it_is_a_closed_surface_wound_outward(head):
    solid = trimesh.Trimesh(head.vertices, head.triangles, process=False)
    assert solid.is_watertight
    assert solid.is_winding_consistent
    assert solid.body_count == 1
    assert solid.volume > 0
    assert solid.area_faces.min() > 1e-9


def test_it_has_the_size_of_a_head_with_shoulders(head):
    x, y, z = head.vertices.T
    above_neck = y > -0.05
    assert 3000 <= len(head.vertices) <= 8000
    assert 0.13 < y.max() < 0.16
    assert 0.15 < np.ptp(x[above_neck]) < 0.19  # With the ears.
    assert 0.14 < np.ptp(x[y > 0.07]) < 0.16  # The skull.
    assert 0.18 < np.ptp(z[above_neck]) < 0.24
    assert 0.35 < np.ptp(x) < 0.45
    assert z[above_neck].max() > -z[above_neck].min()  # The nose is in front.


def test_its_two_sides_mirror_each_other(head):
    """Every vertex, mirrored, is within 2 mm of the surface's nearest vertices' plane."""
    mirrored = trimesh.Trimesh(head.vertices * (-1, 1, 1), head.triangles[:, ::-1], process=False)
    rng = np.random.default_rng(4)
    some = rng.choice(len(head.vertices), 400, replace=False)
    _, distance, _ = trimesh.proximity.closest_point_naive(mirrored, head.vertices[some])
    assert distance.max() < 2e-3


def test_its_hair_region_is_that_of_the_hairline(head):
    np.testing.assert_array_equal(np.sort(head.hair_triangles), hair_region(head))
    centers = head.vertices[head.triangles].mean(axis=1)
    hair = centers[head.hair_triangles]
    assert not ((hair[:, 2] > 0.05) & (hair[:, 1] < 0.03)).any()  # No beard.
    assert hair[:, 1].min() > -0.06  # None on the neck.
    assert np.abs(hair[:, 0]).max() < 0.078  # None on the ears.
    region = trimesh.Trimesh(head.vertices, head.triangles[head.hair_triangles], process=False)
    region.remove_unreferenced_vertices()
    assert region.body_count == 1
    assert 0.04 < region.area < 0.07


def test_the_file_is_small():
    assert (resources.files("mane") / "data" / "mannequin.obj").stat().st_size < 1e6


def test_the_script_makes_the_shipped_file(head, tmp_path, monkeypatch):
    pytest.importorskip("fast_simplification", reason="tools/make_mannequin.py needs it")
    pytest.importorskip("skimage", reason="tools/make_mannequin.py needs it")
    spec = importlib.util.spec_from_file_location("make_mannequin", TOOL)
    tool = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(tool)
    monkeypatch.setattr("sys.argv", ["make_mannequin.py", "--out", str(tmp_path / "again.obj")])
    tool.main()
    again = load_obj(tmp_path / "again.obj")
    np.testing.assert_array_equal(again.triangles, head.triangles)
    np.testing.assert_allclose(again.vertices, head.vertices, atol=2e-6)
    np.testing.assert_array_equal(again.hair_triangles, head.hair_triangles)
