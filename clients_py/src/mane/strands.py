"""Strands of other programs, as polylines, and what an import made of them."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from mane.errors import InvalidArgument
from mane.groom import HairType
from mane.pose import vector


@dataclass(frozen=True)
class HairProperties:
    """Section, material and damping of hair; ranges as in `Guide`. None: taken from elsewhere.

    Attributes:
      radius_1_m, radius_2_m: semi-axes of the elliptic section along n1 and n2 [m].
      young_modulus_pa: E [Pa].
      poisson_ratio: in (-1, 0.5].
      density_kg_m3: [kg/m^3].
      internal_friction: gamma of [SH06] (5d) [kg m^3/s].
      air_drag: nu of [SH06] (5a) [kg/(m s)].
    """

    radius_1_m: float | None = None
    radius_2_m: float | None = None
    young_modulus_pa: float | None = None
    poisson_ratio: float | None = None
    density_kg_m3: float | None = None
    internal_friction: float | None = None
    air_drag: float | None = None


@dataclass(frozen=True, eq=False)
class Strand:
    """A polyline along a hair as it looks at rest, under gravity and on an upright head.

    Attributes:
      points: head frame, root first [m], (k, 3); k from 2 to 1000, usually 25 to 100, at any
        spacing. They travel as float32.
      root_frame: material frame at the root as in `Guide`, (4,); None lets it follow the points.
      properties: those of this strand; what is None is that of `ImportOptions`.
    """

    points: ArrayLike
    root_frame: ArrayLike | None = None
    properties: HairProperties = field(default_factory=HairProperties)

    def __post_init__(self):
        points = np.asarray(self.points, dtype=np.float64)
        if points.ndim != 2 or points.shape[1] != 3:
            raise InvalidArgument.of("points", f"has shape {points.shape}, must be (k, 3)")
        object.__setattr__(self, "points", points)
        if self.root_frame is not None:
            object.__setattr__(self, "root_frame", vector("root_frame", self.root_frame, 4))


@dataclass(frozen=True)
class ImportOptions:
    """How strands become guides: a fit by helical elements, then natural curvatures with which the
    fitted shape is at rest under its weight.

    Attributes:
      hair_type: the preset whose section, material and damping the strands have; its curl is not
        used.
      properties: what differs from the preset.
      element_count: helical elements of every strand, 1 to 64; with a bound, the most that one may
        have. 0 is 20.
      error_bound_m: largest distance allowed of a point from the fitted strand [m]; every strand
        gets the fewest elements that keep within it, and one that cannot is reported. 0: none.
      noise_m: standard deviation of the points' coordinates [m]; None estimates it.
      hold: False takes the fitted shapes for the natural ones, as for strands that were modelled
        without weight; they then sag.
      max_stiffness_factor: hair too soft for its shape buckles; its Young's modulus is raised by
        the least factor that holds it, at most this one, 1 to 1000. None is 4; 100 for the guides of
        a style.
      stability_margin: how far from buckling a held shape must be, 0 to 0.9. None is 0.1.
      wisp_radius_m: of all guides, as in `Guide`.
    """

    hair_type: HairType | str = HairType.CAUCASIAN_WAVY
    properties: HairProperties = field(default_factory=HairProperties)
    element_count: int = 0
    error_bound_m: float = 1e-3
    noise_m: float | None = None
    hold: bool = True
    max_stiffness_factor: float | None = None
    stability_margin: float | None = None
    wisp_radius_m: float = 0.0


@dataclass(frozen=True)
class ImportSummary:
    """What an import did, over all strands.

    Attributes:
      strand_count, point_count: that were imported.
      largest_fit_distance_m, rms_fit_distance_m: of given points from the fitted strands [m].
      bound_missed_count: strands that miss `error_bound_m`.
      not_held_count: strands whose shape does not hold.
      largest_tip_deviation_m: of a tip, at rest after a small push, from where it was fitted [m].
      largest_stiffness_factor: that was applied.
    """

    strand_count: int
    point_count: int
    largest_fit_distance_m: float
    rms_fit_distance_m: float
    bound_missed_count: int
    not_held_count: int
    largest_tip_deviation_m: float
    largest_stiffness_factor: float


@dataclass(frozen=True, eq=False)
class ImportReport:
    """An import strand by strand; every array is (strand,), in the order of the guides.

    Attributes:
      summary: over all strands.
      options: as they were applied.
      element_counts: helical elements.
      largest_fit_distances, rms_fit_distances: of given points from the fitted strand [m].
      bounds_met: whether within the bound; True without one.
      held: whether the shape is a lasting rest shape.
      stiffness_factors: factor on Young's modulus that was applied.
      needed_stiffness_factors: the least that holds the shape; 0 where `hold` is False.
      tip_deviations, largest_deviations: distances at rest from the fitted shape, after a small
        push to the worse side [m]: of the tip, and of the farthest end of an element.
    """

    summary: ImportSummary
    options: ImportOptions
    element_counts: np.ndarray
    largest_fit_distances: np.ndarray
    rms_fit_distances: np.ndarray
    bounds_met: np.ndarray
    held: np.ndarray
    stiffness_factors: np.ndarray
    needed_stiffness_factors: np.ndarray
    tip_deviations: np.ndarray
    largest_deviations: np.ndarray
