"""Heads of hair for asyncio: `mane.heads` with `await`, for one event loop.

The streams are those of `mane.heads`, on threads, and not of gRPC's asyncio API: there a write that
fails while the server ends the stream hides the status that the server gave
(https://github.com/grpc/grpc/issues/36066), and with it what was wrong or that it can be resumed.
"""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator, Callable, Iterable
from concurrent.futures import ThreadPoolExecutor

from mane import heads, stream
from mane.beams import AnimationModel, BeamMotion
from mane.errors import DeadlineExceeded, Error
from mane.frames import Frame
from mane.motion import Motion
from mane.pose import Environment, Pose


class Head:
    """What both kinds of heads have in common; as `mane.heads.Head`.

    Args:
      head: what it stands for.
      worker: a thread of its own for what blocks; done with when the head is closed.
    """

    def __init__(self, head: heads.Head, worker: ThreadPoolExecutor):
        self._head = head
        self._worker = worker
        self.name = head.name
        self.guide_count = head.guide_count
        self.element_count = head.element_count
        self.points_per_guide = head.points_per_guide

    @property
    def notices(self) -> tuple[stream.Notice, ...]:
        """The newest hundred things that the server wanted to be known, oldest first."""
        return self._head.notices

    def reset(self) -> None:
        """Puts the hair to its rest shape with no velocity, from the next frame on."""
        self._head.reset()

    def set_environment(self, environment: Environment) -> None:
        """Changes wind, gravity or damping from the next step on; None leaves a value as it is."""
        self._head.set_environment(environment)

    def set_model(self, model: AnimationModel | str, beam: BeamMotion | None = None) -> None:
        """Changes how the hair is animated; as `mane.heads.Head.set_model`."""
        self._head.set_model(model, beam)

    async def close(self, quiet: bool = False) -> None:
        """Closes the head; the server forgets it. `quiet`: raises nothing."""
        if self._head.closed:
            return
        loop = asyncio.get_running_loop()
        closing = loop.run_in_executor(self._worker, self._head.close)
        try:
            # Closing has a time limit of its own, but a frame may be waited for before it.
            _, late = await asyncio.wait([closing], timeout=2 * heads.CLOSE_TIMEOUT_S)
            if late:
                self._head.abandon()
            await closing
        except Error:
            if not quiet:
                raise
        finally:
            self._worker.shutdown(wait=False)

    async def _run(self, work: Callable, *arguments):
        """The result of blocking work; pieces of it run one after the other."""
        self._head.require_open()
        return await asyncio.get_running_loop().run_in_executor(self._worker, work, *arguments)


class LockstepHead(Head):
    """A head that makes one frame from each pose. For one task at a time."""

    async def step(self, pose: Pose) -> Frame:
        """Moves the head to `pose`, whose time must be later than the last one's."""
        return await self._run(self._head.wait_for, self._head.send(pose))

    async def teleport(self, pose: Pose) -> Frame:
        """Moves head and hair together without dynamics, as in a cut."""
        return await self._run(self._head.wait_for, self._head.send_teleport(pose))

    async def play(
        self, motion: Motion | Iterable[Pose], in_flight: int = 8
    ) -> AsyncIterator[Frame]:
        """One frame for each pose of `motion`, in order; as `mane.heads.LockstepHead.play`."""
        frames = self._head.play(motion, in_flight)
        while (frame := await self._run(next, frames, None)) is not None:
            yield frame


class RealtimeHead(Head):
    """A head that the server animates by its own clock; as `mane.heads.RealtimeHead`."""

    def __init__(self, head: heads.RealtimeHead, worker: ThreadPoolExecutor):
        super().__init__(head, worker)
        self._changed = asyncio.Event()
        loop = asyncio.get_running_loop()

        def wake() -> None:
            with contextlib.suppress(RuntimeError):  # The loop has ended.
                loop.call_soon_threadsafe(self._changed.set)

        head.on_change(wake)

    @property
    def resumptions(self) -> int:
        """How often a broken connection was mended."""
        return self._head.resumptions

    def push(self, pose: Pose) -> None:
        """Tells where the head is at a moment of your clock, later than the last."""
        self._head.push(pose)

    def teleport(self, pose: Pose) -> None:
        """Moves head and hair together without dynamics, as in a cut."""
        self._head.teleport(pose)

    def newest(self) -> Frame | None:
        """The newest frame that has arrived, None before the first; perhaps the same again."""
        return self._head.newest()

    async def frames(self, timeout_s: float | None = 10.0) -> AsyncIterator[Frame]:
        """Waits for each next frame, always the newest one; ends when the head is closed.

        Raises DeadlineExceeded where none comes for `timeout_s` (None waits for ever).
        """
        while True:
            try:
                async with asyncio.timeout(timeout_s):
                    while (frame := self._head.next_frame()) is None and not self._head.closed:
                        await self._changed.wait()
                        self._changed.clear()
            except TimeoutError:
                message = f"{self.name} sent no frame for {timeout_s:g} s"
                raise DeadlineExceeded(message) from None
            if frame is None:
                return
            yield frame


async def open_head(open_blocking: Callable[[], heads.Head]) -> LockstepHead | RealtimeHead:
    """The head that `open_blocking` opens, which is called on a thread of the head's own."""
    worker = ThreadPoolExecutor(1, thread_name_prefix="mane-head")
    opening = worker.submit(open_blocking)
    try:
        head = await asyncio.wrap_future(opening)
    except BaseException:
        # Cancelled, perhaps, while it was being opened: it is closed as soon as it is open.
        opening.add_done_callback(_close_unused)
        worker.shutdown(wait=False)
        raise
    kind = LockstepHead if isinstance(head, heads.LockstepHead) else RealtimeHead
    return kind(head, worker)


def _close_unused(opening) -> None:
    if not opening.cancelled() and opening.exception() is None:
        with contextlib.suppress(Error):
            opening.result().close()
