"""The client for asyncio: `mane.Client` with `await`, for one event loop.

async with mane.aio.Client() as client:
    async with client.open_head("demo", "lockstep") as head:
        async for frame in head.play(motion):
            ...
"""

from __future__ import annotations

import asyncio
import os
import time
from collections.abc import AsyncIterator, Iterable
from contextlib import asynccontextmanager

import grpc
from grpc import aio
from grpc_health.v1 import health_pb2, health_pb2_grpc
from numpy.typing import ArrayLike

from mane import beams, channel, jobs, messages, strand_messages, stream, style_messages
from mane import client as blocking
from mane.aio_heads import Head, LockstepHead, RealtimeHead, open_head
from mane.beam_style import BeamStyle
from mane.beams import AnimationModel, BeamMotion
from mane.bodies import Body, ScalpContact
from mane.client import Status
from mane.frames import Frame, FrameFormat, Space
from mane.groom import Ellipsoid, Groom, Guide, GuideGeneration, RestShape
from mane.hairs import Hairs
from mane.hairstyle import Hairstyle
from mane.helix import Strands
from mane.jobs import Job
from mane.mesh import Mesh
from mane.motion import Motion
from mane.pose import Environment
from mane.strands import ImportOptions, ImportReport, Strand
from mane.stream import Pacing
from mane.style import Style
from mane.styles import StylePreset
from mane.v1 import (
    animation_pb2,
    bake_pb2,
    bake_pb2_grpc,
    groom_pb2,
    groom_pb2_grpc,
    job_pb2,
    job_pb2_grpc,
    style_pb2,
    style_pb2_grpc,
)

__all__ = ["Bake", "Client", "Head", "LockstepHead", "RealtimeHead"]


class Client:
    """A connection to a `maned`. Arguments as `mane.Client`. An asynchronous context manager."""

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
        self._channel = channel.open_channel(aio, self.server, tls, ca_file, token)
        # For calls that stream to the server; mane.aio_heads says why.
        self._blocking = blocking.Client(
            server, tls=tls, ca_file=ca_file, token=token, timeout_s=timeout_s
        )
        self._health = health_pb2_grpc.HealthStub(self._channel)
        self._grooms = groom_pb2_grpc.GroomServiceStub(self._channel)
        self._bakes = bake_pb2_grpc.BakeServiceStub(self._channel)
        self._jobs = job_pb2_grpc.JobServiceStub(self._channel)
        self._styling = style_pb2_grpc.StylingServiceStub(self._channel)

    async def close(self) -> None:
        await self._channel.close()
        await asyncio.to_thread(self._blocking.close)

    async def __aenter__(self) -> Client:
        return self

    async def __aexit__(self, *_) -> None:
        await self.close()

    async def status(self) -> Status:
        """As `mane.Client.status`."""
        begin = time.perf_counter()
        answer = await self._call(self._health.Check, health_pb2.HealthCheckRequest())
        elapsed_ms = 1e3 * (time.perf_counter() - begin)
        state = health_pb2.HealthCheckResponse.ServingStatus.Name(answer.status).lower()
        return Status(self.server, state, elapsed_ms)

    async def create_groom(
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
        """As `mane.Client.create_groom`."""
        return await asyncio.to_thread(
            self._blocking.create_groom,
            guides,
            strands=strands,
            import_options=import_options,
            scalp=scalp,
            scalp_contact=scalp_contact,
            bodies=bodies,
            generate=generate,
            hairs=hairs,
            groom_id=groom_id,
            display_name=display_name,
        )

    async def import_report(self, groom: Groom | str) -> ImportReport:
        """As `mane.Client.import_report`."""
        request = messages.of_groom(groom_pb2.GetImportReportRequest, groom)
        return strand_messages.from_report(await self._call(self._grooms.GetImportReport, request))

    async def get_groom(self, groom: Groom | str) -> Groom:
        """As `mane.Client.get_groom`."""
        request = messages.of_groom(groom_pb2.GetGroomRequest, groom)
        return messages.from_groom(await self._call(self._grooms.GetGroom, request))

    async def list_grooms(self, page_size: int = 100) -> AsyncIterator[Groom]:
        """As `mane.Client.list_grooms`."""
        request = groom_pb2.ListGroomsRequest(page_size=page_size)
        while True:
            answer = await self._call(self._grooms.ListGrooms, request)
            for groom in answer.grooms:
                yield messages.from_groom(groom)
            request.page_token = answer.next_page_token
            if not request.page_token:
                return

    async def delete_groom(self, groom: Groom | str) -> None:
        """As `mane.Client.delete_groom`."""
        request = messages.of_groom(groom_pb2.DeleteGroomRequest, groom)
        await self._call(self._grooms.DeleteGroom, request)

    async def export_groom(self, groom: Groom | str, *, hairs: bool = True) -> Groom:
        """As `mane.Client.export_groom`."""
        request = messages.export_groom(groom, hairs)
        parts = messages.ExportedGroom(hairs)
        async for part in self._stream(self._grooms.ExportGroom(request)):
            parts.add(part)
        return parts.groom()

    async def rest_shape(
        self,
        groom: Groom | str,
        *,
        head_orientation=None,
        gravity=None,
        points_per_guide: int = 16,
    ) -> RestShape:
        """As `mane.Client.rest_shape`."""
        request = messages.rest_shape(groom, head_orientation, gravity, points_per_guide)
        answer = await self._call(self._grooms.ComputeRestShape, request, patience=10)
        return messages.from_rest_shape(answer, await self._strands(groom))

    @asynccontextmanager
    async def open_head(
        self, groom: Groom | str, pacing: Pacing | str, **options
    ) -> AsyncIterator[LockstepHead | RealtimeHead]:
        """As `mane.Client.open_head`, for `async with`."""
        head = await open_head(lambda: self._blocking.open_head(groom, pacing, **options))
        try:
            yield head
        except BaseException:
            await head.close(quiet=True)
            raise
        await head.close()

    async def bake(
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
        """As `mane.Client.bake`."""
        request = messages.bake(groom, motion, points_per_guide, substeps, environment)
        request.format = stream.format_value(format)
        request.space = stream.space_value(space)
        request.model = beams.model_value(model)
        if beam is not None:
            request.beam.CopyFrom(beams.beam_motion(beam))
        job = jobs.from_message(await self._call(self._bakes.BakeAnimation, request))
        reading = jobs.Reading(request.groom, request.format, request.space, points_per_guide)
        return Bake(self, job, reading)

    async def apply_style(
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
        """As `mane.Client.apply_style`."""
        return await asyncio.to_thread(
            self._blocking.apply_style,
            style,
            scalp=scalp,
            scalp_contact=scalp_contact,
            bodies=bodies,
            guides=guides,
            groom_id=groom_id,
            display_name=display_name,
        )

    async def read_hairstyle(self, job: Job | str) -> Hairstyle:
        """As `mane.Client.read_hairstyle`."""
        parts = style_messages.DownloadedHairstyle()
        request = messages.of_job(style_pb2.ReadHairstyleRequest, job)
        async for part in self._stream(self._styling.ReadHairstyle(request)):
            parts.add(part)
        return parts.hairstyle()

    async def style_presets(self) -> list[StylePreset]:
        """As `mane.Client.style_presets`."""
        request = style_pb2.ListStylePresetsRequest()
        answer = await self._call(self._styling.ListStylePresets, request)
        return style_messages.from_presets(answer)

    async def get_job(self, job: Job | str) -> Job:
        """As `mane.Client.get_job`."""
        request = messages.of_job(job_pb2.GetJobRequest, job)
        return jobs.from_message(await self._call(self._jobs.GetJob, request))

    async def list_jobs(self, page_size: int = 100) -> AsyncIterator[Job]:
        """As `mane.Client.list_jobs`."""
        request = job_pb2.ListJobsRequest(page_size=page_size)
        while True:
            answer = await self._call(self._jobs.ListJobs, request)
            for job in answer.jobs:
                yield jobs.from_message(job)
            request.page_token = answer.next_page_token
            if not request.page_token:
                return

    async def watch_job(self, job: Job | str) -> AsyncIterator[Job]:
        """As `mane.Client.watch_job`."""
        request = messages.of_job(job_pb2.WatchJobRequest, job)
        async for answer in self._stream(self._jobs.WatchJob(request)):
            yield jobs.from_message(answer)

    async def cancel_job(self, job: Job | str) -> Job:
        """As `mane.Client.cancel_job`."""
        request = messages.of_job(job_pb2.CancelJobRequest, job)
        return jobs.from_message(await self._call(self._jobs.CancelJob, request))

    async def delete_job(self, job: Job | str) -> None:
        """As `mane.Client.delete_job`."""
        await self._call(self._jobs.DeleteJob, messages.of_job(job_pb2.DeleteJobRequest, job))

    async def read_bake(self, job: Job | str, reading: jobs.Reading) -> AsyncIterator[Frame]:
        """As `mane.Client.read_bake`."""
        groom = await self.get_groom(reading.groom)
        generalized = reading.format == animation_pb2.FRAME_FORMAT_GENERALIZED
        strands = await self._strands(groom) if generalized else None
        decoder = stream.decoder_for(reading, groom.guide_count, strands)
        request = messages.of_job(bake_pb2.ReadBakeRequest, job)
        async for frame in self._stream(self._bakes.ReadBake(request)):
            yield stream.from_hair_frame(frame, decoder)

    async def _strands(self, groom: Groom | str) -> Strands:
        known = groom.guides if isinstance(groom, Groom) else ()
        return Strands(known or (await self.export_groom(groom, hairs=False)).guides)

    async def _call(self, method, request, patience: float = 1.0):
        try:
            return await method(request, timeout=patience * self._timeout_s)
        except grpc.RpcError as error:
            raise channel.translate(error, self.server) from error

    async def _stream(self, call):
        try:
            async for answer in call:
                yield answer
        except grpc.RpcError as error:
            raise channel.translate(error, self.server) from error
        finally:
            call.cancel()


class Bake:
    """A submitted bake; as `mane.Bake`.

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

    async def watch(self) -> AsyncIterator[Job]:
        """The job now and after every change until it has ended."""
        async for job in self._client.watch_job(self.job):
            self.job = job
            yield job

    async def wait(self) -> Job:
        """Waits until the job has ended. Raises JobFailed where it failed or was cancelled."""
        async for _ in self.watch():
            pass
        return self.job.require_success()

    async def cancel(self) -> Job:
        """Asks the job to stop."""
        self.job = await self._client.cancel_job(self.job)
        return self.job

    def frames(self) -> AsyncIterator[Frame]:
        """The frames in order, one for each pose. FailedPrecondition while it is not finished."""
        return self._client.read_bake(self.job, self._reading)
