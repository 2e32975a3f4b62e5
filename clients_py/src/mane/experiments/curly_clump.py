"""A curly clump shaken up and down: its span against internal friction, as in [SH06] figure 6."""

from __future__ import annotations

import numpy as np

from mane.client import Client
from mane.experiments.report import Report
from mane.experiments.scene import DOWN, play
from mane.groom import Guide, frame_along
from mane.motion import Motion

FRICTIONS = (1e-11, 5e-11, 1e-10, 5e-10, 1e-9, 1e-8, 1e-7)
"""gamma [kg m^3/s]: [SH06] 4.2's range, 5e-11 to 5e-10, with its 1e-10 of figure 6, and beyond."""
SHOWN = (1e-11, 1e-10, 5e-10, 1e-8)

RATE_HZ = 120.0
FREQUENCY_HZ = 2.5
AMPLITUDE_M = 0.02
LENGTH_M = 0.2
ELEMENT_COUNT = 24  # More than three a turn: the coil bends and stretches as a rod does.
POINTS = 97
SUBSTEPS = 16


def run(client: Client, report: Report, quick: bool) -> None:
    guides = [clump(friction) for friction in FRICTIONS]
    motion = shaking(cycles=6 if quick else 15)
    coarse, moving = (play(client, guides, motion, POINTS, n) for n in (SUBSTEPS // 2, SUBSTEPS))
    spans = {SUBSTEPS // 2: span(coarse), SUBSTEPS: span(moving)}
    last_two = motion.times_s > motion.times_s[-1] - 2 / FREQUENCY_HZ
    swings = {n: np.ptp(each[last_two], axis=0) / 2 for n, each in spans.items()}
    swing = swings[SUBSTEPS]

    report.fact(
        "larger gamma, smaller swing of the span",
        "falls",
        " > ".join(f"{1e3 * each:.3g}" for each in swing) + " mm",
        np.all(np.diff(swing) < 0),
    )
    low, high = (swing[FRICTIONS.index(friction)] for friction in (5e-11, 5e-10))
    report.fact(
        "within [SH06]'s range, 5e-11 to 5e-10, gamma can be fitted to the swing",
        "swings differ clearly",
        f"by a factor of {low / high:.2f}",
        low / high > 1.5,
    )
    what = "where friction rules, the swing is as 1 / gamma: 1e-8 to 1e-7"
    report.equal(what, 10, swing[-2] / swing[-1], 0.03)
    off = np.abs(swings[SUBSTEPS // 2] / swing - 1).max()
    report.at_most("swing at twice the time step, relative change", off, 0.01)

    columns = {f"gamma_{g:g}_m": spans[SUBSTEPS][:, i] for i, g in enumerate(FRICTIONS)}
    report.table("span", {"time_s": motion.times_s, "root_m": motion.positions[:, 1]} | columns)
    report.table("swing", {"gamma_kg_m3_per_s": FRICTIONS, "swing_m": swing})
    with report.figure("span", columns=3, width=5) as (time_axes, swing_axes, shape_axes):
        for index, friction in enumerate(FRICTIONS):
            if friction in SHOWN:
                label = rf"$\gamma$ = {friction:g}"
                time_axes.plot(motion.times_s, 100 * spans[SUBSTEPS][:, index], label=label)
        time_axes.set(
            xlabel="time [s]",
            ylabel=r"span $\ell_A$ [cm]",
            title=f"Root at {100 * AMPLITUDE_M:g} cm, {FREQUENCY_HZ:g} Hz up and down",
        )
        swing_axes.loglog(FRICTIONS, 1e3 * swing, "o-", label="Mane")
        swing_axes.loglog(
            FRICTIONS[-3:], 1e3 * swing[-1] * FRICTIONS[-1] / np.array(FRICTIONS[-3:]), "k--",
            label=r"as $1/\gamma$",
        )  # fmt: skip
        swing_axes.axvspan(5e-11, 5e-10, alpha=0.15, label="range of [SH06]")
        swing_axes.set(
            xlabel=r"internal friction $\gamma$ [kg m$^3$/s]",
            ylabel="swing of the span [mm]",
            title="Swing over the last two cycles",
        )
        for column, friction in enumerate(SHOWN):
            index = FRICTIONS.index(friction)
            of_cycle = np.flatnonzero(last_two)
            for extreme, style in ((np.argmin, "-"), (np.argmax, "--")):
                frame = of_cycle[extreme(spans[SUBSTEPS][of_cycle, index])]
                line = moving[frame, index] * 100
                shape_axes.plot(2.5 * column + line[:, 0], line[:, 1], style, color=f"C{column}")
        shape_axes.set(
            xlabel="x, clumps side by side [cm]",
            ylabel="below the root [cm]",
            aspect="equal",
            title="Shortest (full) and longest (dashed) span",
        )
        for axes in (time_axes, swing_axes):
            axes.legend()


def clump(internal_friction: float) -> Guide:
    """Curly Caucasian hair of [SH06] Appendix B as one strand that hangs along its coil's axis."""
    r_h, step = 0.006, 0.005
    minor = 2 * 50e-6 / (1 + 1.1)
    curvature, twist = 1 / r_h, step / (2 * np.pi * r_h**2)
    # The axis of a coil is that of its Darboux vector, (twist, curvature, 0) in the root's frame.
    axis = np.array([twist, curvature, 0]) / np.hypot(twist, curvature)
    return Guide(
        root_frame=_turned_onto(axis),
        length_m=LENGTH_M,
        element_count=ELEMENT_COUNT,
        radius_1_m=1.1 * minor,
        radius_2_m=minor,
        young_modulus_pa=1.5e9,
        poisson_ratio=0.48,
        density_kg_m3=1300,
        internal_friction=internal_friction,
        air_drag=2e-5,
        natural_curvature_1=curvature,
        natural_twist=twist,
    )


def _turned_onto(axis: np.ndarray) -> np.ndarray:
    """A root frame in which the strand's `axis` = (a, b, 0) points down."""
    down = np.array(DOWN)
    aside = np.array([0.0, 0.0, 1.0])
    n0 = axis[0] * down + axis[1] * aside
    n1 = axis[1] * down - axis[0] * aside
    return frame_along(n0, n1)


def shaking(cycles: int) -> Motion:
    times = np.arange(round(cycles / FREQUENCY_HZ * RATE_HZ) + 1) / RATE_HZ
    height = AMPLITUDE_M * (np.cos(2 * np.pi * FREQUENCY_HZ * times) - 1)
    return Motion(times, np.stack([0 * times, height, 0 * times], axis=1))


def span(positions: np.ndarray) -> np.ndarray:
    """Height of the clump from its lowest point to the root, l_A, (frame, guide) [m]."""
    return positions[:, :, 0, 1] - positions[..., 1].min(axis=2)
