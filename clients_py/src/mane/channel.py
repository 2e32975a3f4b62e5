"""How the client reaches a server: address, encryption, keepalive, retries, and errors."""

from __future__ import annotations

import json
import os
from pathlib import Path

import grpc
from google.rpc import error_details_pb2
from grpc_status import rpc_status

from mane import errors

DEFAULT_SERVER = "127.0.0.1:7420"
SERVER_VARIABLE = "MANE_SERVER"

# A call that was not started, or whose request carries an id, may be sent again.
_RETRIES = {
    "methodConfig": [
        {
            "name": [
                {"service": "mane.v1.GroomService"},
                {"service": "mane.v1.BakeService"},
                {"service": "mane.v1.JobService"},
            ],
            "retryPolicy": {
                "maxAttempts": 3,
                "initialBackoff": "0.1s",
                "maxBackoff": "1s",
                "backoffMultiplier": 3,
                "retryableStatusCodes": ["UNAVAILABLE"],
            },
        }
    ]
}

OPTIONS = (
    ("grpc.keepalive_time_ms", 10_000),
    ("grpc.keepalive_timeout_ms", 5_000),
    ("grpc.http2.max_pings_without_data", 0),
    ("grpc.initial_reconnect_backoff_ms", 200),
    ("grpc.min_reconnect_backoff_ms", 200),
    ("grpc.max_reconnect_backoff_ms", 2_000),
    ("grpc.max_receive_message_length", 256 * 1024 * 1024),
    ("grpc.service_config", json.dumps(_RETRIES)),
)

_CLASSES = {
    "CANCELLED": errors.Cancelled,
    "INVALID_ARGUMENT": errors.InvalidArgument,
    "OUT_OF_RANGE": errors.InvalidArgument,
    "DEADLINE_EXCEEDED": errors.DeadlineExceeded,
    "NOT_FOUND": errors.NotFound,
    "ALREADY_EXISTS": errors.AlreadyExists,
    "PERMISSION_DENIED": errors.PermissionDenied,
    "UNAUTHENTICATED": errors.Unauthenticated,
    "RESOURCE_EXHAUSTED": errors.ResourceExhausted,
    "FAILED_PRECONDITION": errors.FailedPrecondition,
    "UNAVAILABLE": errors.Unavailable,
    "INTERNAL": errors.Internal,
}


def resolve_server(server: str | None) -> str:
    """`server`, else the environment's MANE_SERVER, else 127.0.0.1:7420."""
    return server or os.environ.get(SERVER_VARIABLE) or DEFAULT_SERVER


def open_channel(api, server: str, tls: bool, ca_file: str | os.PathLike | None, token: str | None):
    """A channel of `api`, which is `grpc` or `grpc.aio`."""
    if not (tls or ca_file):
        if token:
            raise errors.InvalidArgument.of(
                "token", "needs an encrypted connection: pass ca_file, or tls=True"
            )
        return api.insecure_channel(server, options=OPTIONS)
    roots = Path(ca_file).read_bytes() if ca_file else None
    credentials = grpc.ssl_channel_credentials(root_certificates=roots)
    if token:
        credentials = grpc.composite_channel_credentials(
            credentials, grpc.access_token_call_credentials(token)
        )
    return api.secure_channel(server, credentials, options=OPTIONS)


def translate(error: grpc.RpcError, server: str) -> errors.Error:
    """The error of this package that says the same as a failed call, and what to do."""
    code, details = error.code(), error.details() or ""
    violations = _field_violations(error)
    if code == grpc.StatusCode.UNAVAILABLE:
        message = (
            f"no answer from {server} ({details}); is maned running there? "
            f"Another address is given as Client(server=...), --server or {SERVER_VARIABLE}"
        )
    elif code == grpc.StatusCode.DEADLINE_EXCEEDED:
        message = f"{server} did not answer in time; is it overloaded? A longer timeout may help"
    elif code == grpc.StatusCode.UNAUTHENTICATED:
        message = f"{details or 'the server wants a token'}; pass Client(token=...) or --token"
    elif code == grpc.StatusCode.UNIMPLEMENTED:
        message = f"{server} does not know this call ({details}); is it a maned of this version?"
    else:
        named = "; ".join(f"{v.field}: {v.description}" for v in violations)
        message = details or named or code.name
    result = _CLASSES.get(code.name, errors.Error)(message, violations)
    result.code = code.name
    return result


def _field_violations(error: grpc.RpcError) -> tuple[errors.FieldViolation, ...]:
    """The fields named by google.rpc.BadRequest in `grpc-status-details-bin`."""
    status = rpc_status.from_call(error)
    bad_request = error_details_pb2.BadRequest()
    violations = []
    for detail in status.details if status is not None else ():
        if detail.Unpack(bad_request):
            violations += [
                errors.FieldViolation(v.field, v.description) for v in bad_request.field_violations
            ]
    return tuple(violations)
