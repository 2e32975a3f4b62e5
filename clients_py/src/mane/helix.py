"""Rebuilds strands from their generalized coordinates.

A SUPER_HELIX guide is a chain of elements of constant twist and curvatures. With the material frame
R (columns n0 along the strand, n1, n2), the coordinates q = element length * (twist, curvature 1,
curvature 2) and 0 <= u <= 1 along an element of length l:

    R(u) = R(0) exp(u [q])                                                                   (1)
    r(u) = r(0) + l R(0) h(q, u)
    h(q, u) = u e0 + u^2 c2(u^2 z) q x e0 + u^3 c3(u^2 z) q x (q x e0),  z = q.q             (2)

exp([q]) = I + c1(z) [q] + c2(z) [q]^2, and the Stumpff functions c1 = sin x / x,
c2 = (1 - cos x) / x^2, c3 = (x - sin x) / x^3 with x = sqrt(z) are smooth through zero. This is the
closed form that integrates [SH06] (1) and (2) over one element.

A WOUND guide is a chain along the axis of a coil, the hair around it. An element has the coil of
its natural strain k (twist, curvature 1, curvature 2): it winds by W = l |k| about its axis, to
which the hair stands at alpha, cos(alpha) = k[0] / |k|. Coordinates x = l (u, b1, b2, xi) twist the
coil, bend its axis, and add strain towards the hair's tangent, which stretches it:

    m = |(W + x0, x3)|,  beta = (m - W, x1, x2)                angles of the axis
    lambda = (cos(alpha) (W + x0) + sin(alpha) x3) / m         its length, over the hair's
    slant = (sin(alpha) (W + x0) - cos(alpha) x3) / m          lambda^2 + slant^2 = 1        (3)

With the axis frame A, at the root R F, the columns of F being a = k / |k|, w = (e0 - cos(alpha) a)
/ sin(alpha) and a x w of the first element, and the phase p, the sum of W before the element:

    A(u) = A(0) exp(u [beta])
    r(u) = r(0) + l A(0) (lambda h(beta, u) + slant Re int_0^u exp(s [beta]) (0, 1, -i)
                          exp(i (p + W s)) ds)                                               (4)

exp(s [beta]) turns by 0 and +-|beta|, so that the integral is a sum of three turnings of rates W
and W +- |beta|, u sinc(rate u / 2) exp(i rate u / 2) each: smooth at any rate.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.spatial.transform import Rotation

from mane.errors import InvalidArgument
from mane.groom import Guide, StrandModel

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
    """The fixed part of a groom's guides: roots, lengths and coils. Immutable and thread-safe.

    Args:
      guides: at least one. InvalidArgument where an element of a WOUND one lacks natural curvature.
    """

    def __init__(self, guides: Sequence[Guide]):
        lengths = [guide.resolved_element_lengths_m() for guide in guides]
        self._counts = np.array([len(row) for row in lengths])
        self._lengths = np.zeros((len(guides), self._counts.max()))  # Padded with zeros, [m].
        for row, values in zip(self._lengths, lengths, strict=True):
            row[: len(values)] = values
        self._roots = np.stack([guide.root_position for guide in guides])
        self._frames = Rotation.from_quat([guide.root_frame for guide in guides]).as_matrix()
        wound = np.array([guide.model == StrandModel.WOUND for guide in guides])
        self._wound = np.flatnonzero(wound)
        self._widths = np.where(wound, 4, 3)
        if self._wound.size:
            self._coils = _Coils([guides[k] for k in self._wound], self._lengths[self._wound])
            self._frames[self._wound] = self._frames[self._wound] @ self._coils.root_frames
        # Which of (guide, element, 4) are coordinates; in the order of the API.
        real = np.arange(self._lengths.shape[1]) < self._counts[:, None]
        self._is_coordinate = real[..., None] & (np.arange(4) < self._widths[:, None, None])

    @property
    def guide_count(self) -> int:
        return len(self._counts)

    @property
    def element_count(self) -> int:
        """Elements of all guides together."""
        return int(self._counts.sum())

    @property
    def coordinate_count(self) -> int:
        """Coordinates of all guides together: 3 an element, 4 of WOUND guides."""
        return int(self._counts @ self._widths)

    def by_guide(self, values: np.ndarray) -> tuple[np.ndarray, ...]:
        """Views of `values`, one a coordinate, guide by guide, as (element, 3 or 4) each."""
        ends = np.cumsum(self._counts * self._widths)
        parts = np.split(np.reshape(values, self.coordinate_count), ends[:-1])
        return tuple(
            part.reshape(-1, width) for part, width in zip(parts, self._widths, strict=True)
        )

    def positions(self, coordinates: np.ndarray, points_per_guide: int) -> np.ndarray:
        """Points at equal arc length, root first, tip last.

        Args:
          coordinates: guide by guide, root first: (element, 3) twist and bends, element length
            times twist and curvatures, of WOUND guides (element, 4) x of (3) [rad]. Any shape that
            holds them in this order.
          points_per_guide: at least 2.

        Returns:
          (guide, point, 3) float64, head frame [m].
        """
        x = np.zeros((*self._lengths.shape, 4))
        x[self._is_coordinate] = np.reshape(coordinates, self.coordinate_count)
        q, turnings = x[..., :3], None
        if self._wound.size:
            q[self._wound], *turnings = self._coils.deform(x[self._wound])
        origins, frames = self._element_roots(q, turnings)
        element, u = self._locate(points_per_guide)
        guide = np.arange(self.guide_count)[:, None]
        along = self._chords(q, turnings, element, u)
        return origins[guide, element] + np.einsum("gpij,gpj->gpi", frames[guide, element], along)

    def _element_roots(self, q: np.ndarray, turnings) -> tuple[np.ndarray, np.ndarray]:
        """Origins (guide, element, 3) and frames (.., 3, 3) at the elements' roots."""
        turns = _exponential(q)
        every = np.broadcast_to(np.arange(q.shape[1]), q.shape[:-1])
        steps = self._chords(q, turnings, every, np.ones(q.shape[:-1]))
        origins, frames = [self._roots], [self._frames]
        for element in range(q.shape[1] - 1):
            origins.append(origins[-1] + np.einsum("gij,gj->gi", frames[-1], steps[:, element]))
            frames.append(frames[-1] @ turns[:, element])
        return np.stack(origins, axis=1), np.stack(frames, axis=1)

    def _chords(self, q: np.ndarray, turnings, element: np.ndarray, u: np.ndarray) -> np.ndarray:
        """r(u) - r(0) of (2) and (4) in the elements' root frames, (guide, point, 3) [m]."""
        guide = np.arange(self.guide_count)[:, None]
        chords = _helix(q[guide, element], u)
        if turnings is not None:
            at = np.arange(self._wound.size)[:, None], element[self._wound]
            stretch, rates, amplitudes = (values[at] for values in turnings)
            part = u[self._wound][..., None]
            half = 0.5 * rates * part
            integrals = part * np.sinc(half / np.pi) * np.exp(1j * half)
            chords[self._wound] *= stretch[..., None]
            chords[self._wound] += np.einsum("gpk,gpki->gpi", integrals, amplitudes).real
        return chords * self._lengths[guide, element][..., None]

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


class _Coils:
    """The natural coils of WOUND guides.

    Args:
      guides: the wound ones.
      lengths: of their elements, (guide, element) [m], padded with zeros.
    """

    def __init__(self, guides: Sequence[Guide], lengths: np.ndarray):
        natural = np.zeros((*lengths.shape, 3))
        for index, guide in enumerate(guides):
            strain = guide.resolved_natural()
            if not np.all(np.linalg.norm(strain[:, 1:], axis=1) > 0):
                raise InvalidArgument.of("model", "is wound, but an element has no curvature")
            natural[index, : len(strain)] = strain
        winding = np.linalg.norm(natural, axis=-1)
        padded = winding == 0
        self._rise = natural[..., 0] / np.where(padded, 1, winding)
        self._across = np.linalg.norm(natural[..., 1:], axis=-1) / np.where(padded, 1, winding)
        self._winding = np.where(padded, 1, winding * lengths)  # W; of padding, anything but 0.
        self._phase = np.cumsum(winding * lengths, axis=1) - winding * lengths
        axis = natural[:, 0] / winding[:, :1]
        rise, across = self._rise[:, :1], self._across[:, :1]
        bend = natural[:, 0, 1:] / np.linalg.norm(natural[:, 0, 1:], axis=1, keepdims=True)
        w = np.concatenate([across, -rise * bend], axis=1)  # (e0 - rise axis) / across
        self.root_frames = np.stack([axis, w, np.cross(axis, w)], axis=-1)  # F of each guide.

    def deform(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """(3), and the turnings of (4), at coordinates (guide, element, 4).

        Returns beta (.., 3), lambda (..), and of the turnings rates (.., turning) and complex
        amplitudes (.., turning, 3).
        """
        winding, rise, across = self._winding, self._rise, self._across
        along, xi = winding + x[..., 0], x[..., 3]
        turn = np.hypot(along, xi)
        beta = x[..., :3].copy()
        # m - W without its cancellation.
        beta[..., 0] = (x[..., 0] * (2 * winding + x[..., 0]) + xi**2) / (turn + winding)
        stretch = (rise * along + across * xi) / turn
        slant = (across * along - rise * xi) / turn

        # The parts of v along n = beta / |beta| and across it. They add up to v whatever n is, so
        # that a straight axis may have any.
        v = (slant * np.exp(1j * self._phase))[..., None] * np.array([0, 1, -1j])
        bend = np.linalg.norm(beta, axis=-1)
        n = beta / np.where(bend > 0, bend, 1)[..., None]
        still = n * np.einsum("...i,...i->...", n, v)[..., None]
        turned = 1j * np.cross(n, v)
        amplitudes = np.stack([still, (v - still - turned) / 2, (v - still + turned) / 2], axis=-2)
        return beta, stretch, np.stack([winding, winding + bend, winding - bend], -1), amplitudes


def _exponential(q: np.ndarray) -> np.ndarray:
    """exp([q]) by (1), (..., 3, 3)."""
    z = np.einsum("...i,...i->...", q, q)
    c1, c2, _ = stumpff(z)
    cross = np.zeros((*q.shape, 3))
    cross[..., 2, 1], cross[..., 0, 2], cross[..., 1, 0] = np.moveaxis(q, -1, 0)
    cross -= np.swapaxes(cross, -1, -2)
    return np.eye(3) + c1[..., None, None] * cross + c2[..., None, None] * (cross @ cross)


def _helix(q: np.ndarray, u: np.ndarray) -> np.ndarray:
    """h(q, u) of (2), (..., 3)."""
    z = np.einsum("...i,...i->...", q, q)
    _, c2, c3 = stumpff(u**2 * z)
    e0 = np.array([1.0, 0.0, 0.0])
    once = np.cross(q, e0)
    twice = np.cross(q, once)
    return u[..., None] * e0 + (u**2 * c2)[..., None] * once + (u**3 * c3)[..., None] * twice
