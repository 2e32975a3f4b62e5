"""The client for threads. `mane.aio` has the same one for asyncio."""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Literal, overload

import grpc
from grpc_health.v1 import health_pb2, health_pb2_grpc
from numpy.typing import ArrayLike

from mane import beams, channel, jobs, messages, strand_messages, stream, style_messages
from mane.beam_style import BeamStyle
from mane.beams import AnimationModel, BeamMotion
from mane.bodies import Body, ScalpContact
from mane.errors import InvalidArgument
from mane.frames import Frame, FrameFormat, Space
from mane.groom import Ellipsoid, Groom, Guide, GuideGeneration, RestShape
from mane.hairs import Hairs
from mane.hairstyle import Hairstyle
from mane.heads import CLOSE_TIMEOUT_S, LockstepHead, RealtimeHead
from mane.helix import Strands
from mane.jobs import Job
from mane.mesh import Mesh
from mane.motion import Motion
from mane.pose import Environment
from mane.strands import ImportOptions, ImportReport, Strand
from mane.stream import Pacing
from mane.style import GUIDES, Style
from mane.styles import StylePreset
from mane.v1 import (
    animation_pb2,
    animation_pb2_grpc,
    bake_pb2,
    bake_pb2_grpc,
    groom_pb2,
    groom_pb2_grpc,
    job_pb2,
    job_pb2_grpc,
    style_pb2,
    style_pb2_grpc,
)


@dataclass(frozen=True)
class Status:
    """How a server does.

    Attributes:
      server: its address.
      state: `serving`, `not_serving` or `unknown`.
      round_trip_ms: time of one question and answer.
    """

    server: str
    state: str
    round_trip_ms: float

    @property
    def serving(self) -> bool:
        return self.state == "serving"


class Client:
    """A connection to a `maned`. Thread-safe. A context manager: leaving it closes it.

    Args:
      server: `host:port`; None takes the environment's MANE_SERVER, else 127.0.0.1:7420.
      tls: encrypt, and check the server's certificate by the system's authorities.
      ca_file: encrypt, and check it by the authorities in this PEM file.
      token: sent as a bearer token with every call; needs an encrypted connection.
      timeout_s: longest wait for the answer of a short call [s]. Uploads and rest shapes may take
        ten times as long, imports of strands a hundred times.

    The constructor does not connect; the first call does. Every method raises `mane.Error`.
    """

    def __init__(
        self,
        server: str | None = None,
        *,
        tls: bool = False,
        ca_file: str | os.PathLike | None = None,
        token: str | None = None,
        timeout_s: float = 30.0,
    ):
        self.server = channel.resolve_server(server)
        self._timeout_s = timeout_s
        self._channel = channel.open_channel(grpc, self.server, tls, ca_file, token)
        self._health = health_pb2_grpc.HealthStub(self._channel)
        self._grooms = groom_pb2_grpc.GroomServiceStub(self._channel)
        self._animation = animation_pb2_grpc.AnimationServiceStub(self._channel)
        self._bakes = bake_pb2_grpc.BakeServiceStub(self._channel)
        self._jobs = job_pb2_grpc.JobServiceStub(self._channel)
        self._styling = style_pb2_grpc.StylingServiceStub(self._channel)

    def close(self) -> None:
        """Closes the connection, and with it what still uses it."""
        # An interrupt (Ctrl-C) may leave a call half-way inside gRPC, whose close then waits for it
        # for ever; so that is left to a thread that does not keep the process alive.
        closing = threading.Thread(target=self._channel.close, daemon=True)
        closing.start()
        closing.join(CLOSE_TIMEOUT_S)

    def __enter__(self) -> Client:
        return self

    def __exit__(self, *_) -> None:
        self.close()

    def status(self) -> Status:
        """Asks the server's health. Raises Unavailable where none answers."""
        begin = time.perf_counter()
        answer = self._call(self._health.Check, health_pb2.HealthCheckRequest())
        elapsed_ms = 1e3 * (time.perf_counter() - begin)
        state = health_pb2.HealthCheckResponse.ServingStatus.Name(answer.status).lower()
        return Status(self.server, state, elapsed_ms)

    def create_groom(
        self,
        guides: Iterable[Guide] = (),
        *,
        strands: Iterable[Strand | ArrayLike] = (),
        import_options: ImportOptions | None = None,
        scalp: Mesh | Ellipsoid | None = None,
        scalp_contact: ScalpContact | None = None,
        bodies: Iterable[Body] = (),
        generate: GuideGeneration | None = None,
        hairs: Hairs | None = None,
        groom_id: str = "",
        display_name: str = "",
    ) -> Groom:
        """Uploads guides, imports strands, or lets the server generate guides on a scalp. Once it
        returns, the groom is kept.

        Args:
          guides: the guide strands; none where `strands` or `generate` are given.
          strands: hair of another program, `Strand`s or plain arrays of points (k, 3): each becomes
            a guide at rest in that shape. `Groom.import_summary` tells how well, `import_report`
            strand by strand. Takes 10 to 100 ms a strand, some times that with an error bound.
          import_options: how; None is `ImportOptions()`.
          scalp: a triangle mesh or an ellipsoid in the head frame; `generate` needs one.
          scalp_contact: a `ScalpContact` where hair meets the scalp; None where it passes through.
            A mesh may have holes, which are closed, up to a fifth of its surface.
          bodies: what else hair meets, at most 64. Meshes take seconds.
          generate: places and shapes guides on the scalp's hair region.
          hairs: what rides on the guides, however these are made: `mane.hairs.ride_on` makes it of
            curves, `mane.hairs.assemble` makes curves of it and a frame. Heads do not look at it.
          groom_id: last part of the name, `[a-z0-9]([a-z0-9-]{0,61}[a-z0-9])?`; the server chooses
            one where it is empty.
          display_name: free text, at most 200 bytes.

        Raises InvalidArgument that names the offending field (`guides[12].length_m`), and the body,
        AlreadyExists where the id is taken, ResourceExhausted above the server's limits.
        """
        header = messages.create_header(groom_id, display_name, generate, scalp_contact, hairs)
        if import_options is None:
            strands = list(strands)
            import_options = ImportOptions() if strands else None
        if import_options is None:
            requests = messages.create_groom(header, guides, scalp, bodies, hairs)
            patience = 10
        elif any(True for _ in guides):
            raise InvalidArgument.of("guides", "must be empty where strands are imported")
        else:
            requests = strand_messages.create_groom(
                header, strands, import_options, scalp, bodies, hairs
            )
            patience = 100
        groom = self._call(self._grooms.CreateGroom, requests, patience)
        return messages.from_groom(groom)

    def import_report(self, groom: Groom | str) -> ImportReport:
        """How closely every strand was fitted and whether it holds. FailedPrecondition for a groom
        that was not made from strands."""
        request = messages.of_groom(groom_pb2.GetImportReportRequest, groom)
        return strand_messages.from_report(self._call(self._grooms.GetImportReport, request))

    def get_groom(self, groom: Groom | str) -> Groom:
        """The description of a groom, by `grooms/{groom}` or its last part."""
        return messages.from_groom(
            self._call(self._grooms.GetGroom, messages.of_groom(groom_pb2.GetGroomRequest, groom))
        )

    def list_grooms(self, page_size: int = 100) -> Iterator[Groom]:
        """All grooms by name; asks for `page_size` of them (1 to 1000) at a time."""
        request = groom_pb2.ListGroomsRequest(page_size=page_size)
        while True:
            answer = self._call(self._grooms.ListGrooms, request)
            yield from map(messages.from_groom, answer.grooms)
            request.page_token = answer.next_page_token
            if not request.page_token:
                return

    def delete_groom(self, groom: Groom | str) -> None:
        """Deletes a groom. Heads that animate it go on."""
        self._call(self._grooms.DeleteGroom, messages.of_groom(groom_pb2.DeleteGroomRequest, groom))

    def export_groom(self, groom: Groom | str, *, hairs: bool = True) -> Groom:
        """A groom with its guides, scalp and bodies, and with its `hairs` unless that is False."""
        parts = messages.ExportedGroom(hairs)
        request = messages.export_groom(groom, hairs)
        call = self._grooms.ExportGroom(request, timeout=10 * self._timeout_s)
        for part in self._stream(call):
            parts.add(part)
        return parts.groom()

    def rest_shape(
        self,
        groom: Groom | str,
        *,
        head_orientation=None,
        gravity=None,
        points_per_guide: int = 16,
    ) -> RestShape:
        """Static equilibrium of every guide under gravity with the head at rest.

        Args:
          groom: which.
          head_orientation: head -> world quaternion (x, y, z, w); None is upright.
          gravity: world [m/s^2], (3,); None is (0, -9.81, 0).
          points_per_guide: 2 to 256.

        Fetches the guides too, unless `groom` is an exported one that has them.
        """
        request = messages.rest_shape(groom, head_orientation, gravity, points_per_guide)
        answer = self._call(self._grooms.ComputeRestShape, request, patience=10)
        return messages.from_rest_shape(answer, self._strands(groom))

    @overload
    def open_head(
        self, groom: Groom | str, pacing: Literal["lockstep", Pacing.LOCKSTEP], **options
    ) -> LockstepHead: ...

    @overload
    def open_head(
        self, groom: Groom | str, pacing: Literal["realtime", Pacing.REALTIME], **options
    ) -> RealtimeHead: ...

    def open_head(self, groom, pacing, **options):
        """Opens a head of hair that follows streamed poses.

        Args:
          groom: which hair.
          pacing: `"lockstep"`: every pose yields one frame, the same bits every time.
            `"realtime"`: the server's clock ticks, and the newest frame wins.
          format: how frames travel: `"float32"`, `"quantized16"` or `"generalized"`; see
            `FrameFormat`. You get positions in every case.
          space: `"world"`, or `"head"` for positions relative to each frame's `head_pose`.
          points_per_guide: points at equal arc length, 2 to 256; 16 unless given.
          rate_hz: REALTIME frames per second, 1 to 240; 60 unless given.
          substeps: time steps per frame, 1 to 64; 1 unless given.
          pose_delay_s: REALTIME: how far behind the newest pose the head is shown [s], 0 to 0.25;
            0, the default, extrapolates; one pose interval makes every frame an interpolation.
          max_unacked_frames: REALTIME: frames on their way at a time, 1 to 16; 3 unless given.
          initial_pose: a `Pose`: where the head is before the first one; its time is not used.
          environment: an `Environment`.
          diagnostics: True for `Frame.diagnostics`, which cost some sixteen time steps a frame.
          model: `"super_helix"` or `"beam"`, which generalized frames cannot show; see
            `AnimationModel`. `set_model` changes it later.
          beam: a `BeamMotion`: what beams are like, now or once the head is changed to them.
          may_shed: REALTIME: True where the server may animate the head as BEAM while its frames
            come late.

        Raises NotFound for an unknown groom, ResourceExhausted where the server is full.
        """
        name = messages.resource_name("grooms", groom)
        request = stream.open_head(name, pacing, **options)
        generalized = request.format == animation_pb2.FRAME_FORMAT_GENERALIZED
        strands = self._strands(groom) if generalized else None
        lockstep = request.pacing == animation_pb2.PACING_LOCKSTEP
        kind = LockstepHead if lockstep else RealtimeHead
        return kind(self._animation, self.server, request, strands)

    def bake(
        self,
        groom: Groom | str,
        motion: Motion,
        *,
        format: FrameFormat | str = FrameFormat.FLOAT32,
        space: Space | str = Space.WORLD,
        points_per_guide: int = 16,
        substeps: int = 1,
        environment: Environment | None = None,
        model: AnimationModel | str = AnimationModel.SUPER_HELIX,
        beam: BeamMotion | None = None,
    ) -> Bake:
        """Submits a job that animates all of `motion` (at most 16,000 poses) as LOCKSTEP does."""
        request = messages.bake(groom, motion, points_per_guide, substeps, environment)
        request.format = stream.format_value(format)
        request.space = stream.space_value(space)
        request.model = beams.model_value(model)
        if beam is not None:
            request.beam.CopyFrom(beams.beam_motion(beam))
        job = jobs.from_message(self._call(self._bakes.BakeAnimation, request))
        reading = jobs.Reading(request.groom, request.format, request.space, points_per_guide)
        return Bake(self, job, reading)

    def apply_style(
        self,
        style: Style | BeamStyle,
        *,
        scalp: Mesh | Ellipsoid,
        scalp_contact: ScalpContact | None = None,
        bodies: Iterable[Body] = (),
        guides: ImportOptions | None = None,
        groom_id: str = "",
        display_name: str = "",
    ) -> Job:
        """Submits a job that makes a style on a scalp; `watch_job` follows it. When it has
        succeeded, the groom is there, and `read_hairstyle` gives all hair.

        Args:
          style: what to make, of wisps or of beams.
          scalp: a triangle mesh or an ellipsoid in the head frame. Styling keeps hair out of it, or
            by beams out of an ellipsoid around it.
          scalp_contact: where hair meets the scalp when it is animated; None where it passes
            through.
          bodies: as in `create_groom`; styling of wisps keeps hair out of them where they are on
            the head.
          guides: how master strands, or some of the beams, become guides; None is
            `mane.style.GUIDES`.
          groom_id, display_name: as in `create_groom`.

        Raises InvalidArgument that names the offending field
        (`header.style.queues[1].constraints[0].radius_m`), and others as `create_groom`.
        """
        requests = style_messages.apply_style(
            style, guides or GUIDES, scalp, scalp_contact, bodies, groom_id, display_name
        )
        return jobs.from_message(self._call(self._styling.ApplyStyle, requests, patience=10))

    def read_hairstyle(self, job: Job | str) -> Hairstyle:
        """What a finished style job made. FailedPrecondition while it is not finished."""
        parts = style_messages.DownloadedHairstyle()
        request = messages.of_job(style_pb2.ReadHairstyleRequest, job)
        call = self._styling.ReadHairstyle(request, timeout=10 * self._timeout_s)
        for part in self._stream(call):
            parts.add(part)
        return parts.hairstyle()

    def style_presets(self) -> list[StylePreset]:
        """Shipped styles, to use as they are or to change."""
        request = style_pb2.ListStylePresetsRequest()
        return style_messages.from_presets(self._call(self._styling.ListStylePresets, request))

    def get_job(self, job: Job | str) -> Job:
        """A job, by `jobs/{job}` or its last part."""
        return jobs.from_message(
            self._call(self._jobs.GetJob, messages.of_job(job_pb2.GetJobRequest, job))
        )

    def list_jobs(self, page_size: int = 100) -> Iterator[Job]:
        """All jobs, newest first; asks for `page_size` of them (1 to 1000) at a time."""
        request = job_pb2.ListJobsRequest(page_size=page_size)
        while True:
            answer = self._call(self._jobs.ListJobs, request)
            yield from map(jobs.from_message, answer.jobs)
            request.page_token = answer.next_page_token
            if not request.page_token:
                return

    def watch_job(self, job: Job | str) -> Iterator[Job]:
        """The job now and after every change, at most ten times a second, until it has ended."""
        for answer in self._stream(
            self._jobs.WatchJob(messages.of_job(job_pb2.WatchJobRequest, job))
        ):
            yield jobs.from_message(answer)

    def cancel_job(self, job: Job | str) -> Job:
        """Asks a job to stop, which it does within a second. One that has ended stays as it is."""
        return jobs.from_message(
            self._call(self._jobs.CancelJob, messages.of_job(job_pb2.CancelJobRequest, job))
        )

    def delete_job(self, job: Job | str) -> None:
        """Deletes an ended job and its result. FailedPrecondition while it is queued or running."""
        self._call(self._jobs.DeleteJob, messages.of_job(job_pb2.DeleteJobRequest, job))

    def read_bake(self, job: Job | str, reading: jobs.Reading) -> Iterator[Frame]:
        """The frames of a finished bake, in order. FailedPrecondition while it is not finished."""
        groom = self.get_groom(reading.groom)
        generalized = reading.format == animation_pb2.FRAME_FORMAT_GENERALIZED
        strands = self._strands(groom) if generalized else None
        decoder = stream.decoder_for(reading, groom.guide_count, strands)
        for frame in self._stream(
            self._bakes.ReadBake(messages.of_job(bake_pb2.ReadBakeRequest, job))
        ):
            yield stream.from_hair_frame(frame, decoder)

    def _strands(self, groom: Groom | str) -> Strands:
        known = groom.guides if isinstance(groom, Groom) else ()
        return Strands(known or self.export_groom(groom, hairs=False).guides)

    def _call(self, method, request, patience: float = 1.0):
        try:
            return method(request, timeout=patience * self._timeout_s)
        except grpc.RpcError as error:
            raise channel.translate(error, self.server) from error

    def _stream(self, call):
        try:
            yield from call
        except grpc.RpcError as error:
            raise channel.translate(error, self.server) from error
        finally:
            call.cancel()


class Bake:
    """A submitted bake.

    Attributes:
      job: as it was last heard of.
    """

    def __init__(self, client: Client, job: Job, reading: jobs.Reading):
        self.job = job
        self._client = client
        self._reading = reading

    @property
    def name(self) -> str:
        """`jobs/{job}`."""
        return self.job.name

    def watch(self) -> Iterator[Job]:
        """The job now and after every change until it has ended."""
        for job in self._client.watch_job(self.job):
            self.job = job
            yield job

    def wait(self) -> Job:
        """Waits until the job has ended. Raises JobFailed where it failed or was cancelled."""
        for _ in self.watch():
            pass
        return self.job.require_success()

    def cancel(self) -> Job:
        """Asks the job to stop."""
        self.job = self._client.cancel_job(self.job)
        return self.job

    def frames(self) -> Iterator[Frame]:
        """The frames in order, one for each pose. FailedPrecondition while it is not finished."""
        return self._client.read_bake(self.job, self._reading)
