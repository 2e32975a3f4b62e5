"""Errors of the Mane client: one class per gRPC status that a caller can act on.

Every error says what happened and what to do. Errors that the server finds and errors that the
client finds before it sends anything have the same classes.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class FieldViolation:
    """One refused field of a request.

    Attributes:
      field: path in the request, such as `guides[12].length_m`.
      description: the value that was sent and the range that is allowed.
    """

    field: str
    description: str


class Error(Exception):
    """Base of all errors of this package.

    Attributes:
      code: name of the gRPC status code, such as `NOT_FOUND`.
      field_violations: refused fields; empty where the error is not about fields.
    """

    code = "UNKNOWN"

    def __init__(self, message: str, field_violations: tuple[FieldViolation, ...] = ()):
        super().__init__(message)
        self.field_violations = tuple(field_violations)


class InvalidArgument(Error, ValueError):
    """A value is out of its range; `field_violations` names it."""

    code = "INVALID_ARGUMENT"

    @classmethod
    def of(cls, field: str, description: str) -> InvalidArgument:
        """Error about one field that the client itself refuses."""
        return cls(f"{field}: {description}", (FieldViolation(field, description),))


class NotFound(Error, LookupError):
    """There is no groom, job or head of that name."""

    code = "NOT_FOUND"


class AlreadyExists(Error):
    """The name is taken."""

    code = "ALREADY_EXISTS"


class FailedPrecondition(Error):
    """The resource is not in the state that the call needs, such as a bake that still runs."""

    code = "FAILED_PRECONDITION"


class ResourceExhausted(Error):
    """A limit of the server: too many heads, a groom that is too large, too little room."""

    code = "RESOURCE_EXHAUSTED"


class Unauthenticated(Error):
    """The server wants a valid token."""

    code = "UNAUTHENTICATED"


class PermissionDenied(Error):
    """The token does not allow this call."""

    code = "PERMISSION_DENIED"


class Unavailable(Error, ConnectionError):
    """No server answers at the address, or the connection broke."""

    code = "UNAVAILABLE"


class DeadlineExceeded(Error, TimeoutError):
    """The server did not answer in time."""

    code = "DEADLINE_EXCEEDED"


class Cancelled(Error):
    """The call was cancelled, by this side or by a proxy between."""

    code = "CANCELLED"


class Internal(Error):
    """A fault in the server."""

    code = "INTERNAL"


class JobFailed(Error):
    """A job ended without a result: it failed or was cancelled."""

    code = "ABORTED"
