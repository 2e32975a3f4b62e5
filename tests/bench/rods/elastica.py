"""The heavy elastica: where a clamped strand hangs at rest, exact up to a stated tolerance.

With the angle phi(s) below the horizontal, moment balance of an inextensible rod that its own
weight w = rho S g bends is

    EI phi'' + w (L - s) cos phi = 0,    phi(0) = phi_0,  phi'(L) = 0,

and r' = (cos phi, -sin phi). In units of L only G = w L^3 / EI is left, the gravito-bending number.
"""

import numpy as np
from scipy.integrate import solve_bvp


def tip(number: float, tolerance: float = 1e-9) -> tuple[float, float]:
    """Tip (x, z) over L of a strand that is clamped horizontally, for G = `number` >= 0.

    `tolerance` bounds the relative residual of the collocation. G is raised in steps from a nearly
    straight strand, so that the answer is the branch a strand reaches that is released from there.
    """

    def derivative(s: np.ndarray, y: np.ndarray, load: float) -> np.ndarray:
        cos, sin = np.cos(y[0]), np.sin(y[0])
        return np.vstack([y[1], -load * (1 - s) * cos, cos, -sin])

    def ends(root: np.ndarray, free: np.ndarray) -> np.ndarray:
        return np.array([root[0], free[1], root[2], root[3]])

    s = np.linspace(0, 1, 65)
    y = np.vstack([np.zeros_like(s), np.zeros_like(s), s, np.zeros_like(s)])
    # The fewest steps in which G grows at most by half, from 1 up.
    steps = max(1, int(np.ceil(np.log(max(number, 1)) / np.log(1.5))))
    for load in number * 1.5 ** np.arange(1 - steps, 1, dtype=float):
        answer = solve_bvp(
            lambda s, y, load=load: derivative(s, y, load),
            ends,
            s,
            y,
            tol=tolerance,
            max_nodes=50000,
        )
        if not answer.success:
            raise RuntimeError(f"elastica at {load:g}: {answer.message}")
        s, y = answer.x, answer.y
    return float(y[2, -1]), float(y[3, -1])


def tip_series(number: float) -> tuple[float, float]:
    """The same for a small load: the tip's (x, z) over L up to terms of order G^4 and G^5.

    phi = G a(s) + G^3 b(s) with a'' = -(1 - s) and b'' = (1 - s) a^2 / 2, so that
    a = (s^3 - 3 s^2 + 3 s) / 6, x = 1 - G^2/2 int a^2 and z = -G int a + G^3 int (a^3/6 - b).
    """
    return 1 - number**2 / 112, -number / 8 + number**3 / 640
