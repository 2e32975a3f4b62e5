"""Messages on their way to a stream's writer thread.

An outbox outlives a broken stream: what was not sent yet goes to the next one.
"""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable

from mane.v1 import animation_pb2

Request = animation_pb2.AnimateRequest


class Outbox:
    """Messages that wait to be sent, in order. Thread-safe.

    Args:
      pose_limit: from so many waiting messages on, a pose replaces the pose before it: of poses
        that a stalled connection holds back only the newest matters. None keeps all.
      stamp: called with each message just before it is sent, with `changed` held.

    Attributes:
      changed: guards `messages`; notified when they change.
      messages: what waits.
    """

    def __init__(
        self,
        pose_limit: int | None = None,
        stamp: Callable[[Request], Request] = lambda request: request,
    ):
        self.changed = threading.Condition()
        self.messages: deque[Request] = deque()
        self.stamp = stamp
        self._pose_limit = pose_limit

    def put(self, request: Request) -> None:
        with self.changed:
            full = self._pose_limit is not None and len(self.messages) >= self._pose_limit
            if full and _is_pose(request) and _is_pose(self.messages[-1]):
                self.messages.pop()
            self.messages.append(request)
            self.changed.notify_all()

    def put_first(self, request: Request) -> None:
        """Sends `request` before everything that waits."""
        with self.changed:
            self.messages.appendleft(request)
            self.changed.notify_all()


class Feed:
    """Iterator over one stream's messages: `first`, then what waits in the outbox and what comes.

    Blocks for the next message until `close` or `abandon`.
    """

    def __init__(self, outbox: Outbox, first: Request):
        self._outbox = outbox
        self._first: Request | None = first
        self._closed = False
        self._abandoned = False

    def close(self) -> None:
        """Ends the iteration after what waits."""
        with self._outbox.changed:
            self._closed = True
            self._outbox.changed.notify_all()

    def abandon(self) -> None:
        """Ends the iteration at once; what waits is left for the next stream."""
        with self._outbox.changed:
            self._abandoned = True
            self._outbox.changed.notify_all()

    def __iter__(self) -> Feed:
        return self

    def __next__(self) -> Request:
        outbox = self._outbox
        with outbox.changed:
            first, self._first = self._first, None
            if first is not None:
                return outbox.stamp(first)
            outbox.changed.wait_for(lambda: self._abandoned or self._closed or outbox.messages)
            if self._abandoned or not outbox.messages:
                raise StopIteration
            return outbox.stamp(outbox.messages.popleft())


def _is_pose(request: Request) -> bool:
    return request.WhichOneof("kind") == "pose"
