"""Master curve of the heavy cantilever: how far a straight strand sags from a horizontal clamp."""

from __future__ import annotations

import numpy as np

from mane.client import Client
from mane.experiments import kirchhoff
from mane.experiments.report import Report
from mane.experiments.scene import ASIDE, rest, straight_hair, with_gravito_bending

ELEMENT_COUNTS = (5, 10, 20)
LIGHTEST, HEAVIEST = 0.1, 1000.0

# Tip errors over L of a helix of equal elements, of second order in N, grow with the load, which
# bends the strand within G^(-1/2) L of its root: here 0.16 elements of N = 5. So the bounds are
# for G up to HEAVIEST; 20 cm of smooth hair, G = 163, is off by half as much.
TIP_BOUNDS = {5: 0.06, 10: 0.02, 20: 0.0055}


def run(client: Client, report: Report, quick: bool) -> None:
    numbers = np.geomspace(LIGHTEST, HEAVIEST, 9 if quick else 33)
    exact = exact_lines(numbers)
    lines = {count: lines_of_mane(client, numbers, count) for count in ELEMENT_COUNTS}
    errors = {
        count: np.linalg.norm(each[:, -1] - exact[:, -1], axis=1) for count, each in lines.items()
    }

    light = numbers < 0.3  # Where a beam sags by G / 8, less G^2 / 80 of that, to second order.
    sag = -exact[light, -1, 1] / numbers[light]
    off = np.max(np.abs(8 * sag - 1))
    report.at_most("theory: sag / G against 1/8 of a light beam, relative", off, 1.2e-3)
    for count, error in errors.items():
        report.at_most(f"N = {count}: largest tip error / L", np.max(error), TIP_BOUNDS[count])
    # Where every N resolves the bend.
    resolved = numbers < 30
    ratio = np.max(errors[10][resolved]) / np.max(errors[20][resolved])
    report.equal("tip error at N = 10 over N = 20, second order", 4, ratio, 0.1)

    report.table(
        "curve",
        {"gravito_bending_number": numbers, "sag_over_L_exact": -exact[:, -1, 1]}
        | {f"sag_over_L_N{n}": -each[:, -1, 1] for n, each in lines.items()}
        | {f"tip_error_over_L_N{n}": each for n, each in errors.items()},
    )
    with report.figure("curve", columns=3, width=5) as (curve, error_axes, shapes):
        curve.semilogx(numbers, -exact[:, -1, 1], "k", label="elastica")
        for marker, (count, each) in zip("sox", lines.items(), strict=True):
            curve.semilogx(numbers, -each[:, -1, 1], marker, label=f"Mane, N = {count}", mfc="none")
            error_axes.loglog(numbers, errors[count], marker + "-", label=f"N = {count}")
        curve.set(
            xlabel=r"gravito-bending number $\Gamma = \rho S g L^3 / EI$",
            ylabel="sag of the tip b / L",
            title="Master curve",
        )
        error_axes.set(
            xlabel=r"$\Gamma$", ylabel="tip error / L", title="Error of Mane's equilibria"
        )
        for index in np.linspace(0, len(numbers) - 1, 5).astype(int):
            (line,) = shapes.plot(*exact[index, :, :2].T, label=rf"$\Gamma$ = {numbers[index]:.3g}")
            shapes.plot(*lines[10][index, ::5, :2].T, ".", color=line.get_color())
        shapes.set(
            xlabel="x / L",
            ylabel="y / L",
            xlim=(-0.05, 1.5),  # Room for the legend.
            aspect="equal",
            title="Elastica (lines), N = 10 (dots)",
        )
        for axes in (curve, error_axes, shapes):
            axes.legend()


def exact_lines(numbers: np.ndarray) -> np.ndarray:
    """Centrelines of the exact elastica over L, (number, point, 3): x away from the clamp, y up."""
    rods = [kirchhoff.Rod(number) for number in numbers]
    angles = kirchhoff.planar_branch(rods)
    shots = [
        kirchhoff.shoot(rod, kirchhoff.hanging(angle))
        for rod, angle in zip(rods, angles, strict=True)
    ]
    return np.stack([shot.centerlines[0] for shot in shots])


def lines_of_mane(client: Client, numbers: np.ndarray, element_count: int) -> np.ndarray:
    """Rest shapes over L, as `exact_lines`."""
    strand = straight_hair(ASIDE, 0.2, element_count)
    guides = [with_gravito_bending(strand, number) for number in numbers]
    return rest(client, guides) / strand.length_m
