"""An upright strand: when it falls over by its weight, and when a shaken root makes it sway."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import expm, solve

from mane.client import Client
from mane.experiments import modes
from mane.experiments.report import Report
from mane.experiments.scene import (
    DOWN,
    GRAVITY,
    UP,
    bending_stiffness,
    gravito_bending,
    mass_per_length,
    play,
    rest,
    straight_hair,
)
from mane.groom import Guide
from mane.motion import Motion

ELEMENT_COUNTS = (5, 10, 20)

# The upright strand that is shaken: 58 mm, four fifths of the critical length, in still air.
SHAKEN = replace(straight_hair(UP, 0.058, 10), air_drag=2e-5, natural_curvature_2=0.05)
RATE_HZ = 480.0
SUBSTEPS = 4
FREQUENCIES = np.linspace(1.7, 2.3, 7)  # Of the root, in units of the strand's own.
QUICK_FREQUENCIES = (1.8, 2.0, 2.2)


def run(client: Client, report: Report, quick: bool) -> None:
    with report.figure("buckling", columns=3, width=5) as (static, tongue, hanging):
        fall_over(client, report, static, quick)
        shake_upright(client, report, tongue, quick)
        shake_hanging(client, report, hanging)


# -- Weight alone -----------------------------------------------------------------------------


def fall_over(client: Client, report: Report, axes, quick: bool) -> None:
    """Sweeps the length of an upright strand at rest: beyond the critical one it leans over."""
    unit_m = straight_hair(UP, 1, 1)
    scale_m = (bending_stiffness(unit_m) / (mass_per_length(unit_m) * GRAVITY)) ** (1 / 3)
    theory = modes.critical_number() ** (1 / 3)
    axes.axvline(theory, color="k", label=f"Greenhill: {theory:.4f}")
    for marker, count in zip("sox", ELEMENT_COUNTS, strict=True):
        parts, leans, critical = sweep_length(client, scale_m, count)
        axes.plot(parts, leans, marker, mfc="none", ms=4, label=f"N = {count}: {critical:.4f}")
        # Equal elements are too stiff by 1 / (24 N^2) of pi^2 or so: second order.
        report.equal(
            f"N = {count}: critical length / (EI / rho S g)^(1/3)", theory, critical, 0.25 / count**2
        )
        report.table(f"lean-N{count}", {"length_over_scale": parts, "tip_aside_over_L": leans})
    axes.set(
        xlabel=r"length / $(EI / \rho S g)^{1/3}$",
        ylabel="tip aside / L at rest",
        title="An upright strand falls over",
    )
    axes.legend()


def sweep_length(
    client: Client, scale_m: float, element_count: int
) -> tuple[np.ndarray, np.ndarray, float]:
    """Lengths over the scale in order, how far tips lean over L, and the length where that begins.

    A coarse sweep finds the first that leans; two finer ones follow between it and the one before.
    """
    low, high = 1.0, 3.0
    parts, leans = np.empty(0), np.empty(0)
    for _ in range(3):
        swept = np.linspace(low, high, 33)
        tips = rest(
            client, [straight_hair(UP, part * scale_m, element_count) for part in swept], 2
        )[:, -1]
        aside = np.hypot(tips[:, 0], tips[:, 2]) / (swept * scale_m)
        parts, leans = np.append(parts, swept), np.append(leans, aside)
        first = int(np.argmax(aside > 1e-6))
        low, high = swept[first - 1], swept[first]
    order = np.argsort(parts)
    return parts[order], leans[order], (low + high) / 2


# -- A root that goes up and down -------------------------------------------------------------


@dataclass(frozen=True)
class Linear:
    """Small sideways motion of a strand whose root goes up and down, in Ritz's basis and SI.

    M y'' + c M y' + (K - (g + a(t)) W) y = 0, with a the root's acceleration upward.
    """

    inertia: np.ndarray
    stiffness: np.ndarray
    weight: np.ndarray  # For each m/s^2.
    drag: float

    @staticmethod
    def of(guide: Guide) -> Linear:
        m = modes.matrices()
        stiffness = bending_stiffness(guide) / (mass_per_length(guide) * guide.length_m**4)
        return Linear(
            m.inertia,
            stiffness * m.bending,
            m.weight / guide.length_m,
            guide.air_drag / mass_per_length(guide),
        )

    def growth(self, amplitude_m: float, omega: float, pieces: int = 256) -> float:
        """Growth rate of the strongest solution [1/s] where the root is at A cos(omega t): Floquet.

        The root's acceleration is taken as constant over each of `pieces` parts of a period, with
        its mean there, so that the matrix of a period is a product of exponentials.
        """
        size = len(self.inertia)
        edges = np.linspace(0, 2 * np.pi, pieces + 1)
        mean = -amplitude_m * omega**2 * np.diff(np.sin(edges)) / (edges[1] - edges[0])
        K, W = (solve(self.inertia, x, assume_a="pos") for x in (self.stiffness, self.weight))
        period = np.eye(2 * size)
        dt = 2 * np.pi / omega / pieces
        for acceleration in mean:
            pull = K - (GRAVITY + acceleration) * W
            step = np.block(
                [[np.zeros((size, size)), np.eye(size)], [-pull, -self.drag * np.eye(size)]]
            )
            period = expm(dt * step) @ period
        largest = np.abs(np.linalg.eigvals(period)).max()
        return float(np.log(largest) * omega / (2 * np.pi))


def shake_upright(client: Client, report: Report, axes, quick: bool) -> None:
    """Principal parametric resonance of [SH06] figure 7's kind, against Floquet's theory."""
    linear = Linear.of(SHAKEN)
    mode = modes.first_mode(gravito_bending(SHAKEN), hangs=False)
    stiffness = bending_stiffness(SHAKEN) / mass_per_length(SHAKEN)
    own = mode.frequency * stiffness**0.5 / SHAKEN.length_m**2
    amplitudes_m = 1e-3 * np.array([0.5, 1.5, 3.0] if quick else [0.25, 0.5, 1.0, 1.5, 2.0, 3.0])
    rows = []
    for ratio in QUICK_FREQUENCIES if quick else FREQUENCIES:
        for amplitude_m in amplitudes_m:
            omega = ratio * own
            theory = linear.growth(amplitude_m, omega)
            rows.append((ratio, amplitude_m, theory, measured_growth(client, amplitude_m, omega)))
    ratio, amplitude_m, theory, measured = np.array(rows).T
    print(np.array(rows))
