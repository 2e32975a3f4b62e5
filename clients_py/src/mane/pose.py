"""What drives a head of hair: timed head poses, and the air and gravity around it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from mane.errors import InvalidArgument

IDENTITY = (0.0, 0.0, 0.0, 1.0)


@dataclass(frozen=True, eq=False)
class Pose:
    """Where the head is at one moment: world = orientation * head + position.

    Attributes:
      time_s: the caller's clock, any origin [s].
      position: origin of the head frame in world axes [m], (3,), each within ±1e6.
      orientation: rotation head -> world, quaternion (x, y, z, w), (4,). A norm within 1 % of one
        is normalised by the server; anything else is refused.
      bodies: where moving bodies of the groom are at this time, by name: poses body -> world, whose
        times are not used. One that is not named stays where it last was in the world; one that
        never was moves along with the head.
    """

    time_s: float = 0.0
    position: ArrayLike = (0.0, 0.0, 0.0)
    orientation: ArrayLike = IDENTITY
    bodies: Mapping[str, Pose] = field(default_factory=dict)

    def __post_init__(self):
        object.__setattr__(self, "time_s", float(self.time_s))
        object.__setattr__(self, "bodies", dict(self.bodies))
        object.__setattr__(self, "position", vector("position", self.position, 3))
        object.__setattr__(self, "orientation", vector("orientation", self.orientation, 4))


@dataclass(frozen=True, eq=False)
class Environment:
    """What surrounds the hair. None leaves a value as it is.

    Attributes:
      wind_velocity: mean air velocity, world [m/s], (3,), each within ±100.
      gravity: world [m/s^2], (3,), each within ±1000; at first (0, -9.81, 0).
      internal_friction_scale, air_drag_scale: factors on every guide's own, 0 to 1000; at first 1.
      gust_strength: rms of the relative change of the mean wind's speed, 0 to 2; at first 0.
      gust_period_s: middle period of gusts [s], 0.1 to 100; at first 2.
      turbulence_speed: rms speed of eddies [m/s], 0 to 50; at first 0.
      turbulence_size_m: their middle size [m], 0.01 to 100; at first 0.3.
      wind_seed: decides gusts and eddies; at first 0.
      detail_tolerance_m: how far tips may be off [m], 0 to 10, where hair that hardly bends is
        computed with fewer elements, without a jump; at first 0, for all elements. For heads far
        away.
    """

    wind_velocity: ArrayLike | None = None
    gravity: ArrayLike | None = None
    internal_friction_scale: float | None = None
    air_drag_scale: float | None = None
    gust_strength: float | None = None
    gust_period_s: float | None = None
    turbulence_speed: float | None = None
    turbulence_size_m: float | None = None
    wind_seed: int | None = None
    detail_tolerance_m: float | None = None


def choice(field: str, enum_class, value):
    """`value` as a member of a string enum. InvalidArgument names the members where it is none."""
    try:
        return enum_class(value.lower() if isinstance(value, str) else value)
    except ValueError:
        allowed = ", ".join(member.value for member in enum_class)
        raise InvalidArgument.of(field, f"is {value!r}, must be one of {allowed}") from None


def vector(name: str, values: ArrayLike, size: int) -> np.ndarray:
    """`values` as (size,) float64. InvalidArgument naming the field where the shape is another."""
    array = np.array(values, dtype=np.float64)
    if array.shape != (size,):
        raise InvalidArgument.of(name, f"has shape {array.shape}, must be ({size},)")
    return array
