"""Long work on the server."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum

from mane import messages
from mane.errors import JobFailed
from mane.v1 import job_pb2


class JobState(StrEnum):
    QUEUED = "queued"
    RUNNING = "running"
    SUCCEEDED = "succeeded"
    FAILED = "failed"
    CANCELLED = "cancelled"


@dataclass(frozen=True)
class Job:
    """A job as it was when the server said so.

    Attributes:
      name: `jobs/{job}`.
      kind: `bake` or `style`.
      state: a `JobState`.
      progress: 0 to 1.
      seconds_left: estimate while running; 0 when unknown.
      error: why it failed.
      create_time, start_time, end_time: UTC; None before the event.
      result_bytes: size of the result.
      description: what it works on.
    """

    name: str
    kind: str
    state: JobState
    progress: float
    seconds_left: float
    error: str
    create_time: datetime | None
    start_time: datetime | None
    end_time: datetime | None
    result_bytes: int
    description: str

    @property
    def ended(self) -> bool:
        return self.state in (JobState.SUCCEEDED, JobState.FAILED, JobState.CANCELLED)

    def require_success(self) -> Job:
        """This job. Raises JobFailed where it failed or was cancelled."""
        if self.state == JobState.FAILED:
            raise JobFailed(f"{self.name} failed: {self.error}")
        if self.state == JobState.CANCELLED:
            raise JobFailed(f"{self.name} was cancelled")
        return self


@dataclass(frozen=True)
class Reading:
    """How to read the frames of a bake: what it was submitted with.

    Attributes:
      groom: `grooms/{groom}`.
      format, space: values of the API's enums.
      points_per_guide: as given to `bake`.
    """

    groom: str
    format: int
    space: int
    points_per_guide: int


def from_message(message: job_pb2.Job) -> Job:
    state = job_pb2.Job.State.Name(message.state).removeprefix("STATE_").lower()
    return Job(
        name=message.name,
        kind=message.kind,
        state=JobState(state),
        progress=message.progress,
        seconds_left=message.seconds_left,
        error=message.error,
        create_time=messages.utc(message, "create_time"),
        start_time=messages.utc(message, "start_time"),
        end_time=messages.utc(message, "end_time"),
        result_bytes=message.result_bytes,
        description=message.description,
    )
