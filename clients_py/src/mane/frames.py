"""Hair frames and their decoding from the three formats of the API."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from scipy.spatial.transform import Rotation

from mane.beams import AnimationModel
from mane.errors import Internal
from mane.helix import Strands
from mane.pose import Pose


class FrameFormat(StrEnum):
    """How frames travel. What arrives are positions in every case.

    FLOAT32: positions as they are, 12 bytes a point.
    QUANTIZED16: 16-bit positions in each strand's box, 6 bytes a point; off by at most 1/131070 of
      the box's size along each axis.
    GENERALIZED: the strands' coordinates, 12 bytes an element, 16 of WOUND guides; the client
      rebuilds the strands. Exact, and the smallest for guides.
    """

    FLOAT32 = "float32"
    QUANTIZED16 = "quantized16"
    GENERALIZED = "generalized"


class Space(StrEnum):
    """The axes of `Frame.positions`: the world's, or those of the frame's head pose."""

    WORLD = "world"
    HEAD = "head"


@dataclass(frozen=True)
class Diagnostics:
    """What the hair of a head holds at one moment, sums over its guides.

    Attributes:
      kinetic_energy_j: [J].
      elastic_energy_j: [J]; 0 in the natural shape.
      gravity_energy_j: of weight [J]; 0 where every point lies as high as its root.
      largest_angle_rad: of an element, twist and bends together.
      imbalance: of the guide furthest from static equilibrium: the largest moment of weight and
        elasticity that is left about any axis of any element, over the largest of: what its weight
        can exert, rho S |g| L^2 / 2; what its natural shape takes, (EI)_i |kappa^n_i|; the smallest
        (EI)_i / L. At rest as small as the rounding of float32 angles.
    """

    kinetic_energy_j: float
    elastic_energy_j: float
    gravity_energy_j: float
    largest_angle_rad: float
    imbalance: float


@dataclass(frozen=True, eq=False)
class Frame:
    """Hair at one moment.

    Attributes:
      index: 1, 2, 3 ... as the server computed them.
      time_s: the caller's clock: the moment of the head pose that the frame shows [s].
      head_pose: where the roots are clamped.
      positions: points at equal arc length, root first, (guide, point, 3) float32 [m], in the
        `Space` that the head was opened with.
      skipped: frames between the last one that you were given and this one, replaced because they
        were older. Always 0 in LOCKSTEP.
      newest_pose_time_s: newest pose that the server had when it computed the frame, the caller's
        clock [s].
      step_ms: time that the server spent on the frame [ms].
      repaired_guides: guides that the server put back to rest because of a fault of its own.
      stepped_elements: elements that the hair is computed with, of all guides: fewer than it has
        where `Environment.detail_tolerance_m` allows it. Of BEAM, segments.
      model: with which the frame was computed.
      diagnostics: energies and the like; None unless the head was opened with `diagnostics`, and
        in frames of BEAM.
      angles: coordinates of each guide, float32 [rad]: (element, 3) twist, bend 1, bend 2; of WOUND
        guides (element, 4) length times (u, b1, b2, xi) of `mane.helix`. None unless the format is
        GENERALIZED.
    """

    index: int
    time_s: float
    head_pose: Pose
    positions: np.ndarray
    skipped: int = 0
    newest_pose_time_s: float = 0.0
    step_ms: float = 0.0
    repaired_guides: int = 0
    stepped_elements: int = 0
    diagnostics: Diagnostics | None = None
    angles: tuple[np.ndarray, ...] | None = None
    model: AnimationModel = AnimationModel.SUPER_HELIX


class FrameDecoder:
    """Turns `HairFrame.data` into positions. Immutable and thread-safe.

    Args:
      format: what the server sends.
      guide_count, points_per_guide: shape of the positions.
      space: WORLD or HEAD. It matters for GENERALIZED only: the other formats arrive in it.
      strands: the groom's; needed for GENERALIZED.
    """

    def __init__(
        self,
        format: FrameFormat,
        guide_count: int,
        points_per_guide: int,
        space: Space = Space.WORLD,
        strands: Strands | None = None,
    ):
        self._format = FrameFormat(format)
        self._shape = (guide_count, points_per_guide, 3)
        self._space = Space(space)
        self._strands = strands
        self._strand_dtype = np.dtype([("box", "<f4", (2, 3)), ("u", "<u2", (points_per_guide, 3))])
        if self._format == FrameFormat.GENERALIZED and strands is None:
            raise ValueError("strands: needed to rebuild generalized coordinates")

    def decode(
        self, data: bytes, head_pose: Pose
    ) -> tuple[np.ndarray, tuple[np.ndarray, ...] | None]:
        """Positions and, for GENERALIZED, coordinates of each guide; as in `Frame`.

        Raises Internal where `data` has not the size that the format says.
        """
        if len(data) != self._size():
            raise Internal(f"a frame of {len(data)} bytes arrived, expected {self._size()}")
        if self._format == FrameFormat.FLOAT32:
            return np.frombuffer(data, "<f4").reshape(self._shape).copy(), None
        if self._format == FrameFormat.QUANTIZED16:
            return self._dequantized(data), None
        coordinates = np.frombuffer(data, "<f4").copy()
        return self._rebuilt(coordinates, head_pose), self._strands.by_guide(coordinates)

    def _size(self) -> int:
        guides, points, _ = self._shape
        if self._format == FrameFormat.FLOAT32:
            return guides * points * 12
        if self._format == FrameFormat.QUANTIZED16:
            return guides * self._strand_dtype.itemsize
        return self._strands.coordinate_count * 4

    def _dequantized(self, data: bytes) -> np.ndarray:
        strands = np.frombuffer(data, self._strand_dtype)
        box = strands["box"].astype(np.float64)
        low, high = box[:, :1], box[:, 1:]
        return (low + (high - low) * (strands["u"] / 65535.0)).astype(np.float32)

    def _rebuilt(self, coordinates: np.ndarray, head_pose: Pose) -> np.ndarray:
        positions = self._strands.positions(coordinates.astype(np.float64), self._shape[1])
        if self._space == Space.WORLD:
            rotation = Rotation.from_quat(head_pose.orientation).as_matrix()
            positions = positions @ rotation.T + head_pose.position
        return positions.astype(np.float32)
