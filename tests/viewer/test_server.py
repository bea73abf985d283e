"""The server: this machine only, no other port than the one asked for, and no file but its own page."""

import http.client
import json
import socket
from collections.abc import Iterator
from pathlib import Path

import pytest

from recording.errors import InputError
from viewer.server import ClosedServer, opened_server


@pytest.fixture
def server() -> Iterator[ClosedServer]:
    server = opened_server(host="127.0.0.1", port=0, label="test")
    yield server
    server.stop()


def status_and_text(server: ClosedServer, path: str) -> tuple[int, bytes]:
    """What the server answers to a path that is sent as it is."""
    connection = http.client.HTTPConnection("127.0.0.1", server.get_port(), timeout=30)
    connection.request("GET", path)
    answer = connection.getresponse()
    found = answer.status, answer.read()
    connection.close()
    return found


def test_it_serves_its_page(server: ClosedServer) -> None:
    status, text = status_and_text(server, "/")
    assert status == 200
    assert b"<html" in text.lower()


@pytest.mark.parametrize(
    "form", ["{}", "/{}", "/..{}", "/%2e%2e{}", "/..%2f..%2f..%2f..{}", "/../../../../../..{}", "/file://{}"]
)
def test_no_file_of_the_machine_can_be_read(server: ClosedServer, tmp_path: Path, form: str) -> None:
    secret = tmp_path / "recording.json"
    secret.write_text(json.dumps("secret"), encoding="utf-8")
    status, text = status_and_text(server, form.format(secret))
    assert status == 404
    assert b"secret" not in text


def test_a_taken_port_is_refused_in_one_sentence() -> None:
    with socket.socket() as holder:
        holder.bind(("127.0.0.1", 0))
        holder.listen()
        port = holder.getsockname()[1]
        with pytest.raises(InputError, match=f"--port: 127.0.0.1:{port} cannot be listened on"):
            opened_server(host="127.0.0.1", port=port, label="test")


def test_a_host_that_is_none_is_refused() -> None:
    with pytest.raises(InputError, match="--host: expected a name or an address"):
        opened_server(host="no such host", port=0, label="test")


def test_it_listens_on_no_other_address(server: ClosedServer) -> None:
    with socket.socket() as other:
        other.settimeout(5)
        assert other.connect_ex(("127.0.0.2", server.get_port())) != 0


def test_nobody_can_make_it_public(server: ClosedServer) -> None:
    assert server.request_share_url() is None


def test_it_says_nothing_on_standard_output(capfd: pytest.CaptureFixture[str]) -> None:
    server = opened_server(host="127.0.0.1", port=0, label="test")
    server.stop()
    assert capfd.readouterr().out == ""
