"""The strand that every code simulates, and what is measured of it."""

import math
import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

from rods import elastica

LENGTH = 0.2  # [m]
RADIUS = 35e-6  # [m]
YOUNG_MODULUS = 4e9  # [Pa]
POISSON_RATIO = 0.48
DENSITY = 1300.0  # [kg/m^3]
GRAVITY = 9.81  # [m/s^2]

AREA = math.pi * RADIUS**2
BENDING = YOUNG_MODULUS * math.pi / 4 * RADIUS**4  # EI [N m^2]
MASS = DENSITY * AREA * LENGTH  # [kg]
NUMBER = MASS * GRAVITY * LENGTH**2 / BENDING  # Gravito-bending number, 83.3.
RELAXATION = 1e-10 / BENDING  # gamma / EI with the internal friction of hair [s].
DRAG = 5.0  # Rate at which the settling strand loses velocity to the air [1/s].

# The peers' models are in units of the strand's length and mass, and seconds: in SI a hair's
# inertia lies below what some of them take for zero.
UNIT_RADIUS = RADIUS / LENGTH
UNIT_DENSITY = 1 / (math.pi * UNIT_RADIUS**2)
UNIT_YOUNG_MODULUS = YOUNG_MODULUS * LENGTH / MASS
UNIT_SHEAR_MODULUS = UNIT_YOUNG_MODULUS / (2 * (1 + POISSON_RATIO))
UNIT_BENDING = BENDING / (MASS * LENGTH**3)
UNIT_GRAVITY = GRAVITY / LENGTH

FRAME = 1 / 60  # [s]
FAST_DRAG = 15.0  # Where DRAG would make a run too long: rest in FAST_SETTLING.
FAST_SETTLING = 2.5  # [s]
SETTLING = 10.0  # Simulated time from the release to the rest that is judged [s].
REST_SPEED = 1e-3  # A tip below this speed, in strand lengths a second, is at rest.

MEASURED_TIME = 0.1  # Processor time of one repetition, at least [s].


@cache
def unit_reference_tip() -> tuple[float, float]:
    """The tip (x, z) at rest over L."""
    return elastica.tip(NUMBER)


def reference_tip() -> tuple[float, float]:
    """The same in metres."""
    x, z = unit_reference_tip()
    return x * LENGTH, z * LENGTH


def tip_error(x: float, z: float) -> float:
    """Distance of a tip from the reference, in units of L as the arguments are."""
    return math.dist((x, z), unit_reference_tip())


def half_clamped(segments: int) -> float:
    """Length over L of equal segments whose first is fixed with the clamp in its middle.

    The first joint then bends over half a segment, as the midpoint rule wants it: second order.
    """
    return 1 / (segments - 0.5)


@dataclass
class Row:
    """One code at one resolution. `tip_error_over_L` is None where it did not come to rest."""

    name: str
    segments: int
    dt: float  # A step that is stable [s].
    us_per_strand_step: float
    tip_error_over_L: float | None

    @property
    def us_per_frame(self) -> float:
        """Of one strand and 1/60 s."""
        return self.us_per_strand_step * FRAME / self.dt

    def entry(self) -> dict:
        """The row of the last line's JSON."""
        error = self.tip_error_over_L
        return {
            "name": self.name,
            "segments": self.segments,
            "dt": float(f"{self.dt:.9g}"),
            "us_per_strand_step": round(self.us_per_strand_step, 4),
            "us_per_frame_60hz": round(self.us_per_frame, 4),
            "tip_error_over_L": None if error is None else float(f"{error:.3g}"),
        }


def median_us(run: Callable[[int], object], steps: int, repetitions: int = 7) -> float:
    """Median processor time of a step [us], of which run(steps) makes `steps`.

    Processor time, because a machine that is shared would otherwise be measured with its load.
    """
    run(steps)
    times = []
    for _ in range(repetitions):
        start = end = time.process_time()
        made = 0
        while end < start + MEASURED_TIME:
            run(steps)
            made += steps
            end = time.process_time()
        times.append((end - start) / made * 1e6)
    return statistics.median(times)


def largest_stable(settle: Callable[[float], tuple[float, float] | None], halvings: int = 8):
    """The first dt of 1/60 s, 1/120 s, ... with which settle(dt) finds rest, and that tip."""
    for power in range(halvings + 1):
        dt = FRAME / 2**power
        tip = settle(dt)
        if tip is not None:
            return dt, tip
    return None
