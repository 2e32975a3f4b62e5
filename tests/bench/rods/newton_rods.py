"""Newton: capsules on rod joints under vertex block descent, in single precision on the processor.

The solver stops after a fixed number of sweeps. What it has not converged then shows as a wrong
rest shape, the more so the larger the step: each resolution has the step that is worth its cost.
"""

import math

import newton
import numpy as np
import warp as wp

from rods import strand
from rods.strand import Row

STEPS = ((10, 1 / 60), (10, 1 / 240), (20, 1 / 960))  # Segments and step [s].
STRANDS = 100  # Kernels are launched once for all.
SWEEPS = 10  # Newton's default.
STRETCH = {1 / 60: 1e5, 1 / 240: 1e4, 1 / 960: 1e5}  # Joint stiffness [1/s^2]: the most accurate.
GYRATION = 0.01  # Of a segment about its axis, over L: its true spin is beyond single precision.


class Strands:
    """`count` strands side by side; the first segment of each is fixed."""

    def __init__(self, segments: int, dt: float, count: int):
        h = strand.half_clamped(segments)
        stiffness = strand.UNIT_BENDING / h
        builder = newton.ModelBuilder(gravity=wp.vec3(0.0, 0.0, -strand.UNIT_GRAVITY))
        for i in range(count):
            rod = newton.Rod.create_straight(
                start=wp.vec3(-h / 2, float(i), 0.0),
                direction=wp.vec3(1.0, 0.0, 0.0),
                length=h * segments,
                segment_count=segments,
                radius=GYRATION,
            )
            bodies, _ = builder.add_rod(
                rod=rod,
                stretch_stiffness=STRETCH[dt],
                bend_stiffness=stiffness,
                bend_damping=stiffness * strand.RELAXATION,
            )
            for body in bodies:
                moments = np.diag([h**3 / 12, h**3 / 12, h * GYRATION**2])
                builder.body_mass[body], builder.body_inv_mass[body] = h, 1 / h
                builder.body_inertia[body] = wp.mat33(*moments.ravel())
                builder.body_inv_inertia[body] = wp.mat33(*np.linalg.inv(moments).ravel())
            builder.body_mass[bodies[0]] = builder.body_inv_mass[bodies[0]] = 0.0
            builder.body_inertia[bodies[0]] = builder.body_inv_inertia[bodies[0]] = wp.mat33(0.0)
        builder.color(balance_colors=False)
        self.h, self.dt = h, dt
        self.model = builder.finalize(device="cpu")
        self.solver = newton.solvers.SolverVBD(self.model, iterations=SWEEPS)
        self.now, self.next = self.model.state(), self.model.state()
        self.control = self.model.control()

    def advance(self, steps: int, drag: float = 0.0) -> None:
        kept = np.float32(math.exp(-drag * self.dt))
        for _ in range(steps):
            self.now.clear_forces()
            self.solver.step(self.now, self.next, self.control, None, self.dt)
            self.now, self.next = self.next, self.now
            velocity = self.now.body_qd.numpy()  # Shares the solver's memory on the processor.
            velocity *= kept

    def tip(self) -> tuple[float, float] | None:
        """The last strand's tip where it is at rest."""
        pose, twist = self.now.body_q.numpy()[-1], self.now.body_qd.numpy()[-1]
        if not np.isfinite(pose).all() or np.abs(twist[:3]).max() > 10 * strand.REST_SPEED:
            return None
        end = wp.quat_rotate(wp.quat(*map(float, pose[3:])), wp.vec3(0.0, 0.0, self.h / 2))
        return float(pose[0] + end[0]), float(pose[2] + end[2])


def rows() -> list[Row]:
    result = []
    for segments, dt in STEPS:
        settling = Strands(segments, dt, 1)
        settling.advance(round(strand.FAST_SETTLING / dt), strand.FAST_DRAG)
        end = settling.tip()
        error = strand.tip_error(*end) if end else None
        us = strand.median_us(Strands(segments, dt, STRANDS).advance, 10) / STRANDS
        result.append(Row(f"newton {newton.__version__}, vbd, cpu", segments, dt, us, error))
    return result
