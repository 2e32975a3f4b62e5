"""How the guides of a head are animated, and what beams are like."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

from mane.pose import choice
from mane.v1 import animation_pb2


class AnimationModel(StrEnum):
    """How the guides of a head are animated.

    SUPER_HELIX: elastic rods that meet the groom's bodies.
    BEAM: polylines whose segments swing each on its own, a level of detail below, at a fraction of
      the cost. They keep the nodes of the rest shape and stay out of an ellipsoid that stands for
      the scalp; of other bodies and of wisps they know nothing.
    """

    SUPER_HELIX = "super_helix"
    BEAM = "beam"


class BeamEquations(StrEnum):
    """Along which angles a segment turns.

    ACROSS: about an axis across the segment, chosen anew every step; alike on all sides.
    POLAR: zenith and azimuth about Y, as published.
    """

    ACROSS = "across"
    POLAR = "polar"


@dataclass(frozen=True)
class BeamMotion:
    """What beams of a head are like. None is the server's default.

    Attributes:
      segments: of every guide, all of one length, 2 to 64. None: as many as `epsilon` or
        `largest_turn_rad` has numbers, else one for each radian that guides turn by at rest, but 16
        to 64; `HairFrame.stepped_elements` over the guides tells how many.
      hold: factor on what holds segments in their directions at rest, 0 to 1000; 1. 0 is as
        published: hair that is only thrown about.
      equations: see `BeamEquations`.
      unbounded: the recurrences as published, which are stable only while forces are small.
      clamped: the first segment keeps its direction on the head; True unless given.
      avoid_head: nodes are turned out of the ellipsoid that stands for the scalp; True.
      alpha, near_m, epsilon: forces that press hair on the head count less near it: where the
        cosine of their angle with the outward normal is below `alpha` (-1 to 1; -0.75) and the
        segment is nearer than `near_m` (0 to 10; 0.02), they count `epsilon` times (0 to 1, by
        segment; empty for 1).
      largest_turn_rad: between a segment and the one before it, 0 to pi, by segment; empty for pi.
      fluctuation_rad: every ten time steps each segment turns by angles drawn evenly up to this,
        0 to 1.
      seed: of what is drawn.
      tip_response: what accelerates the last segment, per acceleration of the field it is in
        [1/m], 1e-3 to 1e4; others in proportion to their number. None swings about as hair does.
    """

    segments: int | None = None
    hold: float | None = None
    equations: BeamEquations | str = BeamEquations.ACROSS
    unbounded: bool = False
    clamped: bool | None = None
    avoid_head: bool | None = None
    alpha: float | None = None
    near_m: float | None = None
    epsilon: Sequence[float] = ()
    largest_turn_rad: Sequence[float] = ()
    fluctuation_rad: float = 0.0
    seed: int = 0
    tip_response: float | None = None


def model_value(model: AnimationModel | str) -> int:
    name = choice("model", AnimationModel, model).name
    return animation_pb2.AnimationModel.Value(f"ANIMATION_MODEL_{name}")


def from_model(value: int) -> AnimationModel:
    """What an API's number says; of an older server, what it means."""
    beam = value == animation_pb2.ANIMATION_MODEL_BEAM
    return AnimationModel.BEAM if beam else AnimationModel.SUPER_HELIX


def beam_motion(value: BeamMotion | None) -> animation_pb2.BeamMotion | None:
    if value is None:
        return None
    equations = choice("beam.equations", BeamEquations, value.equations).name
    return animation_pb2.BeamMotion(
        segments=value.segments or 0,
        hold=value.hold,
        equations=animation_pb2.BeamEquations.Value(f"BEAM_EQUATIONS_{equations}"),
        unbounded=value.unbounded,
        clamped=value.clamped,
        avoid_head=value.avoid_head,
        alpha=value.alpha,
        near_m=value.near_m,
        epsilon=value.epsilon,
        largest_turn_rad=value.largest_turn_rad,
        fluctuation_rad=value.fluctuation_rad,
        seed=value.seed,
        tip_response=value.tip_response,
    )


def set_model(model: AnimationModel | str, beam: BeamMotion | None) -> animation_pb2.SetModel:
    return animation_pb2.SetModel(model=model_value(model), beam=beam_motion(beam))
