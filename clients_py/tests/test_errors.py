"""Errors: what a server says and what the client makes of it, over a real connection."""

from __future__ import annotations

import asyncio
from concurrent import futures

import grpc
import pytest
from google.protobuf import any_pb2
from google.rpc import error_details_pb2, status_pb2
from grpc_status import rpc_status

import mane
import mane.aio
from mane.v1 import groom_pb2_grpc


def rich_status(code: grpc.StatusCode, message: str, **violations: str):
    """A status with a google.rpc.BadRequest that names fields."""
    bad_request = error_details_pb2.BadRequest()
    for field, description in violations.items():
        bad_request.field_violations.add(field=field, description=description)
    detail = any_pb2.Any()
    detail.Pack(bad_request)
    details = [detail] if violations else []
    return rpc_status.to_status(
        status_pb2.Status(code=code.value[0], message=message, details=details)
    )


class Refusing(groom_pb2_grpc.GroomServiceServicer):
    """Refuses every GetGroom with `answer`."""

    answer = None

    def GetGroom(self, request, context):
        context.abort_with_status(self.answer)


@pytest.fixture
def refusing():
    server = grpc.server(futures.ThreadPoolExecutor(1))
    service = Refusing()
    groom_pb2_grpc.add_GroomServiceServicer_to_server(service, server)
    service.address = f"127.0.0.1:{server.add_insecure_port('127.0.0.1:0')}"
    server.start()
    yield service
    server.stop(None).wait()


def ask(address: str) -> mane.Error:
    with mane.Client(address) as client, pytest.raises(mane.Error) as caught:
        client.get_groom("x")
    return caught.value


@pytest.mark.parametrize(
    ("code", "kind"),
    [
        (grpc.StatusCode.INVALID_ARGUMENT, mane.InvalidArgument),
        (grpc.StatusCode.NOT_FOUND, mane.NotFound),
        (grpc.StatusCode.ALREADY_EXISTS, mane.AlreadyExists),
        (grpc.StatusCode.FAILED_PRECONDITION, mane.FailedPrecondition),
        (grpc.StatusCode.RESOURCE_EXHAUSTED, mane.ResourceExhausted),
        (grpc.StatusCode.PERMISSION_DENIED, mane.PermissionDenied),
        (grpc.StatusCode.UNAUTHENTICATED, mane.Unauthenticated),
        (grpc.StatusCode.INTERNAL, mane.Internal),
        (grpc.StatusCode.CANCELLED, mane.Cancelled),
        (grpc.StatusCode.DATA_LOSS, mane.Error),
    ],
)
def test_status_codes_have_their_classes(refusing, code, kind):
    refusing.answer = rich_status(code, "because so")
    error = ask(refusing.address)
    assert type(error) is kind
    assert error.code == code.name
    assert "because so" in str(error)


def test_field_violations_arrive(refusing):
    refusing.answer = rich_status(
        grpc.StatusCode.INVALID_ARGUMENT, "length_m is -1; it must be above 0", length_m="is -1"
    )
    error = ask(refusing.address)
    assert error.field_violations == (mane.FieldViolation("length_m", "is -1"),)
    assert str(error) == "length_m is -1; it must be above 0"
    assert isinstance(error, ValueError)


def test_asyncio_client_raises_the_same(refusing):
    refusing.answer = rich_status(grpc.StatusCode.NOT_FOUND, "no such groom", name="is grooms/x")

    async def run():
        async with mane.aio.Client(refusing.address) as client:
            await client.get_groom("x")

    with pytest.raises(mane.NotFound, match="no such groom") as caught:
        asyncio.run(run())
    assert caught.value.field_violations[0].field == "name"


def test_no_server_says_address_and_what_to_do():
    error = ask("127.0.0.1:1")
    assert type(error) is mane.Unavailable and isinstance(error, ConnectionError)
    assert "127.0.0.1:1" in str(error) and "is maned running there?" in str(error)


def test_other_services_are_told_apart_from_a_maned(refusing):
    with mane.Client(refusing.address) as client, pytest.raises(mane.Error) as caught:
        client.status()
    assert caught.value.code == "UNIMPLEMENTED"
    assert "is it a maned" in str(caught.value)


def test_token_without_encryption_is_refused_before_it_is_sent():
    with pytest.raises(mane.InvalidArgument, match="token: needs an encrypted connection"):
        mane.Client("127.0.0.1:1", token="secret")


def test_server_address_comes_from_the_environment(monkeypatch):
    monkeypatch.setenv("MANE_SERVER", "10.1.2.3:99")
    with mane.Client() as client:
        assert client.server == "10.1.2.3:99"
    monkeypatch.delenv("MANE_SERVER")
    with mane.Client() as client:
        assert client.server == "127.0.0.1:7420"
