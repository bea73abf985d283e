"""The web server of the viewer: it serves viser's own page, nothing else, and by default to this machine alone."""

import socket
from contextlib import redirect_stdout
from io import StringIO

from viser import ViserServer

from recording.errors import InputError


class ClosedServer(ViserServer):
    """A server that a page cannot make public: viser's page may ask for a tunnel through a host on the internet."""

    def request_share_url(self, verbose: bool = True) -> str | None:
        """Refuse: no address."""
        return None

    def stop(self) -> None:
        """Serve no more, without a word on standard output."""
        with redirect_stdout(StringIO()):
            super().stop()


def opened_server(*, host: str, port: int, label: str) -> ClosedServer:
    """A server at the address; InputError where the port is taken, for viser would quietly take another one."""
    _require_free(host, port)
    with redirect_stdout(StringIO()):  # Its banner; who calls says what is to be said.
        server = ClosedServer(host=host, port=port, label=label, verbose=False)
    if port not in (0, server.get_port()):  # Somebody was quicker.
        server.stop()
        raise _taken(host, port)
    server.gui.configure_theme(show_logo=False, show_share_button=False, control_width="large")
    return server


def _require_free(host: str, port: int) -> None:
    try:
        family, kind, protocol, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
    except socket.gaierror:
        raise InputError(f"--host: expected a name or an address of this machine, got {host!r}") from None
    with socket.socket(family, kind, protocol) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind(address)
            probe.listen()
        except PermissionError:
            raise InputError(f"--port: {port} is reserved for the system: choose one above 1023") from None
        except OSError as error:
            raise _taken(host, port, error.strerror) from None


def _taken(host: str, port: int, why: str | None = None) -> InputError:
    reason = f" ({why})" if why else ""
    return InputError(
        f"--port: {host}:{port} cannot be listened on{reason}: "
        "end what uses it, or choose another, such as --port 8081; 0 takes any that is free"
    )
