"""Client of Mane, hair simulation as a service.

`Client` talks to a `maned`: it uploads grooms, makes hairstyles, opens heads of hair that follow
streamed head poses, and bakes whole motions; hair comes back as numpy arrays. `mane.aio.Client` is
the same for asyncio.

All lengths are metres, all angles radians; axes are right-handed with Y up, an upright head looks
toward +Z; quaternions are (x, y, z, w). `mane.convert` brings other conventions here.
"""

from mane.beam_style import BeamStyle, PoreRegion, Spread
from mane.beams import AnimationModel, BeamEquations, BeamMotion
from mane.bodies import (
    Body,
    BodySummary,
    CapsuleBody,
    EllipsoidBody,
    Material,
    MeshReport,
    ScalpContact,
)
from mane.client import Bake, Client, Status
from mane.errors import (
    AlreadyExists,
    Cancelled,
    DeadlineExceeded,
    Error,
    FailedPrecondition,
    FieldViolation,
    Internal,
    InvalidArgument,
    JobFailed,
    NotFound,
    PermissionDenied,
    ResourceExhausted,
    Unauthenticated,
    Unavailable,
)
from mane.frames import Diagnostics, Frame, FrameFormat, Space
from mane.groom import (
    Ellipsoid,
    Groom,
    Guide,
    GuideGeneration,
    HairType,
    RestShape,
    StrandModel,
    frame_along,
)
from mane.hairs import Hairs
from mane.hairstyle import Hairstyle, Masters, Members, Outcome, StyleReport, Volume
from mane.heads import LockstepHead, RealtimeHead
from mane.jobs import Job, JobState
from mane.mesh import Mesh
from mane.motion import Motion
from mane.pose import Environment, Pose
from mane.strands import HairProperties, ImportOptions, ImportReport, ImportSummary, Strand
from mane.stream import Notice, NoticeCode, Pacing
from mane.style import Region, StrandKind, Style
from mane.styles import StylePreset, load_style

__all__ = [
    "AlreadyExists",
    "AnimationModel",
    "Bake",
    "BeamEquations",
    "BeamMotion",
    "BeamStyle",
    "Body",
    "BodySummary",
    "Cancelled",
    "CapsuleBody",
    "Client",
    "DeadlineExceeded",
    "Diagnostics",
    "Ellipsoid",
    "EllipsoidBody",
    "Environment",
    "Error",
    "FailedPrecondition",
    "FieldViolation",
    "Frame",
    "FrameFormat",
    "Groom",
    "Guide",
    "GuideGeneration",
    "HairProperties",
    "HairType",
    "Hairs",
    "Hairstyle",
    "ImportOptions",
    "ImportReport",
    "ImportSummary",
    "Internal",
    "InvalidArgument",
    "Job",
    "JobFailed",
    "JobState",
    "LockstepHead",
    "Masters",
    "Material",
    "Members",
    "Mesh",
    "MeshReport",
    "Motion",
    "NotFound",
    "Notice",
    "NoticeCode",
    "Outcome",
    "Pacing",
    "PermissionDenied",
    "PoreRegion",
    "Pose",
    "RealtimeHead",
    "Region",
    "ResourceExhausted",
    "RestShape",
    "ScalpContact",
    "Space",
    "Spread",
    "Status",
    "Strand",
    "StrandKind",
    "StrandModel",
    "Style",
    "StylePreset",
    "StyleReport",
    "Unauthenticated",
    "Unavailable",
    "Volume",
    "frame_along",
    "load_style",
]
