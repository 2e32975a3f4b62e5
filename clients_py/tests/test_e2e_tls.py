"""Encryption and token, on a real daemon of its own."""

from __future__ import annotations

import pytest
import trustme

import mane
from conftest import make_guide, start_daemon, stop_daemon


@pytest.fixture
def guarded(tmp_path):
    """A daemon that speaks TLS and wants a token; with the file of its authority."""
    authority = trustme.CA()
    certificate = authority.issue_cert("127.0.0.1", "localhost")
    certificate.private_key_pem.write_to_path(tmp_path / "key.pem")
    certificate.cert_chain_pems[0].write_to_path(tmp_path / "cert.pem")
    authority.cert_pem.write_to_path(tmp_path / "ca.pem")
    (tmp_path / "token").write_text("sesame-4711-open-the-door\n")
    daemon = start_daemon(
        tmp_path, "--tls-cert", str(tmp_path / "cert.pem"), "--tls-key", str(tmp_path / "key.pem"),
        "--token-file", str(tmp_path / "token"),
    )  # fmt: skip
    yield daemon.address, tmp_path / "ca.pem"
    stop_daemon(daemon)


def test_the_right_token_opens_everything(guarded):
    address, ca_file = guarded
    with mane.Client(address, ca_file=ca_file, token="sesame-4711-open-the-door") as client:
        groom = client.create_groom([make_guide()])
        with client.open_head(groom, "lockstep") as head:
            assert head.step(mane.Pose(0)).index == 1


def test_others_are_refused_with_what_to_do(guarded):
    address, ca_file = guarded
    for token in (None, "wrong-but-long-enough"):
        with (
            mane.Client(address, ca_file=ca_file, token=token) as client,
            pytest.raises(mane.Unauthenticated, match="pass Client"),
        ):
            list(client.list_grooms())


def test_an_unknown_authority_is_not_trusted(guarded):
    address, _ = guarded
    with mane.Client(address, tls=True, token="x") as client, pytest.raises(mane.Unavailable):
        client.get_groom("x")
    with mane.Client(address) as client, pytest.raises(mane.Unavailable):
        client.get_groom("x")
