"""Strands and bodies for experiments, and their rest shapes and motion on a server."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace

import numpy as np

from mane.bodies import Body, CapsuleBody
from mane.client import Client
from mane.groom import Groom, Guide, frame_along
from mane.mesh import Mesh
from mane.motion import Motion
from mane.pose import Environment

GRAVITY = 9.81
"""The server's own, [m/s^2]."""

UP, DOWN, ASIDE = (0.0, 1.0, 0.0), (0.0, -1.0, 0.0), (1.0, 0.0, 0.0)

THICKNESS_M = 5e-4
"""How far from a body's surface the server keeps a strand's centreline."""


def straight_hair(direction: Sequence[float], length_m: float, element_count: int) -> Guide:
    """Asian hair of [SH06] Appendix B, round and straight, without internal friction and air."""
    return Guide(
        root_frame=frame_along(direction),
        length_m=length_m,
        element_count=element_count,
        radius_1_m=5e-5,
        radius_2_m=5e-5,
        young_modulus_pa=1e9,
        poisson_ratio=0.48,
        density_kg_m3=1300,
        internal_friction=0,
        air_drag=0,
    )


def mass_per_length(guide: Guide) -> float:
    """rho S [kg/m]."""
    return guide.density_kg_m3 * math.pi * guide.radius_1_m * guide.radius_2_m


def bending_stiffness(guide: Guide) -> float:
    """EI of a round strand [N m^2]."""
    return guide.young_modulus_pa * math.pi / 4 * guide.radius_1_m**4


def gravito_bending(guide: Guide) -> float:
    """rho S g L^3 / EI: how heavy a strand is for its stiffness."""
    weight = mass_per_length(guide) * GRAVITY
    return weight * guide.length_m**3 / bending_stiffness(guide)


def with_gravito_bending(guide: Guide, number: float) -> Guide:
    """The strand with the stiffness at which `gravito_bending` is `number`."""
    modulus = guide.young_modulus_pa * gravito_bending(guide) / number
    return replace(guide, young_modulus_pa=modulus)


def rest(client: Client, guides: Sequence[Guide], points: int = 101) -> np.ndarray:
    """Rest shapes, (guide, point, 3) [m]."""
    with kept(client, guides) as groom:
        return client.rest_shape(groom, points_per_guide=points).positions


def far_body() -> Body:
    """One that hair never meets: today servers let wisps meet in grooms with bodies only."""
    place = (0.0, -50.0, 0.0)
    return Body("far", CapsuleBody(place, place, 0.1))


def slab(name: str, half_width_m: float, **of_body) -> Body:
    """A box 5 cm thick whose face is the square of that half width in the plane x = 0 of its frame.

    The other arguments are those of `Body`.
    """
    corners = [(x, y, z) for x in (-1, 0) for y in (-1, 1) for z in (-1, 1)]
    # Three lists of corners counter-clockwise seen from the low side, and the same from the high.
    low = [(0, 1, 3, 2), (0, 4, 5, 1), (0, 2, 6, 4)]
    high = [(4, 6, 7, 5), (2, 3, 7, 6), (1, 5, 7, 3)]
    triangles = [t for a, b, c, d in (*low, *high) for t in ((a, b, c), (a, c, d))]
    scale = (0.05, half_width_m, half_width_m)
    return Body(name, Mesh(np.array(corners) * scale, triangles), **of_body)


def hair_on_slab(
    length_m: float, element_count: int, root: Sequence[float], number: float = 2e4
) -> Guide:
    """Straight hair that hangs before the face of a `slab` at `root`, so soft, as its
    `gravito_bending` number says, that only its weight and friction count, in air that lets it
    settle within seconds.

    Heads begin at rest under the server's own gravity. Turned by `onto_slab` it lays the hair on
    the slab, stretched out as it is.
    """
    soft = with_gravito_bending(straight_hair(DOWN, length_m, element_count), number)
    position = np.add(root, (THICKNESS_M, 0, 0))
    return replace(soft, root_position=position, air_drag=2 * mass_per_length(soft))


def onto_slab(tilt: float, downhill: Sequence[float]) -> Environment:
    """Gravity as on a slab that is tilted by that angle [rad] towards a direction in its face."""
    into = np.array((-1.0, 0.0, 0.0))
    return Environment(gravity=GRAVITY * (np.cos(tilt) * into + np.sin(tilt) * np.array(downhill)))


def play(
    client: Client, guides: Sequence[Guide], motion: Motion, points: int, substeps: int
) -> np.ndarray:
    """The strands in motion from rest, (frame, guide, point, 3) [m], in the head's axes."""
    with kept(client, guides) as groom:
        return animated(client, groom, motion, points, substeps)


def animated(
    client: Client,
    groom: Groom,
    motion: Motion,
    points: int,
    substeps: int = 1,
    environment: Environment | None = None,
) -> np.ndarray:
    """A groom's strands as of `play`."""
    options = {"points_per_guide": points, "substeps": substeps, "space": "head"}
    with client.open_head(groom, "lockstep", environment=environment, **options) as head:
        return np.stack([frame.positions for frame in head.play(motion)]).astype(np.float64)


@contextmanager
def kept(client: Client, guides: Sequence[Guide] = (), **content) -> Iterator[Groom]:
    """A groom for as long as the block lasts; arguments as those of `Client.create_groom`."""
    groom = client.create_groom(guides, display_name="mane experiment", **content)
    try:
        yield groom
    finally:
        client.delete_groom(groom)
