"""Bodies that hair meets: head, neck, shoulders, hands, clothes, props."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum

from numpy.typing import ArrayLike

from mane.errors import InvalidArgument
from mane.mesh import Mesh
from mane.pose import Pose, choice, vector


class Material(StrEnum):
    """What a surface is made of: how hair rubs on it. UNSPECIFIED lies in the middle."""

    UNSPECIFIED = "unspecified"
    SKIN = "skin"
    COTTON = "cotton"
    WOOL = "wool"
    SILK = "silk"
    LEATHER = "leather"
    POLISHED = "polished"


@dataclass(frozen=True, eq=False)
class EllipsoidBody:
    """An ellipsoid about the origin of the body's frame, axes along it.

    Attributes:
      radii_m: each in [1e-4, 100] [m], the largest at most 100 times the smallest, (3,).
    """

    radii_m: ArrayLike

    def __post_init__(self):
        object.__setattr__(self, "radii_m", vector("radii_m", self.radii_m, 3))


@dataclass(frozen=True, eq=False)
class CapsuleBody:
    """All points within `radius_m` of a segment.

    Attributes:
      a, b: its ends, body frame [m], (3,), within ±1000; the same twice make a ball.
      radius_m: in [1e-4, 100] [m].
    """

    a: ArrayLike
    b: ArrayLike
    radius_m: float

    def __post_init__(self):
        for name in ("a", "b"):
            object.__setattr__(self, name, vector(name, getattr(self, name), 3))


@dataclass(frozen=True, eq=False)
class Body:
    """A rigid solid that hair meets. What bends is several of them, one a bone.

    Attributes:
      name: `[a-z0-9]([a-z0-9_-]{0,61}[a-z0-9])?`, unique in its groom; `Pose.bodies` names it.
      shape: an `EllipsoidBody`, a `CapsuleBody`, or a `Mesh` in the body's frame, whose hair region
        is not used. The server mends what it can, closes holes, and refuses by name what bounds no
        solid.
      material: a `Material` or its value.
      friction: Coulomb's coefficient across the hair, in [0, 10]; None is that of `material`.
      friction_anisotropy: by how much it rises where hair slides towards its tip, and falls where
        it slides towards its root, in [0, 1]; None is that of `material`.
      moving: whether `Pose.bodies` may place it; else it is fixed to the head.
      pose: body -> head; its time is not used. Of a moving body: where it is on the head until it
        is placed. None is the identity.

    The server checks the ranges; its error names the body and the field.
    """

    name: str
    shape: EllipsoidBody | CapsuleBody | Mesh
    material: Material | str = Material.UNSPECIFIED
    friction: float | None = None
    friction_anisotropy: float | None = None
    moving: bool = False
    pose: Pose = field(default_factory=Pose)

    def __post_init__(self):
        object.__setattr__(self, "material", choice("material", Material, self.material))
        if not isinstance(self.shape, EllipsoidBody | CapsuleBody | Mesh):
            kind = type(self.shape).__name__
            raise InvalidArgument.of(
                "shape", f"is of class {kind}, must be an EllipsoidBody, a CapsuleBody or a Mesh"
            )


@dataclass(frozen=True)
class MeshReport:
    """What the server found in a mesh that hair meets, and what it made of it.

    Attributes:
      triangles: as given.
      holes: that were closed.
      inverted: whether every triangle faced inwards and was turned.
      max_error_m: largest error found of the distance to its surface, within 1 cm of it [m].
      bytes: memory of its distance field on the server.
    """

    triangles: int
    holes: int
    inverted: bool
    max_error_m: float
    bytes: int


@dataclass(frozen=True)
class ScalpContact:
    """That hair meets the scalp, and how it rubs there.

    Attributes:
      material, friction, friction_anisotropy: as in `Body`.
      mesh: of a scalp that is a mesh, as the server tells it; not sent.
    """

    material: Material | str = Material.UNSPECIFIED
    friction: float | None = None
    friction_anisotropy: float | None = None
    mesh: MeshReport | None = None

    def __post_init__(self):
        object.__setattr__(self, "material", choice("material", Material, self.material))


@dataclass(frozen=True)
class BodySummary:
    """What describes a body of a groom.

    Attributes:
      name: of the body.
      shape: `ellipsoid`, `capsule` or `mesh`.
      moving: whether `Pose.bodies` may place it.
      mesh: of a mesh, else None.
    """

    name: str
    shape: str
    moving: bool
    mesh: MeshReport | None = None
