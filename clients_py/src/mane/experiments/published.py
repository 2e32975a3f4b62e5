"""What the scenes of [AUK92] section 3 share: its numbers in metres, a head, hair and pictures.

Published numbers have no units, time steps are 0.1 and fields a few hundred. Here a length of 1 is
`UNIT_M`, a frame is one step of 1/60 s, for the server takes none longer, and fields are
accelerations [m/s^2] of the same numbers, given as gravity. What counts is how far a frame turns a
segment, dt^2 lambda_i |F|, and that is as published: lambda is larger by what dt^2 is smaller.
Axes are Mane's: what [AUK92] has along +X, the face, is along +Z.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from mane.beams import BeamMotion
from mane.client import Client
from mane.experiments.scene import straight_hair
from mane.groom import Ellipsoid, Groom, Guide, frame_along
from mane.mesh import Mesh
from mane.pose import Environment, Pose

SEGMENTS = 18
STEP = 0.1
RATE_HZ = 60.0
UNIT_M = 0.0125
"""A published length of 1: 18 segments of it are 22.5 cm, and a head of 6 x 8 x 7 is a head."""
HEAD = Ellipsoid(UNIT_M * np.array((6.0, 8.0, 7.0)))
HULL_MARGIN = 1e-4
"""By which the server makes an ellipsoid smaller than the innermost node of a beam at rest."""
RADII_M = HEAD.radii_m * (1 - HULL_MARGIN)
"""Of the ellipsoid that beams keep out of: hair's roots are on the head."""
TURNS_AT = 16
"""Frame in which the wind of Figure 10 turns."""
_STIFF_PA = 1e13  # So stiff that hair rests in its natural shape.
_LONGITUDES, _LATITUDES = 96, 48
_NOSE = 0.16  # Of the drawn head, relative to its half axis.


def tip_response(segment_length: float = 1.0) -> float:
    """lambda_k [1/m] of a published length of segments, 3 / (2 k^2 d), for steps of 1/60 s."""
    return 1.5 / (SEGMENTS**2 * segment_length) * (STEP * RATE_HZ) ** 2


def push(segment_length: float = 1.0) -> np.ndarray:
    """dt^2 lambda_i, what a field of 1 turns segment i by in a frame [rad], (segment,)."""
    segment = np.arange(1, SEGMENTS + 1)
    return 1.5 * STEP**2 * segment / (SEGMENTS**3 * segment_length)


def as_published(segment_length: float = 1.0, **changes) -> BeamMotion:
    """Hair that nothing holds, bounds or clamps, whose angles are zenith and azimuth. `changes` are
    fields of `BeamMotion`."""
    motion = BeamMotion(
        segments=SEGMENTS,
        hold=0.0,
        equations="polar",
        unbounded=True,
        clamped=False,
        avoid_head=False,
        alpha=-1.0,
        tip_response=tip_response(segment_length),
    )
    return replace(motion, **changes)


def gust(frames: int) -> np.ndarray:
    """The wind of Figure 10, (frame, 3): from the face, and then, of a sudden, down."""
    before, after = (0.0, 0.0, -200.0), (0.0, -250.0, -20.0)
    return np.array([before if frame < TURNS_AT else after for frame in range(1, frames + 1)])


def pores(count: int, axis: Sequence[float], angle: float) -> np.ndarray:
    """Zeniths and azimuths of `count` pores, spread evenly over a cap of the ball, (pore, 2)."""
    index = np.arange(count)
    cosine = 1 - (1 - np.cos(angle)) * (index + 0.5) / count
    sine, turn = np.sqrt(1 - cosine**2), np.pi * (3 - 5**0.5) * index
    about = np.stack([cosine, sine * np.cos(turn), sine * np.sin(turn)], axis=1)
    out = Rotation.from_quat(frame_along(axis)).apply(about)
    return np.stack([np.arccos(out[:, 1]), np.arctan2(out[:, 0], out[:, 2])], axis=1)


def falling_hair(zenith: float, azimuth: float, segment_length: float, fall: float) -> Guide:
    """Hair that stands up from the head at these angles and whose segments then bend down, the more
    the larger `fall` is. It rests as it is, whatever it weighs."""
    out = np.array(
        (np.sin(zenith) * np.sin(azimuth), np.cos(zenith), np.sin(zenith) * np.cos(azimuth))
    )
    normal = out / HEAD.radii_m
    tilts = [np.arctan2(np.hypot(normal[0], normal[2]), normal[1])]
    for _ in range(SEGMENTS):
        tilts.append(np.arctan2(np.sin(tilts[-1]), np.cos(tilts[-1]) - fall))
    d = UNIT_M * segment_length
    return replace(
        straight_hair((0, 1, 0), SEGMENTS * d, SEGMENTS),
        root_position=HEAD.radii_m * out,
        root_frame=frame_along(normal, n1=(0, -1, 0)),
        young_modulus_pa=_STIFF_PA,
        natural_curvature_2=np.diff(tilts) / d,
    )


def play(client: Client, groom: Groom, fields: Sequence, beam: BeamMotion) -> np.ndarray:
    """Nodes of beams in fields that change from frame to frame, (frame + 1, guide, node, 3) [m],
    from where they rest and stand still."""
    airless = Environment(air_drag_scale=0.0)
    options = {"points_per_guide": SEGMENTS + 1, "model": "beam", "beam": beam}
    with client.open_head(groom, "lockstep", environment=airless, **options) as head:
        frames = [head.step(Pose(0.0)).positions]
        for frame, field in enumerate(fields, 1):
            head.set_environment(Environment(gravity=field))
            frames.append(head.step(Pose(frame / RATE_HZ)).positions)
    return np.stack(frames).astype(np.float64)


def directions(nodes: np.ndarray) -> np.ndarray:
    """Unit vectors along segments, (..., segment, 3)."""
    steps = np.diff(nodes, axis=-2)
    return steps / np.linalg.norm(steps, axis=-1, keepdims=True)


def level(nodes: np.ndarray) -> np.ndarray:
    """E of the ellipsoid that beams keep out of, (...): below 0 inside."""
    return ((nodes / RADII_M) ** 2).sum(axis=-1) - 1


def turns(nodes: np.ndarray) -> np.ndarray:
    """Angles between segments and those before them [rad], (..., segment - 1)."""
    e = directions(nodes)
    across = np.linalg.norm(np.cross(e[..., :-1, :], e[..., 1:, :]), axis=-1)
    return np.arctan2(across, (e[..., :-1, :] * e[..., 1:, :]).sum(axis=-1))


def inflections(nodes: np.ndarray) -> np.ndarray:
    """How often curves bend the other way, seen from the side, (...)."""
    e = directions(nodes)
    bends = np.cross(e[..., :-1, :], e[..., 1:, :])[..., 0]
    signs = np.where(np.abs(bends) > 1e-3, np.sign(bends), 0).reshape(-1, bends.shape[-1])
    counts = [np.count_nonzero(np.diff(row[row != 0])) for row in signs]
    return np.array(counts).reshape(bends.shape[:-1])


def drawn_head() -> Mesh:
    """The ellipsoid, with a nose that tells where its face is."""
    longitude, latitude = np.meshgrid(
        2 * np.pi * np.arange(_LONGITUDES) / _LONGITUDES,
        np.pi * np.arange(_LATITUDES + 1) / _LATITUDES,
    )
    ball = np.stack(
        [
            np.sin(latitude) * np.sin(longitude),
            np.cos(latitude),
            np.sin(latitude) * np.cos(longitude),
        ],
        axis=-1,
    ).reshape(-1, 3)
    nose = np.exp(-(((ball[:, 0] / 0.13) ** 2) + ((ball[:, 1] + 0.12) / 0.18) ** 2)) * (
        ball[:, 2] > 0
    )
    points = RADII_M * ball
    points[:, 2] += _NOSE * RADII_M[2] * nose
    row, column = np.mgrid[:_LATITUDES, :_LONGITUDES]
    a, b = row * _LONGITUDES + column, row * _LONGITUDES + (column + 1) % _LONGITUDES
    c, d = a + _LONGITUDES, b + _LONGITUDES
    quads = np.stack([a, c, d, a, d, b], axis=-1)
    return Mesh(points, quads.reshape(-1, 3))
