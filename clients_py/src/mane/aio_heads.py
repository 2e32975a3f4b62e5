"""Heads of hair for asyncio: `mane.heads` with `await`, for one event loop."""

from __future__ import annotations

import asyncio
import time
from collections.abc import AsyncIterator, Iterable

import grpc

from mane import channel, messages, stream
from mane.errors import DeadlineExceeded, Error, FailedPrecondition, Unavailable
from mane.frames import Frame
from mane.heads import CLOSE_TIMEOUT_S, OPEN_TIMEOUT_S
from mane.helix import Strands
from mane.motion import Motion
from mane.outbox import AsyncFeed, AsyncOutbox
from mane.pose import Environment, Pose
from mane.v1 import animation_pb2

Request = animation_pb2.AnimateRequest


class _Connection:
    """One Animate call."""

    def __init__(self, stub, server: str, outbox: AsyncOutbox, first: Request):
        self._server = server
        self._feed = AsyncFeed(outbox, first)
        self._call = stub.Animate(self._feed)

    async def open(self, timeout_s: float) -> animation_pb2.Opened:
        """Waits for the server's first answer. Raises `Error`."""
        try:
            response = await asyncio.wait_for(self.receive(), timeout_s)
        except TimeoutError:
            self.abandon()
            message = f"{self._server} did not answer within {timeout_s:g} s"
            raise DeadlineExceeded(message) from None
        except BaseException:
            self.abandon()
            raise
        if response is None or response.WhichOneof("kind") != "opened":
            self.abandon()
            raise Unavailable(f"{self._server} did not open the head; is it a maned?")
        return response.opened

    async def receive(self) -> animation_pb2.AnimateResponse | None:
        """The next answer, or None where the server has ended the stream. Raises `Error`."""
        try:
            response = await self._call.read()
        except grpc.RpcError as error:
            raise channel.translate(error, self._server) from error
        return None if response is grpc.aio.EOF else response

    def half_close(self) -> None:
        """Tells the server that nothing more comes; it then ends the stream."""
        self._feed.close()

    def abandon(self) -> None:
        self._feed.abandon()
        self._call.cancel()


async def connect(stub, server: str, open_head, strands: Strands | None):
    """Opens a head; a `LockstepHead` or a `RealtimeHead`, as `open_head.pacing` says."""
    acknowledger = stream.Acknowledger(open_head.max_unacked_frames)
    lockstep = open_head.pacing == animation_pb2.PACING_LOCKSTEP
    if lockstep:
        outbox = AsyncOutbox()
    else:
        outbox = AsyncOutbox(pose_limit=stream.POSE_LIMIT, stamp=acknowledger.stamp)
    connection = _Connection(stub, server, outbox, Request(open=open_head))
    opened = await connection.open(OPEN_TIMEOUT_S)
    receiver = stream.Receiver(opened, strands)
    if lockstep:
        return LockstepHead(server, outbox, connection, receiver)
    return RealtimeHead(server, outbox, connection, receiver, stub, acknowledger)


class Head:
    """What both kinds of heads have in common; as `mane.heads.Head`."""

    def __init__(self, server: str, outbox: AsyncOutbox, connection: _Connection, receiver):
        self._server = server
        self._outbox = outbox
        self._connection = connection
        self._receiver = receiver
        self._failure: Error | None = None
        self._failure_raised = False
        self._closed = False
        self.name = receiver.opened.head
        self.guide_count = receiver.opened.guide_count
        self.element_count = receiver.opened.element_count
        self.points_per_guide = receiver.opened.points_per_guide

    @property
    def notices(self) -> tuple[stream.Notice, ...]:
        """The newest hundred things that the server wanted to be known, oldest first."""
        return tuple(self._receiver.notices)

    def reset(self) -> None:
        """Puts the hair to its rest shape with no velocity, from the next frame on."""
        self._send(Request(reset=animation_pb2.ResetHead()))

    def set_environment(self, environment: Environment) -> None:
        """Changes wind, gravity or damping from the next step on; None leaves a value as it is."""
        self._send(Request(environment=messages.environment(environment)))

    async def close(self, quiet: bool = False) -> None:
        """Closes the head; the server forgets it. `quiet`: raises nothing."""
        try:
            await self._close()
        except Error:
            if not quiet:
                raise

    def _send(self, request: Request) -> None:
        self._require_open()
        self._outbox.put(request)

    def _require_sound(self) -> None:
        """Raises what ended the stream, if something did."""
        if self._failure is not None:
            self._failure_raised = True
            raise self._failure

    def _require_open(self) -> None:
        self._require_sound()
        if self._closed:
            raise FailedPrecondition(f"{self.name} is closed")


class LockstepHead(Head):
    """A head that makes one frame from each pose. For one task at a time."""

    def __init__(self, server, outbox, connection, receiver):
        super().__init__(server, outbox, connection, receiver)
        self._last_index = receiver.opened.next_frame - 1

    async def step(self, pose: Pose) -> Frame:
        """Moves the head to `pose`, whose time must be later than the last one's."""
        return await self._frame(self._push(pose))

    async def teleport(self, pose: Pose) -> Frame:
        """Moves head and hair together without dynamics, as in a cut."""
        return await self._frame(self._send_counted(Request(teleport=messages.head_pose(pose))))

    async def play(
        self, motion: Motion | Iterable[Pose], in_flight: int = 8
    ) -> AsyncIterator[Frame]:
        """One frame for each pose of `motion`, in order; as `mane.heads.LockstepHead.play`."""
        first = self._last_index + 1
        for pose in motion.poses() if isinstance(motion, Motion) else motion:
            if self._push(pose) - first + 1 >= in_flight:
                yield await self._frame(first)
                first += 1
        while first <= self._last_index:
            yield await self._frame(first)
            first += 1

    async def _close(self) -> None:
        if self._closed:
            return
        self._closed = True
        if self._failure is not None:
            self._connection.abandon()
            return
        self._connection.half_close()
        try:
            async with asyncio.timeout(CLOSE_TIMEOUT_S):
                while await self._connection.receive() is not None:
                    pass  # Frames that nobody asked for any more.
        except TimeoutError:
            self._connection.abandon()

    def _push(self, pose: Pose) -> int:
        return self._send_counted(Request(pose=messages.head_pose(pose)))

    def _send_counted(self, request: Request) -> int:
        """Sends a message that yields a frame; returns the frame's index."""
        self._send(request)
        self._last_index += 1
        return self._last_index

    async def _frame(self, index: int) -> Frame:
        """Receives up to the frame of that index; drops those of a `play` that was left early."""
        self._require_open()
        try:
            while True:
                response = await self._connection.receive()
                if response is None:
                    raise Unavailable(f"{self._server} ended the stream of {self.name}")
                frame = self._receiver.accept(response)
                if frame is not None and frame.index >= index:
                    return frame
        except Error as error:
            self._failure = error
            raise


class RealtimeHead(Head):
    """A head that the server animates by its own clock; as `mane.heads.RealtimeHead`.

    A task of its own receives frames, acknowledges them and resumes a broken stream.
    """

    def __init__(self, server, outbox, connection, receiver, stub, acknowledger):
        super().__init__(server, outbox, connection, receiver)
        self._stub = stub
        self._acknowledger = acknowledger
        self._environment = stream.EnvironmentMemory()
        self._selector = stream.FrameSelector(receiver.opened.next_frame)
        self._resumptions = 0
        self._changed = asyncio.Event()
        self._task = asyncio.create_task(self._run(), name=self.name)

    @property
    def resumptions(self) -> int:
        """How often a broken connection was mended."""
        return self._resumptions

    def push(self, pose: Pose) -> None:
        """Tells where the head is at a moment of your clock, later than the last."""
        self._send(Request(pose=messages.head_pose(pose)))

    def teleport(self, pose: Pose) -> None:
        """Moves head and hair together without dynamics, as in a cut."""
        self._send(Request(teleport=messages.head_pose(pose)))

    def set_environment(self, environment: Environment) -> None:
        self._environment.add(messages.environment(environment))
        super().set_environment(environment)

    def newest(self) -> Frame | None:
        """The newest frame that has arrived, None before the first; perhaps the same again."""
        self._require_sound()
        return self._selector.take()

    async def frames(self, timeout_s: float | None = 10.0) -> AsyncIterator[Frame]:
        """Waits for each next frame, always the newest one; ends when the head is closed.

        Raises DeadlineExceeded where none comes for `timeout_s` (None waits for ever).
        """
        while True:
            try:
                async with asyncio.timeout(timeout_s):
                    while not (self._selector.fresh or self._failure or self._closed):
                        self._changed.clear()
                        await self._changed.wait()
            except TimeoutError:
                message = f"{self.name} sent no frame for {timeout_s:g} s"
                raise DeadlineExceeded(message) from None
            self._require_sound()
            if self._closed:
                return
            yield self._selector.take()

    async def _close(self) -> None:
        if self._closed:
            return
        self._closed = True
        self._changed.set()
        self._connection.half_close()
        _, running = await asyncio.wait([self._task], timeout=CLOSE_TIMEOUT_S)
        if running:
            self._connection.abandon()
            self._task.cancel()
            await asyncio.wait([self._task])
        if not self._failure_raised:
            self._require_sound()

    async def _run(self) -> None:
        """Receives until the head is closed or cannot be resumed."""
        try:
            while not self._closed:
                await self._receive_all()
        except Error as error:
            if not (self._closed and error.code in stream.RESUMABLE):
                self._failure = error
        finally:
            self._changed.set()

    async def _receive_all(self) -> None:
        """Receives until the stream breaks, then resumes it, or until it ends."""
        broken = Unavailable(f"{self._server} ended the stream of {self.name}")
        try:
            while (response := await self._connection.receive()) is not None:
                self._accept(response)
        except Error as error:
            broken = error
        self._connection.abandon()
        if self._closed:
            return
        if broken.code not in stream.RESUMABLE:
            raise broken
        await self._resume(broken)

    def _accept(self, response: animation_pb2.AnimateResponse) -> None:
        frame = self._receiver.accept(response)
        if frame is None:
            return
        if self._acknowledger.received(frame.index):
            self._outbox.put(Request(acknowledge=animation_pb2.Acknowledge()))
        self._selector.offer(frame)
        self._changed.set()

    async def _resume(self, broken: Error) -> None:
        """Opens the head again, trying for as long as the server keeps it. Raises `Error`."""
        old = self._receiver.opened
        deadline = time.monotonic() + old.resume_grace_s
        for delay in stream.resume_delays():
            first = Request(open=animation_pb2.OpenHead(resume=old.resume_token))
            connection = _Connection(self._stub, self._server, self._outbox, first)
            try:
                opened = await connection.open(max(1.0, deadline - time.monotonic()))
                break
            except Error as error:
                if error.code not in (*stream.RESUMABLE, "DEADLINE_EXCEEDED"):
                    raise
            left = deadline - time.monotonic()
            if left <= 0:
                raise broken
            await asyncio.sleep(min(delay, left))
            if self._closed:
                return
        self._adopt(connection, opened)

    def _adopt(self, connection: _Connection, opened: animation_pb2.Opened) -> None:
        self._connection = connection
        self._receiver.opened = opened
        self._resumptions += 1
        repeat = self._environment.request()
        if repeat is not None:
            self._outbox.put_first(repeat)
        if self._closed:
            connection.half_close()
