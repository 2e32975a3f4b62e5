"""A naturally curved rod in a horizontal clamp: when it leaves its plane, and where it rests."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.optimize import brentq

from mane.client import Client
from mane.experiments import kirchhoff
from mane.experiments.report import Report
from mane.experiments.scene import ASIDE, rest, straight_hair, with_gravito_bending
from mane.groom import Guide

ELEMENT_COUNTS = (5, 10, 20)
POISSON = 0.48
LENGTH_M = 0.2
SHAPE_ANGLE = 4.0
"""Natural curvature times L of the rod whose shapes are compared [rad]."""

HEAVIEST = 24.0
PLANAR = 1e-4  # Tips closer than that to the plane, over L, are in it.

# Relative errors of the critical load, and tip errors over L, fall as N^-2.
LOAD_BOUND, TIP_BOUND = 1.5, 1.0


def run(client: Client, report: Report, quick: bool) -> None:
    with report.figure("bend-twist", columns=3, width=5) as (border, tips, shapes):
        leave_plane(client, report, border, quick)
        rest_aside(client, report, tips, shapes, quick)


def leave_plane(client: Client, report: Report, axes, quick: bool) -> None:
    """The border between planar and spatial equilibria, over the natural angle and the load."""
    angles = np.array([3.0, 4.5] if quick else [3.0, 3.125, 3.25, 3.5, 4.0, 4.5, 5.0, 5.5, 6.0])
    theory = np.array([critical_load(angle) for angle in angles])
    axes.plot(angles, theory, "k-", label="Kirchhoff rod")
    columns = {"natural_angle_rad": angles, "critical_number_theory": theory}
    for marker, count in zip("sox", ELEMENT_COUNTS, strict=True):
        loads = np.array([sweep(client, angle, count) for angle in angles])
        off = np.abs(loads / theory - 1).max()
        what = f"N = {count}: critical load, largest relative error"
        report.at_most(what, off, LOAD_BOUND / count**2)
        axes.plot(angles, loads, marker, mfc="none", label=f"Mane, N = {count}")
        columns[f"critical_number_N{count}"] = loads
    report.table("border", columns)
    axes.text(3.6, 13, "out of its plane")
    axes.text(4.6, 7.6, "in its plane")
    axes.set(
        xlabel=r"natural angle $\kappa_n L$ [rad]",
        ylabel=r"gravito-bending number $\Gamma = \rho S g L^3 / EI$",
        title="When the rod first leaves its plane",
    )
    axes.legend(loc="upper left")


def rest_aside(client: Client, report: Report, axes, shape_axes, quick: bool) -> None:
    """Where a rod of `SHAPE_ANGLE` comes to rest, against the converged equilibria."""
    loads = np.array([7.0, 12.0, 30.0] if quick else [7, 8, 9, 9.5, 10, 11, 12, 15, 20, 25, 30])
    found = [kirchhoff.equilibria(rod(load, SHAPE_ANGLE), (0, -1, 0), 60) for load in loads]
    exact = np.stack([_to_one_side(shots.centerlines)[0] for shots in found])  # Least energy.
    lines = {
        count: _to_one_side(
            rest(client, [guide(load, SHAPE_ANGLE, count) for load in loads]) / LENGTH_M
        )
        for count in ELEMENT_COUNTS
    }
    axes.plot(loads, exact[:, -1, 2], "k-", label="Kirchhoff rod")
    # Near the border the offset is a square root of the load, and magnifies the border's error.
    far = (loads < 8) | (loads >= 12)
    columns = {"gravito_bending_number": loads, "tip_aside_over_L": exact[:, -1, 2]}
    errors = {}
    for marker, (count, line) in zip("sox", lines.items(), strict=True):
        errors[count] = np.linalg.norm(line[:, -1] - exact[:, -1], axis=1)
        what = f"N = {count}: largest tip error / L, away from the border"
        report.at_most(what, errors[count][far].max(), TIP_BOUND / count**2)
        axes.plot(loads, line[:, -1, 2], marker, mfc="none", label=f"Mane, N = {count}")
        columns[f"tip_aside_over_L_N{count}"] = line[:, -1, 2]
        columns[f"tip_error_over_L_N{count}"] = errors[count]
    ratio = errors[10][far].max() / errors[20][far].max()
    report.equal("tip error at N = 10 over N = 20, second order", 4, ratio, 0.1)
    others = [shots.centerlines.shape[0] for shots in found]
    near = [
        int(np.argmin(np.linalg.norm(_to_one_side(shots.centerlines)[:, -1] - tip, axis=1)))
        for shots, tip in zip(found, lines[20][:, -1], strict=True)
    ]
    report.fact(
        "N = 20 rests in the equilibrium of least energy, of all that were found",
        f"the first of {', '.join(map(str, others))}",
        f"the {', '.join(str(index + 1) for index in near)}.",
        not any(near),
    )
    report.table("tips", columns)
    axes.set(
        xlabel=r"$\Gamma$",
        ylabel="tip aside / L",
        title=rf"Rest at $\kappa_n L$ = {SHAPE_ANGLE:g}",
    )
    axes.legend()
    for color, load in enumerate((7.0, 12.0, 30.0)):
        at = int(np.argmax(loads == load))
        for column, style in ((0, "-"), (2, "--")):
            label = rf"$\Gamma$ = {load:g}, " + ("side view" if column == 0 else "front view")
            shape_axes.plot(*exact[at][:, [column, 1]].T, style, color=f"C{color}", label=label)
            dots = lines[10][at, ::5]
            shape_axes.plot(*dots[:, [column, 1]].T, ".", color=f"C{color}")
    shape_axes.set(
        xlabel="x / L, or z / L in front view",
        ylabel="y / L",
        xlim=(-0.3, 1.25),  # Room for the legend.
        aspect="equal",
        title="Kirchhoff rod (lines), N = 10 (dots)",
    )
    shape_axes.legend(fontsize="small", loc="center right")


def _to_one_side(lines: np.ndarray) -> np.ndarray:
    """Centrelines (line, point, 3), mirrored where need be so that tips lie at z >= 0."""
    sides = np.where(lines[:, -1:, 2:] < 0, -1.0, 1.0)
    return lines * np.concatenate([np.ones_like(sides), np.ones_like(sides), sides], axis=2)


# -- Theory -----------------------------------------------------------------------------------


def rod(load: float, angle: float) -> kirchhoff.Rod:
    """Round, curved upward by `angle` [rad] over its length."""
    return kirchhoff.Rod(load, (0.0, 0.0, angle), 1 / (1 + POISSON))


def critical_load(angle: float) -> float:
    """The gravito-bending number at which the planar equilibrium first gives way sideways, followed
    up from the natural shape; infinite where it does not below `HEAVIEST`."""
    before, near = 1e-3, np.pi / 2 + angle
    for load in np.arange(0.5, HEAVIEST, 0.5):
        tip = kirchhoff.planar_tip_angle(rod(load, angle), np.pi / 2, near)
        if kirchhoff.sideways_stability(rod(load, angle), tip) < 0:
            break
        before, near = load, tip
    else:
        return np.inf

    def margin(load: float) -> float:
        tip = kirchhoff.planar_tip_angle(rod(load, angle), np.pi / 2, near)
        return kirchhoff.sideways_stability(rod(load, angle), tip)

    return brentq(margin, before, load, xtol=1e-6)


# -- Mane -------------------------------------------------------------------------------------


def guide(load: float, angle: float, element_count: int) -> Guide:
    """The same rod as a strand of hair: x away from the clamp, y up, z aside."""
    straight = straight_hair(ASIDE, LENGTH_M, element_count)
    curved = replace(straight, poisson_ratio=POISSON, natural_curvature_2=angle / LENGTH_M)
    return with_gravito_bending(curved, load)


def sweep(client: Client, angle: float, element_count: int) -> float:
    """The number at which Mane's rest shape leaves the plane: a coarse sweep, then finer ones."""
    low, high = 0.5, HEAVIEST
    for _ in range(3):
        loads = np.linspace(low, high, 33)
        tips = rest(client, [guide(load, angle, element_count) for load in loads], 2)[:, -1]
        aside = np.abs(tips[:, 2]) > PLANAR * LENGTH_M
        if not aside.any():
            return np.inf
        first = int(np.argmax(aside))
        low, high = loads[first - 1], loads[first]
    return (low + high) / 2
