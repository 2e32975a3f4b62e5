"""Strands for experiments, and their rest shapes and motion on a server."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace

import numpy as np

from mane.client import Client
from mane.groom import Groom, Guide, frame_along
from mane.motion import Motion

GRAVITY = 9.81
"""The server's own, [m/s^2]."""

UP, DOWN, ASIDE = (0.0, 1.0, 0.0), (0.0, -1.0, 0.0), (1.0, 0.0, 0.0)


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


def play(
    client: Client, guides: Sequence[Guide], motion: Motion, points: int, substeps: int
) -> np.ndarray:
    """The strands in motion from rest, (frame, guide, point, 3) [m], in the head's axes."""
    options = {"points_per_guide": points, "substeps": substeps, "space": "head"}
    with (
        kept(client, guides) as groom,
        client.open_head(groom, "lockstep", **options) as head,
    ):
        return np.stack([frame.positions for frame in head.play(motion)]).astype(np.float64)


@contextmanager
def kept(client: Client, guides: Sequence[Guide] = (), **content) -> Iterator[Groom]:
    """A groom for as long as the block lasts; arguments as those of `Client.create_groom`."""
    groom = client.create_groom(guides, display_name="mane experiment", **content)
    try:
        yield groom
    finally:
        client.delete_groom(groom)
