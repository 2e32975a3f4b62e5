"""Hairs that ride on a groom's guides: what is drawn, where guides are what moves.

A control point of a hair is at a part s of its guide's arc length, moved by an offset o in the
guide's carried frame there: h = p(s) + F(s) o. Between the guide's points, at equal arc length, p
is a Catmull-Rom spline and F the normalised mean of the quaternions beside it; beyond its ends the
guide goes on as a parabola. From point to point F follows the guide's direction without turning
about it, from the root frame on. `HairBatch` in `mane/v1/groom.proto` has the formulas. So every
frame's points give every hair, and `assemble` is the inverse of `ride_on` for as many points.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial.transform import Rotation

from mane.errors import InvalidArgument
from mane.groom import Guide

TIP_PART = 65535  # 16 bits of a part of arc length.
LARGEST_OFFSET = 32767  # Units.
LEAST_UNIT_M = 1e-9

_LEAST_LENGTH_M = 1e-12
_LEAST_DIRECTION = 1e-6
_POINTS_AT_A_TIME = 1 << 17  # So that what is between fits into caches.


@dataclass(frozen=True, eq=False)
class Hairs:
    """The hairs of a groom, in flat arrays: points of the first hair, then of the second.

    Attributes:
      guides: the guide that each rides on, not decreasing, (hair,) uint32.
      point_counts: control points of each, 2 to 1000, (hair,) int64.
      parts: of the guide's arc length, of each point, in [0, 1], not decreasing from root to tip,
        (point,) float32. They travel in units of 1/65535.
      offsets: in the carried frame [m], (point, 3) float32: along the guide, then across it.
      colours: sRGB, (hair, 3) uint8; None for none.
      offset_unit_m: in which offsets travel, as 16-bit numbers; 0, the default, takes the least
        that holds the largest offset.

    A hair is a Catmull-Rom spline through its points. The server checks order and ranges; its error
    names the hair.
    """

    guides: ArrayLike
    point_counts: ArrayLike
    parts: ArrayLike
    offsets: ArrayLike
    colours: ArrayLike | None = None
    offset_unit_m: float = 0.0

    def __post_init__(self):
        _set(self, "guides", np.uint32, (-1,))
        _set(self, "point_counts", np.int64, self.guides.shape)
        points = int(self.point_counts.sum())
        _set(self, "parts", np.float32, (points,))
        _set(self, "offsets", np.float32, (points, 3))
        if self.colours is not None:
            _set(self, "colours", np.uint8, (len(self.guides), 3))
        low, high = (float(f(self.offsets, initial=0.0)) for f in (np.min, np.max))
        unit = self.offset_unit_m or max(-low / LARGEST_OFFSET, high / LARGEST_OFFSET, LEAST_UNIT_M)
        if not (unit > 0 and low / unit > -32768.5 and high / unit < 32767.5):
            raise InvalidArgument.of(
                "offsets", f"lie in [{low}, {high}] m; they must be 16-bit numbers of {unit} m"
            )
        object.__setattr__(self, "offset_unit_m", float(unit))

    def __len__(self) -> int:
        return len(self.guides)

    @property
    def first_point(self) -> np.ndarray:
        """Index of each hair's first point, and their number at the end, (hair + 1,) int64."""
        return np.concatenate([[0], np.cumsum(self.point_counts)])


def root_frames(guides: Iterable[Guide], head_orientation: ArrayLike | None = None) -> np.ndarray:
    """Root frames of guides for `assemble`, quaternions (guide, 4).

    Args:
      guides: those of an exported groom.
      head_orientation: of `Frame.head_pose` for positions in the world; None for the head frame.
    """
    frames = Rotation.from_quat([guide.root_frame for guide in guides])
    if head_orientation is not None:
        frames = Rotation.from_quat(head_orientation) * frames
    return frames.as_quat()


def carry_frames(points: ArrayLike, root_frames: ArrayLike) -> np.ndarray:
    """The carried frame at every point of guides, quaternions (guide, point, 4).

    Args:
      points: at equal arc length, root first [m], (guide, point, 3).
      root_frames: in the same axes, quaternions (guide, 4).
    """
    points = np.asarray(points, np.float64)
    frames = np.empty((*points.shape[:2], 4))
    root = np.asarray(root_frames, np.float64)
    frames[:, 0] = root / np.linalg.norm(root, axis=1, keepdims=True)
    before = _rotate(frames[:, 0], np.array([1.0, 0.0, 0.0]))
    chords, chord_lengths = _directions(np.diff(points, axis=1))
    tangents, tangent_lengths = _directions(_tangents(points))
    for k in range(1, points.shape[1]):
        a, now = chords[:, k - 1], tangents[:, k]
        v = now - before + 2 * np.sum(a * before, axis=1, keepdims=True) * a
        b, length = _directions(v)
        turn = np.concatenate([np.cross(a, b), np.sum(a * b, axis=1, keepdims=True)], axis=1)
        turn = np.where(turn[:, 3:] < 0, -turn, turn)
        moves = (chord_lengths[:, k - 1] >= _LEAST_LENGTH_M) & (length >= _LEAST_DIRECTION)
        moves &= tangent_lengths[:, k] >= _LEAST_LENGTH_M
        turn = np.where(moves, turn, np.array([0.0, 0.0, 0.0, 1.0]))
        frames[:, k] = _normalised(_product(turn, frames[:, k - 1]))
        before = np.where(moves, now, before)
    return frames


def assemble(points: ArrayLike, root_frames: ArrayLike, hairs: Hairs) -> np.ndarray:
    """Control points of all hairs [m], (point, 3) float32; `hairs.first_point` tells them apart.

    Args:
      points: of the guides, as `Frame.positions`, (guide, point, 3).
      root_frames: in the same axes: `root_frames()`.
      hairs: those of the groom. Their parts and offsets are taken as they are, not rounded.
    """
    guides = _Carried(points, root_frames)
    out = np.empty((len(hairs.parts), 3), np.float32)
    on = np.repeat(hairs.guides, hairs.point_counts)
    for some in _slices(len(out)):
        p, frames = guides.at(on[some], hairs.parts[some])
        out[some] = p + _rotate(frames, hairs.offsets[some].astype(np.float64))
    return out


def ride_on(
    points: ArrayLike,
    root_frames: ArrayLike,
    guides: ArrayLike,
    point_counts: ArrayLike,
    parts: ArrayLike,
    hair_points: ArrayLike,
    colours: ArrayLike | None = None,
) -> Hairs:
    """Hairs that have the control points `hair_points` where guides have `points`.

    Args:
      points: of the guides, (guide, point, 3) [m]: `Client.rest_shape` has them at rest.
      root_frames: in the same axes, (guide, 4).
      guides, point_counts, parts, colours: as in `Hairs`. Parts are rounded as they travel, and
        offsets found there, so that nothing is lost by that.
      hair_points: (point, 3) [m].
    """
    rounded = np.rint(np.asarray(parts, np.float64) * TIP_PART) / TIP_PART
    counts = np.asarray(point_counts)
    carried, on = _Carried(points, root_frames), np.repeat(guides, counts)
    hair_points = np.asarray(hair_points)
    offsets = np.empty((len(on), 3), np.float32)
    for some in _slices(len(offsets)):
        p, frames = carried.at(on[some], rounded[some])
        frames[:, :3] *= -1
        offsets[some] = _rotate(frames, np.asarray(hair_points[some], np.float64) - p)
    return Hairs(guides, counts, rounded, offsets, colours)


class _Carried:
    """Guides as hairs see them: cubics between neighbouring points, and frames at points."""

    def __init__(self, points: ArrayLike, root_frames: ArrayLike):
        points = np.asarray(points, np.float64)
        self._frames = carry_frames(points, root_frames)
        chord, m = np.diff(points, axis=1), _tangents(points)
        m0, m1 = m[:, :-1], m[:, 1:]
        cubics = [points[:, :-1], m0, 3 * chord - 2 * m0 - m1, m0 + m1 - 2 * chord]
        self._cubics = np.stack(cubics, axis=2)

    def at(self, guides: np.ndarray, parts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Points of the spline (k, 3) and carried frames (k, 4) at parts (k,) of guides (k,)."""
        x = parts.astype(np.float64) * (self._frames.shape[1] - 1)
        j = np.clip(x.astype(np.int64), 0, self._frames.shape[1] - 2)
        u = (x - j)[:, None]
        cubic = self._cubics[guides, j]
        p = cubic[:, 0] + u * (cubic[:, 1] + u * (cubic[:, 2] + u * cubic[:, 3]))
        mixed = (1 - u) * self._frames[guides, j] + u * self._frames[guides, j + 1]
        return p, _normalised(mixed)


def _slices(count: int) -> Iterator[slice]:
    return (slice(k, k + _POINTS_AT_A_TIME) for k in range(0, count, _POINTS_AT_A_TIME))


def _set(hairs: Hairs, name: str, dtype, shape: tuple[int, ...]) -> None:
    values = np.asarray(getattr(hairs, name), dtype)
    expected = values.shape[:1] if shape == (-1,) else shape
    if values.shape != expected:
        raise InvalidArgument.of(name, f"has shape {values.shape}, must be {expected}")
    object.__setattr__(hairs, name, values)


def _tangents(points: np.ndarray) -> np.ndarray:
    """Of the Catmull-Rom spline at every point, (guide, point, 3) [m]."""

    def beyond(a, b, c):
        return 2 * a - b if c is None else 3 * (a - b) + c

    inner = points.shape[1] > 2
    low = beyond(points[:, 0], points[:, 1], points[:, 2] if inner else None)
    high = beyond(points[:, -1], points[:, -2], points[:, -3] if inner else None)
    longer = np.concatenate([low[:, None], points, high[:, None]], axis=1)
    return (longer[:, 2:] - longer[:, :-2]) / 2


def _directions(v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Unit vectors, or zeros, and lengths (..., 1)."""
    lengths = np.linalg.norm(v, axis=-1, keepdims=True)
    return v / np.where(lengths > 0, lengths, 1), lengths


def _normalised(q: np.ndarray) -> np.ndarray:
    return q / np.linalg.norm(q, axis=-1, keepdims=True)


def _product(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Quaternions: `b`, then `a`."""
    va, wa, vb, wb = a[:, :3], a[:, 3:], b[:, :3], b[:, 3:]
    w = wa * wb - np.sum(va * vb, axis=1, keepdims=True)
    return np.concatenate([wa * vb + wb * va + np.cross(va, vb), w], axis=1)


def _rotate(q: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Vectors (k, 3) or (3,) turned by unit quaternions (k, 4)."""
    once = 2 * np.cross(q[:, :3], v)
    return v + q[:, 3:] * once + np.cross(q[:, :3], once)
