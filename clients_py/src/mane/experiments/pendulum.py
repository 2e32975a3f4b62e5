"""A hanging strand that swings: how fast air drag damps it, and how much the time step does."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.optimize import least_squares

from mane.client import Client
from mane.experiments import modes
from mane.experiments.report import Report
from mane.experiments.scene import (
    DOWN,
    bending_stiffness,
    gravito_bending,
    mass_per_length,
    play,
    straight_hair,
)
from mane.motion import Motion

DRAGS = (0.0, 2e-6, 5e-6, 1e-5, 2e-5, 5e-5)
"""nu [kg/(m s)]: none, and around the range of [SH06] 4.2, 5e-6 to 5e-5."""

RATE_HZ = 120.0
SUBSTEPS = (1, 2, 4, 8, 16)
POINTS = 65
PUSH_M = 2e-3  # So small that the swing, some 2 degrees, stays linear.


def run(client: Client, report: Report, quick: bool) -> None:
    strand = straight_hair(DOWN, 0.2, 20)
    guides = [replace(strand, air_drag=drag) for drag in DRAGS]
    mode = modes.first_mode(gravito_bending(strand), hangs=True)
    per_second = (bending_stiffness(strand) / mass_per_length(strand)) ** 0.5 / strand.length_m**2
    omega = mode.frequency * per_second
    motion, free_from = push(2 * np.pi / omega, 1.5 if quick else 4.0)

    steps = np.array([1 / (RATE_HZ * n) for n in SUBSTEPS])
    swings = [first_mode_part(play(client, guides, motion, POINTS, n), mode) for n in SUBSTEPS]
    times = motion.times_s[free_from:] - motion.times_s[free_from]
    fits = np.array([[damped_wave(times, s[free_from:, g], omega) for g in range(len(DRAGS))]
                     for s in swings])  # fmt: skip
    decay, frequency = fits[:, :, 0], fits[:, :, 1]
    # First order in the step, with what is left of second order fitted along.
    decay_0, slope = (np.polyfit(steps, decay, 2)[row] for row in (2, 1))
    frequency_0 = np.polyfit(steps, frequency, 2)[2]
    theory = np.array(DRAGS) / (2 * mass_per_length(strand))

    for drag, expected, measured in zip(DRAGS[1:], theory[1:], decay_0[1:], strict=True):
        report.equal(f"decay at nu = {drag:g}, step -> 0", expected, measured, 0.01, " 1/s")
    report.at_most("decay without drag, step -> 0", abs(decay_0[0]), 1e-3 * omega, " 1/s")
    report.equal("angular frequency without drag", omega, frequency_0[0], 2e-3, " rad/s")
    of_scheme = (0.05 + 0.1375 * mode.bending_part) * omega**2
    report.equal("numerical decay over step (rod.md S8, S10)", of_scheme, slope[0], 0.1, " 1/s^2")
    report.values["numerical decay at 1/60 s"] = float(slope[0] / 60)

    columns = {"nu_kg_per_m_s": DRAGS, "theory_per_s": theory, "step_to_0_per_s": decay_0}
    by_step = {f"step_1_{round(1 / dt)}_s": row for dt, row in zip(steps, decay, strict=True)}
    report.table("decay", columns | by_step)
    report.table(
        "swing",
        {"time_s": times} | {f"nu_{d:g}_m": swings[-1][free_from:, i] for i, d in enumerate(DRAGS)},
    )
    with report.figure("damping", columns=3, width=5) as (swing, rates, step_axes):
        for index in (0, 2, 5):
            (line,) = swing.plot(
                times, 1e3 * swings[-1][free_from:, index], label=rf"$\nu$ = {DRAGS[index]:g}"
            )
            size = 1e3 * fits[-1, index, 2]
            envelope = size * np.exp(-theory[index] * times)
            swing.plot(times, envelope, "--", color=line.get_color(), lw=1)
        swing.set(
            xlabel="time [s]",
            ylabel="tip's part in the first mode [mm]",
            title=f"Swing, step 1/{round(1 / steps[-1])} s (dashed: theory)",
        )
        rates.plot(DRAGS, theory, "k", label=r"$\nu / (2 \rho S)$")
        rates.plot(DRAGS, decay_0, "o", mfc="none", label="Mane, step to 0")
        rates.plot(DRAGS, decay[0], "x", label=f"Mane, step 1/{round(1 / steps[0])} s")
        rates.set(xlabel=r"air drag $\nu$ [kg/(m s)]", ylabel="decay rate [1/s]", title="Damping")
        for index in (0, 2, 5):
            step_axes.plot(1e3 * steps, decay[:, index] - theory[index], "o-",
                           label=rf"$\nu$ = {DRAGS[index]:g}")  # fmt: skip
        step_axes.plot(1e3 * steps, of_scheme * steps, "k--", label="rod.md S8 and S10")
        step_axes.set(
            xlabel="time step [ms]", ylabel="decay rate over theory [1/s]", title="Numerical part"
        )
        for axes in (swing, rates, step_axes):
            axes.legend()


def push(period_s: float, free_s: float) -> tuple[Motion, int]:
    """The root goes aside and back once in `period_s`, then stays; and the frame at which it does.

    A push at the first mode's own period leaves little of the others.
    """
    free_from = int(np.ceil(period_s * RATE_HZ)) + 1
    times = np.arange(free_from + round(free_s * RATE_HZ)) / RATE_HZ
    phase = 2 * np.pi * np.minimum(times / period_s, 1)
    return Motion(times, np.outer(PUSH_M / 2 * (1 - np.cos(phase)), (1, 0, 0))), free_from


def first_mode_part(positions: np.ndarray, mode: modes.Mode) -> np.ndarray:
    """The first mode's coefficient in the sideways deflection, (frame, guide) [m] at the tip.

    Modes are orthogonal under int ds, so that none of the others is left.
    """
    s = np.linspace(0, 1, positions.shape[2])
    shape = mode.shape(s)
    return np.trapezoid(positions[..., 0] * shape, s, axis=-1) / np.trapezoid(shape**2, s)


def damped_wave(times: np.ndarray, values: np.ndarray, omega: float) -> np.ndarray:
    """(decay rate, angular frequency, size) of the damped sine closest to `values`."""

    def miss(unknowns: np.ndarray) -> np.ndarray:
        decay, frequency, cosine, sine, middle = unknowns
        turn = frequency * times
        wave = cosine * np.cos(turn) + sine * np.sin(turn)
        return (np.exp(-decay * times) * wave + middle - values) / np.abs(values).max()

    size = np.abs(values).max()
    scale = [1.0, omega, size, size, size]
    fit = least_squares(miss, [0.1, omega, size / 2, size / 2, 0], x_scale=scale, xtol=1e-12)
    return np.array([fit.x[0], fit.x[1], np.hypot(fit.x[2], fit.x[3])])
