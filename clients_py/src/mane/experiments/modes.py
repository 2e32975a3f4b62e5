"""Small sideways vibrations of a straight heavy strand, by Ritz's method; all without dimension.

With lengths in L, times in sqrt(rho S L^4 / EI) and y(s) the sideways deflection,

    y'''' -+ G ((1 - s) y')' = -y_tt,   - for a strand that hangs and + for one that stands,

G the gravito-bending number; as a variational problem: kinetic energy 1/2 int y_t^2, bending
1/2 int y''^2, weight +-G/2 int (1 - s) y'^2. y is s^2 times a polynomial, so that the
clamp holds; natural conditions hold at the tip.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.polynomial import Legendre
from scipy.linalg import eigh

TERMS = 12
"""Of the polynomial: the first frequency is then exact to ten digits, up to G = 300."""


@dataclass(frozen=True, eq=False)
class Matrices:
    """Inertia, bending and weight of the Ritz basis, (TERMS, TERMS) each, and the basis itself."""

    inertia: np.ndarray
    bending: np.ndarray
    weight: np.ndarray
    basis: tuple[Legendre, ...]


@cache
def matrices() -> Matrices:
    square = Legendre.fromroots([0.0, 0.0], domain=[0, 1])
    basis = [square * Legendre.basis(k, domain=[0, 1]) for k in range(TERMS)]
    nodes, weights = np.polynomial.legendre.leggauss(TERMS + 4)  # Exact for these degrees.
    s, w = (nodes + 1) / 2, weights / 2

    def gram(derivative: int, density: np.ndarray) -> np.ndarray:
        values = np.stack([(y.deriv(derivative) if derivative else y)(s) for y in basis])
        return (values * density) @ values.T

    return Matrices(gram(0, w), gram(2, w), gram(1, w * (1 - s)), tuple(basis))


@dataclass(frozen=True, eq=False)
class Mode:
    """The slowest vibration.

    Attributes:
      frequency: angular.
      bending_part: of its squared frequency, the rest is weight's.
      shape: y at given s, of unit tip.
    """

    frequency: float
    bending_part: float
    _coefficients: np.ndarray
    _basis: tuple[Legendre, ...]

    def shape(self, s: np.ndarray) -> np.ndarray:
        return sum(c * y(s) for c, y in zip(self._coefficients, self._basis, strict=True))


def first_mode(number: float, hangs: bool) -> Mode:
    """Of a strand of that gravito-bending number; one that stands must not fall over."""
    m = matrices()
    squares, vectors = eigh(m.bending + (number if hangs else -number) * m.weight, m.inertia)
    if squares[0] <= 0:
        raise ValueError(f"a strand that stands with gravito-bending number {number} falls over")
    v = vectors[:, 0] / sum(c * y(1.0) for c, y in zip(vectors[:, 0], m.basis, strict=True))
    bending = v @ m.bending @ v / (v @ m.inertia @ v)
    return Mode(float(np.sqrt(squares[0])), float(bending / squares[0]), v, m.basis)


def critical_number() -> float:
    """The gravito-bending number above which a strand that stands falls over (Greenhill 1881)."""
    m = matrices()
    return float(eigh(m.bending, m.weight, eigvals_only=True)[0])
