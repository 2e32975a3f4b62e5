"""Reading, cutting and placing head meshes, and the choice of the hair region."""

import numpy as np
import pytest
import trimesh

from mane import mesh as meshes
from mane.errors import InvalidArgument
from mane.mesh import Mesh, cut_bust, hair_region, load_head, load_obj, place_head, save_obj

SQUARE = "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\n"


@pytest.fixture
def written(tmp_path):
    def write(text):
        path = tmp_path / "mesh.obj"
        path.write_text(text)
        return path

    return write


def open_edges(mesh):
    """Directed edges without a partner in the other direction."""
    t = mesh.triangles.astype(int)
    edges = np.concatenate([t[:, [0, 1]], t[:, [1, 2]], t[:, [2, 0]]])
    seen = {tuple(e) for e in edges}
    assert len(seen) == len(edges)  # No edge twice in one direction: consistent winding.
    return [e for e in seen if e[::-1] not in seen]


def volume(mesh):
    a, b, c = mesh.vertices.astype(float)[mesh.triangles].transpose(1, 0, 2)
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6


def body(lift=0.0):
    """A closed figure, 1.5 m tall: a column with shoulders, and a head with ears."""
    parts = [
        trimesh.creation.icosphere(4).apply_scale((0.074, 0.115, 0.096)),
        trimesh.creation.icosphere(2).apply_scale((0.01, 0.03, 0.018)),
        trimesh.creation.icosphere(2).apply_scale((0.01, 0.03, 0.018)),
        trimesh.creation.cylinder(0.055, 1.3).apply_transform(
            trimesh.transformations.rotation_matrix(np.pi / 2, (1, 0, 0))
        ),
        trimesh.creation.icosphere(3).apply_scale((0.30, 0.10, 0.09)),
    ]
    for part, y, x in zip(parts, (0, 0, 0, -0.70, -0.25), (0, 0.08, -0.08, 0, 0), strict=True):
        part.apply_translation((x, y + lift, 0))
    whole = trimesh.util.concatenate(parts)
    return Mesh(whole.vertices, whole.faces)


def test_groups_are_chosen_by_name(written):
    text = SQUARE + "g front\nf 1 2 3\ng back\nf 1 3 4\nf 4 3 1\n"
    assert len(load_obj(written(text)).triangles) == 3
    assert len(load_obj(written(text), "front").triangles) == 1
    assert len(load_obj(written(text), "back").triangles) == 2
    assert len(load_obj(written(text), ["back", "front"]).triangles) == 3


def test_polygons_become_triangles_of_the_same_area_and_units_become_metres(written):
    mesh = load_obj(written(SQUARE + "f 1 2 3 4\n"), unit_m=0.1)
    a, b, c = mesh.vertices[mesh.triangles].transpose(1, 0, 2)
    assert np.cross(b - a, c - a).sum(axis=0) / 2 == pytest.approx([0, 0, 0.04], abs=1e-7)


def test_vertices_at_one_place_become_one(written):
    text = SQUARE + "v 0 0 0\nv 2 2 0\nvt 0 0\nvt 1 1\nf 1/1 2/1 3/1\nf 5/2 6/2 4/2\n"
    mesh = load_obj(written(text))
    assert len(mesh.vertices) == 4
    assert len(mesh.triangles) == 2


def test_a_group_named_hair_is_the_hair_region(written):
    mesh = load_obj(written(SQUARE + "g skin\nf 1 2 3\ng hair\nf 1 3 4\n"))
    (grows,) = mesh.hair_triangles
    corners = {tuple(v) for v in mesh.vertices[mesh.triangles[grows]]}
    assert corners == {(0, 0, 0), (2, 2, 0), (0, 2, 0)}


def test_what_is_saved_is_what_is_loaded(tmp_path):
    mesh = meshes.with_hair_region(place_head(body()))
    save_obj(tmp_path / "head.obj", mesh)
    again = load_obj(tmp_path / "head.obj")
    assert len(again.hair_triangles) == len(mesh.hair_triangles)
    for chosen in (lambda m: m.triangles, lambda m: m.triangles[m.hair_triangles]):
        centers = [np.sort(m.vertices[chosen(m)].mean(axis=1), axis=0) for m in (mesh, again)]
        np.testing.assert_allclose(*centers, atol=1e-6)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "mesh.obj"),
        (SQUARE, "mesh.obj"),
        ("v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n", "finite"),
        ("v 0 0 0\nv inf 0 0\nv 0 1 0\nf 1 2 3\n", "finite"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "mesh.obj.*line 4 names vertex 9; there are 3"),
        ("v 0 0 zero\nf 1 1 1\n", "mesh.obj.*line 1 is 'v 0 0 zero', must hold numbers"),
        ("v 0 0\nf 1 1 1\n", "mesh.obj.*line 1 has 2 coordinates, must have 3"),
        ("\x00\x01\x02 this is not a mesh", "mesh.obj.*binary, not text"),
    ],
)
def test_bad_files_are_refused_by_name(written, text, says):
    with pytest.raises(InvalidArgument, match=says):
        load_obj(written(text))


def test_random_bytes_are_refused_by_name_whatever_they_are(tmp_path):
    path = tmp_path / "mesh.obj"
    for seed in range(20):
        path.write_bytes(np.random.default_rng(seed).integers(seed % 2, 256, 3000, np.uint8))
        with pytest.raises(InvalidArgument, match="mesh.obj") as refused:
            load_obj(path)
        assert "charset" not in str(refused.value)


def test_comments_may_be_of_any_encoding(tmp_path):
    path = tmp_path / "mesh.obj"
    path.write_bytes(b"# Sch\xe4del\n" + (SQUARE + "f 1 2 3\n").encode())
    assert len(load_obj(path).triangles) == 1
    path.write_bytes(b"\xef\xbb\xbf" + (SQUARE + "f 1 2 3\n").encode())
    assert len(load_obj(path).triangles) == 1


def test_an_unknown_group_names_the_known_ones(written):
    with pytest.raises(InvalidArgument, match=r"group: is 'scalp'.*body"):
        load_obj(written(SQUARE + "g body\nf 1 2 3\n"), "scalp")


@pytest.mark.parametrize("unit_m", [0, -1, float("nan"), 1e4])
def test_a_bad_unit_is_refused(written, unit_m):
    with pytest.raises(InvalidArgument, match="unit_m"):
        load_obj(written(SQUARE + "f 1 2 3\n"), unit_m=unit_m)


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"absent\.obj"):
        load_obj(tmp_path / "absent.obj")


@pytest.mark.parametrize(
    ("vertices", "triangles", "hair", "says"),
    [
        ([[0, 0, np.nan]], [], [], r"vertices\[0\]"),
        (np.zeros((3, 3)), [[0, 1, 3]], [], r"triangles\[0\]"),
        (np.zeros((3, 3)), [[0, 1, -1]], [], r"triangles\[0\]"),
        (np.zeros((3, 3)), [[0, 1, 2]], [1], r"hair_triangles\[0\]"),
    ],
)
def test_a_mesh_refuses_bad_numbers(vertices, triangles, hair, says):
    with pytest.raises(InvalidArgument, match=says):
        Mesh(vertices, triangles, hair)


def test_normals_of_a_sphere_are_radial():
    sphere = trimesh.creation.icosphere(4)
    normals = Mesh(sphere.vertices, sphere.faces).vertex_normals()
    np.testing.assert_allclose(normals, sphere.vertices, atol=0.02)


def test_the_head_frame_does_not_depend_on_where_the_file_puts_the_head():
    here, there = place_head(body()), place_head(body(lift=1.5))
    np.testing.assert_allclose(here.vertices, there.vertices, atol=1e-5)


def test_the_pivot_is_between_the_ears_and_below_them():
    mesh = place_head(body())
    ears = mesh.vertices[np.abs(mesh.vertices[:, 0]) > 0.087]
    ears = ears[ears[:, 1] > -0.1]
    assert ears[:, 1].mean() == pytest.approx(meshes.PIVOT_BELOW_EARS_M, abs=2e-3)
    assert mesh.vertices[:, 0].max() == pytest.approx(-mesh.vertices[:, 0].min(), abs=1e-5)


@pytest.mark.parametrize("scale", [10.0, 0.1])
def test_a_mesh_in_another_unit_is_no_head(scale):
    mesh = body()
    with pytest.raises(InvalidArgument, match="unit"):
        place_head(Mesh(mesh.vertices * scale, mesh.triangles))


def test_cutting_a_closed_body_leaves_a_closed_bust_inside_the_limits():
    whole = body()
    assert not open_edges(whole)
    bust = cut_bust(whole, height_m=0.35, half_width_m=0.2)
    assert not open_edges(bust)
    assert whole.is_closed() and bust.is_closed()
    assert not Mesh(whole.vertices, whole.triangles[1:]).is_closed()
    assert not Mesh(
        whole.vertices, np.vstack([whole.triangles[:1, ::-1], whole.triangles[1:]])
    ).is_closed()
    top = whole.vertices[:, 1].max()
    assert bust.vertices[:, 1].min() == pytest.approx(top - 0.35, abs=1e-5)
    assert np.abs(bust.vertices[:, 0]).max() == pytest.approx(0.2, abs=1e-5)
    assert 0 < volume(bust) < volume(whole)


def test_cutting_removes_exactly_what_is_outside():
    """A box cut on three sides is the smaller box."""
    box = trimesh.creation.box((1.0, 1.0, 1.0))
    bust = cut_bust(Mesh(box.vertices, box.faces), height_m=0.4, half_width_m=0.2)
    assert volume(bust) == pytest.approx(0.4 * 0.4 * 1.0, rel=1e-5)


def test_cutting_keeps_the_hair():
    whole = meshes.with_hair_region(place_head(body()))
    bust = cut_bust(whole)
    before = whole.vertices[whole.triangles[whole.hair_triangles]]
    np.testing.assert_array_equal(before, bust.vertices[bust.triangles[bust.hair_triangles]])


def test_a_small_mesh_is_not_cut():
    sphere = trimesh.creation.icosphere(2).apply_scale(0.1)
    mesh = Mesh(sphere.vertices, sphere.faces)
    assert cut_bust(mesh) is mesh


def test_hair_grows_on_the_skull_and_not_on_face_ears_and_neck(tmp_path):
    save_obj(tmp_path / "body.obj", body(lift=1.6))
    mesh = load_head(tmp_path / "body.obj")
    centers = mesh.vertices[mesh.triangles].mean(axis=1)
    hair = centers[hair_region(mesh)]
    assert len(hair) == len(mesh.hair_triangles) > 300
    top = mesh.vertices[:, 1].max()
    crown = centers[:, 1] > top - 0.02
    assert np.isin(np.flatnonzero(crown), mesh.hair_triangles).all()
    face = (hair[:, 2] > 0.04) & (hair[:, 1] < meshes.PIVOT_BELOW_EARS_M)
    ears = np.abs(hair[:, 0]) > 0.077
    neck = hair[:, 1] < -0.07
    assert not (face | ears | neck).any()


def test_the_hair_region_is_the_same_on_both_sides():
    mesh = meshes.with_hair_region(place_head(body()))
    corners = mesh.vertices.astype(float)[mesh.triangles[mesh.hair_triangles]]
    area = np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    left = corners[:, :, 0].mean(axis=1) > 0
    assert area[left].sum() == pytest.approx(area[~left].sum(), rel=0.03)
