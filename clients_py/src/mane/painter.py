"""Draws single moments of animated hair on a head.

Guides are sparse, one or two hundred on a head: for drawing only, mane.wisps thickens each to a
wisp of hairs.

Hair is shaded after Kajiya and Kay: diffuse light goes with the sine of the angle between tangent
and light, the highlight with a power of the sine of the angle between tangent and half vector. How
much light reaches a point falls exponentially with its depth below the outermost hair as seen from
the light. Head and hair go through one z-buffer (mane.raster), so that either hides the other.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike
from scipy.ndimage import gaussian_filter1d
from scipy.spatial.transform import Rotation

from mane.errors import InvalidArgument
from mane.mesh import Mesh
from mane.motion import Motion
from mane.raster import Camera, ZBuffer
from mane.wisps import Wisps

_SKIN = np.array([0.62, 0.43, 0.33])  # Colours are linear, not sRGB.
_CLOTH = np.array([0.30, 0.36, 0.44])  # Of bodies.
_BACKGROUND = np.array([[0.66, 0.69, 0.73], [0.36, 0.39, 0.44]])  # At the top, at the bottom.
_FLOOR_LINE = np.array([0.20, 0.22, 0.26])
_FLOOR_STEP_M = 0.25
_DISTANCE_M = 1.6  # From the camera to what it looks at.
_LOOK_AT = np.array([0, -0.05, 0])  # From the head's pivot, world [m].
_CAMERA_LAG_S = 0.15  # The camera smooths the head's path with a Gaussian of this width.
_SHADOW_CELL_M = 0.006
_SHADOW_CELLS = 1000  # At most, along either side; what is farther away shares the last ones.
_SHADOW_DEPTH_M = 0.025  # Light falls to 1/e this far below the outermost hair.


@dataclass(frozen=True)
class View:
    """Where the camera stands: angles about the head's first heading, [deg].

    azimuth_deg: 0 looks the figure in the face, 90 is on its left, 180 behind it.
    elevation_deg: above the horizon. height_m: what the picture's height shows at the head [m];
    None is as much as head and hair need in all frames.
    """

    azimuth_deg: float
    elevation_deg: float
    height_m: float | None = None


@dataclass(frozen=True)
class Look:
    """How pictures look.

    hair_color: linear RGB, each in [0, 1], (3,), or one for each strand, (guides, 3). hairs: about
    how many are drawn, at least 1; None draws the strands as they are, which then are no guides but
    hairs. tip_part: width of a wisp at its tip relative to the root, in [0, 10]; below 1 it closes,
    above 1 it opens. size: pixels of a picture's side, a multiple of 16.
    """

    hair_color: ArrayLike = (0.13, 0.06, 0.025)
    hairs: int | None = 2400
    tip_part: float = 0.45
    size: int = 480

    def __post_init__(self) -> None:
        if self.hairs is not None and self.hairs < 1:
            raise InvalidArgument.of("hairs", f"is {self.hairs}, must be at least 1")
        if not 0 <= self.tip_part <= 10:
            raise InvalidArgument.of("tip_part", f"is {self.tip_part}, must be in [0, 10]")
        if self.size < 16 or self.size % 16:
            raise InvalidArgument.of("size", f"is {self.size}, must be a multiple of 16")


class Painter:
    """Draws single moments of one groom on one head.

    mesh: the head, or None for hair alone. positions: (frames, guides, points, 3) world [m].
    motion: the head pose of every frame, and those of bodies. bodies: what else is drawn, by the
    names in `motion.bodies`.

    Raises InvalidArgument when the shapes do not fit or a number is not finite.
    """

    def __init__(
        self,
        mesh: Mesh | None,
        positions: np.ndarray,
        motion: Motion,
        look: Look,
        bodies: Mapping[str, Mesh] = MappingProxyType({}),
    ) -> None:
        positions = np.asarray(positions, np.float32)
        if positions.ndim != 4 or positions.shape[3] != 3 or positions.shape[2] < 2:
            raise InvalidArgument.of(
                "positions",
                f"has shape {positions.shape}, must be (frames, guides, points >= 2, 3)",
            )
        if len(positions) != len(motion):
            raise InvalidArgument.of(
                "motion",
                f"has {len(motion)} poses, must have one for each of {len(positions)} frames",
            )
        if not np.isfinite(positions).all():
            raise InvalidArgument.of("positions", "holds a number that is not finite")
        self._mesh, self._positions, self._motion = mesh, positions, motion
        color, strands = np.asarray(look.hair_color, np.float32), positions.shape[1]
        if color.shape not in ((3,), (strands, 3)):
            raise InvalidArgument.of(
                "hair_color", f"has shape {color.shape}, must be (3,) or ({strands}, 3)"
            )
        self._size = look.size
        self._heads = Rotation.from_quat(motion.orientations)
        roots = self._heads[0].inv().apply(positions[0, :, 0] - motion.positions[0])
        self._wisps = Wisps.scatter(mesh, roots, look.hairs) if look.hairs else Wisps.bare(strands)
        self._tip_part = look.tip_part
        self._color = color[self._wisps.guide, None] if color.ndim == 2 else color
        if mesh is not None:
            self._normals = mesh.vertex_normals()
            self._skin = _scalp_colors(mesh, color.reshape(-1, 3).mean(axis=0))
            self._inside = 0.0 if mesh.is_closed() else 0.25  # Brightness, where it can be seen.
        self._bodies = [
            (motion.bodies[name], body, body.vertex_normals()) for name, body in bodies.items()
        ]
        facing = self._heads[0].apply((0, 0, 1))
        self._heading = np.arctan2(facing[0], facing[2])
        rate = (len(motion) - 1) / max(motion.duration_s, 1e-9)
        blur = max(_CAMERA_LAG_S * rate, 0.01)  # Frames; a single one has no rate.
        # Only what departs from the straight way is smoothed, so that the ends are not pulled in.
        way = np.linspace(motion.positions[0], motion.positions[-1], len(motion))
        off = gaussian_filter1d(motion.positions - way, blur, axis=0, mode="nearest")
        self._targets = way + off
        self._height_m = self._needed_height()
        lowest = 0.25 if mesh is None else -float(mesh.vertices[:, 1].min())
        self._floor_y = motion.positions[0, 1] - lowest - 0.03
        for index in range(len(self._bodies)):
            self._floor_y = min(self._floor_y, self._body(index, 0)[0][:, 1].min() - 0.03)

    def frame(self, index: int, view: View) -> np.ndarray:
        """The picture of one frame, uint8 (size, size, 3)."""
        camera = self._camera(index, view)
        fade = np.linspace(0, 1, self._size)[:, None, None]
        canvas = ZBuffer(
            self._size, self._size, camera, (1 - fade) * _BACKGROUND[0] + fade * _BACKGROUND[1]
        )
        canvas.lines(*_floor(camera.target, self._floor_y))
        right, up, back = camera.axes()
        light = _unit(0.55 * back + 0.35 * right + 0.75 * up)
        head = self._heads[index]
        hairs = self._wisps.hairs(self._positions[index], head, self._tip_part)
        shadow = _Shadow(hairs, light)
        if self._mesh is not None:
            points = head.apply(self._mesh.vertices) + self._motion.positions[index]
            normals = head.apply(self._normals)
            canvas.triangles(
                points,
                self._mesh.triangles,
                _skin_light(normals, light, up, shadow, points) * self._skin,
                back=self._inside,
            )
        for k, (_, body, _) in enumerate(self._bodies):
            points, normals = self._body(k, index)
            lit = _skin_light(normals, light, up, shadow, points)
            canvas.triangles(points, body.triangles, lit * _CLOTH)
        canvas.lines(hairs, self._hair_light(hairs, light, camera, shadow))
        return canvas.image()

    def _body(self, body: int, index: int) -> tuple[np.ndarray, np.ndarray]:
        """Vertices and normals of a body in a frame, in the world."""
        track, mesh, normals = self._bodies[body]
        turn = Rotation.from_quat(track.orientations[index])
        return turn.apply(mesh.vertices) + track.positions[index], turn.apply(normals)

    def _camera(self, index: int, view: View) -> Camera:
        azimuth = self._heading + np.radians(view.azimuth_deg)
        elevation = np.radians(view.elevation_deg)
        toward_eye = np.array(
            [
                np.sin(azimuth) * np.cos(elevation),
                np.sin(elevation),
                np.cos(azimuth) * np.cos(elevation),
            ]
        )
        target = self._targets[index] + _LOOK_AT
        return Camera(target + _DISTANCE_M * toward_eye, target, view.height_m or self._height_m)

    def _needed_height(self) -> float:
        """Height [m] of a view that holds the hair about the target, up to 1.6 m."""
        some = slice(None, None, max(1, len(self._positions) // 40))
        away = self._positions[some] - (self._targets[some] + _LOOK_AT)[:, None, None]
        reach = float(np.linalg.norm(away, axis=-1).max())
        return float(np.clip(2.1 * reach, 0.6, 1.6))

    def _hair_light(self, hairs, light, camera: Camera, shadow: _Shadow) -> np.ndarray:
        tangents = _unit(np.gradient(hairs, axis=1))
        light, eye = light.astype(hairs.dtype), np.asarray(camera.eye, hairs.dtype)
        half = _unit(light + _unit(eye - hairs))
        diffuse = _sine(tangents @ light)
        shine = _sine(np.einsum("...i,...i->...", tangents, half)) ** 60
        lit = shadow.light_at(hairs)
        amount = self._wisps.tint[:, None].astype(hairs.dtype) * (0.30 + 0.90 * diffuse * lit)
        return (
            self._color * amount[..., None] + (0.16 + 0.5 * self._color) * (shine * lit)[..., None]
        )


class _Shadow:
    """How deep points lie below the outermost hair, seen along the light."""

    def __init__(self, hairs: np.ndarray, light: np.ndarray) -> None:
        across = _unit(np.cross(light, (0.31, 0.17, 0.93)))
        self._axes = np.stack([across, np.cross(light, across), light]).astype(hairs.dtype)
        place = hairs.reshape(-1, 3) @ self._axes.T
        self._low = place[:, :2].min(axis=0) - 2 * _SHADOW_CELL_M
        high = place[:, :2].max(axis=0)
        cells = np.ceil((high - self._low) / _SHADOW_CELL_M).astype(np.int64) + 3
        self._shape = np.minimum(cells, _SHADOW_CELLS)
        self._top = np.full(self._shape.prod(), -np.inf, hairs.dtype)
        np.maximum.at(self._top, self._cells(place), place[:, 2])

    def light_at(self, points: np.ndarray) -> np.ndarray:
        """Part of the light that reaches points (..., 3): (...), in (0, 1]."""
        place = points @ self._axes.T
        below = np.maximum(self._top[self._cells(place)] - place[..., 2], 0)
        return np.exp(-below / _SHADOW_DEPTH_M)

    def _cells(self, place: np.ndarray) -> np.ndarray:
        """Index of the cell that each place lies in; the nearest where it lies in none."""
        column, row = np.moveaxis((place[..., :2] - self._low) / _SHADOW_CELL_M, -1, 0)
        column = np.clip(column, 0, self._shape[0] - 1).astype(np.int64)
        row = np.clip(row, 0, self._shape[1] - 1).astype(np.int64)
        return column * self._shape[1] + row


def _skin_light(normals, light, up, shadow: _Shadow, points) -> np.ndarray:
    """Brightness (n, 1): soft key light, a little from above, less under hair."""
    key = np.clip(0.75 * (normals @ light) + 0.25, 0, None)
    sky = 0.5 + 0.5 * (normals @ up)
    return (key * (0.35 + 0.65 * shadow.light_at(points)) + 0.22 * sky)[:, None]


def _scalp_colors(mesh: Mesh, hair_color: np.ndarray) -> np.ndarray:
    """Skin, darkened toward the hair's colour where hair grows, so that partings look natural."""
    colors = np.tile(_SKIN, (len(mesh.vertices), 1))
    colors[np.unique(mesh.triangles[mesh.hair_triangles])] = 0.35 * _SKIN + 0.65 * hair_color
    return colors


def _floor(target: np.ndarray, y: float) -> tuple[np.ndarray, np.ndarray]:
    """A grid fixed in the world, below the head: lines (l, p, 3) and colours that fade out."""
    reach, count = 1.5, 61
    ticks = _FLOOR_STEP_M * np.arange(-6, 7)
    middle = np.round(target / _FLOOR_STEP_M) * _FLOOR_STEP_M
    along, across = np.meshgrid(np.linspace(-reach, reach, count), ticks)
    level = np.full_like(along, y)
    lines = np.concatenate(
        [
            np.stack([middle[0] + along, level, middle[2] + across], -1),
            np.stack([middle[0] + across, level, middle[2] + along], -1),
        ]
    )
    near = np.exp(-3 * ((lines - target)[..., [0, 2]] ** 2).sum(axis=-1))[..., None]
    return lines, near * _FLOOR_LINE + (1 - near) * _BACKGROUND.mean(axis=0)


def _unit(v: np.ndarray) -> np.ndarray:
    return v / np.sqrt(np.maximum(np.einsum("...i,...i->...", v, v), 1e-24))[..., None]


def _sine(cosine: np.ndarray) -> np.ndarray:
    return np.sqrt(np.clip(1 - cosine * cosine, 0, 1))
