"""Pictures: the z-buffer against ray casting, the wisps, what sheets and videos show."""

import imageio_ffmpeg
import numpy as np
import pytest
from PIL import Image
from scipy.spatial.transform import Rotation

from mane import mesh as meshes
from mane import picture
from mane.errors import InvalidArgument
from mane.mesh import Mesh
from mane.motion import Motion
from mane.painter import Look, Painter, View
from mane.picture import draw_sheet, write_video
from mane.raster import SUPERSAMPLING, Camera, ZBuffer
from mane.wisps import Wisps

RED, GREEN, BLUE = np.eye(3)
CAMERA = Camera(np.array([0.3, 0.4, 2.0]), np.array([0.0, 0.1, 0.0]), 1.0)
SIZE = 48
FAST = Look(hairs=200, size=96)


def is_color(pixels, color):
    """Pixels that show nothing but `color`, (height, width)."""
    return (pixels == (255 * color).astype(np.uint8)).all(axis=2)


def cast(camera, triangles, size):
    """A ray for every pixel against every triangle of (m, 3, 3): the index of the nearest, or -1,
    and whether an edge or a second triangle is too close to decide."""
    right, up, back = camera.axes()
    distance = np.linalg.norm(camera.eye - camera.target)
    step = camera.view_height_m / size
    middle = (np.arange(size) + 0.5 - size / 2) * step
    rays = middle[None, :, None] * right - middle[:, None, None] * up - distance * back
    nearest, depth = np.full((size, size), -1), np.full((size, size), np.inf)
    unsure = np.zeros((size, size), bool)
    for index, (a, b, c) in enumerate(triangles):
        solved = np.linalg.solve(
            np.stack(np.broadcast_arrays(b - a, c - a, -rays), -1), (camera.eye - a)[:, None]
        )[..., 0]
        edge = np.minimum(solved[..., :2].min(axis=-1), 1 - solved[..., :2].sum(axis=-1))
        far = solved[..., 2]
        unsure |= (np.abs(edge) < 1e-3) | (np.abs(far - depth) < 1e-3)
        hit = (edge > 0) & (far < depth)
        nearest[hit], depth[hit] = index, far[hit]
    return nearest, unsure


def test_triangles_show_what_ray_casting_shows():
    rng = np.random.default_rng(1)
    corners = rng.uniform(-0.45, 0.45, (25, 1, 3)) + rng.uniform(-0.2, 0.2, (25, 3, 3))
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    away = np.einsum("ij,ij->i", normals, CAMERA.eye - corners[:, 0]) < 0
    corners[away] = corners[away][:, ::-1]  # All face the eye.
    colors = np.repeat(np.arange(25)[:, None] * np.full(3, 1 / 30) + 0.1, 3, axis=0)
    canvas = ZBuffer(SIZE, SIZE, CAMERA, np.zeros(3))
    canvas.triangles(corners.reshape(-1, 3), np.arange(75).reshape(-1, 3), colors)
    fine = SIZE * SUPERSAMPLING
    nearest, unsure = cast(CAMERA, corners, fine)
    expected = np.where(nearest < 0, 0, 0.1 + nearest / 30)
    blocks = (SIZE, SUPERSAMPLING, SIZE, SUPERSAMPLING)
    mean = expected.reshape(blocks).mean(axis=(1, 3))
    sure = ~unsure.reshape(blocks).any(axis=(1, 3))
    shown = (canvas.image()[..., 0] / 255.0) ** 2.2
    assert sure.mean() > 0.9
    assert (nearest >= 0).mean() > 0.2
    np.testing.assert_allclose(shown[sure], mean[sure], atol=0.01)


def square(z, half=0.3):
    return np.array([[-half, -half, z], [half, -half, z], [half, half, z], [-half, half, z]])


TWO = np.array([[0, 1, 2], [0, 2, 3]])
FRONT = Camera(np.array([0, 0, 2.0]), np.zeros(3), 1.0)


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
def test_the_nearer_of_two_squares_wins_in_any_order(order):
    canvas = ZBuffer(SIZE, SIZE, FRONT, np.zeros(3))
    for k in order:
        canvas.triangles(square((-0.2, 0.2)[k]), TWO, np.tile((RED, GREEN)[k], (4, 1)))
    assert is_color(canvas.image(), GREEN)[SIZE // 2, SIZE // 2]
    assert not is_color(canvas.image(), RED).any()  # The far one looks smaller.


def test_a_square_covers_its_area_without_gaps():
    canvas = ZBuffer(100, 100, FRONT, np.zeros(3))
    canvas.triangles(square(0.0, half=0.25), TWO, np.tile(BLUE, (4, 1)))
    blue = is_color(canvas.image(), BLUE)
    assert blue.sum() == 50 * 50
    assert blue[25:75, 25:75].all()


def test_colors_go_linearly_over_a_triangle():
    corners = square(0.0, half=0.5)
    canvas = ZBuffer(SIZE, SIZE, FRONT, np.zeros(3))
    canvas.triangles(corners, TWO, np.stack([corners[:, 0] + 0.5] * 3, 1))
    middle = (np.arange(SIZE) + 0.5) / SIZE
    shown = (canvas.image()[SIZE // 2, :, 0] / 255.0) ** 2.2
    np.testing.assert_allclose(shown, middle, atol=0.01)


@pytest.mark.parametrize(("back", "shown"), [(0.0, 0.6), (0.25, 0.25)])
def test_the_inside_of_a_surface_is_dark_or_not_drawn(back, shown):
    canvas = ZBuffer(SIZE, SIZE, FRONT, np.full(3, 0.6))
    canvas.triangles(square(0.0), TWO[:, ::-1], np.ones((4, 3)), back=back)
    middle = (canvas.image()[SIZE // 2, SIZE // 2] / 255.0) ** 2.2
    np.testing.assert_allclose(middle, shown, atol=0.01)


@pytest.mark.parametrize(("z", "visible"), [(-0.1, False), (0.1, True)])
def test_a_line_behind_a_square_is_hidden(z, visible):
    canvas = ZBuffer(SIZE, SIZE, FRONT, np.zeros(3))
    line = np.array([[[-0.2, 0.001, z], [0.2, 0.001, z]]])
    canvas.triangles(square(0.0), TWO, np.tile(GREEN, (4, 1)))
    canvas.lines(line, np.broadcast_to(RED, line.shape))
    red = canvas.image()[..., 0] > 0
    assert red.any() == visible
    if visible:
        assert red.sum() == pytest.approx(0.4 * SIZE, rel=0.15)  # One pixel row, without gaps.


def test_what_is_outside_the_picture_or_behind_the_eye_is_not_drawn():
    canvas = ZBuffer(SIZE, SIZE, FRONT, np.zeros(3))
    away = np.array(
        [[[5.0, 0, 0], [9.0, 1, 0]], [[0, 0, 2.5], [0.1, 0, 2.5]], [[0, 0, 3], [0, 0, 1]]]
    )
    canvas.lines(away, np.ones_like(away))
    canvas.triangles(square(2.5), TWO, np.ones((4, 3)))
    canvas.triangles(square(0.0) + np.array([5, 0, 0]), TWO, np.ones((4, 3)))
    assert not canvas.image().any()


def test_the_target_is_in_the_middle_and_the_height_is_that_of_the_view():
    up = CAMERA.axes()[1]
    points = np.array([CAMERA.target, CAMERA.target + 0.5 * up])
    middle, top = CAMERA.project(points, 640, 480)
    np.testing.assert_allclose(middle[:2], [320, 240], atol=1e-6)
    np.testing.assert_allclose(top[:2], [320, 0], atol=1e-6)


def strands(roots, direction, length=0.2, points=12):
    s = np.linspace(0, length, points)
    return roots[:, None] + s[None, :, None] * np.asarray(direction, float)


@pytest.fixture(scope="module")
def head():
    return meshes.mannequin()


def roots_on(head, count=30, seed=5):
    rng = np.random.default_rng(seed)
    centers = head.vertices[head.triangles[head.hair_triangles]].mean(axis=1)
    return rng.choice(centers, count, replace=False).astype(float)


def test_wisps_hold_the_guides_and_hairs_rooted_on_the_hair_region(head):
    roots = roots_on(head)
    wisps = Wisps.scatter(head, roots, 500, seed=2)
    assert len(wisps.guide) == 530
    np.testing.assert_array_equal(wisps.guide[:30], np.arange(30))
    np.testing.assert_array_equal(wisps.offset[:30], 0)
    planted = roots[wisps.guide] + wisps.offset
    centers = head.vertices[head.triangles[head.hair_triangles]].mean(axis=1)
    gap = np.linalg.norm(planted[30:, None] - centers[None], axis=2).min(axis=1)
    assert gap.max() < 0.012
    distances = np.linalg.norm(planted[30:, None] - roots[None], axis=2)
    np.testing.assert_array_equal(distances.argmin(axis=1), wisps.guide[30:])


def test_hairs_follow_their_guide_and_gather_at_its_tip(head):
    roots = roots_on(head)
    guides = strands(roots, (0, -1, 0))
    wisps = Wisps.scatter(head, roots, 300, seed=2)
    turn = Rotation.from_euler("Y", 90, degrees=True)
    hairs = wisps.hairs(guides, turn, tip_part=0.4)
    assert hairs.shape == (330, 12, 3)
    np.testing.assert_allclose(
        hairs[:, 0] - guides[wisps.guide, 0], turn.apply(wisps.offset), atol=1e-9
    )
    np.testing.assert_allclose(hairs[:30, :, [0, 2]], guides[:, :, [0, 2]], atol=1e-9)
    long = np.argmax(wisps.length)
    tip = guides[wisps.guide, 0] - wisps.length[:, None] * (0, 0.2, 0)
    part = np.linalg.norm(hairs[:, -1] - tip, axis=1)[long] / np.linalg.norm(wisps.offset[long])
    assert part == pytest.approx(1 - 0.6 * wisps.length[long], abs=1e-6)


def test_wisps_without_a_mesh_stay_within_6_mm_of_their_guides():
    wisps = Wisps.scatter(None, np.zeros((10, 3)), 300)
    np.testing.assert_array_equal(np.bincount(wisps.guide), 30)
    assert np.abs(wisps.offset).max() <= 0.006


def moving(count, speed=(0.0, 0.0, 0.0), start=(0.0, 0.0, 0.0)):
    times = np.arange(count) / 60
    return Motion(times, np.asarray(start) + times[:, None] * np.asarray(speed))


def still_hair(head, frames, direction=(0, -1, 0), keep=lambda roots: roots[:, 2] < 1):
    roots = roots_on(head, 60)
    return np.repeat(strands(roots[keep(roots)], direction)[None], frames, axis=0)


def test_hair_behind_the_head_shows_only_from_behind(head):
    """Green hair at the back of the head: the head hides it from a camera in front."""
    behind = still_hair(head, 1, (0, 0, -0.2), lambda r: (r[:, 2] < -0.05) & (r[:, 1] < 0.06))
    look = Look(hair_color=(0, 1, 0), hairs=300, size=192)
    bare = Mesh(head.vertices, head.triangles)  # No hair region: nothing is tinted.
    painter = Painter(bare, behind, moving(1), look)
    green = [
        (p[..., 1] > 1.2 * p[..., 0]).sum()
        for p in (painter.frame(0, View(a, 0)) for a in (0, 180))
    ]
    assert green[0] == 0
    assert green[1] > 50


def test_the_camera_follows_the_head(head):
    """The same hair far away, a whole number of floor squares off, gives the same picture."""
    hair = still_hair(head, 1)
    here = Painter(head, hair, moving(1), FAST).frame(0, View(40, 10))
    far = moving(1, start=(5.0, 0.0, -7.5))
    there = Painter(head, hair + far.positions, far, FAST).frame(0, View(40, 10))
    same = (np.abs(here.astype(int) - there.astype(int)).max(axis=2) <= 3).mean()
    assert same > 0.98  # Round-off moves a few samples over pixel borders.


def test_a_view_turns_with_the_heading(head):
    """A figure that looks along +X, seen in the face, looks like one along +Z, seen in the face."""
    turned = Rotation.from_euler("Y", 90, degrees=True)
    hair = still_hair(head, 1)
    here = Painter(head, hair, moving(1), FAST).frame(0, View(20, 5))
    motion = Motion([0.0], [[0, 0, 0]], turned.as_quat()[None])
    rotated = turned.apply(hair.reshape(-1, 3)).reshape(hair.shape)
    there = Painter(head, rotated, motion, FAST).frame(0, View(20, 5))
    same = (np.abs(here.astype(int) - there.astype(int)).max(axis=2) <= 4).mean()
    assert same > 0.95


def test_a_sheet_has_a_row_for_each_view_and_a_column_for_each_moment(head, tmp_path):
    path = tmp_path / "sheet.png"
    motion = moving(9, speed=(0, 0, 1))
    positions = still_hair(head, 9) + motion.positions[:, None, None]
    draw_sheet(path, head, positions, motion, moments=3, title="still", look=FAST)
    with Image.open(path) as sheet:
        assert sheet.size == (3 * 96, 2 * 96)
        pixels = np.asarray(sheet)
    cells = pixels.reshape(2, 96, 3, 96, 3).transpose(0, 2, 1, 3, 4)
    assert all(cell.std() > 10 for row in cells for cell in row)
    assert np.abs(cells[0, 0].astype(int) - cells[1, 0]).mean() > 5  # Two sides differ.


def test_hair_alone_can_be_drawn(head, tmp_path):
    draw_sheet(tmp_path / "hair.png", None, still_hair(head, 2), moving(2), moments=1, look=FAST)
    with Image.open(tmp_path / "hair.png") as sheet:
        assert (np.asarray(sheet)[:96].min(axis=2) < 80).sum() > 100  # Dark hair.


@pytest.mark.parametrize("workers", [1, 2])
def test_a_video_shows_every_frame_at_the_motions_rate(head, tmp_path, workers, monkeypatch):
    monkeypatch.setattr(picture, "_FRAMES_PER_WORKER", 3)
    path, motion = tmp_path / "clip.mp4", moving(6)
    done = []

    def count(pictures):
        for drawn in pictures:
            done.append(drawn.shape)
            yield drawn

    write_video(path, head, still_hair(head, 6), motion, look=FAST, workers=workers, progress=count)
    reader = imageio_ffmpeg.read_frames(str(path))
    about = next(reader)
    frames = [np.frombuffer(f, np.uint8).reshape(96, 192, 3) for f in reader]
    assert about["fps"] == pytest.approx(60, rel=1e-3)
    assert about["codec"].startswith("h264")
    assert about["source_size"] == (192, 96)
    assert len(frames) == 6
    assert done == [(96, 192, 3)] * 6
    painter = Painter(head, still_hair(head, 6), motion, FAST)
    drawn = painter.frame(0, View(35, 8)).astype(int)
    assert np.abs(frames[0][:, :96] - drawn).mean() < 12  # As drawn, but for the compression.


@pytest.mark.parametrize(
    ("positions", "poses", "says"),
    [
        (np.zeros((2, 3, 4)), 2, "positions: has shape"),
        (np.zeros((2, 3, 1, 3)), 2, "positions: has shape"),
        (np.zeros((2, 3, 4, 3)), 3, "motion: has 3 poses"),
        (np.full((2, 3, 4, 3), np.nan), 2, "positions: holds"),
    ],
)
def test_what_does_not_fit_is_refused(tmp_path, positions, poses, says):
    with pytest.raises(InvalidArgument, match=says):
        draw_sheet(tmp_path / "no.png", None, positions, moving(poses))


def test_a_video_of_one_frame_is_refused(tmp_path):
    with pytest.raises(InvalidArgument, match="at least 2"):
        write_video(tmp_path / "no.mp4", None, np.zeros((1, 3, 4, 3)), moving(1))


@pytest.mark.parametrize("bad", [{"size": 100}, {"size": 0}, {"hairs": 0}, {"tip_part": -1}])
def test_a_bad_look_is_refused(bad):
    with pytest.raises(InvalidArgument, match=next(iter(bad))):
        Look(**bad)
