"""Equilibria of a heavy Kirchhoff rod, solved without Mane: what its rest shapes are held against.

A clamped rod of length 1, bending stiffness 1 in every direction, torsional stiffness C, weight G a
length (the gravito-bending number rho S g L^3 / EI) and natural curvatures kn = (twist, bend 1,
bend 2). With the frame R = (n0, n1, n2), the moment m in its axes, and the direction of weight d in
the world's, moment balance of what lies beyond s reads

    m' = -kappa x m - G (1 - s) e0 x (R^T d),   kappa = kn + m / (C, 1, 1),
    R' = R [kappa],   r' = R e0

with m(1) = 0 at the free tip. Only what the weight's direction is at the tip in the rod's own axes,
R(1)^T d, is unknown: two numbers. So rods are shot from the tip, where the solution that grows
fastest is the wanted one, to the clamp, where R(0)^T d is given. This shares nothing with Mane,
which minimises an energy over helices.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

STEPS = 400
"""Of the fourth-order Runge-Kutta method: tips are off by less than 1e-7 (checked by a test)."""

_FIRST_AXIS = np.array([1.0, 0.0, 0.0])


@dataclass(frozen=True)
class Rod:
    """load: G. curvature: kn, (3,) [rad over L]. torsion: C, 1 / (1 + Poisson's ratio) if round."""

    load: float
    curvature: tuple[float, float, float] = (0.0, 0.0, 0.0)
    torsion: float = 1.0


@dataclass(frozen=True, eq=False)
class Shots:
    """Rods shot from the tip, k of them.

    Attributes:
      weight_at_root: direction of weight in the axes of the root's frame, (k, 3).
      centerlines: from root to tip, in the axes of the root's frame, (k, STEPS + 1, 3).
      energies: elastic plus gravitational, in units of EI / L, (k,).
    """

    weight_at_root: np.ndarray
    centerlines: np.ndarray
    energies: np.ndarray


def shoot(rod: Rod, weight_at_tip: ArrayLike, steps: int = STEPS) -> Shots:
    """Integrates the balance from free tips to the root.

    weight_at_tip: unit vectors, (k, 3): the weight's direction in the axes of the tip's frame.
    """
    weight = np.atleast_2d(np.asarray(weight_at_tip, dtype=np.float64))
    count, h = len(weight), -1.0 / steps
    compliance = 1 / np.array([rod.torsion, 1.0, 1.0])
    m, r = np.zeros((count, 3)), np.zeros((count, 3))
    R = np.broadcast_to(np.eye(3), (count, 3, 3)).copy()  # The world has the tip's axes at first.

    def rates(s, m, R):
        kappa = np.asarray(rod.curvature) + m * compliance
        e = np.einsum("kji,kj->ki", R, weight)
        e0_x_e = np.stack([np.zeros(count), -e[:, 2], e[:, 1]], axis=1)
        return -np.cross(kappa, m) - rod.load * (1 - s) * e0_x_e, _right_cross(R, kappa), R[:, :, 0]

    points, elastic = [r], [np.zeros(count)]
    for step in range(steps):
        s = 1 + step * h
        k1 = rates(s, m, R)
        k2 = rates(s + h / 2, m + h / 2 * k1[0], R + h / 2 * k1[1])
        k3 = rates(s + h / 2, m + h / 2 * k2[0], R + h / 2 * k2[1])
        k4 = rates(s + h, m + h * k3[0], R + h * k3[1])
        m, R, r = (
            x + h / 6 * (a + 2 * b + 2 * c + d)
            for x, a, b, c, d in zip((m, R, r), k1, k2, k3, k4, strict=True)
        )
        points.append(r)
        elastic.append((m**2 * compliance).sum(axis=1) / 2)
    line = np.stack(points[::-1], axis=1)
    line = (line - line[:, :1]) @ R  # (R^T (r - r_0))^T: into the root's axes.
    at_root = np.einsum("kji,kj->ki", R, weight)
    depth = np.einsum("kni,ki->kn", line, at_root)
    energies = np.trapezoid(np.stack(elastic[::-1], axis=1) - rod.load * depth, dx=-h, axis=1)
    return Shots(at_root, line, energies)


def _right_cross(R: np.ndarray, kappa: np.ndarray) -> np.ndarray:
    """R [kappa]: every row of R crossed with kappa."""
    return np.cross(R, kappa[:, None, :])


def hanging(angle: ArrayLike) -> np.ndarray:
    """Weight in the axes of a frame whose n0 points `angle` [rad] away from straight down, about
    its horizontal n2: (k, 3). A horizontal n0 has pi/2. Small angles keep all their digits."""
    angle = np.atleast_1d(np.asarray(angle, dtype=np.float64))
    return np.stack([np.cos(angle), -np.sin(angle), np.zeros_like(angle)], axis=1)


def planar_root_angle(rod: Rod, tip_angle: float, steps: int = STEPS) -> float:
    """The angle of `hanging` at the root, with all its turns, of a rod that only its bend 2 curves
    and whose tip has `tip_angle`. The balance in a plane: m' = G (1 - s) sin(angle)."""
    h, m, angle = -1.0 / steps, 0.0, tip_angle
    k = rod.curvature[2]

    def rates(s, m, angle):
        return rod.load * (1 - s) * math.sin(angle), k + m

    for step in range(steps):
        s = 1 + step * h
        a = rates(s, m, angle)
        b = rates(s + h / 2, m + h / 2 * a[0], angle + h / 2 * a[1])
        c = rates(s + h / 2, m + h / 2 * b[0], angle + h / 2 * b[1])
        d = rates(s + h, m + h * c[0], angle + h * c[1])
        m += h / 6 * (a[0] + 2 * b[0] + 2 * c[0] + d[0])
        angle += h / 6 * (a[1] + 2 * b[1] + 2 * c[1] + d[1])
    return angle


def planar_tip_angle(rod: Rod, root_angle: float, near: float) -> float:
    """The tip's angle of the planar equilibrium of a rod with `root_angle` at its root: the
    solution closest to `near` [rad]. RuntimeError where there is none within 0.5 rad."""
    reach = 1e-9
    while reach < 0.5:
        ends = near - reach, near + reach
        misses = [planar_root_angle(rod, end) - root_angle for end in ends]
        if misses[0] * misses[1] <= 0:
            # Relative, because a heavy rod's tip hangs straight but for a tiny angle.
            return brentq(
                lambda angle: planar_root_angle(rod, angle) - root_angle,
                *ends,
                xtol=1e-300,
                rtol=1e-14,
            )
        reach *= 3
    raise RuntimeError(f"no planar equilibrium within 0.5 rad of {near:.3f} at {rod}")


def planar_branch(rods: list[Rod], root_angle: float = math.pi / 2) -> np.ndarray:
    """Tip angles of planar equilibria [rad], (len(rods),): rods alike but for their load, which
    rises. They are followed from the natural shape up."""
    near, load, angles = root_angle + rods[0].curvature[2], 0.0, []
    for rod in rods:
        steps = math.ceil((rod.load - load) / max(0.5, 0.25 * load))
        for between in np.linspace(load, rod.load, steps + 1)[1:]:
            near = planar_tip_angle(replace(rod, load=between), root_angle, near)
        load = rod.load
        angles.append(near)
    return np.array(angles)


def sideways_stability(rod: Rod, tip_angle: float) -> float:
    """How far the root's tangent frame leans aside when the tip of a planar equilibrium does, per
    radian: positive, and 1 without load, up to where the rod first leaves its plane, 0 there.

    A zero means that a neighbour out of the plane fits the same clamp: the conjugate point of the
    second variation. Central difference of `shoot` over 2e-5 rad.
    """
    lean = 1e-5
    tips = hanging([tip_angle, tip_angle])
    tips = tips * np.cos(lean) + np.array([[0, 0, lean], [0, 0, -lean]])
    at_root = shoot(rod, tips).weight_at_root
    return float((at_root[0, 2] - at_root[1, 2]) / (2 * lean))


def equilibria(rod: Rod, weight_at_root: ArrayLike, starts: int = 150) -> Shots:
    """All equilibria that Newton's method finds from `starts` tips spread over the sphere, those of
    least energy first; mirror images count as one where the rod and its clamp have them."""
    wanted = np.asarray(weight_at_root, dtype=np.float64)
    tips = _sphere(starts)
    for _ in range(12):
        tips = _newton(rod, tips, wanted, STEPS // 2)
    for _ in range(3):
        tips = _newton(rod, tips, wanted, STEPS)
    shots = shoot(rod, tips)
    found = np.flatnonzero(np.linalg.norm(shots.weight_at_root - wanted, axis=1) < 1e-9)
    kept: list[int] = []
    for index in found[np.argsort(shots.energies[found])]:
        energies = shots.energies[kept]
        if not np.any(np.abs(energies - shots.energies[index]) < 1e-7 * (1 + np.abs(energies))):
            kept.append(int(index))
    return Shots(shots.weight_at_root[kept], shots.centerlines[kept], shots.energies[kept])


def _newton(rod: Rod, tips: np.ndarray, wanted: np.ndarray, steps: int) -> np.ndarray:
    """One Gauss-Newton step of every tip on the sphere, at most 0.3 rad long."""
    across = np.cross(tips, np.where(np.abs(tips[:, :1]) < 0.7, _FIRST_AXIS, [0.0, 1.0, 0.0]))
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    basis = np.stack([across, np.cross(tips, across)], axis=2)  # (k, 3, 2)
    small = 1e-6
    moved = [tips, tips + small * basis[:, :, 0], tips + small * basis[:, :, 1]]
    ends = shoot(rod, np.concatenate(moved), steps).weight_at_root.reshape(3, -1, 3)
    slope = np.stack([ends[1] - ends[0], ends[2] - ends[0]], axis=2) / small
    normal = slope.transpose(0, 2, 1) @ slope + 1e-14 * np.eye(2)
    miss = slope.transpose(0, 2, 1) @ (ends[0] - wanted)[:, :, None]
    step = np.linalg.solve(normal, miss)[:, :, 0]
    step *= np.minimum(1, 0.3 / np.maximum(np.linalg.norm(step, axis=1, keepdims=True), 1e-30))
    tips = tips - np.einsum("kij,kj->ki", basis, step)
    return tips / np.linalg.norm(tips, axis=1, keepdims=True)


def _sphere(count: int) -> np.ndarray:
    """Points spread evenly over the unit sphere: Fibonacci's lattice, (count, 3)."""
    k = np.arange(count) + 0.5
    height, turn = 1 - 2 * k / count, np.pi * (1 + 5**0.5) * k
    radius = np.sqrt(1 - height**2)
    return np.stack([radius * np.cos(turn), height, radius * np.sin(turn)], axis=1)
