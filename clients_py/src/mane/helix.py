"""Rebuilds Super-Helices from their generalized coordinates.

A guide is a chain of elements of constant twist and curvatures. With the material frame R (columns
n0 along the strand, n1, n2), the element angles q = element length * (twist, curvature 1, curvature
2) and 0 <= u <= 1 along an element of length l:

    R(u) = R(0) exp(u [q])                                                                   (1)
    r(u) = r(0) + l R(0) (u e0 + u^2 c2(u^2 z) q x e0 + u^3 c3(u^2 z) q x (q x e0)),  z = q.q  (2)

exp([q]) = I + c1(z) [q] + c2(z) [q]^2, and the Stumpff functions c1 = sin x / x,
c2 = (1 - cos x) / x^2, c3 = (x - sin x) / x^3 with x = sqrt(z) are smooth through zero. This is the
closed form that integrates [SH06] (1) and (2) over one element.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.spatial.transform import Rotation

from mane.groom import Guide

_SERIES_BELOW = 0.5  # Angle [rad] under which x - sin x loses digits; seven terms reach 1e-17.


def stumpff(z: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """c1, c2 and c3 at squared angles `z` >= 0 [rad^2], to round-off, zero included."""
    x = np.sqrt(z)
    c1 = np.sinc(x / np.pi)
    c2 = 0.5 * np.sinc(x / (2 * np.pi)) ** 2
    small = x < _SERIES_BELOW
    safe = np.where(small, 1.0, x)
    series = np.zeros_like(z)
    for k in range(6, -1, -1):  # sum of (-z)^k / (2k + 3)!, nested.
        series = 1 - z / ((2 * k + 4) * (2 * k + 5)) * series
    return c1, c2, np.where(small, series / 6, (safe - np.sin(safe)) / safe**3)


class Strands:
    """The fixed part of a groom's guides: roots and element lengths. Immutable and thread-safe.

    Args:
      guides: at least one.
    """

    def __init__(self, guides: Sequence[Guide]):
        lengths = [guide.resolved_element_lengths_m() for guide in guides]
        self._counts = np.array([len(row) for row in lengths])
        self._lengths = np.zeros((len(guides), self._counts.max()))  # Padded with zeros, [m].
        for row, values in zip(self._lengths, lengths, strict=True):
            row[: len(values)] = values
        self._roots = np.stack([guide.root_position for guide in guides])
        self._frames = Rotation.from_quat([guide.root_frame for guide in guides]).as_matrix()

    @property
    def guide_count(self) -> int:
        return len(self._counts)

    @property
    def element_count(self) -> int:
        """Elements of all guides together."""
        return int(self._counts.sum())

    def positions(self, angles: np.ndarray, points_per_guide: int) -> np.ndarray:
        """Points at equal arc length, root first, tip last.

        Args:
          angles: (element of all guides, 3) twist and bends [rad]: element length times twist and
            curvatures.
          points_per_guide: at least 2.

        Returns:
          (guide, point, 3) float64, head frame [m].
        """
        q = np.zeros((*self._lengths.shape, 3))
        q[np.arange(q.shape[1]) < self._counts[:, None]] = angles
        origins, frames = self._element_roots(q)
        element, u = self._locate(points_per_guide)
        guide = np.arange(self.guide_count)[:, None]
        along = _offset(q[guide, element], u) * self._lengths[guide, element][..., None]
        return origins[guide, element] + np.einsum("gpij,gpj->gpi", frames[guide, element], along)

    def _element_roots(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Origins (guide, element, 3) and material frames (.., 3, 3) at the elements' roots."""
        turns = _exponential(q)
        steps = _offset(q, np.ones(q.shape[:-1])) * self._lengths[..., None]
        origins, frames = [self._roots], [self._frames]
        for element in range(q.shape[1] - 1):
            origins.append(origins[-1] + np.einsum("gij,gj->gi", frames[-1], steps[:, element]))
            frames.append(frames[-1] @ turns[:, element])
        return np.stack(origins, axis=1), np.stack(frames, axis=1)

    def _locate(self, points: int) -> tuple[np.ndarray, np.ndarray]:
        """Element (guide, point) that holds each point, and where in it, 0 to 1."""
        ends = np.cumsum(self._lengths, axis=1)
        arc = np.linspace(0.0, 1.0, points) * ends[:, -1:]
        passed = (ends[:, None, :] <= arc[..., None]).sum(axis=-1)
        element = np.minimum(passed, self._counts[:, None] - 1)
        guide = np.arange(len(ends))[:, None]
        length = self._lengths[guide, element]
        begin = ends[guide, element] - length
        return element, np.clip((arc - begin) / length, 0.0, 1.0)


def _exponential(q: np.ndarray) -> np.ndarray:
    """exp([q]) by (1), (..., 3, 3)."""
    z = np.einsum("...i,...i->...", q, q)
    c1, c2, _ = stumpff(z)
    cross = np.zeros((*q.shape, 3))
    cross[..., 2, 1], cross[..., 0, 2], cross[..., 1, 0] = np.moveaxis(q, -1, 0)
    cross -= np.swapaxes(cross, -1, -2)
    return np.eye(3) + c1[..., None, None] * cross + c2[..., None, None] * (cross @ cross)


def _offset(q: np.ndarray, u: np.ndarray) -> np.ndarray:
    """r(u) - r(0) of (2) in the element's root frame, over the element's length, (..., 3)."""
    z = np.einsum("...i,...i->...", q, q)
    _, c2, c3 = stumpff(u**2 * z)
    e0 = np.array([1.0, 0.0, 0.0])
    once = np.cross(q, e0)
    twice = np.cross(q, once)
    return u[..., None] * e0 + (u**2 * c2)[..., None] * once + (u**3 * c3)[..., None] * twice
