"""Grooms: hair assets made of a scalp and guide strands, as numpy arrays."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial.transform import Rotation

from mane.errors import InvalidArgument
from mane.mesh import Mesh
from mane.pose import IDENTITY, choice, vector

if TYPE_CHECKING:
    from mane.bodies import Body, BodySummary, ScalpContact
    from mane.hairs import Hairs
    from mane.strands import ImportSummary


class HairType(StrEnum):
    """Presets of [SH06] Appendix B."""

    ASIAN_SMOOTH = "asian_smooth"
    CAUCASIAN_WAVY = "caucasian_wavy"
    CAUCASIAN_CURLY = "caucasian_curly"
    AFRICAN_FUZZY = "african_fuzzy"


class StrandModel(StrEnum):
    """How a strand's shape is described by the unknowns of its N elements.

    SUPER_HELIX: [SH06]: each element has constant material curvatures and twist. Right for any hair
      that its elements can follow: two of them, better three or four, for each turn of natural
      curl.
    WOUND: for hair that winds more often: the Super-Helix lies along the axis of the natural coil,
      and the coil around it twists and stretches. Five to ten elements are enough for any number of
      turns. Every element needs natural curvature, which should change little to the next.
    """

    SUPER_HELIX = "super-helix"
    WOUND = "wound"


@dataclass(frozen=True, eq=False, kw_only=True)
class Guide:
    """One guide strand: a Super-Helix of N elements, each of constant natural curvatures and twist.

    Attributes:
      root_position: clamped end, head frame [m], (3,).
      root_frame: material frame (n0, n1, n2) at the root, quaternion (x, y, z, w) that takes its
        coordinates to the head frame, (4,). n0, the image of (1, 0, 0), is the direction in which
        the strand leaves the scalp; `frame_along` makes one.
      length_m: strand length [m], in (0, 5]. May be left 0 where `element_lengths_m` is given.
      element_count: N, 1 to 256. May be left 0 where `element_lengths_m` is given.
      element_lengths_m: root to tip [m], (N,); empty for N equal ones.
      radius_1_m, radius_2_m: semi-axes of the section along n1 and n2 [m], in [1e-6, 1e-2].
      young_modulus_pa: in [1e4, 1e13].
      poisson_ratio: in (-1, 0.5].
      density_kg_m3: in [1, 1e5]; hair: 1300.
      internal_friction: gamma of [SH06] (5d) [kg m^3/s], in [0, 1]; clumps of hair: 5e-11 to 5e-10.
      air_drag: nu of [SH06] (5a) [kg/(m s)], in [0, 10]; disciplined hair 5e-6, fuzzy hair 5e-5.
      natural_twist, natural_curvature_1, natural_curvature_2: per element, root to tip [rad/m],
        within ±1e5: N numbers, or one for all. Component i turns about n_i.
      model: a `StrandModel` or its value.
      wisp_radius_m: of the wisp of hair that the guide stands for, which other guides' wisps stay
        out of, in [0, 0.1] [m]; 0 for none.

    The server checks the ranges; its error names the guide and the field.
    """

    root_position: ArrayLike = (0.0, 0.0, 0.0)
    root_frame: ArrayLike = IDENTITY
    length_m: float = 0.0
    element_count: int = 0
    element_lengths_m: ArrayLike = ()
    radius_1_m: float
    radius_2_m: float
    young_modulus_pa: float
    poisson_ratio: float
    density_kg_m3: float
    internal_friction: float
    air_drag: float
    natural_twist: ArrayLike = 0.0
    natural_curvature_1: ArrayLike = 0.0
    natural_curvature_2: ArrayLike = 0.0
    model: StrandModel | str = StrandModel.SUPER_HELIX
    wisp_radius_m: float = 0.0

    def __post_init__(self):
        object.__setattr__(self, "root_position", vector("root_position", self.root_position, 3))
        object.__setattr__(self, "root_frame", vector("root_frame", self.root_frame, 4))
        object.__setattr__(self, "model", choice("model", StrandModel, self.model))
        lists = ("element_lengths_m", "natural_twist", "natural_curvature_1", "natural_curvature_2")
        for name in lists:
            values = np.atleast_1d(np.array(getattr(self, name), dtype=np.float64))
            if values.ndim != 1:
                raise InvalidArgument.of(name, f"has shape {values.shape}, must be a list")
            object.__setattr__(self, name, values)

    def resolved_element_lengths_m(self) -> np.ndarray:
        """Element lengths, given or equal, (N,) [m]."""
        if self.element_lengths_m.size:
            return self.element_lengths_m
        return np.full(self.element_count, self.length_m / self.element_count)

    def resolved_natural(self) -> np.ndarray:
        """Natural twist and curvatures 1 and 2 of each element, (N, 3) [rad/m]."""
        lists = (self.natural_twist, self.natural_curvature_1, self.natural_curvature_2)
        count = len(self.resolved_element_lengths_m())
        return np.stack([np.broadcast_to(values, count) for values in lists], axis=1)


@dataclass(frozen=True, eq=False)
class Ellipsoid:
    """An ellipsoid scalp with axes along the head frame.

    Hair grows where the outward normal is within `cap_angle` of `cap_axis`.

    Attributes:
      radii_m: half axes, each in [1e-3, 10] [m], (3,).
      center: head frame [m], (3,).
      cap_axis: direction of the middle of the hair, (3,).
      cap_angle: in (0, pi] [rad]; 0 means the whole ellipsoid.
    """

    radii_m: ArrayLike
    center: ArrayLike = (0.0, 0.0, 0.0)
    cap_axis: ArrayLike = (0.0, 1.0, 0.0)
    cap_angle: float = 0.0

    def __post_init__(self):
        for name in ("radii_m", "center", "cap_axis"):
            object.__setattr__(self, name, vector(name, getattr(self, name), 3))


@dataclass(frozen=True)
class GuideGeneration:
    """Asks the server to place and shape guides on the scalp. Same numbers, same bits.

    Attributes:
      hair_type: a `HairType` or its value, such as `"caucasian_wavy"`.
      guide_count: 1 to the server's limit; placed by blue noise over the hair region.
      length_m: in (0, 5] [m].
      element_count: elements per guide, of graded lengths, shortest where hair bends most; 0 lets
        the server choose, 3 to 20, by hair type, length and `error_target`.
      seed: of everything random.
      curl_variation: relative size of the variation of natural curvatures and twist along each
        strand, in [0, 1]; None is the server's default, 0.05.
      root_droop: how far roots lean from the scalp's normal toward the ground, 0 (along the normal)
        to 1; None is the server's default, 0.3.
      error_target: with element_count 0, how far the tip of a guide may be from where infinitely
        many elements would have it, at rest and in a moderate shake, rms, relative to its length.
        In [1e-3, 0.2]; None is the server's default, 0.02. Hair that coils too tightly for 20
        elements to reach it gets 20.
      model: a `StrandModel` or its value; None lets the server choose: WOUND for hair that turns at
        least five times, and more than N / 2 times.
      wisp_radius_m: of all guides, as in `Guide`.
    """

    hair_type: HairType | str
    guide_count: int
    length_m: float
    element_count: int = 0
    seed: int = 0
    curl_variation: float | None = None
    root_droop: float | None = None
    error_target: float | None = None
    model: StrandModel | str | None = None
    wisp_radius_m: float = 0.0


@dataclass(frozen=True, eq=False)
class Groom:
    """A groom that the server holds. Its content never changes.

    Attributes:
      name: `grooms/{groom}`.
      display_name: free text.
      create_time: UTC.
      guide_count: guides.
      element_count: elements of all guides together.
      longest_guide_m: length of the longest guide [m].
      hair_type: the preset that generated it; None for uploaded guides.
      seed: the seed that generated it.
      etag: digest of the content: equal content, equal etag.
      has_scalp: whether it holds a scalp.
      import_summary: an `ImportSummary` for a groom made from strands, else None.
      body_count: bodies that hair meets, the scalp not among them.
      body_summaries: a `BodySummary` of each; `list_grooms` leaves them out.
      scalp_contact: a `ScalpContact` where hair meets the scalp, with its numbers; else None.
      hair_count, hair_point_count: hairs that ride on the guides, and their control points.
      guides, scalp, bodies, hairs: the content; only `export_groom` fills them. `hairs` is a
        `mane.hairs.Hairs`, or None where there are none.
    """

    name: str
    display_name: str = ""
    create_time: datetime | None = None
    guide_count: int = 0
    element_count: int = 0
    longest_guide_m: float = 0.0
    hair_type: HairType | None = None
    seed: int = 0
    etag: str = ""
    has_scalp: bool = False
    import_summary: ImportSummary | None = None
    guides: tuple[Guide, ...] = ()
    scalp: Mesh | Ellipsoid | None = None
    body_count: int = 0
    body_summaries: tuple[BodySummary, ...] = ()
    scalp_contact: ScalpContact | None = None
    bodies: tuple[Body, ...] = ()
    hair_count: int = 0
    hair_point_count: int = 0
    hairs: Hairs | None = None


@dataclass(frozen=True, eq=False)
class RestShape:
    """Static equilibrium of every guide with the head at rest.

    Attributes:
      positions: points at equal arc length, root first, (guide, point, 3) float64, head frame [m].
      curvatures: of each guide, float64 [rad/m]: (element, 3) twist and two curvatures; of WOUND
        guides (element, 4) changes of the coil's twist, two curvatures of its axis, and change of
        the strain towards the hair's tangent, see `mane.helix`.
      residuals: largest unbalanced generalized force over the weight's largest one, (guide,); at
        most 1e-6 where the solver converged.
    """

    positions: np.ndarray
    curvatures: tuple[np.ndarray, ...]
    residuals: np.ndarray


def frame_along(direction: ArrayLike, n1: ArrayLike | None = None) -> np.ndarray:
    """A root frame whose n0 points along `direction` (3,), as a quaternion (4,).

    Without `n1` it is the shortest turn that takes (1, 0, 0) there. With it, n1 is the part of that
    vector across `direction`. InvalidArgument for a zero direction or a parallel `n1`.
    """
    n0 = _unit("direction", vector("direction", direction, 3))
    if n1 is None:
        if n0[0] < -1 + 1e-12:
            return np.array([0.0, 0.0, 1.0, 0.0])  # Half a turn about z.
        return _unit("direction", np.array([0.0, -n0[2], n0[1], 1 + n0[0]]))
    across = vector("n1", n1, 3)
    across = _unit("n1", across - n0 * (n0 @ across))
    return Rotation.from_matrix(np.column_stack([n0, across, np.cross(n0, across)])).as_quat()


def _unit(name: str, values: np.ndarray) -> np.ndarray:
    norm = np.linalg.norm(values)
    if not (np.isfinite(norm) and norm > 1e-12):
        raise InvalidArgument.of(name, f"{values} has no direction")
    return values / norm
