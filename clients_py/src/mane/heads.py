"""Heads of hair that move: the two kinds that `mane.Client.open_head` opens."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import replace

import grpc

from mane import beams, channel, messages, stream
from mane.beams import AnimationModel, BeamMotion
from mane.errors import DeadlineExceeded, Error, FailedPrecondition, Unavailable
from mane.frames import Frame
from mane.helix import Strands
from mane.motion import Motion
from mane.outbox import Feed, Outbox
from mane.pose import Environment, Pose
from mane.v1 import animation_pb2

Request = animation_pb2.AnimateRequest

OPEN_TIMEOUT_S = 30.0
CLOSE_TIMEOUT_S = 5.0


class _Connection:
    """One Animate call that the server has opened."""

    def __init__(self, stub, server: str, outbox: Outbox, first: Request, timeout_s: float):
        self._server = server
        self._feed = Feed(outbox, first)
        try:
            self._call = stub.Animate(self._feed)
        except ValueError as error:  # gRPC's word for a closed channel.
            raise FailedPrecondition(f"the client of {server} is closed") from error
        try:
            with self.time_limit(timeout_s):
                response = self.receive()
            if response is None or response.WhichOneof("kind") != "opened":
                raise Unavailable(f"{server} did not open the head; is it a maned?")
        except BaseException:
            self.abandon()
            raise
        self.opened = response.opened

    def receive(self) -> animation_pb2.AnimateResponse | None:
        """The next answer, or None where the server has ended the stream. Raises `Error`."""
        try:
            return next(self._call, None)
        except grpc.RpcError as error:
            raise channel.translate(error, self._server) from error

    def half_close(self) -> None:
        """Tells the server that nothing more comes; it then ends the stream."""
        self._feed.close()

    def abandon(self) -> None:
        self._feed.abandon()
        self._call.cancel()

    @contextmanager
    def time_limit(self, seconds: float) -> Iterator[None]:
        """Cancels the call where the block takes longer; raises DeadlineExceeded then."""
        expired = threading.Event()

        def expire() -> None:
            expired.set()
            self._call.cancel()

        timer = threading.Timer(seconds, expire)
        timer.daemon = True
        timer.start()
        try:
            yield
        except Error as error:
            if expired.is_set() and error.code == "CANCELLED":
                message = f"{self._server} did not answer within {seconds:g} s"
                raise DeadlineExceeded(message) from error
            raise
        finally:
            timer.cancel()


class Head:
    """What both kinds of heads have in common. A context manager: leaving it closes the head.

    Attributes:
      name: `heads/{head}`, as in the server's logs.
      guide_count, element_count, points_per_guide: shapes of frames.
    """

    def __init__(self, stub, server: str, open_head, strands: Strands | None, outbox: Outbox):
        self._server = server
        self._outbox = outbox
        self._connection = _Connection(
            stub, server, outbox, Request(open=open_head), OPEN_TIMEOUT_S
        )
        opened = self._connection.opened
        self._receiver = stream.Receiver(opened, strands)
        self._failure: Error | None = None
        self._failure_raised = False
        self._closed = False
        self.name = opened.head
        self.guide_count = opened.guide_count
        self.element_count = opened.element_count
        self.points_per_guide = opened.points_per_guide

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

    def set_model(self, model: AnimationModel | str, beam: BeamMotion | None = None) -> None:
        """Changes how the hair is animated from the next step on, without a jump; `beam` None
        leaves beams as they are. Where the server has no room, the head keeps its model, and a
        notice says so; `Frame.model` tells which each frame has."""
        self._send(Request(model=beams.set_model(model, beam)))

    @property
    def closed(self) -> bool:
        """Whether `close` was called."""
        return self._closed

    def close(self) -> None:
        """Closes the head; the server forgets it. May be called twice."""
        raise NotImplementedError

    def abandon(self) -> None:
        """Breaks the connection at once, from any thread; what waits for it fails."""
        self._connection.abandon()

    def __enter__(self):
        return self

    def __exit__(self, kind, *_) -> None:
        try:
            self.close()
        except Error:
            if kind is None:  # Else the block's own exception says more.
                raise

    def _send(self, request: Request) -> None:
        self.require_open()
        self._outbox.put(request)

    def _require_sound(self) -> None:
        """Raises what ended the stream, if something did."""
        if self._failure is not None:
            self._failure_raised = True
            raise self._failure

    def require_open(self) -> None:
        """Raises what ended the stream, and FailedPrecondition where the head was closed."""
        self._require_sound()
        if self._closed:
            raise FailedPrecondition(f"{self.name} is closed")


class LockstepHead(Head):
    """A head that makes one frame from each pose. For one thread at a time."""

    def __init__(self, stub, server: str, open_head, strands: Strands | None):
        super().__init__(stub, server, open_head, strands, Outbox())
        self._last_index = self._connection.opened.next_frame - 1

    def step(self, pose: Pose) -> Frame:
        """Moves the head to `pose`, whose time must be later than the last one's."""
        return self.wait_for(self.send(pose))

    def teleport(self, pose: Pose) -> Frame:
        """Moves head and hair together without dynamics, as in a cut; bodies are where it says at
        once."""
        return self.wait_for(self.send_teleport(pose))

    def play(self, motion: Motion | Iterable[Pose], in_flight: int = 8) -> Iterator[Frame]:
        """One frame for each pose of `motion`, in order.

        The frames are the same as from `step`; `in_flight` poses (at least 1) are under way at a
        time, so that server and connection do not wait for each other.
        """
        first = self._last_index + 1
        for pose in motion.poses() if isinstance(motion, Motion) else motion:
            if self.send(pose) - first + 1 >= in_flight:
                yield self.wait_for(first)
                first += 1
        while first <= self._last_index:
            yield self.wait_for(first)
            first += 1

    def close(self) -> None:
        if self._closed:
            return
        self._closed = True
        if self._failure is not None:
            self._connection.abandon()
            return
        self._connection.half_close()
        with self._connection.time_limit(CLOSE_TIMEOUT_S):
            while self._connection.receive() is not None:
                pass  # Frames that nobody asked for any more.

    def send(self, pose: Pose) -> int:
        """Sends a pose without waiting for its frame; returns the frame's index."""
        return self._send_counted(Request(pose=messages.head_pose(pose)))

    def send_teleport(self, pose: Pose) -> int:
        """`send` for a teleport."""
        return self._send_counted(Request(teleport=messages.head_pose(pose)))

    def _send_counted(self, request: Request) -> int:
        """Sends a message that yields a frame; returns the frame's index."""
        self._send(request)
        self._last_index += 1
        return self._last_index

    def wait_for(self, index: int) -> Frame:
        """Waits for the frame of that index; drops those before it that nobody waited for."""
        self.require_open()
        try:
            while True:
                response = self._connection.receive()
                if response is None:
                    raise Unavailable(f"{self._server} ended the stream of {self.name}")
                frame = self._receiver.accept(response)
                if frame is not None and frame.index >= index:
                    return frame
        except Error as error:
            self._failure = error
            raise


class RealtimeHead(Head):
    """A head that the server animates by its own clock. Any thread may call any method.

    A thread of its own receives frames, keeps the newest and acknowledges them. Where the
    connection breaks it resumes the head, for as long as the server keeps it; of the poses pushed
    meanwhile the newest few wait. What cannot be mended is raised by the next call.
    """

    def __init__(self, stub, server: str, open_head, strands: Strands | None):
        self._stub = stub
        self._acknowledger = stream.Acknowledger(open_head.max_unacked_frames)
        outbox = Outbox(pose_limit=stream.POSE_LIMIT, stamp=self._acknowledger.stamp)
        super().__init__(stub, server, open_head, strands, outbox)
        self._environment = stream.EnvironmentMemory()
        self._model = stream.ModelMemory()
        self._changed = threading.Condition()  # Guards what is below.
        self._selector = stream.FrameSelector(self._connection.opened.next_frame)
        self._resumptions = 0
        self._bodies: dict[str, Pose] = {}  # Newest poses of all that were named.
        self._listener: Callable[[], None] = lambda: None
        self._thread = threading.Thread(target=self._run, name=self.name, daemon=True)
        self._thread.start()

    @property
    def resumptions(self) -> int:
        """How often a broken connection was mended."""
        return self._resumptions

    def push(self, pose: Pose) -> None:
        """Tells where the head is at a moment of your clock, later than the last. Never blocks."""
        self._send(Request(pose=self._head_pose(pose)))

    def teleport(self, pose: Pose) -> None:
        """Moves head and hair together without dynamics, as in a cut; bodies are where it says at
        once. Never blocks."""
        self._send(Request(teleport=self._head_pose(pose)))

    def _head_pose(self, pose: Pose) -> animation_pb2.HeadPose:
        """With all bodies that were named so far: a pose on its way may be dropped for a newer."""
        with self._changed:
            self._bodies |= pose.bodies
            return messages.head_pose(replace(pose, bodies=self._bodies))

    def set_environment(self, environment: Environment) -> None:
        with self._changed:
            self._environment.add(messages.environment(environment))
        super().set_environment(environment)

    def set_model(self, model: AnimationModel | str, beam: BeamMotion | None = None) -> None:
        with self._changed:
            self._model.add(beams.set_model(model, beam))
        super().set_model(model, beam)

    def newest(self) -> Frame | None:
        """The newest frame that has arrived, None before the first. Never blocks.

        The same frame again where no newer one has arrived.
        """
        with self._changed:
            self._require_sound()
            return self._selector.take()

    def next_frame(self) -> Frame | None:
        """The newest frame if it has not been given yet, else None. Never blocks."""
        with self._changed:
            self._require_sound()
            return self._selector.take() if self._selector.fresh else None

    def on_change(self, listener: Callable[[], None]) -> None:
        """Calls `listener`, on another thread, when a frame has come or the head has ended."""
        with self._changed:
            self._listener = listener
            listener()  # For what came before.

    def frames(self, timeout_s: float | None = 10.0) -> Iterator[Frame]:
        """Waits for each next frame, always the newest one; ends when the head is closed.

        Raises DeadlineExceeded where none comes for `timeout_s` (None waits for ever).
        """
        while True:
            with self._changed:
                fresh = self._changed.wait_for(
                    lambda: self._selector.fresh or self._failure or self._closed, timeout_s
                )
                self._require_sound()
                if self._closed:
                    return
                if not fresh:
                    raise DeadlineExceeded(f"{self.name} sent no frame for {timeout_s:g} s")
                frame = self._selector.take()
            yield frame

    def close(self) -> None:
        with self._changed:
            if self._closed:
                return
            self._closed = True
            self._announce()
            self._connection.half_close()
        self._thread.join(CLOSE_TIMEOUT_S)
        if self._thread.is_alive():
            self._connection.abandon()
            self._thread.join()
        if not self._failure_raised:
            self._require_sound()

    def _announce(self) -> None:
        """Wakes whoever waits. `_changed` is held."""
        self._changed.notify_all()
        self._listener()

    def _run(self) -> None:
        """Receives until the head is closed or cannot be resumed."""
        try:
            while not self._closed:
                self._receive_all()
        except Error as error:
            with self._changed:
                if not (self._closed and error.code in stream.RESUMABLE):
                    self._failure = error
                self._announce()

    def _receive_all(self) -> None:
        """Receives until the stream breaks, then resumes it, or until it ends."""
        broken = Unavailable(f"{self._server} ended the stream of {self.name}")
        try:
            while (response := self._connection.receive()) is not None:
                self._accept(response)
        except Error as error:
            broken = error
        self._connection.abandon()
        if self._closed:
            return
        if broken.code not in stream.RESUMABLE:
            raise broken
        self._resume(broken)

    def _accept(self, response: animation_pb2.AnimateResponse) -> None:
        frame = self._receiver.accept(response)
        if frame is None:
            return
        if self._acknowledger.received(frame.index):
            self._outbox.put(Request(acknowledge=animation_pb2.Acknowledge()))
        with self._changed:
            self._selector.offer(frame)
            self._announce()

    def _resume(self, broken: Error) -> None:
        """Opens the head again, trying for as long as the server keeps it. Raises `Error`."""
        opened = self._connection.opened
        deadline = time.monotonic() + opened.resume_grace_s
        for delay in stream.resume_delays():
            try:
                first = Request(open=animation_pb2.OpenHead(resume=opened.resume_token))
                timeout_s = max(1.0, deadline - time.monotonic())
                connection = _Connection(self._stub, self._server, self._outbox, first, timeout_s)
                break
            except Error as error:
                if error.code not in (*stream.RESUMABLE, "DEADLINE_EXCEEDED"):
                    raise
            with self._changed:
                left = deadline - time.monotonic()
                if left <= 0:
                    raise broken
                if self._changed.wait_for(lambda: self._closed, min(delay, left)):
                    return
        self._adopt(connection)

    def _adopt(self, connection: _Connection) -> None:
        with self._changed:
            self._connection = connection
            self._receiver.opened = connection.opened
            self._resumptions += 1
            for repeat in (self._environment.request(), self._model.request()):
                if repeat is not None:
                    self._outbox.put_first(repeat)
            if self._closed:
                connection.half_close()
