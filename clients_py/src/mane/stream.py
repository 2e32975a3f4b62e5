"""What a head's stream says: messages, decoding, acknowledgements.

Nothing here does input or output; `mane.heads` carries the messages.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, replace
from enum import StrEnum

from mane import beams, messages, value_messages
from mane.beams import AnimationModel, BeamMotion
from mane.frames import Diagnostics, Frame, FrameDecoder, FrameFormat, Space
from mane.helix import Strands
from mane.pose import Environment, Pose, choice
from mane.v1 import animation_pb2

_FORMATS = {
    FrameFormat.FLOAT32: animation_pb2.FRAME_FORMAT_POSITIONS_FLOAT32,
    FrameFormat.QUANTIZED16: animation_pb2.FRAME_FORMAT_POSITIONS_QUANTIZED16,
    FrameFormat.GENERALIZED: animation_pb2.FRAME_FORMAT_GENERALIZED,
}
_SPACES = {Space.WORLD: animation_pb2.SPACE_WORLD, Space.HEAD: animation_pb2.SPACE_HEAD}

# A REALTIME stream that broke for one of these goes on where it was, by its resume token. A proxy
# reports a server that died as CANCELLED.
RESUMABLE = ("UNAVAILABLE", "CANCELLED")

# REALTIME: poses that wait for a stalled connection, at most about.
POSE_LIMIT = 16


class Pacing(StrEnum):
    """How simulated time passes.

    REALTIME: the server's clock ticks; the newest frame wins and a slow reader skips some.
    LOCKSTEP: every pose yields exactly one frame; the same messages give the same bits.
    """

    REALTIME = "realtime"
    LOCKSTEP = "lockstep"


class NoticeCode(StrEnum):
    """LATE: the server missed deadlines. DRAINING: it is about to stop. NO_POSES: none came for
    over a second. MODEL: the server changed the head's animation model, or kept it although it was
    asked to change it."""

    UNSPECIFIED = "unspecified"
    LATE = "late"
    DRAINING = "draining"
    NO_POSES = "no_poses"
    MODEL = "model"


@dataclass(frozen=True)
class Notice:
    """Something that the server wants the client to know; the stream goes on.

    `model` goes with the code MODEL: which the head has.
    """

    code: NoticeCode
    message: str
    count: int
    model: AnimationModel | None = None


def format_value(format: FrameFormat | str) -> int:
    return _FORMATS[choice("format", FrameFormat, format)]


def space_value(space: Space | str) -> int:
    return _SPACES[choice("space", Space, space)]


def open_head(
    groom: str,
    pacing: Pacing | str,
    *,
    format: FrameFormat | str = FrameFormat.FLOAT32,
    space: Space | str = Space.WORLD,
    points_per_guide: int = 16,
    rate_hz: float = 60.0,
    substeps: int = 1,
    pose_delay_s: float = 0.0,
    max_unacked_frames: int = 3,
    initial_pose: Pose | None = None,
    environment: Environment | None = None,
    diagnostics: bool = False,
    model: AnimationModel | str = AnimationModel.SUPER_HELIX,
    beam: BeamMotion | None = None,
    may_shed: bool = False,
) -> animation_pb2.OpenHead:
    """The message that opens a head; `mane.Client.open_head` describes the arguments."""
    chosen = choice("pacing", Pacing, pacing)
    message = animation_pb2.OpenHead(
        groom=groom,
        pacing=animation_pb2.Pacing.Value(f"PACING_{chosen.name}"),
        format=format_value(format),
        space=space_value(space),
        points_per_guide=points_per_guide,
        rate_hz=rate_hz if chosen == Pacing.REALTIME else 0.0,
        substeps=substeps,
        pose_delay_s=pose_delay_s,
        max_unacked_frames=max_unacked_frames if chosen == Pacing.REALTIME else 0,
        request_id=messages.request_id(),
        diagnostics=diagnostics,
        model=beams.model_value(model),
        beam=beams.beam_motion(beam),
        may_shed=may_shed,
    )
    if initial_pose is not None:
        message.initial_pose.CopyFrom(value_messages.rigid(initial_pose))
    if environment is not None:
        message.environment.CopyFrom(messages.environment(environment))
    return message


def decoder_for(source, guide_count: int, strands: Strands | None) -> FrameDecoder:
    """Decodes frames.

    Args:
      source: says `format`, `space` (API enums) and `points_per_guide`: an `Opened` or a `Reading`.
      guide_count: of the groom.
      strands: matters for GENERALIZED only.
    """
    formats = {value: key for key, value in _FORMATS.items()}
    spaces = {value: key for key, value in _SPACES.items()}
    return FrameDecoder(
        formats[source.format],
        guide_count,
        source.points_per_guide,
        spaces[source.space],
        strands,
    )


def from_hair_frame(message: animation_pb2.HairFrame, decoder: FrameDecoder) -> Frame:
    pose = value_messages.from_rigid(message.time_s, message.head_pose)
    positions, angles = decoder.decode(message.data, pose)
    return Frame(
        index=message.index,
        time_s=message.time_s,
        head_pose=pose,
        positions=positions,
        skipped=message.skipped,
        newest_pose_time_s=message.newest_pose_time_s,
        step_ms=message.step_ms,
        repaired_guides=message.repaired_guides,
        stepped_elements=message.stepped_elements,
        model=beams.from_model(message.model),
        diagnostics=_diagnostics(message),
        angles=angles,
    )


def _diagnostics(message: animation_pb2.HairFrame) -> Diagnostics | None:
    if not message.HasField("diagnostics"):
        return None
    sent = message.diagnostics
    return Diagnostics(
        sent.kinetic_energy_j,
        sent.elastic_energy_j,
        sent.gravity_energy_j,
        sent.largest_angle_rad,
        sent.imbalance,
    )


class Receiver:
    """Turns the answers of one stream into frames and notices. Not thread-safe.

    Attributes:
      opened: the server's first answer.
      notices: the newest notices, oldest first.
    """

    def __init__(self, opened: animation_pb2.Opened, strands: Strands | None):
        self.opened = opened
        self.notices: deque[Notice] = deque(maxlen=100)
        self._decoder = decoder_for(opened, opened.guide_count, strands)

    def accept(self, response: animation_pb2.AnimateResponse) -> Frame | None:
        """The frame in an answer, if it is one."""
        if response.WhichOneof("kind") == "notice":
            notice = response.notice
            name = animation_pb2.Notice.Code.Name(notice.code).removeprefix("CODE_").lower()
            model = beams.from_model(notice.model) if name == NoticeCode.MODEL else None
            self.notices.append(Notice(NoticeCode(name), notice.message, notice.count, model))
            return None
        return from_hair_frame(response.frame, self._decoder)


class Acknowledger:
    """Says when frames must be acknowledged so that the server keeps sending.

    One thread may call `received` while another calls `stamp`: both only set whole numbers.

    Every message carries the last frame received. One is sent for that alone when half of the
    window `max_unacked_frames` waits, so that poses at the frame rate carry all the rest.
    """

    def __init__(self, max_unacked_frames: int):
        self._due = max(1, (max_unacked_frames + 1) // 2)
        self._received = 0
        self._sent = 0

    def received(self, index: int) -> bool:
        """Notes a frame. True if a message must be sent for its sake."""
        self._received = index
        return self._received - self._sent >= self._due

    def stamp(self, request: animation_pb2.AnimateRequest) -> animation_pb2.AnimateRequest:
        """Puts the acknowledgement into a message that is about to be sent."""
        self._sent = request.acked_frame = self._received
        return request


class FrameSelector:
    """The newest frame of a head, and how many were passed over. Not thread-safe.

    Args:
      next_index: index of the head's next frame.
    """

    def __init__(self, next_index: int):
        self._taken_index = next_index - 1
        self._newest: Frame | None = None
        self._given: Frame | None = None

    @property
    def fresh(self) -> bool:
        """Whether `take` would give a frame that it has not given yet."""
        return self._newest is not None

    def offer(self, frame: Frame) -> None:
        """Replaces the newest frame."""
        self._newest = frame

    def take(self) -> Frame | None:
        """The newest frame; the last one given where there is no newer one."""
        if self._newest is not None:
            skipped = self._newest.index - self._taken_index - 1
            self._given = replace(self._newest, skipped=skipped)
            self._taken_index = self._newest.index
            self._newest = None
        return self._given


class EnvironmentMemory:
    """The sum of all changes of the environment, to be repeated after a resumption."""

    def __init__(self):
        self._message: animation_pb2.Environment | None = None

    def add(self, change: animation_pb2.Environment) -> None:
        if self._message is None:
            self._message = animation_pb2.Environment()
        for field, _ in change.ListFields():  # Vectors are replaced, not merged by component.
            self._message.ClearField(field.name)
        self._message.MergeFrom(change)

    def request(self) -> animation_pb2.AnimateRequest | None:
        if self._message is None:
            return None
        return animation_pb2.AnimateRequest(environment=self._message)


class ModelMemory:
    """The last change of the model, and of beams, to be repeated after a resumption."""

    def __init__(self):
        self._message: animation_pb2.SetModel | None = None

    def add(self, change: animation_pb2.SetModel) -> None:
        beam = self._message.beam if self._message and self._message.HasField("beam") else None
        self._message = change
        if beam is not None and not change.HasField("beam"):
            self._message.beam.CopyFrom(beam)

    def request(self) -> animation_pb2.AnimateRequest | None:
        if self._message is None:
            return None
        return animation_pb2.AnimateRequest(model=self._message)


def resume_delays():
    """Pauses between attempts to resume [s]: soon at first, then every two seconds."""
    delay = 0.1
    while True:
        yield delay
        delay = min(2 * delay, 2.0)
