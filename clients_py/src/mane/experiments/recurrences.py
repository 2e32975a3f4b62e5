"""The recurrences of [AUK92] (4)' and (5)', in double precision: what segments do in a field.

Directions are e = (sin t sin f, cos t, sin t cos f), t the zenith and f the azimuth about Y from +Z
toward +X. Segments of a hair know nothing of each other, but for where they are by the head.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

_AXIS = 1e-4  # Of |sin t|: nearer to Y, the plane of t is that of Y and the field.


@dataclass(frozen=True)
class PseudoForce:
    """Where the field presses on an ellipsoid about the origin nearby, it counts `epsilon` times
    ([AUK92] 3.2.2)."""

    radii_m: np.ndarray
    alpha: float
    near_m: float
    epsilon: float

    def at(self, ends: np.ndarray, F: np.ndarray) -> np.ndarray:
        """The field of segments that end there, (..., 3)."""
        D = 2 * ends / self.radii_m**2
        size = np.linalg.norm(D, axis=-1)
        near = ((ends / self.radii_m) ** 2).sum(axis=-1) - 1 < self.near_m * size
        pressed = (D @ F) / (size * np.linalg.norm(F)) < self.alpha
        return np.where((near & pressed)[..., None], self.epsilon, 1.0) * F


@dataclass
class Polar:
    """By zenith and azimuth, as published."""

    t: np.ndarray
    f: np.ndarray
    t_step: np.ndarray
    f_step: np.ndarray

    @staticmethod
    def begin(e: np.ndarray) -> Polar:
        t, f = (
            np.arctan2(np.hypot(e[..., 0], e[..., 2]), e[..., 1]),
            np.arctan2(e[..., 0], e[..., 2]),
        )
        return Polar(t, f, 0 * t, 0 * t)

    def step(self, push: np.ndarray, F: np.ndarray) -> np.ndarray:
        level = np.hypot(F[..., 0], F[..., 2])
        axis = (np.abs(np.sin(self.t)) < _AXIS) & (level > _AXIS * np.linalg.norm(F, axis=-1))
        along = np.sin(self.f) * F[..., 0] + np.cos(self.f) * F[..., 2]
        self.t = np.where(axis & (along < 0), -self.t, self.t)
        self.t_step = np.where(axis, along / np.where(axis, level, 1) * self.t_step, self.t_step)
        self.f = np.where(axis, np.arctan2(F[..., 0], F[..., 2]), self.f)
        self.f_step = np.where(axis, 0, self.f_step)

        (st, ct), (sf, cf) = ((np.sin(angle), np.cos(angle)) for angle in (self.t, self.f))
        u, v = np.stack([ct * sf, -st, ct * cf], -1), np.stack([cf, 0 * cf, -sf], -1)
        self.t_step = self.t_step + push * (F * u).sum(axis=-1)
        self.f_step = self.f_step + push * st * (F * v).sum(axis=-1)
        self.t, self.f = self.t + self.t_step, self.f + self.f_step
        st, ct, sf, cf = np.sin(self.t), np.cos(self.t), np.sin(self.f), np.cos(self.f)
        return np.stack([st * sf, ct, st * cf], -1)


@dataclass
class Across:
    """About an axis across the segment, chosen anew every step: the same with sin t = 1."""

    e: np.ndarray
    delta: np.ndarray

    @staticmethod
    def begin(e: np.ndarray) -> Across:
        return Across(e, 0 * e)

    def step(self, push: np.ndarray, F: np.ndarray) -> np.ndarray:
        delta = self.delta + push[..., None] * (F - (F * self.e).sum(-1, keepdims=True) * self.e)
        size = np.linalg.norm(delta, axis=-1, keepdims=True)
        toward, angle = delta / np.where(size > 0, size, 1), 2 * np.arctan(size / 2)
        before, self.e = self.e, np.cos(angle) * self.e + np.sin(angle) * toward
        self.delta = size * (np.cos(angle) * toward - np.sin(angle) * before)
        return self.e


def integrate(
    begin: Callable[[np.ndarray], Polar | Across],
    rest: np.ndarray,
    fields: Sequence,
    push: np.ndarray,
    shelter: PseudoForce | None = None,
) -> np.ndarray:
    """Nodes of hair that stands still at first, (frame + 1, guide, node, 3).

    begin: of the equations. rest: nodes at first. push: dt^2 lambda_i, (segment,).
    """
    steps = np.diff(rest, axis=-2)
    d = np.linalg.norm(steps, axis=-1, keepdims=True)
    state, frames = begin(steps / d), [rest]
    for field in np.asarray(fields, np.float64):
        ends = frames[-1][..., 1:, :]
        F = shelter.at(ends, field) if shelter else np.broadcast_to(field, ends.shape)
        e = state.step(np.broadcast_to(push, ends.shape[:-1]), F)
        frames.append(
            np.concatenate([rest[..., :1, :], rest[..., :1, :] + np.cumsum(d * e, -2)], -2)
        )
    return np.stack(frames)
