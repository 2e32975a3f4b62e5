"""PyElastica: the explicit Cosserat rod, as it is and softened.

As it is, a hair's shear makes its elements turn at 2 sqrt(G / rho) / radius, 6e7 1/s, and an
explicit step must follow: rest is out of reach, and only the cost is measured. Softened, stretch
and shear are a thousandth as stiff, which lengthens the strand by less than 4e-4 of itself, and the
elements' radius of gyration is a tenth of their length, which does not alter the rest.
"""

import importlib.metadata
import math

import elastica as ea
import numpy as np

from rods import strand
from rods.strand import Row

RESOLUTIONS = (10, 20, 40)
STRANDS = 100  # Steps share one block of memory, as those of a head of guides would.
SOFTENING = 1e-3
CHECKED_STEPS = 20000
COURANT = 0.5  # Share of the explicit step's limit that is used.


class Simulator(ea.BaseSystemCollection, ea.Constraints, ea.Forcing, ea.Damping):
    """What one run consists of."""


def make_rods(simulator: Simulator, segments: int, count: int, soft: bool) -> list[ea.CosseratRod]:
    """Rods whose first element is fixed: the clamp is in its middle."""
    rods = []
    h = strand.half_clamped(segments)
    for _ in range(count):
        rod = ea.CosseratRod.straight_rod(
            segments,
            start=np.array([-h / 2, 0.0, 0.0]),
            direction=np.array([1.0, 0.0, 0.0]),
            normal=np.array([0.0, 1.0, 0.0]),
            base_length=segments * h,
            base_radius=strand.UNIT_RADIUS,
            density=strand.UNIT_DENSITY,
            youngs_modulus=strand.UNIT_YOUNG_MODULUS,
            shear_modulus=strand.UNIT_SHEAR_MODULUS,
        )
        if soft:
            rod.shear_matrix *= SOFTENING
            factor = inertia_factor(segments)
            rod.mass_second_moment_of_inertia *= factor
            rod.inv_mass_second_moment_of_inertia /= factor
        rods.append(rod)
        simulator.append(rod)
    return rods


def inertia_factor(segments: int) -> float:
    """From the radius of gyration of the section to a tenth of an element's length."""
    return (0.1 / segments / (strand.UNIT_RADIUS / 2)) ** 2


def time_step(segments: int, soft: bool) -> float:
    """COURANT times the limit 2 / omega of the fastest of stretch and element rotation [s]."""
    h = 1 / segments
    softening = SOFTENING if soft else 1.0
    wave = math.sqrt(softening * strand.UNIT_YOUNG_MODULUS / strand.UNIT_DENSITY)
    gyration = 0.1 * h if soft else strand.UNIT_RADIUS / 2
    rotation = math.sqrt(softening * strand.UNIT_SHEAR_MODULUS / strand.UNIT_DENSITY) / gyration
    return COURANT * min(h / wave, 2 / rotation)


def build(segments: int, count: int, soft: bool, drag: float) -> tuple[Simulator, list, float]:
    simulator, dt = Simulator(), time_step(segments, soft)
    rods = make_rods(simulator, segments, count, soft)
    for rod in rods:
        simulator.constrain(rod).using(
            ea.OneEndFixedBC, constrained_position_idx=(0,), constrained_director_idx=(0,)
        )
        simulator.add_forcing_to(rod).using(
            ea.GravityForces, acc_gravity=np.array([0.0, 0.0, -strand.UNIT_GRAVITY])
        )
        simulator.dampen(rod).using(
            ea.AnalyticalLinearDamper, uniform_damping_constant=drag, time_step=dt
        )
    simulator.finalize()
    return simulator, rods, dt


def advance(simulator: Simulator, steps: int, dt: float) -> None:
    stepper, now = ea.PositionVerlet(), np.float64(0)
    for _ in range(steps):
        now = stepper.step(simulator, now, np.float64(dt))


def check_stability(segments: int, soft: bool) -> None:
    """Raises where the first steps after the release blow up."""
    simulator, (rod,), dt = build(segments, 1, soft, 0.0)
    advance(simulator, CHECKED_STEPS, dt)
    if not np.abs(rod.velocity_collection).max() < strand.UNIT_GRAVITY * CHECKED_STEPS * dt * 2:
        raise RuntimeError(f"{segments} elements, step {dt:g} s: not stable")


def settle(segments: int) -> tuple[float, float] | None:
    """The softened strand's tip at rest."""
    simulator, (rod,), dt = build(segments, 1, True, strand.FAST_DRAG)
    advance(simulator, round(strand.FAST_SETTLING / dt), dt)
    x, _, z = rod.position_collection[:, -1]
    speed = np.abs(rod.velocity_collection[:, -1]).max()
    return (float(x), float(z)) if speed < 10 * strand.REST_SPEED else None


def rows() -> list[Row]:
    version = importlib.metadata.version("pyelastica")
    result = []
    for soft in (False, True):
        for segments in RESOLUTIONS:
            check_stability(segments, soft)
            simulator, _, dt = build(segments, STRANDS, soft, strand.DRAG)
            us = strand.median_us(lambda n, s=simulator, dt=dt: advance(s, n, dt), 20) / STRANDS
            end = settle(segments) if soft else None
            error = strand.tip_error(*end) if end else None
            name = f"pyelastica {version}" + (", softened" if soft else "")
            result.append(Row(name, segments, dt, us, error))
    return result
